import Observation

/// What a compass screen shows, for SwiftUI: `.task { await model.run() }`.
///
/// Every run begins with nothing known; one that ends with an error leaves nothing but the error's text in ``status``.
@available(iOS 17, macOS 14, tvOS 17, watchOS 10, *)
@MainActor @Observable
public final class CompassModel {
    /// Clockwise from magnetic north, degrees, 0 to 360; nil when it is not known.
    public private(set) var headingDeg: Double?
    /// One standard deviation of it, degrees; 180, nothing known, where there is no better.
    public private(set) var headingSigmaDeg = 180.0
    /// Length of the corrected field, microtesla.
    public private(set) var totalFieldUt: Double?
    /// What the system itself says of the field, microtesla, and how well it is calibrated.
    public private(set) var systemField: SystemFieldSample?
    /// What the compensator is doing, in a sentence; or why there are no readings.
    public private(set) var status = "starting"
    /// Share of the directions seen, 0 to 1.
    public private(set) var coverage = 0.0
    /// What the person can do for a better heading, or nil.
    public private(set) var guidance: String?

    private let compass: Compass
    private var latest: Status?

    public init(compass: Compass) { self.compass = compass }

    /// The frame headings are in, for instance when the screen was turned.
    public var frame: HeadingFrame {
        get { compass.frame }
        set { compass.frame = newValue }
    }

    /// Shows readings until its task is cancelled or the source ends, whose last one stays then.
    public func run() async {
        clear("starting")
        do {
            for try await answer in compass.readings() { show(answer) }
        } catch {
            clear(error.localizedDescription)
        }
    }

    /// Nothing of an earlier reading, nor of an earlier error.
    private func clear(_ status: String) {
        (headingDeg, headingSigmaDeg, totalFieldUt, systemField) = (nil, 180, nil, nil)
        (coverage, guidance, latest) = (0, nil, nil)
        self.status = status
    }

    private func show(_ answer: CompensatedReading) {
        let reading = answer.reading
        headingDeg = reading.heading?.headingDeg
        headingSigmaDeg = reading.heading?.headingSigmaDeg ?? 180
        totalFieldUt = reading.totalFieldUt
        systemField = answer.systemField
        coverage = reading.coverage
        // the words cost a call into the library: only another status asks for them
        if reading.status != latest {
            latest = reading.status
            status = reading.status.text()
            guidance = Self.guidance(reading.status)
        }
    }

    private static func guidance(_ status: Status) -> String? {
        switch status {
        case .collecting(.rotation), .held(.tooLittleRotation): "Turn the phone."
        case .collecting(.directions), .collecting(.fit), .held(.fitRefused), .held(.lowUniformity):
            "Turn the phone about all its axes, as if drawing an eight."
        case .collecting(.samples), .held(.atRest): "Pick the phone up and turn it."
        case .disturbed: "Walk away from metal and magnets."
        case .held(.noGyroscope), .held(.constant), .tracking, .suspect, .rejected: nil
        }
    }
}
