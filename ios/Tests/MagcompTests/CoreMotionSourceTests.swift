#if canImport(CoreMotion) && !os(macOS)
import CoreMotion
import Foundation
@_spi(Research) @testable import Magcomp
import Testing

/// What ``CoreMotionSource`` makes of the events of a stand-in of Core Motion.
@Suite(.longest) struct CoreMotionSourceTests: OverCoreMotion {
    let manager = CMMotionManager()

    @Test func signsAndUnitsInAttitudesComputedByHand() async throws {
        struct Events: Decodable {
            struct Case: Decodable {
                struct Apples: Decodable {
                    let magneticField, gravity, rotationRate: [Double]
                }
                let name, axis: String
                let ios: Apples
                let fieldUt, upMS2, rateRadS: [Double]
                let headingDeg: Double
            }
            let timeNs: Int64
            let iosTimestampS, inclinationDeg: Double
            let cases: [Case]
        }
        let events = try vectors("platform_events.json", as: Events.self)
        #expect(events.cases.count == 50)
        for fact in events.cases {
            let (g, r, m) = (fact.ios.gravity, fact.ios.rotationRate, fact.ios.magneticField)
            let samples = try await samples(3) {
                manager.deviceMotion(at: events.iosTimestampS, gravity: (g[0], g[1], g[2]), rate: (r[0], r[1], r[2]))
                manager.magnetometer(at: events.iosTimestampS, m[0], m[1], m[2])
            }
            let expected: [SensorSample] = [
                .rotationRate(SensorSample.RotationRate(timeNs: events.timeNs, rateRadS: DeviceVector(fact.rateRadS))),
                .up(SensorSample.Up(timeNs: events.timeNs, upMS2: DeviceVector(fact.upMS2))),
                .magnetic(SensorSample.Magnetic(timeNs: events.timeNs, fieldUt: DeviceVector(fact.fieldUt))),
            ]
            #expect(samples == expected, "\(fact.name)")
            guard case .up(let up) = samples[1], case .magnetic(let magnetic) = samples[2] else { continue }
            let frame = HeadingFrame(axis: fact.axis == "camera" ? .camera : .topEdge, screenRotation: .deg0)
            let found = try #require(try CompassHeading(fieldUt: magnetic.fieldUt, up: up.upMS2, frame: frame))
            #expect(abs((found.headingDeg - fact.headingDeg).remainder(dividingBy: 360)) < 1e-9, "\(fact.name)")
            #expect(abs(try #require(found.inclinationDeg) - events.inclinationDeg) < 1e-9, "\(fact.name)")
        }
    }

    @Test func onlyTheSensorsAskedForAreUsed() async throws {
        let alone = try await samples(1, CoreMotionSource.Options(gyroscope: false, up: false)) {
            #expect(!manager.isDeviceMotionActive)
            manager.magnetometer(at: 1, 1, 2, 3)
        }
        #expect(alone == [.magnetic(SensorSample.Magnetic(timeNs: 1_000_000_000, fieldUt: DeviceVector(x: 1, y: 2, z: 3)))])
        let withUp = try await samples(2, CoreMotionSource.Options(gyroscope: false)) {
            // nobody knows at first that there is no gyroscope: its events are waited for
            for time in [1, 1.06] {
                manager.deviceMotion(at: time, gravity: (0, 0, -1), rate: (1, 2, 3))
                manager.magnetometer(at: time, 1, 2, 3)
            }
        }
        #expect(withUp[0] == .up(SensorSample.Up(timeNs: 1_000_000_000, upMS2: DeviceVector(x: 0, y: 0, z: 9.80665))))
    }

    @Test func everySensorMayBeAskedForAlone() async throws {
        // nobody knows at first that the others never come: their events are waited for
        func alone(_ options: CoreMotionSource.Options) async throws -> SensorSample? {
            try await samples(1, options) {
                for time in [1, 1.06] {
                    manager.deviceMotion(
                        at: time, gravity: (0, 0, -1), rate: (1, 2, 3),
                        field: CMCalibratedMagneticField(field: .init(x: 10, y: 20, z: -40), accuracy: .high))
                    manager.magnetometer(at: time, 1, 2, 3)
                }
            }.first
        }
        let field = SensorSample.SystemField(
            timeNs: 1_000_000_000, fieldUt: DeviceVector(x: 10, y: 20, z: -40), accuracy: .high)
        #expect(
            try await alone(CoreMotionSource.Options(gyroscope: false, up: false, systemField: true)) == .systemField(field))
        let rate = SensorSample.RotationRate(timeNs: 1_000_000_000, rateRadS: DeviceVector(x: 1, y: 2, z: 3))
        #expect(try await alone(CoreMotionSource.Options(up: false)) == .rotationRate(rate))
        let all = try await samples(4, CoreMotionSource.Options(up: false)) {
            for time in [1, 1.06] { play(at: time) }
            manager.magnetometerFails(CMErrorUnknown.error)
        }
        #expect(all.allSatisfy { if case .up = $0 { false } else { true } } && all.count == 4)
    }

    @Test func timesAreRoundedToNanoseconds() async throws {
        // 1.001 s are 1000999999.9999999 ns, as numbers go
        for time in [1.001, 16.13, 4.1] {
            let found = try await samples(1, CoreMotionSource.Options(gyroscope: false, up: false)) {
                manager.magnetometer(at: .nan, 1, 2, 3)
                manager.magnetometer(at: time, 1, 2, 3)
            }
            #expect(found.first?.timeNs == Int64((time * 1000).rounded()) * 1_000_000)
        }
    }

    @Test func theLagIsTheLargestOfThisSecondAndTheOneBefore() async throws {
        let source = CoreMotionSource(options: CoreMotionSource.Options(holdS: 0), scripted: manager)
        var iterator = source.samples().makeAsyncIterator()
        iterator.start()
        /// The lag when device motion has come so much later than the magnetometer's latest event.
        func lagMs(at time: Double, lateMs: Double) async throws -> Double? {
            manager.magnetometer(at: time + lateMs / 1000, 1, 2, 3)
            manager.deviceMotion(at: time, gravity: (0, 0, -1))
            for _ in 0..<3 { #expect(try await iterator.next() != nil) }
            return source.lagS.map { ($0 * 1000).rounded() }
        }
        #expect(try await lagMs(at: 1, lateMs: 10) == 10)
        #expect(try await lagMs(at: 1.5, lateMs: 30) == 30)
        #expect(try await lagMs(at: 1.9, lateMs: 20) == 30)
        #expect(try await lagMs(at: 2.1, lateMs: 5) == 30, "the next second")
        #expect(try await lagMs(at: 3.2, lateMs: 7) == 7)
    }

    /// The magnetometer alone, by a clock of the test's.
    private func source(by clock: Shared<Double>) -> CoreMotionSource {
        CoreMotionSource(
            options: CoreMotionSource.Options(gyroscope: false, up: false), scripted: manager,
            continuousNs: { Int64(clock.value * 1e9) })
    }

    @Test func sleepThatCoreMotionsTimesDoNotShowIsToldOnceAndLateEventsAreNoSleep() async throws {
        let clock = Shared(0.0)
        let source = source(by: clock)
        var iterator = source.samples().makeAsyncIterator()
        iterator.start()
        var (timeS, sleptS) = (100.0, 50.0)
        func pass(_ samples: Int, lateS: (Int) -> Double = { _ in 0 }) async throws {
            for k in 0..<samples {
                timeS += 0.01
                clock.change { $0 = timeS + sleptS + lateS(k) }
                manager.magnetometer(at: timeS, 1, 2, 3)
                #expect(try await iterator.next() != nil)
            }
        }
        // sleep before it was there, delays of up to 5 s, and an event of an hour ago
        try await pass(100)
        try await pass(1000) { k in Double(500 - k % 500) * 0.01 }
        manager.magnetometer(at: timeS - 3600, 1, 2, 3)
        #expect(try await iterator.next() != nil)
        try await pass(1000) { k in Double(500 - k % 500) * 0.01 }
        #expect(source.hiddenS == 0)
        // a nap that is as good as none
        sleptS += 0.9
        try await pass(200)
        #expect(source.hiddenS == 0)
        // two of them are some
        sleptS += 0.9
        try await pass(200)
        #expect(abs(source.hiddenS - 1.8) < 0.1)
        sleptS += 8 * 3600
        try await pass(200)
        #expect(abs(source.hiddenS - 1.8 - 8 * 3600) < 0.1)
        let once = source.hiddenS
        try await pass(200)
        #expect(source.hiddenS == once)
        // of what it sleeps later all counts, of late events the earliest
        sleptS += 3600
        try await pass(200) { k in k == 0 ? 0 : 0.4 }
        #expect(abs(source.hiddenS - once - 3600) < 0.1)
        sleptS += 10
        try await pass(200)
        #expect(abs(source.hiddenS - once - 3610) < 0.1)
    }

    @Test func aFirstEventThatIsLateIsNoSleep() async throws {
        let clock = Shared(0.0)
        let source = source(by: clock)
        var iterator = source.samples().makeAsyncIterator()
        iterator.start()
        for k in 1...200 {
            let timeS = Double(k) * 0.01
            clock.change { $0 = timeS + (k == 1 ? 5 : 0) }
            manager.magnetometer(at: timeS, 1, 2, 3)
            #expect(try await iterator.next() != nil)
        }
        #expect(source.hiddenS == 0)
    }

    @Test func theSystemsOwnFieldIsBesideOurs() async throws {
        let source = CoreMotionSource(options: CoreMotionSource.Options(systemField: true), scripted: manager)
        var readings = source.samples().compensated().makeAsyncIterator()
        readings.start()
        try await eventually { manager.isDeviceMotionActive }
        #expect(manager.frame == .xArbitraryCorrectedZVertical)
        let accuracies: [(CMMagneticFieldCalibrationAccuracy, SensorSample.SystemField.Accuracy)] = [
            (.uncalibrated, .uncalibrated), (.low, .low), (.medium, .medium), (.high, .high),
        ]
        for (k, (theirs, ours)) in accuracies.enumerated() {
            let time = Double(k + 1)
            let calibrated = CMCalibratedMagneticField(field: .init(x: 10, y: 20, z: -40), accuracy: theirs)
            manager.deviceMotion(at: time, gravity: (0, 0, -1), field: calibrated)
            manager.magnetometer(at: time, 110, 20, time)
            let reading = try #require(try await readings.next())
            let field = DeviceVector(x: 10, y: 20, z: -40)
            let expected = SensorSample.SystemField(timeNs: Int64(k + 1) * 1_000_000_000, fieldUt: field, accuracy: ours)
            #expect(reading.systemField == expected)
            #expect(reading.sample.fieldUt.x == 110)
        }
    }

    @Test func aCompassAsksForTheSystemsFieldWhereThereIsOne() {
        final class Without: CMMotionManager {
            override class func availableAttitudeReferenceFrames() -> CMAttitudeReferenceFrame { [.xArbitraryZVertical] }
        }
        #expect(CoreMotionSource.Options.ofCompass(CMMotionManager.self) == CoreMotionSource.Options(systemField: true))
        #expect(CoreMotionSource.Options.ofCompass(Without.self) == CoreMotionSource.Options())
    }

    @Test func aPauseEndsNothing() async throws {
        // the app was in the background for ten minutes; the clock went on
        let times: [Double] = (1...100).map { k in Double(k) / 100 + (k > 50 ? 600 : 0) }
        let readings = try await readings(times.count) {
            for time in times {
                manager.deviceMotion(at: time, gravity: (0, 0, -1))
                manager.magnetometer(at: time, 20 + time, 30, -40)
            }
        }
        #expect(readings.map(\.sample.timeNs) == times.map { Int64(($0 * 1e9).rounded()) })
        #expect(readings.allSatisfy { $0.reading.status.label == "collecting" })
    }

    @Test func timesThatRepeatOrGoBackAreRejectedAndNothingElse() async throws {
        let times = [1.0, 1.01, 1.01, 1.0, 1.02]
        let readings = try await readings(times.count) {
            for time in times {
                manager.deviceMotion(at: time, gravity: (0, 0, -1))
                manager.magnetometer(at: time, 20 + time, 30, -40)
            }
        }
        #expect(readings.map { $0.reading.status.label == "rejected" } == [false, false, true, true, false])
    }

    @Test func deviceMotionMayStopAndComeBack() async throws {
        let readings = try await readings(300) {
            for k in 1...300 {
                let time = Double(k) / 100
                if !(100..<200).contains(k) { manager.deviceMotion(at: time, gravity: (0, 0, -1)) }
                manager.magnetometer(at: time, 20 + Double(k % 7), 30, -40)
            }
        }
        #expect(readings[50].reading.mode == .gyroscopeAndGravity)
        #expect(readings[190].reading.mode == .magnetometerOnly)
        #expect(readings[299].reading.mode == .gyroscopeAndGravity)
    }
}
#endif
