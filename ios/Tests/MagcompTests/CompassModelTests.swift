@testable import Magcomp
import Testing

@Suite @MainActor struct CompassModelTests {
    @Test func showsWhatTheReadingsSay() async throws {
        let events = tumbling(600)
        let model = CompassModel(compass: Compass(source: Played(events: events)))
        #expect(model.headingDeg == nil && model.headingSigmaDeg == 180 && model.status == "starting")
        await model.run()
        // its axis is automatic
        let last = try #require(
            try Compensator(config: Config(heading: HeadingConfig(axis: .auto))).pushAll(events).last)
        #expect(model.headingDeg == last.heading?.headingDeg && model.headingDeg != nil)
        #expect(model.headingSigmaDeg == last.heading?.headingSigmaDeg)
        #expect(model.totalFieldUt == last.totalFieldUt)
        #expect(model.coverage == last.coverage)
        #expect(model.status == "tracking" && model.guidance == nil)
        #expect(model.systemField == nil)
    }

    @Test func saysWhatToDoWhileItCollects() async {
        let model = CompassModel(compass: Compass(source: Played(events: Array(tumbling(10)))))
        await model.run()
        #expect(model.status.hasPrefix("collecting: ") && model.status.contains("of 16 samples"))
        #expect(model.guidance == "Pick the phone up and turn it.")
        #expect(model.headingDeg == nil)
    }

    @Test func anErrorIsShownInWords() async {
        let missing = SensorError.missing(sensor: "magnetometer", advice: "hide the compass")
        struct Without: MagneticFieldSource {
            let error: SensorError

            func samples() -> SensorSamples {
                SensorSamples { [error] in AsyncThrowingStream { throw error } }
            }
        }
        let model = CompassModel(compass: Compass(source: Without(error: missing)))
        await model.run()
        #expect(model.status == "this device has no magnetometer; hide the compass")
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
                continuation.finish(throwing: SensorError.accessRefused(sensor: "magnetometer"))
            }
        }
    }

    let nothing = "nil 180.0 nil nil 0.0 nil"

    /// All it shows but the status.
    func shown(_ model: CompassModel) -> String {
        func text<T>(_ value: T?) -> String { value.map { "\($0)" } ?? "nil" }
        return [
            text(model.headingDeg), "\(model.headingSigmaDeg)", text(model.totalFieldUt), text(model.systemField),
            "\(model.coverage)", text(model.guidance),
        ].joined(separator: " ")
    }

    /// The system's field and enough for a heading: whatever a model can show.
    var everything: [SensorSample] {
        let system = SystemFieldSample(timeNs: 1, fieldUt: Vector3(x: 1, y: 2, z: 3), accuracy: .high)
        return [.systemField(system)] + tumbling(600)
    }

    @Test func anErrorLeavesNothingOfTheReadingsBeforeIt() async {
        let access = SensorError.accessRefused(sensor: "magnetometer").localizedDescription
        let model = CompassModel(compass: Compass(source: Runs(samplesOfRuns: [
            Played(events: everything).samples(), Self.failing(), Self.failing(after: everything),
            Self.failing(after: tumbling(10)),
        ])))
        await model.run()
        #expect(model.headingDeg != nil && model.totalFieldUt != nil && model.systemField != nil && model.coverage > 0)
        // at the next run's beginning, after readings of its own, and while it collected
        for _ in 1...3 {
            await model.run()
            #expect(shown(model) == nothing)
            #expect(model.status == access)
        }
    }

    @Test func aGoodRunLeavesNothingOfAnErrorBeforeIt() async throws {
        let model = CompassModel(compass: Compass(source: Runs(samplesOfRuns: [
            Self.failing(after: everything), Played(events: everything).samples(),
            Self.failing(after: tumbling(1)), Played(events: tumbling(1)).samples(),
        ])))
        await model.run()
        await model.run()
        #expect(model.status == "tracking")
        #expect(model.headingDeg != nil)
        await model.run()
        await model.run()
        #expect(model.status.hasPrefix("collecting: "), "though the reading before the error had this status too")
        #expect(model.guidance == "Pick the phone up and turn it.")
    }

    @Test func aRunBeginsWithNothingOfTheOneBefore() async throws {
        let (silent, continuation) = AsyncStream.makeStream(of: SensorSample.self)
        let source = Runs(samplesOfRuns: [
            Played(events: everything).samples(), SensorSamples { silent }, Self.failing(), SensorSamples { silent },
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

    @Test func theScreenMayTurn() {
        let model = CompassModel(compass: Compass(source: Played(events: [])))
        model.frame.screenRotation = .deg270
        #expect(model.frame == HeadingFrame(axis: .auto, screenRotation: .deg270))
    }

    /// `UIInterfaceOrientation`: landscapeRight, 3, has the home button to the right, so the device was turned
    /// counter-clockwise and the screen's top is the device's right edge.
    @Test func interfaceOrientationsAreScreenRotations() {
        let rotations = (0...5).map { ScreenRotation(interfaceOrientation: $0) }
        #expect(rotations == [nil, .deg0, .deg180, .deg90, .deg270, nil])
    }
}
