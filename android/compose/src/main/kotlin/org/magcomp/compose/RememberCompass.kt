package org.magcomp.compose

import android.view.Surface
import android.view.View
import androidx.compose.runtime.Composable
import androidx.compose.runtime.State
import androidx.compose.runtime.getValue
import androidx.compose.runtime.produceState
import androidx.compose.runtime.rememberUpdatedState
import androidx.compose.ui.platform.LocalView
import androidx.lifecycle.Lifecycle
import androidx.lifecycle.compose.LocalLifecycleOwner
import androidx.lifecycle.repeatOnLifecycle
import org.magcomp.Compass
import org.magcomp.CompassState
import org.magcomp.core.ReferenceAxis
import org.magcomp.screenRotation

/**
 * The readings of a compass while the screen is on, for the screen as it is turned. The sensors rest while it is not.
 *
 * ```
 * val state by rememberCompass((LocalContext.current.applicationContext as App).compass)
 * val headingDeg = (state as? CompassState.Live)?.reading?.headingDeg // null: reading.text(resources) says why
 * ```
 *
 * @param compass one for the app's whole life, of its `Application` or of a `ViewModel`: it keeps what it has learned
 * @param axis the axis of the device that the heading belongs to; null: that of the compass's config
 * @param displayRotation `Display.getRotation()`, asked with every reading, as a screen that turns upside down recomposes nothing
 */
@Composable
public fun rememberCompass(
    compass: Compass,
    axis: ReferenceAxis? = null,
    displayRotation: () -> Int = rotationOf(LocalView.current),
): State<CompassState> {
    val owner = LocalLifecycleOwner.current
    val rotation by rememberUpdatedState(displayRotation)
    return produceState<CompassState>(CompassState.Waiting, compass, axis, owner) {
        owner.repeatOnLifecycle(Lifecycle.State.STARTED) { compass.states(axis) { screenRotation(rotation()) }.collect { value = it } }
    }
}

/** Of the display that the view is on, which need not be the phone's first. */
private fun rotationOf(view: View): () -> Int = { view.display?.rotation ?: Surface.ROTATION_0 }
