import Foundation
import Magcomp
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

extension Vector3 {
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
let hardIronUt = Vector3(x: 120, y: -80, z: 300)

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
        let field = Vector3(
            x: 50 * x + hardIronUt.x + noise(), y: 50 * y + hardIronUt.y + noise(), z: 50 * z + hardIronUt.z + noise())
        // the field dips by 53 degrees wherever the device points
        let up = Vector3(
            x: 9.81 * (-0.8 * x - 0.6 * sin(a)), y: 9.81 * (-0.8 * y + 0.6 * cos(a)), z: -9.81 * 0.8 * z)
        return [
            .up(UpSample(timeNs: timeNs, upMS2: up)),
            .magnetic(MagneticSample(timeNs: timeNs, fieldUt: field)),
        ]
    }
}

/// One more sample, number `k`, of a device that lies flat.
func flat(_ k: Int) -> [SensorSample] {
    let timeNs = Int64(k + 1) * stepNs
    let field = Vector3(x: hardIronUt.x + 10, y: hardIronUt.y + 28, z: hardIronUt.z - 40)
    return [
        .up(UpSample(timeNs: timeNs, upMS2: Vector3(x: 0, y: 0, z: 9.81))),
        .magnetic(MagneticSample(timeNs: timeNs, fieldUt: field)),
    ]
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

extension Compensator {
    func pushAll(_ events: [SensorSample]) throws -> [Reading] { try events.compactMap { try push($0) } }
}

/// Waits for what must happen; a test that waits in vain fails after half a minute.
func eventually(_ happens: () -> Bool) async throws {
    let deadline = ContinuousClock.now + .seconds(30)
    while !happens() {
        try #require(ContinuousClock.now < deadline, "it never happened")
        try await Task.sleep(for: .milliseconds(1))
    }
}

/// A value tests share with other threads.
final class Shared<Value: Sendable>: @unchecked Sendable {
    private var stored: Value
    private let lock = NSLock()

    init(_ value: Value) { stored = value }

    var value: Value { lock.withLock { stored } }

    func change(_ body: (inout Value) -> Void) { lock.withLock { body(&stored) } }
}
