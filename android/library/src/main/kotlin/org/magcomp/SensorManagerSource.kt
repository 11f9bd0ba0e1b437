package org.magcomp

import android.content.Context
import android.content.pm.PackageManager
import android.hardware.Sensor
import android.hardware.SensorManager
import android.os.Build
import android.os.SystemClock
import kotlinx.coroutines.flow.MutableStateFlow
import kotlinx.coroutines.flow.StateFlow
import kotlinx.coroutines.flow.asStateFlow
import org.magcomp.core.*

/**
 * The phone's own sensors: the uncalibrated magnetometer (the calibrated one where there is no other), gravity (else
 * the accelerometer) and the gyroscope.
 *
 * Any number of compasses and others may share one source. From the first to the last of them they have one listener and
 * one thread. Collecting fails with [SensorException] when a sensor or a permission is missing or the system refuses. Without a gyroscope
 * it goes on, and [sensors] says why. Events come in the order of their times ([SensorOptions.holdS]), on the magnetometer's clock: when a
 * sensor's events arrive shows within about a second whether it has another clock. [UsedSensor.isSilent] tells of a sensor that is registered
 * and delivers nothing. The accelerometer takes gravity's place where gravity alone is silent.
 */
public class SensorManagerSource internal constructor(
    private val manager: SensorManager,
    private val options: SensorOptions,
    private val continuousNs: () -> Long,
    private val above200Hz: () -> Boolean,
) : MagneticFieldSource {

    /** The sensors of the phone behind a context. The source keeps the application's context alone. */
    @JvmOverloads
    public constructor(context: Context, options: SensorOptions = SensorOptions()) : this(
        // of the application: the manager keeps its context
        applicationOf(context).getSystemService(Context.SENSOR_SERVICE) as SensorManager,
        options,
        SystemClock::elapsedRealtimeNanos,
        mayExceed200Hz(applicationOf(context)),
    )

    private val inUse = MutableStateFlow<SensorsInUse?>(null)

    /** The sensors in use; the value is null before the first collector. */
    public val sensors: StateFlow<SensorsInUse?> = inUse.asStateFlow()

    /** Android's `Sensor.getMaximumRange`; null if a driver says less than 100 or more than 100 000 microtesla, which is no full scale. */
    override val fullScaleUt: Double?
        get() = magnetometer()?.maximumRange?.toDouble()?.takeIf { it in LEAST_FULL_SCALE_UT..LARGEST_FULL_SCALE_UT }

    override val nowNs: Long get() = continuousNs()

    private val sleep = Sleep()

    /** On most phones the sensors' times count sleep. Where they do not, this is how far they fall behind `elapsedRealtimeNanos`. */
    override val hiddenS: Double get() = sleep.hiddenS

    /** On most phones this is the same time. */
    override fun eventTimeNs(elapsedRealtimeNs: Long): Long = elapsedRealtimeNs - sleep.behindNs

    /** While anyone takes its events; within the lock of this source, in which nobody else's code is called. */
    private var run: SensorRun? = null

    /** The longest from one event to the next of any sensor that has the same clock, ns. */
    internal val mostBetweenNs: Long get() = 1000L * options.maxReportLatencyUs + 1_000_000_000L / options.slowestHz + Clocks.SAME_NS.toLong()

    /** The events, on a thread of this source. It ends with the error of [taker], if at all. */
    override suspend fun deliver(taker: EventTaker) {
        val seat = Seat(taker)
        join(seat)
        try {
            throw seat.failure.await()
        } finally {
            leave(seat)
        }
    }

    @Synchronized
    private fun join(seat: Seat) {
        val run = run
        if (run == null) this.run = begun(seat) else run.add(seat)
    }

    @Synchronized
    private fun leave(seat: Seat) {
        val run = run ?: return
        if (!run.remove(seat)) {
            this.run = null
            run.end()
        }
    }

    private fun begun(first: Seat): SensorRun {
        val magnetometer = magnetometer() ?: throw SensorException.Missing("magnetometer", "hide the compass")
        val up = if (options.up) up() else null
        val gyroscope = if (options.gyroscope) manager.getDefaultSensor(Sensor.TYPE_GYROSCOPE) else null
        if (options.fastestHz > FREE_RATE_HZ && !above200Hz()) throw SensorException.PermissionMissing(HIGH_RATE)
        val without = when {
            !options.gyroscope -> "the gyroscope was not asked for"
            gyroscope == null -> "this phone has no gyroscope"
            else -> null
        }
        return SensorRun(manager, options, inUse, sleep, continuousNs).apply { start(first, magnetometer, up, gyroscope, without) }
    }

    private fun magnetometer(): Sensor? = manager.getDefaultSensor(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED)
        ?: manager.getDefaultSensor(Sensor.TYPE_MAGNETIC_FIELD)

    private fun up(): Sensor = manager.getDefaultSensor(Sensor.TYPE_GRAVITY)
        ?: manager.getDefaultSensor(Sensor.TYPE_ACCELEROMETER)
        ?: throw SensorException.Missing("accelerometer", "without a heading, use SensorOptions(up = false)")

    /** A question to ask before anything is collected. */
    public companion object {
        /**
         * Whether the phone has what a heading needs: a magnetometer, and gravity or an accelerometer. A gyroscope makes the heading better,
         * and this does not ask for it. Nothing is registered.
         */
        @JvmStatic
        public fun isAvailable(context: Context): Boolean {
            val manager = applicationOf(context).getSystemService(Context.SENSOR_SERVICE) as? SensorManager ?: return false
            fun has(vararg types: Int) = types.any { manager.getDefaultSensor(it) != null }
            return has(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, Sensor.TYPE_MAGNETIC_FIELD) && has(Sensor.TYPE_GRAVITY, Sensor.TYPE_ACCELEROMETER)
        }

        // one that is less can't measure the Earth's field beside a phone's own
        private const val LEAST_FULL_SCALE_UT = 100.0
        private const val LARGEST_FULL_SCALE_UT = 100_000.0
        internal const val FREE_RATE_HZ = 200
        internal const val HIGH_RATE = "android.permission.HIGH_SAMPLING_RATE_SENSORS"

        /** Android 12, for apps that target it. */
        private const val RULE_SINCE_SDK = 31

        private fun mayExceed200Hz(context: Context): () -> Boolean = {
            Build.VERSION.SDK_INT < RULE_SINCE_SDK ||
                context.applicationInfo.targetSdkVersion < RULE_SINCE_SDK ||
                context.checkCallingOrSelfPermission(HIGH_RATE) == PackageManager.PERMISSION_GRANTED
        }

        /** There is none yet in an application's own constructor. */
        private fun applicationOf(context: Context): Context = context.applicationContext ?: context
    }
}
