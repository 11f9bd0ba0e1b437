import Foundation
@testable import Magcomp
import Testing

/// One model for many views, and sensors that run on a little.
@Suite @MainActor struct SharedRunTests {
    /// A view that shows a model: its task.
    func view(_ model: CompassModel) -> Task<Void, Never> { Task { await model.run() } }

    func shows(_ model: CompassModel, sample k: Int) async throws {
        try await eventually { model.reading?.sample.timeNs == Int64(k) * stepNs }
    }

    @Test func viewsOfOneModelShareItsRun() async throws {
        let source = Live()
        let model = CompassModel(
            compass: Compass(source: source), rateHz: 1e6, smoothingHalfLifeS: 1)
        let first = view(model)
        try await source.started(1)
        source.play(tumbling(600))
        try await shows(model, sample: 600)
        let heading = try #require(model.headingDeg)
        var blanks = 0
        CompassModelTests.follow({ model.headingDeg }) { if $0 == nil { blanks += 1 } }
        let second = view(model)
        for _ in 0..<50 { await Task.yield() }
        #expect(model.headingDeg == heading && model.status == "tracking")
        // one smoother: it goes a little every time, and never back
        var shown: [Double] = []
        for k in 600..<605 {
            source.play(flat(k))
            try await shows(model, sample: k + 1)
            for _ in 0..<20 { await Task.yield() }
            shown.append(try #require(model.headingDeg))
        }
        let steps = zip(shown, shown.dropFirst()).map { ($1 - $0).remainder(dividingBy: 360) }
        #expect(steps.allSatisfy { $0 * steps[0] > 0 && abs($0) < 5 }, "\(shown)")
        // the other view goes on
        first.cancel()
        await first.value
        source.play(flat(605))
        try await shows(model, sample: 606)
        #expect(source.state.value.starts == 1 && source.state.value.ends == 0 && blanks == 0)
        second.cancel()
        await second.value
        try await eventually { source.state.value.ends == 1 }
    }

    @Test func aViewThatComesWhileTheLastOneLeavesHasARunOfItsOwn() async throws {
        let source = Live()
        let model = CompassModel(compass: Compass(source: source), rateHz: 1e6)
        let first = view(model)
        try await source.started(1)
        first.cancel()
        let second = view(model)
        await first.value
        try await source.started(2)
        source.play(tumbling(3))
        try await shows(model, sample: 3)
        // who was cancelled before it began starts nothing
        let third = view(model)
        third.cancel()
        await third.value
        second.cancel()
        await second.value
        try await eventually { source.state.value.ends == 2 }
        #expect(source.state.value.starts == 2)
    }

    @Test func whoLeavesLastWaitsForTheRunsEnd() async throws {
        let (runs, begun, ended) = (SharedRun(), Shared(false), Shared(false))
        let view = Task {
            await runs.join { _ in
                begun.change { $0 = true }
                while !Task.isCancelled { await Task.yield() }
                for _ in 0..<50 { await Task.yield() }
                ended.change { $0 = true }
            }
        }
        try await eventually { begun.value }
        view.cancel()
        await view.value
        #expect(ended.value)
    }

    @Test func everyViewEndsWithTheSource() async throws {
        let source = Live()
        let (model, other) = (
            CompassModel(compass: Compass(source: source)), CompassModel(compass: Compass(source: Played(events: [])))
        )
        let views = [view(model), view(model)]
        try await source.started(1)
        source.finish(CompassError.accessRefused(sensor: .motion))
        for view in views { await view.value }
        #expect(model.error == .accessRefused(sensor: .motion))
        // nothing to try again
        model.retry()
        await other.run()
        other.retry()
        #expect(source.state.value.starts == 1)
    }

    @Test func whatMayPassIsTriedAgainWhenItIsAskedFor() async throws {
        let source = Live()
        let model = CompassModel(compass: Compass(source: source), rateHz: 1e6)
        let views = [view(model), view(model)]
        for run in 1...3 {
            try await source.started(run)
            source.play(tumbling(600))
            try await shows(model, sample: 600)
            // nothing to try again yet
            model.retry()
            source.finish(CompassError.refused(sensor: .magnetometer, reason: "CMErrorDomain 103"))
            try await eventually { model.error?.mayPass == true }
            #expect(model.headingDeg == nil && model.status == "The magnetometer has stopped.")
            #expect(source.state.value.starts == run)
            // twice is once: the next error waits to be asked about
            model.retry()
            model.retry()
        }
        try await source.started(4)
        #expect(model.error == nil && model.headingDeg == nil)
        for view in views { view.cancel() }
        for view in views { await view.value }
        try await eventually { source.state.value.ends == 4 }
        #expect(!CompassError.library(.closed).mayPass && !CompassError.accessRefused(sensor: .motion).mayPass)
    }

    @Test func whoWaitsToTryAgainLeavesWhenItsViewDoes() async throws {
        let source = Live()
        let model = CompassModel(compass: Compass(source: source))
        let running = Task { await model.run() }
        try await source.started(1)
        source.finish(CompassError.refused(sensor: .magnetometer, reason: "CMErrorDomain 103"))
        try await eventually { model.error?.mayPass == true }
        running.cancel()
        await running.value
        #expect(model.error == nil && model.status == "starting")
        model.retry()
        for _ in 0..<50 { await Task.yield() }
        #expect(source.state.value.starts == 1)
    }

    /// A recording is at its place when the next reader comes: with the grace time that apps have it would have played on.
    @Test func aRecordingEndsAtOnceForAllItsGraceTime() async throws {
        let (source, given) = (Shared(0), Shared(0))
        struct Counting: MagneticFieldSource {
            let starts, given: Shared<Int>

            func samples() -> SensorSamples {
                starts.change { $0 += 1 }
                return SensorSamples(isLive: false) { [given] in
                    AsyncStream(unfolding: {
                        given.change { $0 += 1 }
                        return flat(given.value)[1]
                    })
                }
            }
        }
        let compass = Compass(source: Counting(starts: source, given: given), graceS: 5)
        for try await _ in compass.readings(capacity: 4) { break }
        // another run begins, so the first has ended
        for try await _ in compass.readings(capacity: 4) { break }
        let count = given.value
        try await Task.sleep(for: .milliseconds(100))
        #expect(source.value == 2 && given.value <= count + 1 && count < 40)
    }

    /// A tab that goes and comes.
    @Test func aScreenThatComesBackInTimeHasItsHeadingAtOnce() async throws {
        let (source, store) = (Live(), Slow())
        var compass: Compass? = Compass(source: source, store: store, graceS: 5)
        let seen = Shared<[CompensatedReading]>([])
        let first = reader(try #require(compass), seen)
        try await source.started(1)
        source.play(tumbling(900))
        try await eventually { seen.value.count == 900 }
        await compass?.settled()
        let saved = store.kept.value
        first.cancel()
        try await first.value
        // the app may end in the grace time: all was saved
        await compass?.settled()
        #expect(store.kept.value != nil && store.kept.value != saved)
        source.play(flat(900))
        try await eventually { compass?.latest?.sample.timeNs == 901 * stepNs }
        let model = CompassModel(compass: try #require(compass))
        var texts: [String] = []
        CompassModelTests.follow({ model.status }) { texts.append($0) }
        let second = view(model)
        try await shows(model, sample: 901)
        // the text before each change: only the new model's own beginning
        #expect(model.headingDeg != nil && texts.filter { $0 == "starting" }.count == 1)
        second.cancel()
        await second.value
        for _ in 0..<50 { await Task.yield() }
        #expect(source.state.value.starts == 1 && source.state.value.ends == 0)
        // the sensors stop when nobody can come back: the model has the compass
        compass = nil
        withExtendedLifetime(model) { #expect(source.state.value.ends == 0) }
    }

    /// A sample that comes when a screen has shown that it begins, and before it reads.
    @Test func aScreenThatComesBackMissesNothing() async throws {
        let source = PushedSource(holdS: 0)
        let compass = Compass(source: source, graceS: 5)
        let first = reader(compass, Shared([]))
        try await eventually { source.listeners == 1 }
        source.push(tumbling(3))
        first.cancel()
        try await first.value
        let shown = Shared<[Int64]>([])
        let second = Task {
            let retries = AsyncStream<Void> { $0.finish() }
            await compass.follow(rateHz: 1e6, smoothingHalfLifeS: nil, retries: retries) { state in
                if shown.value.isEmpty { source.push(flat(3)) }
                shown.change { $0.append((state.reading?.sample.timeNs ?? 0) / stepNs) }
            }
        }
        try await eventually { shown.value.last == 4 }
        #expect(shown.value == [0, 4])
        second.cancel()
        await second.value
    }

    @Test func whoComesBackInTimeReadsOnWhenItIsOver() async throws {
        let source = Live()
        let clock = StandingClock()
        let compass = Compass(source: source, graceS: 5, clock: clock)
        let leaving = reader(compass, Shared([]))
        try await source.started(1)
        source.play(flat(0))
        try await eventually { compass.latest != nil }
        leaving.cancel()
        try await leaving.value
        let seen = Shared<[CompensatedReading]>([])
        let staying = reader(compass, seen)
        // the silence's watch waits too
        try await clock.turn(5, for: 2)
        try await clock.look(1)
        source.play(flat(1))
        try await eventually { seen.value.count == 1 || source.state.value.ends == 1 }
        #expect(seen.value.count == 1 && source.state.value.starts == 1)
        staying.cancel()
        try await staying.value
    }

    @Test func sensorsStopWhenTheGraceTimeIsOverOrNobodyCanComeBack() async throws {
        let source = Live()
        let clock = StandingClock()
        var compass: Compass? = Compass(source: source, graceS: 5, clock: clock)
        for run in 1...2 {
            let task = reader(try #require(compass), Shared([]))
            try await source.started(run)
            source.play(tumbling(1))
            try await eventually { compass?.latest != nil }
            task.cancel()
            try await task.value
            // the silence's watch waits too
            try await clock.turn(4.9, for: 2)
            try await clock.turn(0.05, for: 2)
            #expect(source.state.value.ends == run - 1 && compass?.latest != nil)
            try await clock.turn(0.05, for: 2)
            try await eventually { source.state.value.ends == run }
            #expect(compass?.latest == nil)
        }
        compass = Compass(source: source, graceS: 5)
        let task = reader(try #require(compass), Shared([]))
        try await source.started(3)
        source.play(tumbling(1))
        try await eventually { compass?.latest != nil }
        task.cancel()
        try await task.value
        compass = nil
        try await eventually { source.state.value.ends == 3 }
        // who still reads goes on, and is the last
        compass = Compass(source: source, graceS: 5)
        let last = reader(try #require(compass), Shared([]))
        try await source.started(4)
        compass = nil
        last.cancel()
        try await last.value
        try await eventually { source.state.value.ends == 4 }
    }

    @Test func aPreviewShowsItsStateAndRunsNothing() async {
        let heading = CompassHeading(headingDeg: 42, headingSigmaDeg: 3, trueHeadingDeg: nil, inclinationDeg: 60)
        let sample = SensorSample.Magnetic(timeNs: 1, fieldUt: DeviceVector(x: 1, y: 2, z: 3))
        let model = CompassModel(
            preview: CompensatedReading(reading: MagneticReading(status: .tracking, heading: heading), sample: sample))
        await model.run()
        #expect(model.headingDeg == 42 && model.headingSigmaDeg == 3 && model.status == "tracking" && model.error == nil)
        let missing = CompassError.missing(sensor: .magnetometer, advice: "")
        let failed = CompassModel(preview: nil, error: missing)
        await failed.run()
        #expect(failed.error == missing && failed.status == "This device has no magnetometer." && failed.headingDeg == nil)
        let stopped = CompassModel(preview: nil, error: .refused(sensor: .magnetometer, reason: ""))
        stopped.retry()
        #expect(stopped.error != nil)
    }
}
