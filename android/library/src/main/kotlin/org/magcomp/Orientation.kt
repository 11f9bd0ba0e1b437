@file:JvmName("Attitudes")

package org.magcomp

import android.view.Surface
import kotlin.math.asin
import kotlin.math.atan2
import org.magcomp.core.*

/**
 * The attitude as Android's `SensorManager.getRotationMatrix` writes it: nine numbers, row by row, which take a vector of the device to
 * east, north, up. North is magnetic. `SensorManager.remapCoordinateSystem` and `getOrientation` take it.
 */
public fun DeviceAttitude.rotationMatrix(): FloatArray = FloatArray(9).also { matrix -> rows().forEachIndexed { k, value -> matrix[k] = value.toFloat() } }

/**
 * Azimuth, pitch and roll as Android's `SensorManager.getOrientation` has them, but in degrees.
 *
 * @property azimuthDeg from magnetic north to the top of the screen, clockwise, -180 to 180; nothing is known of it where the top points
 *   straight up or down: then prefer [MagneticReading.heading]
 * @property pitchDeg how far the top of the screen points below the horizon, -90 to 90
 * @property rollDeg how far the left edge is raised, -180 to 180
 */
public class Orientation internal constructor(public val azimuthDeg: Double, public val pitchDeg: Double, public val rollDeg: Double) {
    /** For logs. */
    override fun toString(): String = "Orientation(azimuthDeg=$azimuthDeg, pitchDeg=$pitchDeg, rollDeg=$rollDeg)"
}

/**
 * Azimuth, pitch and roll of the screen.
 *
 * @param screenRotation how far the screen has turned, as Android's `remapCoordinateSystem` is used for it; 0: those of the device
 */
@JvmOverloads
public fun DeviceAttitude.orientation(screenRotation: ScreenRotation = ScreenRotation.DEG0): Orientation {
    val r = rows()
    // the screen's right and top are the device's x and y, turned
    val (cosine, sine) = when (screenRotation) {
        ScreenRotation.DEG0 -> Pair(1, 0)
        ScreenRotation.DEG90 -> Pair(0, 1)
        ScreenRotation.DEG180 -> Pair(-1, 0)
        ScreenRotation.DEG270 -> Pair(0, -1)
    }
    fun right(row: Int) = cosine * r[3 * row] - sine * r[3 * row + 1]
    fun top(row: Int) = sine * r[3 * row] + cosine * r[3 * row + 1]
    return Orientation(
        azimuthDeg = Math.toDegrees(atan2(top(0), top(1))),
        // rounding may take it beyond 1
        pitchDeg = Math.toDegrees(asin((-top(2)).coerceIn(-1.0, 1.0))),
        rollDeg = Math.toDegrees(atan2(-right(2), r[8])),
    )
}

/**
 * How far the screen has turned, for [Compass.headings].
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

/** Of the unit quaternion. */
private fun DeviceAttitude.rows() = doubleArrayOf(
    1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
    2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
    2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y),
)
