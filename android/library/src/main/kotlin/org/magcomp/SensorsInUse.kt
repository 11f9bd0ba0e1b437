package org.magcomp

import org.magcomp.core.*

/**
 * The phone's sensors in use.
 *
 * @property magnetometer the uncalibrated magnetometer, else the calibrated one
 * @property up gravity, else the accelerometer, which also takes over where gravity alone is silent; null if it was not asked for
 * @property gyroscope null if it is not used
 * @property withoutGyroscope why the gyroscope is not used, in a sentence; null if it is
 */
public data class SensorsInUse(
    public val magnetometer: UsedSensor,
    public val up: UsedSensor?,
    public val gyroscope: UsedSensor?,
    public val withoutGyroscope: String?,
)

/**
 * One sensor of the phone.
 *
 * @property type Android's: `Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED` and so on
 * @property name the maker's name for it
 * @property vendor its maker
 * @property accuracy what the system last said of it
 * @property isSilent whether it is registered and has delivered no event of three numbers for 2 s beyond the latency that was asked for. All
 *   sensors are silent while an app is in the background without a foreground service; one that is silent alone is broken
 */
public data class UsedSensor @JvmOverloads constructor(
    public val type: Int,
    public val name: String,
    public val vendor: String,
    public val accuracy: SensorAccuracy,
    public val isSilent: Boolean = false,
)

/** How far the system trusts a sensor: Android's `SENSOR_STATUS_...`. */
public enum class SensorAccuracy {
    /** The system has not said yet. */
    UNKNOWN,

    /** The sensor measures nothing. */
    NO_CONTACT,

    /** What it measures can't be trusted. */
    UNRELIABLE,

    /** Low. */
    LOW,

    /** Medium. */
    MEDIUM,

    /** High. */
    HIGH,
}
