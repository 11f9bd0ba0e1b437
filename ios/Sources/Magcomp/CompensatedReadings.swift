/// The answer to one magnetometer sample, as iterators get it.
public struct CompensatedReading: Equatable, Sendable {
    /// Corrected field, heading, and what the compensator is doing.
    public var reading: Reading
    /// The raw sample it answers.
    public var sample: MagneticSample
    /// The operating system's own calibrated field, the latest before it, where the source delivers that.
    public var systemField: SystemFieldSample?
    /// Where the field has not pointed yet, unit vectors in the device frame: an app may ask for the phone to be turned so
    /// that it does. Renewed several times a second.
    public var unseenDirections: [Vector3]
    /// Readings dropped right before this one because the iterator was slow; the estimator saw every sample all the same.
    public var droppedBefore = 0
}

extension AsyncSequence where Self: Sendable, Element == SensorSample {
    /// Compensates a sequence of sensor events: one reading for every magnetometer sample.
    ///
    /// Every iterator has its own ``Compensator``, fed in the background, so a slow one never holds it up: between them a
    /// buffer drops the oldest reading and counts it. An error of the config is thrown to the iterator.
    ///
    /// - Parameters:
    ///   - config: what was left out is the library's default
    ///   - store: where the calibration is kept from one launch to the next; nil: nowhere
    ///   - capacity: readings kept for a slow iterator, at least 1
    ///   - frame: the heading frame in force at each moment; nil: the config's
    public func compensated(
        _ config: Config = Config(),
        store: (any CalibrationStore)? = nil,
        capacity: Int = 64,
        frame: (@Sendable () -> HeadingFrame)? = nil
    ) -> CompensatedReadings {
        CompensatedReadings {
            AsyncThrowingStream(bufferingPolicy: .bufferingNewest(Swift.max(1, capacity))) { continuation in
                let feeding = Task {
                    do {
                        guard capacity >= 1 else {
                            throw MagcompError.Config(field: "capacity", value: "\(capacity)", expected: "at least 1")
                        }
                        try await Estimation.run(config, store, frame, on: self) { continuation.yield($0) }
                        continuation.finish()
                    } catch {
                        continuation.finish(throwing: error)
                    }
                }
                continuation.onTermination = { _ in feeding.cancel() }
            }
        }
    }
}

/// Readings, one for every magnetometer sample. Every iterator starts its own events and its own ``Compensator``, and ends
/// them when it is freed or its task is cancelled.
public struct CompensatedReadings: AsyncSequence, Sendable {
    public typealias Element = CompensatedReading

    fileprivate typealias Numbered = (number: Int, answer: CompensatedReading)

    private let begin: @Sendable () -> AsyncThrowingStream<Numbered, any Error>

    fileprivate init(_ begin: @escaping @Sendable () -> AsyncThrowingStream<Numbered, any Error>) { self.begin = begin }

    public func makeAsyncIterator() -> AsyncIterator { AsyncIterator(numbered: begin().makeAsyncIterator()) }

    public struct AsyncIterator: AsyncIteratorProtocol {
        fileprivate var numbered: AsyncThrowingStream<Numbered, any Error>.AsyncIterator
        fileprivate var expected = 0

        public mutating func next() async throws -> CompensatedReading? {
            guard let (number, kept) = try await numbered.next() else { return nil }
            var answer = kept
            answer.droppedBefore = number - expected
            expected = number + 1
            return answer
        }
    }
}

/// One iterator's compensator.
private struct Estimation {
    /// About what a crash costs; flash memory wears out with more.
    private static let saveEveryNs = 10e9
    /// As often as an eye sees.
    private static let lookEveryNs = 0.2e9

    private let compensator: Compensator
    private let store: (any CalibrationStore)?
    private let frame: (@Sendable () -> HeadingFrame)?
    private var currentFrame: HeadingFrame?
    private var systemField: SystemFieldSample?
    private var number = 0
    /// What the store keeps, and the time of the sample it was saved at.
    private var saved: Correction?
    private var savedNs: Int64?
    private var unseen: [Vector3] = []
    private var lookedNs: Int64?

    init(_ config: Config, store: (any CalibrationStore)?, frame: (@Sendable () -> HeadingFrame)?) throws {
        compensator = try Compensator(config: config)
        (self.store, self.frame) = (store, frame)
        do {
            if let kept = store?.load() {
                try compensator.restoreCalibration(kept)
                saved = try correction()
            }
        } catch MagcompError.SnapshotDamaged, MagcompError.SnapshotNewer {
            // as at the first launch
        }
    }

    /// Feeds all events, and keeps the calibration at the end, whatever ended them.
    static func run<S: AsyncSequence>(
        _ config: Config,
        _ store: (any CalibrationStore)?,
        _ frame: (@Sendable () -> HeadingFrame)?,
        on events: S,
        answer: (CompensatedReadings.Numbered) -> Void
    ) async throws where S.Element == SensorSample {
        var estimation = try Estimation(config, store: store, frame: frame)
        defer { estimation.end() }
        for try await event in events {
            // not every sequence ends with its task
            if Task.isCancelled { break }
            if let numbered = try estimation.push(event) { answer(numbered) }
        }
    }

    mutating func push(_ event: SensorSample) throws -> CompensatedReadings.Numbered? {
        if case .systemField(let sample) = event { systemField = sample }
        guard case .magnetic(let sample) = event else {
            _ = try compensator.push(event)
            return nil
        }
        if let wanted = frame?(), wanted != currentFrame {
            try compensator.setHeadingFrame(wanted)
            currentFrame = wanted
        }
        let reading = try compensator.push(sample)
        // a time that is refused may be any
        if case .rejected = reading.status {} else { try nowAndThen(sample.timeNs, reading.status) }
        defer { number += 1 }
        let answer = CompensatedReading(
            reading: reading, sample: sample, systemField: systemField, unseenDirections: unseen)
        return (number, answer)
    }

    private mutating func nowAndThen(_ timeNs: Int64, _ status: Status) throws {
        let since = savedNs
        if since == nil, status == .tracking {
            save()
            savedNs = timeNs
        }
        if lookedNs.map({ Self.apart(timeNs, $0) >= Self.lookEveryNs }) ?? true {
            lookedNs = timeNs
            unseen = try compensator.coverage().unseenDirections
            if let since, Self.apart(timeNs, since) >= Self.saveEveryNs, save() { savedNs = timeNs }
        }
    }

    /// Nanoseconds between two times; the clock may have begun anew between them, so either may be the later.
    private static func apart(_ oneNs: Int64, _ otherNs: Int64) -> Double { abs(Double(oneNs) - Double(otherNs)) }

    /// Whether there was anything to save that the store does not keep already.
    @discardableResult
    private mutating func save() -> Bool {
        // after a defect there is nothing to keep
        guard let store, let found = try? correction(), found != saved,
            let snapshot = try? compensator.snapshotCalibration()
        else { return false }
        store.save(snapshot)
        saved = found
        return true
    }

    private func correction() throws -> Correction? {
        try compensator.calibration().map { Correction(softIron: $0.softIron, hardIronUt: $0.hardIronUt) }
    }

    /// What corrects a sample: of a calibration all but the field strength, which follows the noise of a device at rest.
    private struct Correction: Equatable {
        var softIron: SoftIron
        var hardIronUt: Vector3
    }

    mutating func end() {
        save()
        compensator.close()
    }
}
