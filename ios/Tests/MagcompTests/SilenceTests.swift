import Foundation
@testable import Magcomp
import Testing

/// Sensors that deliver nothing, without an error, leave no heading.
@Suite(.longest) struct SilenceTests {
    private let clock = StandingClock()

    private func compass(_ source: any MagneticFieldSource) -> Compass { Compass(source: source, clock: clock) }

    /// Once it reads and silence is watched for.
    private func reading(_ compass: Compass, _ seen: Shared<[CompensatedReading]>) async throws -> Task<Void, any Error> {
        let task = reader(compass, seen)
        try await eventually { clock.sleepers == 1 }
        return task
    }

    @Test func aSourceThatStopsIsToldOnceAndTheNextSampleGoesOn() async throws {
        let source = Live()
        let compass = compass(source)
        let seen = Shared<[CompensatedReading]>([])
        let task = try await reading(compass, seen)
        source.play(tumbling(600))
        try await eventually { seen.value.count == 600 }
        // two seconds, by looks of which the first finds the samples
        try await clock.look(4)
        #expect(seen.value.last?.headingDeg != nil && !seen.value.contains { $0.isSilent })
        try await clock.look(1)
        try await eventually { seen.value.count == 601 }
        let silent = try #require(seen.value.last)
        #expect(silent.isSilent)
        #expect(silent.headingDeg == nil && silent.headingSigmaDeg == nil && silent.attitude == nil)
        #expect(silent.reading.fieldUt == nil && silent.reading.totalFieldUt == nil && silent.timestamp == nil)
        #expect(silent.sample == seen.value[599].sample && silent.status == .collecting(missing: .samples(have: 0, need: 1)))
        #expect(silent.localizedText == "the magnetometer delivers nothing" && silent.localizedGuidance == nil)
        #expect(compass.latest?.isSilent == true)
        // once, however long it lasts; gyroscope and gravity alone are no samples
        for k in 0..<20 {
            source.play([.up(SensorSample.Up(timeNs: Int64(700 + k) * stepNs, upMS2: DeviceVector(x: 0, y: 0, z: 9.8)))])
            try await clock.look(1)
        }
        #expect(seen.value.count == 601)
        source.play(flat(720))
        try await eventually { seen.value.count == 602 }
        let next = try #require(seen.value.last)
        #expect(!next.isSilent && next.reading.fieldUt != nil && next.droppedBefore == 0)
        // and again
        try await clock.look(5)
        try await eventually { seen.value.count == 603 }
        #expect(seen.value.last?.isSilent == true)
        task.cancel()
        try await task.value
    }

    @Test func oneThatNeverBeginsIsToldToo() async throws {
        let seen = Shared<[CompensatedReading]>([])
        let task = try await reading(compass(Live()), seen)
        try await clock.look(3)
        #expect(seen.value.isEmpty)
        try await clock.look(1)
        try await eventually { seen.value.count == 1 }
        #expect(seen.value.first?.isSilent == true && seen.value.first?.sample.timeNs == 0)
        task.cancel()
        try await task.value
    }

    /// Sensors that call are watched as those that are asked.
    @Test func aPushedSourceIsWatched() async throws {
        let source = PushedSource()
        let compass = compass(source)
        let seen = Shared<[CompensatedReading]>([])
        let task = try await reading(compass, seen)
        try await eventually { source.listeners == 1 }
        source.push(tumbling(600))
        try await eventually { seen.value.count > 500 }
        // what it holds back may come meanwhile
        for _ in 0..<20 where compass.latest?.isSilent != true { try await clock.look(1) }
        try await eventually { seen.value.last?.isSilent == true }
        task.cancel()
        try await task.value
    }

    @Test func aSlowSourceAndARecordingAreNotSilent() async throws {
        let source = Live()
        let seen = Shared<[CompensatedReading]>([])
        let task = try await reading(compass(source), seen)
        for k in 0..<5 {
            source.play(flat(k))
            try await eventually { seen.value.count == k + 1 }
            try await clock.look(4)
        }
        #expect(seen.value.count == 5 && !seen.value.contains { $0.isSilent })
        task.cancel()
        try await task.value
        // a recording waits, whoever reads it
        let (stream, listener) = AsyncStream.makeStream(of: SensorSample.self)
        struct Waiting: MagneticFieldSource {
            let stream: AsyncStream<SensorSample>

            func samples() -> SensorSamples { SensorSamples(isLive: false) { stream } }
        }
        let played = Shared<[CompensatedReading]>([])
        let reading = try await reading(compass(Waiting(stream: stream)), played)
        for event in flat(0) { listener.yield(event) }
        try await eventually { played.value.count == 1 }
        for _ in 0..<10 { try await clock.turn(5) }
        listener.finish()
        try await reading.value
        #expect(played.value.count == 1)
    }

    @Test func northInARKitsWorldIsLostToo() async throws {
        let source = Live()
        let compass = compass(source)
        let seen = Shared<[CompensatedReading]>([])
        let task = try await reading(compass, seen)
        source.play(tumbling(600))
        try await eventually { seen.value.count == 600 }
        // attitudes are remembered from the first pose on
        for k in [600, 602] {
            _ = try compass.aid(
                with: SensorSample.Attitude(timeNs: Int64(k) * stepNs, w: 1, x: 0, y: 0, z: 0, yaw: .relative))
            source.play(flat(k) + flat(k + 1))
            try await eventually { seen.value.last?.sample.timeNs == Int64(k + 2) * stepNs }
        }
        #expect(compass.arWorldNorth != nil)
        try await clock.look(5)
        #expect(compass.latest?.isSilent == true && compass.arWorldNorth == nil)
        task.cancel()
        try await task.value
    }

    @Test @MainActor func aScreenShowsNoHeadingOfSensorsThatHaveStopped() async throws {
        let source = Live()
        let model = CompassModel(compass: compass(source))
        let running = Task { await model.run() }
        try await eventually { clock.sleepers == 1 }
        source.play(tumbling(600))
        try await eventually { model.compass.latest?.sample.timeNs == 600 * stepNs && model.headingDeg != nil }
        try await clock.look(5)
        try await eventually { model.headingDeg == nil }
        #expect(model.status == "the magnetometer delivers nothing" && model.error == nil && model.headingSigmaDeg == 180)
        #expect(model.guidance == nil && model.reading?.reading.totalFieldUt == nil)
        source.play((700..<720).flatMap { flat($0) })
        try await eventually { model.headingDeg != nil && model.status != "the magnetometer delivers nothing" }
        running.cancel()
        await running.value
        // nothing is left when nobody looks
        #expect(model.headingDeg == nil && model.reading == nil && model.status == "starting" && model.coverage == 0)
    }

    @Test @MainActor func sensorsThatEndLeaveNoHeadingAndARecordingItsLast() async throws {
        let live = CompassModel(compass: compass(Played(events: tumbling(600))))
        await live.run()
        #expect(live.headingDeg == nil && live.status == "the magnetometer delivers nothing")
        let recording = CompassModel(compass: compass(Played(events: tumbling(600), isLive: false)))
        await recording.run()
        #expect(recording.headingDeg != nil && recording.status == "tracking")
    }
}
