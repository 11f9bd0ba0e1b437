/// Readings, one for every magnetometer sample. Events run while anybody iterates: they begin when an iterator is first asked for a
/// reading, and stop when the last iterator is freed or its task is cancelled.
public struct CompensatedReadings: AsyncSequence, Sendable {
    public typealias Element = CompensatedReading

    private let begin: @Sendable () -> Place

    init(_ begin: @escaping @Sendable () -> Place) { self.begin = begin }

    public func makeAsyncIterator() -> AsyncIterator { AsyncIterator(begin: begin) }

    public struct AsyncIterator: AsyncIteratorProtocol {
        let begin: @Sendable () -> Place
        private var place: Place?

        init(begin: @escaping @Sendable () -> Place) { self.begin = begin }

        /// Events run, and readings are kept for it from now on.
        mutating func start() { place = place ?? begin() }

        public mutating func next() async throws -> CompensatedReading? { try await next(isolation: nil) }

        /// As ``next()``, on the caller's actor.
        public mutating func next(isolation actor: isolated (any Actor)?) async throws -> CompensatedReading? {
            // who was cancelled before it began starts nothing
            if place == nil, Task.isCancelled { return nil }
            start()
            return try await place?.next(isolation: actor)
        }
    }
}

extension AsyncSequence where Self: Sendable, Element == SensorSample {
    /// Compensates a sequence of sensor events: one reading for every magnetometer sample.
    ///
    /// Every iterator has its own ``Compensator``, fed in the background; those of one ``Compass`` share theirs. A slow
    /// iterator never holds up events of sensors: a buffer drops the oldest reading and counts it. Events that can wait
    /// (``SensorSamples/isLive``), those of a ``RecordingSource``, wait for it instead. An error of the config is thrown to the
    /// iterator.
    ///
    /// - Parameters:
    ///   - config: a field left out has the library's default
    ///   - store: where the calibration is kept from one launch to the next; nil: nowhere
    ///   - capacity: readings kept for a slow iterator, at least 1
    ///   - frame: the heading frame in force at each moment; nil: the config's
    public func compensated(
        _ config: CompensationConfig = CompensationConfig(),
        store: (any CalibrationStore)? = nil,
        capacity: Int = 64,
        frame: (@Sendable () -> HeadingFrame)? = nil
    ) -> CompensatedReadings {
        let events = (self as? SensorSamples) ?? SensorSamples { self }
        return CompensatedReadings {
            Readers(of: { events }, by: Estimation(config, store: store, frame: frame), graceS: 0).place(capacity: capacity)
        }
    }
}
