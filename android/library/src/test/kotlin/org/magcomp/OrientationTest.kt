package org.magcomp

import android.hardware.SensorManager
import java.util.Random
import kotlin.math.abs
import kotlin.math.sqrt
import kotlin.time.Duration.Companion.ZERO
import kotlinx.coroutines.flow.flow
import kotlinx.coroutines.flow.toList
import kotlinx.coroutines.runBlocking
import org.junit.jupiter.api.Assertions.assertArrayEquals
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.core.*

/** The attitude in Android's ways, against Android's own code. */
class OrientationTest {
    private val random = Random(11)

    private fun attitude(): DeviceAttitude {
        val q = DoubleArray(4) { random.nextGaussian() }
        val length = sqrt(q.sumOf { it * it })
        return DeviceAttitude(q[0] / length, q[1] / length, q[2] / length, q[3] / length, null)
    }

    @Test
    fun `the rotation matrix is that of Android's rotation vector`() {
        val theirs = FloatArray(9)
        repeat(1000) {
            val a = attitude()
            SensorManager.getRotationMatrixFromVector(theirs, floatArrayOf(a.x.toFloat(), a.y.toFloat(), a.z.toFloat(), a.w.toFloat()))
            assertArrayEquals(theirs, a.rotationMatrix(), 1e-5f)
        }
    }

    @Test
    fun `azimuth, pitch and roll are those of getOrientation, on a turned screen those after remapCoordinateSystem`() {
        val axes = mapOf(
            ScreenRotation.DEG0 to Pair(SensorManager.AXIS_X, SensorManager.AXIS_Y),
            // as Android's documentation uses it
            ScreenRotation.DEG90 to Pair(SensorManager.AXIS_Y, SensorManager.AXIS_MINUS_X),
            ScreenRotation.DEG180 to Pair(SensorManager.AXIS_MINUS_X, SensorManager.AXIS_MINUS_Y),
            ScreenRotation.DEG270 to Pair(SensorManager.AXIS_MINUS_Y, SensorManager.AXIS_X),
        )
        val (matrix, angles) = Pair(FloatArray(9), FloatArray(3))
        var compared = 0
        while (compared < 1000) {
            val a = attitude()
            for ((rotation, axis) in axes) {
                assertTrue(SensorManager.remapCoordinateSystem(a.rotationMatrix(), axis.first, axis.second, matrix))
                SensorManager.getOrientation(matrix, angles)
                // near the vertical azimuth and roll are lost in Android's floats
                if (abs(angles[1]) > 1.4) continue
                val ours = a.orientation(rotation)
                for ((one, other) in listOf(ours.azimuthDeg, ours.pitchDeg, ours.rollDeg).zip(angles.toList())) {
                    assertEquals(0.0, Math.IEEEremainder(one - Math.toDegrees(other.toDouble()), 360.0), 1e-3, "$rotation: $ours")
                }
                if (rotation == ScreenRotation.DEG0) assertEquals(ours.toString(), a.orientation().toString())
                compared += 1
            }
        }
        // straight up
        assertEquals(-90.0, DeviceAttitude(sqrt(0.5), sqrt(0.5), 0.0, 0.0, null).orientation().pitchDeg, 1e-6)
    }

    @Test
    fun `an attitude's azimuth is the heading of the top edge`() = runBlocking {
        val source = object : FlowSource() {
            override fun played() = flow { events(tumbling(1500)).forEach { emit(it) } }
        }
        fun compass() = Compass(source, CompensationConfig(heading = HeadingConfig(axis = ReferenceAxis.TOP_EDGE)), grace = ZERO).apply { declinationDeg = 3.0 }
        // as many of them as come: what is slower sees the latest alone
        val readings = compass().headings().toList().filter { it.attitude != null && it.headingDeg != null }
        val level = readings.filter { abs(it.attitude!!.orientation().pitchDeg) < 60 }
        assertTrue(level.size > 20, "${level.size}")
        for (reading in level) {
            val off = Math.IEEEremainder(reading.headingDeg!! - reading.attitude!!.orientation().azimuthDeg, 360.0)
            assertEquals(0.0, off, 3.0 + 2 * reading.headingSigmaDeg!!, "$reading")
        }
        val one = readings.last()
        val (whole, first) = compass().readings().toList().run { last() to first() }
        val heading = whole.reading.heading!!
        assertEquals(heading.headingDeg, one.headingDeg!!, 1e-9)
        assertEquals(heading.headingSigmaDeg!!, one.headingSigmaDeg!!, 1e-6)
        with(one.attitude!!) { for ((a, b) in listOf(w, x, y, z).zip(with(whole.reading.attitude!!) { listOf(w, x, y, z) })) assertEquals(b, a, 1e-9) }
        assertEquals(whole.reading.attitude!!.sigmaDeg!!, one.attitude!!.sigmaDeg!!, 1e-6)
        assertEquals("${one.attitude!!.orientation()}", "${one.orientation}")
        assertEquals(0.0, Math.IEEEremainder(one.trueHeadingDeg!! - one.headingDeg!! - 3.0, 360.0), 1e-9)
        assertEquals(Pair(whole.reading.timeNs, whole.reading.status), Pair(one.timeNs, one.status))
        assertTrue("give or take" in one.spoken(englishResources()))
        // one that an app makes of records
        val made = whole.run { CompensatedReading(reading, sample, unseenDirections, droppedBefore, sensors, storeError, headingAid, stream) }
        assertEquals("$whole", "$made")
        assertEquals(heading, made.headingOn(ScreenRotation.DEG90))
        assertTrue("$whole" != "$first" && "headingDeg=${one.headingDeg}" in "$one", "$one")
    }
}
