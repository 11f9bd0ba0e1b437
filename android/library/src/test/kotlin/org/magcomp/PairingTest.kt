package org.magcomp

import java.util.Random
import kotlin.math.acos
import kotlin.math.cos
import kotlin.math.sin
import kotlin.math.sqrt
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.core.*

/** Events of three sensors with their own times, through the border as a phone delivers them. */
class PairingTest {
    /** 40 s of a hand turning a phone: magnetometer at 100 Hz, gyroscope at 400 Hz, gravity at 50 Hz. */
    private val turned = turned()

    @Test
    fun `events between two magnetometer samples may come in any order`() {
        val random = Random(3)
        val shuffled = mutableListOf<SensorSample>()
        val between = mutableListOf<SensorSample>()
        for (event in turned.events) {
            if (event is SensorSample.Magnetic) {
                between.shuffle(random)
                shuffled += between + event
                between.clear()
            } else {
                between += event
            }
        }
        assertTrue(shuffled != turned.events)
        assertEquals(readings(turned.events), readings(shuffled))
    }

    @Test
    fun `jitter, lost events and late ones do no harm`() {
        val random = Random(4)
        val arrivals = turned.events
            // every twentieth event of gyroscope and gravity is lost; some arrive up to 4 ms late
            .filter { it is SensorSample.Magnetic || random.nextInt(20) != 0 }
            .map { event ->
                val late = if (event !is SensorSample.Magnetic && random.nextInt(10) == 0) random.nextInt(4_000_000) else 0
                event.timeNs + late to event
            }
            .sortedBy { it.first }
            .map { it.second }
        val found = readings(arrivals.map { jittered(it, random) })
        assertEquals(4000, found.size)
        assertTrue(found.none { it.status is CompensationStatus.Rejected })
        assertErrors(found.drop(1500), below = 2.0)
    }

    @Test
    fun `a gap of the gyroscope is told, and bridged by what was learned`() {
        val gap = 20_000_000_000L..23_000_000_000L
        val found = readings(turned.events.filterNot { it is SensorSample.RotationRate && it.timeNs in gap })
        val modes = found.associate { it.timeNs to it.mode }
        assertEquals(SensorMode.GYROSCOPE_AND_GRAVITY, modes.getValue(19_900_000_000L))
        assertEquals(SensorMode.GRAVITY_ONLY, modes.getValue(22_000_000_000L))
        val back = modes.filter { it.key > 23_000_000_000L && it.value == SensorMode.GYROSCOPE_AND_GRAVITY }.keys.min()
        assertTrue(back < 28_000_000_000L, "back at $back ns")
        assertTrue(found.none { it.timeNs > 15_000_000_000L && it.fieldUt == null }, "the calibration is kept")
        assertErrors(found.filter { it.timeNs > 15_000_000_000L }, below = 3.0)
    }

    @Test
    fun `a pause of all sensors keeps the calibration`() {
        val pause = 20_000_000_000L..30_000_000_000L
        val found = readings(turned.events.filterNot { it.timeNs in pause })
        assertTrue(found.none { it.timeNs > 15_000_000_000L && it.fieldUt == null })
        assertErrors(found.filter { it.timeNs > 15_000_000_000L }, below = 3.0)
    }

    private fun readings(events: List<SensorSample>) = Compensator().use { it.pushAll(events) }

    /** 95 % of the corrected fields point where the true ones do, within so many degrees. */
    private fun assertErrors(readings: List<MagneticReading>, below: Double) {
        val errors = readings.map { angleDeg(it.fieldUt!!, turned.fields.getValue(it.timeNs / STEP_NS)) }.sorted()
        val worst = errors[errors.size * 95 / 100]
        assertTrue(worst < below, "95 % of the directions are right within $worst degrees")
    }

    /** Times off by up to half a millisecond; those of the magnetometer stay, so that they can be looked up. */
    private fun jittered(event: SensorSample, random: Random): SensorSample {
        val off = random.nextInt(1_000_000) - 500_000L
        return when (event) {
            is SensorSample.Magnetic -> event
            is SensorSample.RotationRate -> SensorSample.RotationRate(event.sample.copy(timeNs = event.timeNs + off))
            is SensorSample.Up -> SensorSample.Up(event.sample.copy(timeNs = event.timeNs + off))
        }
    }

    private class Turned(val events: List<SensorSample>, val fields: Map<Long, DeviceVector>)

    private fun turned(): Turned {
        val random = Random(5)
        val events = mutableListOf<SensorSample>()
        val fields = HashMap<Long, DeviceVector>()
        var attitude = doubleArrayOf(1.0, 0.0, 0.0, 0.0)
        for (k in 1..16_000L) {
            val timeNs = k * GYROSCOPE_STEP_NS
            val t = timeNs * 1e-9
            attitude = turn(attitude, rate(t - 0.5e-9 * GYROSCOPE_STEP_NS), GYROSCOPE_STEP_NS * 1e-9)
            events += SensorSample.RotationRate(RotationRateSample(timeNs, rate(t)))
            if (k % 8 == 0L) events += SensorSample.Up(UpSample(timeNs, inDevice(attitude, DeviceVector(0.0, 0.0, 9.81))))
            if (k % 4 == 0L) {
                val field = inDevice(attitude, DeviceVector(0.0, 22.0, -42.0))
                fields[timeNs / STEP_NS] = field
                val noise = { 0.3 * random.nextGaussian() }
                val raw = DeviceVector(field.x + 30 + noise(), field.y - 20 + noise(), field.z + 40 + noise())
                events += SensorSample.Magnetic(MagneticSample(timeNs, raw))
            }
        }
        return Turned(events, fields)
    }

    private fun rate(t: Double) = DeviceVector(0.8 * sin(0.9 * t), 0.9 * cos(0.7 * t), 0.7 * sin(1.3 * t + 1))

    /** The attitude q (device to Earth; w, x, y, z) after turning at a rate about the device's axes for so long. */
    private fun turn(q: DoubleArray, rate: DeviceVector, seconds: Double): DoubleArray {
        val speed = sqrt(rate.x * rate.x + rate.y * rate.y + rate.z * rate.z)
        val half = speed * seconds / 2
        val (w, s) = Pair(cos(half), if (speed > 0) sin(half) / speed else 0.0)
        val (x, y, z) = Triple(s * rate.x, s * rate.y, s * rate.z)
        return doubleArrayOf(
            q[0] * w - q[1] * x - q[2] * y - q[3] * z,
            q[0] * x + q[1] * w + q[2] * z - q[3] * y,
            q[0] * y - q[1] * z + q[2] * w + q[3] * x,
            q[0] * z + q[1] * y - q[2] * x + q[3] * w,
        )
    }

    /** A vector of the Earth's frame in the device's. */
    private fun inDevice(q: DoubleArray, v: DeviceVector): DeviceVector {
        val (w, x, y, z) = q.toList()
        return DeviceVector(
            (1 - 2 * (y * y + z * z)) * v.x + 2 * (x * y + w * z) * v.y + 2 * (x * z - w * y) * v.z,
            2 * (x * y - w * z) * v.x + (1 - 2 * (x * x + z * z)) * v.y + 2 * (y * z + w * x) * v.z,
            2 * (x * z + w * y) * v.x + 2 * (y * z - w * x) * v.y + (1 - 2 * (x * x + y * y)) * v.z,
        )
    }

    private fun angleDeg(a: DeviceVector, b: DeviceVector): Double {
        fun dot(a: DeviceVector, b: DeviceVector) = a.x * b.x + a.y * b.y + a.z * b.z
        return Math.toDegrees(acos((dot(a, b) / sqrt(dot(a, a) * dot(b, b))).coerceIn(-1.0, 1.0)))
    }

    private companion object {
        const val GYROSCOPE_STEP_NS = 2_500_000L
    }
}
