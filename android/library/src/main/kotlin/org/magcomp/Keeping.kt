package org.magcomp

import java.util.concurrent.ExecutionException
import kotlinx.coroutines.CoroutineScope
import kotlinx.coroutines.CoroutineStart
import kotlinx.coroutines.Job
import kotlinx.coroutines.launch
import kotlinx.coroutines.withTimeoutOrNull

/**
 * Calls a store, one call at a time, and knows what it said. Nobody waits for its calls who does not ask to.
 *
 * @param T tells two texts apart
 * @param scope where the store is called
 */
internal class Keeping<T : Any>(private val store: CalibrationStore, private val scope: CoroutineScope) {
    /** What the store keeps, as far as it is known. */
    @Volatile
    var kept: T? = null

    /** What it threw last; null after a call that went well. */
    @Volatile
    var error: Exception? = null

    private var loaded: String? = null
    private var latest: Job? = null

    /** Whether a call is under way. */
    val isBusy: Boolean @Synchronized get() = latest?.isActive == true

    fun load() = call { store.load().let { synchronized(this) { loaded = it } } }

    /** The text that was loaded, once. */
    @Synchronized
    fun takeLoaded(): String? = loaded.also { loaded = null }

    fun save(text: String, of: T) = call {
        store.save(text)
        kept = of
    }

    /** Waits for all calls so far, no longer than so many milliseconds. */
    suspend fun settled(atMostMs: Long = Long.MAX_VALUE) {
        val all = synchronized(this) { latest } ?: return
        withTimeoutOrNull(atMostMs) { all.join() }
    }

    private fun call(what: () -> Unit) {
        val before = synchronized(this) { latest }
        val job = scope.launch(start = CoroutineStart.LAZY) {
            before?.join()
            // whatever a store throws: nobody above would hear of it before the app ended
            error = runCatching(what).exceptionOrNull()?.asException()
        }
        synchronized(this) { latest = job }
        // outside: the store may be called in it
        job.start()
    }
}

/** The same, or that it was the cause: for whom an [Error] would end. */
internal fun Throwable.asException(): Exception = this as? Exception ?: ExecutionException(this)
