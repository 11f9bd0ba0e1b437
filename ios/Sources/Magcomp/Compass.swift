/// A compass from a phone's own sensors: `for try await reading in Compass().readings() { ... }`.
///
/// However many iterate its readings, there is one estimator, and sensors run once, while anybody iterates. What was learned
/// stays as long as the compass lives: a screen that comes back has its heading at once.
public final class Compass: Sendable {
    private let readers: Readers
    private let estimation: Estimation
    private let frames: Locked<HeadingFrame>

    /// - Parameters:
    ///   - source: where events come from
    ///   - config: what was left out is the library's default, that of ``Compensator``: among them the heading's axis `.auto`,
    ///     which does not flip when the phone is raised, and `useReportedHardIron`: iOS's own hard iron is the first calibration
    ///     where there is no other and the source delivers its field, so that the first reading has a heading, with a wide sigma
    ///   - store: where the calibration is kept from one launch to the next; nil: nowhere
    public init(source: any MagneticFieldSource, config: Config = Config(), store: (any CalibrationStore)? = nil) {
        let frames = Locked(
            HeadingFrame(
                axis: config.heading?.axis ?? .auto,
                screenRotation: config.heading?.screenRotation ?? .deg0,
                declinationDeg: config.heading?.declinationDeg))
        self.frames = frames
        estimation = Estimation(config, store: store) { frames.value }
        readers = Readers(of: { source.samples() }, by: estimation)
    }

    #if canImport(CoreMotion) && !os(macOS)
    /// The phone's sensors at 100 Hz, the calibration kept in the app's user defaults.
    public convenience init() {
        self.init(source: CoreMotionSource(), store: UserDefaultsStore())
    }
    #endif

    /// The frame headings are in; may be set at any time, from any thread, for instance when the screen was turned. With a
    /// declination out of range readings end with `MagcompError.config`.
    public var frame: HeadingFrame {
        get { frames.value }
        set { frames.value = newValue }
    }

    /// One reading for every magnetometer sample, as long as it is iterated. Iterators get the same readings, each from when
    /// it began.
    ///
    /// - Parameter capacity: readings kept for a slow iterator, at least 1; the oldest is dropped and counted, but for a source
    ///   that can wait, as a ``RecordingSource`` can
    public func readings(capacity: Int = 64) -> CompensatedReadings {
        CompensatedReadings { [readers] in readers.place(capacity: capacity) }
    }

    /// Saves the calibration now, if it has changed since it was saved: for an app that enters the background, where iOS may
    /// end it without a word.
    public func save() { estimation.save() }

    /// Forgets what was learned, in the store too; iterations go on with a first calibration.
    public func reset() { estimation.reset() }
}
