package org.magcomp

import kotlin.math.pow

/**
 * Smooths an angle for a screen: s += (1 - 2^(-dt / h)) wrap(a - s), with half-life h, so that 359 and 1 degrees are 2
 * degrees apart. The smoothed angle lags by about 1.4 half-lives. Use it for a rose on a screen, not where an app
 * computes with headings. The library itself smooths no reading. A smoother is not thread-safe.
 *
 * @property halfLifeS the seconds after which half of a step is followed, 0 or above; 0 smooths nothing
 */
public class HeadingSmoother(public val halfLifeS: Double) {
    init {
        require(halfLifeS >= 0 && halfLifeS.isFinite()) { "halfLifeS is $halfLifeS, expected 0 or above" }
    }

    private var smoothDeg = Double.NaN
    private var latestNs = 0L

    /**
     * Takes an angle, degrees, and gives the smoothed one, 0 to 360. An angle that is NaN or infinite, as an unknown
     * heading is, gives NaN, and the next angle begins anew. An angle whose time is before the latest begins anew too.
     */
    public fun push(timeNs: Long, angleDeg: Double): Double {
        val elapsedS = (timeNs.toDouble() - latestNs.toDouble()) * 1e-9
        val share = if (smoothDeg.isNaN() || elapsedS < 0 || halfLifeS == 0.0) 1.0 else 1 - 2.0.pow(-elapsedS / halfLifeS)
        val from = if (share == 1.0) angleDeg else smoothDeg
        val stepDeg = Math.IEEEremainder(angleDeg - from, 360.0)
        val towards = (from + share * stepDeg) % 360.0
        smoothDeg = if (towards < 0) towards + 360.0 else towards
        // the rounding of a number just below 0
        if (smoothDeg == 360.0) smoothDeg = 0.0
        latestNs = timeNs
        return smoothDeg
    }
}
