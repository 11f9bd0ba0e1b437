import Foundation
@testable import Magcomp
import Testing

@Suite struct SimulatedSourceTests {
    @Test func aCompassLearnsFromItAndItsHeadingIsTheMadeUpOne() async throws {
        var (tracking, errors) = (false, [Double]())
        for try await answer in Compass(source: SimulatedSource(speed: nil)).readings() {
            let seconds = Double(answer.sample.timeNs) * 1e-9
            tracking = tracking || answer.reading.status == .tracking
            if answer.sample.timeNs > 15_000_000_000 {
                let heading = try #require(answer.reading.heading)
                let sigma = try #require(heading.headingSigmaDeg)
                let error = (heading.headingDeg - SimulatedSource.headingDeg(seconds)).remainder(dividingBy: 360)
                errors.append(error / sigma)
                #expect(sigma < 10)
            }
            if answer.sample.timeNs >= 60_000_000_000 { break }
        }
        #expect(tracking && errors.count == 4500)
        // the gyroscope agrees with the field, or the compensator would not believe them
        #expect((errors.reduce(0) { $0 + $1 * $1 } / 4500).squareRoot() < 2)
    }

    @Test func everyAxisOfItsMagnetometerHasNoise() async throws {
        // held nearly flat it turns by less than 0.2 degrees a sample, so nearly all of the difference of two is noise: 2 * 0.3^2
        var (samples, noise) = ([SIMD3<Double>](), SIMD3<Double>.zero)
        for try await event in SimulatedSource(speed: nil).samples() {
            guard case .magnetic(let sample) = event, sample.timeNs > 20_000_000_000 else { continue }
            samples.append(SIMD3(sample.fieldUt))
            if samples.count == 1000 { break }
        }
        for (one, next) in zip(samples, samples.dropFirst()) { noise += (next - one) * (next - one) / 999 }
        for axis in 0..<3 { #expect(0.1 < noise[axis] && noise[axis] < 0.3) }
    }

    @Test func theGyroscopeTellsHowTheOthersTurn() async throws {
        var (rate, up) = (DeviceVector(x: 0, y: 0, z: 0), DeviceVector?.none)
        var worst = 0.0
        for try await event in SimulatedSource(speed: nil).samples() {
            switch event {
            case .rotationRate(let sample): rate = sample.rateRadS
            case .up(let sample):
                if let before = up {
                    // the world turns the other way
                    let cross = DeviceVector(
                        x: before.y * rate.z - before.z * rate.y, y: before.z * rate.x - before.x * rate.z,
                        z: before.x * rate.y - before.y * rate.x)
                    worst = max(worst, (sample.upMS2 + before * -1 + cross * -0.01).length)
                }
                up = sample.upMS2
            default: break
            }
            if event.timeNs > 20_000_000_000 { break }
        }
        #expect(worst < 0.2 && worst > 0, "\(worst) m/s^2, where 0.3 and more goes by in a step")
    }

    @Test func everyIteratorGetsTheSameAtItsPace() async throws {
        final class Clock: WaitingClock {
            let slept = Shared<[Int64]>([])

            var nowNs: Int64 { slept.value.reduce(0, +) }

            func sleep(forNs ns: Int64) async throws { slept.change { $0.append(ns) } }
        }
        func first(_ source: SimulatedSource) async throws -> [SensorSample] {
            var (iterator, all) = (source.samples().makeAsyncIterator(), [SensorSample]())
            while all.count < 300, let event = try await iterator.next() { all.append(event) }
            return all
        }
        let clock = Clock()
        let (played, read) = (
            try await first(SimulatedSource(speed: 2, clock: clock)), try await first(SimulatedSource(speed: nil))
        )
        #expect(played == read && played.count == 300)
        #expect(clock.slept.value == Array(repeating: 5_000_000, count: 99), "100 steps of 10 ms, twice as fast")
        await #expect(throws: MagcompError.config(field: "SimulatedSource.speed", value: "0.0", expected: "above 0")) {
            try await first(SimulatedSource(speed: 0))
        }
    }
}
