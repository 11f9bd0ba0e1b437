package org.magcomp

import android.hardware.Sensor
import android.location.Location
import android.os.Build
import android.view.Surface
import java.util.concurrent.CompletableFuture
import java.util.concurrent.TimeUnit
import kotlin.time.Duration.Companion.milliseconds
import kotlinx.coroutines.flow.first
import kotlinx.coroutines.launch
import kotlinx.coroutines.runBlocking
import kotlinx.coroutines.withTimeout
import kotlinx.coroutines.yield
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertNotEquals
import org.junit.jupiter.api.Assertions.assertNotNull
import org.junit.jupiter.api.Assertions.assertThrows
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.core.*

/** The constructors an app uses, over a stand-in of its context. */
class AppTest {
    private val sensors =
        FakeSensorManager(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, Sensor.TYPE_GRAVITY, Sensor.TYPE_GYROSCOPE)

    @Test
    fun `a compass of an app asks for 100 Hz at once, and keeps its calibration`(): Unit = runBlocking {
        val app = FakeApp(sensors)
        val activity = FakeActivity(app)
        val events = events(tumbling(600))
        val collecting = launch { Compass(activity).readings().first { it.sample.timeNs == events.last().timeNs } }
        withTimeout(120_000) { while (sensors.registrations.size < 3) yield() }
        assertTrue(sensors.registrations.all { it.periodUs == 10_000 && it.latencyUs == 0 }, "${sensors.registrations}")
        events.forEach(sensors::deliver)
        // what the last events wait for
        val later = SensorSample.Up(UpSample(events.last().timeNs + 50_000_000, DeviceVector(0.0, 0.0, 9.81)))
        sensors.deliver(later)
        collecting.join()
        withTimeout(120_000) { while (app.preferences.getString("calibration", null) == null) yield() }
        withTimeout(120_000) { while (sensors.registrations.isNotEmpty()) kotlinx.coroutines.delay(10) }
        assertEquals(0, sensors.threads, "its thread has ended")

        // the next launch, whatever its options and its config
        val options = SensorOptions(rateHz = 50, gyroscope = false)
        val next = Compass(activity, options, CompensationConfig(heading = HeadingConfig(axis = ReferenceAxis.CAMERA)))
        val first = launch {
            val reading = next.readings().first()
            assertNotNull(reading.reading.fieldUt, "calibrated at once")
            assertEquals(Sensor.TYPE_GRAVITY, reading.sensors!!.up!!.type)
        }
        withTimeout(120_000) { while (sensors.registrations.size < 2) yield() }
        assertEquals(listOf(20_000, 20_000), sensors.registrations.map { it.periodUs })
        sensors.deliver(events.last())
        sensors.deliver(later)
        first.join()
    }

    @Test
    fun `above 200 Hz an app needs its permission, up to it none`() {
        fun asked(rateHz: Int, vararg permissions: String, targetSdk: Int = 31) = runBlocking {
            val app = FakeApp(sensors, permissions.toSet(), targetSdk)
            val source = SensorManagerSource(app, SensorOptions(rateHz, holdS = 0.0))
            val collecting = launch { source.samples().first() }
            withTimeout(120_000) { while (sensors.registrations.isEmpty() && collecting.isActive) yield() }
            sensors.deliver(events(tumbling(1)).first())
            collecting.join()
        }
        asked(200)
        asked(201, "android.permission.HIGH_SAMPLING_RATE_SENSORS")
        val error = assertThrows(SensorException.PermissionMissing::class.java) { asked(201, "android.permission.CAMERA") }
        assertTrue("HIGH_SAMPLING_RATE_SENSORS" in error.message!!, error.message)
        // an app for an older Android than 12 needs none on any
        asked(201, targetSdk = 30)
        val now = Build.VERSION.SDK_INT
        try {
            Build.VERSION.SDK_INT = 30 // Android 11 knows no such permission
            asked(201)
        } finally {
            Build.VERSION.SDK_INT = now
        }
        assertEquals(0, sensors.threads)
    }

    @Test
    fun `a declination out of range is refused where it is set, and the one before stays`() {
        val compass = Compass(sensors.source())
        val before = HeadingFrame(ReferenceAxis.CAMERA, ScreenRotation.DEG90, 180.0)
        compass.declinationDeg = 180.0
        for (declinationDeg in listOf(180.1, -1e9, Double.NaN)) {
            val error = assertThrows(MagcompException.Config::class.java) { compass.declinationDeg = declinationDeg }
            assertEquals("heading.declination_deg", error.field)
            assertEquals(180.0, compass.declinationDeg)
            // in the core's words
            val core = assertThrows(MagcompException.Config::class.java) {
                Compensator().use { it.setHeadingFrame(before.copy(declinationDeg = declinationDeg)) }
            }
            assertEquals(core.field to core.expected, error.field to error.expected)
        }
        for (declinationDeg in listOf(-180.0, null, 180.0)) compass.declinationDeg = declinationDeg
    }

    @Test
    fun `a grace time below 0 is refused`() {
        assertThrows(IllegalArgumentException::class.java) { Compass(sensors.source(), grace = (-1).milliseconds) }
    }

    @Test
    fun `preloading loads the native library, in the background, once`() {
        val options = listOf("java.library.path", "jna.library.path").map { "-D$it=${System.getProperty(it)}" }
        val said = inProcessOfItsOwn("org.magcomp.PreloadMain", options = options)
        assertEquals("not loaded, loaded", said.trim())
    }

    @Test
    fun `an error's message is its sentence`() {
        val error = assertThrows(MagcompException.Config::class.java) { Compensator(CompensationConfig(rangeUt = -1.0)) }
        assertEquals(error.text(), error.message)
        assertTrue("range_ut" in error.message && "=" !in error.message, error.message)
    }

    /** Android's own keeps what it is told. */
    private fun place(latitudeDeg: Double, longitudeDeg: Double, timeMs: Long, heightM: Double? = null) = Location("a test").apply {
        latitude = latitudeDeg
        longitude = longitudeDeg
        time = timeMs
        heightM?.let { altitude = it }
    }

    @Test
    fun `a place gives the declination, at any date and height`() {
        val compass = Compass(sensors.source())
        val year = 31_557_600_000
        for (timeMs in listOf(1_750_000_000_000, 1, 70 * year, Long.MAX_VALUE)) {
            compass.setPlace(place(-33.87, 151.21, timeMs, 20.0))
            assertEquals(geomagneticField(-33.87, 151.21, 20.0, timeMs).declinationDeg, compass.declinationDeg)
            assertTrue(compass.declinationDeg!! in 12.0..14.0, "${compass.declinationDeg}")
        }
        // no date is now; a height that can't be is none, and height counts
        compass.unixTimeS = { 1_750_000_000 }
        val sea = geomagneticField(70.0, -100.0, 0.0, 1_750_000_000_000).declinationDeg
        for (heightM in listOf(null, -1e9, 1e9, Double.NaN)) {
            compass.setPlace(place(70.0, -100.0, 0, heightM))
            assertEquals(sea, compass.declinationDeg)
        }
        compass.setPlace(place(70.0, -100.0, 0, 400_000.0))
        assertNotEquals(sea, compass.declinationDeg)

        val before = compass.declinationDeg
        assertThrows(MagcompException.Place::class.java) { compass.setPlace(place(91.0, 0.0, 0)) }
        assertThrows(MagcompException.Place::class.java) { compass.setPlace(place(0.0, Double.NaN, 0)) }
        assertEquals(before, compass.declinationDeg)
    }

    @Test
    fun `a screen's rotation as Android counts it`() {
        val expected = mapOf(
            Surface.ROTATION_0 to ScreenRotation.DEG0,
            Surface.ROTATION_90 to ScreenRotation.DEG90,
            Surface.ROTATION_180 to ScreenRotation.DEG180,
            Surface.ROTATION_270 to ScreenRotation.DEG270,
        )
        for ((android, ours) in expected) {
            assertEquals(ours, screenRotation(android))
        }
        for (none in listOf(-1, 4, 90)) assertThrows(IllegalArgumentException::class.java) { screenRotation(none) }
    }

    @Test
    fun `an app without the native library is told so, whatever it calls first, and again`() {
        for (first in WithoutLibrary.calls.keys) {
            val (listener, said) = inProcessOfItsOwn("org.magcomp.WithoutLibrary", first, options = listOf("-Djava.library.path=/nowhere")).trim().lines()
            assertEquals(List(2 * WithoutLibrary.calls.size + 1) { "NativeLibraryException" }, said.split(" "), first)
            assertEquals("NativeLibraryException: magcomp's native library can't be loaded (no magcomp_ffi in java.library.path: " +
                "/nowhere); the app must hold it for this phone's ABI", listener)
        }
    }
}

/** Run in a process of its own: what a listener and every entry say. */
object WithoutLibrary {
    val calls = mapOf<String, () -> Any>(
        "Compensator" to { Compensator() },
        "ConstantField" to { ConstantField() },
        "ReadingBuffer" to { ReadingBuffer() },
        "geomagneticField" to { geomagneticField(48.86, 2.35, 35.0, 1_750_000_000_000) },
        "defaultConfig" to { defaultConfig() },
        "text" to { CompensationStatus.Tracking.text() },
        "MagcompException.text" to { MagcompException.Closed().text() },
        "correct" to {
            val nowhere = DeviceVector(0.0, 0.0, 0.0)
            correct(MagnetometerCalibration(SoftIron(1.0, 1.0, 1.0, 0.0, 0.0, 0.0), nowhere, 50.0), nowhere)
        },
        "heading" to {
            val frame = HeadingFrame(ReferenceAxis.AUTO, ScreenRotation.DEG0, null)
            heading(DeviceVector(0.0, 20.0, -40.0), DeviceVector(0.0, 0.0, 1.0), frame) ?: "none"
        },
        "calibrationFromJson" to {
            calibrationFromJson("""{"soft_iron": [1, 0, 0, 0, 1, 0, 0, 0, 1], "hard_iron_ut": [0, 0, 0], "field_strength_ut": 50}""")
        },
        "startLogging" to { startLogging("tag", MagcompLogLevel.WARN) },
    )

    @JvmStatic
    fun main(arguments: Array<String>) {
        val said = (listOf(arguments.single()) + calls.keys + calls.keys).map { runCatching(calls.getValue(it)).exceptionOrNull()?.javaClass?.simpleName }
        val ended = CompletableFuture<Exception?>()
        val listener = object : CompassReadingListener {
            override fun onReading(reading: CompensatedReading) = Unit

            override fun onEnd(error: Exception?) {
                ended.complete(error)
            }
        }
        val nothing = RecordingSource("nothing") { "t_s,mx,my,mz\n0,1,2,3\n".reader() }
        Compass(nothing).start({ it.run() }, listener)
        println(ended.get(60, TimeUnit.SECONDS)!!.let { "${it.javaClass.simpleName}: ${it.message}" })
        println(said.joinToString(" "))
    }
}
