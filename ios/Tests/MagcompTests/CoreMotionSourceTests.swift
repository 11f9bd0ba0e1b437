#if canImport(CoreMotion) && !os(macOS)
import CoreMotion
import Foundation
@testable import Magcomp
import Testing

/// ``CoreMotionSource`` over a stand-in of Core Motion that plays what a test scripts.
@Suite(.timeLimit(.minutes(2))) struct CoreMotionSourceTests {
    let manager = CMMotionManager()

    /// An event of each sensor.
    func play(at time: Double) {
        manager.deviceMotion(at: time, gravity: (0, 0, -1))
        manager.magnetometer(at: time, 1, 2, 3)
    }

    /// The first samples while `play` runs, once updates are on.
    func samples(_ count: Int, _ options: SensorOptions = SensorOptions(), play: () -> Void) async throws -> [SensorSample] {
        var samples: [SensorSample] = []
        var iterator = CoreMotionSource(options: options, manager: manager).samples().makeAsyncIterator()
        iterator.start()
        play()
        while samples.count < count, let sample = try await iterator.next() { samples.append(sample) }
        return samples
    }

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
                .rotationRate(RotationRateSample(timeNs: events.timeNs, rateRadS: Vector3(fact.rateRadS))),
                .up(UpSample(timeNs: events.timeNs, upMS2: Vector3(fact.upMS2))),
                .magnetic(MagneticSample(timeNs: events.timeNs, fieldUt: Vector3(fact.fieldUt))),
            ]
            #expect(samples == expected, "\(fact.name)")
            guard case .up(let up) = samples[1], case .magnetic(let magnetic) = samples[2] else { continue }
            let frame = HeadingFrame(axis: fact.axis == "camera" ? .camera : .topEdge, screenRotation: .deg0)
            let found = try #require(try Heading(fieldUt: magnetic.fieldUt, up: up.upMS2, frame: frame))
            #expect(abs((found.headingDeg - fact.headingDeg).remainder(dividingBy: 360)) < 1e-9, "\(fact.name)")
            #expect(abs(found.inclinationDeg - events.inclinationDeg) < 1e-9, "\(fact.name)")
        }
    }

    @Test func updatesRunWhileIteratedAtTheRateAskedFor() async throws {
        let source = CoreMotionSource(options: SensorOptions(rateHz: 50), manager: manager)
        let sequence = source.samples()
        #expect(manager.starts == 0, "cold")
        do {
            var iterator = sequence.makeAsyncIterator()
            #expect(manager.starts == 0, "nobody has asked for an event")
            iterator.start()
            #expect(manager.isMagnetometerActive && manager.isDeviceMotionActive)
            #expect(manager.magnetometerUpdateInterval == 0.02 && manager.deviceMotionUpdateInterval == 0.02)
            #expect(manager.frame == .xArbitraryZVertical)
            play(at: 1)
            #expect(try await iterator.next()?.timeNs == 1_000_000_000)
        }
        try await eventually { !manager.isMagnetometerActive && !manager.isDeviceMotionActive }
        // and it can be iterated again
        var again = sequence.makeAsyncIterator()
        again.start()
        play(at: 2)
        #expect(try await again.next()?.timeNs == 2_000_000_000)
        #expect(manager.starts == 2)
    }

    @Test func onlyTheSensorsAskedForAreUsed() async throws {
        let alone = try await samples(1, SensorOptions(gyroscope: false, up: false)) {
            #expect(!manager.isDeviceMotionActive)
            manager.magnetometer(at: 1, 1, 2, 3)
        }
        #expect(alone == [.magnetic(MagneticSample(timeNs: 1_000_000_000, fieldUt: Vector3(x: 1, y: 2, z: 3)))])
        let withUp = try await samples(2, SensorOptions(gyroscope: false)) {
            // nobody knows at first that there is no gyroscope: its events are waited for
            for time in [1, 1.06] {
                manager.deviceMotion(at: time, gravity: (0, 0, -1), rate: (1, 2, 3))
                manager.magnetometer(at: time, 1, 2, 3)
            }
        }
        #expect(withUp[0] == .up(UpSample(timeNs: 1_000_000_000, upMS2: Vector3(x: 0, y: 0, z: 9.80665))))
    }

    @Test func everySensorMayBeAskedForAlone() async throws {
        // nobody knows at first that the others never come: their events are waited for
        func alone(_ options: SensorOptions) async throws -> SensorSample? {
            try await samples(1, options) {
                for time in [1, 1.06] {
                    manager.deviceMotion(
                        at: time, gravity: (0, 0, -1), rate: (1, 2, 3),
                        field: CMCalibratedMagneticField(field: .init(x: 10, y: 20, z: -40), accuracy: .high))
                    manager.magnetometer(at: time, 1, 2, 3)
                }
            }.first
        }
        let field = SystemFieldSample(timeNs: 1_000_000_000, fieldUt: Vector3(x: 10, y: 20, z: -40), accuracy: .high)
        #expect(try await alone(SensorOptions(gyroscope: false, up: false, systemField: true)) == .systemField(field))
        let rate = RotationRateSample(timeNs: 1_000_000_000, rateRadS: Vector3(x: 1, y: 2, z: 3))
        #expect(try await alone(SensorOptions(up: false)) == .rotationRate(rate))
        let all = try await samples(4, SensorOptions(up: false)) {
            for time in [1, 1.06] { play(at: time) }
            manager.magnetometerFails(CMErrorUnknown.error)
        }
        #expect(all.allSatisfy { if case .up = $0 { false } else { true } } && all.count == 4)
    }

    @Test func timesAreRoundedToNanoseconds() async throws {
        // 1.001 s are 1000999999.9999999 ns, as numbers go
        for time in [1.001, 16.13, 4.1] {
            let found = try await samples(1, SensorOptions(gyroscope: false, up: false)) {
                manager.magnetometer(at: .nan, 1, 2, 3)
                manager.magnetometer(at: time, 1, 2, 3)
            }
            #expect(found.first?.timeNs == Int64((time * 1000).rounded()) * 1_000_000)
        }
    }

    @Test func theLagIsTheLargestOfThisSecondAndTheOneBefore() async throws {
        let source = CoreMotionSource(options: SensorOptions(holdS: 0), manager: manager)
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

    /// What an earlier run left waiting, and its lag, are not the next one's.
    @Test func anotherRunBeginsWithNothing() async throws {
        let source = CoreMotionSource(manager: manager)
        var first: SensorSamples.AsyncIterator? = source.samples().makeAsyncIterator()
        first?.start()
        for time in [1, 1.01] { play(at: time) }
        #expect(try await first?.next() != nil)
        // waits for device motion
        manager.magnetometer(at: 1.02, 7, 7, 7)
        try await eventually { source.lagS != nil }
        try await Task.sleep(for: .milliseconds(20))
        first = nil
        try await eventually { !manager.isMagnetometerActive }
        var second = source.samples().makeAsyncIterator()
        second.start()
        #expect(source.lagS == nil)
        play(at: 1.03)
        #expect(try await second.next()?.timeNs == 1_030_000_000)
    }

    @Test func errorsOfAnotherDomainAreNotCoreMotions() async throws {
        for code in [CMErrorNotAuthorized, CMErrorDeviceRequiresMovement] {
            let error = NSError(domain: "org.other", code: Int(code.rawValue))
            let expected = SensorError.refused(sensor: .magnetometer, reason: "org.other \(code.rawValue)")
            await #expect(throws: expected) {
                try await samples(1) {
                    manager.magnetometerFails(error)
                    play(at: 1)
                }
            }
        }
    }

    @Test func sleepThatCoreMotionsTimesDoNotShowIsToldOnceAndLateEventsAreNoSleep() async throws {
        let clock = Shared(0.0)
        let source = CoreMotionSource(
            options: SensorOptions(gyroscope: false, up: false), manager: { manager },
            continuousNs: { Int64(clock.value * 1e9) })
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
        sleptS += 8 * 3600
        try await pass(200)
        #expect(abs(source.hiddenS - 8 * 3600) < 1)
        let once = source.hiddenS
        try await pass(200)
        #expect(source.hiddenS == once)
    }

    @Test func theSystemsOwnFieldIsBesideOurs() async throws {
        let source = CoreMotionSource(options: SensorOptions(systemField: true), manager: manager)
        var readings = source.samples().compensated().makeAsyncIterator()
        readings.start()
        try await eventually { manager.isDeviceMotionActive }
        #expect(manager.frame == .xArbitraryCorrectedZVertical)
        let accuracies: [(CMMagneticFieldCalibrationAccuracy, SystemFieldSample.Accuracy)] = [
            (.uncalibrated, .uncalibrated), (.low, .low), (.medium, .medium), (.high, .high),
        ]
        for (k, (theirs, ours)) in accuracies.enumerated() {
            let time = Double(k + 1)
            let calibrated = CMCalibratedMagneticField(field: .init(x: 10, y: 20, z: -40), accuracy: theirs)
            manager.deviceMotion(at: time, gravity: (0, 0, -1), field: calibrated)
            manager.magnetometer(at: time, 110, 20, time)
            let reading = try #require(try await readings.next())
            let field = Vector3(x: 10, y: 20, z: -40)
            let expected = SystemFieldSample(timeNs: Int64(k + 1) * 1_000_000_000, fieldUt: field, accuracy: ours)
            #expect(reading.systemField == expected)
            #expect(reading.sample.fieldUt.x == 110)
        }
    }

    @Test func aMissingSensorIsATypedErrorThatSaysWhatToDo() async throws {
        manager.lack(magnetometer: true)
        await #expect(throws: SensorError.missing(sensor: .magnetometer, advice: "hide the compass")) {
            try await samples(1) {}
        }
        manager.lack(deviceMotion: true)
        do {
            _ = try await samples(1) {}
            Issue.record("no error")
        } catch let error as SensorError {
            #expect(error.developerText.contains("SensorOptions(gyroscope: false, up: false)"))
        }
        // and that works
        let alone = try await samples(1, SensorOptions(gyroscope: false, up: false)) { manager.magnetometer(at: 1, 1, 2, 3) }
        #expect(alone.count == 1)
    }

    @Test func aFrameTheDeviceLacksIsATypedErrorThatSaysWhatToDo() async throws {
        final class WithoutCorrected: CMMotionManager {
            override class func availableAttitudeReferenceFrames() -> CMAttitudeReferenceFrame { .xArbitraryZVertical }
        }
        let manager = WithoutCorrected()
        var options = SensorOptions(systemField: true)
        let missing = SensorError.missing(
            sensor: .calibratedField, advice: "use SensorOptions(systemField: false)")
        await #expect(throws: missing) {
            var iterator = CoreMotionSource(options: options, manager: manager).samples().makeAsyncIterator()
            iterator.start()
            manager.deviceMotion(at: 1, gravity: (0, 0, -1))
            _ = try await iterator.next()
        }
        #expect(manager.starts == 0 && manager.frame == [])
        options.systemField = false
        let without = CoreMotionSource(options: options, manager: manager).samples().makeAsyncIterator()
        without.start()
        #expect(manager.starts == 1 && manager.frame == .xArbitraryZVertical)
        withExtendedLifetime(without) {}
    }

    @Test func accessThatWasRefusedBeforeIsATypedErrorAtOnce() async throws {
        final class Denied: CMMotionManager {
            override class func authorizationStatus() -> CMAuthorizationStatus { .denied }
        }
        final class Restricted: CMMotionManager {
            override class func authorizationStatus() -> CMAuthorizationStatus { .restricted }
        }
        final class Authorized: CMMotionManager {
            override class func authorizationStatus() -> CMAuthorizationStatus { .authorized }
        }
        for manager in [Denied(), Restricted()] {
            await #expect(throws: SensorError.accessRefused(sensor: .motion)) {
                var iterator = CoreMotionSource(manager: manager).samples().makeAsyncIterator()
                iterator.start()
                // an event for who began nevertheless
                manager.deviceMotion(at: 1, gravity: (0, 0, -1))
                _ = try await iterator.next()
            }
            #expect(manager.starts == 0)
        }
        // nobody was asked yet, or the person allowed it
        for manager in [CMMotionManager(), Authorized()] {
            let iterator = CoreMotionSource(manager: manager).samples().makeAsyncIterator()
            iterator.start()
            #expect(manager.starts == 1)
            withExtendedLifetime(iterator) {}
        }
    }

    @Test func optionsOutOfRangeAreATypedError() async throws {
        for holdS in [-0.01, 0.26, .nan] {
            let error = MagcompError.config(field: "SensorOptions.holdS", value: "\(holdS)", expected: "0 to 0.25 s")
            await #expect(throws: error) { try await samples(1, SensorOptions(holdS: holdS)) {} }
        }
        for rateHz in [0, -1, 1001] {
            let error = MagcompError.config(field: "SensorOptions.rateHz", value: "\(rateHz)", expected: "1 to 1000")
            await #expect(throws: error) { try await samples(1, SensorOptions(rateHz: rateHz)) {} }
        }
        #expect(manager.starts == 0)
    }

    @Test func refusedAccessEndsTheSequenceWithATypedError() async throws {
        for code in [CMErrorNotAuthorized, CMErrorNotEntitled] {
            await #expect(throws: SensorError.accessRefused(sensor: .magnetometer)) {
                try await samples(1) { manager.magnetometerFails(code.error) }
            }
            let words = SensorError.accessRefused(sensor: .magnetometer).developerText
            #expect(words.contains("Settings > Privacy & Security > Motion & Fitness"), "\(words)")
            #expect(!manager.isMagnetometerActive && !manager.isDeviceMotionActive)
        }
        await #expect(throws: SensorError.refused(sensor: .gyroscope, reason: "CMErrorDomain 109")) {
            try await samples(1) { manager.deviceMotionFails(CMErrorNotAvailable.error) }
        }
        // also after events, and through the compensator; what came before arrives
        var readings = CoreMotionSource(manager: manager).samples().compensated().makeAsyncIterator()
        readings.start()
        try await eventually { manager.isMagnetometerActive }
        manager.magnetometer(at: 1, 1, 2, 3)
        manager.magnetometerFails(CMErrorUnknown.error)
        #expect(try await readings.next() != nil)
        await #expect(throws: SensorError.refused(sensor: .magnetometer, reason: "CMErrorDomain 103")) {
            try await readings.next()
        }
        // who tries again gets events again
        #expect(try await samples(1) { play(at: 2) }.count == 1)
    }

    /// Both sensors fail; the second error comes when somebody iterates again.
    @Test func anOldRunsErrorDoesNotEndANewOne() async throws {
        let source = CoreMotionSource(manager: manager)
        var first = source.samples().makeAsyncIterator()
        first.start()
        let late = manager.lateDeviceMotionError()
        let (lateMagnetometer, lateDeviceMotion) = (manager.lateMagnetometer(), manager.lateDeviceMotion())
        manager.magnetometerFails(CMErrorUnknown.error)
        await #expect(throws: SensorError.self) { try await first.next() }
        var second = source.samples().makeAsyncIterator()
        second.start()
        #expect(manager.starts == 2)
        late(CMErrorUnknown.error)
        // nor are events that were on their way its own
        lateMagnetometer(4)
        lateDeviceMotion(4.01)
        play(at: 5)
        #expect(try await second.next()?.timeNs == 5_000_000_000)
        #expect(source.lagS == nil, "device motion came first in this run")
        #expect(manager.isMagnetometerActive && manager.isDeviceMotionActive)
        // its own error does
        manager.deviceMotionFails(CMErrorUnknown.error)
        await #expect(throws: SensorError.refused(sensor: .gyroscope, reason: "CMErrorDomain 103")) {
            while try await second.next() != nil {}
        }
    }

    @Test func theAuthorizationIsReadAsAMethodAndAsAProperty() {
        enum Older { static func authorizationStatus() -> CMAuthorizationStatus { .denied } }
        enum Newer { static var authorizationStatus: CMAuthorizationStatus { .restricted } }
        #expect(authorization(Older.authorizationStatus) == .denied)
        #expect(authorization(Newer.authorizationStatus) == .restricted)
    }

    @Test func aCompassAsksForTheSystemsFieldWhereThereIsOne() {
        final class Without: CMMotionManager {
            override class func availableAttitudeReferenceFrames() -> CMAttitudeReferenceFrame { [.xArbitraryZVertical] }
        }
        #expect(SensorOptions.ofCompass(CMMotionManager.self) == SensorOptions(systemField: true))
        #expect(SensorOptions.ofCompass(Without.self) == SensorOptions())
    }

    @Test func anErrorThatPassesByItselfDoesNotEndTheSequence() async throws {
        let samples = try await samples(2) {
            manager.deviceMotionFails(CMErrorDeviceRequiresMovement.error)
            play(at: 1)
        }
        #expect(samples.count == 2)
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

    /// As many readings while `play` runs.
    func readings(_ count: Int, play: () -> Void) async throws -> [CompensatedReading] {
        var readings: [CompensatedReading] = []
        var iterator = CoreMotionSource(manager: manager).samples().compensated(capacity: count).makeAsyncIterator()
        iterator.start()
        try await eventually { manager.isMagnetometerActive }
        play()
        while readings.count < count, let reading = try await iterator.next() { readings.append(reading) }
        #expect(readings.allSatisfy { $0.droppedBefore == 0 })
        return readings
    }

    @Test func cancellingTheTaskStopsTheUpdates() async throws {
        let source = CoreMotionSource(manager: manager)
        let got = Shared(0)
        let task = Task {
            for try await _ in source.samples().compensated() { got.change { $0 += 1 } }
        }
        try await eventually { manager.isMagnetometerActive }
        play(at: 1)
        try await eventually { got.value == 1 }
        task.cancel()
        try await task.value
        try await eventually { !manager.isMagnetometerActive && !manager.isDeviceMotionActive }
    }

    @Test func leavingTheLoopStopsTheUpdates() async throws {
        for _ in 0..<100 {
            let source = CoreMotionSource(manager: manager)
            let player = Player(manager: manager)
            let playing = Task {
                var time = 0.0
                while !Task.isCancelled {
                    time += 0.001
                    player.manager.magnetometer(at: time, 1, 2, time)
                    await Task.yield()
                }
            }
            for try await reading in source.samples().compensated() where reading.reading.window >= 0 { break }
            playing.cancel()
            try await eventually { !manager.isMagnetometerActive }
        }
    }

    /// The stand-in may be played from any thread.
    struct Player: @unchecked Sendable {
        let manager: CMMotionManager
    }

    @Test func twoIteratorsEachGetEveryEvent() async throws {
        let source = CoreMotionSource(options: SensorOptions(gyroscope: false, up: false), manager: manager)
        var first: SensorSamples.AsyncIterator? = source.samples().makeAsyncIterator()
        var second = source.samples().makeAsyncIterator()
        first?.start()
        second.start()
        #expect(manager.starts == 1, "they share the updates")
        for time in [1.0, 2.0] { manager.magnetometer(at: time, 1, 2, 3) }
        for time in [1, 2] {
            #expect(try await first?.next()?.timeNs == Int64(time) * 1_000_000_000)
            #expect(try await second.next()?.timeNs == Int64(time) * 1_000_000_000)
        }
        first = nil
        #expect(manager.isMagnetometerActive, "one is left")
        manager.magnetometer(at: 3, 1, 2, 3)
        #expect(try await second.next()?.timeNs == 3_000_000_000)
    }

    /// SwiftUI makes a view's initial state as often as the view, and keeps the first.
    @Test @MainActor func aModelThatIsNotRunMakesNoManager() async throws {
        let made = Shared(0)
        func manager() -> CMMotionManager {
            made.change { $0 += 1 }
            return CMMotionManager()
        }
        for _ in 0..<100 {
            let model = CompassModel(compass: Compass(source: CoreMotionSource(manager: manager())))
            #expect(model.compass.frame.axis == .auto)
        }
        #expect(made.value == 0)
        let source = CoreMotionSource(manager: manager())
        for _ in 0..<3 {
            let iterator = source.samples().makeAsyncIterator()
            iterator.start()
            withExtendedLifetime(iterator) {}
        }
        #expect(made.value == 1, "and then one")
        // as an app writes it
        #expect(CompassModel().reading == nil && CompassObject().state == CompassState())
    }

    @Test func iteratorsThatAreDroppedAtOnceStartNothing() async throws {
        let source = CoreMotionSource(manager: manager)
        for _ in 0..<1000 {
            _ = source.samples().makeAsyncIterator()
            _ = source.samples().compensated().makeAsyncIterator()
        }
        #expect(manager.starts == 0)
    }

    @Test func noEventIsDroppedBeforeTheEstimator() async throws {
        let samples = try await samples(20_000, SensorOptions(gyroscope: false, up: false)) {
            // all of them before the iterator asks for the first
            for k in 1...20_000 { manager.magnetometer(at: Double(k), 1, 2, 3) }
        }
        #expect(samples.map(\.timeNs) == (1...20_000).map { Int64($0) * 1_000_000_000 })
    }

    @Test func theOneLiner() async throws {
        // its own manager: nothing can be played, but it compiles as the documents say, and ends when told to
        let task = Task {
            for try await reading in Compass().readings() { print(reading.reading.status.text) }
        }
        task.cancel()
        try await task.value
    }
}
#endif
