import Foundation

/// A recording as CSV, as `magcomp import` and ``Compass/record(to:mostBytes:)`` write it, for tests, demos and bug reports:
/// `t_s,mx,my,mz[,ax,ay,az][,gx,gy,gz][,sys_mx,sys_my,sys_mz][,course_deg,course_sigma_deg]` in any order, seconds, microtesla, m/s^2
/// (pointing up at rest), rad/s, the system's own field in microtesla, degrees from true north; what a compass's own recording has beside
/// these stands in docs/dev/RECORDING_FILE.md, and other columns are ignored. Of a sensor there are all columns or none, and a row leaves
/// all its cells empty where the sensor said nothing at that time. A row's help from outside is told first, then gyroscope, `up`, the
/// system's field and the magnetometer, as far as it has them.
///
/// The recording of a compass plays as it was, reading for reading, in a compass with the same config and without a store: it sets the
/// compass's frame, takes over the calibration that the recorded one took over, and forgets where that forgot.
///
/// Rows wait for whoever reads them, so none of their readings is dropped. Iterating throws ``RecordingSource/FileError`` where the
/// recording is not in order.
public struct RecordingSource: MagneticFieldSource {
    private let name: String
    private let open: @Sendable () throws -> Data
    private let speed: Double?
    private let courses: SensorSample.HeadedAxis?
    private let clock: any WaitingClock

    /// - Parameters:
    ///   - name: said in errors
    ///   - speed: 1 plays at the recording's own pace, 2 twice as fast, above 0; nil: as fast as it is read
    ///   - courses: what of the phone pointed along the courses; nil: they are passed over
    ///   - open: gives the text anew for every iterator
    public init(
        name: String, speed: Double? = nil, courses: SensorSample.HeadedAxis? = nil,
        open: @escaping @Sendable () throws -> Data
    ) {
        self.init(name: name, speed: speed, courses: courses, clock: SystemClock(), open: open)
    }

    /// A file, `.csv`; a `.csv.gz` must be decompressed before.
    ///
    /// - Parameters:
    ///   - url: the file
    ///   - speed: 1 plays at the recording's own pace, 2 twice as fast, above 0; nil: as fast as it is read
    ///   - courses: what of the phone pointed along the courses; nil: they are passed over
    public init(url: URL, speed: Double? = nil, courses: SensorSample.HeadedAxis? = nil) {
        self.init(name: url.lastPathComponent, speed: speed, courses: courses) {
            try Data(contentsOf: url, options: .alwaysMapped)
        }
    }

    init(
        name: String, speed: Double?, courses: SensorSample.HeadedAxis? = nil, clock: any WaitingClock,
        open: @escaping @Sendable () throws -> Data
    ) {
        (self.name, self.speed, self.courses, self.clock, self.open) = (name, speed, courses, clock, open)
    }

    public func samples() -> SensorSamples {
        SensorSamples.batches(isLive: false) { [self] in
            Rows(
                name: name, pace: speed.map { Pace("RecordingSource", speed: $0, clock: clock) }, courses: courses,
                open: open)
        }
    }
}

/// By what everything waits; a test has its own.
protocol WaitingClock: Sendable {
    var nowNs: Int64 { get }

    func sleep(forNs: Int64) async throws
}

struct SystemClock: WaitingClock {
    var nowNs: Int64 { Int64(DispatchTime.now().uptimeNanoseconds) }

    func sleep(forNs ns: Int64) async throws { try await Task.sleep(for: .nanoseconds(ns)) }
}

/// When a row is due.
struct Pace {
    private let source: String
    private let speed: Double
    private let clock: any WaitingClock
    /// Time of the first row, and when it was read.
    private var start: (rowNs: Int64, nowNs: Int64)?

    /// - Parameter source: named in errors
    init(_ source: String, speed: Double, clock: any WaitingClock) {
        (self.source, self.speed, self.clock) = (source, speed, clock)
    }

    func check() throws {
        guard speed > 0, speed.isFinite else {
            throw MagcompError.config(field: "\(source).speed", value: "\(speed)", expected: "above 0")
        }
    }

    mutating func wait(for rowNs: Int64) async throws {
        guard let start else {
            start = (rowNs, clock.nowNs)
            return
        }
        // of two differences, each exact enough: the times may be any
        let dueNs = (Double(rowNs) - Double(start.rowNs)) / speed
        let leftNs = dueNs - Double(clock.nowNs - start.nowNs)
        if leftNs >= 1, leftNs < 9e18 { try await clock.sleep(forNs: Int64(leftNs)) }
    }
}

/// The rows of a recording as events, read as they are asked for.
private struct Rows: AsyncSequence, AsyncIteratorProtocol {
    typealias Element = [SensorSample]

    /// Rows that are read at once where nothing is waited for.
    private static let together = 32
    private static let gzip: [UInt8] = [0x1f, 0x8b]

    let name: String
    let open: @Sendable () throws -> Data
    private let courses: SensorSample.HeadedAxis?
    private var pace: Pace?
    private var lines: Lines?
    private var columns: [String: Int] = [:]
    private var width = 0
    private var line = 0
    /// What is wrong with the row after those that were given.
    private var failure: (any Error)?

    init(name: String, pace: Pace?, courses: SensorSample.HeadedAxis?, open: @escaping @Sendable () throws -> Data) {
        (self.name, self.pace, self.courses, self.open) = (name, pace, courses, open)
    }

    func makeAsyncIterator() -> Rows { self }

    mutating func next() async throws -> [SensorSample]? {
        if let failure { throw failure }
        if lines == nil { try begin() }
        var events: [SensorSample] = []
        var rows = 0
        // a row may have nothing of what is read
        while events.isEmpty || (pace == nil && rows < Self.together) {
            guard let text = nextLine() else { return events.isEmpty ? nil : events }
            if text.isEmpty { continue }
            rows += 1
            do { try read(text, &events) } catch {
                if events.isEmpty { throw error }
                failure = error
                return events
            }
            if let first = events.first { try await pace?.wait(for: first.timeNs) }
        }
        return events
    }

    private mutating func begin() throws {
        try pace?.check()
        let data = try open()
        guard !data.starts(with: Self.gzip) else {
            throw RecordingSource.FileError(
                name: name, line: 1, column: nil, problem: "it is compressed; decompress it with gunzip")
        }
        lines = Lines(data: data)
        guard let header = nextLine() else {
            throw RecordingSource.FileError(name: name, line: 1, column: nil, problem: "the header is missing")
        }
        // spreadsheets write a mark first
        let names = cells(header.hasPrefix("\u{FEFF}") ? String(header.dropFirst()) : header)
        width = names.count
        columns = Dictionary(zip(names, 0...), uniquingKeysWith: { first, _ in first })
        for column in ["t_s", "mx", "my", "mz"] where columns[column] == nil {
            throw wrong(column, "the column is missing")
        }
        for group in [["t_s"], ["own_t_s"]] + RecordedColumn.allCases.flatMap(\.groups) {
            for column in group where names.count(where: { $0 == column }) > 1 {
                throw wrong(column, "the column is there twice")
            }
            let missing = group.filter { columns[$0] == nil }
            if let column = missing.first, missing.count < group.count {
                throw wrong(column, "the column is missing; expected all of \(group.joined(separator: ",")) or none")
            }
        }
    }

    private mutating func nextLine() -> String? {
        guard let text = lines?.next() else { return nil }
        line += 1
        return text
    }

    /// Appends the row's events, all or none.
    private func read(_ text: String, _ events: inout [SensorSample]) throws {
        let cells = cells(text)
        guard cells.count == width else { throw wrong(nil, "\(cells.count) cells, expected \(width)") }
        let rowNs = try time("t_s", cells)
        let timeNs = self.text("own_t_s", cells) == nil ? rowNs : try time("own_t_s", cells)
        var row: [SensorSample] = []
        func note(_ what: SensorSample.Note.What) { row.append(.note(SensorSample.Note(timeNs: rowNs, what: what))) }
        if self.text("reset", cells) != nil { note(.reset) }
        if let kept = self.text("kept", cells) { note(.kept(text: kept, unixTimeS: try whole("unix_s", cells))) }
        if self.text("run", cells) != nil { note(.run) }
        // what a recording of a compass has was told to it; of others the app says whose courses they are
        if let course = try numbers(RecordedColumn.course.groups[0], cells),
            let headed = try self.text("course_of", cells).map({ try axis($0) }) ?? courses
        {
            let sample = SensorSample.Heading(
                timeNs: timeNs, headingDeg: course[0], sigmaDeg: course[1],
                reference: try one("course_north", cells) ?? .true, axis: headed)
            row.append(.heading(sample))
        }
        if let pose = try numbers(RecordedColumn.pose.groups[0], cells) {
            let isKnown = self.text("pose_yaw_sigma_deg", cells) != nil
            let yaw: SensorSample.Attitude.WorldYaw =
                isKnown
                ? .absolute(
                    sigmaDeg: try number("pose_yaw_sigma_deg", cells), reference: try one("pose_north", cells) ?? .true)
                : .relative
            row.append(
                .attitude(SensorSample.Attitude(timeNs: timeNs, w: pose[0], x: pose[1], y: pose[2], z: pose[3], yaw: yaw)))
        }
        if let rate = try vector(.rate, cells) {
            row.append(.rotationRate(SensorSample.RotationRate(timeNs: timeNs, rateRadS: rate)))
        }
        if let up = try vector(.up, cells) { row.append(.up(SensorSample.Up(timeNs: timeNs, upMS2: up))) }
        if let field = try vector(.system, cells) {
            // nothing begins with a field of which the recording does not say how sure the system was
            let accuracy: SensorSample.SystemField.Accuracy = try one("sys_accuracy", cells) ?? .uncalibrated
            row.append(.systemField(SensorSample.SystemField(timeNs: timeNs, fieldUt: field, accuracy: accuracy)))
        }
        if self.text("slept_s", cells) != nil { note(.slept(seconds: try number("slept_s", cells))) }
        if let axis: HeadingFrame.ReferenceAxis = try one("axis", cells) {
            let rotation: HeadingFrame.ScreenRotation = try one("screen_deg", cells) ?? .deg0
            let declinationDeg = try number("declination_deg", cells)
            note(
                .frame(
                    HeadingFrame(
                        axis: axis, screenRotation: rotation, declinationDeg: declinationDeg.isNaN ? nil : declinationDeg)))
        }
        if let field = try vector(.magnetic, cells) {
            let reported = try vector(.magnetic, cells, group: 1)
            row.append(.magnetic(SensorSample.Magnetic(timeNs: timeNs, fieldUt: field, reportedHardIronUt: reported)))
        }
        events += row
    }

    private func vector(_ column: RecordedColumn, _ cells: [String], group: Int = 0) throws -> DeviceVector? {
        try numbers(column.groups[group], cells).map { DeviceVector(x: $0[0], y: $0[1], z: $0[2]) }
    }

    /// Nil where the sensor has no columns, or said nothing: all its cells are empty then.
    private func numbers(_ names: [String], _ cells: [String]) throws -> [Double]? {
        if names.allSatisfy({ columns[$0].map { cells[$0].isEmpty } ?? true }) { return nil }
        return try names.map { try number($0, cells) }
    }

    /// Nanoseconds, with all the digits there are: seconds as a number would lose some after a hundred days.
    private func time(_ column: String, _ cells: [String]) throws -> Int64 {
        let parts = cells[columns[column]!].split(separator: ".", omittingEmptySubsequences: false)
        if parts.count == 2, parts[1].count <= 9, parts[1].allSatisfy(\.isWholeNumber), let whole = Int64(parts[0]),
            let part = Int64(parts[1] + String(repeating: "0", count: 9 - parts[1].count))
        {
            let (scaled, over) = whole.multipliedReportingOverflow(by: 1_000_000_000)
            let (timeNs, over2) = scaled.addingReportingOverflow(parts[0].hasPrefix("-") ? -part : part)
            if !over, !over2 { return timeNs }
        }
        guard let timeNs = nanoseconds(try number(column, cells)) else {
            throw wrong(column, "the time is no number of seconds that fits 64 bits of nanoseconds")
        }
        return timeNs
    }

    /// A cell that says something.
    private func text(_ column: String, _ cells: [String]) -> String? {
        columns[column].flatMap { cells[$0].isEmpty ? nil : cells[$0] }
    }

    private func whole(_ column: String, _ cells: [String]) throws -> Int64 {
        guard let value = Int64(cells[columns[column]!]) else {
            throw wrong(column, "'\(cells[columns[column]!])' is no whole number")
        }
        return value
    }

    /// Nil for an empty cell.
    private func one<Value: Celled>(_ column: String, _ cells: [String]) throws -> Value? {
        guard let text = text(column, cells) else { return nil }
        guard let value = Value.ofCells[text] else {
            throw wrong(column, "'\(text)' is none of \(Value.ofCells.keys.sorted().joined(separator: ", "))")
        }
        return value
    }

    private func axis(_ text: String) throws -> SensorSample.HeadedAxis {
        guard let axis = SensorSample.HeadedAxis(cell: text) else {
            throw wrong("course_of", "'\(text)' is neither vehicle nor three numbers")
        }
        return axis
    }

    private func number(_ column: String, _ cells: [String]) throws -> Double {
        let text = cells[columns[column]!]
        guard let value = Double(text) else {
            throw wrong(
                column, text.isEmpty ? "an empty cell, where others of the sensor have numbers" : "'\(text)' is no number")
        }
        return value
    }

    /// A cell in quotes may have commas; two quotes in it are one.
    private func cells(_ text: String) -> [String] {
        guard text.utf8.contains(UInt8(ascii: "\"")) else {
            return text.split(separator: ",", omittingEmptySubsequences: false).map {
                $0.trimmingCharacters(in: .whitespaces)
            }
        }
        var cells: [String] = []
        var rest = text[...]
        while true {
            let end: Substring.Index
            if rest.first == "\"" {
                var cell = ""
                rest.removeFirst()
                while let quote = rest.firstIndex(of: "\"") {
                    cell += rest[..<quote]
                    rest = rest[rest.index(after: quote)...]
                    guard rest.first == "\"" else { break }
                    cell.append("\"")
                    rest.removeFirst()
                }
                end = rest.firstIndex(of: ",") ?? rest.endIndex
                cells.append(cell)
            } else {
                end = rest.firstIndex(of: ",") ?? rest.endIndex
                cells.append(rest[..<end].trimmingCharacters(in: .whitespaces))
            }
            if end == rest.endIndex { return cells }
            rest = rest[rest.index(after: end)...]
        }
    }

    private func wrong(_ column: String?, _ problem: String) -> RecordingSource.FileError {
        RecordingSource.FileError(name: name, line: line, column: column, problem: problem)
    }
}

/// The lines of a text, each decoded when it is asked for.
private struct Lines {
    let data: Data
    var at: Data.Index

    init(data: Data) { (self.data, at) = (data, data.startIndex) }

    mutating func next() -> String? {
        guard at < data.endIndex else { return nil }
        let end = data[at...].firstIndex(of: UInt8(ascii: "\n")) ?? data.endIndex
        var line = data[at..<end]
        at = end < data.endIndex ? data.index(after: end) : end
        if line.last == UInt8(ascii: "\r") { line.removeLast() }
        return String(decoding: line, as: UTF8.self)
    }
}

extension RecordingSource {
    /// A recording is not in order.
    public struct FileError: Error, Equatable, Sendable {
        /// The recording.
        public let name: String
        /// Line in it, from 1.
        public let line: Int
        /// Column's name, or nil when the line as a whole is wrong.
        public let column: String?
        /// What is wrong with it.
        public let problem: String
    }
}

extension RecordingSource.FileError: LocalizedError {
    public var errorDescription: String? {
        "\(name), line \(line)" + (column.map { ", column \($0)" } ?? "") + ": \(problem)"
    }
}
