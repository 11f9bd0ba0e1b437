import Foundation

/// One estimation and everyone who reads it: its events run while anybody does, those of sensors a little longer.
final class Readers: Sendable {
    private struct State {
        var readers: [Int: Reader] = [:] {
            didSet { ofRun = readers.values.filter { $0.run == run } }
        }
        /// Those of the run.
        private(set) var ofRun: [Reader] = []
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
        var isIdle: Bool { running && ofRun.isEmpty }
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
    ///
    /// - Parameter rateHz: at most as many readings a second, and the last; nil: all
    func place(capacity: Int, rateHz: Double? = nil) -> Place {
        guard capacity >= 1 else {
            let none = Reader(run: 0, capacity: 1, rateHz: nil)
            none.finish(MagcompError.config(field: "capacity", value: "\(capacity)", expected: "at least 1"))
            return Place(none) {}
        }
        let (number, reader) = state.change { state in
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
            let reader = Reader(run: state.run, capacity: capacity, rateHz: rateHz)
            state.number += 1
            state.readers[state.number] = reader
            return (state.number, reader)
        }
        return Place(reader) { [self] in remove(number) }
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
        let iterator = events.makeAsyncIterator()
        var batch: [SensorSample] = []
        var answers: [CompensatedReading] = []
        // not every sequence ends with its task
        while try await iterator.advance(&batch), !Task.isCancelled {
            let pushed = Result { try estimation.push(batch, &answers) }
            batch.removeAll(keepingCapacity: true)
            if let latest = answers.last {
                // sensors do not wait for a store, so neither do their readings
                if !events.isLive { await estimation.settledIfTold() }
                let readers = state.change { state in
                    if state.run == run, state.running { state.latest = latest }
                    return state.run == run ? state.ofRun : []
                }
                for reader in readers { await fill(reader, answers, waits: !events.isLive) }
                answers.removeAll(keepingCapacity: true)
            }
            try pushed.get()
        }
    }

    /// Gives readings to a reader; those of events that can wait wait for its room, but where others read not for one that has stopped
    /// asking.
    private func fill(_ reader: Reader, _ answers: [CompensatedReading], waits: Bool) async {
        var rest = reader.take(answers[...], waits: waits)
        while !rest.isEmpty {
            let isGivenUp = reader.hasStopped && state.value.ofRun.contains { $0.run == reader.run && $0 !== reader }
            if !isGivenUp { await reader.room() }
            rest = reader.take(rest, waits: !isGivenUp)
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

/// A reader's place, which it leaves when this is freed or its task is cancelled.
final class Place: Sendable {
    private let reader: Reader
    private let leave: @Sendable () -> Void

    init(_ reader: Reader, leave: @escaping @Sendable () -> Void) { (self.reader, self.leave) = (reader, leave) }

    deinit { end() }

    func next(isolation actor: isolated (any Actor)?) async throws -> CompensatedReading? {
        try await withTaskCancellationHandler {
            try await reader.next(isolation: actor)
        } onCancel: {
            end()
        }
    }

    private func end() {
        leave()
        reader.finish()
    }
}
