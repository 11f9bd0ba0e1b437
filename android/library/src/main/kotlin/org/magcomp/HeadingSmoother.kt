package org.magcomp

import kotlin.math.pow

/**
 * Smooths an angle for a screen: s += (1 - 2^(-dt / h)) wrap(a - s), with half-life h, so that 359 and 1 degrees are 2 degrees apart. It
 * delays what it smooths by about 1.4 half-lives: a rose on a screen wants it, nothing that computes with headings does, and no reading
 * is smoothed unless an app does so. Not thread-safe.
 *
 * @property halfLifeS after so many seconds half of a step is followed; 0 or above, 0 smooths nothing
 */
public class HeadingSmoother(public val halfLifeS: Double) {
    init {
        require(halfLifeS >= 0 && halfLifeS.isFinite()) { "halfLifeS is $halfLifeS, expected 0 or above" }
    }

    private var smoothDeg = Double.NaN
    private var latestNs = 0L

    /**
     * Takes an angle, degrees, and gives the smoothed one, 0 to 360. One that is NaN or infinite, as a heading that is not known, gives NaN,
     * and the next begins anew; so does one whose time is before that of the latest.
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
