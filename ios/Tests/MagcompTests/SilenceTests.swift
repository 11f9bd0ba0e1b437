import Foundation
@testable import Magcomp
import Testing

/// Sensors that deliver nothing, without an error, leave no heading.
@Suite(.timeLimit(.minutes(2))) struct SilenceTests {
    private func compass(_ source: any MagneticFieldSource, silenceS: Double = 0.2) -> Compass {
        Compass(source: source, graceS: 0, silenceS: silenceS)
    }

    @Test func aSourceThatStopsIsToldOnceAndTheNextSampleGoesOn() async throws {
        let source = Live()
        let compass = compass(source)
        let seen = Shared<[CompensatedReading]>([])
        let task = reader(compass, seen)
        try await source.started(1)
        source.play(tumbling(600))
        try await eventually { seen.value.last?.isSilent == true }
        let silent = seen.value[600]
        #expect(seen.value[599].headingDeg != nil && !seen.value[..<600].contains { $0.isSilent })
        #expect(silent.headingDeg == nil && silent.headingSigmaDeg == nil && silent.attitude == nil)
        #expect(silent.reading.fieldUt == nil && silent.reading.totalFieldUt == nil && silent.timestamp == nil)
        #expect(silent.sample == seen.value[599].sample && silent.status == .collecting(missing: .samples(have: 0, need: 1)))
        #expect(silent.localizedText == "the magnetometer delivers nothing" && silent.localizedGuidance == nil)
        #expect(compass.latest?.isSilent == true)
        // once, however long it lasts; gyroscope and gravity alone are no samples
        for k in 0..<20 {
            source.play([.up(UpSample(timeNs: Int64(700 + k) * stepNs, upMS2: DeviceVector(x: 0, y: 0, z: 9.8)))])
            try await Task.sleep(for: .milliseconds(30))
        }
        #expect(seen.value.count == 601)
        source.play(flat(720))
        try await eventually { seen.value.count >= 602 }
        #expect(!seen.value[601].isSilent && seen.value[601].reading.fieldUt != nil && seen.value[601].droppedBefore == 0)
        // and again
        try await eventually { seen.value.last?.isSilent == true }
        task.cancel()
        try await task.value
    }

    @Test func oneThatNeverBeginsIsToldToo() async throws {
        let source = Live()
        let seen = Shared<[CompensatedReading]>([])
        let task = reader(compass(source), seen)
        try await source.started(1)
        try await eventually { seen.value.count == 1 }
        #expect(seen.value[0].isSilent && seen.value[0].sample.timeNs == 0)
        task.cancel()
        try await task.value
    }

    /// What apps get.
    @Test func twoSecondsAreSilence() async throws {
        let source = Live()
        let seen = Shared<[CompensatedReading]>([])
        let task = reader(Compass(source: source, config: CompensationConfig(), store: nil, graceS: 0), seen)
        try await source.started(1)
        source.play(flat(0))
        try await eventually { seen.value.first?.isSilent == false }
        let begin = ContinuousClock.now
        try await eventually { seen.value.last?.isSilent == true }
        // a machine that others use may be slower, not faster
        #expect(ContinuousClock.now - begin > .seconds(1.4))
        task.cancel()
        try await task.value
    }

    /// Sensors that call are watched as those that are asked.
    @Test func aPushedSourceIsWatched() async throws {
        let source = PushedSource()
        let compass = compass(source)
        let seen = Shared<[CompensatedReading]>([])
        let task = reader(compass, seen)
        try await eventually {
            if seen.value.isEmpty { source.push(tumbling(600)) }
            return seen.value.last?.isSilent == true && seen.value.count > 500
        }
        task.cancel()
        try await task.value
    }

    @Test func aSlowSourceAndARecordingAreNotSilent() async throws {
        let source = Live()
        let seen = Shared<[CompensatedReading]>([])
        let task = reader(compass(source, silenceS: 20), seen)
        try await source.started(1)
        for k in 0..<5 {
            source.play(flat(k))
            try await Task.sleep(for: .milliseconds(60))
        }
        try await eventually { seen.value.count == 5 }
        #expect(!seen.value.contains { $0.isSilent })
        task.cancel()
        try await task.value
        // a recording waits, whoever reads it
        let (stream, listener) = AsyncStream.makeStream(of: SensorSample.self)
        struct Waiting: MagneticFieldSource {
            let stream: AsyncStream<SensorSample>

            func samples() -> SensorSamples { SensorSamples(isLive: false) { stream } }
        }
        let played = Shared<[CompensatedReading]>([])
        let reading = reader(compass(Waiting(stream: stream), silenceS: 0.04), played)
        for event in flat(0) { listener.yield(event) }
        try await eventually { played.value.count == 1 }
        try await Task.sleep(for: .milliseconds(300))
        listener.finish()
        try await reading.value
        #expect(played.value.count == 1)
    }

    @Test func northInARKitsWorldIsLostToo() async throws {
        let source = Live()
        let compass = compass(source)
        let seen = Shared<[CompensatedReading]>([])
        let task = reader(compass, seen)
        try await source.started(1)
        source.play(tumbling(600))
        try await eventually { seen.value.count >= 600 }
        // attitudes are remembered from the first pose on
        for k in [600, 602] {
            _ = try compass.aid(
                with: AttitudeSample(timeNs: Int64(k) * stepNs, w: 1, x: 0, y: 0, z: 0, yaw: .relative))
            source.play(flat(k) + flat(k + 1))
            try await eventually { seen.value.last?.sample.timeNs == Int64(k + 2) * stepNs }
        }
        #expect(compass.arWorldNorth != nil)
        try await eventually { seen.value.last?.isSilent == true }
        #expect(compass.arWorldNorth == nil)
        task.cancel()
        try await task.value
    }

    @Test @MainActor func aScreenShowsNoHeadingOfSensorsThatHaveStopped() async throws {
        let source = Live()
        let model = CompassModel(compass: compass(source))
        let running = Task { await model.run() }
        try await source.started(1)
        source.play(tumbling(600))
        try await eventually { model.headingDeg != nil }
        try await eventually { model.headingDeg == nil }
        #expect(model.status == "the magnetometer delivers nothing" && model.error == nil && model.headingSigmaDeg == 180)
        #expect(model.guidance == nil && model.totalFieldUt == nil)
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
