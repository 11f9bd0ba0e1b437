@file:JvmName("CalibrationJson")

package org.magcomp.core

import org.json.JSONArray
import org.json.JSONException
import org.json.JSONObject

/**
 * Reads the calibration that the command `magcomp replay --calibration OUT.json` writes: `soft_iron`, the nine elements of the
 * symmetric matrix M; `hard_iron_ut`, the three components of b, microtesla; `field_strength_ut`, microtesla. It passes over other names
 * in the text, the covariance too.
 *
 * The result can be [CompensationConfig.initial] or go to [Compensator.adopt].
 *
 * @throws MagcompException.Calibration when the text is no such JSON, or the numbers are no calibration
 */
@JvmName("read")
@Throws(MagcompException::class)
public fun calibrationFromJson(json: String): MagnetometerCalibration {
    val calibration = try {
        val read = JSONObject(json)
        val m = read.numbers("soft_iron", 9)
        val b = read.numbers("hard_iron_ut", 3)
        for ((one, other) in listOf(1 to 3, 2 to 6, 5 to 7)) {
            if (m[one] != m[other]) throw JSONException("soft_iron is not symmetric")
        }
        val softIron = SoftIron(xx = m[0], yy = m[4], zz = m[8], xy = m[1], xz = m[2], yz = m[5])
        MagnetometerCalibration(softIron, DeviceVector(b[0], b[1], b[2]), read.getDouble("field_strength_ut"))
    } catch (error: JSONException) {
        throw MagcompException.Calibration("no calibration of magcomp replay: ${error.message}")
    }
    // the core refuses what is none
    correct(calibration, DeviceVector(0.0, 0.0, 0.0))
    return calibration
}

private fun JSONObject.numbers(name: String, count: Int): List<Double> {
    val array: JSONArray = getJSONArray(name)
    if (array.length() != count) throw JSONException("$name has ${array.length()} numbers, not $count")
    return List(count) { array.getDouble(it) }
}
