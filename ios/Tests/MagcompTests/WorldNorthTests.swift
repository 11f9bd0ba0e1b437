import Foundation
@testable import Magcomp
import Testing
import simd

/// North in ARKit's world.
@Suite struct WorldNorthTests {
    /// An attitude that is turned about up by so much, counter-clockwise, of a device with a pitch.
    func attitude(yawDeg: Double, pitchDeg: Double = 30, sigmaDeg: Double? = 4) -> DeviceAttitude {
        let (a, b) = (yawDeg * .pi / 360, pitchDeg * .pi / 360)
        // about z after about x
        return DeviceAttitude(
            w: cos(a) * cos(b), x: cos(a) * sin(b), y: sin(a) * sin(b), z: sin(a) * cos(b), sigmaDeg: sigmaDeg)
    }

    func reading(yawDeg: Double, sigmaDeg: Double? = 4) -> MagneticReading {
        MagneticReading(status: .tracking, attitude: attitude(yawDeg: yawDeg, sigmaDeg: sigmaDeg))
    }

    /// The pose of a device in a world whose y axis points by `worldDeg` clockwise from north.
    func pose(_ timeNs: Int64, yawDeg: Double, worldDeg: Double) -> SensorSample.Attitude {
        let q = attitude(yawDeg: yawDeg + worldDeg)
        return SensorSample.Attitude(timeNs: timeNs, w: q.w, x: q.x, y: q.y, z: q.z, yaw: .relative)
    }

    func isClose(_ north: Compass.WorldNorth?, _ headingDeg: Double, within: Double = 1e-6) -> Bool {
        north.map { abs(($0.headingDeg - headingDeg).remainder(dividingBy: 360)) < within } ?? false
    }

    @Test func theWorldsTurnIsFoundAtThePosesTimeWhicheverComesFirst() {
        for worldDeg in [0.0, 40, 179, 271, 359.5] {
            var turn = WorldTurn()
            // 300 degrees a second: the pose lies between two readings
            for k in 0..<50 {
                let timeNs = Int64(k) * stepNs
                let poseNs = timeNs - stepNs / 4
                let told = pose(poseNs, yawDeg: 3 * (Double(k) - 0.25), worldDeg: worldDeg)
                if k % 2 == 0, k > 0 { turn.see(told) }
                turn.see(reading(yawDeg: 3 * Double(k)), timeNs)
                if k % 2 == 1 { turn.see(told) }
                if k > 0 {
                    #expect(turn.north?.timeNs == poseNs && turn.north?.sigmaDeg == 4)
                    #expect(isClose(turn.north, worldDeg, within: 0.01), "\(worldDeg), \(k)")
                }
            }
        }
    }

    @Test func whatIsOldOrFarApartTellsNothing() {
        var turn = WorldTurn()
        // before all readings, and between two that are far apart
        turn.see(pose(-1, yawDeg: 0, worldDeg: 40))
        turn.see(reading(yawDeg: 0), 0)
        turn.see(pose(200_000_000, yawDeg: 0, worldDeg: 40))
        turn.see(reading(yawDeg: 0), 300_000_000)
        #expect(turn.north == nil)
        turn.see(pose(300_000_000, yawDeg: 0, worldDeg: 40))
        #expect(isClose(turn.north, 40))
        // a reading without an attitude, or without a sigma, counts as none
        turn.see(MagneticReading(status: .tracking), 310_000_000)
        turn.see(reading(yawDeg: 9, sigmaDeg: nil), 320_000_000)
        // valid for a second
        turn.see(reading(yawDeg: 0), 1_300_000_000)
        #expect(isClose(turn.north, 40))
        turn.see(reading(yawDeg: 0), 1_300_000_001)
        #expect(turn.north == nil)
        // another clock
        turn.see(pose(1_300_000_001, yawDeg: 0, worldDeg: 40))
        #expect(turn.north != nil)
        turn.see(reading(yawDeg: 0), 5)
        #expect(turn.north == nil)
        // more poses than wait
        for k in 0..<40 { turn.see(pose(Int64(6 + k), yawDeg: 0, worldDeg: Double(k))) }
        turn.see(reading(yawDeg: 0), 100)
        #expect(isClose(turn.north, 39))
    }

    /// ARKit has 60 frames a second, and readings are 50 ms behind: three poses wait, each for its own time.
    @Test func posesThatCameBeforeTheirAttitudesEachGetTheirs() {
        var turn = WorldTurn()
        turn.see(reading(yawDeg: 0, sigmaDeg: 9), 0)
        for k in 1...3 { turn.see(pose(Int64(k) * 16_000_000, yawDeg: 5, worldDeg: Double(40 + k))) }
        #expect(turn.north == nil)
        var found: [Int64?] = []
        for k in 1...5 {
            turn.see(reading(yawDeg: 5, sigmaDeg: Double(k)), Int64(k) * stepNs)
            found.append(turn.north.map { $0.timeNs / 16_000_000 })
            // as unsure as the attitude that came after the pose, not the one before
            if let north = turn.north, north.timeNs > Int64(k - 1) * stepNs { #expect(north.sigmaDeg == Double(k)) }
        }
        #expect(found == [nil, 1, 1, 2, 3] && isClose(turn.north, 43))
    }

    /// A phone that lies flat: its top edge points along ARKit's -z.
    @Test func aCompassKnowsWhereNorthIsForArKit() async throws {
        let source = Live()
        let compass = Compass(source: source)
        let seen = Shared<[CompensatedReading]>([])
        let task = reader(compass, seen)
        try await source.started(1)
        #expect(compass.arWorldNorth == nil)
        source.play(tumbling(900))
        // not so many that the sensor seems to hang
        for k in 900..<920 { source.play(flat(k)) }
        try await eventually { seen.value.count == 920 }
        let transform = simd_float4x4(SIMD4(0, 0, 1, 0), SIMD4(1, 0, 0, 0), SIMD4(0, 1, 0, 0), SIMD4(0, 0, 0, 1))
        // attitudes are remembered from the first pose on
        _ = try compass.aid(arKitCamera: transform, timestampS: Double(seen.value[919].sample.timeNs) * 1e-9)
        source.play(flat(920))
        try await eventually { seen.value.count == 921 }
        #expect(compass.arWorldNorth == nil)
        let last = try #require(seen.value.last)
        _ = try compass.aid(arKitCamera: transform, timestampS: Double(last.sample.timeNs) * 1e-9)
        let north = try #require(compass.arWorldNorth)
        // the field (10, 28) of `flat` is north
        let topDeg = -atan2(10.0, 28) * 180 / .pi
        #expect(isClose(north, topDeg, within: 3), "\(north), \(topDeg)")
        #expect(north.reference == .magnetic && north.sigmaDeg == last.reading.attitude?.sigmaDeg)
        try compass.setDeclinationDeg(20)
        let true_ = try #require(compass.arWorldNorth)
        #expect(true_.reference == .true && isClose(true_, north.headingDeg + 20))
        // north is to the right of the top edge, which is -z; x is to the right
        #expect(north.direction.x > 0.2 && north.direction.z < -0.8 && north.direction.y == 0)
        // one that is no pose changes nothing
        let none = SensorSample.Attitude(timeNs: last.sample.timeNs + 1, w: 0, x: 0, y: 0, z: 0, yaw: .relative)
        #expect(throws: MagcompError.eventRejected(reason: .outOfRange)) { try compass.aid(with: none) }
        source.play(flat(921))
        try await eventually { seen.value.count == 922 }
        #expect(compass.arWorldNorth == true_)
        compass.reset()
        #expect(compass.arWorldNorth == nil)
        task.cancel()
        try await task.value
    }
}
