package org.magcomp

import java.io.File
import org.junit.jupiter.api.Assertions.assertArrayEquals
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertFalse
import org.junit.jupiter.api.Assertions.assertNotEquals
import org.junit.jupiter.api.Assertions.assertNotNull
import org.junit.jupiter.api.Assertions.assertNull
import org.junit.jupiter.api.Assertions.assertThrows
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.core.*

/** Samples in, readings out, the same by both ways over the border. */
class BorderTest {
    private val values = tumbling(600)

    @Test
    fun `finds the hard iron, and says why not before`() {
        Compensator().use { compensator ->
            val readings = compensator.pushAll(events(values))
            assertTrue(readings.first().status is CompensationStatus.Collecting)
            assertNull(readings.first().fieldUt)
            assertEquals(CompensationStatus.Tracking, readings.last().status)
            assertEquals(50.0, readings.last().totalFieldUt!!, 2.0)
            val hardIron = compensator.calibration()!!.hardIronUt
            assertArrayEquals(HARD_IRON, doubleArrayOf(hardIron.x, hardIron.y, hardIron.z), 1.0)
            assertEquals(81, compensator.covariance()!!.size)
            assertNull(compensator.fit())
            assertTrue(compensator.coverage().share > 0.5)
        }
        Compensator(CompensationConfig(method = CompensationMethod.WINDOWED)).use { compensator ->
            compensator.pushAll(events(values))
            assertEquals(81, compensator.fit()!!.covariance.size)
        }
    }

    @Test
    fun `a whole reading of the magnetometer alone is the same over JNI and uniffi`() {
        val native = NativeCompensator(CompensationConfig())
        Compensator().use { compensator ->
            val alone = events(values).filterIsInstance<SensorSample.Magnetic>()
            val over = compensator.pushAll(alone)
            val direct = alone.map { native.push(it.sample) }
            assertEquals(direct, over)
            assertTrue(over.any { it.modelOrder != null && it.directionSigmaDeg != null && it.worstSigmaDeg != null })
        }
        native.close()
    }

    @Test
    fun `a buffer shows every field of a reading`() {
        Compensator().use { compensator ->
            val buffer = ReadingBuffer()
            for (event in events(values)) {
                if (event is SensorSample.Magnetic) {
                    with(event.sample) { compensator.push(timeNs, fieldUt.x, fieldUt.y, fieldUt.z, buffer) }
                } else {
                    compensator.pushAll(listOf(event))
                }
            }
            val shown = with(buffer) {
                MagneticReading(
                    timeNs, DeviceVector(xUt, yUt, zUt), fieldSigmaUt, DeviceVector(filteredXUt, filteredYUt, filteredZUt), totalFieldUt,
                    CompassHeading(headingDeg, headingSigmaDeg, trueHeadingDeg, inclinationDeg),
                    DeviceAttitude(attitudeW, attitudeX, attitudeY, attitudeZ, attitudeSigmaDeg), sigmaT, window, coverage,
                    directionSigmaDeg, worstSigmaDeg, modelOrder, reportedHardIronJumpUt, mode, event, status,
                )
            }
            val unknown = DeviceVector(Double.NaN, Double.NaN, Double.NaN)
            val reading = buffer.toReading()
            val spelled = reading.copy(
                filteredFieldUt = reading.filteredFieldUt ?: unknown,
                heading = with(reading.heading!!) { copy(trueHeadingDeg = trueHeadingDeg ?: Double.NaN) },
                reportedHardIronJumpUt = Double.NaN,
                sigmaT = reading.sigmaT ?: Double.NaN,
                directionSigmaDeg = reading.directionSigmaDeg ?: Double.NaN,
                worstSigmaDeg = reading.worstSigmaDeg ?: Double.NaN,
            )
            assertEquals(spelled, shown)
            assertNotNull(reading.attitude!!.sigmaDeg)
        }
    }

    @Test
    fun `a config out of range is a typed error`() {
        val error = assertThrows(MagcompException.Config::class.java) {
            Compensator(CompensationConfig(windowed = WindowedConfig(nMin = 3)))
        }
        assertEquals("windowed.n_min", error.field)
        assertTrue("at least 9" in error.text(), error.text())
    }

    @Test
    fun `the defaults are the core's`() {
        Compensator().use { plain ->
            Compensator(defaultConfig()).use { spelled ->
                assertEquals(plain.pushAll(events(values)), spelled.pushAll(events(values)))
                assertEquals(plain.keep(NOW_S), spelled.keep(NOW_S))
            }
        }
    }

    @Test
    fun `a bad sample is rejected and changes nothing`() {
        Compensator().use { compensator ->
            compensator.pushAll(events(values))
            val before = compensator.keep(NOW_S)!!
            val out = ReadingBuffer()
            compensator.push(Long.MAX_VALUE, Double.NaN, 0.0, 0.0, out)
            assertEquals(CompensationStatus.Rejected(RejectReason.NotFinite), out.status)
            compensator.push(5, 1.0, 2.0, 3.0, out)
            assertEquals(CompensationStatus.Rejected(RejectReason.TimeNotAfter(5, 600 * STEP_NS)), out.status)
            assertFalse(compensator.pushUp(5, 0.0, 0.0, 9.8), "too late")
            assertFalse(compensator.pushRotationRate(5, Double.NaN, 0.0, 0.0))
            assertEquals(before, compensator.keep(NOW_S))
        }
    }

    @Test
    fun `a saturated sample names its axis`() {
        Compensator(CompensationConfig(railUt = 1200.0)).use { compensator ->
            val at = listOf(DeviceVector(1200.0, 1.0, 2.0), DeviceVector(1.0, -1201.0, 2.0), DeviceVector(1.0, 2.0, 1300.0))
            val reasons = at.mapIndexed { k, field -> (compensator.push(MagneticSample(k + 1L, field)).status as CompensationStatus.Rejected).reason }
            val expected = listOf(Pair(DeviceAxis.X, 1200.0), Pair(DeviceAxis.Y, -1201.0), Pair(DeviceAxis.Z, 1300.0))
            assertEquals(expected.map { (axis, value) -> RejectReason.Saturated(axis, value, 1200.0) }, reasons)
            assertTrue(" y -1201.0 uT" in reasons[1].text(), reasons[1].text())
        }
    }

    @Test
    fun `a heading frame may change in the stream`() {
        val landscape = HeadingFrame(ReferenceAxis.TOP_EDGE, ScreenRotation.DEG90, 10.0)
        Compensator().use { compensator ->
            compensator.pushAll(events(values))
            compensator.setHeadingFrame(landscape)
            // after a pause: the vertical is that of the sample
            val reading = compensator.pushAll(events(tumbling(1, seed = 2), 600 * STEP_NS + PAUSE_NS)).single()
            val expected = heading(reading.fieldUt!!, up(0), landscape)!!
            assertEquals(expected.headingDeg, reading.heading!!.headingDeg)
            assertEquals(expected.trueHeadingDeg, reading.heading!!.trueHeadingDeg)
            assertNotNull(reading.heading!!.headingSigmaDeg)
            assertThrows(MagcompException.Config::class.java) { compensator.setHeadingFrame(landscape.copy(declinationDeg = 200.0)) }
        }
    }

    @Test
    fun `a constant calibration guides to the directions that are missing`() {
        ConstantField().use { session ->
            assertThrows(MagcompException.Fit::class.java) { session.finish() }
            for (k in 0 until 40) session.add(DeviceVector(values[3 * k], values[3 * k + 1], values[3 * k + 2]))
            val before = session.coverage()
            for (k in 40 until 600) session.add(DeviceVector(values[3 * k], values[3 * k + 1], values[3 * k + 2]))
            val after = session.coverage()
            assertTrue(after.unseenDirections.size < before.unseenDirections.size)
            assertEquals(600, session.orientations())
            val fit = session.finish()
            assertEquals(120.0, fit.calibration.hardIronUt.x, 1.0)
            val corrected = correct(fit.calibration, DeviceVector(values[0], values[1], values[2]))
            assertNotEquals(values[0], corrected.x)
            assertThrows(MagcompException.Rejected::class.java) { session.add(DeviceVector(Double.NaN, 0.0, 0.0)) }
            session.reset()
            assertEquals(0, session.orientations())
        }
    }

    @Test
    fun `a constant calibration that was closed says so`() {
        val session = ConstantField(samplesPerOrientation = 5)
        assertEquals(
            listOf(0, 0, 0, 0, 1, 1),
            List(6) {
                session.add(DeviceVector(1.0, 2.0, 3.0))
                session.orientations()
            },
        )
        session.close()
        session.close()
        val uses = listOf(
            { session.add(DeviceVector(1.0, 2.0, 3.0)) },
            { session.orientations() },
            { session.coverage() },
            { session.finish() },
            { session.reset() },
        )
        for (use in uses) assertThrows(MagcompException.Closed::class.java) { use() }
    }

    @Test
    fun `messages go to stderr under their tag, as many as their level lets through`() {
        fun said(level: MagcompLogLevel): String {
            // in a process of its own: the log of this one is set once
            val java = File(System.getProperty("java.home"), "bin/java").path
            val options = listOf("java.library.path", "jna.library.path").map { "-D$it=" + System.getProperty(it) }
            val command = listOf(java) + options + listOf("-cp", System.getProperty("java.class.path"), "org.magcomp.LoggingMain", level.name)
            val process = ProcessBuilder(command).redirectOutput(ProcessBuilder.Redirect.DISCARD).start()
            val text = process.errorStream.reader().readText()
            assertEquals(0, process.waitFor(), text)
            return text
        }
        val errors = said(MagcompLogLevel.ERROR)
        assertTrue(Regex("^ERROR compass-app: panicked at .*", RegexOption.MULTILINE).containsMatchIn(errors), errors)
        assertTrue("ERROR compass-app: panic caught at the border: on purpose" in errors, errors)
        assertFalse("WARN" in errors, errors)
        val warnings = said(MagcompLogLevel.WARN)
        assertTrue("WARN compass-app: the operating system's hard iron was not taken over" in warnings, warnings)
        assertFalse("compass-app" in said(MagcompLogLevel.OFF))
    }

    @Test
    fun `an event out of order, late or missing leaves the pairing of the others alone`() {
        val flat = DeviceVector(0.0, 0.0, 9.81)
        val field = { k: Int -> DeviceVector(values[3 * k], values[3 * k + 1], values[3 * k + 2]) }
        Compensator().use { compensator ->
            compensator.pushAll(events(values))
            val begin = 600 * STEP_NS + PAUSE_NS
            fun headingAfter(timeNs: Long, k: Int) = compensator.push(MagneticSample(timeNs, field(k))).heading
            compensator.pushUp(begin + 1_000_000, flat.x, flat.y, flat.z)
            val paired = headingAfter(begin + 2_000_000, 7)
            assertNotNull(paired)
            assertFalse(compensator.pushUp(begin + 500_000, 9.81, 0.0, 0.0), "older than a sample answered: not used")
            // the calibration goes on learning meanwhile
            assertEquals(paired!!.headingDeg, headingAfter(begin + 3_000_000, 7)!!.headingDeg, 0.01)
            assertNull(headingAfter(begin + 900_000_000, 7), "the latest up is too old")
        }
    }
}
