package org.magcomp

import org.magcomp.core.*

/** A sensor of the phone that a heading is made of. */
public enum class PhoneSensor {
    /** The uncalibrated magnetometer, else the calibrated one. */
    MAGNETOMETER,

    /** The gyroscope. */
    GYROSCOPE,

    /** The gravity sensor, else the accelerometer: the vertical. */
    GRAVITY,
}

/**
 * Whether a stream of readings has all that a heading is made of. The compensator's own [CompensationStatus] can't say so: it knows of nothing that
 * does not come.
 */
public sealed class StreamStatus {
    /** The stream has all of it. */
    public data object Live : StreamStatus()

    /**
     * Sensors in use have delivered nothing for 2 s beyond the latency that was asked for. All sensors are silent while an app is in the
     * background without a foreground service; one that is silent alone is broken. A silent magnetometer ends the heading: one reading tells
     * so, whose heading, attitude and field are null, and the next reading comes with the next event. Without gravity the gyroscope carries
     * the heading on; without the gyroscope gravity does, and the heading is less sure; without both it ends.
     *
     * @property sensors the silent ones, at least one
     */
    public data class Silent(public val sensors: Set<PhoneSensor>) : StreamStatus()

    /**
     * For a second no sample had an event of gravity or accelerometer near its own time: none came, or its times are of another clock. There
     * is no heading.
     */
    public data object NoVertical : StreamStatus()
}
