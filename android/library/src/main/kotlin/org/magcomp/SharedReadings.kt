package org.magcomp

import kotlin.time.Duration
import kotlinx.coroutines.CoroutineDispatcher
import kotlinx.coroutines.CoroutineScope
import kotlinx.coroutines.CoroutineStart
import kotlinx.coroutines.Job
import kotlinx.coroutines.NonCancellable
import kotlinx.coroutines.SupervisorJob
import kotlinx.coroutines.cancel
import kotlinx.coroutines.cancelAndJoin
import kotlinx.coroutines.channels.BufferOverflow
import kotlinx.coroutines.channels.Channel
import kotlinx.coroutines.delay
import kotlinx.coroutines.flow.Flow
import kotlinx.coroutines.flow.flow
import kotlinx.coroutines.launch
import kotlinx.coroutines.sync.Mutex
import kotlinx.coroutines.sync.withLock
import kotlinx.coroutines.withContext
import org.magcomp.core.*

/**
 * One run of readings for all who collect at the same time. It begins with the first collector and ends by itself, or when no
 * collector was left for the grace time. A run begins only after the run before has ended to its last line. The readings'
 * error or end reaches every collector after the readings before it; the next collector begins a new run.
 *
 * @param dispatcher where runs begin and end
 * @param handover takes collectors off the thread that tells readings
 * @param grace the grace time
 * @param onIdle called on the dispatcher when its last collector leaves
 * @param onEnd called after a run; the next one does not wait for it, whoever has left does
 * @param nowNs a clock that counts sleep, nanoseconds
 * @param readings one run: it tells every reading, one at a time, from whichever thread it likes
 */
internal class SharedReadings(
    dispatcher: CoroutineDispatcher,
    private val grace: Duration,
    private val onIdle: () -> Unit = {},
    private val onEnd: suspend () -> Unit = {},
    private val nowNs: () -> Long = System::nanoTime,
    private val handover: Handover = Handover(),
    private val readings: suspend (tell: (CompensatedReading) -> Unit) -> Unit,
) {
    private val scope = CoroutineScope(dispatcher + SupervisorJob())
    private val oneAtATime = Mutex()
    private var current: Run? = null

    @Volatile
    var isClosed = false
        private set

    /** Whether anybody collects now. */
    val isCollected: Boolean @Synchronized get() = (current?.collectors ?: 0) > 0

    /** What one collector has not taken yet. */
    private class Box(val run: Run, val readings: Channel<CompensatedReading>, val next: Long)

    private inner class Run {
        /** One for each collector. The array is replaced, never changed: what is told goes to those that are there then. */
        private var boxes = emptyArray<Channel<CompensatedReading>>()
        private var latest: CompensatedReading? = null
        private var latestAtNs = 0L
        private var number = 0L
        private var hasEnded = false
        var collectors = 0
        var ending: Job? = null

        /** Of the end, once the boxes are closed. */
        @Volatile
        var error: Throwable? = null
            private set

        val job = scope.launch(start = CoroutineStart.LAZY) {
            val error = try {
                oneAtATime.withLock { readings(::tell) }
                null
            } catch (e: Throwable) {
                // even a CancellationException, such as a source's own timeout, which would end this coroutine without a word; even an Error,
                // which would leave collectors waiting
                e
            }
            end(error)
            withContext(NonCancellable) { onEnd() }
        }.apply {
            // one that is closed before it has begun ends without a line of it
            invokeOnCompletion { end(it) }
        }

        /** A box for another collector, with the latest reading where that is still true. */
        fun open(capacity: Int): Box = synchronized(this) {
            val box = Channel<CompensatedReading>(capacity, BufferOverflow.DROP_OLDEST)
            val now = latest?.takeIf { it.isSilence || nowNs() - latestAtNs < FRESH_NS }?.also { box.trySend(it) }
            boxes += box
            Box(this, box, now?.number ?: number)
        }

        fun close(box: Box) = synchronized(this) {
            boxes = boxes.filter { it !== box.readings }.toTypedArray()
        }

        private fun tell(reading: CompensatedReading) {
            handover.isDelivering()
            val now = synchronized(this) {
                reading.number = number++
                latest = reading
                latestAtNs = nowNs()
                boxes
            }
            for (box in now) box.trySend(reading)
        }

        /** Ends what is collected, once. */
        private fun end(error: Throwable?) {
            leave()
            val now = synchronized(this) {
                if (hasEnded) return
                hasEnded = true
                this.error = error.takeUnless { isClosed }
                boxes
            }
            for (box in now) box.close()
        }

        /** From now on a collector begins another run. */
        fun leave() = synchronized(this@SharedReadings) { if (current === this) current = null }
    }

    /**
     * @param capacity readings kept for a slow collector; it loses the oldest, counted
     * @param isBrief whether what is collected takes no time where it runs, so that it may run where readings are told
     */
    fun collected(capacity: Int, isBrief: Boolean = false): Flow<CompensatedReading> = flow {
        val box = join(capacity)
        try {
            box.run.job.start()
            var next = box.next
            for (reading in box.readings) {
                val dropped = reading.number - next
                next = reading.number + 1
                if (!isBrief) handover.away()
                emit(if (dropped == 0L) reading else reading.after(dropped))
            }
            box.run.error?.let { throw it }
        } finally {
            part(box)?.let { withContext(NonCancellable) { it.join() } }
        }
    }

    /** Ends the run; what is collected ends. Then [after] is called on the dispatcher, once. */
    fun close(after: () -> Unit) {
        val run = synchronized(this) {
            if (isClosed) return
            isClosed = true
            current.also { current = null }
        }
        scope.launch {
            run?.job?.cancelAndJoin()
            oneAtATime.withLock { after() }
        }.invokeOnCompletion { scope.cancel() }
    }

    @Synchronized
    private fun join(capacity: Int): Box {
        if (isClosed) throw MagcompException.Closed()
        val run = current ?: Run().also { current = it }
        run.collectors += 1
        run.ending?.cancel()
        return run.open(capacity)
    }

    /** One collector less; the job that ends now because it was the last, if so. */
    private fun part(box: Box): Job? {
        val run = box.run
        synchronized(this) {
            run.close(box)
            run.collectors -= 1
            if (run.collectors > 0 || current !== run) return null
            if (grace > Duration.ZERO && run.job.isActive) {
                run.ending = scope.launch {
                    onIdle()
                    delay(grace)
                    endIdle(run)
                }
                return null
            }
            current = null
        }
        // outside: what ends may run in it
        return run.job.apply { cancel() }
    }

    /** Ends a run that nobody collects: a collector may have come while this was about to be cancelled. */
    private fun endIdle(run: Run) {
        if (synchronized(this) { (run.collectors == 0).also { if (it) run.leave() } }) run.job.cancel()
    }

    private companion object {
        /** A reading that is older is not given to a collector that joins. */
        const val FRESH_NS = 1_000_000_000L
    }
}
