/// Where events come from: a phone's sensors (``CoreMotionSource``), a recording (``RecordingSource``), or your own.
public protocol MagneticFieldSource: Sendable {
    /// The events, each sensor's in the order of their times. Cold: every iterator starts its own when it is first asked for an event,
    /// and ends it when it is freed or its task is cancelled, which must not take long. No event may be dropped on the way.
    func samples() -> SensorSamples

    /// Seconds that have passed so far and that the events' times do not show, because the phone slept; never less than before.
    /// Read with every magnetometer sample; what it grew by goes to ``Compensator/pushGap(hiddenS:)``. By default 0.
    var hiddenS: Double { get }
}

extension MagneticFieldSource {
    public var hiddenS: Double { 0 }
}

/// One event of one of the sensors, with its own time.
public enum SensorSample: Equatable, Codable, Sendable {
    /// A raw magnetometer event.
    case magnetic(Magnetic)
    /// A gyroscope event.
    case rotationRate(RotationRate)
    /// An accelerometer or gravity event.
    case up(Up)
    /// The operating system's own calibrated field. A compensator does not use it; a ``Compass`` takes from it a first hard
    /// iron, where it has no better.
    case systemField(SystemField)
    /// A heading from outside, as a recording has it; an app tells its own by `Compass.aid`.
    case heading(Heading)
    /// An orientation from outside, as a recording has it; an app tells its own by `Compass.aid`.
    case attitude(Attitude)
    /// What else the compass was told, as a recording has it.
    indirect case note(Note)

    /// Time of the event, nanoseconds, on one clock for all sensors.
    public var timeNs: Int64 {
        switch self {
        case .magnetic(let sample): sample.timeNs
        case .rotationRate(let sample): sample.timeNs
        case .up(let sample): sample.timeNs
        case .systemField(let sample): sample.timeNs
        case .heading(let sample): sample.timeNs
        case .attitude(let sample): sample.timeNs
        case .note(let note): note.timeNs
        }
    }

    /// Whether it is no sensor's.
    var isNote: Bool { if case .note = self { true } else { false } }
}

extension SensorSample {
    /// What a compass was told besides events, at its place among them: how long the phone slept, the heading's frame, a calibration that was
    /// taken over, a reset, a new run of the sensors. A ``RecordingSource`` gives them, so that its readings are those of the compass that
    /// was recorded.
    public struct Note: Equatable, Codable, Sendable {
        enum What: Equatable, Codable, Sendable {
            case run, reset
            case kept(text: String, unixTimeS: Int64)
            case slept(seconds: Double)
            case frame(HeadingFrame)
        }

        /// Time of the recording's row, nanoseconds.
        public let timeNs: Int64
        let what: What
    }

    /// The field as the operating system has calibrated it.
    public struct SystemField: Equatable, Codable, Sendable {
        /// How well the operating system says that it is calibrated.
        public enum Accuracy: String, Equatable, Codable, Sendable {
            case uncalibrated, low, medium, high
        }

        /// Time of the event, nanoseconds, on the magnetometer's clock.
        public var timeNs: Int64
        /// The calibrated field, microtesla, device frame.
        public var fieldUt: DeviceVector
        /// How well it is calibrated.
        public var accuracy: Accuracy

        public init(timeNs: Int64, fieldUt: DeviceVector, accuracy: Accuracy) {
            self.timeNs = timeNs
            self.fieldUt = fieldUt
            self.accuracy = accuracy
        }
    }
}

/// Events of the sensors, from any sequence of them. Every iterator makes its own.
public struct SensorSamples: AsyncSequence, Sendable {
    public typealias Element = SensorSample

    /// Whether events come whether or not anybody is ready for them, as a sensor's do; those of a recording wait.
    public let isLive: Bool

    private let begin: @Sendable () -> AsyncIterator
    /// Of sensors that call: events need no task on their way.
    let listen: Listen?

    /// Takes the events of a source that calls, on the thread they come on, and its end.
    struct Listener: Sendable {
        let take: @Sendable ([SensorSample]) -> Void
        let end: @Sendable ((any Error)?) -> Void
    }

    /// Begins to call a listener; what it gives back ends that.
    typealias Listen = @Sendable (Listener) -> @Sendable () -> Void

    /// Events of a source that calls whoever listens, one call at a time.
    static func calls(_ listen: @escaping Listen) -> SensorSamples {
        SensorSamples(
            true,
            {
                // no event is dropped before the estimator
                AsyncThrowingStream<[SensorSample], any Error>(bufferingPolicy: .unbounded) { stream in
                    let stop = listen(Listener(take: { stream.yield($0) }, end: { stream.finish(throwing: $0) }))
                    stream.onTermination = { _ in stop() }
                }
            }, { $0.append(contentsOf: $1) }, listen)
    }

    /// - Parameters:
    ///   - isLive: whether events come whether or not anybody is ready for them
    ///   - make: makes the sequence anew for every iterator
    public init<S: AsyncSequence>(
        isLive: Bool = true, _ make: @escaping @Sendable () -> S
    ) where S.Element == SensorSample {
        self.init(isLive, make) { $0.append($1) }
    }

    /// As ``init(isLive:_:)``, from a sequence that has several events at once: their readings go to who iterates together, which costs
    /// less.
    package static func batches<S: AsyncSequence>(
        isLive: Bool = true, _ make: @escaping @Sendable () -> S
    ) -> SensorSamples where S.Element == [SensorSample] {
        SensorSamples(isLive, make) { $0.append(contentsOf: $1) }
    }

    private init<S: AsyncSequence>(
        _ isLive: Bool, _ make: @escaping @Sendable () -> S,
        _ append: @escaping @Sendable (inout [SensorSample], S.Element) -> Void, _ listen: Listen? = nil
    ) {
        (self.isLive, self.listen) = (isLive, listen)
        begin = {
            var iterator: S.AsyncIterator?
            func start() { iterator = iterator ?? make().makeAsyncIterator() }
            return AsyncIterator(start: start) { events in
                start()
                guard let next = try await iterator?.next() else { return false }
                append(&events, next)
                return true
            }
        }
    }

    public func makeAsyncIterator() -> AsyncIterator { begin() }

    public struct AsyncIterator: AsyncIteratorProtocol {
        /// Begins before the first event is asked for.
        let start: () -> Void
        /// Appends what comes next; false at the end.
        let advance: (inout [SensorSample]) async throws -> Bool
        /// What came with the latest, the next one last.
        private var waiting: [SensorSample] = []

        fileprivate init(start: @escaping () -> Void, advance: @escaping (inout [SensorSample]) async throws -> Bool) {
            (self.start, self.advance) = (start, advance)
        }

        public mutating func next() async throws -> SensorSample? {
            while waiting.isEmpty {
                guard try await advance(&waiting) else { return nil }
                waiting.reverse()
            }
            return waiting.popLast()
        }
    }
}
