package org.magcomp

import android.os.Handler
import android.os.HandlerThread

/** The thread that a run's events are delivered on, and estimated: no work of the app holds it up. */
internal class SensorThread {
    private val thread = HandlerThread("magcomp").apply { start() }
    val handler = Handler(thread.looper)

    /** Calls [what] on it again and again until it ends. This clock stands while the phone sleeps. */
    fun every(periodMs: Long, what: () -> Unit) {
        handler.postDelayed(
            {
                what()
                every(periodMs, what)
            },
            periodMs,
        )
    }

    /** What is delivered already is done first, if this is asked elsewhere. */
    fun end() {
        thread.quitSafely()
    }
}
