import CoreMotion
import Foundation
@testable import Magcomp
import Testing

/// An app with a motion manager of its own pushes.
@Suite(.serialized) struct PushedSourceTests: OverCoreMotion {
    let manager = CMMotionManager()

    @Test func whatIsPushedIsWhatASourceOfCoreMotionGives() async throws {
        let options = SensorOptions(systemField: true)
        let theirs = try await samples(8, options) { for k in 1...2 { play(at: Double(k)) } }
        let source = PushedSource()
        var (one, other) = (source.samples().makeAsyncIterator(), source.samples().makeAsyncIterator())
        // nobody iterates yet
        source.push([.up(UpSample(timeNs: 0, upMS2: DeviceVector(x: 0, y: 0, z: 9.8)))])
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
            .magnetic(MagneticSample(timeNs: timeNs, fieldUt: DeviceVector(x: 1, y: 2, z: 3)))
        }
        func rate(_ timeNs: Int64) -> SensorSample {
            .rotationRate(RotationRateSample(timeNs: timeNs, rateRadS: DeviceVector(x: 1, y: 2, z: 3)))
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

    @Test(arguments: [-0.01, 0.26, .nan]) func aHoldOutOfRangeIsAnError(holdS: Double) async {
        let error = MagcompError.config(field: "PushedSource.holdS", value: "\(holdS)", expected: "0 to 0.25 s")
        await #expect(throws: error) { try await PushedSource(holdS: holdS).samples().collected() }
    }

    @Test func aPhoneWithoutASensorSaysSo() {
        #expect(CoreMotionSource.isAvailable(manager))
        manager.lack(magnetometer: true)
        #expect(!CoreMotionSource.isAvailable(manager))
        manager.lack(deviceMotion: true)
        #expect(!CoreMotionSource.isAvailable(manager))
    }
}
