package org.magcomp

import android.content.Context
import android.content.pm.PackageManager
import android.hardware.Sensor
import android.hardware.SensorEvent
import android.hardware.SensorEventListener
import android.hardware.SensorManager
import android.os.Build
import android.os.Handler
import android.os.HandlerThread
import kotlinx.coroutines.channels.Channel
import kotlinx.coroutines.channels.SendChannel
import kotlinx.coroutines.channels.awaitClose
import kotlinx.coroutines.flow.Flow
import kotlinx.coroutines.flow.buffer
import kotlinx.coroutines.flow.callbackFlow

/**
 * How the phone's sensors are asked.
 *
 * @property rateHz events a second of each sensor, 1 to 1000; the system takes it as a wish. Above 200 Hz Android 12 and
 *   newer want the permission `android.permission.HIGH_SAMPLING_RATE_SENSORS`. Default 100
 * @property maxReportLatencyUs how long the system may collect events before it delivers them, microseconds; more saves
 *   power and delays readings; from about 150 000 on it makes them worse too, as events come sensor by sensor. Default 0: at
 *   once
 * @property gyroscope whether the gyroscope is used where there is one. Default true
 * @property up whether gravity, else the accelerometer, is used; without it there is no heading. Default true
 */
public data class SensorOptions @JvmOverloads constructor(
    public val rateHz: Int = 100,
    public val maxReportLatencyUs: Int = 0,
    public val gyroscope: Boolean = true,
    public val up: Boolean = true,
) {
    init {
        require(rateHz in 1..1000) { "rateHz is $rateHz, expected 1 to 1000" }
        require(maxReportLatencyUs >= 0) { "maxReportLatencyUs is $maxReportLatencyUs, expected 0 or above" }
    }
}

/**
 * The phone's own sensors: the uncalibrated magnetometer (the calibrated one where there is no other), gravity (else
 * the accelerometer) and the gyroscope.
 *
 * Every collector of [samples] has its own thread and its own listener, which end with it. Collecting fails with
 * [SensorException] when a sensor or a permission is missing or the system refuses.
 */
public class SensorManagerSource internal constructor(
    private val sensors: SensorManager,
    private val options: SensorOptions,
    private val above200Hz: () -> Boolean,
    private val startThread: () -> EventThread,
) : MagneticFieldSource {

    /** The sensors of the phone behind a context, which is not kept. */
    @JvmOverloads
    public constructor(context: Context, options: SensorOptions = SensorOptions()) : this(
        context.getSystemService(Context.SENSOR_SERVICE) as SensorManager,
        options,
        mayExceed200Hz(context.applicationContext ?: context),
        { LooperThread() },
    )

    override fun samples(): Flow<SensorSample> = callbackFlow {
        val wanted = chosen()
        if (options.rateHz > FREE_RATE_HZ && !above200Hz()) throw SensorException.PermissionMissing(HIGH_RATE)
        val listener = Listener(channel)
        val thread = startThread()
        try {
            for (sensor in wanted) register(listener, sensor, thread.handler)
            awaitClose()
        } finally {
            sensors.unregisterListener(listener)
            thread.end()
        }
    }.buffer(Channel.UNLIMITED) // no event is dropped before the estimator

    private fun chosen(): List<Sensor> {
        val magnetometer = sensors.getDefaultSensor(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED)
            ?: sensors.getDefaultSensor(Sensor.TYPE_MAGNETIC_FIELD)
            ?: throw SensorException.Missing("magnetometer", "hide the compass")
        val wanted = mutableListOf(magnetometer)
        if (options.up) {
            wanted += sensors.getDefaultSensor(Sensor.TYPE_GRAVITY)
                ?: sensors.getDefaultSensor(Sensor.TYPE_ACCELEROMETER)
                ?: throw SensorException.Missing("accelerometer", "without a heading, use SensorOptions(up = false)")
        }
        if (options.gyroscope) sensors.getDefaultSensor(Sensor.TYPE_GYROSCOPE)?.let { wanted += it }
        return wanted
    }

    private fun register(listener: SensorEventListener, sensor: Sensor, handler: Handler?) {
        val periodUs = 1_000_000 / options.rateHz
        val accepted = try {
            sensors.registerListener(listener, sensor, periodUs, options.maxReportLatencyUs, handler)
        } catch (e: SecurityException) {
            throw SensorException.PermissionMissing(HIGH_RATE, e)
        } catch (e: IllegalStateException) {
            // what Android throws at the 129th listener of an app
            throw SensorException.Refused(nameOf(sensor.type), e.message, e)
        }
        if (!accepted) throw SensorException.Refused(nameOf(sensor.type))
    }

    /** Copies an event at once: Android uses it again for the next. */
    private class Listener(private val samples: SendChannel<SensorSample>) : SensorEventListener {
        override fun onSensorChanged(event: SensorEvent) {
            val v = event.values
            val xyz = Vector3(v[0].toDouble(), v[1].toDouble(), v[2].toDouble())
            val sample = when (event.sensor.type) {
                Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED -> {
                    val reported = Vector3(v[3].toDouble(), v[4].toDouble(), v[5].toDouble())
                    SensorSample.Magnetic(MagneticSample(event.timestamp, xyz, reported))
                }
                Sensor.TYPE_MAGNETIC_FIELD -> SensorSample.Magnetic(MagneticSample(event.timestamp, xyz))
                Sensor.TYPE_GYROSCOPE -> SensorSample.RotationRate(RotationRateSample(event.timestamp, xyz))
                Sensor.TYPE_GRAVITY, Sensor.TYPE_ACCELEROMETER -> SensorSample.Up(UpSample(event.timestamp, xyz))
                else -> return
            }
            // fails only when the collector has gone: then nobody wants it
            samples.trySend(sample)
        }

        override fun onAccuracyChanged(sensor: Sensor?, accuracy: Int) = Unit
    }

    /** The thread events are delivered on. */
    internal interface EventThread {
        val handler: Handler?

        fun end()
    }

    private class LooperThread : EventThread {
        private val thread = HandlerThread("magcomp").apply { start() }
        override val handler: Handler = Handler(thread.looper)

        override fun end() {
            thread.quitSafely()
        }
    }

    private companion object {
        const val FREE_RATE_HZ = 200
        const val HIGH_RATE = "android.permission.HIGH_SAMPLING_RATE_SENSORS"

        /** Android 12, for apps that target it. */
        const val RULE_SINCE_SDK = 31

        fun mayExceed200Hz(context: Context): () -> Boolean = {
            Build.VERSION.SDK_INT < RULE_SINCE_SDK ||
                context.applicationInfo.targetSdkVersion < RULE_SINCE_SDK ||
                context.packageManager.checkPermission(HIGH_RATE, context.packageName) == PackageManager.PERMISSION_GRANTED
        }

        fun nameOf(type: Int): String = when (type) {
            Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, Sensor.TYPE_MAGNETIC_FIELD -> "magnetometer"
            Sensor.TYPE_GYROSCOPE -> "gyroscope"
            Sensor.TYPE_GRAVITY -> "gravity sensor"
            else -> "accelerometer"
        }
    }
}
