package app

import android.app.Activity
import android.app.Application
import android.app.Service
import android.content.Intent
import android.os.Bundle
import android.os.IBinder
import android.widget.TextView
import kotlinx.coroutines.CoroutineScope
import kotlinx.coroutines.Dispatchers
import kotlinx.coroutines.Job
import kotlinx.coroutines.SupervisorJob
import kotlinx.coroutines.cancel
import kotlinx.coroutines.launch
import org.magcomp.Compass
import org.magcomp.CompassReading
import org.magcomp.CompassState
import org.magcomp.screenRotation

/** Keeps the one compass. */
class App : Application() {
    val compass by lazy { Compass(this) }
}

/** Shows the compass while it is on screen. */
open class CompassActivity : Activity() {
    lateinit var label: TextView
    var shown = 0
    var latest: CompassReading? = null
    val compass get() = (application as App).compass
    private val scope = CoroutineScope(Dispatchers.Main.immediate + SupervisorJob())
    private var job: Job? = null

    override fun onCreate(saved: Bundle?) {
        super.onCreate(saved)
        label = TextView(this)
        setContentView(label)
    }

    override fun onStart() {
        super.onStart()
        job = scope.launch {
            compass.states { rotation() }.collect { state ->
                shown += 1
                label.text = when (state) {
                    is CompassState.Ended -> state.error?.message
                    is CompassState.Live -> {
                        val reading = state.reading.also { latest = it }
                        reading.headingDeg?.let { "$it deg, give or take ${reading.headingSigmaDeg}" } ?: reading.status.text()
                    }
                    CompassState.Waiting -> ""
                }
            }
        }
    }

    @Suppress("DEPRECATION") // its successor needs API 30
    fun rotation() = screenRotation(windowManager.defaultDisplay.rotation)

    override fun onStop() {
        job?.cancel()
        super.onStop()
    }

    override fun onDestroy() {
        scope.cancel()
        super.onDestroy()
    }
}

class OtherActivity : CompassActivity()

/** Goes on in the background, where the system ends the events of the sensors. */
class CompassService : Service() {
    val readings = java.util.concurrent.CopyOnWriteArrayList<CompassReading>()
    private val scope = CoroutineScope(Dispatchers.Main + SupervisorJob())

    override fun onCreate() {
        super.onCreate()
        scope.launch { (application as App).compass.headings().collect { readings += it } }
    }

    override fun onDestroy() {
        scope.cancel()
        super.onDestroy()
    }

    override fun onBind(intent: Intent?): IBinder? = null
}
