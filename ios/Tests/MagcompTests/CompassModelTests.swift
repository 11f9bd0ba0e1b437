import Foundation
@_spi(Research) @testable import Magcomp
import Observation
import Testing

@Suite @MainActor struct CompassModelTests {
    @Test func showsWhatTheReadingsSay() async throws {
        let events = tumbling(600)
        let model = CompassModel(compass: Compass(source: Played(events: events, isLive: false)))
        #expect(model.headingDeg == nil && model.headingSigmaDeg == 180 && model.status == "starting")
        await model.run()
        // its axis is automatic
        let last = try #require(
            try Compensator(config: CompensationConfig(heading: HeadingConfig(axis: .auto))).pushAll(events).last)
        #expect(model.headingDeg == last.heading?.headingDeg && model.headingDeg != nil)
        #expect(model.headingSigmaDeg == last.heading?.headingSigmaDeg)
        #expect(model.coverage == last.coverage)
        #expect(model.status == "tracking" && model.guidance == nil)
    }

    @Test func showsAllThatAReadingHas() async throws {
        let compass = Compass(source: Played(events: tumbling(600) + flat(600), isLive: false))
        try compass.setDeclinationDeg(7)
        let model = CompassModel(compass: compass)
        await model.run()
        let last = try #require(model.reading)
        #expect(last.reading.timeNs == 601 * stepNs)
        #expect(model.trueHeadingDeg == last.reading.heading?.trueHeadingDeg && model.trueHeadingDeg != nil)
        #expect(model.unseenDirections == last.unseenDirections && model.event == last.reading.event)

        var state = CompassState()
        let event = FieldEvent(kind: .deviceStep, sinceNs: 1, decidedNs: 2)
        let unseen = [DeviceVector(x: 0, y: 0, z: 1)]
        let sample = SensorSample.Magnetic(timeNs: 3, fieldUt: DeviceVector(x: 1, y: 2, z: 3))
        state.show(
            CompensatedReading(
                reading: MagneticReading(status: .tracking, event: event), sample: sample, unseenDirections: unseen))
        #expect(state.event == event && state.unseenDirections == unseen && state.status == "tracking")
    }

    /// Tells of every change of a model's value, with the value before it.
    static func follow<Value>(
        _ value: @escaping @MainActor @Sendable () -> Value, changes: @escaping @MainActor @Sendable (Value) -> Void
    ) {
        withObservationTracking {
            _ = value()
        } onChange: {
            MainActor.assumeIsolated {
                changes(value())
                follow(value, changes: changes)
            }
        }
    }

    /// How often a value of a model changes.
    func changes<Value>(_ value: @escaping @MainActor @Sendable () -> Value) -> Shared<Int> {
        let count = Shared(0)
        Self.follow(value) { _ in count.change { $0 += 1 } }
        return count
    }

    @Test func valuesChangeToOthersAloneAndNoMoreOftenThanAScreenIsDrawn() async throws {
        let events = tumbling(1000)
        // 100 samples a second, of which every second comes 1/60 s or more after the one shown before
        for (rateHz, shown) in [(60.0, 500), (1000, 1000), (10, 100)] {
            let model = CompassModel(
                compass: Compass(source: Played(events: events, isLive: false)), rateHz: rateHz)
            let readings = changes { model.reading }
            let headings = changes { model.headingDeg }
            let words = changes { model.status }
            let guidance = changes { model.guidance }
            let unseen = changes { model.unseenDirections }
            await model.run()
            // the last sample is shown whenever it comes
            #expect((shown...(shown + 1)).contains(readings.value), "\(readings.value) at \(rateHz) Hz")
            #expect(headings.value <= readings.value && headings.value > shown / 2)
            #expect((2...(shown / 3)).contains(words.value), "\(words.value) other words")
            #expect((1...20).contains(guidance.value), "\(guidance.value) pieces of advice")
            #expect((1...50).contains(unseen.value), "\(unseen.value) other unseen directions")
            #expect(model.reading?.sample.timeNs == 1000 * stepNs)
        }
    }

    @Test func aDisplayOutOfRangeIsAnErrorInWords() async throws {
        let compass = Compass(source: Played(events: tumbling(10)))
        for (model, field) in [
            (CompassModel(compass: compass, rateHz: 0), "rateHz"), (CompassModel(compass: compass, rateHz: .nan), "rateHz"),
            (CompassModel(compass: compass, smoothingHalfLifeS: -1), "smoothingHalfLifeS"),
        ] {
            await model.run()
            let text = try #require(model.error).developerText
            #expect(text.contains("CompassModel.\(field)"), "\(text)")
            #expect(model.status == "The compass does not work in this version of the app.", "for people")
        }
    }

    @Test func whatThePersonCanDo() {
        let turn = "Turn the phone."
        let eight = "Turn the phone about all its axes, as if drawing an eight."
        let pickUp = "Pick the phone up and turn it."
        let expected: [(CompensationStatus, String?)] = [
            (.collecting(missing: .rotation), turn), (.held(reason: .tooLittleRotation), turn),
            (.collecting(missing: .directions), eight), (.collecting(missing: .fit(problem: .notFinite)), eight),
            (.held(reason: .fitRefused(problem: .notFinite)), eight), (.held(reason: .lowUniformity), eight),
            (.collecting(missing: .samples(have: 1, need: 2)), pickUp), (.held(reason: .atRest), pickUp),
            (.disturbed(sinceNs: 1), "Walk away from metal and magnets."),
            (.held(reason: .noGyroscope), nil), (.held(reason: .constant), nil), (.tracking, nil),
            (.suspect(sinceNs: 1), nil), (.rejected(reason: .notFinite), nil),
        ]
        let sample = SensorSample.Magnetic(timeNs: 1, fieldUt: DeviceVector(x: 1, y: 2, z: 3))
        var state = CompassState()
        for (status, guidance) in expected {
            state.show(CompensatedReading(reading: MagneticReading(status: status), sample: sample))
            #expect(state.guidance == guidance && state.status == status.text, "\(status)")
            #expect(state.isDisturbed == (status.label == "disturbed"))
        }
    }

    @Test func aHeadingAsItIsRead() {
        #expect(CompassState.spoken(headingDeg: nil, sigmaDeg: 180) == "no heading yet")
        #expect(CompassState.spoken(headingDeg: 359.6, sigmaDeg: 2.1) == "heading 0 degrees, give or take 3")
        #expect(CompassState.spoken(headingDeg: 89.7, sigmaDeg: 4) == "heading 90 degrees, give or take 4")
    }

    /// A rose is finite, and read, whatever it is given.
    @Test(
        arguments: [
            (.nan, 3, nil, 3, "no heading yet"), (.infinity, .nan, nil, 180, "no heading yet"),
            (-90, 3, 270, 3, "heading 270 degrees, give or take 3"),
            (1e300, .infinity, 1e300.truncatingRemainder(dividingBy: 360), 180, nil), (-1e-20, -1, 0, 180, nil),
            (720.4, 1e300, 720.4 - 720, 180, "heading 0 degrees, give or take 180"),
            (42, .nan, 42, 180, "heading 42 degrees, give or take 180"), (0, 0, 0, 0, "heading 0 degrees, give or take 0"),
        ] as [(Double, Double, Double?, Double, String?)])
    func aRoseTakesAnyNumber(heading: Double, sigma: Double, shown: Double?, shownSigma: Double, spoken: String?) {
        #expect(CompassState.shownDeg(heading) == shown && CompassState.shownSigmaDeg(sigma) == shownSigma)
        let text = CompassState.spoken(headingDeg: heading, sigmaDeg: sigma)
        #expect(spoken.map { text == $0 } ?? text.hasPrefix("heading "))
    }

    @Test func whatIsNoNumberIsNotSmoothed() {
        var smoother = HeadingSmoother(halfLifeS: 0.1)
        #expect(smoother.push(350, timeNs: 0) == 350)
        #expect(smoother.push(.nan, timeNs: 1).isNaN && smoother.push(-.infinity, timeNs: 2) == -.infinity)
        #expect(abs(smoother.push(10, timeNs: 100_000_000)) < 1e-9, "and is forgotten")
        // a half-life that is none smooths nothing; a heading below 0 by nothing is 0
        for halfLifeS in [0, -1, Double.nan] {
            var plain = HeadingSmoother(halfLifeS: halfLifeS)
            #expect(
                plain.push(350, timeNs: 0) == 350 && plain.push(10, timeNs: 1) == 10 && plain.push(-1e-20, timeNs: 2) == 0)
        }
    }

    @Test func aSmoothedHeadingGoesTheShorterWayRound() {
        var smoother = HeadingSmoother(halfLifeS: 0.1)
        #expect(smoother.push(350, timeNs: 0) == 350)
        // half of 20 degrees in a half-life, then half of the other 10
        #expect(abs(smoother.push(10, timeNs: 100_000_000) - 0) < 1e-9)
        #expect(abs(smoother.push(10, timeNs: 200_000_000) - 5) < 1e-9)
        #expect(abs(smoother.push(355, timeNs: 300_000_000) - 0) < 1e-9)
        #expect(abs(smoother.push(300, timeNs: 400_000_000) - 330) < 1e-9)
        // the same whatever the rate
        var fine = HeadingSmoother(halfLifeS: 0.1)
        _ = fine.push(350, timeNs: 0)
        var last = 0.0
        for k in 1...20 { last = fine.push(10, timeNs: Int64(k) * 10_000_000) }
        #expect(abs(last - 5) < 1e-9)
        // a clock that begins anew, and a moment without a heading
        #expect(fine.push(123, timeNs: 5) == 123)
        #expect(fine.push(nil, timeNs: 6) == nil)
        #expect(fine.push(77, timeNs: 6) == 77)
    }

    @Test func smoothingIsOffUnlessAskedFor() async throws {
        let events = tumbling(600) + (600..<630).flatMap { flat($0) }
        func shown(_ halfLifeS: Double?) async -> CompassModel {
            let model = CompassModel(
                compass: Compass(source: Played(events: events, isLive: false)), smoothingHalfLifeS: halfLifeS)
            await model.run()
            return model
        }
        let plain = await shown(nil)
        #expect(plain.headingDeg == plain.reading?.reading.heading?.headingDeg)
        let smooth = await shown(1)
        #expect(smooth.headingDeg != smooth.reading?.reading.heading?.headingDeg && smooth.headingDeg != nil)
    }

    @Test func saysWhatToDoWhileItCollects() async {
        let model = CompassModel(compass: Compass(source: Played(events: Array(tumbling(10)), isLive: false)))
        await model.run()
        #expect(model.status.hasPrefix("collecting: ") && model.status.contains("of 16 samples"))
        #expect(model.guidance == "Pick the phone up and turn it.")
        #expect(model.headingDeg == nil)
    }

    @Test func anErrorIsShownInWords() async {
        let missing = CompassError.missing(sensor: .magnetometer, advice: "hide the compass")
        struct Without: MagneticFieldSource {
            let error: CompassError

            func samples() -> SensorSamples {
                SensorSamples { [error] in AsyncThrowingStream { throw error } }
            }
        }
        let model = CompassModel(compass: Compass(source: Without(error: missing)))
        await model.run()
        #expect(model.status == "This device has no magnetometer.")
        #expect(model.error?.developerText == "this device has no magnetometer; hide the compass")
        #expect(model.error == missing && model.error?.isMendedInSettings == false)
    }

    @Test func everyErrorHasAWordForPeopleAndOneForDevelopers() throws {
        struct Own: LocalizedError { var errorDescription: String? { "of the app's source" } }
        let again = CompassError.refused(sensor: .gyroscope, reason: "CMErrorDomain 103")
        let errors: [(CompassError, people: String, mend: String?, developers: String)] = [
            (
                CompassError.accessRefused(sensor: .motion), "The app may not use the motion sensors.",
                "Allow it in Settings > Privacy & Security > Motion & Fitness.", "access to the motion sensors was refused"
            ),
            (
                CompassError.accessRefused(sensor: .location), "The app may not use the phone's location.",
                "Allow it in Settings > Privacy & Security > Location Services.", "Security > Location Services"
            ),
            (
                CompassError.accessRefused(sensor: .preciseLocation),
                "The app may not use the phone's precise location.",
                "Turn on Precise Location for it in Settings > Privacy & Security > Location Services.", "precise location"
            ),
            (CompassError(again), "The gyroscope has stopped.", "Try again.", "CMErrorDomain 103"),
            (
                CompassError.missing(sensor: .calibratedField, advice: "advice"),
                "This device has no calibrated magnetic field.", nil, "advice"
            ),
            (CompassError(MagcompError.closed), "The compass does not work in this version of the app.", nil, "closed"),
            (CompassError(Own()), "of the app's source", nil, "of the app's source"),
        ]
        for (error, people, mend, developers) in errors {
            #expect(error.localizedDescription == people && error.recoverySuggestion == mend, "\(error)")
            #expect(error.developerText.contains(developers), "\(error.developerText)")
            #expect(error.isMendedInSettings == (mend?.contains("Settings") == true))
        }
        // English names the sensors as developers do
        for sensor in CompassError.Sensor.allCases { #expect(sensor.localizedName == sensor.rawValue) }
        #expect(roseLetters() == ["N", "E", "S", "W"])
    }

    /// Plays another source at every run.
    struct Runs: MagneticFieldSource {
        let samplesOfRuns: [SensorSamples]
        let run = Shared(0)

        func samples() -> SensorSamples {
            run.change { $0 += 1 }
            return samplesOfRuns[run.value - 1]
        }
    }

    static func failing(after events: [SensorSample] = []) -> SensorSamples {
        SensorSamples {
            AsyncThrowingStream<SensorSample, any Error> { continuation in
                for event in events { continuation.yield(event) }
                continuation.finish(throwing: CompassError.accessRefused(sensor: .magnetometer))
            }
        }
    }

    let nothing = "nil 180.0 nil nil 0.0 nil"

    /// All it shows but the status.
    func shown(_ model: CompassModel) -> String {
        func text<T>(_ value: T?) -> String { value.map { "\($0)" } ?? "nil" }
        return [
            text(model.headingDeg), "\(model.headingSigmaDeg)", text(model.reading), text(model.event),
            "\(model.coverage)", text(model.guidance),
        ].joined(separator: " ")
    }

    /// The system's field and enough for a heading: whatever a model can show.
    var everything: [SensorSample] {
        let system = SensorSample.SystemField(timeNs: 1, fieldUt: DeviceVector(x: 1, y: 2, z: 3), accuracy: .high)
        return [.systemField(system)] + tumbling(600)
    }

    @Test func anErrorLeavesNothingOfTheReadingsBeforeIt() async {
        let access = "The app may not use the motion sensors."
        let model = CompassModel(
            compass: Compass(
                source: Runs(samplesOfRuns: [
                    Played(events: everything, isLive: false).samples(), Self.failing(), Self.failing(after: everything),
                    Self.failing(),
                ])))
        await model.run()
        #expect(model.headingDeg != nil && model.reading?.systemField != nil && model.coverage > 0)
        // at the next run's beginning, after readings of its own, and while it collected
        for _ in 1...3 {
            await model.run()
            #expect(shown(model) == nothing)
            #expect(model.status == access)
            #expect(model.error == .accessRefused(sensor: .magnetometer))
            #expect(model.error?.isMendedInSettings == true && model.error?.localizedDescription == access)
        }
    }

    @Test func aGoodRunLeavesNothingOfAnErrorBeforeIt() async throws {
        let model = CompassModel(
            compass: Compass(
                source: Runs(samplesOfRuns: [
                    Self.failing(after: everything), Played(events: everything, isLive: false).samples(),
                ])))
        let young = CompassModel(
            compass: Compass(
                source: Runs(samplesOfRuns: [
                    Self.failing(after: tumbling(1)), Played(events: Array(tumbling(2)[2...]), isLive: false).samples(),
                ])))
        await model.run()
        #expect(model.error != nil)
        await model.run()
        #expect(model.status == "tracking")
        #expect(model.headingDeg != nil && model.error == nil)
        await young.run()
        await young.run()
        #expect(young.status.hasPrefix("collecting: "))
        #expect(young.guidance == "Pick the phone up and turn it.")
    }

    @Test func aRunBeginsWithNothingOfTheOneBefore() async throws {
        let (silent, continuation) = AsyncStream.makeStream(of: SensorSample.self)
        let source = Runs(samplesOfRuns: [
            Played(events: everything, isLive: false).samples(), SensorSamples { silent }, Self.failing(),
            SensorSamples { silent },
        ])
        let model = CompassModel(compass: Compass(source: source))
        for run in [2, 4] {
            await model.run()
            let running = Task { await model.run() }
            while source.run.value < run { await Task.yield() }
            #expect(model.status == "starting")
            #expect(shown(model) == nothing)
            running.cancel()
            await running.value
        }
        continuation.finish()
    }

    @Test func aDecidedEventAndADisturbedPlaceAreShown() async throws {
        var phone = Phone(8)
        var events = (0..<3000).flatMap { _ in phone.advance(still: false) }
        // carried beside iron
        phone.horizontalUt = 45
        events += (0..<300).flatMap { _ in phone.advance(still: false) }
        let model = CompassModel(compass: Compass(source: Played(events: events, isLive: false)))
        await model.run()
        #expect(model.isDisturbed, "\(model.status)")
        #expect(model.event?.kind == .placeChanged && model.event == model.reading?.reading.event)
    }

    @Test func aModelSavesAndForgetsAsItsCompassDoes() async throws {
        let (source, store) = (Live(), Slow())
        let model = CompassModel(
            compass: Compass(source: source, store: store), rateHz: 1e6)
        let running = Task { await model.run() }
        try await source.started(1)
        source.play(tumbling(900))
        try await eventually { model.reading?.sample.timeNs == 900 * stepNs }
        await model.compass.settled()
        let saved = store.kept.value
        model.save()
        await model.compass.settled()
        #expect(saved != nil && store.kept.value != saved, "what came after the save at first tracking")
        model.reset()
        await model.compass.settled()
        #expect(store.kept.value == nil)
        source.play(flat(900))
        try await eventually { model.reading?.sample.timeNs == 901 * stepNs }
        #expect(model.headingDeg == nil)
        running.cancel()
        await running.value
    }

    @Test func theScreenMayTurn() throws {
        let model = CompassModel(compass: Compass(source: Played(events: [])))
        model.compass.axis = .camera
        try model.compass.setDeclinationDeg(3)
        model.compass.screenRotation = .deg270
        let compass = model.compass
        #expect(compass.frame == HeadingFrame(axis: .camera, screenRotation: .deg270, declinationDeg: 3))
        #expect(compass.axis == .camera && compass.screenRotation == .deg270 && compass.declinationDeg == 3)
    }

    /// Each thread reads back what it alone sets.
    @Test func settingsThatTwoThreadsChangeAreBothKept() {
        let compass = Compass(source: Played(events: []))
        let lost = Locked(0)
        DispatchQueue.concurrentPerform(iterations: 2) { thread in
            for k in 1...300_000 {
                let (deg, rotation) = (Double(k % 90), k % 2 == 0 ? HeadingFrame.ScreenRotation.deg0 : .deg90)
                if thread == 0 { try? compass.setDeclinationDeg(deg) } else { compass.screenRotation = rotation }
                // the other thread may be anywhere in its own change
                for _ in 1...10 {
                    let kept = thread == 0 ? compass.declinationDeg == deg : compass.screenRotation == rotation
                    if !kept { lost.change { $0 += 1 } }
                }
            }
        }
        #expect(lost.value == 0)
    }

    /// `UIInterfaceOrientation`: landscapeRight, 3, has the home button to the right, so the device was turned
    /// counter-clockwise and the screen's top is the device's right edge.
    @Test func interfaceOrientationsAreScreenRotations() {
        let rotations = (0...5).map { HeadingFrame.ScreenRotation(interfaceOrientation: $0) }
        #expect(rotations == [nil, .deg0, .deg180, .deg90, .deg270, nil])
    }
}
