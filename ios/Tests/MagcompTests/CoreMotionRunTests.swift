#if canImport(CoreMotion) && !os(macOS)
import CoreMotion
import Foundation
@_spi(Research) @testable import Magcomp
import Testing

/// When the updates of a ``CoreMotionSource`` begin and end, and who gets their events.
@Suite(.longest) struct CoreMotionRunTests: OverCoreMotion {
    let manager = CMMotionManager()

    @Test func updatesRunWhileIteratedAtTheRateAskedFor() async throws {
        let source = CoreMotionSource(options: CoreMotionSource.Options(rateHz: 50), scripted: manager)
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

    /// What an earlier run left waiting, and its lag, are not the next one's.
    @Test func anotherRunBeginsWithNothing() async throws {
        let source = CoreMotionSource(scripted: manager)
        var first: SensorSamples.AsyncIterator? = source.samples().makeAsyncIterator()
        first?.start()
        for time in [1, 1.01] { play(at: time) }
        #expect(try await first?.next() != nil)
        // waits for device motion
        manager.magnetometer(at: 1.02, 7, 7, 7)
        // it has come when the next one has
        manager.deviceMotion(at: 1.011, gravity: (0, 0, -1))
        try await eventually { source.lagS ?? 0 > 0 }
        first = nil
        try await eventually { !manager.isMagnetometerActive }
        var second = source.samples().makeAsyncIterator()
        second.start()
        #expect(source.lagS == nil)
        play(at: 1.03)
        #expect(try await second.next()?.timeNs == 1_030_000_000)
    }

    @Test func cancellingTheTaskStopsTheUpdates() async throws {
        let source = CoreMotionSource(scripted: manager)
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
            let source = CoreMotionSource(scripted: manager)
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
        let source = CoreMotionSource(options: CoreMotionSource.Options(gyroscope: false, up: false), scripted: manager)
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
        try #require(manager.isMagnetometerActive, "one is left")
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
            let model = CompassModel(compass: Compass(source: CoreMotionSource(options: { .compass }, manager: manager)))
            #expect(model.compass.frame.axis == .auto)
        }
        #expect(made.value == 0)
        let source = CoreMotionSource(options: { .compass }, manager: manager)
        for _ in 0..<3 {
            let iterator = source.samples().makeAsyncIterator()
            iterator.start()
            withExtendedLifetime(iterator) {}
        }
        #expect(made.value == 1, "and then one")
        // as an app writes it
        #expect(CompassModel().reading == nil)
    }

    @Test func iteratorsThatAreDroppedAtOnceStartNothing() async throws {
        let source = CoreMotionSource(scripted: manager)
        for _ in 0..<1000 {
            _ = source.samples().makeAsyncIterator()
            _ = source.samples().compensated().makeAsyncIterator()
        }
        #expect(manager.starts == 0)
    }

    @Test func noEventIsDroppedBeforeTheEstimator() async throws {
        let samples = try await samples(20_000, CoreMotionSource.Options(gyroscope: false, up: false)) {
            // all of them before the iterator asks for the first
            for k in 1...20_000 { manager.magnetometer(at: Double(k), 1, 2, 3) }
        }
        #expect(samples.map(\.timeNs) == (1...20_000).map { Int64($0) * 1_000_000_000 })
    }

    /// An app's own manager, with the defaults that apps get: a first heading by iOS's field, five seconds' grace, and what was learned is
    /// there at the next launch.
    @Test func aCompassWithTheAppsManagerKeepsWhatItLearned() async throws {
        let defaults = UserDefaults.standard, key = "org.magcomp.calibration"
        let before = defaults.string(forKey: key)
        defer { before.map { defaults.set($0, forKey: key) } ?? defaults.removeObject(forKey: key) }
        defaults.removeObject(forKey: key)
        nonisolated(unsafe) let app = manager
        func play(_ samples: Range<Int>) {
            for event in tumbling(samples.upperBound).suffix(2 * samples.count) {
                let timeS = Double(event.timeNs) * 1e-9
                switch event {
                case .up(let sample):
                    let g = sample.upMS2
                    manager.deviceMotion(at: timeS, gravity: (-g.x / 9.80665, -g.y / 9.80665, -g.z / 9.80665))
                case .magnetic(let sample):
                    manager.magnetometer(at: timeS, sample.fieldUt.x, sample.fieldUt.y, sample.fieldUt.z)
                default: break
                }
            }
        }
        do {
            let compass = Compass(manager: app)
            let seen = Shared<[CompensatedReading]>([])
            let first = reader(compass, seen)
            try await eventually { manager.isMagnetometerActive }
            #expect(manager.frame == .xArbitraryCorrectedZVertical)
            play(0..<900)
            try await eventually { seen.value.count >= 890 }
            first.cancel()
            try await first.value
            // nobody reads, and the sensors run on
            #expect(manager.isMagnetometerActive && seen.value.last?.headingDeg != nil)
            await compass.settled()
        }
        #expect(defaults.string(forKey: key)?.contains("magcomp_calibration") == true)
        // it is gone, and its sensors with it
        try await eventually { !manager.isMagnetometerActive }
        let next = Compass(manager: app)
        let again = Shared<[CompensatedReading]>([])
        let second = reader(next, again)
        try await eventually { manager.isMagnetometerActive }
        play(900..<930)
        try await eventually { !again.value.isEmpty }
        #expect(again.value[0].reading.fieldUt != nil, "it is known from the first sample on")
        second.cancel()
        try await second.value
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
