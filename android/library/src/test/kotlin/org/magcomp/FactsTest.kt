package org.magcomp

import android.hardware.Sensor
import kotlin.math.abs
import kotlinx.coroutines.flow.take
import kotlinx.coroutines.flow.toList
import kotlinx.coroutines.launch
import kotlinx.coroutines.runBlocking
import kotlinx.coroutines.withTimeout
import kotlinx.coroutines.yield
import org.json.JSONArray
import org.json.JSONObject
import org.junit.jupiter.api.Assertions.assertArrayEquals
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertFalse
import org.junit.jupiter.api.Assertions.assertThrows
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.core.*

/** The facts every language of the library agrees on, from the files Rust and Swift assert too. */
class FactsTest {
    private val facts = JSONObject(repository.resolve("tests/vectors/facts.json").readText())

    @Test
    fun correcting() {
        for (case in list(facts, "correct")) {
            val calibration = MagnetometerCalibration(softIron(case), vector(case.getJSONArray("hard_iron_ut")), 50.0)
            assertVector(vector(case.getJSONArray("field_ut")), correct(calibration, vector(case.getJSONArray("raw_ut"))), 1e-12)
        }
    }

    @Test
    fun `no calibration`() {
        for (case in list(facts, "no_calibration")) {
            val calibration = MagnetometerCalibration(softIron(case), DeviceVector(0.0, 0.0, 0.0), case.getDouble("field_strength_ut"))
            val error = assertThrows(MagcompException.Calibration::class.java) { correct(calibration, DeviceVector(1.0, 2.0, 3.0)) }
            assertEquals(case.getString("text"), error.text())
        }
    }

    @Test
    fun `the gauge is the symmetric positive definite matrix`() {
        val gauge = facts.getJSONObject("gauge")
        val (soft, hard, strength) = NativeConstantField(1).use { session ->
            val raw = gauge.getJSONArray("raw_ut")
            for (k in 0 until raw.length()) session.add(vector(raw.getJSONArray(k)))
            session.finish(null).calibration
        }
        val expected = softIron(gauge)
        assertArrayEquals(
            with(expected) { doubleArrayOf(xx, yy, zz, xy, xz, yz) },
            with(soft) { doubleArrayOf(xx, yy, zz, xy, xz, yz) },
            1e-9,
        )
        assertVector(vector(gauge.getJSONArray("hard_iron_ut")), hard, 1e-7)
        assertEquals(gauge.getDouble("field_strength_ut"), strength, 1e-7)
    }

    @Test
    fun headings() {
        for (case in list(facts, "headings")) {
            val frame = HeadingFrame(ReferenceAxis.TOP_EDGE, ScreenRotation.DEG0, case.getDouble("declination_deg"))
            val found = heading(vector(case.getJSONArray("field_ut")), vector(case.getJSONArray("up")), frame)!!
            assertEquals(case.getDouble("heading_deg"), found.headingDeg, 1e-9, case.getString("name"))
            assertEquals(case.getDouble("true_heading_deg"), found.trueHeadingDeg!!, 1e-9, case.getString("name"))
            assertEquals(case.getDouble("inclination_deg"), found.inclinationDeg!!, 1e-9, case.getString("name"))
            val (w, x, y, z) = attitude(vector(case.getJSONArray("field_ut")), vector(case.getJSONArray("up")))!!
            val q = case.getJSONArray("attitude")
            // a quaternion and its negative are the same attitude
            val product = w * q.getDouble(0) + x * q.getDouble(1) + y * q.getDouble(2) + z * q.getDouble(3)
            assertEquals(1.0, abs(product), 1e-12, case.getString("name"))
        }
    }

    @Test
    fun `units by their limits`() {
        val limits = facts.getJSONObject("limits")
        fun pair(key: String) = limits.getJSONArray(key).let { Pair(it.getDouble(0), it.getDouble(1)) }
        Compensator().use { compensator ->
            fun push(timeNs: Long, x: Double) = compensator.push(MagneticSample(timeNs, DeviceVector(x, 0.0, 0.0))).status
            val (within, beyond) = pair("magnetic_ut")
            assertTrue(push(0, within) is CompensationStatus.Collecting)
            assertTrue((push(1, beyond) as CompensationStatus.Rejected).reason is RejectReason.OutOfRange)
            val (soon, late) = pair("gap_ns")
            assertTrue((push(late.toLong(), 1.0) as CompensationStatus.Rejected).reason is RejectReason.TimeJump)
            assertTrue(push(soon.toLong(), 1.0) is CompensationStatus.Collecting)
        }
        Compensator().use { compensator ->
            val (slow, fast) = pair("rotation_rate_rad_s")
            assertTrue(compensator.pushRotationRate(1, slow, 0.0, 0.0))
            assertFalse(compensator.pushRotationRate(2, fast, 0.0, 0.0))
            val (weak, strong) = pair("up_m_s2")
            assertTrue(compensator.pushUp(1, weak, 0.0, 0.0))
            assertFalse(compensator.pushUp(2, strong, 0.0, 0.0))
        }
    }

    @Test
    fun errors() {
        assertEquals(
            list(facts, "event_rejections").map { it.getString("text") },
            EventRejection.entries.map { it.text() },
        )
        for (case in list(facts, "errors") + list(facts, "border_errors")) {
            val error = when (val name = case.getString("name")) {
                "Config" -> assertThrows(MagcompException.Config::class.java) {
                    Compensator(CompensationConfig(windowed = WindowedConfig(nMin = 3)))
                }
                "KeptDamaged" -> Compensator().use {
                    assertThrows(MagcompException.KeptDamaged::class.java) { it.adoptKept("nonsense", null) }
                }
                "KeptNewer" -> MagcompException.KeptNewer(99)
                "Closed" -> MagcompException.Closed()
                "Panicked" -> MagcompException.Panicked("why")
                else -> error(name)
            }
            if (case.has("begins")) {
                assertTrue(error.text().startsWith(case.getString("begins")), error.text())
            } else {
                assertEquals(case.getString("text"), error.text())
            }
        }
    }

    @Test
    fun `signs and units of Android's sensors, in attitudes computed by hand`() = runBlocking {
        val shared = JSONObject(repository.resolve("tests/vectors/platform_events.json").readText())
        val types = intArrayOf(Sensor.TYPE_GYROSCOPE, Sensor.TYPE_GRAVITY, Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED)
        val timeNs = shared.getLong("time_ns")
        val cases = list(shared, "cases")
        assertEquals(50, cases.size)
        for (case in cases) {
            val sensors = FakeSensorManager(*types)
            val samples = mutableListOf<SensorSample>()
            val collecting = launch { sensors.source().samples().take(3).toList(samples) }
            withTimeout(120_000) { while (sensors.registrations.size < 3) yield() }
            val events = case.getJSONObject("android")
            for ((type, key) in types.zip(listOf("gyroscope", "gravity", "magnetic_field_uncalibrated"))) {
                val value = events.getJSONArray(key)
                sensors.deliver(type, timeNs, *FloatArray(3) { value.getDouble(it).toFloat() })
            }
            withTimeout(120_000) { collecting.join() }
            val rate = (samples[0] as SensorSample.RotationRate).sample
            val up = (samples[1] as SensorSample.Up).sample
            val field = (samples[2] as SensorSample.Magnetic).sample
            // Android's floats
            assertVector(vector(case.getJSONArray("rate_rad_s")), rate.rateRadS, 1e-5)
            assertVector(vector(case.getJSONArray("up_m_s2")), up.upMS2, 1e-5)
            assertVector(vector(case.getJSONArray("field_ut")), field.fieldUt, 1e-5)
            assertEquals(List(3) { timeNs }, samples.map { it.timeNs })
            val axis = ReferenceAxis.valueOf(case.getString("axis").uppercase())
            val found = heading(field.fieldUt, up.upMS2, HeadingFrame(axis, ScreenRotation.DEG0))!!
            val off = Math.IEEEremainder(found.headingDeg - case.getDouble("heading_deg"), 360.0)
            assertTrue(abs(off) < 1e-4, "${case.getString("name")}: $found")
            assertEquals(shared.getDouble("inclination_deg"), found.inclinationDeg!!, 1e-4)
        }
    }

    private fun list(of: JSONObject, key: String): List<JSONObject> {
        val list = of.getJSONArray(key)
        assertTrue(list.length() > 0, key)
        return List(list.length()) { list.getJSONObject(it) }
    }

    private fun vector(json: JSONArray) = DeviceVector(json.getDouble(0), json.getDouble(1), json.getDouble(2))

    private fun softIron(case: JSONObject): SoftIron {
        val m = case.getJSONArray("soft_iron")
        return SoftIron(m.getDouble(0), m.getDouble(1), m.getDouble(2), m.getDouble(3), m.getDouble(4), m.getDouble(5))
    }

    private fun assertVector(expected: DeviceVector, found: DeviceVector, tolerance: Double) = assertArrayEquals(
        with(expected) { doubleArrayOf(x, y, z) },
        with(found) { doubleArrayOf(x, y, z) },
        tolerance,
    )
}
