package org.magcomp

import java.util.concurrent.Executor
import kotlin.coroutines.intrinsics.COROUTINE_SUSPENDED
import kotlin.coroutines.intrinsics.intercepted
import kotlin.coroutines.intrinsics.suspendCoroutineUninterceptedOrReturn
import kotlin.coroutines.resume
import kotlinx.coroutines.Dispatchers
import kotlinx.coroutines.asExecutor

/**
 * Takes an app's code off the thread that delivers to all users of a source. A collector on `Dispatchers.Unconfined`, or a listener whose
 * executor runs at once, would run there, and hold all others up.
 *
 * @param executor runs such code instead
 */
internal class Handover(val executor: Executor = Dispatchers.IO.asExecutor()) {
    private val delivers = ThreadLocal<Boolean>()

    /** This thread delivers, from now on. */
    fun isDelivering() {
        if (delivers.get() == null) delivers.set(true)
    }

    /** Does something here, or on another thread if this one delivers. */
    fun run(what: Runnable) = if (delivers.get() != null) executor.execute(what) else what.run()

    /** Returns on another thread, if this one delivers: also where that is quicker than this one, which a `suspendCoroutine` would then go on with. */
    suspend fun away() {
        if (delivers.get() == null) return
        suspendCoroutineUninterceptedOrReturn<Unit> {
            val there = it.intercepted()
            executor.execute { there.resume(Unit) }
            COROUTINE_SUSPENDED
        }
    }
}
