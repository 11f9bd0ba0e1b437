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
import kotlinx.coroutines.delay
import kotlinx.coroutines.flow.Flow
import kotlinx.coroutines.flow.MutableSharedFlow
import kotlinx.coroutines.flow.emitAll
import kotlinx.coroutines.flow.flow
import kotlinx.coroutines.flow.onSubscription
import kotlinx.coroutines.flow.transformWhile
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

    private class Message(val number: Long, val answer: CompensatedReading?, val error: Throwable? = null)

    private inner class Run {
        val messages = MutableSharedFlow<Message>(replay = 1, extraBufferCapacity = capacity - 1, BufferOverflow.DROP_OLDEST)
        var collectors = 0
        var ending: Job? = null
        private var hasEnded = false

        val job = scope.launch(start = CoroutineStart.LAZY) {
            var number = 0L
            val error = try {
                oneAtATime.withLock { readings().collect { messages.emit(Message(number++, it)) } }
                null
            } catch (e: Throwable) {
                // even a CancellationException, such as a source's own timeout, which would end this coroutine without a word; even an Error,
                // which would leave collectors waiting
                e
            }
            end(number, error)
        }.apply {
            // where the dispatcher takes nothing more, a run ends without a line of it
            invokeOnCompletion { end(0, it) }
        }

        /** Ends what is collected, once. */
        private fun end(number: Long, error: Throwable?) {
            leave()
            val isFirst = synchronized(this) { !hasEnded.also { hasEnded = true } }
            if (isFirst) messages.tryEmit(Message(number, null, error.takeUnless { isClosed }))
        }

        /** From now on a collector begins another run. */
        fun leave() = synchronized(this@SharedReadings) { if (current === this) current = null }
    }

    fun collected(): Flow<CompensatedReading> = flow {
        val run = join()
        try {
            // a run that is under way began with its latest reading
            var next = if (run.job.isActive) null else 0L
            val messages = run.messages.onSubscription { run.job.start() }
            emitAll(
                messages.transformWhile { message ->
                    message.error?.let { throw it }
                    val answer = message.answer ?: return@transformWhile false
                    val dropped = message.number - (next ?: message.number)
                    next = message.number + 1
                    emit(if (dropped == 0L) answer else answer.copy(droppedBefore = dropped))
                    true
                },
            )
        } finally {
            part(run)?.let { withContext(NonCancellable) { it.join() } }
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
    private fun join(): Run {
        if (isClosed) throw MagcompException.Closed()
        val run = current ?: Run().also { current = it }
        run.collectors += 1
        run.ending?.cancel()
        return run
    }

    /** One collector less; the job that ends now because it was the last, if so. */
    @Synchronized
    private fun part(run: Run): Job? {
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
