import Foundation
@testable import Magcomp
import Testing

/// What a screen shows, by readings made by hand.
@Suite struct ScreenTests {
    func answer(_ ms: Int64, _ headingDeg: Double?, true trueDeg: Double? = nil, sigma: Double? = 2) -> CompensatedReading {
        let heading = headingDeg.map {
            CompassHeading(headingDeg: $0, headingSigmaDeg: sigma, trueHeadingDeg: trueDeg, inclinationDeg: 60)
        }
        let sample = SensorSample.Magnetic(timeNs: ms * 1_000_000, fieldUt: DeviceVector(x: 1, y: 2, z: 3))
        return CompensatedReading(reading: MagneticReading(status: .tracking, heading: heading), sample: sample)
    }

    /// What is shown of each.
    func shown(_ answers: [CompensatedReading], halfLifeS: Double? = nil) -> [CompassState] {
        var screen = CompassScreen(smoothingHalfLifeS: halfLifeS)
        return answers.map {
            screen.see($0)
            return screen.state
        }
    }

    @Test func aHeadingWithoutASigmaIsAsUnsureAsCanBe() {
        let states = shown([answer(0, 10, sigma: nil), answer(100, nil), answer(200, 10)])
        #expect(states.map(\.headingSigmaDeg) == [180, 180, 2])
        #expect(states.map(\.headingDeg) == [10, nil, 10])
    }

    @Test func bothHeadingsAreSmoothedTheShorterWayRound() {
        let states = shown([answer(0, 350, true: 353), answer(100, 10, true: 13)], halfLifeS: 0.1)
        #expect(abs((states[1].headingDeg ?? 99).remainder(dividingBy: 360)) < 1e-9)
        #expect(abs((states[1].trueHeadingDeg ?? 99) - 3) < 1e-9)
    }

    @Test func nothingIsSmoothedAcrossAMomentWithoutAHeading() {
        let states = shown([answer(0, 100, true: 103), answer(100, nil), answer(200, 200, true: 203)], halfLifeS: 10)
        #expect(states[2].headingDeg == 200 && states[2].trueHeadingDeg == 203)
    }

    /// What a screen of 10 Hz is given.
    private func given(_ answers: [CompensatedReading]) async throws -> [Int64] {
        let reader = Reader(run: 1, capacity: 10, rateHz: 10)
        #expect(reader.take(answers[...], waits: true).isEmpty)
        reader.finish()
        var times: [Int64] = []
        while let answer = try await reader.next(isolation: nil) {
            times.append(answer.isSilent ? -1 : answer.sample.timeNs / 1_000_000)
        }
        return times
    }

    @Test func aClockThatBeginsAnewDoesNotFreezeIt() async throws {
        let times = try await given([answer(60_000, 1), answer(0, 2), answer(50, 3), answer(100, 4)])
        #expect(times == [60_000, 0, 100])
    }

    @Test func silenceIsShownAtOnceAndSoIsWhatComesAfterIt() async throws {
        let silent = CompensatedReading(silentAfter: answer(10, 2).sample)
        // the one that waited is older
        let times = try await given([answer(0, 1), answer(10, 2), silent, answer(20, 90), answer(30, 91)])
        #expect(times == [0, -1, 20, 30])
        let states = shown([answer(0, 1), silent, answer(20, 90)], halfLifeS: 10)
        #expect(states[1].headingDeg == nil && states[1].headingSigmaDeg == 180 && states[1].trueHeadingDeg == nil)
        #expect(states[1].status == "the magnetometer delivers nothing" && states[1].guidance == nil)
        // and is not smoothed into what comes
        #expect(states[2].headingDeg == 90 && states[2].status == "tracking")
    }

    @Test @MainActor func theLastReadingIsShownWhenARecordingEndsAndNoneOfSensorsThatHaveEnded() async throws {
        for isLive in [false, true] {
            let model = CompassModel(compass: Compass(source: Played(events: tumbling(601), isLive: isLive)), rateHz: 1)
            await model.run()
            #expect(model.reading?.sample.timeNs == 601 * stepNs)
            #expect((model.headingDeg == nil) == isLive && model.reading?.isSilent == isLive)
            // nothing came
            let other = CompassModel(compass: Compass(source: Played(events: [], isLive: isLive)))
            await other.run()
            #expect(other.reading == nil && other.status == "starting")
        }
    }

    /// The main thread was busy: what it sees then is the newest reading, not those that piled up.
    @Test @MainActor func aScreenThatWasBusyShowsTheNewest() async throws {
        struct Counting: MagneticFieldSource {
            let live = Live()
            let seen = Shared(0)

            // read with every sample
            var hiddenS: Double {
                seen.change { $0 += 1 }
                return 0
            }

            func samples() -> SensorSamples { live.samples() }
        }
        let source = Counting()
        let shown = Shared<[Int64]>([])
        let compass = Compass(source: source)
        let running = Task {
            let retries = AsyncStream<Void> { $0.finish() }
            await compass.follow(rateHz: 1e6, smoothingHalfLifeS: nil, retries: retries) { state in
                if let reading = state.reading { shown.change { $0.append(reading.sample.timeNs) } }
            }
        }
        try await source.live.started(1)
        let before = source.seen.value
        source.live.play(tumbling(300))
        busy { source.seen.value >= before + 300 }
        #expect(source.seen.value == before + 300)
        try await eventually { @Sendable in shown.value.last == 300 * stepNs }
        // the one it waited for, the newest, and one the feeding was at
        #expect(shown.value.count <= 3, "\(shown.value.count) readings")
        running.cancel()
        await running.value
    }
}
