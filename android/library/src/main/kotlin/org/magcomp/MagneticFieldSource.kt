package org.magcomp

import kotlinx.coroutines.CoroutineStart
import kotlinx.coroutines.coroutineScope
import kotlinx.coroutines.currentCoroutineContext
import kotlinx.coroutines.ensureActive
import kotlinx.coroutines.flow.Flow
import kotlinx.coroutines.flow.StateFlow
import kotlinx.coroutines.launch
import org.magcomp.core.*

/** Where events come from: a phone's sensors ([SensorManagerSource]), a recording ([RecordingSource]), or your own. */
public interface MagneticFieldSource {
    /**
     * The events, each sensor's in the order of their times. Cold: every collector starts its own, and ends it by
     * cancelling. No event may be dropped on the way.
     */
    public fun samples(): Flow<SensorSample>

    /**
     * The phone's sensors that are used, null before [samples] has chosen them; null when the source knows none. A magnetometer that is
     * silent ends the heading of a [Compass] ([StreamStatus.Silent]).
     */
    public val sensors: StateFlow<SensorsInUse?>? get() = null

    /** Largest component that the magnetometer can measure, microtesla; null where that is not known. */
    public val fullScaleUt: Double? get() = null

    /**
     * Seconds that have passed so far and that the events' times do not show, because the phone slept; never less than before. Read
     * with every magnetometer sample; what it grew by goes to [Compensator.pushGap].
     */
    public val hiddenS: Double get() = 0.0

    /** The time that this source's events have when `SystemClock.elapsedRealtimeNanos()` is [elapsedRealtimeNs], for [Compass.aid]. */
    public fun eventTimeNs(elapsedRealtimeNs: Long): Long = elapsedRealtimeNs
}

/** Gives a taker the events until they end, or their error: on the sensors' thread those of a phone, those of another source where this is called. */
internal suspend fun MagneticFieldSource.deliver(taker: EventTaker) {
    if (this is SensorManagerSource) deliverOnTheirThread(taker)
    val source = this
    coroutineScope {
        var known: SensorsInUse? = null
        // one at a time, whichever thread it is on
        fun hear() = synchronized(taker) {
            val now = source.sensors?.value
            if (now == null || now === known) return@synchronized
            known = now
            taker.heard(now)
        }
        // what does not come can't say so: who knows the sensors does
        val hearing = source.sensors?.let { told -> launch(start = CoroutineStart.UNDISPATCHED) { told.collect { hear() } } }
        val raw = RawEvent()
        samples().collect {
            currentCoroutineContext().ensureActive()
            hear()
            raw.set(it)
            synchronized(taker) { taker.take(raw) }
        }
        hearing?.cancel()
    }
}
