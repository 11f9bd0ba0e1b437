/// What one reader has not taken yet. The task of one run fills it, one iterator at a time empties it; either may wait for the other.
final class Reader: Sendable {
    /// Who waits for the next reading. One who waits is resumed once: it is taken out of the state first.
    private typealias Iterating = UnsafeContinuation<CompensatedReading?, any Error>

    private struct State {
        /// From `first` on.
        var kept: [CompensatedReading] = []
        var first = 0
        /// Dropped since the latest was taken.
        var dropped = 0
        var taken = 0
        var iterating: Iterating?
        var filling: CheckedContinuation<Void, Never>?
        /// Counts the waits for room, and what there was when it was looked last.
        var wait = 0
        var seen = (wait: 0, taken: 0)
        /// How many it had taken when it was waited for in vain.
        var stoppedAt: Int?
        /// The time of the latest that was kept, and the latest that came too soon after it.
        var keptNs: Int64?
        var early: CompensatedReading?
        var isOver = false
        var failure: (any Error)?

        var count: Int { kept.count - first }

        mutating func keep(_ reading: CompensatedReading, _ capacity: Int) {
            kept.append(reading)
            guard count > capacity else { return }
            (first, dropped) = (first + 1, dropped + 1)
            if first >= capacity {
                kept.removeFirst(first)
                first = 0
            }
        }

        /// What an iterator gets; nil where it has to wait.
        mutating func next() -> Result<CompensatedReading?, any Error>? {
            guard count > 0 else {
                defer { failure = nil }
                return isOver ? failure.map { .failure($0) } ?? .success(nil) : nil
            }
            var reading = kept[first]
            (first, taken) = (first + 1, taken + 1)
            if count == 0 {
                kept.removeAll(keepingCapacity: true)
                first = 0
            }
            (reading.droppedBefore, dropped) = (dropped, 0)
            return .success(reading)
        }

        /// The iterator that waits, and what it gets.
        mutating func woken() -> (iterating: Iterating, next: Result<CompensatedReading?, any Error>)? {
            guard let iterating, let next = next() else { return nil }
            self.iterating = nil
            return (iterating, next)
        }

        mutating func filled() -> CheckedContinuation<Void, Never>? {
            defer { filling = nil }
            return filling
        }
    }

    /// Whose readings it gets.
    let run: Int
    private let capacity: Int
    private let rateHz: Double?
    private let state = Locked(State())

    /// - Parameters:
    ///   - capacity: at least 1
    ///   - rateHz: at most as many readings a second, by the times of the samples, and the last; nil: all
    init(run: Int, capacity: Int, rateHz: Double?) { (self.run, self.capacity, self.rateHz) = (run, capacity, rateHz) }

    /// Keeps readings. Where there is no more room the oldest goes, or those that are left are returned if `waits`.
    func take(_ readings: ArraySlice<CompensatedReading>, waits: Bool) -> ArraySlice<CompensatedReading> {
        let (rest, woken) = state.change { state in
            var rest = readings
            while let reading = rest.first, !waits || state.count < capacity {
                rest = rest.dropFirst()
                let timeNs = reading.sample.timeNs
                if reading.isSilent {
                    (state.keptNs, state.early) = (nil, nil)
                    state.keep(reading, capacity)
                    continue
                }
                // the clock may have begun anew since, so either may be the later
                if let rateHz, let keptNs = state.keptNs, abs(Double(timeNs) - Double(keptNs)) * rateHz < 1e9 {
                    state.early = reading
                } else {
                    (state.keptNs, state.early) = (timeNs, nil)
                    state.keep(reading, capacity)
                }
            }
            return (state.isOver ? [] : rest, state.count > 0 ? state.woken() : nil)
        }
        if let woken { woken.iterating.resume(with: woken.next) }
        return rest
    }

    /// Waits until half of the room is free, so that it is filled at a stroke; until patience is lost, or nobody reads.
    func room() async {
        await withCheckedContinuation { continuation in
            let isThere = state.change { state in
                if state.isOver || state.count <= capacity / 2 { return true }
                (state.filling, state.wait) = (continuation, state.wait + 1)
                return false
            }
            if isThere { continuation.resume() }
        }
    }

    /// Whether it was waited for in vain and has taken nothing since.
    var hasStopped: Bool { state.change { $0.stoppedAt == $0.taken } }

    /// Ends a wait that was there at the call before, where nothing was taken since.
    func losePatience() {
        let filling = state.change { state in
            let before = state.seen
            state.seen = (state.wait, state.taken)
            if state.filling == nil || before != state.seen { return nil as CheckedContinuation<Void, Never>? }
            state.stoppedAt = state.taken
            return state.filled()
        }
        filling?.resume()
    }

    /// Nothing comes any more; what is kept may still be taken.
    func finish(_ failure: (any Error)? = nil) {
        let (woken, filling) = state.change { state in
            if !state.isOver {
                (state.isOver, state.failure) = (true, failure)
                if let early = state.early { state.keep(early, capacity) }
            }
            return (state.woken(), state.filled())
        }
        if let woken { woken.iterating.resume(with: woken.next) }
        filling?.resume()
    }

    /// The next reading, on the caller's actor: nobody changes threads for one that is there.
    func next(isolation actor: isolated (any Actor)?) async throws -> CompensatedReading? {
        try await withUnsafeThrowingContinuation(isolation: actor) { continuation in
            let (next, filling) = state.change { state in
                precondition(state.iterating == nil, "two tasks ask one iterator at a time")
                let next = state.next()
                if next == nil { state.iterating = continuation }
                return (next, state.count <= capacity / 2 ? state.filled() : nil)
            }
            filling?.resume()
            if let next { continuation.resume(with: next) }
        }
    }
}
