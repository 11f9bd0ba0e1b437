package org.magcomp

import android.hardware.Sensor
import kotlin.math.abs
import kotlin.math.cos
import kotlin.math.sin
import kotlin.time.Duration.Companion.ZERO
import kotlinx.coroutines.async
import kotlinx.coroutines.flow.take
import kotlinx.coroutines.flow.toList
import kotlinx.coroutines.runBlocking
import kotlinx.coroutines.withTimeout
import kotlinx.coroutines.yield
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertNull
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.core.*

/** A phone that lies still from the start, with nothing in a store. */
class FirstReadingTest {
    private val hardIron = DeviceVector(120.0, -80.0, 300.0)

    @Test
    fun `with the system's hard iron it has a heading, as wrong as its sigma says`() {
        // what a phone's own calibration errs by
        val off = DeviceVector(4.0, -5.0, 3.0)
        val reported = DeviceVector(hardIron.x + off.x, hardIron.y + off.y, hardIron.z + off.z)
        val found = (0 until 360 step 10).map { headingDeg ->
            val heading = first(headingDeg.toDouble(), reported).heading!!
            val errorDeg = abs(Math.IEEEremainder(heading.headingDeg - headingDeg, 360.0))
            assertTrue(errorDeg < 3 * heading.headingSigmaDeg!!, "$headingDeg: off by $errorDeg, sigma ${heading.headingSigmaDeg}")
            Pair(errorDeg, heading.headingSigmaDeg!!)
        }
        val (errors, sigmas) = Pair(found.map { it.first }, found.map { it.second }.sorted())
        assertTrue(sigmas.first() > 5 && sigmas[sigmas.size / 2] < 90 && sigmas.last() <= 180, "$sigmas")
        assertTrue(errors.max() in 10.0..25.0, "the data show an error: ${errors.max()}")
    }

    @Test
    fun `without it there is none, nor when the config refuses it`() {
        assertNull(first(0.0, null).heading)
        assertNull(first(0.0, hardIron, CompensationConfig(useReportedHardIron = false)).heading)
        assertEquals(0.0, Math.IEEEremainder(first(0.0, hardIron).heading!!.headingDeg, 360.0), 1e-3)
    }

    private fun first(headingDeg: Double, reported: DeviceVector?, config: CompensationConfig = CompensationConfig()): MagneticReading = runBlocking {
        val sensors = FakeSensorManager(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, Sensor.TYPE_GRAVITY)
        val reading = async { Compass(sensors.source(), config, grace = ZERO).readings().take(1).toList().single().reading }
        withTimeout(120_000) { while (sensors.registrations.size < 2) yield() }
        val (north, east) = Pair(cos(Math.toRadians(headingDeg)), sin(Math.toRadians(headingDeg)))
        sensors.deliver(SensorSample.Up(UpSample(STEP_NS, DeviceVector(0.0, 0.0, 9.81))))
        val raw = DeviceVector(hardIron.x - 20 * east, hardIron.y + 20 * north, hardIron.z - 45)
        sensors.deliver(SensorSample.Magnetic(MagneticSample(STEP_NS, raw, reported)))
        reading.await()
    }
}
