package org.magcomp.sample

import android.hardware.SensorManager
import android.os.Bundle
import androidx.activity.ComponentActivity
import androidx.activity.compose.setContent
import androidx.activity.enableEdgeToEdge
import androidx.compose.foundation.layout.safeDrawingPadding
import androidx.compose.runtime.getValue
import androidx.compose.runtime.mutableStateOf
import androidx.compose.runtime.setValue
import androidx.compose.ui.Modifier
import androidx.compose.ui.res.stringResource
import androidx.lifecycle.Lifecycle
import androidx.lifecycle.lifecycleScope
import androidx.lifecycle.repeatOnLifecycle
import kotlinx.coroutines.launch
import org.magcomp.screenRotation

/** Glue alone: what the screen says is [ScreenModel]'s. */
class CompassActivity : ComponentActivity() {
    private var state by mutableStateOf(ScreenState())

    override fun onCreate(saved: Bundle?) {
        super.onCreate(saved)
        enableEdgeToEdge()
        val compass = (application as SampleApp).compass
        val system = SystemHeading(getSystemService(SENSOR_SERVICE) as SensorManager)
        val model = ScreenModel(resources)
        setContent {
            val letters = listOf(R.string.north, R.string.east, R.string.south, R.string.west).map { stringResource(it) }
            CompassScreen(state, letters, insets = Modifier.safeDrawingPadding())
        }
        lifecycleScope.launch {
            repeatOnLifecycle(Lifecycle.State.STARTED) {
                system.start()
                try {
                    model.states(compass, system.headingDeg).collect {
                        state = it
                        // looked at again and again, as a screen that turns upside down restarts no activity
                        @Suppress("DEPRECATION") // its successor needs API 30
                        val rotation = windowManager.defaultDisplay.rotation
                        compass.screenRotation = screenRotation(rotation)
                        system.displayRotation = rotation
                    }
                } finally {
                    system.stop()
                }
            }
        }
    }
}
