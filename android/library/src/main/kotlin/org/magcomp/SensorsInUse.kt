package org.magcomp

import org.magcomp.core.*

/**
 * The phone's sensors that are used.
 *
 * @property magnetometer the uncalibrated one, else the calibrated one
 * @property up gravity, else the accelerometer, also where gravity is silent while others are not; null when it was not asked for
 * @property gyroscope null when it is not used
 * @property withoutGyroscope why not, in a sentence; null when it is used
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
 * @property name as its maker calls it
 * @property vendor its maker
 * @property accuracy what the system says of it last
 * @property isSilent it is registered, and has delivered nothing for 2 s beyond the latency that was asked for, or nothing that is an
 *   event of three numbers. All sensors are while an app is in the background without a foreground service; one alone is broken.
 *   It counts no longer as soon as an event comes
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
    /** It has not said yet. */
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
