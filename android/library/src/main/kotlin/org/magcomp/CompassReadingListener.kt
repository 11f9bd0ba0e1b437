package org.magcomp

import java.io.File
import java.util.concurrent.ExecutionException
import java.util.concurrent.Executor
import java.util.concurrent.RejectedExecutionException
import java.util.concurrent.atomic.AtomicBoolean
import kotlinx.coroutines.CoroutineScope
import kotlinx.coroutines.Dispatchers
import kotlinx.coroutines.ExperimentalCoroutinesApi
import kotlinx.coroutines.async
import kotlinx.coroutines.suspendCancellableCoroutine
import org.magcomp.core.*

/** What a Java app implements to get readings. */
public interface CompassReadingListener {
    /** One reading. */
    public fun onReading(reading: CompensatedReading)

    /**
     * There are no more readings: the source has ended, or there was this error. It is a [CompassException], a [java.io.IOException] of a
     * recording's file, or an exception of the source or of [onReading]. An [Error] is the cause of an [ExecutionException]. The compass does
     * not call this after the handle was closed.
     *
     * Where the executor was shut down, a thread of the compass calls this with a [RejectedExecutionException]. Close the [CompassHandle]
     * before `shutdownNow`: an executor that forgets what it has accepted is waited for until then.
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

/** What a Java app implements to get one heading. */
public fun interface HeadingCallback {
    /**
     * There is a heading; or the latest reading, whose [CompassReading.text] says why it has none; or null if no reading came; or the error,
     * as in [CompassReadingListener.onEnd]. The compass calls this once, and not after the handle was closed.
     */
    public fun onHeading(reading: CompassReading?, error: Exception?)
}

/** What a Java app implements to know when a recording has ended. */
public fun interface RecordingCallback {
    /** The file is whole now, or there was an error, such as a [java.io.IOException]. The compass calls this once, also after closing. */
    public fun onEnd(file: File, error: Exception?)
}

/** A use of a [Compass] by Java, until it is closed. */
public class CompassHandle internal constructor(private val end: () -> Unit) : AutoCloseable {
    /** Ends the use. A call of the listener that is under way goes on to its end, and none follows. Any thread may call this, also twice. */
    override fun close(): Unit = end()
}

/**
 * Does [what] for a listener, and gives [end] what it answered, or the error, on the executor. Closing ends it at once, whatever the executor does.
 * No thread that delivers calls [end].
 *
 * @param isToldOfClosing whether [end] gets neither when the handle was closed; else it is not called then
 */
@OptIn(ExperimentalCoroutinesApi::class) // getCompleted
internal fun <T> listening(executor: Executor, end: (T?, Exception?) -> Unit, isToldOfClosing: Boolean = false, what: suspend () -> T): CompassHandle {
    val isClosed = AtomicBoolean()
    // it hands over to the executor and does no work of its own: so no work of others holds it up
    val work = CoroutineScope(Dispatchers.Unconfined).async { what() }
    work.invokeOnCompletion { error ->
        val told = if (isClosed.get()) null else error?.asException()
        val answer = if (error == null) work.getCompleted() else null
        try {
            executor.execute { Handover.run { if (isToldOfClosing || !isClosed.get()) end(answer, told) } }
        } catch (e: RejectedExecutionException) {
            Handover.run { if (isToldOfClosing || !isClosed.get()) end(answer, told ?: e) }
        }
    }
    return CompassHandle {
        isClosed.set(true)
        work.cancel()
    }
}

/** Calls on the executor, and waits for it. Whatever [what] throws is thrown here. Not called where this was cancelled before its turn. */
internal suspend fun Executor.call(what: () -> Unit): Unit = suspendCancellableCoroutine { waiting ->
    execute { Handover.run { if (waiting.isActive) waiting.resumeWith(runCatching(what)) } }
}
