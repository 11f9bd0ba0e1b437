import Foundation
@testable import Magcomp
import Testing

/// What a screen shows, by readings made by hand.
@Suite struct ScreenTests {
    func answer(_ ms: Int64, _ headingDeg: Double?, true trueDeg: Double? = nil, sigma: Double? = 2) -> CompensatedReading {
        let heading = headingDeg.map {
            CompassHeading(headingDeg: $0, headingSigmaDeg: sigma, trueHeadingDeg: trueDeg, inclinationDeg: 60)
        }
        let sample = MagneticSample(timeNs: ms * 1_000_000, fieldUt: DeviceVector(x: 1, y: 2, z: 3))
        return CompensatedReading(reading: MagneticReading(status: .tracking, heading: heading), sample: sample)
    }

    /// The headings shown, nil where the reading was not shown.
    func shown(_ display: CompassDisplay, _ answers: [CompensatedReading]) -> [CompassState?] {
        var screen = CompassScreen(display)
        return answers.map { screen.see($0) ? screen.state : nil }
    }

    @Test func aHeadingWithoutASigmaIsAsUnsureAsCanBe() {
        let states = shown(CompassDisplay(), [answer(0, 10, sigma: nil), answer(100, nil), answer(200, 10)])
        #expect(states.map(\.?.headingSigmaDeg) == [180, 180, 2])
        #expect(states.map(\.?.headingDeg) == [10, nil, 10])
    }

    @Test func bothHeadingsAreSmoothedTheShorterWayRound() {
        let display = CompassDisplay(smoothingHalfLifeS: 0.1)
        let states = shown(display, [answer(0, 350, true: 353), answer(100, 10, true: 13)])
        #expect(abs((states[1]?.headingDeg ?? 99).remainder(dividingBy: 360)) < 1e-9)
        #expect(abs((states[1]?.trueHeadingDeg ?? 99) - 3) < 1e-9)
    }

    @Test func nothingIsSmoothedAcrossAMomentWithoutAHeading() {
        let display = CompassDisplay(smoothingHalfLifeS: 10)
        let states = shown(display, [answer(0, 100, true: 103), answer(100, nil), answer(200, 200, true: 203)])
        #expect(states[2]?.headingDeg == 200 && states[2]?.trueHeadingDeg == 203)
    }

    @Test func aClockThatBeginsAnewDoesNotFreezeIt() {
        let states = shown(CompassDisplay(rateHz: 10), [answer(60_000, 1), answer(0, 2), answer(50, 3), answer(100, 4)])
        #expect(states.map { $0 != nil } == [true, true, false, true])
    }

    @Test func theLastReadingIsShownWhenItEnds() {
        var screen = CompassScreen(CompassDisplay(rateHz: 10))
        #expect(screen.see(answer(0, 1)) && !screen.see(answer(10, 2)) && screen.state.headingDeg == 1)
        let ends = [screen.end(isLive: false), screen.state.headingDeg == 2, screen.end(isLive: false)]
        #expect(ends == [true, true, false])
        let sees = [screen.see(answer(200, 3)), screen.end(isLive: false)]
        #expect(sees == [true, false])
        // sensors that have ended leave no heading
        let isLost = screen.end(isLive: true)
        #expect(isLost && screen.state.headingDeg == nil && screen.state.reading?.isSilent == true)
        var other = CompassScreen(CompassDisplay(rateHz: 10))
        let isShown = other.end(isLive: true)
        #expect(!isShown && other.state == CompassState())
    }

    @Test func silenceIsShownAtOnceAndSoIsWhatComesAfterIt() {
        var screen = CompassScreen(CompassDisplay(rateHz: 10, smoothingHalfLifeS: 10))
        let before = [screen.see(answer(0, 1)), screen.see(answer(10, 2))]
        let isTold = screen.see(CompensatedReading(silentAfter: answer(10, 2).sample))
        #expect(before == [true, false] && isTold)
        let state = screen.state
        #expect(state.headingDeg == nil && state.headingSigmaDeg == 180 && state.trueHeadingDeg == nil)
        #expect(state.status == "the magnetometer delivers nothing" && state.guidance == nil && state.totalFieldUt == nil)
        // the one that waited is older, and is not smoothed into what comes
        let after = [screen.end(isLive: false), screen.see(answer(20, 90))]
        #expect(after == [false, true])
        #expect(screen.state.headingDeg == 90 && screen.state.status == "tracking")
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
            await compass.follow(CompassDisplay(rateHz: 1e6), retries: AsyncStream { $0.finish() }) { state in
                if let reading = state.reading { shown.change { $0.append(reading.sample.timeNs) } }
            }
        }
        try await source.live.started(1)
        let before = source.seen.value
        source.live.play(tumbling(300))
        func busy() {
            let deadline = ContinuousClock.now + .seconds(longestS)
            while source.seen.value < before + 300, ContinuousClock.now < deadline { Thread.sleep(forTimeInterval: 0.001) }
        }
        busy()
        #expect(source.seen.value == before + 300)
        try await eventually { @Sendable in shown.value.last == 300 * stepNs }
        // the one it waited for, the newest, and one the feeding was at
        #expect(shown.value.count <= 3, "\(shown.value.count) readings")
        running.cancel()
        await running.value
    }
}
