import Foundation

// What something else than the magnetometer knows: a GNSS course, a landmark, ARKit's camera. docs/OUTSIDE.md says what it is worth.

extension SensorSample.HeadedAxis {
    /// The direction in which a walker holds a phone ahead: between top edge and back camera, so that it points ahead whether the phone
    /// lies in the hand or is held up.
    public static let heldAhead = SensorSample.HeadedAxis.device(axis: DeviceVector(x: 0, y: 1, z: -1))
}

extension SensorSample.Attitude {
    /// The pose of ARKit's camera, whose world has a y axis that points up and is turned to anywhere: its turns alone count. Not for a
    /// session with `.gravityAndHeading`, whose yaw is the system's compass.
    ///
    /// - Parameters:
    ///   - timestampS: `ARFrame.timestamp`, seconds
    ///   - x: the first column of `ARCamera.transform`: along the device from the front camera to the other end
    ///   - y: the second: to the device's right
    ///   - z: the third: out of the screen
    public init(arKitTimestampS timestampS: Double, x: SIMD3<Double>, y: SIMD3<Double>, z: SIMD3<Double>) {
        // (x, y, z) of that world is (x, -z, y) of one whose z points up
        func up(_ v: SIMD3<Double>) -> SIMD3<Double> { SIMD3(v.x, -v.z, v.y) }
        let q = quaternion(up(y), -up(x), up(z))
        self.init(
            timeNs: nanoseconds(timestampS) ?? .max, w: q.w, x: q.x, y: q.y, z: q.z, yaw: .relative)
    }
}

/// The unit quaternion that takes the axes of a frame to these, right-handed and of length 1: the largest of its four parts comes first.
private func quaternion(_ x: SIMD3<Double>, _ y: SIMD3<Double>, _ z: SIMD3<Double>) -> (
    w: Double, x: Double, y: Double, z: Double
) {
    let trace = x.x + y.y + z.z
    let largest = max(trace, x.x, y.y, z.z)
    func part(_ value: Double) -> Double { (max(value, 0)).squareRoot() / 2 }
    if largest == trace {
        let w = part(1 + trace)
        return (w, (y.z - z.y) / (4 * w), (z.x - x.z) / (4 * w), (x.y - y.x) / (4 * w))
    }
    if largest == x.x {
        let i = part(1 + x.x - y.y - z.z)
        return ((y.z - z.y) / (4 * i), i, (x.y + y.x) / (4 * i), (z.x + x.z) / (4 * i))
    }
    if largest == y.y {
        let j = part(1 - x.x + y.y - z.z)
        return ((z.x - x.z) / (4 * j), (x.y + y.x) / (4 * j), j, (y.z + z.y) / (4 * j))
    }
    let k = part(1 - x.x - y.y + z.z)
    return ((x.y - y.x) / (4 * k), (z.x + x.z) / (4 * k), (y.z + z.y) / (4 * k), k)
}

/// A time that has nanoseconds; nil for one that is none.
func nanoseconds(_ seconds: Double) -> Int64? { Int64(exactly: (seconds * 1e9).rounded()) }

extension SensorSample.Heading {
    /// The time of a fix, or of anything else that has a date, by the clock of the phone's sensors: nanoseconds since the start of the
    /// device, without its sleep. For a date of the last seconds, and before the phone sleeps or its clock is set.
    public static func timeNs(of date: Date) -> Int64 {
        timeNs(of: date, now: Date(), uptimeS: ProcessInfo.processInfo.systemUptime)
    }

    /// A date too far away for that clock is at its end.
    static func timeNs(of date: Date, now: Date, uptimeS: TimeInterval) -> Int64 {
        let timeS = uptimeS - now.timeIntervalSince(date)
        return nanoseconds(timeS) ?? (timeS > 0 ? .max : .min)
    }

    /// Choice: a car that goes more slowly may go backwards; who walks more slowly stands and looks about, m/s.
    static let leastSpeedMS = (driving: 3.0, walking: 0.7)
    /// Choice: the error of a GNSS speed across the course, where the phone tells none, m/s.
    static let speedSigmaMS = 0.5
    /// Choice: how far off ahead a phone is held, and a car's nose off its track, degrees.
    static let headedSigmaDeg = (held: 10.0, track: 2.0)

    /// The course of a fix as a heading; nil where it says nothing: without course or speed, or too slow. What is negative is not known.
    init?(courseDeg: Double, accuracyDeg: Double, speedMS: Double, timeNs: Int64, of headed: SensorSample.HeadedAxis) {
        let isVehicle = headed == .vehicle
        let leastMS = isVehicle ? Self.leastSpeedMS.driving : Self.leastSpeedMS.walking
        guard (0...360).contains(courseDeg), speedMS >= leastMS, speedMS.isFinite else { return nil }
        let toldDeg = accuracyDeg > 0 ? accuracyDeg : atan2(Self.speedSigmaMS, speedMS) * 180 / .pi
        let headedDeg = isVehicle ? Self.headedSigmaDeg.track : Self.headedSigmaDeg.held
        let sigmaDeg = min((toldDeg * toldDeg + headedDeg * headedDeg).squareRoot(), 180)
        self.init(timeNs: timeNs, headingDeg: courseDeg, sigmaDeg: sigmaDeg, reference: .true, axis: headed)
    }
}

extension Compass {
    /// A heading from outside: a landmark that the user tapped, a corridor of a map. Any thread may call.
    ///
    /// - Parameter heading: its time is that of the source's events, for the phone's sensors `SensorSample.Heading.timeNs(of:)` of a date; up to 5 s
    ///   before the latest reading
    /// - Returns: whether it was taken; one that is too late, or comes while nobody iterates, changes nothing
    /// - Throws: `MagcompError.eventRejected` for numbers that can't be, while somebody iterates
    @discardableResult
    public func aid(with heading: SensorSample.Heading) throws -> Bool {
        try aid(.heading(heading))
    }

    /// An orientation from outside: ARKit's camera (`SensorSample.Attitude(arKitTimestampS:x:y:z:)`). While the gyroscope is missing its turns stand in
    /// for it; one whose yaw is known is a heading too.
    ///
    /// - Returns: whether it was taken; one that is too late, or comes while nobody iterates, changes nothing
    /// - Throws: `MagcompError.eventRejected` for numbers that can't be, while somebody iterates
    @discardableResult
    public func aid(with attitude: SensorSample.Attitude) throws -> Bool {
        try aid(.attitude(attitude))
    }
}

// Linux compiles this with stand-ins of CoreLocation and simd
#if canImport(CoreLocation)
import CoreLocation

extension Compass {
    /// The course of a fix, while it moves. The app or its user says of what it is the heading; where neither is true, no course helps.
    ///
    /// - Parameters:
    ///   - location: its course, course accuracy, speed and timestamp are used
    ///   - headed: `.vehicle`: the phone lies in a holder; `.heldAhead`: its user walks and holds it ahead
    /// - Returns: whether there was a course, and it was taken
    @discardableResult
    public func aid(with location: CLLocation, pointing headed: SensorSample.HeadedAxis) throws -> Bool {
        let course = SensorSample.Heading(
            courseDeg: location.course, accuracyDeg: location.courseAccuracy, speedMS: location.speed,
            timeNs: SensorSample.Heading.timeNs(of: location.timestamp), of: headed)
        return try course.map { try aid(with: $0) } ?? false
    }
}
#endif

#if canImport(simd)
import simd

extension Compass {
    /// ARKit's camera, with every frame: `try compass.aid(arKitCamera: frame.camera.transform, timestampS: frame.timestamp)`.
    ///
    /// - Returns: whether it was taken
    @discardableResult
    public func aid(arKitCamera transform: simd_float4x4, timestampS: Double) throws -> Bool {
        func column(_ c: SIMD4<Float>) -> SIMD3<Double> { SIMD3(Double(c.x), Double(c.y), Double(c.z)) }
        let (x, y, z, _) = transform.columns
        return try aid(
            with: SensorSample.Attitude(arKitTimestampS: timestampS, x: column(x), y: column(y), z: column(z)))
    }
}
#endif
