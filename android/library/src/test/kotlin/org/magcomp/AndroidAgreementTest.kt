package org.magcomp

import android.hardware.GeomagneticField
import android.hardware.SensorManager
import java.util.Random
import kotlin.math.abs
import kotlin.math.sqrt
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.core.*

/** Against Android's own classes. */
class AndroidAgreementTest {
    @Test
    fun `headings agree with getRotationMatrix and getOrientation`() {
        val random = Random(7)
        // the raw field is the field: what is compared are headings
        val nothing = MagnetometerCalibration(SoftIron(1.0, 1.0, 1.0, 0.0, 0.0, 0.0), DeviceVector(0.0, 0.0, 0.0), 50.0)
        val config = CompensationConfig(method = CompensationMethod.CONSTANT, initial = nothing, heading = HeadingConfig(axis = ReferenceAxis.TOP_EDGE))
        val matrix = FloatArray(9)
        val angles = FloatArray(3)
        val out = ReadingBuffer()
        var compared = 0
        var worst = 0.0
        Compensator(config).use { compensator ->
            // each after a pause, so that the vertical is that of the sample
            while (compared < 100_000) {
                val (north, up) = attitude(random)
                // near the vertical the top edge's heading is lost in Android's floats
                if (abs(up[1]) > 0.99) continue
                // 50 uT, dip 60 degrees, north
                val magnetic = FloatArray(3) { (25.0 * north[it] - 43.30127 * up[it]).toFloat() }
                val gravity = FloatArray(3) { (9.80665 * up[it]).toFloat() }
                assertTrue(SensorManager.getRotationMatrix(matrix, null, gravity, magnetic))
                SensorManager.getOrientation(matrix, angles)
                compared += 1
                val (g, m) = Pair(vector(gravity), vector(magnetic))
                assertTrue(compensator.pushUp(compared * PAUSE_NS, g.x, g.y, g.z))
                compensator.push(compared * PAUSE_NS, m.x, m.y, m.z, out)
                val off = abs(Math.IEEEremainder(out.headingDeg - Math.toDegrees(angles[0].toDouble()), 360.0))
                assertTrue(off < 1e-3, "headings differ by $off degrees")
                worst = maxOf(worst, off)
            }
        }
        assertTrue(worst > 0.0, "compared with itself")
    }

    @Test
    fun `declination, inclination and strength agree with GeomagneticField`() {
        // mid-2024: both by the edition of 2020, ours in single precision
        assertField(1_720_000_000_000, declinationDeg = 0.02, inclinationDeg = 0.02, strengthUt = 0.02)
        // mid-2025: ours by the edition of 2025, Android's by that of 2020
        assertField(1_750_000_000_000, declinationDeg = 0.5, inclinationDeg = 0.5, strengthUt = 0.3)
    }

    private fun assertField(timeMs: Long, declinationDeg: Double, inclinationDeg: Double, strengthUt: Double) {
        for (latitude in -75..75 step 15) {
            for (longitude in -180..150 step 30) {
                val theirs = GeomagneticField(latitude.toFloat(), longitude.toFloat(), 100f, timeMs)
                val ours = geomagneticField(latitude.toDouble(), longitude.toDouble(), 100.0, timeMs)
                val place = "$latitude N $longitude E"
                assertEquals(theirs.inclination.toDouble(), ours.inclinationDeg, inclinationDeg, place)
                assertEquals(theirs.fieldStrength / 1000.0, ours.totalFieldUt, strengthUt, place)
                // an error of the field counts the more, the smaller its horizontal part
                val off = Math.IEEEremainder(ours.declinationDeg - theirs.declination, 360.0)
                assertEquals(0.0, off * minOf(1.0, theirs.horizontalStrength / 20_000.0), declinationDeg, place)
            }
        }
    }

    private fun vector(v: FloatArray) = DeviceVector(v[0].toDouble(), v[1].toDouble(), v[2].toDouble())

    /** North and up in a device frame of random attitude. */
    private fun attitude(random: Random): List<DoubleArray> {
        val q = DoubleArray(4) { random.nextGaussian() }
        val n = sqrt(q.sumOf { it * it })
        val (w, x, y, z) = q.map { it / n }
        return listOf(
            doubleArrayOf(2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
            doubleArrayOf(2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
        )
    }
}
