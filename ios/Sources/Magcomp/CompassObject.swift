#if canImport(Combine)
import Combine

/// ``CompassModel`` for iOS 15 and 16, with the same rules: `@StateObject` in a view, `.task { await compass.run() }`.
@MainActor
public final class CompassObject: ObservableObject {
    /// What a screen shows.
    @Published public private(set) var state = CompassState()

    /// Whose readings are shown; its axis, screen rotation and declination may be set at any time.
    public let compass: Compass
    private let display: CompassDisplay
    private let runs = SharedRun()
    private var isPreview = false

    public init(compass: Compass, display: CompassDisplay = CompassDisplay()) {
        (self.compass, self.display) = (compass, display)
    }

    /// Shows a state, for previews: no sensor runs, ``run()`` returns at once.
    public init(state: CompassState) {
        (compass, display) = (Compass(source: NoSource()), CompassDisplay())
        (self.state, isPreview) = (state, true)
    }

    #if canImport(CoreMotion) && !os(macOS)
    /// That of a ``Compass/init()``: the phone's sensors, or in the Simulator a ``SimulatedSource``.
    public convenience init(display: CompassDisplay = CompassDisplay()) { self.init(compass: Compass(), display: display) }
    #endif

    /// Shows readings until its task is cancelled or the source ends, whose last one stays then.
    public func run() async {
        if isPreview { return }
        await runs.join { [self] retries in
            // an equal state tells nobody
            await compass.follow(display, retries: retries) { if $0 != state { state = $0 } }
        }
    }

    /// Tries again after an error that may pass: ``CompassModel/retry()``.
    public func retry() { if state.error?.mayPass == true { runs.retry() } }

    /// Saves the calibration now: for an app that enters the background.
    public func save() { compass.save() }

    /// Forgets the learned calibration, in the store too.
    public func reset() { compass.reset() }
}
#endif
