import Foundation

extension Compass {
    /// Where north is in a world of its own, such as ARKit's, which points anywhere when its session begins.
    public struct WorldNorth: Equatable, Sendable {
        /// Where that world's -z axis points: clockwise from north as seen from above, degrees, 0 to 360.
        public var headingDeg: Double
        /// One standard deviation of it, degrees.
        public var sigmaDeg: Double
        /// Which north: true where the ``Compass`` has a declination.
        public var reference: CompassHeading.NorthReference
        /// Time of the camera's pose, nanoseconds, on the clock of the sensors.
        public var timeNs: Int64

        public init(headingDeg: Double, sigmaDeg: Double, reference: CompassHeading.NorthReference, timeNs: Int64) {
            (self.headingDeg, self.sigmaDeg, self.reference, self.timeNs) = (headingDeg, sigmaDeg, reference, timeNs)
        }

        /// The direction of north in that world, whose y points up: a unit vector with y = 0, to place what lies north, or to turn a map by.
        public var direction: SIMD3<Double> {
            let angle = headingDeg * .pi / 180
            return SIMD3(-sin(angle), 0, -cos(angle))
        }
    }

    /// Where north is in ARKit's world, by the latest pose that `aid(arKitCamera:timestampS:)` told and the attitude at the pose's own time;
    /// nil before there are both, without the gravity sensor, and where nobody has told a pose for a second. It is as unsure as the attitude:
    /// an app averages it while the person walks, and weighs by ``WorldNorth/sigmaDeg``.
    public var arWorldNorth: WorldNorth? {
        guard var north = estimation.worldNorth else { return nil }
        if let declinationDeg {
            north.headingDeg = CompassHeading.trueHeadingDeg(headingDeg: north.headingDeg, declinationDeg: declinationDeg)
            north.reference = .true
        }
        return north
    }
}

/// Attitudes and poses of one device, brought together at the poses' times; magnetic north.
struct WorldTurn {
    /// Attitudes of a second and more at 100 Hz, and poses that wait for theirs.
    private static let (room, waiting) = (128, 16)
    /// Between attitudes further apart nothing is known of a turn.
    private static let longestNs: Int64 = 250_000_000
    /// An answer is of now.
    private static let validNs: Int64 = 1_000_000_000

    private var attitudes: [(timeNs: Int64, attitude: DeviceAttitude)] = []
    private var poses: [SensorSample.Attitude] = []
    private var latest: Compass.WorldNorth?

    /// Nil where nothing was told of late.
    var north: Compass.WorldNorth? {
        guard let latest, let now = attitudes.last, now.timeNs.since(latest.timeNs) <= Self.validNs else { return nil }
        return latest
    }

    /// What was known of the device's turns is old.
    mutating func forgetAttitudes() { (attitudes, latest) = ([], nil) }

    mutating func see(_ pose: SensorSample.Attitude) {
        poses = poses.suffix(Self.waiting - 1) + [pose]
        resolve()
    }

    mutating func see(_ reading: MagneticReading, _ timeNs: Int64) {
        guard let attitude = reading.attitude, attitude.sigmaDeg != nil else { return }
        // another clock, or the sample before again
        if let last = attitudes.last, timeNs <= last.timeNs { self = WorldTurn() }
        if attitudes.count == Self.room { attitudes.removeFirst() }
        attitudes.append((timeNs, attitude))
        resolve()
    }

    private mutating func resolve() {
        while let pose = poses.first, let newest = attitudes.last, pose.timeNs <= newest.timeNs {
            poses.removeFirst()
            guard let next = attitudes.firstIndex(where: { $0.timeNs >= pose.timeNs }) else { continue }
            let after = attitudes[next]
            // the first of all has none before it
            let before = attitudes[after.timeNs == pose.timeNs ? next : max(next - 1, 0)]
            let apartNs = after.timeNs.since(before.timeNs)
            guard before.timeNs <= pose.timeNs, apartNs <= Self.longestNs else { continue }
            let share = apartNs == 0 ? 0 : Double(pose.timeNs.since(before.timeNs)) / Double(apartNs)
            let turn = Quaternion(before.attitude).towards(Quaternion(after.attitude), share) * Quaternion(pose).conjugate
            let headingDeg = CompassState.shownDeg(-2 * atan2(turn.z, turn.w) * 180 / .pi)
            guard let headingDeg, let sigmaDeg = after.attitude.sigmaDeg else { continue }
            latest = Compass.WorldNorth(
                headingDeg: headingDeg, sigmaDeg: sigmaDeg, reference: .magnetic, timeNs: pose.timeNs)
        }
    }
}

private struct Quaternion {
    var w, x, y, z: Double

    init(w: Double, x: Double, y: Double, z: Double) { (self.w, self.x, self.y, self.z) = (w, x, y, z) }

    init(_ attitude: DeviceAttitude) { self.init(w: attitude.w, x: attitude.x, y: attitude.y, z: attitude.z) }

    init(_ pose: SensorSample.Attitude) { self.init(w: pose.w, x: pose.x, y: pose.y, z: pose.z) }

    var conjugate: Quaternion { Quaternion(w: w, x: -x, y: -y, z: -z) }

    /// Between two that are little apart; its length does not matter here.
    func towards(_ q: Quaternion, _ share: Double) -> Quaternion {
        let (a, b) = (1 - share, w * q.w + x * q.x + y * q.y + z * q.z < 0 ? -share : share)
        return Quaternion(w: a * w + b * q.w, x: a * x + b * q.x, y: a * y + b * q.y, z: a * z + b * q.z)
    }

    static func * (p: Quaternion, q: Quaternion) -> Quaternion {
        Quaternion(
            w: p.w * q.w - p.x * q.x - p.y * q.y - p.z * q.z, x: p.w * q.x + p.x * q.w + p.y * q.z - p.z * q.y,
            y: p.w * q.y - p.x * q.z + p.y * q.w + p.z * q.x, z: p.w * q.z + p.x * q.y - p.y * q.x + p.z * q.w)
    }
}
