package org.magcomp.sample

import android.annotation.SuppressLint
import android.content.Intent
import android.hardware.SensorManager
import android.location.LocationManager
import android.os.Bundle
import android.os.Looper
import androidx.activity.ComponentActivity
import androidx.activity.compose.setContent
import androidx.activity.enableEdgeToEdge
import androidx.activity.result.contract.ActivityResultContracts
import androidx.compose.foundation.layout.safeDrawingPadding
import androidx.compose.runtime.getValue
import androidx.compose.runtime.mutableStateOf
import androidx.compose.runtime.setValue
import androidx.compose.runtime.snapshotFlow
import androidx.compose.ui.Modifier
import androidx.compose.ui.res.stringResource
import androidx.core.content.FileProvider
import androidx.lifecycle.Lifecycle
import androidx.lifecycle.compose.collectAsStateWithLifecycle
import androidx.lifecycle.lifecycleScope
import androidx.lifecycle.repeatOnLifecycle
import java.io.File
import kotlinx.coroutines.awaitCancellation
import kotlinx.coroutines.flow.collectLatest
import kotlinx.coroutines.launch
import org.magcomp.Compass
import org.magcomp.screenRotation

/** Glue alone: what the screen says is [ScreenModel]'s. */
class CompassActivity : ComponentActivity() {
    private var state by mutableStateOf(ScreenState())
    private var isHelped by mutableStateOf(false)
    private val asked = registerForActivityResult(ActivityResultContracts.RequestMultiplePermissions()) { isHelped = CourseHelp.isAllowed(it) }

    override fun onCreate(saved: Bundle?) {
        super.onCreate(saved)
        enableEdgeToEdge()
        val (compass, recording) = (application as SampleApp).run { Pair(compass, recording) }
        val system = SystemHeading(getSystemService(SENSOR_SERVICE) as SensorManager)
        val model = ScreenModel(resources)
        setContent {
            val letters = listOf(R.string.north, R.string.east, R.string.south, R.string.west).map { stringResource(it) }
            val course = ScreenSwitch(isHelped, stringResource(if (isHelped) R.string.course_on else R.string.course_off)) { isWanted ->
                if (isWanted) asked.launch(CourseHelp.PERMISSIONS) else isHelped = false
            }
            val now by recording.state.collectAsStateWithLifecycle()
            val share = now.file?.let { file -> ScreenButton(stringResource(R.string.share)) { share(file) } }
            val switches = listOf(course, ScreenSwitch(now.isOn, now.text, recording::set))
            CompassScreen(state, letters, insets = Modifier.safeDrawingPadding(), switches = switches, buttons = listOfNotNull(share))
        }
        lifecycleScope.launch {
            repeatOnLifecycle(Lifecycle.State.STARTED) { snapshotFlow { isHelped }.collectLatest { if (it) help(compass) } }
        }
        lifecycleScope.launch {
            repeatOnLifecycle(Lifecycle.State.STARTED) {
                system.start()
                try {
                    // looked at again and again, as a screen that turns upside down restarts no activity
                    @Suppress("DEPRECATION") // its successor needs API 30
                    fun rotation() = windowManager.defaultDisplay.rotation.also { system.displayRotation = it }
                    model.states(compass, system.headingDeg) { screenRotation(rotation()) }.collect { state = it }
                } finally {
                    system.stop()
                }
            }
        }
    }

    private fun share(file: File) {
        val uri = FileProvider.getUriForFile(this, "org.magcomp.sample.recordings", file)
        val send = Intent(Intent.ACTION_SEND).setType("application/gzip").putExtra(Intent.EXTRA_STREAM, uri).addFlags(Intent.FLAG_GRANT_READ_URI_PERMISSION)
        startActivity(Intent.createChooser(send, getString(R.string.share)))
    }

    @SuppressLint("MissingPermission") // the switch asked for it
    private suspend fun help(compass: Compass) {
        val locations = getSystemService(LOCATION_SERVICE) as LocationManager
        if (LocationManager.GPS_PROVIDER !in locations.allProviders) return
        val listener = CourseHelp(compass)
        locations.requestLocationUpdates(LocationManager.GPS_PROVIDER, 1000L, 0f, listener, Looper.getMainLooper())
        try {
            awaitCancellation()
        } finally {
            locations.removeUpdates(listener)
        }
    }
}
