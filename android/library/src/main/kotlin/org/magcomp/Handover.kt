package org.magcomp

import java.util.concurrent.Executor
import kotlin.coroutines.intrinsics.COROUTINE_SUSPENDED
import kotlin.coroutines.intrinsics.intercepted
import kotlin.coroutines.intrinsics.suspendCoroutineUninterceptedOrReturn
import kotlin.coroutines.resume
import kotlinx.coroutines.Dispatchers
import kotlinx.coroutines.asExecutor

/**
 * Takes an app's code off the threads that deliver to all users of a source or a compass. A collector on `Dispatchers.Unconfined`, or a listener
 * whose executor runs at once, would run there, and hold all others up.
 */
internal object Handover {
    /** Runs such code instead. Tests set another one. */
    @Volatile
    var executor: Executor = Dispatchers.IO.asExecutor()

    private val delivers = ThreadLocal<Boolean>()

    /** This thread delivers and does nothing else, from now on. */
    fun delivers() {
        if (delivers.get() == null) delivers.set(true)
    }

    /** This thread delivers while it does something: a thread of an app's own source has other work too. */
    inline fun delivering(what: () -> Unit) {
        val before = delivers.get()
        delivers.set(true)
        try {
            what()
        } finally {
            delivers.set(before)
        }
    }

    fun isDelivering(): Boolean = delivers.get() != null

    /** Does something here, or on another thread if this one delivers. */
    fun run(what: Runnable) = if (isDelivering()) executor.execute(what) else what.run()

    /** Returns on another thread, if this one delivers: also where that is quicker than this one, which a `suspendCoroutine` would then go on with. */
    suspend fun away() {
        if (!isDelivering()) return
        suspendCoroutineUninterceptedOrReturn<Unit> {
            val there = it.intercepted()
            executor.execute { there.resume(Unit) }
            COROUTINE_SUSPENDED
        }
    }
}
