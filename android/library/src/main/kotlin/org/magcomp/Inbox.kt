package org.magcomp

import kotlinx.coroutines.channels.Channel
import kotlinx.coroutines.channels.trySendBlocking
import org.magcomp.core.*

/**
 * Events on their way to one collector. None is dropped: where [most] of them wait, a source of its own waits too. The thread of a phone's sensors
 * can't, and its collector gets [SensorException.NotTaken] after them. The channel gives back the room they took.
 *
 * @param hear gets the sensors in use, before the first event and whenever they are others
 */
internal class Inbox(private val most: Int, private val hear: (SensorsInUse) -> Unit = {}) : EventTaker {
    private val waiting = Channel<RawEvent>(most) { if (onItsWay == null) onItsWay = it }

    /** What was taken for a collector that was cancelled before it got it. */
    @Volatile
    private var onItsWay: RawEvent? = null

    /** Gives every event to [out] until the source ends, with its error. */
    suspend fun each(out: suspend (RawEvent) -> Unit) {
        for (event in waiting) {
            // a cancelled collector does not get it: `rest` does
            onItsWay = event
            Handover.away()
            out(event)
            onItsWay = null
        }
    }

    override fun take(event: RawEvent) {
        val copy = event.copy()
        val sent = waiting.trySend(copy)
        if (sent.isSuccess) return
        if (!sent.isClosed && Handover.isDelivering()) throw SensorException.NotTaken(most)
        waiting.trySendBlocking(copy).getOrThrow()
    }

    override fun heard(sensors: SensorsInUse): Unit = hear(sensors)

    /** No event follows. */
    fun end(error: Throwable?) {
        waiting.close(error)
    }

    /** Gives what waits to [out]. */
    fun rest(out: (RawEvent) -> Unit) {
        onItsWay?.let(out)
        while (true) out(waiting.tryReceive().getOrNull() ?: return)
    }

    /** Nobody collects any more: who waits for room is told. */
    fun cancel() = waiting.cancel()
}
