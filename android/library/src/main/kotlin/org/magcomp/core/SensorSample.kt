package org.magcomp.core

/** An event of one of the three sensors, with its own time. */
public sealed interface SensorSample {
    /** Time of the event, nanoseconds, on one clock for all sensors. */
    public val timeNs: Long

    /**
     * A raw magnetometer event.
     *
     * @property sample its time and field
     */
    public data class Magnetic(public val sample: MagneticSample) : SensorSample {
        override val timeNs: Long get() = sample.timeNs
    }

    /**
     * A gyroscope event.
     *
     * @property sample its time and rates
     */
    public data class RotationRate(public val sample: RotationRateSample) : SensorSample {
        override val timeNs: Long get() = sample.timeNs
    }

    /**
     * An accelerometer or gravity event.
     *
     * @property sample its time and direction
     */
    public data class Up(public val sample: UpSample) : SensorSample {
        override val timeNs: Long get() = sample.timeNs
    }
}
