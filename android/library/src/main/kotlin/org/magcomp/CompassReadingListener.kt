package org.magcomp

import java.util.concurrent.ExecutionException
import java.util.concurrent.Executor
import java.util.concurrent.ExecutorService
import java.util.concurrent.RejectedExecutionException
import kotlinx.coroutines.CompletableDeferred
import kotlinx.coroutines.CoroutineScope
import kotlinx.coroutines.Dispatchers
import kotlinx.coroutines.SupervisorJob
import kotlinx.coroutines.cancel
import kotlinx.coroutines.ensureActive
import kotlinx.coroutines.flow.Flow
import kotlinx.coroutines.isActive
import kotlinx.coroutines.launch
import kotlinx.coroutines.withTimeoutOrNull

/** What a Java app implements to get readings. */
public interface CompassReadingListener {
    /** One reading. */
    public fun onReading(reading: CompensatedReading)

    /**
     * There are no more readings, because the source ended or for this error: a [SensorException], a
     * [RecordingException], a [java.io.IOException] of a recording's file, a [MagcompException], a [NativeLibraryException],
     * or what the source or [onReading] threw; an [Error] is the cause of an [ExecutionException]. Not called after closing.
     *
     * An executor that was shut down gets no call: with a [RejectedExecutionException] this one comes on a thread of the
     * compass.
     */
    public fun onEnd(error: Exception?)
}

/** What a Java app implements for a screen. */
public interface HeadingListener {
    /** The latest reading. */
    public fun onHeading(reading: CompassReading)

    /** As [CompassReadingListener.onEnd]. */
    public fun onEnd(error: Exception?)
}

/** A listener and the executor it is called on. */
internal class Listening<T>(private val executor: Executor, private val onNext: (T) -> Unit, private val onEnd: (Exception?) -> Unit) {
    fun start(readings: Flow<T>): AutoCloseable {
        // it hands over to the executor and does no work of its own: so no work of others holds it up
        val scope = CoroutineScope(Dispatchers.Unconfined + SupervisorJob())
        scope.launch {
            // whoever threw it: nobody above this coroutine would hear of it before the app crashed
            val error = try {
                readings.collect { call(scope) { onNext(it) } }
                null
            } catch (e: Exception) {
                e
            } catch (e: Error) {
                ExecutionException(e)
            }
            // after closing there is nobody to tell
            ensureActive()
            try {
                executor.execute { if (scope.isActive) onEnd(error) }
            } catch (e: RejectedExecutionException) {
                onEnd(error ?: e)
            }
        }
        return AutoCloseable { scope.cancel() }
    }

    /** Calls on the executor, and waits for it. */
    private suspend fun call(scope: CoroutineScope, what: () -> Unit) {
        val done = CompletableDeferred<Result<Unit>>()
        executor.execute { if (scope.isActive) done.complete(runCatching(what)) }
        while (true) {
            withTimeoutOrNull(LOOK_AGAIN_MS) { done.await() }?.let { return it.getOrThrow() }
            // `shutdownNow` forgets what it had accepted
            if ((executor as? ExecutorService)?.isTerminated == true && !done.isCompleted) {
                throw RejectedExecutionException("the executor was shut down")
            }
        }
    }

    private companion object {
        const val LOOK_AGAIN_MS = 1000L
    }
}
