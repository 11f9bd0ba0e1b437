import Foundation

/// One estimation and everyone who reads it: its events run while anybody does.
final class Readers: Sendable {
    typealias Numbered = (number: Int, answer: CompensatedReading)

    /// A reader's readings, and the counter of those it has taken.
    struct Place {
        let readings: AsyncThrowingStream<Numbered, any Error>
        let taken: Taken
    }

    private struct State {
        var readers: [Int: Reader] = [:]
        var number = 0
        /// Counts the runs of the events; a reader is of one run.
        var run = 0
        var running = false
        var feeding: Task<Void, Never>?
    }

    private let events: @Sendable () -> SensorSamples
    private let estimation: Estimation
    private let state = Locked(State())

    init(of events: @escaping @Sendable () -> SensorSamples, by estimation: Estimation) {
        (self.events, self.estimation) = (events, estimation)
    }

    /// A new reader's place; the first one starts the events.
    func place(capacity: Int) -> Place {
        let taken = Taken()
        let readings = AsyncThrowingStream<Numbered, any Error>(
            bufferingPolicy: .bufferingNewest(max(1, capacity))
        ) { continuation in
            guard capacity >= 1 else {
                let error = MagcompError.config(field: "capacity", value: "\(capacity)", expected: "at least 1")
                continuation.finish(throwing: error)
                return
            }
            let number = state.change { state in
                state.number += 1
                return state.number
            }
            continuation.onTermination = { [self] _ in
                taken.end()
                remove(number)
            }
            add(number, Reader(continuation, taken, capacity: capacity))
        }
        return Place(readings: readings, taken: taken)
    }

    private func add(_ number: Int, _ reader: Reader) {
        state.change { state in
            if !state.running {
                state.running = true
                state.run += 1
                let (run, before) = (state.run, state.feeding)
                state.feeding = Task {
                    // what the run before saves is there for this one
                    await before?.value
                    await feed(run)
                }
            }
            reader.run = state.run
            state.readers[number] = reader
        }
    }

    private func remove(_ number: Int) {
        let over = state.change { state -> Task<Void, Never>? in
            guard state.readers.removeValue(forKey: number)?.run == state.run, state.running,
                !state.readers.values.contains(where: { $0.run == state.run })
            else { return nil }
            state.running = false
            return state.feeding
        }
        // outside the lock: a source may do anything when it is told to end
        over?.cancel()
    }

    /// Feeds all events of a run; the calibration is saved at its end, whatever ended it, before readers know.
    private func feed(_ run: Int) async {
        var failure: (any Error)?
        // else whoever asked has left
        if !Task.isCancelled {
            do {
                await estimation.settled()
                try estimation.begin()
                try await feedAll(run)
            } catch {
                failure = error
            }
            await estimation.finish()
        }
        end(run, failure)
    }

    private func feedAll(_ run: Int) async throws {
        let events = events()
        for try await event in events {
            // not every sequence ends with its task
            if Task.isCancelled { break }
            guard let answer = try estimation.push(event) else { continue }
            await estimation.settledIfTold()
            for reader in state.value.readers.values where reader.run == run {
                if !events.isLive { await reader.room() }
                reader.take(answer)
            }
        }
    }

    private func end(_ run: Int, _ error: (any Error)?) {
        let ended = state.change { state in
            let ended = state.readers.filter { $0.value.run == run }
            for number in ended.keys { state.readers[number] = nil }
            if state.run == run { state.running = false }
            return ended.values
        }
        // outside the lock: this calls `remove`
        for reader in ended { reader.finish(error) }
    }
}

/// One reader's buffer, filled by one run's task alone.
private final class Reader: @unchecked Sendable {
    private let continuation: AsyncThrowingStream<Readers.Numbered, any Error>.Continuation
    private let taken: Taken
    private let capacity: Int
    // set before the run's task can see it
    var run = 0
    private var number = 0

    init(
        _ continuation: AsyncThrowingStream<Readers.Numbered, any Error>.Continuation, _ taken: Taken, capacity: Int
    ) {
        (self.continuation, self.taken, self.capacity) = (continuation, taken, capacity)
    }

    /// Waits until nothing need be dropped.
    func room() async { await taken.atLeast(number + 1 - capacity) }

    func take(_ answer: CompensatedReading) {
        continuation.yield((number, answer))
        number += 1
    }

    func finish(_ error: (any Error)?) { continuation.finish(throwing: error) }
}

/// How many readings a reader has taken, for events that can wait for it.
final class Taken: Sendable {
    private struct State {
        var count = 0
        var wanted = 0
        var waiting: CheckedContinuation<Void, Never>?

        mutating func wake() -> CheckedContinuation<Void, Never>? {
            guard count >= wanted else { return nil }
            defer { waiting = nil }
            return waiting
        }
    }

    private let state = Locked(State())

    func upTo(_ count: Int) {
        let woken = state.change { state in
            state.count = max(state.count, count)
            return state.wake()
        }
        woken?.resume()
    }

    /// Nobody takes any more.
    func end() { upTo(.max) }

    /// Waits for that many; one task at a time.
    func atLeast(_ wanted: Int) async {
        await withCheckedContinuation { continuation in
            let woken = state.change { state in
                (state.wanted, state.waiting) = (wanted, continuation)
                return state.wake()
            }
            woken?.resume()
        }
    }
}
