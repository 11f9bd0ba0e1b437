import Foundation

/// A source that an app pushes into, for one that has a `CMMotionManager` of its own, of which there should be one alone:
/// `source.push(SensorSample.events(of: motion))` and `source.push(SensorSample.events(of: data))` in its handlers.
///
/// Events go out in the order of their times, whichever sensor's are delivered late. What is pushed while nobody iterates is gone.
public final class PushedSource: MagneticFieldSource {
    private struct State {
        var listeners: [Int: SensorSamples.Listener] = [:]
        var number = 0
        var queue: EventQueue
    }

    private let holdS: Double
    private let state: Locked<State>

    /// - Parameter holdS: longest that an event waits for those of other sensors, seconds, 0 to 0.25, as `CoreMotionSource.Options.holdS`
    public init(holdS: Double = 0.05) {
        self.holdS = holdS
        state = Locked(State(queue: EventQueue(holdS: 0)))
    }

    /// Gives events to everyone who iterates. Any thread may call, one at a time.
    public func push(_ events: [SensorSample]) {
        let (listeners, due) = state.change { state in (state.listeners.values, state.queue.push(events)) }
        if due.isEmpty { return }
        for listener in listeners { listener.take(due) }
    }

    /// How many iterate.
    package var listeners: Int { state.change { $0.listeners.count } }

    public func samples() -> SensorSamples {
        SensorSamples.calls { [state, holdS] listener in
            do { try EventQueue.check(holdS: holdS, of: "PushedSource") } catch {
                listener.end(error)
                return {}
            }
            let number = state.change { state in
                if state.listeners.isEmpty { state.queue = EventQueue(holdS: holdS) }
                state.number += 1
                state.listeners[state.number] = listener
                return state.number
            }
            return { [state] in state.change { $0.listeners[number] = nil } }
        }
    }
}
