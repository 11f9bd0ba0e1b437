package org.magcomp

import org.magcomp.core.*

/**
 * One event of a sensor as numbers. A source uses the object again: who takes one is done with it when [EventTaker.take] returns, and changes
 * a [copy] alone.
 */
public class RawEvent {
    /** At equal times events have this order. */
    internal var kind = 0

    /** The sensor that it is of. */
    public val sensor: PhoneSensor get() = SENSORS[kind]

    /** Time of the event, nanoseconds, on one clock for all sensors. */
    public var timeNs: Long = 0L

    /** The sensor's own time, nanoseconds, where [timeNs] is brought to another clock. */
    public var ownNs: Long = 0L

    /** To the right of the screen: microtesla, m/s^2, or rad/s. */
    public var x: Double = 0.0

    /** Towards the top of the screen. */
    public var y: Double = 0.0

    /** Out of the screen. */
    public var z: Double = 0.0

    /** Of a magnetometer the operating system's own hard iron, microtesla; null if it tells none. */
    public var reportedHardIronUt: DeviceVector? = null

    /** What the system said last of a magnetometer. */
    public var accuracy: SensorAccuracy = SensorAccuracy.UNKNOWN

    internal fun set(kind: Int, timeNs: Long, x: Double, y: Double, z: Double, reported: DeviceVector? = null, ownNs: Long = timeNs) {
        this.kind = kind
        this.timeNs = timeNs
        this.ownNs = ownNs
        this.x = x
        this.y = y
        this.z = z
        reportedHardIronUt = reported
        accuracy = SensorAccuracy.UNKNOWN
    }

    /** Becomes this event. */
    public fun set(event: SensorSample): RawEvent {
        when (event) {
            is SensorSample.RotationRate -> with(event.sample.rateRadS) { set(ROTATION_RATE, event.timeNs, x, y, z) }
            is SensorSample.Up -> with(event.sample.upMS2) { set(UP, event.timeNs, x, y, z) }
            is SensorSample.Magnetic -> with(event.sample.fieldUt) { set(MAGNETIC, event.timeNs, x, y, z, event.sample.reportedHardIronUt) }
        }
        return this
    }

    /** The same, to be kept. */
    public fun copy(): RawEvent = RawEvent().also {
        it.set(kind, timeNs, x, y, z, reportedHardIronUt, ownNs)
        it.accuracy = accuracy
    }

    /** The same as a record. */
    public fun toSample(): SensorSample {
        val vector = DeviceVector(x, y, z)
        return when (kind) {
            ROTATION_RATE -> SensorSample.RotationRate(RotationRateSample(timeNs, vector))
            UP -> SensorSample.Up(UpSample(timeNs, vector))
            else -> SensorSample.Magnetic(MagneticSample(timeNs, vector, reportedHardIronUt))
        }
    }

    internal companion object {
        const val ROTATION_RATE = 0
        const val UP = 1
        const val MAGNETIC = 2
        private val SENSORS = arrayOf(PhoneSensor.GYROSCOPE, PhoneSensor.GRAVITY, PhoneSensor.MAGNETOMETER)
    }
}
