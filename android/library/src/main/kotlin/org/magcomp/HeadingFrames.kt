@file:JvmName("HeadingFrames")

package org.magcomp

import android.view.Surface
import org.magcomp.core.ScreenRotation

/**
 * How far the screen has turned, for [Compass.screenRotation].
 *
 * @param displayRotation `Display.getRotation()`: `Surface.ROTATION_0` to `ROTATION_270`
 */
public fun screenRotation(displayRotation: Int): ScreenRotation = when (displayRotation) {
    Surface.ROTATION_0 -> ScreenRotation.DEG0
    Surface.ROTATION_90 -> ScreenRotation.DEG90
    Surface.ROTATION_180 -> ScreenRotation.DEG180
    Surface.ROTATION_270 -> ScreenRotation.DEG270
    else -> throw IllegalArgumentException("displayRotation is $displayRotation, expected Surface.ROTATION_0 to ROTATION_270")
}
