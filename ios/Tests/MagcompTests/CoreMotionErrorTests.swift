#if canImport(CoreMotion) && !os(macOS)
import CoreMotion
import Foundation
@testable import Magcomp
import Testing

/// When ``CoreMotionSource`` ends with an error, and with which.
@Suite(.longest) struct CoreMotionErrorTests: OverCoreMotion {
    let manager = CMMotionManager()

    @Test func errorsOfAnotherDomainAreNotCoreMotions() async throws {
        for code in [CMErrorNotAuthorized, CMErrorDeviceRequiresMovement] {
            let error = NSError(domain: "org.other", code: Int(code.rawValue))
            let expected = CompassError.refused(sensor: .magnetometer, reason: "org.other \(code.rawValue)")
            await #expect(throws: expected) {
                try await samples(1) {
                    manager.magnetometerFails(error)
                    play(at: 1)
                }
            }
        }
    }

    @Test func aMissingSensorIsATypedErrorThatSaysWhatToDo() async throws {
        manager.lack(magnetometer: true)
        await #expect(throws: CompassError.missing(sensor: .magnetometer, advice: "hide the compass")) {
            try await samples(1) {}
        }
        manager.lack(deviceMotion: true)
        do {
            _ = try await samples(1) {}
            Issue.record("no error")
        } catch let error as CompassError {
            #expect(error.developerText.contains("CoreMotionSource.Options(gyroscope: false, up: false)"))
        }
        // and that works
        let alone = try await samples(1, CoreMotionSource.Options(gyroscope: false, up: false)) {
            manager.magnetometer(at: 1, 1, 2, 3)
        }
        #expect(alone.count == 1)
    }

    @Test func aFrameTheDeviceLacksIsATypedErrorThatSaysWhatToDo() async throws {
        final class WithoutCorrected: CMMotionManager {
            override class func availableAttitudeReferenceFrames() -> CMAttitudeReferenceFrame { .xArbitraryZVertical }
        }
        let manager = WithoutCorrected()
        var options = CoreMotionSource.Options(systemField: true)
        let missing = CompassError.missing(
            sensor: .calibratedField, advice: "use CoreMotionSource.Options(systemField: false)")
        await #expect(throws: missing) {
            var iterator = CoreMotionSource(options: options, scripted: manager).samples().makeAsyncIterator()
            iterator.start()
            manager.deviceMotion(at: 1, gravity: (0, 0, -1))
            _ = try await iterator.next()
        }
        #expect(manager.starts == 0 && manager.frame == [])
        options.systemField = false
        let without = CoreMotionSource(options: options, scripted: manager).samples().makeAsyncIterator()
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
            await #expect(throws: CompassError.accessRefused(sensor: .motion)) {
                var iterator = CoreMotionSource(scripted: manager).samples().makeAsyncIterator()
                iterator.start()
                // an event for who began nevertheless
                manager.deviceMotion(at: 1, gravity: (0, 0, -1))
                _ = try await iterator.next()
            }
            #expect(manager.starts == 0)
        }
        // nobody was asked yet, or the person allowed it
        for manager in [CMMotionManager(), Authorized()] {
            let iterator = CoreMotionSource(scripted: manager).samples().makeAsyncIterator()
            iterator.start()
            #expect(manager.starts == 1)
            withExtendedLifetime(iterator) {}
        }
    }

    @Test func optionsOutOfRangeAreATypedError() async throws {
        for holdS in [-0.01, 0.26, .nan] {
            let error = MagcompError.config(
                field: "CoreMotionSource.Options.holdS", value: "\(holdS)", expected: "0 to 0.25 s")
            await #expect(throws: error) { try await samples(1, CoreMotionSource.Options(holdS: holdS)) {} }
        }
        for rateHz in [0, -1, 1001] {
            let error = MagcompError.config(
                field: "CoreMotionSource.Options.rateHz", value: "\(rateHz)", expected: "1 to 1000")
            await #expect(throws: error) { try await samples(1, CoreMotionSource.Options(rateHz: rateHz)) {} }
        }
        #expect(manager.starts == 0)
    }

    @Test func refusedAccessEndsTheSequenceWithATypedError() async throws {
        for code in [CMErrorNotAuthorized, CMErrorNotEntitled] {
            await #expect(throws: CompassError.accessRefused(sensor: .magnetometer)) {
                try await samples(1) { manager.magnetometerFails(code.error) }
            }
            let words = CompassError.accessRefused(sensor: .magnetometer).developerText
            #expect(words.contains("Settings > Privacy & Security > Motion & Fitness"), "\(words)")
            #expect(!manager.isMagnetometerActive && !manager.isDeviceMotionActive)
        }
        await #expect(throws: CompassError.refused(sensor: .gyroscope, reason: "CMErrorDomain 109")) {
            try await samples(1) { manager.deviceMotionFails(CMErrorNotAvailable.error) }
        }
        // also after events, and through the compensator; what came before arrives
        var readings = CoreMotionSource(scripted: manager).samples().compensated().makeAsyncIterator()
        readings.start()
        try await eventually { manager.isMagnetometerActive }
        manager.magnetometer(at: 1, 1, 2, 3)
        manager.magnetometerFails(CMErrorUnknown.error)
        #expect(try await readings.next() != nil)
        await #expect(throws: CompassError.refused(sensor: .magnetometer, reason: "CMErrorDomain 103")) {
            try await readings.next()
        }
        // who tries again gets events again
        #expect(try await samples(1) { play(at: 2) }.count == 1)
    }

    /// Both sensors fail; the second error comes when somebody iterates again.
    @Test func anOldRunsErrorDoesNotEndANewOne() async throws {
        let source = CoreMotionSource(scripted: manager)
        var first = source.samples().makeAsyncIterator()
        first.start()
        let late = manager.lateDeviceMotionError()
        let (lateMagnetometer, lateDeviceMotion) = (manager.lateMagnetometer(), manager.lateDeviceMotion())
        manager.magnetometerFails(CMErrorUnknown.error)
        await #expect(throws: CompassError.self) { try await first.next() }
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
        await #expect(throws: CompassError.refused(sensor: .gyroscope, reason: "CMErrorDomain 103")) {
            while try await second.next() != nil {}
        }
    }

    @Test func theAuthorizationIsReadAsAMethodAndAsAProperty() {
        enum Older { static func authorizationStatus() -> CMAuthorizationStatus { .denied } }
        enum Newer { static var authorizationStatus: CMAuthorizationStatus { .restricted } }
        #expect(authorization(Older.authorizationStatus) == .denied)
        #expect(authorization(Newer.authorizationStatus) == .restricted)
    }

    @Test func anErrorThatPassesByItselfDoesNotEndTheSequence() async throws {
        let samples = try await samples(2) {
            manager.deviceMotionFails(CMErrorDeviceRequiresMovement.error)
            play(at: 1)
        }
        #expect(samples.count == 2)
    }
}
#endif
