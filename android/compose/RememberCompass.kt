// Copy this file into an app with Compose and `androidx.lifecycle:lifecycle-runtime-compose`. It is no artifact of its own.
package org.magcomp.compose

import android.content.Context
import android.view.WindowManager
import androidx.compose.runtime.Composable
import androidx.compose.runtime.State
import androidx.compose.runtime.produceState
import androidx.compose.ui.platform.LocalContext
import androidx.lifecycle.Lifecycle
import androidx.lifecycle.compose.LocalLifecycleOwner
import androidx.lifecycle.repeatOnLifecycle
import kotlinx.coroutines.CancellationException
import org.magcomp.Compass
import org.magcomp.CompassState
import org.magcomp.screenRotation

/**
 * The readings of a compass while the screen is on, in the frame of the screen as it is turned. The sensors rest while it is not.
 *
 * ```
 * val compass = rememberCompass((LocalContext.current.applicationContext as App).compass)
 * val heading = compass.value.reading?.headingDeg // null: reading.text(resources) says why
 * ```
 *
 * @param compass one for the app's whole life, of its `Application` or of a `ViewModel`: it keeps what it has learned
 * @param displayRotation `Display.getRotation()`, asked with every reading, as a screen that turns upside down recomposes nothing
 */
@Composable
public fun rememberCompass(compass: Compass, displayRotation: () -> Int = rotationOf(LocalContext.current)): State<CompassState> {
    val owner = LocalLifecycleOwner.current
    return produceState(CompassState(), compass, owner) {
        owner.repeatOnLifecycle(Lifecycle.State.STARTED) {
            try {
                compass.headings().collect {
                    compass.screenRotation = screenRotation(displayRotation())
                    value = CompassState(it)
                }
            } catch (e: CancellationException) {
                throw e
            } catch (e: Exception) {
                value = CompassState(error = e)
            }
        }
    }
}

@Suppress("DEPRECATION") // its successor needs API 30
private fun rotationOf(context: Context): () -> Int = { (context.getSystemService(Context.WINDOW_SERVICE) as WindowManager).defaultDisplay.rotation }
