/// What a compass screen shows; ``CompassModel`` brings it to SwiftUI.
public struct CompassState: Equatable, Sendable {
    /// Clockwise from magnetic north, degrees, 0 to 360; nil when it is not known.
    public var headingDeg: Double?
    /// One standard deviation of it, degrees; 180, nothing known, where there is no better.
    public var headingSigmaDeg = 180.0
    /// Clockwise from true north, degrees, 0 to 360; nil without a heading, or a declination in the compass's frame.
    public var trueHeadingDeg: Double?
    /// Length of the corrected field, microtesla.
    public var totalFieldUt: Double?
    /// What the system itself says of the field, microtesla, and how well it is calibrated.
    public var systemField: SystemFieldSample?
    /// What the compensator is doing, in a sentence; or why there are no readings.
    public var status = say("starting")
    /// Share of the directions seen, 0 to 1.
    public var coverage = 0.0
    /// Where the field has not pointed yet, unit vectors in the device frame.
    public var unseenDirections: [DeviceVector] = []
    /// What the person can do for a better heading, or nil.
    public var guidance: String?
    /// The latest decided change of the field: a cover put on or taken off, another place.
    public var event: FieldEvent?
    /// All that the latest reading has.
    public var reading: CompensatedReading?
    /// Why there are no readings.
    public var error: CompassError?

    /// Whether the place is disturbed, so that the heading is not to be relied on.
    public var isDisturbed: Bool {
        if case .disturbed = reading?.reading.status { true } else { false }
    }

    /// Nothing known: before the first reading.
    public init() {}

    /// What a screen shows of one reading, for previews.
    public init(_ reading: CompensatedReading) { show(reading) }

    /// Nothing known, for a reason.
    init(error: CompassError) { (self.error, status) = (error, error.localizedDescription) }

    mutating func show(_ answer: CompensatedReading) {
        let new = answer.reading
        // only another status asks for words
        if reading?.reading.status != new.status || reading?.isSilent != answer.isSilent {
            (status, guidance) = (answer.localizedText, answer.localizedGuidance)
        }
        headingDeg = new.heading?.headingDeg
        headingSigmaDeg = new.heading?.headingSigmaDeg ?? 180
        trueHeadingDeg = new.heading?.trueHeadingDeg
        (totalFieldUt, systemField) = (new.totalFieldUt, answer.systemField)
        (coverage, unseenDirections) = (new.coverage, answer.unseenDirections)
        event = new.event
        reading = answer
    }
}

/// How a screen shows a compass.
public struct CompassDisplay: Equatable, Sendable {
    /// At most this many states a second, by the times of the samples, above 0. Default 60: as often as a screen is drawn.
    public var rateHz: Double
    /// Half-life of headings' smoothing, seconds, above 0; nil, the default: they are shown as they come.
    public var smoothingHalfLifeS: Double?

    public init(rateHz: Double = 60, smoothingHalfLifeS: Double? = nil) {
        (self.rateHz, self.smoothingHalfLifeS) = (rateHz, smoothingHalfLifeS)
    }

    func check() throws {
        for (field, value) in [("rateHz", rateHz), ("smoothingHalfLifeS", smoothingHalfLifeS ?? 1)] where !(value > 0) {
            throw MagcompError.config(field: "CompassDisplay.\(field)", value: "\(value)", expected: "above 0")
        }
    }
}

extension Compass {
    /// Gives what a screen shows, until the task is cancelled or the source ends. Then nothing is known any more, but a recording's last
    /// state stays. Begins with nothing known, or while the sensors run on after another screen with what they know; an error leaves nothing but itself and its
    /// text. After one that may pass it waits until it is told to try again.
    @MainActor
    func follow(_ display: CompassDisplay, retries: SharedRun.Retries, show: (CompassState) -> Void) async {
        while true {
            var screen = CompassScreen(display)
            do {
                try display.check()
                if let latest { _ = screen.see(latest) }
                show(screen.state)
                var iterator = readings(rateHz: display.rateHz).makeAsyncIterator()
                while let answer = try await iterator.next(isolation: MainActor.shared) {
                    if screen.see(answer) { show(screen.state) }
                }
                if Task.isCancelled {
                    show(CompassState())
                } else if screen.end(isLive: isLive) {
                    show(screen.state)
                }
                return
            } catch {
                let error = CompassError(error)
                show(CompassState(error: error))
                guard error.mayPass else { return }
            }
            var isTold = false
            for await _ in retries {
                isTold = true
                break
            }
            // else the task was cancelled
            if !isTold {
                show(CompassState())
                return
            }
        }
    }
}

/// What a screen shows of the readings it sees: some of them, smoothed, as its display says.
struct CompassScreen {
    private(set) var state = CompassState()
    private let display: CompassDisplay
    private var heading, trueHeading: HeadingSmoother?
    private var shownNs: Int64?
    private var waiting: CompensatedReading?

    init(_ display: CompassDisplay) {
        self.display = display
        heading = display.smoothingHalfLifeS.map { HeadingSmoother(halfLifeS: $0) }
        trueHeading = heading
    }

    /// Whether the state shows this reading now.
    mutating func see(_ answer: CompensatedReading) -> Bool {
        let timeNs = answer.sample.timeNs
        if answer.isSilent {
            (shownNs, waiting) = (nil, nil)
            take(answer)
            return true
        }
        // the clock may have begun anew since, so either may be the later
        if let shownNs, abs(Double(timeNs) - Double(shownNs)) * display.rateHz < 1e9 {
            waiting = answer
            return false
        }
        (shownNs, waiting) = (timeNs, nil)
        take(answer)
        return true
    }

    /// Whether the last reading was not shown yet, and now the state shows it; or that a source that was live gives no more.
    mutating func end(isLive: Bool) -> Bool {
        if isLive, let last = waiting ?? state.reading { return see(CompensatedReading(silentAfter: last.sample)) }
        guard let waiting else { return false }
        take(waiting)
        self.waiting = nil
        return true
    }

    private mutating func take(_ answer: CompensatedReading) {
        state.show(answer)
        let timeNs = answer.sample.timeNs
        state.headingDeg = smooth(state.headingDeg, timeNs, &heading)
        state.trueHeadingDeg = smooth(state.trueHeadingDeg, timeNs, &trueHeading)
    }
}

/// The smoothed heading; nothing is smoothed across a moment without one.
private func smooth(_ headingDeg: Double?, _ timeNs: Int64, _ smoother: inout HeadingSmoother?) -> Double? {
    guard let headingDeg else {
        smoother?.reset()
        return nil
    }
    return smoother?.push(headingDeg, timeNs: timeNs) ?? headingDeg
}
