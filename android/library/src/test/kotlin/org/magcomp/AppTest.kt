package org.magcomp

import android.hardware.Sensor
import android.os.Build
import java.util.concurrent.CompletableFuture
import java.util.concurrent.TimeUnit
import java.util.concurrent.atomic.AtomicInteger
import kotlinx.coroutines.flow.first
import kotlinx.coroutines.launch
import kotlinx.coroutines.runBlocking
import kotlinx.coroutines.withTimeout
import kotlinx.coroutines.yield
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertInstanceOf
import org.junit.jupiter.api.Assertions.assertNotNull
import org.junit.jupiter.api.Assertions.assertThrows
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test

/** The constructors an app uses, over a stand-in of its context. */
class AppTest {
    private val sensors =
        FakeSensorManager(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, Sensor.TYPE_GRAVITY, Sensor.TYPE_GYROSCOPE)

    @Test
    fun `a compass of an app asks for 100 Hz at once, and keeps its calibration`(): Unit = runBlocking {
        val app = FakeApp(sensors)
        val events = events(tumbling(600))
        val collecting = launch { Compass(app).readings().first { it.sample.timeNs == events.last().timeNs } }
        withTimeout(20_000) { while (sensors.registrations.size < 3) yield() }
        assertTrue(sensors.registrations.all { it.periodUs == 10_000 && it.latencyUs == 0 }, "${sensors.registrations}")
        events.forEach(sensors::deliver)
        // what the last events wait for
        val later = SensorSample.Up(UpSample(events.last().timeNs + 50_000_000, Vector3(0.0, 0.0, 9.81)))
        sensors.deliver(later)
        collecting.join()
        withTimeout(20_000) { while (app.preferences.getString("calibration", null) == null) yield() }
        withTimeout(20_000) { while (sensors.registrations.isNotEmpty()) kotlinx.coroutines.delay(10) }
        assertEquals(0, sensors.threads, "its thread has ended")

        // the next launch
        val first = launch { assertNotNull(Compass(app).readings().first().reading.fieldUt, "calibrated at once") }
        withTimeout(20_000) { while (sensors.registrations.size < 3) yield() }
        sensors.deliver(events.last())
        sensors.deliver(later)
        first.join()
    }

    @Test
    fun `above 200 Hz an app needs its permission, up to it none`() {
        fun asked(rateHz: Int, vararg permissions: String) = runBlocking {
            val source = SensorManagerSource(FakeApp(sensors, permissions.toSet()), SensorOptions(rateHz, holdS = 0.0))
            val collecting = launch { source.samples().first() }
            withTimeout(20_000) { while (sensors.registrations.isEmpty() && collecting.isActive) yield() }
            sensors.deliver(events(tumbling(1)).first())
            collecting.join()
        }
        asked(200)
        asked(201, "android.permission.HIGH_SAMPLING_RATE_SENSORS")
        val error = assertThrows(SensorException.PermissionMissing::class.java) { asked(201, "android.permission.CAMERA") }
        assertTrue("HIGH_SAMPLING_RATE_SENSORS" in error.message!!, error.message)
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
    fun `a declination out of range is refused where it is set, and the frame stays`() {
        val compass = Compass(sensors.source())
        val before = HeadingFrame(ReferenceAxis.CAMERA, ScreenRotation.DEG90, 180.0)
        compass.frame = before
        for (declinationDeg in listOf(180.1, -1e9, Double.NaN)) {
            val error = assertThrows(MagcompException.Config::class.java) { compass.frame = before.copy(declinationDeg = declinationDeg) }
            assertEquals("heading.declination_deg", error.field)
            assertEquals(before, compass.frame)
            assertThrows(MagcompException.Config::class.java) { compass.declinationDeg = declinationDeg }
            assertEquals(before, compass.frame)
            // in the core's words
            val core = assertThrows(MagcompException.Config::class.java) {
                Compensator().use { it.setHeadingFrame(before.copy(declinationDeg = declinationDeg)) }
            }
            assertEquals(core.field to core.expected, error.field to error.expected)
        }
        for (declinationDeg in listOf(-180.0, null, 180.0)) compass.declinationDeg = declinationDeg
    }

    @Test
    fun `settings that two threads change are both kept`() {
        val compass = Compass(sensors.source())
        compass.axis = ReferenceAxis.CAMERA
        // each reads back what it alone sets
        val lost = AtomicInteger()
        fun <T> changing(value: (Int) -> T, set: (T) -> Unit, get: () -> T) = Thread {
            for (k in 1..1_000_000) value(k).let { set(it); if (get() != it) lost.incrementAndGet() }
        }
        val threads = listOf(
            changing({ k -> k % 180.0 }, { compass.declinationDeg = it }, { compass.declinationDeg }),
            changing({ k -> screenRotation(k % 4) }, { compass.screenRotation = it }, { compass.screenRotation }),
        )
        threads.forEach(Thread::start)
        threads.forEach(Thread::join)
        assertEquals(0, lost.get())
        assertEquals(ReferenceAxis.CAMERA, compass.axis)
    }

    @Test
    fun `an app without the native library is told so, whatever it calls first`() {
        val (listener, first) = inProcessOfItsOwn("org.magcomp.WithoutLibrary", options = listOf("-Djava.library.path=/nowhere")).trim().lines()
        assertEquals("NativeLibraryException: magcomp's native library can't be loaded (no magcomp_ffi in java.library.path: " +
            "/nowhere); the app must hold it for this phone's ABI", listener)
        assertEquals("NativeLibraryException NativeLibraryException", first)
    }
}

/** Run in a process of its own: what a listener and constructors say. */
object WithoutLibrary {
    @JvmStatic
    fun main(arguments: Array<String>) {
        val ended = CompletableFuture<Exception?>()
        val listener = object : CompassListener {
            override fun onReading(reading: CompensatedReading) = Unit

            override fun onEnd(error: Exception?) {
                ended.complete(error)
            }
        }
        val nothing = RecordingSource("nothing") { "t_s,mx,my,mz\n0,1,2,3\n".reader() }
        Compass(nothing).start({ it.run() }, listener)
        println(ended.get(60, TimeUnit.SECONDS)!!.let { "${it.javaClass.simpleName}: ${it.message}" })
        println(listOf({ Compensator() }, { ConstantField() }).joinToString(" ") { runCatching(it).exceptionOrNull()!!.javaClass.simpleName })
    }
}
