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
     * The events, each sensor's in the order of their times. The flow is cold: every collector starts its own, and cancels it. The source may
     * drop no event.
     */
    public fun samples(): Flow<SensorSample>

    /**
     * The phone's sensors in use, with the value null before [samples] has chosen them; null if the source knows none. A magnetometer that
     * is silent ends the heading of a [Compass] ([StreamStatus.Silent]).
     */
    public val sensors: StateFlow<SensorsInUse?>? get() = null

    /** The largest component that the magnetometer can measure, microtesla; null if that is not known. */
    public val fullScaleUt: Double? get() = null

    /**
     * The seconds so far that the events' times do not show because the phone slept. They never fall. A [Compass] reads them with every
     * magnetometer sample, and tells its estimator by how much they grew ([Compensator.pushGap]).
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
