import Foundation

#if canImport(CoreMotion) && !os(macOS)
import CoreMotion
#endif

/// A compass from a phone's own sensors: `for try await reading in Compass().readings() { ... }`.
///
/// All iterations of its readings share one estimator and one run of the sensors, which lasts while anybody iterates and 5 s longer.
/// The compass keeps the learned calibration as long as it lives, so a screen that comes back has its heading at once.
public final class Compass: Sendable {
    private let readers: Readers
    let estimation: Estimation
    private let frames: Locked<HeadingFrame>

    /// - Parameters:
    ///   - source: where events come from
    ///   - config: a field left out has the library's default, as in ``Compensator``. Two defaults serve a compass: the
    ///     heading's axis is `.auto`, which does not flip when the phone is raised; and `useReportedHardIron` makes
    ///     iOS's own hard iron the first calibration where there is no other and the source delivers iOS's field, so
    ///     that the first reading has a heading, with a wide sigma
    ///   - store: where the calibration is kept from one launch to the next; nil: nowhere
    ///   - graceS: how long sensors run on after the last iterator has left, seconds, at least 0, so that a screen that comes back soon
    ///     has its heading at once; what can wait, such as a ``RecordingSource``, ends at once
    public convenience init(
        source: any MagneticFieldSource, config: CompensationConfig = CompensationConfig(),
        store: (any CalibrationStore)? = nil, graceS: Double = 5
    ) {
        self.init(
            source: source, config: config, store: store, graceS: graceS, clock: SystemClock(), unixTimeS: systemUnixTimeS)
    }

    /// With another clock to wait by, and another wall clock, seconds since 1970.
    init(
        source: any MagneticFieldSource, config: CompensationConfig, store: (any CalibrationStore)?, graceS: Double,
        clock: any WaitingClock, unixTimeS: @escaping @Sendable () -> Int64
    ) {
        let frames = Locked(
            HeadingFrame(
                axis: config.heading?.axis ?? .auto,
                screenRotation: config.heading?.screenRotation ?? .deg0,
                declinationDeg: config.heading?.declinationDeg))
        self.frames = frames
        estimation = Estimation(
            config, store: store, hiddenS: { source.hiddenS }, unixTimeS: unixTimeS, frames: frames)
        readers = Readers(of: { source.samples() }, by: estimation, graceS: graceS, clock: clock)
    }

    deinit { readers.endGrace() }

    #if canImport(CoreMotion) && !os(macOS)
    /// The phone's sensors at 100 Hz, the calibration kept in the app's user defaults. Where iOS has a calibrated field it is asked for,
    /// so that the first reading of all has a heading, with a wide sigma. In the Simulator, which has no sensors, a ``SimulatedSource``,
    /// and nothing is kept.
    ///
    /// It asks the system for nothing before readings are iterated, so a view's initial value may be made as often as the view is.
    public convenience init() {
        #if targetEnvironment(simulator)
        self.init(source: SimulatedSource())
        #else
        self.init(
            source: CoreMotionSource(options: { .compass }, manager: { CMMotionManager() }), store: UserDefaultsStore())
        #endif
    }

    /// As ``init()``, with the app's motion manager (``CoreMotionSource/init(options:manager:)``), in the Simulator too.
    public convenience init(manager: sending CMMotionManager) {
        self.init(source: CoreMotionSource(options: { .compass }, manager: { manager }), store: UserDefaultsStore())
    }
    #endif

    /// The axis of the device the headings are those of. Like ``screenRotation`` and ``setDeclinationDeg(_:)`` it may be set at any time from
    /// any thread.
    public var axis: HeadingFrame.ReferenceAxis {
        get { frames.value.axis }
        set { frames.change { $0.axis = newValue } }
    }

    /// How far the screen has turned: on iOS `HeadingFrame.ScreenRotation(_:)` knows it from a `UIInterfaceOrientation`.
    public var screenRotation: HeadingFrame.ScreenRotation {
        get { frames.value.screenRotation }
        set { frames.change { $0.screenRotation = newValue } }
    }

    /// The declination of the place, degrees, east positive, for a true heading; nil: there is none.
    public var declinationDeg: Double? { frames.value.declinationDeg }

    /// From now on headings have a true heading by this declination; `EarthMagneticField` gives that of a place.
    ///
    /// - Parameter declinationDeg: degrees, east positive, -180 to 180; nil: no true heading
    /// - Throws: `MagcompError.config` when it is out of range; nothing has changed then
    public func setDeclinationDeg(_ declinationDeg: Double?) throws {
        // the core's own range; a test compares them
        if let declinationDeg, !(-180...180).contains(declinationDeg) {
            throw MagcompError.config(
                field: "heading.declination_deg", value: "\(declinationDeg)", expected: "-180.0 to 180.0 deg, or none")
        }
        frames.change { $0.declinationDeg = declinationDeg }
    }

    /// One reading for every magnetometer sample, as long as somebody iterates. All iterators get the same readings,
    /// each from its own beginning on.
    ///
    /// - Parameter capacity: readings kept for a slow iterator, at least 1; the oldest is dropped and counted, but for a source
    ///   that can wait, as a ``RecordingSource`` can
    public func readings(capacity: Int = 64) -> Readings {
        Readings { [readers] in readers.place(capacity: capacity) }
    }

    /// Those that a screen shows: the newest, at most so many a second, and the last.
    func readings(rateHz: Double) -> Readings {
        Readings { [readers] in readers.place(capacity: 1, rateHz: rateHz) }
    }

    /// Saves the calibration now, if it has changed since it was saved: for an app that enters the background, where iOS may end the
    /// app without warning. It waits for nothing, neither for the store nor for a sample that is being worked on, so the main thread may
    /// call it; iOS is asked to let the app live until the store has it.
    public func save() {
        estimation.save()
        #if canImport(Darwin) && !os(macOS)
        ProcessInfo.processInfo.performExpiringActivity(withReason: "saving the compass's calibration") {
            [estimation] isExpired in
            if !isExpired { estimation.settle() }
        }
        #endif
    }

    /// Forgets the learned calibration, in the store too; iterations go on with a first calibration.
    public func reset() { estimation.reset() }

    /// The declination that true headings from outside have shown; nil before the first, and while ``declinationDeg`` is set.
    public func foundDeclination() throws -> Compass.FoundDeclination? { try estimation.foundDeclination() }

    /// The frame of the headings, whole.
    var frame: HeadingFrame { frames.value }

    /// The latest reading while the sensors run, for tests alone: its readers get it a moment later.
    var latest: CompensatedReading? { readers.latest }

    /// Whether the events of the latest run come whether or not anybody is ready for them.
    var isLive: Bool { readers.isLive }

    /// Tells the estimator what something else knows; false where there is none, or it came too late or too early.
    func aid(_ help: SensorSample) throws -> Bool { try estimation.aid(help) }

    /// Waits until the store has done all that it was told.
    func settled() async { await estimation.settled() }

    /// The compensator's, for tests alone.
    var fastHandle: Int64? { estimation.fastHandle }
}

extension Compass {
    /// Readings, one for every magnetometer sample. Events run while anybody iterates: they begin when an iterator is first asked for a
    /// reading, and stop when the last iterator is freed or its task is cancelled.
    public struct Readings: AsyncSequence, Sendable {
        public typealias Element = CompensatedReading

        private let begin: @Sendable () -> Place

        init(_ begin: @escaping @Sendable () -> Place) { self.begin = begin }

        public func makeAsyncIterator() -> AsyncIterator { AsyncIterator(begin: begin) }

        public struct AsyncIterator: AsyncIteratorProtocol {
            let begin: @Sendable () -> Place
            private var place: Place?

            init(begin: @escaping @Sendable () -> Place) { self.begin = begin }

            /// Events run, and readings are kept for it from now on.
            package mutating func start() { place = place ?? begin() }

            public mutating func next() async throws -> CompensatedReading? { try await next(isolation: nil) }

            /// As ``next()``, on the caller's actor.
            public mutating func next(isolation actor: isolated (any Actor)?) async throws -> CompensatedReading? {
                // who was cancelled before it began starts nothing
                if place == nil, Task.isCancelled { return nil }
                start()
                return try await place?.next(isolation: actor)
            }
        }
    }
}
