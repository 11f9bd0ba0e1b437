/// What a compass screen shows: ``CompassModel`` brings it to SwiftUI, and says what each is.
struct CompassState: Equatable, Sendable {
    var headingDeg: Double?
    var headingSigmaDeg = 180.0
    var trueHeadingDeg: Double?
    var status = say("starting")
    var coverage = 0.0
    var unseenDirections: [DeviceVector] = []
    var guidance: String?
    var isDisturbed = false
    var event: FieldEvent?
    var reading: CompensatedReading?
    var error: CompassError?

    /// Nothing known: before the first reading, or for a reason.
    init(error: CompassError? = nil) {
        self.error = error
        if let error { status = error.localizedDescription }
    }

    mutating func show(_ answer: CompensatedReading) {
        let new = answer.reading
        // only another status asks for words
        if reading?.reading.status != new.status || reading?.isSilent != answer.isSilent {
            (status, guidance) = (answer.localizedText, answer.localizedGuidance)
            isDisturbed = if case .disturbed = new.status { true } else { false }
        }
        headingDeg = new.heading?.headingDeg
        headingSigmaDeg = new.heading?.headingSigmaDeg ?? 180
        trueHeadingDeg = new.heading?.trueHeadingDeg
        (coverage, unseenDirections) = (new.coverage, answer.unseenDirections)
        (event, reading) = (new.event, answer)
    }
}

extension Compass {
    /// Gives what a screen shows, until the task is cancelled or the source ends. Then nothing is known any more, but a recording's last
    /// state stays. Begins with nothing known, or while the sensors run on after another screen with what they know; an error leaves
    /// nothing but itself and its text. After one that may pass it waits until it is told to try again.
    @MainActor
    func follow(
        rateHz: Double, smoothingHalfLifeS: Double?, retries: SharedRun.Retries, show: (CompassState) -> Void
    ) async {
        while true {
            var screen = CompassScreen(smoothingHalfLifeS: smoothingHalfLifeS)
            do {
                for (field, value) in [("rateHz", rateHz), ("smoothingHalfLifeS", smoothingHalfLifeS ?? 1)]
                where !(value > 0) {
                    throw MagcompError.config(field: "CompassModel.\(field)", value: "\(value)", expected: "above 0")
                }
                show(screen.state)
                var iterator = readings(rateHz: rateHz).makeAsyncIterator()
                while let answer = try await iterator.next(isolation: MainActor.shared) {
                    screen.see(answer)
                    show(screen.state)
                }
                if Task.isCancelled {
                    show(CompassState())
                } else if isLive, let last = screen.state.reading {
                    screen.see(CompensatedReading(silentAfter: last.sample))
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

/// What a screen shows of the readings it sees, smoothed where a half-life is given.
struct CompassScreen {
    private(set) var state = CompassState()
    private var heading, trueHeading: HeadingSmoother?

    init(smoothingHalfLifeS: Double?) {
        heading = smoothingHalfLifeS.map { HeadingSmoother(halfLifeS: $0) }
        trueHeading = heading
    }

    mutating func see(_ answer: CompensatedReading) {
        state.show(answer)
        guard heading != nil else { return }
        state.headingDeg = heading?.push(state.headingDeg, timeNs: answer.sample.timeNs) ?? nil
        state.trueHeadingDeg = trueHeading?.push(state.trueHeadingDeg, timeNs: answer.sample.timeNs) ?? nil
    }
}
