/// One run of a model for any number of views: it begins with the first that joins, and ends when the last has left or by itself.
@MainActor
final class SharedRun {
    /// What a run waits for before it tries again after an error.
    typealias Retries = AsyncStream<Void>

    private struct Run {
        let number: Int
        let task: Task<Void, Never>
        let retries: Retries.Continuation
    }

    private var joined: [Int: CheckedContinuation<Void, Never>] = [:]
    private var number = 0
    private var run: Run?
    /// That of the run that was told to end last.
    private var ending: Task<Void, Never>?

    /// Returns when this task is cancelled or the run has ended. Whoever leaves last waits for its end.
    func join(_ work: @escaping @MainActor (Retries) async -> Void) async {
        number += 1
        let mine = number
        await withTaskCancellationHandler {
            await withCheckedContinuation { continuation in
                joined[mine] = continuation
                if run == nil { begin(mine, work) }
            }
        } onCancel: {
            Task { @MainActor in self.leave(mine) }
        }
    }

    /// A run that waits after an error, or is just about to, goes on.
    func retry() { run?.retries.yield() }

    private func begin(_ number: Int, _ work: @escaping @MainActor (Retries) async -> Void) {
        let before = ending
        let (retries, told) = Retries.makeStream(bufferingPolicy: .bufferingNewest(1))
        let task = Task {
            await before?.value
            if !Task.isCancelled { await work(retries) }
            end(number)
        }
        run = Run(number: number, task: task, retries: told)
    }

    private func leave(_ number: Int) {
        guard let continuation = joined[number] else { return }
        if joined.count == 1, let run {
            run.task.cancel()
            (ending, self.run) = (run.task, nil)
            joined = [:]
            Task {
                await run.task.value
                continuation.resume()
            }
        } else {
            joined[number] = nil
            continuation.resume()
        }
    }

    private func end(_ number: Int) {
        guard run?.number == number else { return }
        run = nil
        let all = joined.values
        joined = [:]
        for continuation in all { continuation.resume() }
    }
}
