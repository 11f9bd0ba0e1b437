@file:JvmName("Sources")

package org.magcomp

import kotlinx.coroutines.Dispatchers
import kotlinx.coroutines.coroutineScope
import kotlinx.coroutines.flow.Flow
import kotlinx.coroutines.flow.flow
import kotlinx.coroutines.flow.map
import kotlinx.coroutines.launch
import org.magcomp.core.*

/**
 * Where events come from: a phone's sensors ([SensorManagerSource]), a recording ([RecordingSource]), or your own. A source that changes or
 * notes the events of another is `class Filtered(source: MagneticFieldSource) : MagneticFieldSource by source` with a [deliver] of its own.
 */
public interface MagneticFieldSource {
    /**
     * Gives [taker] the events, each sensor's in the order of their times, until they end or this is cancelled. The source makes one call at a
     * time and drops no event. A [Compass] calls this on a thread that does nothing else, and estimates on the thread that calls [taker].
     */
    public suspend fun deliver(taker: EventTaker)

    /** The largest component that the magnetometer can measure, microtesla; null if that is not known. */
    public val fullScaleUt: Double? get() = null

    /**
     * The seconds so far that the events' times do not show because the phone slept. They never fall. A [Compass] reads them with every
     * magnetometer sample, and tells its estimator by how much they grew ([Compensator.pushGap]).
     */
    public val hiddenS: Double get() = 0.0

    /** A clock that goes on while the phone sleeps, nanoseconds, on which a [Compass] sees how old its latest reading is. */
    public val nowNs: Long get() = System.nanoTime()

    /** The time that this source's events have when `SystemClock.elapsedRealtimeNanos()` is [elapsedRealtimeNs], for [Compass.aid]. */
    public fun eventTimeNs(elapsedRealtimeNs: Long): Long = elapsedRealtimeNs
}

/** Takes the events of a [MagneticFieldSource]. */
public interface EventTaker {
    /** Takes an event. It throws where no more are wanted. */
    public fun take(event: RawEvent)

    /**
     * The phone's sensors in use are these: before the first event, and whenever they are others. A source that knows no sensors does not call
     * it. A magnetometer that is silent ends the heading of a [Compass] ([StreamStatus.Silent]).
     */
    public fun heard(sensors: SensorsInUse): Unit = Unit

    /** The events before this were out of step: a sensor's clock is another one than was thought. */
    public fun anotherClock(): Unit = Unit
}

/**
 * The events, for one collector. Where 18 000 of a phone's sensors wait for it, a minute of three at 100 Hz, it gets these and then
 * [SensorException.NotTaken].
 */
public fun MagneticFieldSource.samples(): Flow<SensorSample> = events().map { it.toSample() }

/** The same with each sensor's own times. [hear] gets the sensors in use before the first event, [rest] what still waits when the collector ends. */
internal fun MagneticFieldSource.events(hear: (SensorsInUse) -> Unit = {}, rest: (RawEvent) -> Unit = {}): Flow<RawEvent> = flow {
    coroutineScope {
        val inbox = Inbox(MOST_EVENTS, hear)
        // elsewhere: a source need not suspend
        val delivering = launch(Dispatchers.IO) { inbox.end(runCatching { deliver(inbox) }.exceptionOrNull()) }
        try {
            inbox.each(::emit)
        } finally {
            delivering.cancel()
            inbox.rest(rest)
            inbox.cancel()
        }
    }
}

private const val MOST_EVENTS = 18_000
