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
import android.os.SystemClock
import java.util.concurrent.atomic.AtomicIntegerArray
import kotlinx.coroutines.coroutineScope
import kotlinx.coroutines.delay
import kotlinx.coroutines.flow.Flow
import kotlinx.coroutines.flow.MutableStateFlow
import kotlinx.coroutines.flow.StateFlow
import kotlinx.coroutines.flow.asStateFlow
import kotlinx.coroutines.flow.flow
import kotlinx.coroutines.flow.map
import kotlinx.coroutines.flow.update
import kotlinx.coroutines.launch

/**
 * How the phone's sensors are asked.
 *
 * @property rateHz events a second of each sensor, 1 to 1000; the system takes it as a wish. Above 200 Hz Android 12 and
 *   newer want the permission `android.permission.HIGH_SAMPLING_RATE_SENSORS`. Default 100
 * @property maxReportLatencyUs how long the system may collect events before it delivers them, microseconds; more saves
 *   power and delays readings; above 200 000 it makes them worse too, as events come sensor by sensor and wait for each other for
 *   0.25 s at the most. Default 0: at once
 * @property gyroscope whether the gyroscope is used where there is one and the system delivers it. Default true
 * @property up whether gravity, else the accelerometer, is used; without it there is no heading. Default true
 * @property holdS longest that an event waits for those of the other sensors, so that all go in the order of their times, 0 to
 *   0.25 s (see [EventQueue]); 0: as they are delivered. Default 0.05 beyond [maxReportLatencyUs], at most 0.25
 */
public data class SensorOptions @JvmOverloads constructor(
    public val rateHz: Int = 100,
    public val maxReportLatencyUs: Int = 0,
    public val gyroscope: Boolean = true,
    public val up: Boolean = true,
    public val holdS: Double = minOf(EventQueue.DEFAULT_HOLD_S + maxReportLatencyUs * 1e-6, EventQueue.LONGEST_HOLD_S),
) {
    init {
        require(rateHz in 1..1000) { "rateHz is $rateHz, expected 1 to 1000" }
        require(holdS in 0.0..EventQueue.LONGEST_HOLD_S) { "holdS is $holdS, expected 0 to ${EventQueue.LONGEST_HOLD_S}" }
        require(maxReportLatencyUs >= 0) { "maxReportLatencyUs is $maxReportLatencyUs, expected 0 or above" }
    }
}

/**
 * The phone's own sensors: the uncalibrated magnetometer (the calibrated one where there is no other), gravity (else
 * the accelerometer) and the gyroscope.
 *
 * Every collector of [samples] has its own thread and its own listener, which end with it. Collecting fails with
 * [SensorException] when a sensor or a permission is missing or the system refuses. Without a gyroscope it goes on, and
 * [sensors] says why. Events arrive in the order of their times ([SensorOptions.holdS]). A sensor that is registered and delivers
 * nothing is told in [UsedSensor.isSilent]; where gravity alone is silent, the accelerometer takes its place.
 */
public class SensorManagerSource internal constructor(
    private val manager: SensorManager,
    private val options: SensorOptions,
    private val continuousNs: () -> Long,
    private val silenceMs: Long = SILENCE_MS,
    private val above200Hz: () -> Boolean,
) : MagneticFieldSource {

    /** The sensors of the phone behind a context; the context itself is not kept, only that of its application. */
    @JvmOverloads
    public constructor(context: Context, options: SensorOptions = SensorOptions()) : this(
        // of the application: the manager keeps its context
        applicationOf(context).getSystemService(Context.SENSOR_SERVICE) as SensorManager,
        options,
        SystemClock::elapsedRealtimeNanos,
        above200Hz = mayExceed200Hz(applicationOf(context)),
    )

    private val inUse = MutableStateFlow<SensorsInUse?>(null)

    override val sensors: StateFlow<SensorsInUse?> = inUse.asStateFlow()

    /** Android's `Sensor.getMaximumRange`; null where a driver says less than 100 or more than 100 000 microtesla, which is no full scale. */
    override val fullScaleUt: Double?
        get() = magnetometer()?.maximumRange?.toDouble()?.takeIf { it in LEAST_FULL_SCALE_UT..LARGEST_FULL_SCALE_UT }

    private val sleep = Sleep()

    /** Android's times count sleep on most phones; on those whose sensors count without it, it is seen beside `elapsedRealtimeNanos`. */
    override val hiddenS: Double get() = sleep.hiddenS

    /** The same for most phones. */
    override fun eventTimeNs(elapsedRealtimeNs: Long): Long = elapsedRealtimeNs - sleep.behindNs

    override fun samples(): Flow<SensorSample> = events(isEager = true).map { it.toSample() }

    /** The same in objects that are used again; see [Inbox]. */
    internal fun events(isEager: Boolean): Flow<RawEvent> = flow {
        val magnetometer = magnetometer()
            ?: throw SensorException.Missing("magnetometer", "hide the compass")
        val up = if (options.up) up() else null
        val gyroscope = if (options.gyroscope) manager.getDefaultSensor(Sensor.TYPE_GYROSCOPE) else null
        if (options.rateHz > FREE_RATE_HZ && !above200Hz()) throw SensorException.PermissionMissing(HIGH_RATE)
        val inbox = Inbox(options.holdS, isEager)
        val listener = Listener(inbox)
        val thread = LooperThread()
        try {
            val without = when {
                !options.gyroscope -> "the gyroscope was not asked for"
                gyroscope == null -> "this phone has no gyroscope"
                else -> null
            }
            // before the first event
            inUse.value = SensorsInUse(used(magnetometer), up?.let(::used), gyroscope?.let(::used), without)
            register(listener, magnetometer, thread.handler)
            up?.let { register(listener, it, thread.handler) }
            try {
                gyroscope?.let { register(listener, it, thread.handler) }
            } catch (e: SensorException.Refused) {
                inUse.update { it?.copy(gyroscope = null, withoutGyroscope = e.message) }
            }
            coroutineScope {
                launch {
                    val silences = Silences(listener)
                    while (true) {
                        // this clock stands while the phone sleeps
                        delay((silenceMs + options.maxReportLatencyUs / 1000 + 1000 / options.rateHz) / LOOKS)
                        silences.look()
                        replaceGravity(listener, thread.handler)
                    }
                }
                inbox.takeAll { emit(it) }
            }
        } finally {
            manager.unregisterListener(listener)
            thread.end()
        }
    }

    private fun magnetometer(): Sensor? = manager.getDefaultSensor(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED)
        ?: manager.getDefaultSensor(Sensor.TYPE_MAGNETIC_FIELD)

    private fun up(): Sensor = manager.getDefaultSensor(Sensor.TYPE_GRAVITY)
        ?: manager.getDefaultSensor(Sensor.TYPE_ACCELEROMETER)
        ?: throw SensorException.Missing("accelerometer", "without a heading, use SensorOptions(up = false)")

    private fun register(listener: SensorEventListener, sensor: Sensor, handler: Handler) {
        val periodUs = 1_000_000 / options.rateHz
        val accepted = try {
            manager.registerListener(listener, sensor, periodUs, options.maxReportLatencyUs, handler)
        } catch (e: SecurityException) {
            if (options.rateHz > FREE_RATE_HZ) throw SensorException.PermissionMissing(HIGH_RATE, e)
            throw SensorException.Refused(nameOf(sensor.type), e.message, e, "let the app use this phone's sensors")
        } catch (e: IllegalStateException) {
            // what Android throws at the 129th listener of an app
            throw SensorException.Refused(nameOf(sensor.type), e.message, e)
        }
        if (!accepted) throw SensorException.Refused(nameOf(sensor.type))
    }

    /** The accelerometer for gravity where that is silent and another sensor is not; all are while the app is in the background. */
    private fun replaceGravity(listener: Listener, handler: Handler) {
        val now = inUse.value ?: return
        val gravity = now.up?.takeIf { it.type == Sensor.TYPE_GRAVITY && it.isSilent } ?: return
        if (now.magnetometer.isSilent && now.gyroscope?.isSilent != false) return
        val accelerometer = manager.getDefaultSensor(Sensor.TYPE_ACCELEROMETER) ?: return
        try {
            register(listener, accelerometer, handler)
        } catch (_: SensorException) {
            // gravity stays, and what is told of it
            return
        }
        manager.unregisterListener(listener, manager.getDefaultSensor(gravity.type))
        inUse.update { it?.copy(up = used(accelerometer)) }
    }

    /** Which sensors have delivered nothing at so many looks in a row. */
    private inner class Silences(private val listener: Listener) {
        private val heard = IntArray(TYPES)
        private val looks = IntArray(TYPES)

        fun look() {
            val used = inUse.value?.run { setOf(magnetometer.type, up?.type, gyroscope?.type) }.orEmpty()
            for (type in 0 until TYPES) {
                val events = listener.events.get(type)
                looks[type] = if (type in used && events == heard[type]) looks[type] + 1 else 0
                heard[type] = events
            }
            fun UsedSensor.told() = if (isSilent == (looks[type] >= LOOKS)) this else copy(isSilent = !isSilent)
            inUse.update { now ->
                now?.copy(magnetometer = now.magnetometer.told(), up = now.up?.told(), gyroscope = now.gyroscope?.told())
            }
        }
    }

    private fun used(sensor: Sensor) =
        UsedSensor(sensor.type, sensor.name.orEmpty(), sensor.vendor.orEmpty(), SensorAccuracy.UNKNOWN)

    /** Copies an event at once: Android uses it again for the next. */
    private inner class Listener(private val inbox: Inbox) : SensorEventListener {
        /** How many of each type came so far. */
        val events = AtomicIntegerArray(TYPES)
        private var bias: DeviceVector? = null

        override fun onSensorChanged(event: SensorEvent) {
            val v = event.values
            // an exception here would end the app; so it counts as none, and its sensor as silent
            if (v.size < 3) return
            val kind = when (event.sensor.type) {
                Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, Sensor.TYPE_MAGNETIC_FIELD -> RawEvent.MAGNETIC
                Sensor.TYPE_GYROSCOPE -> RawEvent.ROTATION_RATE
                Sensor.TYPE_GRAVITY, Sensor.TYPE_ACCELEROMETER -> RawEvent.UP
                else -> return
            }
            events.incrementAndGet(event.sensor.type)
            if (kind == RawEvent.MAGNETIC) sleep.see(event.timestamp, continuousNs())
            val reported = if (event.sensor.type == Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED && v.size >= 6) bias(v) else null
            inbox.put(kind, event.timestamp, v[0].toDouble(), v[1].toDouble(), v[2].toDouble(), reported)
        }

        /** The object of before where it is the same. Some phones deliver no bias, and 0 until they have found one. */
        private fun bias(v: FloatArray): DeviceVector? {
            if (v[3] == 0f && v[4] == 0f && v[5] == 0f) return null
            bias?.let { if (it.x == v[3].toDouble() && it.y == v[4].toDouble() && it.z == v[5].toDouble()) return it }
            return DeviceVector(v[3].toDouble(), v[4].toDouble(), v[5].toDouble()).also { bias = it }
        }

        override fun onAccuracyChanged(sensor: Sensor?, accuracy: Int) {
            fun UsedSensor.told() = if (type == sensor?.type) copy(accuracy = accuracyOf(accuracy)) else this
            inUse.update { now ->
                now?.copy(magnetometer = now.magnetometer.told(), up = now.up?.told(), gyroscope = now.gyroscope?.told())
            }
        }
    }

    /** The thread events are delivered on. */
    private class LooperThread {
        private val thread = HandlerThread("magcomp").apply { start() }
        val handler = Handler(thread.looper)

        fun end() {
            thread.quitSafely()
        }
    }

    private companion object {
        const val SILENCE_MS = 2000L

        /** As often it is looked within that time. */
        const val LOOKS = 4

        /** Android's types that are used are all less. */
        const val TYPES = Sensor.TYPE_GYROSCOPE_UNCALIBRATED
        // one that is less can't measure the Earth's field beside a phone's own
        const val LEAST_FULL_SCALE_UT = 100.0
        const val LARGEST_FULL_SCALE_UT = 100_000.0
        const val FREE_RATE_HZ = 200
        const val HIGH_RATE = "android.permission.HIGH_SAMPLING_RATE_SENSORS"

        /** Android 12, for apps that target it. */
        const val RULE_SINCE_SDK = 31

        fun mayExceed200Hz(context: Context): () -> Boolean = {
            Build.VERSION.SDK_INT < RULE_SINCE_SDK ||
                context.applicationInfo.targetSdkVersion < RULE_SINCE_SDK ||
                context.checkCallingOrSelfPermission(HIGH_RATE) == PackageManager.PERMISSION_GRANTED
        }

        /** There is none yet in an application's own constructor. */
        fun applicationOf(context: Context): Context = context.applicationContext ?: context

        fun accuracyOf(status: Int): SensorAccuracy = when (status) {
            SensorManager.SENSOR_STATUS_NO_CONTACT -> SensorAccuracy.NO_CONTACT
            SensorManager.SENSOR_STATUS_UNRELIABLE -> SensorAccuracy.UNRELIABLE
            SensorManager.SENSOR_STATUS_ACCURACY_LOW -> SensorAccuracy.LOW
            SensorManager.SENSOR_STATUS_ACCURACY_MEDIUM -> SensorAccuracy.MEDIUM
            SensorManager.SENSOR_STATUS_ACCURACY_HIGH -> SensorAccuracy.HIGH
            else -> SensorAccuracy.UNKNOWN
        }

        fun nameOf(type: Int): String = when (type) {
            Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, Sensor.TYPE_MAGNETIC_FIELD -> "magnetometer"
            Sensor.TYPE_GYROSCOPE -> "gyroscope"
            Sensor.TYPE_GRAVITY -> "gravity sensor"
            else -> "accelerometer"
        }
    }
}
