package org.magcomp

import kotlinx.coroutines.channels.Channel
import kotlinx.coroutines.channels.ReceiveChannel

/**
 * Samples on their way from the sensors' thread to one collector. None is dropped: where [most] of them wait, the collector gets
 * [SensorException.NotTaken] after them. The room they took is given back.
 */
internal class Inbox(private val most: Int) : EventTaker {
    private val waiting = Channel<SensorSample>(most)

    /** What the collector takes; it ends with the error. */
    val samples: ReceiveChannel<SensorSample> get() = waiting

    override fun take(event: RawEvent) {
        if (!waiting.trySend(event.toSample()).isSuccess) throw SensorException.NotTaken(most)
    }

    override fun failed(error: Throwable) {
        waiting.close(error)
    }
}
