/// Events of several sensors in the order of their times; the system delivers each sensor's late or in batches.
///
/// An event waits for every other sensor until that has delivered an event at or after its time. A sensor whose latest event, or
/// else the beginning of the stream, is more than 0.25 s older than the newest event of all is not waited for. Nothing waits
/// for longer than the hold, counted in the time of the events. At equal times the rotation rate is first, then `up`, then the
/// magnetometer; the system's own field goes with `up`, and nobody waits for it. None is dropped: one that comes too late goes
/// out at once.
///
/// The rules are those of the core's queue; `tests/vectors/event_order.json` holds both to them.
struct EventQueue: Sendable {
    /// Events that can wait.
    private static let room = 256
    /// An event that is this much newer than all before it follows a pause of all sensors.
    private static let pauseNs: Int64 = 250_000_000
    /// An event that is this much older is from another clock.
    private static let anotherClockNs: Int64 = 10_000_000_000
    private static let never = Int64.min

    private let holdNs: Int64
    /// In the order they go out.
    private var waiting: [SensorSample] = []
    /// Time of the event the stream began with.
    private var beginNs: Int64 = 0
    /// Time of the latest event of the gyroscope, of `up` and of the magnetometer.
    private var latestNs = [never, never, never]
    /// The latest of these.
    private var newestNs = never

    /// The range of what an app sets.
    static func check(holdS: Double, of name: String) throws {
        guard (0...0.25).contains(holdS) else {
            throw MagcompError.config(field: "\(name).holdS", value: "\(holdS)", expected: "0 to 0.25 s")
        }
    }

    /// - Parameter holdS: longest that an event waits, seconds; 0: every event goes out as it comes
    init(holdS: Double) { holdNs = Int64(holdS * 1e9) }

    /// Takes the events that were delivered next, and gives those whose turn it is now, in order.
    mutating func push(_ events: [SensorSample]) -> [SensorSample] {
        var out: [SensorSample] = []
        for event in events { push(event, &out) }
        return out
    }

    private mutating func push(_ event: SensorSample, _ out: inout [SensorSample]) {
        let timeNs = event.timeNs
        let sinceNs = timeNs.since(newestNs)
        if newestNs == Self.never || sinceNs > Self.pauseNs || sinceNs < -Self.anotherClockNs {
            out += flush()
            beginNs = timeNs
        }
        // nearly always at the end
        var place = waiting.count
        while place > 0, (timeNs, event.place) < (waiting[place - 1].timeNs, waiting[place - 1].place) { place -= 1 }
        waiting.insert(event, at: place)
        if event.isAwaited {
            latestNs[event.place] = timeNs
            newestNs = latestNs.max() ?? timeNs
        }
        let due = waiting.indices.first { !isDue(waiting[$0].timeNs, waiting: waiting.count - $0) } ?? waiting.count
        if due == 0 { return }
        out += waiting[..<due]
        waiting.removeFirst(due)
    }

    /// Everything that waits: the stream has ended, or another begins.
    mutating func flush() -> [SensorSample] {
        (latestNs, newestNs) = ([Self.never, Self.never, Self.never], Self.never)
        defer { waiting = [] }
        return waiting
    }

    private func isDue(_ timeNs: Int64, waiting: Int) -> Bool {
        waiting >= Self.room || newestNs.since(timeNs) >= holdNs
            || latestNs.allSatisfy { $0 >= timeNs || newestNs.since(max($0, beginNs)) > Self.pauseNs }
    }
}

extension SensorSample {
    /// Of its sensor among events of one time.
    fileprivate var place: Int {
        switch self {
        case .rotationRate: 0
        case .up, .systemField, .heading, .attitude, .note: 1
        case .magnetic: 2
        }
    }

    /// Whether others wait for its sensor.
    fileprivate var isAwaited: Bool {
        switch self {
        case .rotationRate, .up, .magnetic: true
        case .systemField, .heading, .attitude, .note: false
        }
    }
}

extension Int64 {
    /// The difference, or the nearest there is.
    func since(_ other: Int64) -> Int64 {
        let (difference, overflow) = subtractingReportingOverflow(other)
        return overflow ? (self < other ? .min : .max) : difference
    }
}
