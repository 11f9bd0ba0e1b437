package org.magcomp

import org.json.JSONArray
import org.json.JSONObject
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertThrows
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.core.*

class CalibrationJsonTest {
    private val text = repository.resolve("tests/vectors/calibration.json").readText()

    /** The numbers stand in Rust's and Swift's tests of the same file too. */
    @Test
    fun `the command's file is read`() {
        val calibration = calibrationFromJson(text)
        assertEquals(
            SoftIron(
                xx = 1.0074739066651197,
                yy = 0.9949408198854466,
                zz = 0.9975852116805589,
                xy = 0.0010278183785302803,
                xz = 0.0033559853288960234,
                yz = -0.0005891320979764632,
            ),
            calibration.softIron,
        )
        assertEquals(DeviceVector(0.4434981867517305, 0.07810767384555047, -0.2777318011715177), calibration.hardIronUt)
        assertEquals(44.62375335464398, calibration.fieldStrengthUt)
        Compensator(CompensationConfig(initial = calibration)).use { compensator ->
            assertEquals(calibration, compensator.calibration())
        }
    }

    @Test
    fun `what is no calibration is refused and says why`() {
        val changed = { name: String, value: Any -> JSONObject(text).put(name, value).toString() }
        val cases = mapOf(
            "" to "no calibration of magcomp replay",
            "[1, 2]" to "no calibration of magcomp replay",
            changed("hard_iron_ut", JSONArray(listOf(1.0, 2.0))) to "hard_iron_ut has 2 numbers, not 3",
            changed("field_strength_ut", "strong") to "field_strength_ut",
            changed("soft_iron", JSONArray((1..9).toList())) to "soft_iron is not symmetric",
            changed("soft_iron", JSONArray(listOf(-1, 0, 0, 0, 1, 0, 0, 0, 1))) to "positive definite",
        )
        for ((json, why) in cases) {
            val error = assertThrows(MagcompException.Calibration::class.java) { calibrationFromJson(json) }
            assertTrue(why in error.text(), "$json: ${error.text()}")
        }
    }
}
