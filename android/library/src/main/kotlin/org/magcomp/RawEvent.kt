package org.magcomp

import kotlinx.coroutines.channels.Channel
import kotlinx.coroutines.flow.Flow
import kotlinx.coroutines.flow.emitAll
import kotlinx.coroutines.flow.flow
import kotlinx.coroutines.flow.map

/** One event of a sensor as numbers. It is used again: who gets one is done with it when it returns. */
internal class RawEvent {
    /** [ROTATION_RATE], [UP] or [MAGNETIC]. */
    var kind = 0
    var timeNs = 0L
    var x = 0.0
    var y = 0.0
    var z = 0.0

    /** Of a magnetometer the operating system's own hard iron. */
    var reported: DeviceVector? = null

    fun set(kind: Int, timeNs: Long, x: Double, y: Double, z: Double, reported: DeviceVector? = null) {
        this.kind = kind
        this.timeNs = timeNs
        this.x = x
        this.y = y
        this.z = z
        this.reported = reported
    }

    fun set(event: SensorSample) = when (event) {
        is SensorSample.RotationRate -> with(event.sample.rateRadS) { set(ROTATION_RATE, event.timeNs, x, y, z) }
        is SensorSample.Up -> with(event.sample.upMS2) { set(UP, event.timeNs, x, y, z) }
        is SensorSample.Magnetic -> with(event.sample.fieldUt) { set(MAGNETIC, event.timeNs, x, y, z, event.sample.reportedHardIronUt) }
    }

    fun toSample(): SensorSample {
        val vector = DeviceVector(x, y, z)
        return when (kind) {
            ROTATION_RATE -> SensorSample.RotationRate(RotationRateSample(timeNs, vector))
            UP -> SensorSample.Up(UpSample(timeNs, vector))
            else -> SensorSample.Magnetic(MagneticSample(timeNs, vector, reported))
        }
    }

    companion object {
        // at equal times in this order
        const val ROTATION_RATE = 0
        const val UP = 1
        const val MAGNETIC = 2
    }
}

/** The same events, in one object that is used again. */
internal fun Flow<SensorSample>.raw(): Flow<RawEvent> {
    val events = this
    return flow {
        val raw = RawEvent()
        emitAll(events.map { raw.apply { set(it) } })
    }
}

/**
 * Events on their way from a sensors' thread to one collector, in the order of [EventQueue]; any number may wait. Once there are as many
 * objects as ever wait at a time, an event costs none.
 *
 * @param isEager whether every event wakes the collector; if not, one of the magnetometer does, or when [MANY] wait
 */
internal class Inbox(holdS: Double, private val isEager: Boolean) {
    private val order = object : EventOrder<RawEvent>(holdS) {
        override fun timeNs(event: RawEvent) = event.timeNs

        override fun sensor(event: RawEvent) = event.kind
    }
    private val due = ArrayDeque<RawEvent>()
    private val free = ArrayDeque<RawEvent>()
    private var isNews = false
    private val release: (RawEvent) -> Unit = {
        due.addLast(it)
        if (isEager || due.size >= MANY || it.kind == RawEvent.MAGNETIC) isNews = true
    }
    private val news = Channel<Unit>(Channel.CONFLATED)

    /** From the sensors' thread. */
    fun put(kind: Int, timeNs: Long, x: Double, y: Double, z: Double, reported: DeviceVector? = null) {
        val wakes = synchronized(this) {
            val event = free.removeLastOrNull() ?: RawEvent()
            event.set(kind, timeNs, x, y, z, reported)
            isNews = false
            order.push(event, release)
            isNews
        }
        // outside: it may run who waits. It fails only when the collector has gone: then nobody wants it
        if (wakes) news.trySend(Unit)
    }

    /** Gives [take] every event, one at a time, until it is cancelled. */
    suspend inline fun takeAll(take: (RawEvent) -> Unit): Nothing {
        while (true) {
            news.receive()
            while (true) {
                val event = next() ?: break
                take(event)
                done(event)
            }
        }
    }

    @Synchronized
    private fun next(): RawEvent? = due.removeFirstOrNull()

    @Synchronized
    private fun done(event: RawEvent) = free.addLast(event)

    private companion object {
        const val MANY = 64
    }
}
