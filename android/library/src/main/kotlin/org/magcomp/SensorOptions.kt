package org.magcomp

/**
 * How the phone's sensors are asked.
 *
 * @property rateHz events a second of each sensor, 1 to 1000; the system takes it as a wish. 50 to 100 serve a compass; below 20 Hz the
 *   headings of a phone that moves are wrong by tens of degrees. Above 200 Hz Android 12 and newer want the permission
 *   `android.permission.HIGH_SAMPLING_RATE_SENSORS`. Default 100
 * @property maxReportLatencyUs how long the system may collect events before it delivers them, microseconds; more saves
 *   power and delays readings; above 200 000 it makes them worse too, as events come sensor by sensor and wait for each other for
 *   0.25 s at the most. Default 0: at once
 * @property gyroscope whether the gyroscope is used where there is one and the system delivers it. Default true
 * @property up whether gravity, else the accelerometer, is used; without it there is no heading. Default true
 * @property holdS longest that an event waits for those of the other sensors, so that all go in the order of their times, 0 to
 *   0.25 s (see [EventQueue]); 0: as they are delivered. Default null: 0.05 beyond [maxReportLatencyUs], at most 0.25
 */
public data class SensorOptions @JvmOverloads constructor(
    public val rateHz: Int = 100,
    public val maxReportLatencyUs: Int = 0,
    public val gyroscope: Boolean = true,
    public val up: Boolean = true,
    public val holdS: Double? = null,
) {
    init {
        require(rateHz in 1..1000) { "rateHz is $rateHz, expected 1 to 1000" }
        require(holdS == null || holdS in 0.0..EventQueue.LONGEST_HOLD_S) {
            "holdS is $holdS, expected 0 to ${EventQueue.LONGEST_HOLD_S}, or null for what suits the latency"
        }
        require(maxReportLatencyUs >= 0) { "maxReportLatencyUs is $maxReportLatencyUs, expected 0 or above" }
    }

    /** What [holdS] says or, where it says nothing, what suits the latency. */
    internal val heldS: Double
        get() = holdS ?: minOf(EventQueue.DEFAULT_HOLD_S + maxReportLatencyUs * 1e-6, EventQueue.LONGEST_HOLD_S)
}
