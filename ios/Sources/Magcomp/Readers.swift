import Foundation

/// One estimation and everyone who reads it: its events run while anybody does, those of sensors a little longer.
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
        /// The run's latest reading.
        var latest: CompensatedReading?
        /// Whether the run's events come whether or not anybody is ready for them.
        var isLive = false
        /// How long the run goes on when nobody reads; a recording's ends at once.
        var graceS: Double
        /// Counts the times that nobody was left.
        var leaves = 0

        /// Whether the run goes on for nobody.
        var isIdle: Bool { running && !readers.values.contains { $0.run == run } }
    }

    private let events: @Sendable () -> SensorSamples
    private let estimation: Estimation
    private let patienceS: Double
    private let state: Locked<State>

    /// - Parameters:
    ///   - graceS: how long sensors run on after the last reader has left, seconds
    ///   - patienceS: how long events that can wait do so for a reader that asks for nothing while others read, seconds; up to twice that
    init(
        of events: @escaping @Sendable () -> SensorSamples, by estimation: Estimation, graceS: Double, patienceS: Double = 5
    ) {
        (self.events, self.estimation, self.patienceS) = (events, estimation, patienceS)
        state = Locked(State(graceS: graceS))
    }

    /// The latest reading while events run.
    var latest: CompensatedReading? { state.value.latest }

    /// Nobody can begin to read any more.
    func endGrace() {
        let over = state.change { state -> Task<Void, Never>? in
            state.graceS = 0
            return state.isIdle ? Self.over(&state) : nil
        }
        over?.cancel()
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
        let (over, grace) = state.change { state -> (Task<Void, Never>?, (leave: Int, seconds: Double)?) in
            guard state.readers.removeValue(forKey: number)?.run == state.run, state.isIdle else { return (nil, nil) }
            state.leaves += 1
            return state.graceS > 0 && state.isLive ? (nil, (state.leaves, state.graceS)) : (Self.over(&state), nil)
        }
        // outside the lock: a source may do anything when it is told to end
        over?.cancel()
        guard let grace else { return }
        // the app may end before the run does
        estimation.save()
        Task {
            try await Task.sleep(nanoseconds: UInt64(min(grace.seconds, 1e9) * 1e9))
            state.change { $0.isIdle && $0.leaves == grace.leave ? Self.over(&$0) : nil }?.cancel()
        }
    }

    private static func over(_ state: inout State) -> Task<Void, Never>? {
        (state.running, state.latest) = (false, nil)
        return state.feeding
    }

    /// Feeds all events of a run; the calibration is saved at its end, whatever ended it, before readers know.
    private func feed(_ run: Int) async {
        var failure: (any Error)?
        // else whoever asked has left
        if !Task.isCancelled {
            do {
                try await estimation.begin()
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
        state.change { if $0.run == run { $0.isLive = events.isLive } }
        let watching = events.isLive ? nil : Task { try await watch(run) }
        defer { watching?.cancel() }
        for try await event in events {
            // not every sequence ends with its task
            if Task.isCancelled { break }
            guard let answer = try estimation.push(event) else { continue }
            // sensors do not wait for a store, so neither do their readings
            if !events.isLive { await estimation.settledIfTold() }
            let readers = state.change { state in
                if state.run == run, state.running { state.latest = answer }
                return state.readers.values.filter { $0.run == run }
            }
            for reader in readers {
                if !events.isLive { await room(reader) }
                reader.take(answer)
            }
        }
    }

    /// Waits for a reader's room, but where others read not for one that has stopped asking.
    private func room(_ reader: Reader) async {
        var isThere = false
        while !isThere {
            if reader.hasStopped, state.value.readers.values.contains(where: { $0.run == reader.run && $0 !== reader }) {
                return
            }
            isThere = await reader.room()
        }
    }

    /// Ends what waits for too long.
    private func watch(_ run: Int) async throws {
        while true {
            try await Task.sleep(nanoseconds: UInt64(patienceS * 1e9))
            for reader in state.value.readers.values where reader.run == run { reader.losePatience() }
        }
    }

    private func end(_ run: Int, _ error: (any Error)?) {
        let ended = state.change { state in
            let ended = state.readers.filter { $0.value.run == run }
            for number in ended.keys { state.readers[number] = nil }
            if state.run == run { _ = Self.over(&state) }
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
    /// How many it had taken when it was waited for in vain.
    private var stoppedAt: Int?

    init(
        _ continuation: AsyncThrowingStream<Readers.Numbered, any Error>.Continuation, _ taken: Taken, capacity: Int
    ) {
        (self.continuation, self.taken, self.capacity) = (continuation, taken, capacity)
    }

    /// Waits until nothing need be dropped; false when that took too long.
    func room() async -> Bool {
        let isThere = await taken.atLeast(number + 1 - capacity)
        stoppedAt = isThere ? nil : taken.count
        return isThere
    }

    /// Whether it was waited for in vain and has asked for nothing since.
    var hasStopped: Bool { stoppedAt == taken.count }

    func losePatience() { taken.losePatience() }

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
        var waiting: CheckedContinuation<Bool, Never>?
        /// Counts the waits, and that which was there when it was looked last.
        var wait = 0
        var seen = 0

        mutating func wake(_ isThere: Bool) -> CheckedContinuation<Bool, Never>? {
            guard count >= wanted || !isThere else { return nil }
            defer { waiting = nil }
            return waiting
        }
    }

    private let state = Locked(State())

    var count: Int { state.value.count }

    func upTo(_ count: Int) {
        let woken = state.change { state in
            state.count = max(state.count, count)
            return state.wake(true)
        }
        woken?.resume(returning: true)
    }

    /// Nobody takes any more.
    func end() { upTo(.max) }

    /// Waits for that many; one task at a time. False when patience was lost before.
    func atLeast(_ wanted: Int) async -> Bool {
        await withCheckedContinuation { continuation in
            let woken = state.change { state in
                (state.wanted, state.waiting, state.wait) = (wanted, continuation, state.wait + 1)
                return state.wake(true)
            }
            woken?.resume(returning: true)
        }
    }

    /// Ends a wait that was there at the call before.
    func losePatience() {
        let woken = state.change { state in
            defer { state.seen = state.wait }
            return state.seen == state.wait ? state.wake(false) : nil
        }
        woken?.resume(returning: false)
    }
}
