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
        /// Grows with every batch of readings, so that silence is noticed.
        var heard = 0
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
    private let clock: any WaitingClock
    private let state: Locked<State>
    /// How long events that can wait do so for a reader that asks for nothing while others read; up to twice that.
    private static let patienceNs: Int64 = 5_000_000_000
    /// After how long without a sample readers of a live source are told; up to a quarter, a look, later.
    private static let silenceNs: Int64 = 2_000_000_000
    private static let looks = 4

    /// - Parameter graceS: how long sensors run on after the last reader has left, seconds
    init(
        of events: @escaping @Sendable () -> SensorSamples, by estimation: Estimation, graceS: Double,
        clock: any WaitingClock
    ) {
        (self.events, self.estimation, self.clock) = (events, estimation, clock)
        state = Locked(State(graceS: graceS))
    }

    /// The latest reading while events run.
    var latest: CompensatedReading? { state.change { $0.latest } }

    /// Whether the latest run's events came whether or not anybody was ready for them.
    var isLive: Bool { state.change { $0.isLive } }

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
            // a screen begins with what is known
            if rateHz != nil, let latest = state.latest { _ = reader.take([latest], waits: false) }
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
            try await clock.sleep(forNs: Int64(min(grace.seconds, 1e9) * 1e9))
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
        let watching = Task { try await events.isLive ? watchForSilence(run) : watch() }
        defer { watching.cancel() }
        if let listen = events.listen { return try await Calls(listen, { [self] in try hear($0, &$1, of: run) }).ended() }
        let iterator = events.makeAsyncIterator()
        var batch: [SensorSample] = []
        var answers: [CompensatedReading] = []
        // not every sequence ends with its task
        while try await iterator.advance(&batch), !Task.isCancelled {
            if events.isLive {
                try hear(batch, &answers, of: run)
            } else {
                let pushed = Result { try estimation.push(batch, isLive: false, &answers) }
                if !answers.isEmpty {
                    // sensors do not wait for a store, so neither do their readings
                    await estimation.settledIfTold()
                    for reader in readers(of: run, latest: answers[answers.count - 1]) { await fill(reader, answers) }
                    answers.removeAll(keepingCapacity: true)
                }
                try pushed.get()
            }
            batch.removeAll(keepingCapacity: true)
        }
    }

    /// Takes events of a live source: nobody waits.
    private func hear(_ events: [SensorSample], _ answers: inout [CompensatedReading], of run: Int) throws {
        let pushed = Result { try estimation.push(events, isLive: true, &answers) }
        if !answers.isEmpty {
            // outside the lock: to wake a task takes its own, which it holds when it is cancelled and leaves
            for reader in readers(of: run, latest: answers[answers.count - 1]) {
                _ = reader.take(answers[...], waits: false)
            }
            answers.removeAll(keepingCapacity: true)
        }
        try pushed.get()
    }

    /// Who gets the run's readings, the newest of which is noted.
    private func readers(of run: Int, latest: CompensatedReading) -> [Reader] {
        state.change { state in
            guard state.run == run, state.running else { return [] }
            (state.latest, state.heard) = (latest, state.heard &+ 1)
            return state.ofRun
        }
    }

    /// Tells once when a live source has delivered no sample for too long, from the run's beginning on.
    private func watchForSilence(_ run: Int) async throws {
        var (heard, quiet) = (state.change { $0.heard }, 0)
        while true {
            try await clock.sleep(forNs: Self.silenceNs / Int64(Self.looks))
            let now = state.change { $0.heard }
            (quiet, heard) = (now == heard ? quiet + 1 : 0, now)
            guard quiet == Self.looks else { continue }
            let silent = estimation.silent(after: latest)
            // one more sample may have come meanwhile: then nobody is silent
            let readers = state.change { state -> [Reader] in
                guard state.run == run, state.running, state.heard == heard else { return [] }
                state.latest = silent
                return state.ofRun
            }
            for reader in readers { _ = reader.take([silent], waits: false) }
        }
    }

    /// Gives readings to a reader; they wait for its room, but where others read not for one that has stopped asking.
    private func fill(_ reader: Reader, _ answers: [CompensatedReading]) async {
        var rest = reader.take(answers[...], waits: true)
        while !rest.isEmpty {
            let isGivenUp = reader.hasStopped && state.value.ofRun.contains { $0.run == reader.run && $0 !== reader }
            if !isGivenUp { await reader.room() }
            rest = reader.take(rest, waits: !isGivenUp)
        }
    }

    /// Ends what waits for too long.
    private func watch() async throws {
        while true {
            try await clock.sleep(forNs: Self.patienceNs)
            for reader in state.value.ofRun { reader.losePatience() }
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

/// The run of a source that calls: it lasts until the source ends, pushing fails, or the task is cancelled.
private final class Calls: Sendable {
    private struct State {
        var stop: (@Sendable () -> Void)?
        var waiting: CheckedContinuation<Void, any Error>?
        var end: Result<Void, any Error>?
    }

    private let listen: SensorSamples.Listen
    private let push: @Sendable ([SensorSample], inout [CompensatedReading]) throws -> Void
    private let state = Locked(State())
    /// Of one call at a time.
    private let answers = Locked<[CompensatedReading]>([])

    init(
        _ listen: @escaping SensorSamples.Listen,
        _ push: @escaping @Sendable ([SensorSample], inout [CompensatedReading]) throws -> Void
    ) {
        (self.listen, self.push) = (listen, push)
    }

    func ended() async throws {
        // nothing is pushed after a run's end
        defer { answers.change { _ in } }
        try await withTaskCancellationHandler {
            try await wait()
        } onCancel: {
            end(nil)
        }
    }

    private func wait() async throws {
        try await withCheckedThrowingContinuation { continuation in
            let stop = listen(SensorSamples.Listener(take: { self.take($0) }, end: { self.end($0) }))
            let end = state.change { state in
                if state.end == nil { (state.stop, state.waiting) = (stop, continuation) }
                return state.end
            }
            guard let end else { return }
            stop()
            continuation.resume(with: end)
        }
    }

    private func take(_ events: [SensorSample]) {
        do {
            try answers.change { answers in
                if state.change({ $0.end == nil }) { try push(events, &answers) }
            }
        } catch {
            end(error)
        }
    }

    private func end(_ error: (any Error)?) {
        let (stop, waiting, end) = state.change { state in
            let end = state.end ?? error.map { .failure($0) } ?? .success(())
            defer { (state.end, state.stop, state.waiting) = (end, nil, nil) }
            return (state.stop, state.waiting, end)
        }
        // outside the lock: a source may do anything when it is told to end
        stop?()
        waiting?.resume(with: end)
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
