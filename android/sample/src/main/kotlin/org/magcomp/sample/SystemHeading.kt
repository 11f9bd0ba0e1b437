package org.magcomp.sample

import android.hardware.Sensor
import android.hardware.SensorEvent
import android.hardware.SensorEventListener
import android.hardware.SensorManager
import kotlinx.coroutines.flow.MutableStateFlow
import kotlinx.coroutines.flow.StateFlow

/** The system's own heading, degrees clockwise from magnetic north, of its rotation vector; of the direction between top edge and camera. */
class SystemHeading(private val sensors: SensorManager) : SensorEventListener {
    private val latest = MutableStateFlow<Double?>(null)
    private val matrix = FloatArray(9)

    val headingDeg: StateFlow<Double?> = latest

    fun start() {
        sensors.getDefaultSensor(Sensor.TYPE_ROTATION_VECTOR)?.let { sensors.registerListener(this, it, SensorManager.SENSOR_DELAY_UI) }
    }

    fun stop() = sensors.unregisterListener(this)

    override fun onSensorChanged(event: SensorEvent) {
        SensorManager.getRotationMatrixFromVector(matrix, event.values)
        latest.value = headingDeg(matrix)
    }

    override fun onAccuracyChanged(sensor: Sensor, accuracy: Int) = Unit
}

/** Of a matrix that takes a vector of the device to east, north, up, row by row. */
internal fun headingDeg(matrix: FloatArray): Double? {
    // x of the device points right; what lies level and a quarter turn before it is ahead
    val (east, north) = Pair(-matrix[3].toDouble(), matrix[0].toDouble())
    if (Math.hypot(east, north) < 1e-3) return null
    return (Math.toDegrees(Math.atan2(east, north)) + 360) % 360
}
