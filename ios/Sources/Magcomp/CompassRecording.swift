import Foundation

extension Compass {
    /// Records all that the estimator is given from now on: events, courses, poses, the screen's turns, sleep, and the calibration that is
    /// taken over. Begun before the first reading, the recording plays as it was; begun later, its first readings differ, since what
    /// was learned before goes into it as a kept calibration alone.
    ///
    /// - Parameters:
    ///   - url: a file, `.csv`; where there is one already, the next free name
    ///   - mostBytes: where the recording ends by itself, over all its files, at least 10 000. Default 200 MB
    /// - Returns: what ends it: ``Recording/close()``
    /// - Throws: the system's error where the file can't be made; `MagcompError.config` for `mostBytes` out of range, or while another
    ///   recording goes on
    @discardableResult
    public func record(to url: URL, mostBytes: Int = 200_000_000) throws -> Recording {
        try estimation.record { try Recording(to: url, mostBytes: mostBytes) }
    }

    /// A recording of all that a compass's estimator is given: `docs/dev/RECORDING_FILE.md` has the columns. Rows stand in the order in which
    /// it was given, each later than the one before; played by ``RecordingSource``, every reading is the one that was live.
    ///
    /// It goes on until it is closed, whether or not its object is kept, through any number of runs of the sensors. A file that is there already
    /// is never touched: the next free name is taken, `NAME-2.csv`; another clock begins another file too.
    public final class Recording: Sendable {
        private struct State {
            var urls: [URL] = []
            var file: FileHandle?
            var bytes = 0
            var text: [UInt8] = []
            var row: Row?
            /// Of the latest row that was begun.
            var rowNs: Int64?
            /// What goes into the next row.
            var notes = Row()
            var runs = 0
            var isOver = false
            var failure: (any Error)?
        }

        /// As few writes as a crash can bear: about half a second.
        private static let chunk = 16_384
        /// Limit: what the cells of one row take beside a calibration.
        private static let longestRow = 1_000

        private let url: URL
        private let mostBytes: Int
        private let create: @Sendable (String) -> Int32
        private let state = Locked(State())
        /// Writes in order, while no sample waits for it.
        private let queue = DispatchQueue(label: "org.magcomp.recording", qos: .utility)

        /// - Parameter create: makes a file that is not there and opens it; a descriptor, or -1 with `errno`
        init(
            to url: URL, mostBytes: Int,
            create: @escaping @Sendable (String) -> Int32 = { systemOpen($0, O_WRONLY | O_CREAT | O_EXCL, 0o644) }
        ) throws {
            guard mostBytes >= 10_000 else {
                throw MagcompError.config(field: "mostBytes", value: "\(mostBytes)", expected: "at least 10000")
            }
            (self.url, self.mostBytes, self.create) = (url, mostBytes, create)
            try state.change { try open(&$0) }
        }

        deinit {
            state.change { state in
                if !state.isOver { end(&state) }
            }
        }

        /// The files so far, the first one first.
        public var urls: [URL] { state.value.urls }

        /// Whether it has ended: it was closed, is as large as it may be, or its file could not be written.
        public var isOver: Bool { state.value.isOver }

        /// Ends it, and waits until all of it is in the file. May be called twice, from any thread.
        ///
        /// - Throws: why the file could not be written; what was written before stays
        public func close() throws {
            state.change { state in
                if !state.isOver { end(&state) }
            }
            queue.sync {}
            if let failure = state.value.failure { throw failure }
        }

        // Called by the estimation, in the order of what it was given.

        /// A row of another clock would be earlier than those before: another file begins.
        func beginClock() {
            state.change { state in
                if state.isOver { return }
                flush(&state, all: true)
                do { try open(&state) } catch { Self.fail(&state, error) }
            }
        }

        func beginRun() {
            state.change { state in
                state.runs += 1
                note(.run, "\(state.runs)", &state)
            }
        }

        func reset() { state.change { note(.reset, "1", &$0) } }

        func kept(_ text: String, unixTimeS: Int64) {
            state.change { note(.kept, "\(Self.quoted(text)),\(unixTimeS)", &$0) }
        }

        func frame(_ frame: HeadingFrame) {
            let declination = frame.declinationDeg.map { "\($0)" } ?? "nan"
            state.change { note(.frame, "\(frame.axis.cell),\(frame.screenRotation.cell),\(declination)", &$0) }
        }

        func slept(_ seconds: Double) { state.change { note(.slept, "\(seconds)", &$0) } }

        func take(_ event: SensorSample) {
            func vector(_ v: DeviceVector) -> String { "\(v.x),\(v.y),\(v.z)" }
            state.change { state in
                switch event {
                case .magnetic(let sample):
                    let reported = sample.reportedHardIronUt.map(vector) ?? ",,"
                    add(.magnetic, "\(vector(sample.fieldUt)),\(reported)", sample.timeNs, &state)
                case .up(let sample): add(.up, vector(sample.upMS2), sample.timeNs, &state)
                case .rotationRate(let sample): add(.rate, vector(sample.rateRadS), sample.timeNs, &state)
                case .systemField(let sample):
                    add(.system, "\(vector(sample.fieldUt)),\(sample.accuracy.cell)", sample.timeNs, &state)
                case .heading(let sample):
                    let north = sample.reference == .true ? "" : "magnetic"
                    add(
                        .course, "\(sample.headingDeg),\(sample.sigmaDeg),\(north),\(sample.axis.cell)", sample.timeNs,
                        &state)
                case .attitude(let sample):
                    let yaw =
                        switch sample.yaw {
                        case .relative: ","
                        case .absolute(let sigmaDeg, let reference): "\(sigmaDeg),\(reference.cell)"
                        }
                    add(.pose, "\(sample.w),\(sample.x),\(sample.y),\(sample.z),\(yaw)", sample.timeNs, &state)
                // the estimation tells them itself
                case .note: break
                }
            }
        }

        // Inside the lock.

        private func open(_ state: inout State) throws {
            var (next, number) = (url, 1)
            var descriptor = create(next.path)
            while descriptor < 0, errno == EEXIST {
                number += 1
                let name = "\(url.deletingPathExtension().lastPathComponent)-\(number)"
                next = url.deletingLastPathComponent().appendingPathComponent(name).appendingPathExtension(url.pathExtension)
                descriptor = create(next.path)
            }
            guard descriptor >= 0 else {
                let why = "\(next.path) can't be written: \(String(cString: strerror(errno)))"
                throw CocoaError(
                    .fileWriteUnknown, userInfo: [NSFilePathErrorKey: next.path, NSLocalizedDescriptionKey: why])
            }
            state.urls.append(next)
            state.file = FileHandle(fileDescriptor: descriptor, closeOnDealloc: true)
            (state.row, state.rowNs, state.notes, state.runs) = (nil, nil, Row(), 0)
            state.text += (RecordedColumn.names.joined(separator: ",") + "\n").utf8
            flush(&state, all: true)
            note(
                .about, Self.quoted("magcomp; \(machine()), \(ProcessInfo.processInfo.operatingSystemVersionString)"), &state
            )
        }

        /// A cell of any text. A line of CSV is one line.
        private static func quoted(_ text: String) -> String {
            let line = String(String.UnicodeScalarView(text.unicodeScalars.map { $0 == "\n" || $0 == "\r" ? " " : $0 }))
            return "\"\(line.replacingOccurrences(of: "\"", with: "\"\""))\""
        }

        /// One that does not fit what waits already has a row for it alone.
        private func note(_ group: RecordedColumn, _ cells: String, _ state: inout State) {
            if state.isOver { return }
            if !state.notes.fits(group) { endNotes(&state) }
            state.notes.put(group, cells)
        }

        private func endNotes(_ state: inout State) {
            endRow(&state)
            let timeNs = after(&state)
            state.row = state.notes
            state.row?.timeNs = timeNs
            state.notes = Row()
            endRow(&state)
        }

        private func add(_ group: RecordedColumn, _ cells: String, _ timeNs: Int64, _ state: inout State) {
            if state.isOver { return }
            if !state.notes.fits(group) { endNotes(&state) }
            let first = state.notes.first ?? group
            if let row = state.row, row.ownNs == timeNs, row.fits(first) {
                let notes = state.notes.cells
                for (group, cells) in notes { state.row?.put(group, cells) }
            } else {
                endRow(&state)
                // help may be of any time: others come at theirs after it
                let isHelp = group == .course || group == .pose
                let isLater = !isHelp && timeNs > state.rowNs ?? .min
                var row = state.notes
                (row.timeNs, row.ownNs) = (isLater ? timeNs : after(&state), timeNs)
                state.row = row
            }
            if state.notes.first != nil { state.notes = Row() }
            state.rowNs = state.row?.timeNs
            state.row?.put(group, cells)
            if state.text.count >= Self.chunk { flush(&state) }
        }

        private func after(_ state: inout State) -> Int64 {
            let timeNs = state.rowNs.map { $0 == .max ? $0 : $0 + 1 } ?? 0
            state.rowNs = timeNs
            return timeNs
        }

        private func endRow(_ state: inout State) {
            guard let row = state.row else { return }
            state.row = nil
            state.text += row.text.utf8
            if state.bytes + state.text.count > mostBytes - Self.longestRow { end(&state) }
        }

        private func end(_ state: inout State) {
            flush(&state, all: true)
            (state.isOver, state.file) = (true, nil)
        }

        private static func fail(_ state: inout State, _ error: any Error) {
            (state.isOver, state.failure, state.file, state.text) = (true, state.failure ?? error, nil, [])
        }

        /// Hands what waits to the queue; with `all` also the row that is not complete yet, and notes that no event has followed.
        private func flush(_ state: inout State, all: Bool = false) {
            if all {
                if let row = state.row { state.text += row.text.utf8 }
                state.row = nil
                if state.notes.first != nil {
                    state.notes.timeNs = after(&state)
                    state.text += state.notes.text.utf8
                    state.notes = Row()
                }
            }
            guard let file = state.file, !state.text.isEmpty else { return }
            let text = state.text
            state.bytes += text.count
            state.text.removeAll(keepingCapacity: true)
            queue.async { [shared = self.state] in
                do { try file.write(contentsOf: text) } catch { shared.change { Self.fail(&$0, error) } }
            }
        }

        /// A line that grows. Its cells are given in the order of the groups.
        private struct Row {
            var timeNs: Int64 = 0
            var ownNs: Int64?
            private(set) var cells: [(RecordedColumn, String)] = []

            var first: RecordedColumn? { cells.first?.0 }

            /// Whether what comes stands behind all that is there, so that it is read in the order in which it came.
            func fits(_ group: RecordedColumn) -> Bool { cells.last.map { $0.0.rawValue < group.rawValue } ?? true }

            mutating func put(_ group: RecordedColumn, _ text: String) { cells.append((group, text)) }

            var text: String {
                var line = seconds(timeNs) + ","
                if let ownNs, ownNs != timeNs { line += seconds(ownNs) }
                var next = cells.makeIterator()
                var cell = next.next()
                for group in RecordedColumn.allCases {
                    line += ","
                    if let (there, text) = cell, there == group {
                        line += text
                        cell = next.next()
                    } else {
                        line += String(repeating: ",", count: group.names.count - 1)
                    }
                }
                return line + "\n"
            }
        }
    }
}

/// Groups of cells of a recording, in the order in which a row's are told.
enum RecordedColumn: Int, CaseIterable {
    case about, reset, kept, run, course, pose, rate, up, system, slept, frame, magnetic

    static let names = ["t_s", "own_t_s"] + allCases.flatMap(\.names)

    /// Cells of which a row has all or none.
    var groups: [[String]] {
        switch self {
        case .about: [["about"]]
        case .run: [["run"]]
        case .reset: [["reset"]]
        case .kept: [["kept", "unix_s"]]
        case .course: [["course_deg", "course_sigma_deg"], ["course_north"], ["course_of"]]
        case .pose: [["pose_w", "pose_x", "pose_y", "pose_z"], ["pose_yaw_sigma_deg"], ["pose_north"]]
        case .rate: [["gx", "gy", "gz"]]
        case .up: [["ax", "ay", "az"]]
        case .system: [["sys_mx", "sys_my", "sys_mz"], ["sys_accuracy"]]
        case .slept: [["slept_s"]]
        case .frame: [["axis", "screen_deg", "declination_deg"]]
        case .magnetic: [["mx", "my", "mz"], ["reported_bx", "reported_by", "reported_bz"]]
        }
    }

    var names: [String] { groups.flatMap { $0 } }
}

/// What stands in a cell for one of a few values.
protocol Celled: Hashable {
    static var ofCells: [String: Self] { get }
}

extension Celled {
    fileprivate var cell: String { Self.ofCells.first { $0.value == self }?.key ?? "" }
}

extension HeadingFrame.ReferenceAxis: Celled {
    static let ofCells: [String: Self] = ["top": .topEdge, "camera": .camera, "auto": .auto]
}

extension HeadingFrame.ScreenRotation: Celled {
    static let ofCells: [String: Self] = ["0": .deg0, "90": .deg90, "180": .deg180, "270": .deg270]
}

extension CompassHeading.NorthReference: Celled {
    static let ofCells: [String: Self] = ["true": .true, "magnetic": .magnetic]
}

extension SensorSample.SystemField.Accuracy: Celled {
    /// As Android's numbers of a sensor's accuracy.
    static let ofCells: [String: Self] = ["0": .uncalibrated, "1": .low, "2": .medium, "3": .high]
}

extension SensorSample.HeadedAxis {
    fileprivate var cell: String {
        switch self {
        case .vehicle: "vehicle"
        case .device(let axis): "\(axis.x) \(axis.y) \(axis.z)"
        }
    }

    init?(cell: String) {
        let numbers = cell.split(separator: " ").map { Double($0) }
        if cell == "vehicle" {
            self = .vehicle
        } else if numbers.count == 3, let x = numbers[0], let y = numbers[1], let z = numbers[2] {
            self = .device(axis: DeviceVector(x: x, y: y, z: z))
        } else {
            return nil
        }
    }
}

/// Seconds with all their nanoseconds.
private func seconds(_ timeNs: Int64) -> String {
    let (seconds, ns) = timeNs.quotientAndRemainder(dividingBy: 1_000_000_000)
    let digits = String(ns.magnitude)
    return "\(timeNs < 0 ? "-" : "")\(seconds.magnitude).\(String(repeating: "0", count: 9 - digits.count))\(digits)"
}

/// The device's model, such as `iPhone16,2`.
private func machine() -> String {
    var name = utsname()
    uname(&name)
    return withUnsafeBytes(of: &name.machine) { String(decoding: $0.prefix { $0 != 0 }, as: UTF8.self) }
}

// `FileHandle` has a method of this name
@Sendable private func systemOpen(_ path: String, _ flags: Int32, _ mode: mode_t) -> Int32 { open(path, flags, mode) }
