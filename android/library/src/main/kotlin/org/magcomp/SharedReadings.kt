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

/** Where a run tells its answers, one at a time, from whichever thread it likes. */
internal interface Told {
    /** Whether anybody collects the whole of them. */
    val isWholeWanted: Boolean

    fun tell(answer: Answer)
}

/**
 * One run of readings for all who collect at the same time. It begins with the first collector and ends by itself, or when no
 * collector was left for the grace time. A run begins only after the run before has ended to its last line. The readings'
 * error or end reaches every collector after the readings before it; the next collector begins a new run.
 *
 * @param dispatcher where runs begin and end
 * @param grace the grace time
 * @param onIdle called on the dispatcher when its last collector leaves
 * @param onEnd called after a run; the next one does not wait for it, whoever has left does
 * @param nowNs a clock that counts sleep, nanoseconds
 * @param readings one run
 */
internal class SharedReadings(
    dispatcher: CoroutineDispatcher,
    private val grace: Duration,
    private val onIdle: () -> Unit,
    private val onEnd: suspend () -> Unit,
    private val nowNs: () -> Long,
    private val readings: suspend (to: Told) -> Unit,
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
    private class Box(val isWhole: Boolean, val answers: Channel<Answer>, val next: Long)

    private inner class Run : Told {
        /** One for each collector. The array is replaced, never changed: what is told goes to those that are there then. */
        @Volatile
        private var boxes = emptyArray<Box>()

        private var latest: Answer? = null
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
            // even a CancellationException, such as a source's own timeout, which would end this coroutine without a word; even an Error, which
            // would leave collectors waiting
            end(runCatching { oneAtATime.withLock { readings(this@Run) } }.exceptionOrNull())
            withContext(NonCancellable) { onEnd() }
        }.apply {
            // one that is closed before it has begun ends without a line of it
            invokeOnCompletion { end(it) }
        }

        /** Also for who comes back within the grace time. */
        override val isWholeWanted: Boolean get() = boxes.let { now -> now.isEmpty() || now.any { it.isWhole } }

        /** A box for another collector, with the latest answer where that is still true. */
        fun open(isWhole: Boolean): Box = synchronized(this) {
            val answers = Channel<Answer>(if (isWhole) Compass.MOST_WAITING else 1, BufferOverflow.DROP_OLDEST)
            val isTrue = latest?.isSilence == true || nowNs() - latestAtNs < FRESH_NS
            val now = latest?.takeIf { isTrue && (!isWhole || it.whole != null) }?.also { answers.trySend(it) }
            Box(isWhole, answers, now?.number ?: number).also { boxes += it }
        }

        fun close(box: Box) = synchronized(this) {
            boxes = boxes.filter { it !== box }.toTypedArray()
        }

        override fun tell(answer: Answer) {
            val now = synchronized(this) {
                answer.number = number++
                latest = answer
                latestAtNs = nowNs()
                boxes
            }
            Handover.delivering { for (box in now) box.answers.trySend(answer) }
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
            Handover.delivering { for (box in now) box.answers.close() }
        }

        /** From now on a collector begins another run. */
        fun leave() = synchronized(this@SharedReadings) { if (current === this) current = null }
    }

    /**
     * Every reading, whole; a collector that is slow loses the oldest, counted.
     *
     * @param isBrief whether what is collected takes no time where it runs, so that it may run where readings are told
     */
    fun whole(isBrief: Boolean = false): Flow<CompensatedReading> = flow {
        var next = -1L
        collect(isWhole = true, isBrief) { answer, first ->
            if (next < 0) next = first
            val dropped = answer.number - next
            next = answer.number + 1
            // one that was told before the collector was seen is none of its readings
            val whole = answer.whole ?: return@collect
            emit(if (dropped == 0L) whole else whole.after(dropped))
        }
    }

    /** What [make] makes of the latest answers. */
    fun <T> latest(isBrief: Boolean = false, make: (Answer) -> T): Flow<T> =
        flow { collect(isWhole = false, isBrief) { answer, _ -> emit(make(answer)) } }

    private suspend inline fun collect(isWhole: Boolean, isBrief: Boolean, take: (answer: Answer, first: Long) -> Unit) {
        val (run, box) = join(isWhole)
        try {
            run.job.start()
            for (answer in box.answers) {
                if (!isBrief) Handover.away()
                take(answer, box.next)
            }
            run.error?.let { throw it }
        } finally {
            part(run, box)?.let { withContext(NonCancellable) { it.join() } }
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
    private fun join(isWhole: Boolean): Pair<Run, Box> {
        if (isClosed) throw MagcompException.Closed()
        val run = current ?: Run().also { current = it }
        run.collectors += 1
        run.ending?.cancel()
        return run to run.open(isWhole)
    }

    /** One collector less; the job that ends now because it was the last, if so. */
    private fun part(run: Run, box: Box): Job? {
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
        /** An answer that is older is not given to a collector that joins. */
        const val FRESH_NS = 1_000_000_000L
    }
}
