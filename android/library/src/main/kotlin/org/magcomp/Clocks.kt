package org.magcomp

import kotlin.math.abs

/**
 * Brings each sensor's times to the magnetometer's clock. Which clock a sensor has is seen in when its events arrive: they are late by any
 * time, so of a span only the smallest lag counts, and it has to be the same in two spans. One thread at a time.
 *
 * @param periodNs between two events of a sensor
 * @param latencyNs how long the system may keep events before it delivers them
 */
internal class Clocks(periodNs: Long, latencyNs: Long) {
    private val spanNs = maxOf(SHORTEST_SPAN_NS, 2 * LEAST_EVENTS * periodNs) + 2 * latencyNs
    private var beganNs = 0L
    private val leastNs = LongArray(KINDS)
    private val events = IntArray(KINDS)

    /** How far each is behind the magnetometer's, ns: what is in force, and what the span before has shown. */
    private val behindNs = LongArray(KINDS)
    private val shownNs = LongArray(KINDS)

    /** Whether the latest event was the first of other times of a sensor: those before it were out of step. */
    var hasChanged = false
        private set

    /** The time of an event on the magnetometer's clock. */
    fun magnetometersNs(kind: Int, timeNs: Long, nowNs: Long): Long {
        hasChanged = false
        if (nowNs - beganNs !in 0..spanNs) {
            // over a pause the lags of before tell nothing
            if (nowNs - beganNs in 0..2 * spanNs) endSpan()
            beganNs = nowNs
            events.fill(0)
        }
        val lagNs = nowNs - timeNs
        leastNs[kind] = if (events[kind] == 0) lagNs else minOf(leastNs[kind], lagNs)
        events[kind] += 1
        return timeNs + behindNs[kind]
    }

    private fun endSpan() {
        if (events[RawEvent.MAGNETIC] < LEAST_EVENTS) return
        for (kind in 0 until KINDS) {
            if (kind == RawEvent.MAGNETIC || events[kind] < LEAST_EVENTS) continue
            val foundNs = (leastNs[kind] - leastNs[RawEvent.MAGNETIC]).let { if (isAnother(it, 0)) it else 0 }
            if (isAnother(foundNs, behindNs[kind]) && !isAnother(foundNs, shownNs[kind])) {
                behindNs[kind] = foundNs
                hasChanged = true
            }
            shownNs[kind] = foundNs
        }
    }

    private fun isAnother(oneNs: Long, otherNs: Long) = abs(oneNs.toDouble() - otherNs.toDouble()) > SAME_NS

    companion object {
        private const val KINDS = 3
        private const val SHORTEST_SPAN_NS = 500_000_000L
        private const val LEAST_EVENTS = 5

        /** Events that are late by less have the same clock: as far as the queue waits for one. */
        const val SAME_NS = 250_000_000.0
    }
}
