package app

import android.content.Context
import android.hardware.Sensor
import android.hardware.SensorManager
import android.os.Looper
import android.os.SystemClock
import java.util.Random
import kotlin.math.cos
import kotlin.math.sin
import kotlin.math.sqrt
import org.robolectric.Shadows.shadowOf
import org.robolectric.shadows.SensorEventBuilder
import org.robolectric.shadows.ShadowSensor

/** A phone with a hard iron of (30, -20, 10) uT that is turned about in a room, or lies still; 100 Hz. */
class Phone(context: Context, types: List<Int> = ALL) {
    private val shadow = shadowOf(context.getSystemService(Context.SENSOR_SERVICE) as SensorManager)
    private val sensors = types.associateWith { ShadowSensor.newInstance(it).also(shadow::addSensor) }
    private var steps = 0L
    private var q = doubleArrayOf(1.0, 0.0, 0.0, 0.0)
    private val random = Random(1)
    private val nowMs get() = 1000 + 10 * steps

    val listeners get() = shadow.listeners.toList()

    fun registered(listener: android.hardware.SensorEventListener) = sensors.filterValues { shadow.hasListener(listener, it) }.keys

    /** A vector of the world in the device. */
    private fun seen(v: DoubleArray): FloatArray {
        val (w, x, y, z) = q.toList()
        val r = doubleArrayOf(
            1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
            2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
            2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y),
        )
        return FloatArray(3) { c -> (r[c] * v[0] + r[3 + c] * v[1] + r[6 + c] * v[2]).toFloat() }
    }

    private fun send(type: Int, values: FloatArray) {
        val sensor = sensors[type] ?: return
        val event = SensorEventBuilder.newBuilder().setSensor(sensor).setTimestamp(nowMs * 1_000_000).setValues(values).build()
        shadow.sendSensorEventToListeners(event, sensor)
    }

    /** Time passes without an event, as it does while an app is in the background. */
    fun rest(ms: Long) {
        steps += ms / 10
        SystemClock.setCurrentTimeMillis(nowMs)
        shadowOf(Looper.getMainLooper()).idle()
    }

    fun play(count: Int, isTurned: Boolean = true) = repeat(count) {
        steps += 1
        SystemClock.setCurrentTimeMillis(nowMs)
        val t = steps * 0.01
        val rate = if (isTurned) doubleArrayOf(1.5 * sin(0.9 * t), 1.5 * cos(0.7 * t), 1.2 * sin(0.5 * t + 1)) else DoubleArray(3)
        val (w, x, y, z) = q.toList()
        val h = 0.005
        q = doubleArrayOf(
            w - h * (x * rate[0] + y * rate[1] + z * rate[2]), x + h * (w * rate[0] + y * rate[2] - z * rate[1]),
            y + h * (w * rate[1] - x * rate[2] + z * rate[0]), z + h * (w * rate[2] + x * rate[1] - y * rate[0]),
        )
        val length = sqrt(q.sumOf { it * it })
        q = DoubleArray(4) { q[it] / length }
        val field = seen(doubleArrayOf(0.0, 20.0, -45.0)).map { it + (0.3 * random.nextGaussian()).toFloat() }
        send(Sensor.TYPE_GYROSCOPE, FloatArray(3) { rate[it].toFloat() })
        for (type in listOf(Sensor.TYPE_GRAVITY, Sensor.TYPE_ACCELEROMETER)) send(type, seen(doubleArrayOf(0.0, 0.0, 9.81)))
        send(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, FloatArray(6) { if (it < 3) field[it] + HARD_IRON[it] else HARD_IRON[it - 3] })
        send(Sensor.TYPE_MAGNETIC_FIELD, field.toFloatArray())
        shadowOf(Looper.getMainLooper()).idle()
    }

    companion object {
        val ALL = listOf(
            Sensor.TYPE_GYROSCOPE, Sensor.TYPE_GRAVITY, Sensor.TYPE_ACCELEROMETER, Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, Sensor.TYPE_MAGNETIC_FIELD,
        )
        private val HARD_IRON = floatArrayOf(30f, -20f, 10f)
    }
}
