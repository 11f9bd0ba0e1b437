package org.magcomp

import android.hardware.Sensor
import org.magcomp.core.*

/**
 * How the phone's sensors are asked.
 *
 * @property rateHz events a second of each sensor, 1 to 1000. The system takes it as a wish. 50 to 100 serve a compass; below 20 Hz the
 *   headings of a phone that moves are wrong by tens of degrees. Above 200 Hz Android 12 and newer want the permission
 *   `android.permission.HIGH_SAMPLING_RATE_SENSORS`. Default 100
 * @property maxReportLatencyUs how long the system may collect events before it delivers them, microseconds. A larger one saves power and
 *   delays readings. Above 200 000 readings get worse too: events come sensor by sensor, and wait for each other 0.25 s at most. Default 0
 * @property gyroscope whether the gyroscope is used. Default true
 * @property up whether gravity, else the accelerometer, is used. Without it there is no heading. Default true
 * @property holdS how long an event may wait for those of the other sensors, so that all go in the order of their times, 0 to 0.25 s
 *   ([EventQueue]). With 0 events go as they are delivered. The default, null, is 0.05 beyond [maxReportLatencyUs], at most 0.25
 * @property magnetometerRateHz events a second of the magnetometer alone, so how many readings come. Fewer save work, and what the gyroscope
 *   tells between two of them still counts. The default, null, is [rateHz]
 */
public class SensorOptions @JvmOverloads constructor(
    public val rateHz: Int = 100,
    public val maxReportLatencyUs: Int = 0,
    public val gyroscope: Boolean = true,
    public val up: Boolean = true,
    public val holdS: Double? = null,
    public val magnetometerRateHz: Int? = null,
) {
    init {
        require(rateHz in 1..1000) { "rateHz is $rateHz, expected 1 to 1000" }
        require(magnetometerRateHz == null || magnetometerRateHz in 1..1000) { "magnetometerRateHz is $magnetometerRateHz, expected 1 to 1000, or null" }
        require(holdS == null || holdS in 0.0..EventQueue.LONGEST_HOLD_S) {
            "holdS is $holdS, expected 0 to ${EventQueue.LONGEST_HOLD_S}, or null for what suits the latency"
        }
        require(maxReportLatencyUs >= 0) { "maxReportLatencyUs is $maxReportLatencyUs, expected 0 or above" }
    }

    /** That of each sensor. */
    internal fun rateHz(type: Int): Int = when (type) {
        Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, Sensor.TYPE_MAGNETIC_FIELD -> magnetometerRateHz ?: rateHz
        else -> rateHz
    }

    /** The least and the largest of the two rates. */
    internal val slowestHz: Int get() = minOf(rateHz, magnetometerRateHz ?: rateHz)
    internal val fastestHz: Int get() = maxOf(rateHz, magnetometerRateHz ?: rateHz)

    /** What [holdS] says or, where it says nothing, what suits the latency. */
    internal val heldS: Double
        get() = holdS ?: minOf(EventQueue.DEFAULT_HOLD_S + maxReportLatencyUs * 1e-6, EventQueue.LONGEST_HOLD_S)
}
