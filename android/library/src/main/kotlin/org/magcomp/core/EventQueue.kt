package org.magcomp.core

/**
 * Brings events that are delivered late or in batches into the order of their times, which [Compensator] expects. The rules are those
 * of `EventQueue` in Rust; `tests/vectors/event_order.json` holds both to them. A
 * [SensorManagerSource][org.magcomp.SensorManagerSource] has one; a source of your own may need it.
 *
 * An event waits for every other sensor until that has delivered an event at or after its time. A sensor whose latest
 * event, or else the beginning of the stream, is more than 0.25 s older than the newest event of all is not waited for.
 * Nothing waits for longer than [holdS], counted in the time of the events. At equal times the rotation rate is first,
 * then `up`, then the magnetometer. The queue drops no event: one that comes more than [holdS] too late goes out at
 * once, behind later events. Not thread-safe.
 *
 * @property holdS how long an event may wait, 0 to 0.25 s. With 0 every event goes out as it comes. For batches choose a little more than
 *   one batch takes. Default 0.05
 */
public class EventQueue @JvmOverloads constructor(public val holdS: Double = DEFAULT_HOLD_S) {
    init {
        require(holdS in 0.0..LONGEST_HOLD_S) { "holdS is $holdS, expected 0 to $LONGEST_HOLD_S" }
    }

    private val order = object : EventOrder<SensorSample>(holdS) {
        override fun timeNs(event: SensorSample) = event.timeNs

        override fun sensor(event: SensorSample) = when (event) {
            is SensorSample.RotationRate -> 0
            is SensorSample.Up -> 1
            is SensorSample.Magnetic -> 2
        }
    }

    /**
     * Takes the event that was delivered next, and gives [out] the events whose turn it is now, in order: none, one or several. While 256
     * events wait, the first goes out whatever it waits for.
     */
    public fun push(event: SensorSample, out: (SensorSample) -> Unit): Unit = order.push(event, out)

    /** Gives [out] all events that wait, because the stream has ended or another begins. */
    public fun flush(out: (SensorSample) -> Unit): Unit = order.flush(out)

    /** Constants of every queue. */
    public companion object {
        /** How long an event may wait unless another time is chosen, s. */
        public const val DEFAULT_HOLD_S: Double = 0.05

        /** The longest time that may be chosen, s. */
        public const val LONGEST_HOLD_S: Double = 0.25
    }
}

/** What [EventQueue] does, whatever holds an event. */
internal abstract class EventOrder<T>(holdS: Double) {
    private val holdNs = (holdS * 1e9).toLong()

    /** In the order they go out. */
    private val waiting = ArrayDeque<T>(ROOM)

    /** Time of the event the stream began with. */
    private var beginNs = 0L

    /** Time of the latest event of each sensor. */
    private val latestNs = longArrayOf(NEVER, NEVER, NEVER)

    abstract fun timeNs(event: T): Long

    /** 0, 1 or 2, in the order that events of the same time have. */
    abstract fun sensor(event: T): Int

    fun push(event: T, out: (T) -> Unit) {
        val timeNs = timeNs(event)
        val sinceNs = difference(timeNs, newestNs())
        if (newestNs() == NEVER || sinceNs > PAUSE_NS || sinceNs < -ANOTHER_CLOCK_NS) {
            flush(out)
            beginNs = timeNs
        }
        waiting.add(place(event), event)
        latestNs[sensor(event)] = timeNs
        while (waiting.isNotEmpty() && isDue(timeNs(waiting.first()))) out(waiting.removeFirst())
    }

    fun flush(out: (T) -> Unit) {
        latestNs.fill(NEVER)
        while (waiting.isNotEmpty()) out(waiting.removeFirst())
    }

    /** Behind those that are before it, or came before it at the same time. */
    private fun place(event: T): Int {
        var place = waiting.size
        while (place > 0 && goesBefore(event, waiting[place - 1])) place -= 1
        return place
    }

    private fun goesBefore(one: T, other: T): Boolean =
        timeNs(one) < timeNs(other) || (timeNs(one) == timeNs(other) && sensor(one) < sensor(other))

    /** Whether an event of this time waits no longer. */
    private fun isDue(timeNs: Long): Boolean {
        val newestNs = newestNs()
        return waiting.size >= ROOM ||
            difference(newestNs, timeNs) >= holdNs ||
            latestNs.all { it >= timeNs || difference(newestNs, maxOf(it, beginNs)) > PAUSE_NS }
    }

    private fun newestNs(): Long = maxOf(latestNs[0], latestNs[1], latestNs[2])

    /** Any two times may be subtracted: a difference beyond 64 bits becomes the nearest number of 64 bits. */
    private fun difference(oneNs: Long, otherNs: Long): Long {
        val difference = oneNs - otherNs
        val overflowed = (oneNs xor otherNs) and (oneNs xor difference) < 0
        return if (!overflowed) difference else if (oneNs < 0) Long.MIN_VALUE else Long.MAX_VALUE
    }

    private companion object {
        const val ROOM = 256
        const val NEVER = Long.MIN_VALUE

        // as `sensing/order.rs`
        const val PAUSE_NS = 250_000_000L
        const val ANOTHER_CLOCK_NS = 10_000_000_000L
    }
}
