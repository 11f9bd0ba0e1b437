package org.magcomp

import kotlinx.coroutines.flow.Flow
import kotlinx.coroutines.flow.StateFlow

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
