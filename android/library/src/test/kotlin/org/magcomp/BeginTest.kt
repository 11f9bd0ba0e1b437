package org.magcomp

import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertNotEquals
import org.junit.jupiter.api.Assertions.assertNull
import org.junit.jupiter.api.Assertions.assertThrows
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.core.*

/** A stream that does not begin from nothing: a kept calibration, an adopted one, the operating system's hard iron. */
class BeginTest {
    private val values = tumbling(600)

    @Test
    fun `a kept calibration is in force again, less sure with its age, in a stream that goes on`() {
        val all = events(values)
        Compensator().use { first ->
            assertNull(first.keep(NOW_S), "nothing was learned")
            first.pushAll(all)
            val text = first.keep(NOW_S)!!
            val sigmas = listOf(60L, 3600L, 86_400L, null).map { age ->
                Compensator().use { second ->
                    second.setHeadingFrame(HeadingFrame(ReferenceAxis.TOP_EDGE, ScreenRotation.DEG90, 3.0))
                    second.push(MagneticSample(STEP_NS, DeviceVector(1.0, 2.0, 3.0)))
                    second.adoptKept(text, age?.let { NOW_S + it })
                    assertEquals(first.calibration()!!.hardIronUt, second.calibration()!!.hardIronUt)
                    assertNull(second.keep(NOW_S), "nothing was learned since")
                    val rejected = second.push(MagneticSample(STEP_NS, DeviceVector(1.0, 2.0, 3.0)))
                    assertTrue((rejected.status as CompensationStatus.Rejected).reason is RejectReason.TimeNotAfter, "the clock goes on")
                    second.pushAll(flat(10)).single().let { reading ->
                        assertTrue(reading.heading?.let { it.trueHeadingDeg != null } ?: true, "the frame stays")
                        assertNotEquals(CompensationStatus.Tracking, reading.status)
                        reading.fieldSigmaUt ?: 1e9
                    }
                }
            }
            assertEquals(sigmas.sorted(), sigmas, "$sigmas")
            assertTrue(sigmas.first() < 10.0 && sigmas.last() > 2 * sigmas.first(), "$sigmas")
        }
    }

    @Test
    fun `a text that is damaged or newer is a typed error and changes nothing`() {
        Compensator().use { compensator ->
            compensator.pushAll(events(values))
            val text = compensator.keep(NOW_S)!!
            for (damaged in listOf("", "{}", "nonsense", text.dropLast(9), text.replaceFirst("\"learned\"", "\"luck\""))) {
                val error = assertThrows(MagcompException.KeptDamaged::class.java) { compensator.adoptKept(damaged, NOW_S) }
                assertTrue(error.why.isNotEmpty() && error.why in error.text(), error.text())
            }
            val error = assertThrows(MagcompException.KeptNewer::class.java) { compensator.adoptKept(newer(text), NOW_S) }
            assertEquals(99, error.found)
            assertEquals(text, compensator.keep(NOW_S))
        }
    }

    @Test
    fun `time that the clock does not show makes the calibration less sure`() {
        val gone = listOf(0.0, 8 * 3600.0).map { hiddenS ->
            Compensator().use { compensator ->
                compensator.pushAll(events(values))
                val gaps = compensator.gaps()
                compensator.pushGap(hiddenS)
                assertEquals(gaps + 1, compensator.gaps())
                compensator.pushAll(flat(values.size / 3)).single().fieldSigmaUt ?: 1e9
            }
        }
        assertTrue(gone[1] > 1.2 * gone[0], "$gone")
        Compensator().use {
            val error = assertThrows(MagcompException.Config::class.java) { it.pushGap(-1.0) }
            assertEquals("hidden_s", error.field)
            assertEquals(0, it.gaps())
        }
    }

    @Test
    fun `the operating system's hard iron gives readings from the first sample on`() {
        val first = MagneticSample(STEP_NS, DeviceVector(120.0, -35.0, 300.0), DeviceVector(120.0, -80.0, 300.0))
        Compensator().use { compensator ->
            val reading = compensator.push(first)
            assertEquals(DeviceVector(0.0, 45.0, 0.0), reading.fieldUt)
            assertNull(reading.reportedHardIronJumpUt)
        }
        Compensator(CompensationConfig(useReportedHardIron = false)).use { assertNull(it.push(first).fieldUt) }
    }

    @Test
    fun `an adopted calibration is as unsure as it is said to be`() {
        val first = MagneticSample(STEP_NS, DeviceVector(120.0, -35.0, 300.0))
        val calibration = MagnetometerCalibration(SoftIron(1.0, 1.0, 1.0, 0.0, 0.0, 0.0), DeviceVector(120.0, -80.0, 300.0), 45.0)
        val sigmas = listOf(3.0, 30.0).map { sigmaUt ->
            Compensator().use {
                it.adopt(calibration, sigmaUt)
                it.push(first).fieldSigmaUt!!
            }
        }
        // the sample's own strength tells one of three axes
        assertTrue(sigmas[0] in 3.0..6.0 && sigmas[1] in 20.0..60.0, "$sigmas")
        Compensator().use {
            val error = assertThrows(MagcompException.Config::class.java) { it.adopt(calibration, 0.0) }
            assertEquals("hard_iron_sigma_ut", error.field)
            assertNull(it.calibration())
        }
    }

    @Test
    fun `a jump of the operating system's hard iron is visible`() {
        Compensator().use { compensator ->
            val b = listOf(DeviceVector(1.0, 2.0, 3.0), DeviceVector(1.0, 2.0, 3.0), DeviceVector(4.0, 2.0, -1.0), null, DeviceVector(4.0, 2.0, -1.0))
            val jumps = b.mapIndexed { k, reported ->
                compensator.push(MagneticSample(k + 1L, DeviceVector(1.0 * k, 0.0, 0.0), reported)).reportedHardIronJumpUt
            }
            assertEquals(listOf(null, null, 5.0, null, null), jumps)
        }
    }
}
