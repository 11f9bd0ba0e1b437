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
