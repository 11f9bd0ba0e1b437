// macOS has a CoreMotion without these sensors
#if canImport(CoreMotion) && !os(macOS)
import CoreMotion
import Foundation

/// The phone's own sensors: the raw magnetometer, and device motion for gravity and the gyroscope.
///
/// Times become nanoseconds; gravity, which Core Motion reports in g and pointing down, becomes `up` in m/s^2. Events go out
/// in the order of their times (``Options/holdS``), though device motion is delivered later than the magnetometer, or
/// earlier; ``lagS`` says by how much. Updates start with the first iterator of ``samples()`` and stop with the last; each
/// gets every event. Iterating throws ``CompassError`` when a sensor is missing or the system refuses, and
/// `MagcompError.config` for options out of range.
///
/// Core Motion tells no range of the magnetometer; where an app knows it, `CompensationConfig.railUt` takes it. Core Motion's times leave out
/// the device's sleep, which ``hiddenS`` counts beside a clock that goes on.
public final class CoreMotionSource: MagneticFieldSource {
    private let updates: Updates

    /// With a motion manager of its own, made when the first iterator begins.
    ///
    /// - Parameter options: which sensors, how often
    public convenience init(options: Options = Options()) {
        self.init(options: { options }, manager: { CMMotionManager() }, continuousNs: systemContinuousNs)
    }

    /// With the app's motion manager, of which there should be one alone. From now on its magnetometer and device-motion updates are
    /// this source's; the app goes on with its other sensors only where it keeps no hold on it: what still uses the manager itself
    /// pushes (``PushedSource``).
    ///
    /// - Parameters:
    ///   - options: which sensors, how often
    ///   - manager: handed over: the compiler sees to it that nothing else uses it on another thread
    public convenience init(options: Options = Options(), manager: sending CMMotionManager) {
        self.init(options: { options }, manager: { manager }, continuousNs: systemContinuousNs)
    }

    /// With another clock that counts sleep, nanoseconds. The system is asked for nothing before the first iterator begins.
    init(
        options: @escaping @Sendable () -> Options, manager: @escaping () -> CMMotionManager,
        continuousNs: @escaping @Sendable () -> Int64 = systemContinuousNs
    ) {
        updates = Updates(manager, options, continuousNs)
    }

    /// Seconds that the device slept while this source was there and that its events' times do not show.
    public var hiddenS: Double { updates.hiddenS }

    public func samples() -> SensorSamples {
        SensorSamples.calls { [updates] in updates.listen($0) }
    }

    /// By how much device motion lately came later than magnetometer events of the same time, seconds: the largest of about
    /// the last second; negative when the magnetometer came later; nil before both came. For a look at a new device: more
    /// than ``Options/holdS`` costs accuracy.
    public var lagS: Double? { updates.lagS }
}

extension CoreMotionSource {
    /// How the phone's sensors are asked.
    public struct Options: Equatable, Sendable {
        /// Events a second of each sensor, 1 to 1000; the system takes it as a wish and gives at most about 100. Default 100.
        public var rateHz: Int
        /// Whether the gyroscope is used. Default true.
        public var gyroscope: Bool
        /// Whether gravity is used; without it there is no heading. Default true.
        public var up: Bool
        /// Whether the system's own calibrated field is delivered too: for comparison, and because raw less calibrated field is the
        /// system's hard iron, which gives a first heading before the phone was turned, with a wide sigma. Default false.
        public var systemField: Bool
        /// Longest that an event waits for earlier ones of other sensors, seconds, 0 to 0.25, so that all go out in the order of
        /// their times though the system delivers one sensor later than another; 0: as they are delivered. Default 0.05.
        public var holdS: Double

        public init(
            rateHz: Int = 100, gyroscope: Bool = true, up: Bool = true, systemField: Bool = false, holdS: Double = 0.05
        ) {
            (self.rateHz, self.gyroscope, self.up, self.systemField) = (rateHz, gyroscope, up, systemField)
            self.holdS = holdS
        }
    }
}

/// One motion manager and everyone who wants its events.
private final class Updates: @unchecked Sendable {
    typealias Listener = SensorSamples.Listener

    private let queue = OperationQueue()
    // what follows is used inside `lock` alone
    private let lock = NSLock()
    private let make: () -> CMMotionManager
    private lazy var manager = make()
    private let ask: @Sendable () -> CoreMotionSource.Options
    private lazy var options = ask()
    private var listeners: [Int: Listener] = [:]
    private var number = 0
    /// Runs of the sensors so far: what an old one still has to say is not of the present one.
    private var run = 0
    private var queued: EventQueue
    private var lag = Lag()
    private var sleep = Sleep()
    private let continuousNs: @Sendable () -> Int64

    init(
        _ make: @escaping () -> CMMotionManager, _ ask: @escaping @Sendable () -> CoreMotionSource.Options,
        _ continuousNs: @escaping @Sendable () -> Int64
    ) {
        (self.make, self.ask, self.continuousNs) = (make, ask, continuousNs)
        queued = EventQueue(holdS: 0)
        queue.name = "org.magcomp.sensors"
        // events stay in order
        queue.maxConcurrentOperationCount = 1
        queue.qualityOfService = .userInitiated
    }

    func listen(_ listener: Listener) -> @Sendable () -> Void {
        do {
            let mine = try lock.withLock {
                if listeners.isEmpty { try start() }
                number += 1
                listeners[number] = listener
                return number
            }
            return { [self] in
                lock.withLock { if listeners.removeValue(forKey: mine) != nil, listeners.isEmpty { stop() } }
            }
        } catch {
            listener.end(error)
            return {}
        }
    }

    private func start() throws {
        guard (1...1000).contains(options.rateHz) else {
            throw MagcompError.config(
                field: "CoreMotionSource.Options.rateHz", value: "\(options.rateHz)", expected: "1 to 1000")
        }
        try EventQueue.check(holdS: options.holdS, of: "CoreMotionSource.Options")
        if refused(type(of: manager)) { throw CompassError.accessRefused(sensor: .motion) }
        guard manager.isMagnetometerAvailable else {
            throw CompassError.missing(sensor: .magnetometer, advice: "hide the compass")
        }
        let motion = options.gyroscope || options.up || options.systemField
        // only this frame and those of a compass carry the calibrated field
        let frame: CMAttitudeReferenceFrame = options.systemField ? .xArbitraryCorrectedZVertical : .xArbitraryZVertical
        if motion {
            guard manager.isDeviceMotionAvailable else {
                throw CompassError.missing(
                    sensor: .gyroscope,
                    advice: "without a heading, use CoreMotionSource.Options(gyroscope: false, up: false)")
            }
            guard type(of: manager).availableAttitudeReferenceFrames().contains(frame) else {
                throw CompassError.missing(
                    sensor: .calibratedField, advice: "use CoreMotionSource.Options(systemField: false)")
            }
        }
        run += 1
        let run = run
        // the magnetometer alone waits for nobody
        (queued, lag) = (EventQueue(holdS: motion ? options.holdS : 0), Lag())
        let interval = 1 / Double(options.rateHz)
        manager.magnetometerUpdateInterval = interval
        manager.startMagnetometerUpdates(to: queue) { @Sendable [weak self] data, error in
            if let error { self?.fail(.magnetometer, error, in: run) }
            if let data { self?.take(data, in: run) }
        }
        guard motion else { return }
        manager.deviceMotionUpdateInterval = interval
        manager.startDeviceMotionUpdates(using: frame, to: queue) { @Sendable [weak self] data, error in
            if let error { self?.fail(.gyroscope, error, in: run) }
            if let data { self?.take(data, in: run) }
        }
    }

    /// Whether the system says, before it is asked for events, that it will give none.
    private func refused(_ manager: CMMotionManager.Type) -> Bool {
        // new in iOS 27.2: older SDKs lack the method, older systems ask nobody
        #if canImport(CoreMotion, _version: 3186)
        if #available(iOS 27.2, macCatalyst 27.2, watchOS 27.2, visionOS 27.2, *) {
            switch authorization(manager.authorizationStatus) {
            case .denied, .restricted: return true
            default: return false
            }
        }
        #endif
        return false
    }

    private func stop() {
        manager.stopMagnetometerUpdates()
        manager.stopDeviceMotionUpdates()
    }

    private func take(_ data: CMMagnetometerData, in run: Int) {
        let nowS = Double(continuousNs()) * 1e-9
        deliver(SensorSample.events(of: data), of: run) {
            lag.magnetic(data.timestamp)
            sleep.see(data.timestamp, nowS: nowS)
        }
    }

    private func take(_ motion: CMDeviceMotion, in run: Int) {
        deliver(SensorSample.events(of: motion, options), of: run) { lag.motion(motion.timestamp) }
    }

    /// Notes times, inside `lock`, and gives events to all listeners.
    private func deliver(_ events: [SensorSample], of run: Int, note: () -> Void) {
        // what has no time at all, which Core Motion never reports, tells nothing
        guard !events.isEmpty else { return }
        let (all, due): ([Listener], [SensorSample]) = lock.withLock {
            // they were on their way when their run ended, and another has begun since
            guard run == self.run else { return ([], []) }
            note()
            return (Array(listeners.values), queued.push(events))
        }
        if due.isEmpty { return }
        for listener in all { listener.take(due) }
    }

    var lagS: Double? { lock.withLock { lag.seconds } }

    var hiddenS: Double { lock.withLock { sleep.hiddenS } }

    private func fail(_ sensor: CompassError.Sensor, _ error: any Error, in run: Int) {
        let reason = error as NSError
        let code = reason.domain == CMErrorDomain ? UInt32(exactly: reason.code) : nil
        // passes by itself when the device is moved
        if code == CMErrorDeviceRequiresMovement.rawValue { return }
        let refused = [CMErrorNotAuthorized, CMErrorNotEntitled].contains { $0.rawValue == code }
        let failure: CompassError =
            refused
            ? .accessRefused(sensor: sensor) : .refused(sensor: sensor, reason: "\(reason.domain) \(reason.code)")
        let (all, rest): ([Listener], [SensorSample]) = lock.withLock {
            // the other sensor's error came first, and another run has begun since
            guard run == self.run, !listeners.isEmpty else { return ([], []) }
            defer { listeners = [:] }
            stop()
            return (Array(listeners.values), queued.flush())
        }
        // outside the lock: the end of one that listens stops it
        for listener in all {
            listener.take(rest)
            listener.end(failure)
        }
    }
}

/// Core Motion's answer, whether an SDK has it as a method or as a property: the one call compiles with both.
func authorization(_ ask: () -> CMAuthorizationStatus) -> CMAuthorizationStatus { ask() }
func authorization(_ status: CMAuthorizationStatus) -> CMAuthorizationStatus { status }

/// How much older than the newest magnetometer event device motion is when it is delivered: the largest of this second and the
/// one before it, by the motion's own times.
private struct Lag {
    private var newestS: Double?
    private var begunS: Double?
    private var now: Double?
    private var before: Double?

    var seconds: Double? { [now, before].compactMap { $0 }.max() }

    mutating func magnetic(_ timeS: Double) { newestS = timeS }

    mutating func motion(_ timeS: Double) {
        guard let newestS else { return }
        if begunS.map({ abs(timeS - $0) >= 1 }) ?? true { (begunS, before, now) = (timeS, now, nil) }
        now = max(now ?? -.infinity, newestS - timeS)
    }
}

/// A clock that counts sleep, nanoseconds: on Apple's systems that of `mach_continuous_time`.
@Sendable private func systemContinuousNs() -> Int64 {
    var now = timespec()
    clock_gettime(CLOCK_MONOTONIC_RAW, &now)
    return Int64(now.tv_sec) * 1_000_000_000 + Int64(now.tv_nsec)
}

/// How much time a sensor's clock did not show beside one that never stops. An event is delivered later than it happened, by any
/// time, so only the smallest lag of half a second of events counts.
private struct Sleep {
    /// Shorter sleep is as good as none.
    private static let leastSleepS = 1.0
    /// What the compensator takes; longer than any phone runs.
    private static let longestS = 1e9
    /// Events that waited have all been delivered by then.
    private static let otherForS = 0.5

    /// So far.
    private(set) var hiddenS = 0.0
    /// The smallest lag of the two clocks.
    private var leastS: Double?
    /// The smallest lag since all have been others, and since when.
    private var other: (lagS: Double, sinceS: Double)?
    private var latestS = 0.0

    /// An event of this time was delivered now.
    mutating func see(_ timeS: Double, nowS: Double) {
        let lagS = nowS - timeS
        // what came before a pause tells nothing of a batch after it
        if nowS - latestS > Self.otherForS { other = nil }
        latestS = nowS
        guard let least = leastS, abs(lagS - least) > Self.leastSleepS else {
            leastS = min(lagS, leastS ?? lagS)
            other = nil
            return
        }
        let new = (lagS: min(lagS, other?.lagS ?? lagS), sinceS: other?.sinceS ?? nowS)
        other = new
        if nowS - new.sinceS < Self.otherForS { return }
        // less: the first events were delivered late
        hiddenS += min(max(new.lagS - least, 0), Self.longestS)
        (leastS, other) = (new.lagS, nil)
    }
}
#endif
