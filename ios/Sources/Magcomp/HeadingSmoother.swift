import Foundation

/// Smooths headings for a rose on a screen. In every half-life the shown heading makes half of its way to the given
/// one, the shorter way round: y += (1 - 2^(-dt / halfLife)) wrap(x - y).
///
/// In a steady turn the shown heading lags by about 1.4 half-lives; the heading's sigma does not count this lag.
struct HeadingSmoother {
    /// Seconds in which half of a difference goes.
    let halfLifeS: Double
    private var latest: (headingDeg: Double, timeNs: Int64)?

    /// - Parameter halfLifeS: seconds; 0 or NaN smooths nothing
    init(halfLifeS: Double) { self.halfLifeS = halfLifeS }

    /// The smoothed heading, degrees, 0 to 360. The first heading is returned as it is; so is one whose time is not
    /// after the latest, as when a clock began anew. One that is no number is returned and forgotten.
    mutating func push(_ headingDeg: Double, timeNs: Int64) -> Double {
        guard headingDeg.isFinite else { return headingDeg }
        var shown = headingDeg
        if let latest, timeNs > latest.timeNs, halfLifeS > 0 {
            let seconds = (Double(timeNs) - Double(latest.timeNs)) * 1e-9
            let share = 1 - exp2(-seconds / halfLifeS)
            shown = latest.headingDeg + share * (headingDeg - latest.headingDeg).remainder(dividingBy: 360)
        }
        shown = CompassState.shownDeg(shown) ?? headingDeg
        latest = (shown, timeNs)
        return shown
    }

    /// As above; nothing is smoothed across a moment without a heading.
    mutating func push(_ headingDeg: Double?, timeNs: Int64) -> Double? {
        if headingDeg == nil { latest = nil }
        return headingDeg.map { push($0, timeNs: timeNs) }
    }
}
