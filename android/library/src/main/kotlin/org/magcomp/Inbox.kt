package org.magcomp

import kotlinx.coroutines.channels.Channel

/**
 * Events on their way from the sensors' thread to one collector. None is dropped: where [most] of them wait, the collector gets
 * [SensorException.NotTaken] after them. The channel gives back the room they took.
 *
 * @param hear gets the sensors in use, before the first event and whenever they are others
 */
internal class Inbox(private val most: Int, private val handover: Handover, private val hear: (SensorsInUse) -> Unit = {}) : EventTaker {
    private val waiting = Channel<RawEvent>(most)

    /** Gives every event to [out] until the source ends them with an error. */
    suspend fun each(out: suspend (RawEvent) -> Unit) {
        for (event in waiting) {
            handover.away()
            out(event)
        }
    }

    override fun take(event: RawEvent) {
        handover.isDelivering()
        if (!waiting.trySend(event.copy()).isSuccess) throw SensorException.NotTaken(most)
    }

    override fun heard(sensors: SensorsInUse) = hear(sensors)

    override fun failed(error: Throwable) {
        waiting.close(error)
    }
}
