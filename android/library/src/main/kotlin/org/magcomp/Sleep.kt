package org.magcomp

import kotlin.math.abs

/**
 * How much time a sensor's clock did not show beside one that never stops. An event is delivered later than it happened, by any time
 * where events come in batches, so only the smallest lag of half a second of events counts.
 */
internal class Sleep {
    /** Seconds so far. */
    @Volatile
    var hiddenS = 0.0
        private set

    // NaN: there is none. Numbers that may be null would cost an object an event

    /** The smallest lag of the two clocks, s. */
    private var leastS = Double.NaN

    /** The smallest lag since all have been others, s, and since when, ns. */
    private var otherS = Double.NaN
    private var otherSinceNs = 0L
    private var latestNs = 0L

    /** How far the sensor's clock is behind the one that never stops, ns; 0 where they differ by no more than events are late. */
    @get:Synchronized
    val behindNs: Long get() = if (abs(leastS) > LEAST_S) (leastS * 1e9).toLong() else 0

    /** An event of this time was delivered now. */
    @Synchronized
    fun see(timeNs: Long, nowNs: Long) {
        // any two times may be subtracted
        val lagS = (nowNs.toDouble() - timeNs.toDouble()) * 1e-9
        // what came before a pause tells nothing of a batch after it
        if (nowNs - latestNs > OTHER_FOR_NS) otherS = Double.NaN
        latestNs = nowNs
        if (leastS.isNaN() || abs(lagS - leastS) <= LEAST_S) {
            leastS = if (leastS < lagS) leastS else lagS
            otherS = Double.NaN
            return
        }
        if (otherS.isNaN()) otherSinceNs = nowNs
        otherS = if (otherS < lagS) otherS else lagS
        if (nowNs - otherSinceNs < OTHER_FOR_NS) return
        // less: the first events were delivered late
        hiddenS += (otherS - leastS).coerceIn(0.0, LONGEST_S)
        leastS = otherS
        otherS = Double.NaN
    }

    private companion object {
        /** Shorter sleep is as good as none. */
        const val LEAST_S = 1.0

        /** What the compensator takes; longer than any phone runs. */
        const val LONGEST_S = 1e9

        /** Events that waited have all been delivered by then. */
        const val OTHER_FOR_NS = 500_000_000L
    }
}
