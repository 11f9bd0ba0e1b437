package org.magcomp.sample

import android.app.Activity
import android.os.Bundle
import android.os.Handler
import android.os.Looper
import java.util.concurrent.Executor
import org.magcomp.CompassListener
import org.magcomp.Compass
import org.magcomp.CompensatedReading
import org.magcomp.MagcompException
import org.magcomp.SensorException
import org.magcomp.headingFrame

/** One screen: the compass rose, and beside it what the library says of itself. */
class CompassActivity : Activity(), CompassListener {
    private lateinit var view: CompassView
    private val compass: Compass get() = (application as SampleApp).compass
    private val mainThread = Handler(Looper.getMainLooper()).let { handler -> Executor { handler.post(it) } }
    private var running: AutoCloseable? = null

    override fun onCreate(saved: Bundle?) {
        super.onCreate(saved)
        view = CompassView(this)
        setContentView(view)
    }

    override fun onStart() {
        super.onStart()
        running = compass.start(mainThread, this)
    }

    override fun onStop() {
        running?.close()
        super.onStop()
    }

    override fun onReading(reading: CompensatedReading) {
        // looked at again and again, as a screen that turns upside down restarts no activity
        @Suppress("DEPRECATION") // its successor needs API 30
        compass.frame = headingFrame(windowManager.defaultDisplay.rotation)
        view.show(reading)
    }

    override fun onEnd(error: Exception?) {
        view.explain(
            when (error) {
                is SensorException -> error.message
                is MagcompException -> error.text()
                else -> error?.toString()
            },
        )
    }
}
