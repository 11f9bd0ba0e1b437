import Foundation

/// A recording is not in order.
public struct RecordingSourceError: Error, Equatable, Sendable {
    /// The recording.
    public let name: String
    /// Line in it, from 1.
    public let line: Int
    /// Column's name, or nil when the line as a whole is wrong.
    public let column: String?
    /// What is wrong with it.
    public let problem: String
}

extension RecordingSourceError: LocalizedError {
    public var errorDescription: String? {
        "\(name), line \(line)" + (column.map { ", column \($0)" } ?? "") + ": \(problem)"
    }
}

/// A recording as CSV, as `magcomp import` and `recorded(to:)` write it, for tests and demos:
/// `t_s,mx,my,mz[,ax,ay,az][,gx,gy,gz][,sys_mx,sys_my,sys_mz][,course_deg,course_sigma_deg]` in any order, seconds, microtesla, m/s^2
/// (pointing up at rest), rad/s, the system's own field in microtesla, degrees from true north; other columns are ignored. Of a
/// sensor there are all columns or none, and a row leaves all its cells empty where the sensor said nothing at that time. Every row is a
/// gyroscope event, an `up` event, one of the system's field, a course and a magnetometer event, in this order, as far as it has them.
///
/// Rows wait for whoever reads them, so none of their readings is dropped. Iterating throws ``RecordingSourceError`` where the
/// recording is not in order.
public struct RecordingSource: MagneticFieldSource {
    private let name: String
    private let open: @Sendable () throws -> Data
    private let speed: Double?
    private let courses: HeadedAxis?
    private let clock: any PlayingClock

    /// - Parameters:
    ///   - name: said in errors
    ///   - speed: 1 plays at the recording's own pace, 2 twice as fast, above 0; nil: as fast as it is read
    ///   - courses: what of the phone pointed along the courses; nil: they are passed over
    ///   - open: gives the text anew for every iterator
    public init(
        name: String, speed: Double? = nil, courses: HeadedAxis? = nil, open: @escaping @Sendable () throws -> Data
    ) {
        self.init(name: name, speed: speed, courses: courses, clock: SystemClock(), open: open)
    }

    /// A file, `.csv`; a `.csv.gz` must be decompressed before.
    ///
    /// - Parameters:
    ///   - url: the file
    ///   - speed: 1 plays at the recording's own pace, 2 twice as fast, above 0; nil: as fast as it is read
    ///   - courses: what of the phone pointed along the courses; nil: they are passed over
    public init(url: URL, speed: Double? = nil, courses: HeadedAxis? = nil) {
        self.init(name: url.lastPathComponent, speed: speed, courses: courses) {
            try Data(contentsOf: url, options: .alwaysMapped)
        }
    }

    init(
        name: String, speed: Double?, courses: HeadedAxis? = nil, clock: any PlayingClock,
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

/// What a recording is played by; a test has its own.
protocol PlayingClock: Sendable {
    var nowNs: Int64 { get }

    func sleep(forNs: Int64) async throws
}

struct SystemClock: PlayingClock {
    var nowNs: Int64 { Int64(DispatchTime.now().uptimeNanoseconds) }

    // not by a deadline, which iOS 15 lacks
    func sleep(forNs ns: Int64) async throws { try await Task.sleep(nanoseconds: UInt64(ns)) }
}

/// When a row is due.
struct Pace {
    private let source: String
    private let speed: Double
    private let clock: any PlayingClock
    /// Time of the first row, and when it was read.
    private var start: (rowNs: Int64, nowNs: Int64)?

    /// - Parameter source: named in errors
    init(_ source: String, speed: Double, clock: any PlayingClock) {
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
    private static let time = ["t_s"], magnetic = ["mx", "my", "mz"], up = ["ax", "ay", "az"], rate = ["gx", "gy", "gz"]
    private static let system = ["sys_mx", "sys_my", "sys_mz"], course = ["course_deg", "course_sigma_deg"]

    let name: String
    let open: @Sendable () throws -> Data
    private let courses: HeadedAxis?
    private var pace: Pace?
    private var lines: Lines?
    private var columns: [String: Int] = [:]
    private var width = 0
    private var line = 0
    /// What is wrong with the row after those that were given.
    private var failure: (any Error)?

    init(name: String, pace: Pace?, courses: HeadedAxis?, open: @escaping @Sendable () throws -> Data) {
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
            throw RecordingSourceError(
                name: name, line: 1, column: nil, problem: "it is compressed; decompress it with gunzip")
        }
        lines = Lines(data: data)
        guard let header = nextLine() else {
            throw RecordingSourceError(name: name, line: 1, column: nil, problem: "the header is missing")
        }
        // spreadsheets write a mark first
        let names = cells(header.hasPrefix("\u{FEFF}") ? String(header.dropFirst()) : header)
        width = names.count
        columns = Dictionary(zip(names, 0...), uniquingKeysWith: { first, _ in first })
        for column in ["t_s"] + Self.magnetic where columns[column] == nil {
            throw wrong(column, "the column is missing")
        }
        for group in [Self.time, Self.magnetic, Self.up, Self.rate, Self.system, Self.course] {
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
        let time = try number("t_s", cells)
        guard let timeNs = Int64(exactly: (time * 1e9).rounded()) else {
            throw wrong("t_s", "the time is no number of seconds that fits 64 bits of nanoseconds")
        }
        var row: [SensorSample] = []
        if let rate = try vector(Self.rate, cells) {
            row.append(.rotationRate(RotationRateSample(timeNs: timeNs, rateRadS: rate)))
        }
        if let up = try vector(Self.up, cells) { row.append(.up(UpSample(timeNs: timeNs, upMS2: up))) }
        if let field = try vector(Self.system, cells) {
            // a recording does not say how sure the system was, so nothing begins with it
            row.append(.systemField(SystemFieldSample(timeNs: timeNs, fieldUt: field, accuracy: .uncalibrated)))
        }
        if let headed = courses, let course = try numbers(Self.course, cells) {
            row.append(
                .heading(
                    HeadingSample(
                        timeNs: timeNs, headingDeg: course[0], sigmaDeg: course[1], reference: .true, axis: headed)))
        }
        if let field = try vector(Self.magnetic, cells) {
            row.append(.magnetic(MagneticSample(timeNs: timeNs, fieldUt: field)))
        }
        events += row
    }

    private func vector(_ names: [String], _ cells: [String]) throws -> DeviceVector? {
        try numbers(names, cells).map { DeviceVector(x: $0[0], y: $0[1], z: $0[2]) }
    }

    /// Nil where the sensor has no columns, or said nothing: all its cells are empty then.
    private func numbers(_ names: [String], _ cells: [String]) throws -> [Double]? {
        if names.allSatisfy({ columns[$0].map { cells[$0].isEmpty } ?? true }) { return nil }
        return try names.map { try number($0, cells) }
    }

    private func number(_ column: String, _ cells: [String]) throws -> Double {
        let text = cells[columns[column]!]
        guard let value = Double(text) else {
            throw wrong(
                column, text.isEmpty ? "an empty cell, where others of the sensor have numbers" : "'\(text)' is no number")
        }
        return value
    }

    private func cells(_ text: String) -> [String] {
        text.split(separator: ",", omittingEmptySubsequences: false).map { $0.trimmingCharacters(in: .whitespaces) }
    }

    private func wrong(_ column: String?, _ problem: String) -> RecordingSourceError {
        RecordingSourceError(name: name, line: line, column: column, problem: problem)
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
