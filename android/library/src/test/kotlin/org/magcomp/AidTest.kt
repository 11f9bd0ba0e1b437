package org.magcomp

import android.hardware.Sensor
import android.hardware.SensorManager
import android.location.Location
import android.os.Build
import kotlin.math.abs
import kotlin.math.cos
import kotlin.math.sin
import kotlin.time.Duration.Companion.ZERO
import kotlin.time.Duration.Companion.milliseconds
import kotlinx.coroutines.CoroutineScope
import kotlinx.coroutines.Dispatchers
import kotlinx.coroutines.async
import kotlinx.coroutines.cancelAndJoin
import kotlinx.coroutines.flow.first
import kotlinx.coroutines.flow.flow
import kotlinx.coroutines.flow.toList
import kotlinx.coroutines.launch
import kotlinx.coroutines.runBlocking
import kotlinx.coroutines.withTimeout
import kotlinx.coroutines.yield
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertFalse
import org.junit.jupiter.api.Assertions.assertNotNull
import org.junit.jupiter.api.Assertions.assertNull
import org.junit.jupiter.api.Assertions.assertThrows
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.core.*

/** Headings and poses from outside, as Android and ARCore have them. */
class AidTest {
    private val second = 1_000_000_000L

    /** A phone that lies flat, its top edge to the north of a field of which it hardly knows its own share, and hears of each second. */
    private fun lying(
        seconds: Int,
        offsetNs: Long = 0,
        isUpright: Boolean = false,
        aid: Compass.(elapsedNs: Long) -> Unit,
    ): List<CompensatedReading> = runBlocking {
        lateinit var compass: Compass
        val source = object : FlowSource() {
            override fun played() = flow {
                for (k in 1L..50L * seconds) {
                    val timeNs = k * second / 50
                    if (k % 50 == 0L) compass.aid(timeNs + offsetNs)
                    emit(SensorSample.RotationRate(RotationRateSample(timeNs, DeviceVector(0.0, 0.0, 0.0))))
                    // upright: what the top edge was to a phone that lies, the back camera is
                    fun turned(x: Double, ahead: Double, up: Double) = if (isUpright) DeviceVector(x, up, -ahead) else DeviceVector(x, ahead, up)
                    emit(SensorSample.Up(UpSample(timeNs, turned(0.0, 0.0, 9.81))))
                    emit(SensorSample.Magnetic(MagneticSample(timeNs, turned(0.2 * sin(k.toDouble()), 20.0, -45.0))))
                }
            }

            override fun eventTimeNs(elapsedRealtimeNs: Long) = elapsedRealtimeNs - offsetNs
        }
        val field = MagnetometerCalibration(SoftIron(1.0, 1.0, 1.0, 0.0, 0.0, 0.0), DeviceVector(0.0, 0.0, 0.0), 49.244)
        compass = Compass(source, CompensationConfig(initial = field, initialSigmaUt = 30.0), grace = ZERO)
        compass.use { compass.readings().toList() }
    }

    private fun fix(timeNs: Long, bearingDeg: Float? = 30f, speedMS: Float? = 20f, accuracyDeg: Float? = 1f) = Location("a test").apply {
        elapsedRealtimeNanos = timeNs
        bearingDeg?.let { bearing = it }
        speedMS?.let { speed = it }
        accuracyDeg?.let { bearingAccuracyDegrees = it }
    }

    private val headed = HeadingSample(0, 30.0, 5.0, NorthReference.TRUE, HELD_AHEAD)

    private fun List<CompensatedReading>.assertTurned(headingDeg: Double) {
        val last = last()
        assertEquals(HeadingAid.LEADS, last.headingAid)
        assertEquals(HeadingAid.LEADS, shown(last).headingAid)
        assertTrue(abs(last.reading.heading!!.headingDeg - headingDeg) < 6, "${last.reading.heading}")
    }

    @Test
    fun `a walker's course turns north, and without it nothing is said`() {
        val without = lying(60) { }
        assertTrue(without.all { it.headingAid == null })
        assertTrue(abs(Math.IEEEremainder(without.last().reading.heading!!.headingDeg, 360.0)) < 2)
        assertNull(shown(without.last()).headingAid)
        val taken = mutableListOf<Boolean>()
        lying(60) { taken += aid(fix(it), HELD_AHEAD) }.assertTurned(30.0)
        assertEquals(List(60) { true }, taken)
        // held up, it is the camera that points ahead
        lying(60, isUpright = true) { aid(fix(it), HELD_AHEAD) }.assertTurned(30.0)
    }

    @Test
    fun `the times of an aid are those of the phone, whatever the sensors' clock is`() {
        lying(60, offsetNs = 7000 * second) { aid(fix(it), HELD_AHEAD) }.assertTurned(30.0)
        lying(60, offsetNs = 7000 * second) { aid(headed.copy(timeNs = it, sigmaDeg = 3.0)) }.assertTurned(30.0)
        lying(60, offsetNs = 7000 * second) { aid(arCoreAttitude(it, eastUpSouth(30.0), 1.0)) }.assertTurned(30.0)
    }

    @Test
    fun `what help was worth is forgotten where a source begins again, also before its first good sample`(): Unit = runBlocking {
        var run = 0
        lateinit var compass: Compass
        val source = object : FlowSource() {
            override fun played() = flow {
                run += 1
                if (run == 2) emit(SensorSample.Magnetic(MagneticSample(1, DeviceVector(Double.NaN, 0.0, 0.0))))
                for (k in 1L..500) {
                    val timeNs = k * second / 50
                    if (run == 1 && k % 50 == 0L) compass.aid(headed.copy(timeNs = timeNs))
                    emit(SensorSample.RotationRate(RotationRateSample(timeNs, DeviceVector(0.0, 0.0, 0.0))))
                    emit(SensorSample.Up(UpSample(timeNs, DeviceVector(0.0, 0.0, 9.81))))
                    emit(SensorSample.Magnetic(MagneticSample(timeNs, DeviceVector(0.2 * sin(k.toDouble()), 20.0, -45.0))))
                }
            }
        }
        val field = MagnetometerCalibration(SoftIron(1.0, 1.0, 1.0, 0.0, 0.0, 0.0), DeviceVector(0.0, 0.0, 0.0), 49.244)
        compass = Compass(source, CompensationConfig(initial = field, initialSigmaUt = 30.0), grace = ZERO)
        assertNotNull(compass.readings().toList().last().headingAid)
        assertTrue(compass.readings().toList().all { it.headingAid == null })
    }

    @Test
    fun `a course shows the declination`() {
        var found: FoundDeclination? = null
        val last = lying(60) {
            aid(fix(it), HELD_AHEAD)
            found = foundDeclination()
        }.last().reading.heading!!
        assertTrue(found!!.sigmaDeg > 1, "$found")
        assertEquals(last.headingDeg + found!!.declinationDeg, last.trueHeadingDeg!!, 0.5)
    }

    @Test
    fun `a fix that tells no course is left out`() {
        val vehicle = HeadedAxis.Vehicle
        for (says in listOf(fix(1), fix(1, speedMS = 3f), fix(1, accuracyDeg = null))) assertNotNull(courseOf(says, vehicle))
        for (nothing in listOf(fix(1, bearingDeg = null), fix(1, speedMS = null), fix(1, speedMS = 2.9f), fix(1, speedMS = Float.NaN))) {
            assertNull(courseOf(nothing, vehicle))
            val taken = mutableListOf<Boolean>()
            lying(1) { taken += aid(nothing, vehicle) }
            assertEquals(listOf(false), taken)
        }
        assertNotNull(courseOf(fix(1, speedMS = 0.8f), HELD_AHEAD))
        assertNull(courseOf(fix(1, speedMS = 0.6f), HELD_AHEAD))
        val course = courseOf(fix(5, 350f), vehicle)!!
        assertEquals(HeadingSample(5, 350.0, course.sigmaDeg, NorthReference.TRUE, vehicle), course)
    }

    @Test
    fun `the sigma of a course is what the phone tells, else what its speed makes it`() {
        fun sigmaDeg(place: Location, headed: HeadedAxis = HeadedAxis.Vehicle) = courseOf(place, headed)!!.sigmaDeg
        assertEquals(Math.hypot(6.0, 2.0), sigmaDeg(fix(1, accuracyDeg = 6f)), 1e-9)
        assertEquals(Math.hypot(6.0, 10.0), sigmaDeg(fix(1, accuracyDeg = 6f), HELD_AHEAD), 1e-9)
        val bySpeed = Math.hypot(Math.toDegrees(Math.atan2(0.5, 5.0)), 2.0)
        assertEquals(bySpeed, sigmaDeg(fix(1, speedMS = 5f, accuracyDeg = null)), 1e-9)
        assertEquals(bySpeed, sigmaDeg(fix(1, speedMS = 5f, accuracyDeg = 0f)), 1e-9)
        assertEquals(180.0, sigmaDeg(fix(1, accuracyDeg = 180f)))
        val now = Build.VERSION.SDK_INT
        try {
            Build.VERSION.SDK_INT = 25 // Android 7 has no such method
            assertEquals(bySpeed, sigmaDeg(fix(1, speedMS = 5f, accuracyDeg = 6f)), 1e-9)
        } finally {
            Build.VERSION.SDK_INT = now
        }
    }

    /** ARCore's quaternion of a phone that lies flat, its top edge turned clockwise from north: the world's axes are east, up, south. */
    private fun eastUpSouth(headingDeg: Double): FloatArray {
        val (a, c) = Pair(Math.toRadians(-headingDeg) / 2, Math.sqrt(0.5))
        // first about its own z, then from z up to y up
        return floatArrayOf((-c * cos(a)).toFloat(), (c * sin(a)).toFloat(), (c * sin(a)).toFloat(), (c * cos(a)).toFloat())
    }

    @Test
    fun `a pose of ARCore is Android's rotation vector`() {
        for (headingDeg in listOf(0.0, 30.0, 200.0)) {
            val (matrix, angles) = Pair(FloatArray(9), FloatArray(3))
            val told = arCoreAttitude(1, eastUpSouth(headingDeg))
            SensorManager.getRotationMatrixFromVector(matrix, with(told) { floatArrayOf(x.toFloat(), y.toFloat(), z.toFloat(), w.toFloat()) })
            SensorManager.getOrientation(matrix, angles)
            assertEquals(0.0, Math.IEEEremainder(Math.toDegrees(angles[0].toDouble()) - headingDeg, 360.0), 0.01)
            assertEquals(1f, matrix[8], 1e-6f)
            assertEquals(WorldYaw.Relative, told.yaw)
        }
        // tilted: the camera looks north while the top edge points up, so device x, y, z are east, up, south
        val upright = arCoreAttitude(1, floatArrayOf(0f, 0f, 0f, 1f), 3.0)
        val matrix = FloatArray(9)
        SensorManager.getRotationMatrixFromVector(matrix, with(upright) { floatArrayOf(x.toFloat(), y.toFloat(), z.toFloat(), w.toFloat()) })
        for ((k, value) in listOf(1f, 0f, 0f, 0f, 0f, -1f, 0f, 1f, 0f).withIndex()) assertEquals(value, matrix[k], 1e-6f, "$k")
        assertEquals(WorldYaw.Absolute(3.0, NorthReference.TRUE), upright.yaw)
        assertThrows(IllegalArgumentException::class.java) { arCoreAttitude(1, FloatArray(3)) }
        // of no yaw: nothing about north
        assertTrue(lying(5) { aid(arCoreAttitude(it, eastUpSouth(30.0))) }.all { it.headingAid == null })
    }

    @Test
    fun `what can't be is refused as the core refuses it, before there is an estimator`() {
        val nan = Double.NaN
        fun device(x: Double) = HeadedAxis.Device(DeviceVector(x, 0.0, 0.0))
        val headings = listOf(
            headed.copy(headingDeg = nan), headed.copy(headingDeg = 360.1), headed.copy(headingDeg = -361.0), headed.copy(sigmaDeg = 0.0),
            headed.copy(sigmaDeg = -1.0), headed.copy(sigmaDeg = 180.1), headed.copy(sigmaDeg = Double.POSITIVE_INFINITY),
            headed.copy(axis = device(0.0)), headed.copy(axis = device(nan)), headed.copy(headingDeg = nan, axis = HeadedAxis.Vehicle),
        )
        val pose = AttitudeSample(0, 1.0, 0.0, 0.0, 0.0, WorldYaw.Relative)
        fun absolute(sigmaDeg: Double) = pose.copy(yaw = WorldYaw.Absolute(sigmaDeg, NorthReference.MAGNETIC))
        val attitudes = listOf(pose.copy(w = 0.0), pose.copy(x = nan), pose.copy(z = Double.POSITIVE_INFINITY), absolute(0.0), absolute(181.0), absolute(nan))
        val compass = Compass(RecordingSource("nothing") { "t_s,mx,my,mz\n".reader() })
        fun reason(call: () -> Unit) = assertThrows(MagcompException.EventRejected::class.java, call).reason
        for (heading in headings) {
            val core = Compensator().use { reason { it.pushHeading(heading) } }
            assertEquals(core, reason { compass.aid(heading) }, "$heading")
        }
        for (attitude in attitudes) {
            val core = Compensator().use { reason { it.pushAttitude(attitude) } }
            assertEquals(core, reason { compass.aid(attitude) }, "$attitude")
        }
        for (good in listOf(-360.0, 360.0)) Compensator().use { assertTrue(it.pushHeading(headed.copy(headingDeg = good, sigmaDeg = 180.0))) }
        // nobody collects
        assertFalse(compass.aid(headed))
        assertFalse(compass.aid(pose))
        assertFalse(compass.aid(fix(1), HELD_AHEAD))
        assertNull(compass.foundDeclination())
        compass.close()
        assertThrows(MagcompException.Closed::class.java) { compass.aid(headed) }
        assertThrows(MagcompException.Closed::class.java) { compass.aid(fix(1, speedMS = 0f), HELD_AHEAD) }
        assertThrows(MagcompException.Closed::class.java) { compass.foundDeclination() }
    }

    @Test
    fun `nothing is taken once the last collector has left, in the grace time or after it`(): Unit = runBlocking {
        for (graceMs in listOf(0L, 600_000L)) {
            val sensors = FakeSensorManager(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, Sensor.TYPE_GRAVITY, Sensor.TYPE_GYROSCOPE)
            val compass = Compass(sensors.source(), grace = graceMs.milliseconds)
            val phone = Phone(1)
            val collecting = CoroutineScope(Dispatchers.Unconfined).launch { compass.readings().collect { } }
            sensors.registered(3)
            repeat(1500) {
                val events = phone.advance(still = false)
                sensors.continuousNs = phone.timeNs
                events.forEach(sensors::deliver)
            }
            assertTrue(compass.aid(headed.copy(timeNs = phone.timeNs)))
            collecting.cancelAndJoin()
            assertFalse(compass.aid(headed.copy(timeNs = phone.timeNs + second / 2)))
            assertTrue(compass.kept!!.compensator.pushHeading(headed.copy(timeNs = phone.timeNs + second / 2)), "the core had not heard of it")
            compass.close()
        }
    }

    @Test
    fun `one that comes twice, late or from another clock is not taken`() {
        Compensator().use {
            it.push(MagneticSample(100 * second, DeviceVector(1.0, 2.0, 3.0)))
            assertTrue(it.pushHeading(headed.copy(timeNs = 99 * second)))
            assertFalse(it.pushHeading(headed.copy(timeNs = 99 * second)))
            assertFalse(it.pushHeading(headed.copy(timeNs = 94 * second)))
            assertFalse(it.pushHeading(headed.copy(timeNs = 200 * second)))
            assertTrue(it.pushAttitude(AttitudeSample(100 * second, 1.0, 0.0, 0.0, 0.0, WorldYaw.Relative)))
            assertFalse(it.pushAttitude(AttitudeSample(100 * second, 1.0, 0.0, 0.0, 0.0, WorldYaw.Relative)))
            assertNull(it.headingAid())
            assertNull(it.foundDeclination())
        }
    }

    @Test
    fun `a clock that sleep has held is known from the events`(): Unit = runBlocking {
        val sensors = FakeSensorManager(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, Sensor.TYPE_GRAVITY)
        val source = sensors.source()
        assertEquals(1000L, source.eventTimeNs(1000), "nothing is known")
        val collecting = async { source.samples().first { it.timeNs == 8 * second } }
        withTimeout(120_000) { while (sensors.registrations.size < 2) yield() }
        fun deliver(timeNs: Long, nowNs: Long) {
            sensors.continuousNs = nowNs
            sensors.deliver(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, timeNs, 1f, 2f, 3f)
        }
        // late by 20 ms, then by 5: that is no other clock
        deliver(5 * second, 5 * second + 20_000_000)
        deliver(6 * second, 6 * second + 5_000_000)
        assertEquals(7 * second, source.eventTimeNs(7 * second))
        collecting.cancel()
        // one that did not count an hour
        val other = FakeSensorManager(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, Sensor.TYPE_GRAVITY)
        val counting = other.source()
        val ended = async { counting.samples().first { it.timeNs == 8 * second } }
        withTimeout(120_000) { while (other.registrations.size < 2) yield() }
        other.continuousNs = 3608 * second + 5_000_000
        other.deliver(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, 8 * second, 1f, 2f, 3f)
        ended.await()
        assertEquals(10 * second, counting.eventTimeNs(3610 * second), 5e6)
    }

    private fun assertEquals(expected: Long, found: Long, within: Double) = assertTrue(abs(found - expected) <= within, "$found")
}
