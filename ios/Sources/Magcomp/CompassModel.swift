import Observation

/// What a compass screen shows, for SwiftUI: `.task { await model.run() }`.
///
/// Any number of views may run one model: they share one run, which begins with nothing shown, or with the latest reading where the
/// sensors still run on after another screen. A run that ends with an error leaves only the ``error``, and its text in ``status``; one
/// whose error may pass (``CompassError/mayPass``) waits for ``retry()``. A value is set only when it differs, and at most as often as a
/// screen is drawn, so a view is drawn anew only for the values it shows.
@MainActor @Observable
public final class CompassModel {
    /// Clockwise from magnetic north, degrees, 0 to 360; nil when it is not known.
    public private(set) var headingDeg: Double?
    /// One standard deviation of it, degrees; 180, nothing known, where there is no better.
    public private(set) var headingSigmaDeg = 180.0
    /// Clockwise from true north, degrees, 0 to 360; nil without a heading, or a declination of the ``compass``.
    public private(set) var trueHeadingDeg: Double?
    /// What the compensator is doing, in a sentence; or why there are no readings.
    public private(set) var status = CompassState().status
    /// Share of the directions seen, 0 to 1.
    public private(set) var coverage = 0.0
    /// Where the field has not pointed yet, unit vectors in the device frame.
    public private(set) var unseenDirections: [DeviceVector] = []
    /// What the person can do for a better heading, or nil.
    public private(set) var guidance: String?
    /// Whether the place is disturbed, so that the heading is not to be relied on.
    public private(set) var isDisturbed = false
    /// The latest decided change of the field: a cover put on or taken off, another place.
    public private(set) var event: FieldEvent?
    /// All that the latest reading has.
    public private(set) var reading: CompensatedReading?
    /// Why there are no readings. Nil while they come, and after a run that was cancelled.
    public private(set) var error: CompassError?

    /// Whose readings are shown; its axis, screen rotation and declination may be set at any time.
    public let compass: Compass
    private let rateHz: Double
    private let smoothingHalfLifeS: Double?
    private let runs = SharedRun()
    private var isPreview = false
    @ObservationIgnored private var shown = CompassState()

    /// - Parameters:
    ///   - compass: whose readings are shown
    ///   - rateHz: at most so many a second, by the times of the samples, above 0. Default 60: as often as a screen is drawn
    ///   - smoothingHalfLifeS: half-life of headings' smoothing, seconds, above 0; nil, the default: they are shown as they come
    public init(compass: Compass, rateHz: Double = 60, smoothingHalfLifeS: Double? = nil) {
        (self.compass, self.rateHz, self.smoothingHalfLifeS) = (compass, rateHz, smoothingHalfLifeS)
    }

    /// Shows one reading, or an error, for previews: no sensor runs, ``run()`` returns at once.
    public convenience init(preview reading: CompensatedReading?, error: CompassError? = nil) {
        self.init(compass: Compass(source: PushedSource()))
        isPreview = true
        var state = CompassState(error: error)
        if let reading { state.show(reading) }
        show(state)
    }

    #if canImport(CoreMotion) && !os(macOS)
    /// That of a ``Compass/init()``: the phone's sensors, or in the Simulator a ``SimulatedSource``.
    public convenience init() { self.init(compass: Compass()) }
    #endif

    /// Shows readings until its task is cancelled or the source ends; then it shows no heading, but a recording's last reading stays.
    public func run() async {
        if isPreview { return }
        await runs.join { [self] retries in
            await compass.follow(rateHz: rateHz, smoothingHalfLifeS: smoothingHalfLifeS, retries: retries) { show($0) }
        }
    }

    /// Tries again after an error that may pass, such as a sensor that has stopped: the run that waits goes on. Else it does nothing.
    public func retry() {
        guard error?.mayPass == true, !isPreview else { return }
        // who asks twice is not heard after the next error
        show(CompassState())
        runs.retry()
    }

    /// Saves the calibration now: for an app that enters the background.
    public func save() { compass.save() }

    /// Forgets the learned calibration, in the store too.
    public func reset() { compass.reset() }

    /// An equal value tells nobody. Asking `shown`, not the model, takes no look at who observes.
    private func show(_ new: CompassState) {
        let old = shown
        shown = new
        if new.headingDeg != old.headingDeg { headingDeg = new.headingDeg }
        if new.headingSigmaDeg != old.headingSigmaDeg { headingSigmaDeg = new.headingSigmaDeg }
        if new.trueHeadingDeg != old.trueHeadingDeg { trueHeadingDeg = new.trueHeadingDeg }
        if new.status != old.status { status = new.status }
        if new.coverage != old.coverage { coverage = new.coverage }
        if new.unseenDirections != old.unseenDirections { unseenDirections = new.unseenDirections }
        if new.guidance != old.guidance { guidance = new.guidance }
        if new.isDisturbed != old.isDisturbed { isDisturbed = new.isDisturbed }
        if new.event != old.event { event = new.event }
        if new.reading != old.reading { reading = new.reading }
        if new.error != old.error { error = new.error }
    }
}
