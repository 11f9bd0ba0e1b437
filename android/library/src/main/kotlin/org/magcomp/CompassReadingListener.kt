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
     * There are no more readings, because the source ended or for this error: a [SensorException], a
     * [RecordingException], a [java.io.IOException] of a recording's file, a [MagcompException], a [NativeLibraryException],
     * or what the source or [onReading] threw; an [Error] is the cause of an [ExecutionException]. Not called after closing.
     *
     * An executor that was shut down gets no call: with a [RejectedExecutionException] this one comes on a thread of the compass. One that
     * forgets what it has accepted, as after `shutdownNow`, is waited for until the [CompassHandle] is closed: close it first.
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
     * The heading, or the latest reading, whose [CompassReading.text] says why there is none, or null where no reading came; or else the
     * error, as of [CompassReadingListener.onEnd]. Called once; not after closing.
     */
    public fun onHeading(reading: CompassReading?, error: Exception?)
}

/** What a Java app implements to know when a recording has ended. */
public fun interface RecordingCallback {
    /** The file is whole now, also after closing; or the error, such as a [java.io.IOException]. Called once. */
    public fun onEnd(file: File, error: Exception?)
}

/** A use of a [Compass] by Java, until it is closed. */
public class CompassHandle internal constructor(private val end: () -> Unit) : AutoCloseable {
    /** Ends it. A call of the listener that is under way is finished; none follows. Any thread may call it, also twice. */
    override fun close(): Unit = end()
}

/**
 * Does [what] for a listener, and gives [end] what it answered, or the error, on the executor. Closing ends it at once, whatever the executor does.
 * No thread that delivers calls [end].
 *
 * @param isToldOfClosing whether [end] gets neither when the handle was closed; else it is not called then
 */
@OptIn(ExperimentalCoroutinesApi::class) // getCompleted
internal fun <T> Handover.listening(executor: Executor, end: (T?, Exception?) -> Unit, isToldOfClosing: Boolean = false, what: suspend () -> T): CompassHandle {
    val isClosed = AtomicBoolean()
    // it hands over to the executor and does no work of its own: so no work of others holds it up
    val work = CoroutineScope(Dispatchers.Unconfined).async { what() }
    work.invokeOnCompletion { error ->
        val told = if (isClosed.get()) null else error?.asException()
        val answer = if (error == null) work.getCompleted() else null
        try {
            executor.execute { run { if (isToldOfClosing || !isClosed.get()) end(answer, told) } }
        } catch (e: RejectedExecutionException) {
            run { if (isToldOfClosing || !isClosed.get()) end(answer, told ?: e) }
        }
    }
    return CompassHandle {
        isClosed.set(true)
        work.cancel()
    }
}

/** Calls on the executor, and waits for it. Whatever [what] throws is thrown here. Not called where this was cancelled before its turn. */
internal suspend fun Executor.call(handover: Handover, what: () -> Unit): Unit = suspendCancellableCoroutine { waiting ->
    execute { handover.run { if (waiting.isActive) waiting.resumeWith(runCatching(what)) } }
}
