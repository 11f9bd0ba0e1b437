package org.magcomp

import android.hardware.Sensor
import android.hardware.SensorManager
import java.util.Random
import java.util.concurrent.CopyOnWriteArrayList
import kotlin.math.abs
import kotlin.math.cos
import kotlin.math.sin
import kotlin.math.sqrt
import kotlin.time.Duration.Companion.ZERO
import kotlinx.coroutines.CompletableDeferred
import kotlinx.coroutines.cancelAndJoin
import kotlinx.coroutines.flow.flow
import kotlinx.coroutines.flow.onEach
import kotlinx.coroutines.flow.toList
import kotlinx.coroutines.launch
import kotlinx.coroutines.runBlocking
import kotlinx.coroutines.withTimeout
import kotlinx.coroutines.yield
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertFalse
import org.junit.jupiter.api.Assertions.assertNotEquals
import org.junit.jupiter.api.Assertions.assertNotNull
import org.junit.jupiter.api.Assertions.assertNull
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.core.*

/** A compass is closed and opened again, through its store: what it says while the phone lies still. */
class SecondLaunchTest {
    private val preferences = FakePreferences()
    private val store = PreferencesStore(preferences)
    private val text: String? get() = preferences.getString("calibration", null)

    @Test
    fun `headings err as their sigma says, whatever happened to the phone meanwhile`() {
        val (learned, _) = learn()
        val cover = DeviceVector(150.0, -100.0, 300.0)
        val wrong = ArrayList<String>()
        var headings = 0
        for (offUt in listOf(0.0, 20.0, 39.0, null)) {
            for (k in 0 until PHONES) {
                preferences.edit().putString("calibration", learned).apply()
                val random = Random(100L + k)
                val direction = length(random.let { DeviceVector(it.nextGaussian(), it.nextGaussian(), it.nextGaussian()) }, 1.0)
                val off = if (offUt == null) cover else length(direction, offUt)
                val phone = Phone(k.toLong(), hardIron = HARD_IRON_UT + off).apply { layDown(23.0 * k) }
                val readings = launched(phone, 200, still = true, nowS = NOW_S + 3600)
                assertFalse(readings.any { it.reading.status == CompensationStatus.Tracking }, "$offUt, $k")
                assertEquals(learned, text, "nothing was learned")
                val heading = readings.last().reading.heading
                if (heading == null) {
                    assertNotEquals(0.0, offUt, "a heading is there")
                    continue
                }
                headings += 1
                val sigmaDeg = heading.headingSigmaDeg!!
                val errorDeg = abs(Math.IEEEremainder(heading.headingDeg - phone.headingDeg, 360.0))
                if (errorDeg > 2 * sigmaDeg) wrong += "$offUt uT: $errorDeg, $sigmaDeg deg"
                if (offUt == 0.0) assertTrue(sigmaDeg <= 10.0, "of use: $sigmaDeg")
            }
        }
        assertTrue(wrong.size <= 0.1 * 4 * PHONES, "$wrong")
        assertTrue(headings >= 2 * PHONES, "$headings headings")
    }

    @Test
    fun `it is learned again where the phone is turned, and saved then`() {
        val (learned, timeNs) = learn()
        val phone = Phone(3, hardIron = HARD_IRON_UT + DeviceVector(20.0, -10.0, 15.0), beginNs = timeNs)
        val readings = launched(phone, 3000, still = false, nowS = NOW_S + 3600)
        assertTrue(readings.any { it.reading.status == CompensationStatus.Tracking })
        assertNotEquals(learned, text)
        val again = Compensator().use { it.apply { adoptKept(text!!, NOW_S + 3600) }.calibration()!! }
        assertEquals(HARD_IRON_UT.x + 20, again.hardIronUt.x, 3.0)
    }

    @Test
    fun `the system's hard iron and what was given are never saved as learned`() {
        val given = MagnetometerCalibration(SoftIron(1.0, 1.0, 1.0, 0.0, 0.0, 0.0), HARD_IRON_UT, 47.4)
        for (config in listOf(CompensationConfig(), CompensationConfig(initial = given, useReportedHardIron = false))) {
            val phone = Phone(1, reported = HARD_IRON_UT).apply { layDown(30.0) }
            val readings = launched(phone, 2000, still = true, config = config)
            assertNotNull(readings.last().reading.heading, "it is in force")
            assertNull(text)
        }
    }

    @Test
    fun `a damaged text, or one of a newer version, is as none and is told, and the next that is learned replaces it`() {
        val (learned, _) = learn()
        for (damaged in listOf(learned.dropLast(20), newer(learned))) {
            preferences.edit().putString("calibration", damaged).apply()
            val resting = launched(Phone(2).apply { layDown(10.0) }, 50, still = true).last()
            assertNull(resting.reading.fieldUt)
            val expected = if (damaged == newer(learned)) MagcompException.KeptNewer::class else MagcompException.KeptDamaged::class
            assertEquals(expected, resting.storeError!!::class)
            assertEquals(damaged, text, "not overwritten by what was not learned")
            assertNull(launched(Phone(2), 3000, still = false).last().storeError)
            assertTrue(text!!.startsWith("{\"magcomp_calibration\":1,"), text)
        }
    }

    @Test
    fun `the system's hard iron is heard beside a kept calibration only where the system is sure of it`() {
        val (learned, _) = learn()
        val hardIron = HARD_IRON_UT + DeviceVector(22.0, -22.0, 22.0)
        fun fieldUt(reported: DeviceVector?, accuracy: Int?): DeviceVector {
            preferences.edit().putString("calibration", learned).apply()
            val phone = Phone(4, hardIron, reported).apply { layDown(120.0) }
            return launched(phone, 20, still = true, nowS = NOW_S + 3600, accuracy = accuracy).last().reading.fieldUt!!
        }
        val alone = fieldUt(null, null)
        assertEquals(alone, fieldUt(hardIron, null))
        assertEquals(alone, fieldUt(hardIron, SensorManager.SENSOR_STATUS_ACCURACY_MEDIUM))
        val sure = fieldUt(hardIron, SensorManager.SENSOR_STATUS_ACCURACY_HIGH)
        fun off(field: DeviceVector) = (field + Phone(4).apply { layDown(120.0) }.field * -1.0).length()
        assertTrue(off(sure) < 0.75 * off(alone), "${off(sure)} ${off(alone)}")
    }

    @Test
    fun `the system's hard iron is heard where the kept calibration was refuted, and of a source that knows no sensors`(): Unit = runBlocking {
        val (learned, _) = learn()
        val cover = DeviceVector(150.0, -100.0, 300.0)
        fun fieldUt(reported: DeviceVector?): DeviceVector? {
            preferences.edit().putString("calibration", learned).apply()
            val phone = Phone(4, HARD_IRON_UT + cover, reported).apply { layDown(120.0) }
            return launched(phone, 200, still = true, nowS = NOW_S + 3600, accuracy = SensorManager.SENSOR_STATUS_ACCURACY_MEDIUM).last().reading.fieldUt
        }
        assertNull(fieldUt(null), "the data show one that is refuted")
        assertNotNull(fieldUt(HARD_IRON_UT + cover))

        val hardIron = HARD_IRON_UT + DeviceVector(22.0, -22.0, 22.0)
        suspend fun played(reported: DeviceVector?): DeviceVector {
            preferences.edit().putString("calibration", learned).apply()
            val phone = Phone(4, hardIron, reported).apply { layDown(120.0) }
            val events = (1..20).flatMap { phone.advance(still = true) }
            return flow { events.forEach { emit(it) } }.compensated(store = store).toList().last().reading.fieldUt!!
        }
        assertNotEquals(played(null), played(hardIron))
    }

    @Test
    fun `beside a given calibration the system's hard iron is heard where the system is sure of it`() {
        val config = CompensationConfig(initial = MagnetometerCalibration(SoftIron(1.0, 1.0, 1.0, 0.0, 0.0, 0.0), HARD_IRON_UT, 47.4))
        val hardIron = HARD_IRON_UT + DeviceVector(22.0, -22.0, 22.0)
        fun fieldUt(reported: DeviceVector?, accuracy: Int) =
            launched(Phone(4, hardIron, reported).apply { layDown(120.0) }, 20, still = true, config = config, accuracy = accuracy).last().reading.fieldUt!!
        val alone = fieldUt(null, SensorManager.SENSOR_STATUS_ACCURACY_MEDIUM)
        assertEquals(alone, fieldUt(hardIron, SensorManager.SENSOR_STATUS_ACCURACY_MEDIUM))
        assertNotEquals(alone, fieldUt(hardIron, SensorManager.SENSOR_STATUS_ACCURACY_HIGH))
    }

    @Test
    fun `a source whose times begin again keeps what was in force, learned or not`() {
        val (learned, _) = learn()
        preferences.edit().putString("calibration", learned).apply()
        var nowS = NOW_S + 3600
        val resting = Phone(5).apply { layDown(80.0) }
        val events = (1..150).flatMap { resting.advance(still = true) }
        val source = object : FlowSource() {
            override fun played() = flow { events.forEach { emit(it) } }
        }
        val compass = Compass(source, store = store, grace = ZERO).apply { unixTimeS = { nowS } }
        compass.declinationDeg = 2.0
        runBlocking {
            val first = compass.readings().toList().last().reading
            nowS += 60
            val again = compass.readings().toList()
            assertTrue(again.none { it.reading.status is CompensationStatus.Rejected })
            val heading = again.last().reading.heading!!
            assertEquals(first.heading!!.headingSigmaDeg!!, heading.headingSigmaDeg!!, 1.0)
            assertEquals(trueHeadingDeg(heading.headingDeg, 2.0), heading.trueHeadingDeg, "the frame stays")
        }
        assertEquals(learned, text)

        val turned = Phone(6)
        val moving = (1..3000).flatMap { turned.advance(still = false) }
        // the second sample waits until the first reading was seen: a collector that is slow loses none of it
        var isSeen = CompletableDeferred<Unit>()
        val played = object : FlowSource() {
            override fun played() = flow {
                moving.forEachIndexed { k, event ->
                    if (k == 3) isSeen.await()
                    emit(event)
                }
            }
        }
        val other = Compass(played, grace = ZERO).apply { unixTimeS = { nowS } }
        suspend fun first(): MagneticReading {
            isSeen = CompletableDeferred()
            return other.readings().onEach { isSeen.complete(Unit) }.toList().first().reading
        }
        runBlocking {
            first()
            val soon = first()
            nowS += 7 * 86_400
            val late = first()
            assertTrue(soon.fieldSigmaUt!! < 6.0, "${soon.fieldSigmaUt}")
            assertTrue((late.fieldSigmaUt ?: 1e9) > 2 * soon.fieldSigmaUt!!, "${late.fieldSigmaUt} after a week, ${soon.fieldSigmaUt} at once")
        }
    }

    /** The text that a first launch keeps, and when its last sample was. */
    private fun learn(): Pair<String, Long> {
        val phone = Phone(0)
        val last = launched(phone, 3000, still = false).last()
        assertEquals(CompensationStatus.Tracking, last.reading.status)
        return Pair(text!!, last.sample.timeNs)
    }

    /** The readings of one launch of an app. */
    private fun launched(
        phone: Phone,
        samples: Int,
        still: Boolean,
        nowS: Long = NOW_S,
        config: CompensationConfig = CompensationConfig(),
        accuracy: Int? = null,
    ): List<CompensatedReading> = runBlocking {
        val sensors = FakeSensorManager(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, Sensor.TYPE_GRAVITY, Sensor.TYPE_GYROSCOPE)
        val compass = Compass(sensors.source(), config, store, grace = ZERO).apply { unixTimeS = { nowS } }
        val readings = CopyOnWriteArrayList<CompensatedReading>()
        val app = launch { compass.readings().collect { readings += it } }
        withTimeout(120_000) { while (sensors.registrations.size < 3) yield() }
        accuracy?.let { sensors.tell(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, it) }
        repeat(samples) { phone.advance(still).forEach(sensors::deliver) }
        withTimeout(120_000) { while (readings.lastOrNull()?.sample?.timeNs != phone.timeNs) yield() }
        app.cancelAndJoin()
        readings
    }

    private companion object {
        const val PHONES = 16
    }
}

val HARD_IRON_UT = DeviceVector(HARD_IRON[0], HARD_IRON[1], HARD_IRON[2])

operator fun DeviceVector.plus(other: DeviceVector) = DeviceVector(x + other.x, y + other.y, z + other.z)

operator fun DeviceVector.times(factor: Double) = DeviceVector(x * factor, y * factor, z * factor)

fun DeviceVector.length() = sqrt(x * x + y * y + z * z)

private fun length(v: DeviceVector, length: Double) = v * (length / v.length())

/** A phone with a gyroscope whose sensors have noise; turned about all axes, or lying still. */
class Phone(
    seed: Long,
    private val hardIron: DeviceVector = HARD_IRON_UT,
    private val reported: DeviceVector? = null,
    beginNs: Long = 0,
) {
    private val random = Random(seed)

    /** The world's north and up in the device. */
    private var north = DeviceVector(0.0, 1.0, 0.0)
    private var up = DeviceVector(0.0, 0.0, 1.0)
    var timeNs = beginNs
        private set

    /** Of the top edge, where it lies flat. */
    var headingDeg = 0.0
        private set

    /** The Earth's in the device, uT. */
    val field: DeviceVector get() = north * 21.0 + up * -43.0

    fun layDown(headingDeg: Double) {
        this.headingDeg = headingDeg
        val angle = Math.toRadians(headingDeg)
        north = DeviceVector(-sin(angle), cos(angle), 0.0)
        up = DeviceVector(0.0, 0.0, 1.0)
    }

    /** The next 10 ms. */
    fun advance(still: Boolean): List<SensorSample> {
        val t = timeNs * 1e-9
        val rate = if (still) DeviceVector(0.0, 0.0, 0.0) else DeviceVector(sin(0.9 * t), cos(1.3 * t + 1), 0.8 * sin(0.5 * t))
        north = seen(north, rate)
        up = seen(up, rate)
        timeNs += STEP_NS
        return listOf(
            SensorSample.RotationRate(RotationRateSample(timeNs, noisy(rate, 0.003))),
            SensorSample.Up(UpSample(timeNs, noisy(up * 9.81, 0.05))),
            SensorSample.Magnetic(MagneticSample(timeNs, noisy(field + hardIron, 0.5), reported)),
        )
    }

    private fun noisy(v: DeviceVector, noise: Double) =
        v + DeviceVector(random.nextGaussian(), random.nextGaussian(), random.nextGaussian()) * noise

    /** A vector of the world as the device sees it after turning at a rate for 10 ms: Rodrigues' formula. */
    private fun seen(v: DeviceVector, rate: DeviceVector): DeviceVector {
        val speed = rate.length()
        if (speed == 0.0) return v
        val (x, y, z) = rate * (1 / speed)
        val (c, s) = Pair(cos(0.01 * speed), sin(0.01 * speed))
        val cross = DeviceVector(y * v.z - z * v.y, z * v.x - x * v.z, x * v.y - y * v.x)
        return v * c + cross * -s + DeviceVector(x, y, z) * ((x * v.x + y * v.y + z * v.z) * (1 - c))
    }
}
