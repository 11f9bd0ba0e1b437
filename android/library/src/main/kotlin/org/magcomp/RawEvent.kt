package org.magcomp

import org.magcomp.core.*

/** One event of a sensor as numbers. It is used again: who gets one is done with it when it returns. */
internal class RawEvent {
    /** [ROTATION_RATE], [UP] or [MAGNETIC]. */
    var kind = 0
    var timeNs = 0L

    /** The sensor's own time, where [timeNs] is brought to another clock. */
    var ownNs = 0L
    var x = 0.0
    var y = 0.0
    var z = 0.0

    /** Of a magnetometer the operating system's own hard iron. */
    var reported: DeviceVector? = null

    /** What the system said last of a magnetometer. */
    var accuracy = SensorAccuracy.UNKNOWN

    fun set(kind: Int, timeNs: Long, x: Double, y: Double, z: Double, reported: DeviceVector? = null, ownNs: Long = timeNs) {
        this.kind = kind
        this.timeNs = timeNs
        this.ownNs = ownNs
        this.x = x
        this.y = y
        this.z = z
        this.reported = reported
    }

    fun copy() = RawEvent().also {
        it.set(kind, timeNs, x, y, z, reported, ownNs)
        it.accuracy = accuracy
    }

    fun set(event: SensorSample) = when (event) {
        is SensorSample.RotationRate -> with(event.sample.rateRadS) { set(ROTATION_RATE, event.timeNs, x, y, z) }
        is SensorSample.Up -> with(event.sample.upMS2) { set(UP, event.timeNs, x, y, z) }
        is SensorSample.Magnetic -> with(event.sample.fieldUt) { set(MAGNETIC, event.timeNs, x, y, z, event.sample.reportedHardIronUt) }
    }

    fun toSample(): SensorSample {
        val vector = DeviceVector(x, y, z)
        return when (kind) {
            ROTATION_RATE -> SensorSample.RotationRate(RotationRateSample(timeNs, vector))
            UP -> SensorSample.Up(UpSample(timeNs, vector))
            else -> SensorSample.Magnetic(MagneticSample(timeNs, vector, reported))
        }
    }

    companion object {
        // at equal times in this order
        const val ROTATION_RATE = 0
        const val UP = 1
        const val MAGNETIC = 2
    }
}
