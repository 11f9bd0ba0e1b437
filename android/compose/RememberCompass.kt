// Copy this file into an app with Compose and `androidx.lifecycle:lifecycle-runtime-compose`. It is no artifact of its own.
package org.magcomp.compose

import android.view.Surface
import android.view.View
import androidx.compose.runtime.Composable
import androidx.compose.runtime.State
import androidx.compose.runtime.produceState
import androidx.compose.ui.platform.LocalView
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
 * val state by rememberCompass((LocalContext.current.applicationContext as App).compass)
 * val headingDeg = (state as? CompassState.Live)?.reading?.headingDeg // null: reading.text(resources) says why
 * ```
 *
 * @param compass one for the app's whole life, of its `Application` or of a `ViewModel`: it keeps what it has learned
 * @param displayRotation `Display.getRotation()`, asked with every reading, as a screen that turns upside down recomposes nothing
 */
@Composable
public fun rememberCompass(compass: Compass, displayRotation: () -> Int = rotationOf(LocalView.current)): State<CompassState> {
    val owner = LocalLifecycleOwner.current
    return produceState<CompassState>(CompassState.Waiting, compass, owner) {
        owner.repeatOnLifecycle(Lifecycle.State.STARTED) {
            try {
                compass.headings().collect {
                    val rotation = screenRotation(displayRotation())
                    if (rotation != compass.screenRotation) compass.screenRotation = rotation
                    value = CompassState.Live(it)
                }
                value = CompassState.Ended(null)
            } catch (e: CancellationException) {
                throw e
            } catch (e: Exception) {
                value = CompassState.Ended(e)
            }
        }
    }
}

/** Of the display that the view is on, which need not be the phone's first. */
private fun rotationOf(view: View): () -> Int = { view.display?.rotation ?: Surface.ROTATION_0 }
