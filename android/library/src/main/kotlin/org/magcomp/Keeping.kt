package org.magcomp

import kotlinx.coroutines.CoroutineScope
import kotlinx.coroutines.Job
import kotlinx.coroutines.launch
import kotlinx.coroutines.withTimeoutOrNull

/**
 * Calls a store, one call at a time, and knows what it said. With a [scope] its calls are there, and nobody waits for them who does not ask
 * to; without, they are where they are asked for.
 *
 * @param T what tells two texts apart
 */
internal class Keeping<T : Any>(private val store: CalibrationStore, private val scope: CoroutineScope?) {
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

    /** Waits for all calls so far, no longer than so many nanoseconds of a clock. */
    suspend fun settled(atMostNs: Long = Long.MAX_VALUE, nowNs: () -> Long = System::nanoTime) {
        val all = synchronized(this) { latest } ?: return
        val beganNs = nowNs()
        while (all.isActive && nowNs() - beganNs < atMostNs) withTimeoutOrNull(LOOK_AGAIN_MS) { all.join() }
    }

    private fun call(what: () -> Unit) {
        if (scope == null) return told(what)
        synchronized(this) {
            val before = latest
            latest = scope.launch {
                before?.join()
                told(what)
            }
        }
    }

    private fun told(what: () -> Unit) = try {
        what()
        error = null
    } catch (e: Exception) {
        error = e
    }

    private companion object {
        const val LOOK_AGAIN_MS = 20L
    }
}
