package org.magcomp.sample

import android.hardware.Sensor
import android.hardware.SensorEvent
import android.hardware.SensorEventListener
import android.hardware.SensorManager
import android.view.Surface
import kotlinx.coroutines.flow.MutableStateFlow
import kotlinx.coroutines.flow.StateFlow

/**
 * The system's own heading, degrees clockwise from magnetic north, of its rotation vector; of the direction between top edge and camera of
 * the screen as it is turned.
 */
class SystemHeading(private val sensors: SensorManager) : SensorEventListener {
    private val latest = MutableStateFlow<Double?>(null)
    private val matrix = FloatArray(9)

    val headingDeg: StateFlow<Double?> = latest

    /** `Display.getRotation()`. */
    @Volatile
    var displayRotation: Int = Surface.ROTATION_0

    fun start() {
        sensors.getDefaultSensor(Sensor.TYPE_ROTATION_VECTOR)?.let { sensors.registerListener(this, it, SensorManager.SENSOR_DELAY_UI) }
    }

    fun stop() = sensors.unregisterListener(this)

    override fun onSensorChanged(event: SensorEvent) {
        SensorManager.getRotationMatrixFromVector(matrix, event.values)
        latest.value = headingDeg(matrix, displayRotation)
    }

    override fun onAccuracyChanged(sensor: Sensor, accuracy: Int) = Unit
}

/** Of a matrix that takes a vector of the device to east, north, up, row by row. */
internal fun headingDeg(matrix: FloatArray, displayRotation: Int = Surface.ROTATION_0): Double? {
    val ofScreen = FloatArray(9)
    val (x, y) = when (displayRotation) {
        Surface.ROTATION_90 -> Pair(SensorManager.AXIS_Y, SensorManager.AXIS_MINUS_X)
        Surface.ROTATION_180 -> Pair(SensorManager.AXIS_MINUS_X, SensorManager.AXIS_MINUS_Y)
        Surface.ROTATION_270 -> Pair(SensorManager.AXIS_MINUS_Y, SensorManager.AXIS_X)
        else -> Pair(SensorManager.AXIS_X, SensorManager.AXIS_Y)
    }
    SensorManager.remapCoordinateSystem(matrix, x, y, ofScreen)
    // x of the screen points right; what lies level and a quarter turn before it is ahead
    val (east, north) = Pair(-ofScreen[3].toDouble(), ofScreen[0].toDouble())
    if (Math.hypot(east, north) < 1e-3) return null
    return (Math.toDegrees(Math.atan2(east, north)) + 360) % 360
}
