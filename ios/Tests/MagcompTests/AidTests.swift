import Foundation
import MagcompTestHooks
import Testing

@_spi(Research) @testable import Magcomp

@Suite struct AidTests {
    /// Flat, the screen up, the top edge along -z of ARKit's world, which is y of one whose z points up.
    @Test func arKitsCameraIsTurnedIntoTheDevice() {
        let flat = SensorSample.Attitude(arKitTimestampS: 1.5, x: SIMD3(0, 0, 1), y: SIMD3(1, 0, 0), z: SIMD3(0, 1, 0))
        #expect(flat.timeNs == 1_500_000_000 && flat.yaw == .relative)
        #expect(abs(flat.w - 1) < 1e-12 && abs(flat.x) + abs(flat.y) + abs(flat.z) < 1e-12)
        // upright, the screen towards the viewer: the top edge is up
        let upright = SensorSample.Attitude(arKitTimestampS: 0, x: SIMD3(0, -1, 0), y: SIMD3(1, 0, 0), z: SIMD3(0, 0, 1))
        let top = turned(SIMD3(0, 1, 0), by: upright)
        #expect(abs(top.x) + abs(top.y) < 1e-12 && abs(top.z - 1) < 1e-12)
    }

    /// Whichever of the four parts of the quaternion is the largest.
    @Test func anyPoseKeepsTheDevicesAxes() {
        for (a, b, c) in [
            (0.1, 0.2, 0.3), (3.1, 0.1, 0.0), (0.1, 3.1, 0.2), (0.0, 0.2, 3.1), (2.0, 2.2, -1.7), (-2.9, 1.4, 0.4),
        ] {
            let (x, y, z) = axes(a, b, c)
            let sample = SensorSample.Attitude(arKitTimestampS: 0, x: x, y: y, z: z)
            for (device, camera) in [(SIMD3(1.0, 0, 0), y), (SIMD3(0, 1.0, 0), -x), (SIMD3(0, 0, 1.0), z)] {
                let off = turned(device, by: sample) - SIMD3(camera.x, -camera.z, camera.y)
                #expect((off * off).sum() < 1e-20)
            }
        }
    }

    @Test func aFixThatStandsOrHasNoCourseSaysNothing() throws {
        func course(_ courseDeg: Double, _ accuracyDeg: Double, _ speedMS: Double, _ headed: SensorSample.HeadedAxis)
            -> SensorSample.Heading?
        {
            SensorSample.Heading(courseDeg: courseDeg, accuracyDeg: accuracyDeg, speedMS: speedMS, timeNs: 7, of: headed)
        }
        let driven = try #require(course(90, 1.5, 12, .vehicle))
        #expect(driven.timeNs == 7 && driven.headingDeg == 90 && driven.reference == .true && driven.axis == .vehicle)
        #expect(abs(driven.sigmaDeg - 2.5) < 1e-12)
        // 0.5 m/s across 1 m/s, and 10 degrees of the hand
        let walked = try #require(course(90, -1, 1, .heldAhead))
        #expect(abs(walked.sigmaDeg - 28.385) < 0.001)
        #expect(course(90, 1.5, 2, .vehicle) == nil && course(90, 1.5, 0.5, .heldAhead) == nil)
        for (courseDeg, speedMS) in [(-1.0, 12.0), (.nan, 12), (90, -1), (90, .nan), (90, .infinity)] {
            #expect(course(courseDeg, 1.5, speedMS, .vehicle) == nil)
        }
    }

    @Test func aDateIsATimeOfTheSensorsClock() {
        let (fix, now) = (Date(timeIntervalSince1970: 999_999.75), Date(timeIntervalSince1970: 1_000_000))
        #expect(SensorSample.Heading.timeNs(of: fix, now: now, uptimeS: 100) == 99_750_000_000)
        #expect(SensorSample.Heading.timeNs(of: now, now: fix, uptimeS: 100) == 100_250_000_000)
        // the way back of a reading's date
        let reading = CompensatedReading(
            reading: MagneticReading(status: .tracking),
            sample: SensorSample.Magnetic(timeNs: 99_750_000_000, fieldUt: DeviceVector(x: 0, y: 0, z: 0)))
        #expect(CompensatedReading.date(of: reading.sample, now: now, uptimeNs: 100_000_000_000) == fix)
        func timeNs(_ seconds: Double) -> Int64 {
            SensorSample.Heading.timeNs(of: Date(timeIntervalSinceReferenceDate: seconds), now: now, uptimeS: 100)
        }
        #expect(timeNs(1e12) == .max && timeNs(-1e12) == .min && timeNs(.nan) == .min)
        let nowNs = SensorSample.Heading.timeNs(of: Date())
        #expect(abs(Double(nowNs) * 1e-9 - ProcessInfo.processInfo.systemUptime) < 10)
    }

    @Test func numbersAreRefusedAsTheCoreRefusesThem() async throws {
        let core = try Compensator()
        let source = Live()
        let compass = Compass(source: source)
        let task = reader(compass, Shared([]))
        try await source.started(1)
        let (top, far) = (DeviceVector(x: 0, y: 1, z: 0), Double.infinity)
        let axes: [SensorSample.HeadedAxis] = [
            .vehicle, .device(axis: top), .device(axis: DeviceVector(x: 0, y: 0, z: 0)),
            .device(axis: DeviceVector(x: far, y: 0, z: 0)),
        ]
        for axis in axes {
            for (headingDeg, sigmaDeg) in [
                (10.0, 5.0), (-360, 180), (361, 5), (10, 0), (10, -1), (10, 181), (.nan, 5), (10, far),
            ] {
                let sample = SensorSample.Heading(
                    timeNs: 1, headingDeg: headingDeg, sigmaDeg: sigmaDeg, reference: .magnetic, axis: axis)
                try core.reset()
                compass.reset()
                let told = Result { try core.pushHeading(sample) }.failure
                #expect(Result { try compass.aid(with: sample) }.failure == told, "\(sample)")
            }
        }
        for (w, yaw) in [
            (1.0, SensorSample.Attitude.WorldYaw.relative), (0, .relative), (.nan, .relative),
            (1, .absolute(sigmaDeg: 0, reference: .true)),
            (2, .absolute(sigmaDeg: 9, reference: .true)), (1, .absolute(sigmaDeg: .nan, reference: .true)),
        ] {
            let sample = SensorSample.Attitude(timeNs: 1, w: w, x: 0, y: 0, z: 0, yaw: yaw)
            try core.reset()
            compass.reset()
            let told = Result { try core.pushAttitude(sample) }.failure
            #expect(Result { try compass.aid(with: sample) }.failure == told, "\(sample)")
        }
        task.cancel()
        try await task.value
    }

    /// A phone that lies flat, its top edge north by a calibration that is hardly known: a world turned by 30 degrees leads.
    @Test func northComesFromOutsideAndIsTold() async throws {
        let calibration = MagnetometerCalibration(
            softIron: SoftIron(xx: 1, yy: 1, zz: 1, xy: 0, xz: 0, yz: 0), hardIronUt: DeviceVector(x: 0, y: 0, z: 0),
            fieldStrengthUt: 49.244)
        let events = (1...1500).flatMap { k -> [SensorSample] in
            let timeNs = Int64(k) * 20_000_000
            let field = DeviceVector(x: 0.2 * sin(Double(timeNs)), y: 20, z: -45)
            return [
                .rotationRate(SensorSample.RotationRate(timeNs: timeNs, rateRadS: DeviceVector(x: 0, y: 0, z: 0))),
                .up(SensorSample.Up(timeNs: timeNs, upMS2: DeviceVector(x: 0, y: 0, z: 9.81))),
                .magnetic(SensorSample.Magnetic(timeNs: timeNs, fieldUt: field)),
            ]
        }
        let compass = Compass(
            source: Played(events: events, isLive: false),
            config: CompensationConfig(initial: calibration, initialSigmaUt: 30))
        var (latest, taken): (CompensatedReading?, Int) = (nil, 0)
        for try await answer in compass.readings(capacity: 1) {
            latest = answer
            guard answer.reading.timeNs % 1_000_000_000 == 0 else { continue }
            let half = -15 * Double.pi / 180
            let pose = SensorSample.Attitude(
                timeNs: answer.reading.timeNs, w: cos(half), x: 0, y: 0, z: sin(half),
                yaw: .absolute(sigmaDeg: 1, reference: .magnetic))
            if try compass.aid(with: pose) { taken += 1 }
            // the same once more comes too late
            #expect(try !compass.aid(with: pose))
        }
        #expect(taken == 30)
        let reading = try #require(latest)
        #expect(
            reading.headingAid == .leads && reading.headingAid?.localizedText == CompensatedReading.HeadingAid.leads.text)
        #expect(abs(try #require(reading.reading.headingDeg) - 30) < 5)
        #expect(try compass.foundDeclination() == nil)
        for aid in [CompensatedReading.HeadingAid.used, .leads, .disagrees] { #expect(aid.localizedText == aid.text) }
        compass.reset()
    }

    /// Whether help or a question meets it, while somebody reads or between two runs.
    @Test(arguments: [true, false], [true, false])
    func aDefectThatHelpMeetsEndsTheRunAndSparesTheNext(isAsked: Bool, isRead: Bool) async throws {
        let source = Live()
        let compass = Compass(source: source)
        let seen = Shared<[CompensatedReading]>([])
        let pose = SensorSample.Attitude(timeNs: 1, w: 1, x: 0, y: 0, z: 0, yaw: .relative)
        func play(_ events: [SensorSample]) async throws {
            let before = seen.value.count
            source.play(events)
            try await eventually { seen.value.count == before + events.count / 2 }
        }
        func breakIt() throws {
            let defect = MagcompError.panicked(what: "on purpose")
            #expect(magcomp_test_panic(try #require(compass.fastHandle)) == Int32(MAGCOMP_PANICKED))
            #expect(throws: defect) {
                if isAsked { _ = try compass.foundDeclination() } else { try compass.aid(with: pose) }
            }
            #expect(try !compass.aid(with: pose), "there is nothing to help")
            #expect(try compass.foundDeclination() == nil)
        }
        let task = reader(compass, seen)
        try await source.started(1)
        try await play(flat(0))
        if isRead {
            try breakIt()
            source.play(flat(1))
            await #expect(throws: MagcompError.panicked(what: "on purpose"), "its own reason") { try await task.value }
        } else {
            task.cancel()
            try await task.value
            await compass.settled()
            try breakIt()
        }
        let again = reader(compass, seen)
        try await source.started(2)
        try await play(flat(2))
        again.cancel()
        try await again.value
    }
}

extension Result {
    fileprivate var failure: MagcompError? {
        if case .failure(let error) = self { return error as? MagcompError }
        return nil
    }
}

/// A device's vector in the world.
private func turned(_ v: SIMD3<Double>, by q: SensorSample.Attitude) -> SIMD3<Double> {
    func cross(_ a: SIMD3<Double>, _ b: SIMD3<Double>) -> SIMD3<Double> {
        SIMD3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)
    }
    let u = SIMD3(q.x, q.y, q.z)
    return v + 2 * cross(u, cross(u, v) + q.w * v)
}

/// Three axes at right angles, turned about z, y and x by these.
private func axes(_ a: Double, _ b: Double, _ c: Double) -> (SIMD3<Double>, SIMD3<Double>, SIMD3<Double>) {
    let (x, y, z) = ((cos(a), sin(a)), (cos(b), sin(b)), (cos(c), sin(c)))
    return (
        SIMD3(x.0 * y.0, x.1 * y.0, -y.1),
        SIMD3(x.0 * y.1 * z.1 - x.1 * z.0, x.1 * y.1 * z.1 + x.0 * z.0, y.0 * z.1),
        SIMD3(x.0 * y.1 * z.0 + x.1 * z.1, x.1 * y.1 * z.0 - x.0 * z.1, y.0 * z.0)
    )
}
