import Foundation

extension MagneticFieldSource {
    /// The same events, each written to a file as it goes out: a recording that ``RecordingSource``, `magcomp replay` and a bug report take.
    /// `Compass(source: CoreMotionSource(options: .compass).recorded(to: url))`.
    ///
    /// Every run of the events writes the file anew. Events of one time are one row, in which other sensors' cells are empty; an event that
    /// is older than the row before, or the second of its sensor at one time, is not written. A file that can't be written ends the events with
    /// its error.
    ///
    /// - Parameter url: a file, `.csv`
    public func recorded(to url: URL) -> some MagneticFieldSource { RecordedSource(source: self, url: url) }
}

private struct RecordedSource<Source: MagneticFieldSource>: MagneticFieldSource {
    let source: Source
    let url: URL

    var hiddenS: Double { source.hiddenS }

    func samples() -> SensorSamples {
        let samples = source.samples()
        return SensorSamples.batches(isLive: samples.isLive) { [url] in Recorded(events: samples, url: url) }
    }
}

private struct Recorded: AsyncSequence {
    typealias Element = [SensorSample]

    let events: SensorSamples
    let url: URL

    func makeAsyncIterator() -> Iterator { Iterator(events: events.makeAsyncIterator(), url: url) }

    struct Iterator: AsyncIteratorProtocol {
        var events: SensorSamples.AsyncIterator
        let url: URL
        private var file: SensorRecorder?

        init(events: SensorSamples.AsyncIterator, url: URL) { (self.events, self.url) = (events, url) }

        mutating func next() async throws -> [SensorSample]? {
            let file = try file ?? SensorRecorder(url)
            self.file = file
            var batch: [SensorSample] = []
            guard try await events.advance(&batch) else {
                try file.finish()
                return nil
            }
            for event in batch { try file.write(event) }
            return batch
        }
    }
}

/// A recording that grows; what waits is written when it is freed.
final class SensorRecorder {
    static let columns = ["mx", "my", "mz", "ax", "ay", "az", "gx", "gy", "gz", "sys_mx", "sys_my", "sys_mz"]
    private static let course = ["course_deg", "course_sigma_deg"]
    /// As few writes as a crash can bear: about half a second.
    private static let chunk = 16_384

    private let file: FileHandle
    private var text = ("t_s," + (columns + course).joined(separator: ",") + "\n").utf8.map { $0 }
    private var row: (timeNs: Int64, cells: [Double?])?

    init(_ url: URL) throws {
        try Data().write(to: url)
        file = try FileHandle(forWritingTo: url)
    }

    deinit { try? finish() }

    func write(_ event: SensorSample) throws {
        let (place, values) = Self.cells(event)
        if let row, event.timeNs < row.timeNs || (event.timeNs == row.timeNs && row.cells[place] != nil) { return }
        if row?.timeNs != event.timeNs {
            endRow()
            row = (event.timeNs, Array(repeating: nil, count: Self.columns.count + Self.course.count))
        }
        row?.cells.replaceSubrange(place..<(place + values.count), with: values)
        if text.count >= Self.chunk { try flush() }
    }

    func finish() throws {
        endRow()
        try flush()
    }

    private func flush() throws {
        try file.write(contentsOf: text)
        text.removeAll(keepingCapacity: true)
    }

    private func endRow() {
        guard let row else { return }
        self.row = nil
        let (seconds, ns) = row.timeNs.quotientAndRemainder(dividingBy: 1_000_000_000)
        let sign = row.timeNs < 0 ? "-" : ""
        let digits = String(ns.magnitude)
        text += "\(sign)\(seconds.magnitude).\(String(repeating: "0", count: 9 - digits.count))\(digits)".utf8
        for cell in row.cells { text += ("," + (cell.map { "\($0)" } ?? "")).utf8 }
        text.append(UInt8(ascii: "\n"))
    }

    /// The place of an event's cells, and their values.
    private static func cells(_ event: SensorSample) -> (Int, [Double]) {
        func vector(_ v: DeviceVector) -> [Double] { [v.x, v.y, v.z] }
        return switch event {
        case .magnetic(let sample): (0, vector(sample.fieldUt))
        case .up(let sample): (3, vector(sample.upMS2))
        case .rotationRate(let sample): (6, vector(sample.rateRadS))
        case .systemField(let sample): (9, vector(sample.fieldUt))
        case .heading(let sample): (12, [sample.headingDeg, sample.sigmaDeg])
        }
    }
}
