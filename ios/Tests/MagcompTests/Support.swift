import Foundation
@_spi(Research) @testable import Magcomp
import Testing

let repository = URL(fileURLWithPath: #filePath)
    .deletingLastPathComponent().deletingLastPathComponent().deletingLastPathComponent().deletingLastPathComponent()

/// What `tests/swift.sh` prepared: Rust's own numbers, and the recording without its compression.
func prepared(_ name: String) throws -> URL {
    let folder = try #require(ProcessInfo.processInfo.environment["MAGCOMP_EXPECTED"], "run tests/swift.sh")
    return URL(fileURLWithPath: folder).appendingPathComponent(name)
}

/// A file of `tests/vectors`.
func vectors<T: Decodable>(_ name: String, as type: T.Type = T.self) throws -> T {
    let decoder = JSONDecoder()
    decoder.keyDecodingStrategy = .convertFromSnakeCase
    return try decoder.decode(type, from: Data(contentsOf: repository.appendingPathComponent("tests/vectors/\(name)")))
}

extension DeviceVector {
    init(_ v: [Double]) { self.init(x: v[0], y: v[1], z: v[2]) }

    func isClose(to other: [Double], within tolerance: Double) -> Bool {
        zip([x, y, z], other).allSatisfy { abs($0 - $1) <= tolerance }
    }
}

/// A time of the wall clock, seconds since 1970.
let nowS: Int64 = 1_795_000_000

/// A kept calibration as if a newer version of the library had written it.
func newer(_ text: String) -> String {
    text.replacingOccurrences(of: #""magcomp_calibration":1,"#, with: #""magcomp_calibration":99,"#)
}

/// 100 Hz.
let stepNs: Int64 = 10_000_000
let hardIronUt = DeviceVector(x: 120, y: -80, z: 300)

/// A device tumbled in a field of 50 uT, noise of 0.3 uT, around `hardIronUt`, with `up` beside every sample.
func tumbling(_ samples: Int) -> [SensorSample] {
    var state: UInt64 = 1
    func noise() -> Double {
        state = state &* 6_364_136_223_846_793_005 &+ 1_442_695_040_888_963_407
        return 0.3 * 3.46 * (Double(state >> 11) / 9_007_199_254_740_992 - 0.5)
    }
    return (0..<samples).flatMap { k -> [SensorSample] in
        let (a, b) = (Double(k) * 0.11, Double(k) * 0.031)
        let timeNs = Int64(k + 1) * stepNs
        let (x, y, z) = (cos(a) * cos(b), sin(a) * cos(b), sin(b))
        let field = DeviceVector(
            x: 50 * x + hardIronUt.x + noise(), y: 50 * y + hardIronUt.y + noise(), z: 50 * z + hardIronUt.z + noise())
        // the field dips by 53 degrees wherever the device points
        let up = DeviceVector(
            x: 9.81 * (-0.8 * x - 0.6 * sin(a)), y: 9.81 * (-0.8 * y + 0.6 * cos(a)), z: -9.81 * 0.8 * z)
        return [
            .up(SensorSample.Up(timeNs: timeNs, upMS2: up)),
            .magnetic(SensorSample.Magnetic(timeNs: timeNs, fieldUt: field)),
        ]
    }
}

/// One more sample, number `k`, of a device that lies flat.
func flat(_ k: Int) -> [SensorSample] {
    let timeNs = Int64(k + 1) * stepNs
    let field = DeviceVector(x: hardIronUt.x + 10, y: hardIronUt.y + 28, z: hardIronUt.z - 40)
    return [
        .up(SensorSample.Up(timeNs: timeNs, upMS2: DeviceVector(x: 0, y: 0, z: 9.81))),
        .magnetic(SensorSample.Magnetic(timeNs: timeNs, fieldUt: field)),
    ]
}

// Tests look at what happens when the last reader leaves, so their compasses have no grace time but where they say so, and they may be
// slow, so a compass's clock stands: of two that fit, the compiler takes the one without defaults.
extension Compass {
    convenience init(
        source: any MagneticFieldSource, config: CompensationConfig = CompensationConfig(),
        store: (any CalibrationStore)? = nil, graceS: Double = 0, clock: any WaitingClock
    ) {
        self.init(
            source: source, config: config, store: store, graceS: graceS, clock: clock, unixTimeS: systemUnixTimeS)
    }

    convenience init(
        source: any MagneticFieldSource, config: CompensationConfig = CompensationConfig(),
        store: (any CalibrationStore)? = nil, unixTimeS: @escaping @Sendable () -> Int64
    ) {
        self.init(source: source, config: config, store: store, graceS: 0, clock: StandingClock(), unixTimeS: unixTimeS)
    }

    convenience init(source: any MagneticFieldSource) { self.init(source: source, clock: StandingClock()) }

    convenience init(source: any MagneticFieldSource, graceS: Double) {
        self.init(source: source, graceS: graceS, clock: StandingClock())
    }

    convenience init(source: any MagneticFieldSource, store: (any CalibrationStore)?) {
        self.init(source: source, store: store, clock: StandingClock())
    }

    convenience init(source: any MagneticFieldSource, store: (any CalibrationStore)?, graceS: Double) {
        self.init(source: source, store: store, graceS: graceS, clock: StandingClock())
    }

    convenience init(source: any MagneticFieldSource, config: CompensationConfig) {
        self.init(source: source, config: config, clock: StandingClock())
    }

    convenience init(source: any MagneticFieldSource, config: CompensationConfig, store: (any CalibrationStore)?) {
        self.init(source: source, config: config, store: store, clock: StandingClock())
    }
}

/// A clock that stands until a test turns it.
final class StandingClock: WaitingClock {
    private struct State {
        var nowNs: Int64 = 0
        var number = 0
        var waiting: [Int: (dueNs: Int64, wake: CheckedContinuation<Void, any Error>)] = [:]
    }

    private let state = Shared(State())

    var nowNs: Int64 { state.value.nowNs }

    /// How many wait.
    var sleepers: Int { state.value.waiting.count }

    func sleep(forNs ns: Int64) async throws {
        let number = state.change { state in
            state.number += 1
            return state.number
        }
        try await withTaskCancellationHandler {
            try await withCheckedThrowingContinuation { wake in
                let isCancelled = state.change { state in
                    // looked at once: it may be cancelled meanwhile, and is woken then
                    let isCancelled = Task.isCancelled
                    if !isCancelled { state.waiting[number] = (state.nowNs + ns, wake) }
                    return isCancelled
                }
                if isCancelled { wake.resume(throwing: CancellationError()) }
            }
        } onCancel: {
            state.change { $0.waiting.removeValue(forKey: number) }?.wake.resume(throwing: CancellationError())
        }
    }

    /// Goes on by so many seconds once so many wait, and wakes those whose time has come.
    func turn(_ seconds: Double, for count: Int = 1) async throws {
        try await eventually { sleepers >= count }
        let woken = state.change { state in
            state.nowNs += Int64(seconds * 1e9)
            let due = state.waiting.filter { $0.value.dueNs <= state.nowNs }
            for number in due.keys { state.waiting[number] = nil }
            return due.values
        }
        for sleeper in woken { sleeper.wake.resume() }
    }

    /// Turns it by so many looks for silence, of half a second; each has come to nothing or was told when this returns.
    func look(_ times: Int) async throws {
        for _ in 0..<times { try await turn(0.5) }
        try await eventually { sleepers == 1 }
    }
}

/// All at once, as often as it is asked.
struct Played: MagneticFieldSource {
    let events: [SensorSample]
    var isLive = true

    func samples() -> SensorSamples {
        SensorSamples(isLive: isLive) { [events] in
            AsyncStream { continuation in
                for event in events { continuation.yield(event) }
                continuation.finish()
            }
        }
    }
}

extension AsyncSequence {
    func collected() async throws -> [Element] {
        var all: [Element] = []
        for try await element in self { all.append(element) }
        return all
    }
}

extension AsyncSequence where Self: Sendable, Element == SensorSample {
    /// Readings of an estimator of their own, for each iterator.
    func compensated(
        _ config: CompensationConfig = CompensationConfig(), store: (any CalibrationStore)? = nil, capacity: Int = 64
    ) -> Compass.Readings {
        let events = (self as? SensorSamples) ?? SensorSamples { self }
        return Compass.Readings {
            let frames = Locked(HeadingFrame(axis: config.heading?.axis ?? .auto, screenRotation: .deg0))
            return Readers(
                of: { events }, by: Estimation(config, store: store, frames: frames), graceS: 0, clock: StandingClock()
            )
            .place(capacity: capacity)
        }
    }
}

extension Compensator {
    func pushAll(_ events: [SensorSample]) throws -> [MagneticReading] { try events.compactMap { try push($0) } }
}

/// Seconds that a test waits for what must happen, far more than a busy machine takes: only a test that fails waits so long.
let longestS = ProcessInfo.processInfo.environment["MAGCOMP_LONGEST_S"].flatMap(Double.init) ?? 120

extension Trait where Self == TimeLimitTrait {
    /// For suites where an error is awaited, which may never come.
    static var longest: Self { .timeLimit(.minutes(10)) }
}

/// Waits for what must happen.
func eventually(isolation: isolated (any Actor)? = #isolation, _ happens: () -> Bool) async throws {
    let deadline = ContinuousClock.now + .seconds(longestS)
    while !happens() {
        try #require(ContinuousClock.now < deadline, "it never happened")
        try await Task.sleep(for: .milliseconds(1))
    }
}

/// Holds this thread, as the main one may be busy, until it happens on another.
func busy(until happens: () -> Bool) {
    let deadline = ContinuousClock.now + .seconds(longestS)
    while !happens(), ContinuousClock.now < deadline { Thread.sleep(forTimeInterval: 0.001) }
}

/// A value tests share with other threads.
final class Shared<Value: Sendable>: @unchecked Sendable {
    private var stored: Value
    private let lock = NSLock()

    init(_ value: Value) { stored = value }

    var value: Value { lock.withLock { stored } }

    @discardableResult
    func change<T>(_ body: (inout Value) throws -> T) rethrows -> T { try lock.withLock { try body(&stored) } }
}

/// A live source that a test plays; every start is another run.
final class Live: MagneticFieldSource {
    struct State {
        var starts = 0
        var ends = 0
        var listener: AsyncThrowingStream<SensorSample, any Error>.Continuation?
    }

    let state = Shared(State())

    func samples() -> SensorSamples {
        SensorSamples { [state] in
            AsyncThrowingStream { listener in
                state.change {
                    $0.starts += 1
                    $0.listener = listener
                }
                listener.onTermination = { _ in state.change { $0.ends += 1 } }
            }
        }
    }

    func play(_ events: some Sequence<SensorSample>) {
        for event in events { state.value.listener?.yield(event) }
    }

    func finish(_ error: (any Error)? = nil) { state.value.listener?.finish(throwing: error) }

    func started(_ times: Int) async throws { try await eventually { state.value.starts == times } }
}

/// Reads from now on; `seen` grows.
func reader(_ compass: Compass, _ seen: Shared<[CompensatedReading]>) -> Task<Void, any Error> {
    var begun = compass.readings(capacity: 10_000).makeAsyncIterator()
    begun.start()
    return Task { [begun] in
        var iterator = begun
        while let reading = try await iterator.next() { seen.change { $0.append(reading) } }
    }
}

/// A store that takes its time and notes its calls.
final class Slow: CalibrationStore {
    let calls = Shared<[String]>([])
    let kept = Shared<String?>(nil)

    func load() -> String? {
        calls.change { $0.append("load") }
        return kept.value
    }

    func save(_ text: String) {
        calls.change { $0.append("save") }
        Thread.sleep(forTimeInterval: 0.05)
        kept.change { $0 = text }
        calls.change { $0.append("saved") }
    }

    func clear() {
        calls.change { $0.append("clear") }
        kept.change { $0 = nil }
    }
}

/// A gate that opens when a call has come back; for a call that waits for the gate it never does.
final class Gate: CalibrationStore {
    private let opened = DispatchSemaphore(value: 0)
    let entered = Shared(0)
    let opensInTime = Shared<[Bool]>([])

    func pass() {
        entered.change { $0 += 1 }
        let inTime = opened.wait(timeout: .now() + longestS) == .success
        opensInTime.change { $0.append(inTime) }
    }

    func open() { opened.signal() }

    func load() -> String? { nil }

    func save(_ text: String) { pass() }

    func clear() {}
}

/// A live source that passes a gate with every sample while `gated`.
struct Gated: MagneticFieldSource {
    let live = Live()
    let sensor = Gate()
    let gated = Shared(false)

    // asked for while a sample is worked on
    var hiddenS: Double {
        if gated.value { sensor.pass() }
        return 0
    }

    func samples() -> SensorSamples { live.samples() }
}

#if canImport(CoreMotion) && !os(macOS)
import CoreMotion

extension CoreMotionSource {
    /// With a manager that the test goes on to script, which an app can't: the stand-in has a lock.
    convenience init(
        options: CoreMotionSource.Options = CoreMotionSource.Options(), scripted: CMMotionManager,
        continuousNs: (@Sendable () -> Int64)? = nil
    ) {
        nonisolated(unsafe) let manager = scripted
        if let continuousNs {
            self.init(options: { options }, manager: { manager }, continuousNs: continuousNs)
        } else {
            self.init(options: { options }, manager: { manager })
        }
    }
}

/// Tests over a stand-in of Core Motion that plays what they script.
protocol OverCoreMotion {
    var manager: CMMotionManager { get }
}

extension OverCoreMotion {
    /// An event of each sensor.
    func play(at time: Double) {
        manager.deviceMotion(at: time, gravity: (0, 0, -1))
        manager.magnetometer(at: time, 1, 2, 3)
    }

    /// The first samples while `play` runs, once updates are on.
    func samples(_ count: Int, _ options: CoreMotionSource.Options = CoreMotionSource.Options(), play: () -> Void)
        async throws -> [SensorSample]
    {
        var samples: [SensorSample] = []
        var iterator = CoreMotionSource(options: options, scripted: manager).samples().makeAsyncIterator()
        iterator.start()
        play()
        while samples.count < count, let sample = try await iterator.next() { samples.append(sample) }
        return samples
    }

    /// As many readings while `play` runs.
    func readings(_ count: Int, play: () -> Void) async throws -> [CompensatedReading] {
        var readings: [CompensatedReading] = []
        var iterator = CoreMotionSource(scripted: manager).samples().compensated(capacity: count).makeAsyncIterator()
        iterator.start()
        try await eventually { manager.isMagnetometerActive }
        play()
        while readings.count < count, let reading = try await iterator.next() { readings.append(reading) }
        #expect(readings.allSatisfy { $0.droppedBefore == 0 })
        return readings
    }
}
#endif
