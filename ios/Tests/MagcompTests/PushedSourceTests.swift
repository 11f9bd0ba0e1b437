import CoreMotion
import Foundation
@testable import Magcomp
import Testing

/// An app with a motion manager of its own pushes.
@Suite(.serialized) struct PushedSourceTests: OverCoreMotion {
    let manager = CMMotionManager()

    @Test func whatIsPushedIsWhatASourceOfCoreMotionGives() async throws {
        let options = CoreMotionSource.Options(systemField: true)
        let theirs = try await samples(8, options) { for k in 1...2 { play(at: Double(k)) } }
        let source = PushedSource()
        var (one, other) = (source.samples().makeAsyncIterator(), source.samples().makeAsyncIterator())
        // nobody iterates yet
        source.push([.up(SensorSample.Up(timeNs: 0, upMS2: DeviceVector(x: 0, y: 0, z: 9.8)))])
        one.start()
        other.start()
        let app = CMMotionManager()
        // events of one time keep their order
        let queue = OperationQueue()
        queue.maxConcurrentOperationCount = 1
        app.startMagnetometerUpdates(to: queue) { data, _ in
            if let data { source.push(SensorSample.events(of: data)) }
        }
        app.startDeviceMotionUpdates(using: .xArbitraryCorrectedZVertical, to: queue) { motion, _ in
            if let motion { source.push(SensorSample.events(of: motion, options)) }
        }
        for k in 1...2 {
            app.deviceMotion(at: Double(k), gravity: (0, 0, -1))
            app.magnetometer(at: Double(k), 1, 2, 3)
        }
        for k in 0..<8 {
            #expect(try await one.next() == theirs[k], "\(k)")
            #expect(try await other.next() == theirs[k], "\(k)")
        }
    }

    @Test func eventsGoOutInOrderOfTheirTimes() async throws {
        let source = PushedSource()
        var iterator = source.samples().makeAsyncIterator()
        iterator.start()
        func magnetic(_ timeNs: Int64) -> SensorSample {
            .magnetic(SensorSample.Magnetic(timeNs: timeNs, fieldUt: DeviceVector(x: 1, y: 2, z: 3)))
        }
        func rate(_ timeNs: Int64) -> SensorSample {
            .rotationRate(SensorSample.RotationRate(timeNs: timeNs, rateRadS: DeviceVector(x: 1, y: 2, z: 3)))
        }
        source.push([magnetic(10_000_000), magnetic(20_000_000)])
        // another one takes nothing from what waits
        var other = source.samples().makeAsyncIterator()
        other.start()
        source.push([rate(5_000_000), rate(15_000_000), rate(25_000_000), magnetic(75_000_000)])
        var times: [Int64] = []
        for _ in 0..<3 { times.append(try await iterator.next()?.timeNs ?? 0) }
        try #require(times == [5_000_000, 10_000_000, 15_000_000])
        #expect(try await iterator.next()?.timeNs == 20_000_000)
        #expect(try await other.next()?.timeNs == 5_000_000)
    }

    /// A second reader, once the first has left: nothing of the first's is left, and the order begins anew.
    @Test func whoHasLeftGetsNothingAndTheNextBeginsAnew() async throws {
        let source = PushedSource()
        func up(_ timeNs: Int64) -> SensorSample {
            .up(SensorSample.Up(timeNs: timeNs, upMS2: DeviceVector(x: 0, y: 0, z: 9.8)))
        }
        let (first, second) = (Shared<[Int64]>([]), Shared<[Int64]>([]))
        func read(_ seen: Shared<[Int64]>) -> Task<Void, any Error> {
            let iterator = source.samples().makeAsyncIterator()
            iterator.start()
            return Task {
                var iterator = iterator
                while let event = try await iterator.next() { seen.change { $0.append(event.timeNs) } }
            }
        }
        let one = read(first)
        source.push([up(1_000_000_000), up(1_010_000_000), up(2_000_000_000)])
        try await eventually { first.value.count == 2 }
        one.cancel()
        try await one.value
        try await eventually { source.listeners == 0 }
        // the one that waited is the first's, and is gone with it
        let two = read(second)
        #expect(source.listeners == 1)
        source.push([up(3_000_000_000), up(3_010_000_000), up(4_000_000_000)])
        try await eventually { second.value.count == 2 }
        #expect(second.value == [3_000_000_000, 3_010_000_000] && first.value == [1_000_000_000, 1_010_000_000])
        two.cancel()
        try await two.value
    }

    /// An estimator is pushed where the events come: as a recording's, reading for reading, and to its end.
    @Test func aCompassReadsItAsItReadsARecording() async throws {
        let source = PushedSource(holdS: 0)
        let compass = Compass(source: source, graceS: 0)
        let seen = Shared<[CompensatedReading]>([])
        let task = reader(compass, seen)
        let events = tumbling(900)
        try await eventually { source.listeners == 1 }
        for k in stride(from: 0, to: events.count, by: 7) { source.push(Array(events[k..<min(k + 7, events.count)])) }
        try await eventually { seen.value.count == 900 }
        let played = try await Compass(source: Played(events: events, isLive: false)).readings().collected()
        #expect(seen.value.map(\.reading) == played.map(\.reading) && seen.value.allSatisfy { $0.timestamp != nil })
        // two threads at once
        await withTaskGroup(of: Void.self) { group in
            for _ in 0..<4 { group.addTask { for k in 0..<50 { source.push(flat(1000 + k)) } } }
        }
        try await eventually { seen.value.count == 1100 }
        task.cancel()
        try await task.value
        #expect(source.listeners == 0)
        source.push(flat(2000))
        #expect(seen.value.count == 1100)
    }

    /// Its last call was on its way when it was told to stop.
    @Test func whatComesAfterTheEndIsNotTaken() async throws {
        struct Deaf: MagneticFieldSource {
            let listener = Shared<SensorSamples.Listener?>(nil)
            let taken = Shared(0)

            // read with every sample
            var hiddenS: Double {
                taken.change { $0 += 1 }
                return 0
            }

            func samples() -> SensorSamples {
                SensorSamples.calls { [listener] new in
                    listener.change { $0 = new }
                    return {}
                }
            }
        }
        let source = Deaf()
        let compass = Compass(source: source)
        let seen = Shared<[CompensatedReading]>([])
        let task = reader(compass, seen)
        try await eventually { source.listener.value != nil }
        let before = source.taken.value
        source.listener.value?.take(flat(0))
        try await eventually { seen.value.count == 1 }
        task.cancel()
        try await task.value
        source.listener.value?.take(flat(1))
        #expect(source.taken.value == before + 1)
    }

    @Test(arguments: [-0.01, 0.26, .nan]) func aHoldOutOfRangeIsAnError(holdS: Double) async {
        let error = MagcompError.config(field: "PushedSource.holdS", value: "\(holdS)", expected: "0 to 0.25 s")
        await #expect(throws: error) { try await PushedSource(holdS: holdS).samples().collected() }
        await #expect(throws: error) { try await Compass(source: PushedSource(holdS: holdS)).readings().collected() }
    }

    @Test func aPhoneWithoutASensorSaysSo() {
        #expect(CoreMotionSource.isAvailable(manager))
        manager.lack(magnetometer: true)
        #expect(!CoreMotionSource.isAvailable(manager))
        manager.lack(deviceMotion: true)
        #expect(!CoreMotionSource.isAvailable(manager))
    }
}
