import Foundation

/// A phone that nobody holds, for previews, the Simulator and demos: hard iron, noise and motion are made up, and every iterator gets
/// the same. For 12 s the phone is turned about all its axes, so that the compass learns; then it is held nearly flat and its heading
/// swings by 30 degrees about 40. It never ends.
///
/// Like those of a ``RecordingSource`` its events wait for whoever reads them.
public struct SimulatedSource: MagneticFieldSource {
    private let speed: Double?
    private let clock: any WaitingClock

    /// - Parameter speed: 1 plays at its own pace, 2 twice as fast, above 0; nil: as fast as it is read
    public init(speed: Double? = 1) { self.init(speed: speed, clock: SystemClock()) }

    init(speed: Double?, clock: any WaitingClock) { (self.speed, self.clock) = (speed, clock) }

    public func samples() -> SensorSamples {
        SensorSamples.batches(isLive: false) { [speed, clock] in
            Motion(pace: speed.map { Pace("SimulatedSource", speed: $0, clock: clock) })
        }
    }

    /// CompassHeading of the top edge once the phone is held flat, degrees.
    static func headingDeg(_ seconds: Double) -> Double { 40 + 30 * sin(0.5 * seconds) }

    private struct Motion: AsyncSequence, AsyncIteratorProtocol {
        typealias Element = [SensorSample]

        /// 100 Hz.
        private static let stepNs: Int64 = 10_000_000
        /// To magnetic north, and up, microtesla.
        private static let (northUt, upUt) = (20.0, -43.0)
        private static let hardIronUt = (x: 80.0, y: -45.0, z: 130.0)
        /// A second past this the phone is held flat.
        private static let learnedS = 12.0

        var pace: Pace?
        private var count: Int64 = 0
        private var noise = Noise()

        init(pace: Pace?) { self.pace = pace }

        func makeAsyncIterator() -> Motion { self }

        mutating func next() async throws -> [SensorSample]? {
            if count == 0 { try pace?.check() }
            count += 1
            try await pace?.wait(for: count * Self.stepNs)
            return events(count * Self.stepNs)
        }

        private mutating func events(_ timeNs: Int64) -> [SensorSample] {
            let seconds = Double(timeNs) * 1e-9
            let (before, now) = (Pose(seconds - 0.01), Pose(seconds))
            // of so small a turn: what each axis of the device has moved along the next
            func turned(_ one: KeyPath<Pose, SIMD3<Double>>, _ other: KeyPath<Pose, SIMD3<Double>>) -> Double {
                let (a, b) = (before[keyPath: one] * now[keyPath: other], now[keyPath: one] * before[keyPath: other])
                return ((b - a).sum() / 2) / 0.01
            }
            let rate = SIMD3(turned(\.y, \.z), turned(\.z, \.x), turned(\.x, \.y))
            let up = SIMD3(now.x.z, now.y.z, now.z.z)
            let north = SIMD3(now.x.y, now.y.y, now.z.y)
            let iron = SIMD3(Self.hardIronUt.x, Self.hardIronUt.y, Self.hardIronUt.z)
            let field = north * Self.northUt + up * Self.upUt + iron
            // the noise is drawn in this order
            let magnetic = SensorSample.Magnetic(timeNs: timeNs, fieldUt: vector(field, noise: 0.3))
            let upward = SensorSample.Up(timeNs: timeNs, upMS2: vector(up * 9.81, noise: 0.02))
            let turning = SensorSample.RotationRate(timeNs: timeNs, rateRadS: vector(rate, noise: 0.002))
            return [.rotationRate(turning), .up(upward), .magnetic(magnetic)]
        }

        private mutating func vector(_ v: SIMD3<Double>, noise size: Double) -> DeviceVector {
            DeviceVector(x: v.x + size * noise.next(), y: v.y + size * noise.next(), z: v.z + size * noise.next())
        }

        /// The device's axes in the world: east, north, up.
        private struct Pose {
            let x, y, z: SIMD3<Double>

            init(_ seconds: Double) {
                // turned about, and from 12 s on ever less
                let share = Swift.min(1, Swift.max(0.05, Motion.learnedS + 1 - seconds))
                let (pitch, roll) = (share * 1.2 * sin(1.1 * seconds), share * 1.4 * sin(0.7 * seconds + 1))
                let spin = share > 0.05 ? share * 2 * sin(0.6 * seconds) : 0
                let heading = SimulatedSource.headingDeg(seconds) * .pi / 180 + spin
                let (right, ahead) = (SIMD3(cos(heading), -sin(heading), 0), SIMD3(sin(heading), cos(heading), 0))
                let up = SIMD3(0.0, 0, 1)
                // the top edge is raised, then the device rolls about it
                y = ahead * cos(pitch) + up * sin(pitch)
                let above = up * cos(pitch) - ahead * sin(pitch)
                x = right * cos(roll) - above * sin(roll)
                z = above * cos(roll) + right * sin(roll)
            }
        }
    }
}

/// Normal by a sum of twelve; the same from every beginning.
private struct Noise {
    private var state: UInt64 = 1

    mutating func next() -> Double {
        (0..<12).reduce(-6) { sum, _ in
            state = state &* 6_364_136_223_846_793_005 &+ 1_442_695_040_888_963_407
            return sum + Double(state >> 11) / 9_007_199_254_740_992
        }
    }
}
