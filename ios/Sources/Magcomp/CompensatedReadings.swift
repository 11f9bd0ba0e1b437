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
        package mutating func start() { place = place ?? begin() }

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
