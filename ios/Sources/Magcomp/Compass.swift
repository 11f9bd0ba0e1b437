/// A compass from a phone's own sensors: `for try await reading in Compass().readings() { ... }`.
public final class Compass: Sendable {
    private let source: any MagneticFieldSource
    private let config: Config
    private let store: (any CalibrationStore)?
    private let frames: Locked<HeadingFrame>

    /// - Parameters:
    ///   - source: where events come from
    ///   - config: what was left out is the library's default, but for the heading's axis: `.auto`, which does not flip when
    ///     the phone is raised
    ///   - store: where the calibration is kept from one launch to the next; nil: nowhere
    public init(source: any MagneticFieldSource, config: Config = Config(), store: (any CalibrationStore)? = nil) {
        (self.source, self.config, self.store) = (source, config, store)
        frames = Locked(
            HeadingFrame(
                axis: config.heading?.axis ?? .auto,
                screenRotation: config.heading?.screenRotation ?? .deg0,
                declinationDeg: config.heading?.declinationDeg))
    }

    #if canImport(CoreMotion) && !os(macOS)
    /// The phone's sensors at 100 Hz, the calibration kept in the app's user defaults.
    public convenience init() {
        self.init(source: CoreMotionSource(), store: UserDefaultsStore())
    }
    #endif

    /// The frame headings are in; may be set at any time, from any thread, for instance when the screen was turned. With a
    /// declination out of range readings end with `MagcompError.Config`.
    public var frame: HeadingFrame {
        get { frames.value }
        set { frames.value = newValue }
    }

    /// One reading for every magnetometer sample, as long as it is iterated.
    public func readings() -> CompensatedReadings {
        source.samples().compensated(config, store: store) { [frames] in frames.value }
    }
}
