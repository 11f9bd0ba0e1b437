package org.magcomp

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

/**
 * One run of readings for all who collect at the same time. It begins with the first collector and ends by itself, or when no
 * collector was left for the grace time. A run begins only after the run before has ended to its last line. The readings'
 * error or end reaches every collector after the readings before it; the next collector begins a new run.
 *
 * @param dispatcher where runs are
 * @param graceMs the grace time, milliseconds
 * @param capacity readings kept for a slow collector; it loses the oldest, counted
 * @param onIdle called on the dispatcher when its last collector leaves
 * @param readings one run
 */
internal class SharedReadings(
    dispatcher: CoroutineDispatcher,
    private val graceMs: Long,
    private val capacity: Int,
    private val onIdle: () -> Unit,
    private val readings: () -> Flow<CompensatedReading>,
) {
    private val scope = CoroutineScope(dispatcher + SupervisorJob())
    private val oneAtATime = Mutex()
    private var current: Run? = null

    @Volatile
    var isClosed = false
        private set

    /** What one collector has not taken yet. */
    private class Box(val run: Run, val readings: Channel<CompensatedReading>, val next: Long)

    private inner class Run {
        /** One for each collector. The array is replaced, never changed: what is told goes to those that are there then. */
        private var boxes = emptyArray<Channel<CompensatedReading>>()
        private var latest: CompensatedReading? = null
        private var hasEnded = false
        var collectors = 0
        var ending: Job? = null

        /** Of the end, once the boxes are closed. */
        @Volatile
        var error: Throwable? = null
            private set

        val job = scope.launch(start = CoroutineStart.LAZY) {
            var number = 0L
            val error = try {
                oneAtATime.withLock {
                    readings().collect {
                        it.number = number++
                        tell(it)
                    }
                }
                null
            } catch (e: Throwable) {
                // even a CancellationException, such as a source's own timeout, which would end this coroutine without a word; even an Error,
                // which would leave collectors waiting
                e
            }
            end(error)
        }.apply {
            // where the dispatcher takes nothing more, a run ends without a line of it
            invokeOnCompletion { end(it) }
        }

        /** A box for another collector, with the latest reading where there is one. */
        fun open(): Box = synchronized(this) {
            val box = Channel<CompensatedReading>(capacity, BufferOverflow.DROP_OLDEST)
            latest?.let { box.trySend(it) }
            if (hasEnded) box.close() else boxes += box
            Box(this, box, latest?.number ?: 0)
        }

        fun close(box: Box) = synchronized(this) {
            boxes = boxes.filter { it !== box.readings }.toTypedArray()
        }

        private fun tell(reading: CompensatedReading) {
            val now = synchronized(this) {
                latest = reading
                boxes
            }
            // outside: a collector may run in it
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

    fun collected(): Flow<CompensatedReading> = flow {
        val box = join()
        try {
            box.run.job.start()
            var next = box.next
            for (reading in box.readings) {
                val dropped = reading.number - next
                next = reading.number + 1
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
        }.invokeOnCompletion { refused ->
            // a dispatcher that takes nothing more runs nothing either
            if (refused != null) after()
            scope.cancel()
        }
    }

    @Synchronized
    private fun join(): Box {
        if (isClosed) throw MagcompException.Closed()
        val run = current ?: Run().also { current = it }
        run.collectors += 1
        run.ending?.cancel()
        return run.open()
    }

    /** One collector less; the job that ends now because it was the last, if so. */
    @Synchronized
    private fun part(box: Box): Job? {
        val run = box.run
        run.close(box)
        run.collectors -= 1
        if (run.collectors > 0 || current !== run) return null
        if (graceMs == 0L || !run.job.isActive) {
            current = null
            return run.job.apply { cancel() }
        }
        run.ending = scope.launch {
            onIdle()
            delay(graceMs)
            synchronized(this@SharedReadings) {
                // a collector may have come while this was about to be cancelled
                if (run.collectors == 0) {
                    run.leave()
                    run.job.cancel()
                }
            }
        }
        return null
    }
}
