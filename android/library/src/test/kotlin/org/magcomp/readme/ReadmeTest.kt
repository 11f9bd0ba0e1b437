package org.magcomp.readme

import android.hardware.Sensor
import kotlinx.coroutines.async
import kotlinx.coroutines.delay
import kotlinx.coroutines.flow.first
import kotlinx.coroutines.runBlocking
import kotlinx.coroutines.withTimeout
import kotlinx.coroutines.yield
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.FakeApp
import org.magcomp.FakeSensorManager
import org.magcomp.SensorSample
import org.magcomp.STEP_NS
import org.magcomp.UpSample
import org.magcomp.Vector3
import org.magcomp.events
import org.magcomp.repository
import org.magcomp.tumbling

class ReadmeTest {
    private val sensors = FakeSensorManager(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, Sensor.TYPE_GRAVITY, hardIron = false)

    @Test
    fun `the view model of the README is the one that is compiled and run here`() {
        val file = "android/library/src/test/kotlin/org/magcomp/readme/CompassViewModel.kt"
        val code = "class CompassViewModel" + repository.resolve(file).readText().substringAfter("class CompassViewModel")
        assertTrue(code in repository.resolve("android/README.md").readText(), code)
    }

    @Test
    fun `the first page's snippet is the one that is compiled here, and shows a heading`(): Unit = runBlocking {
        val file = "android/library/src/test/kotlin/org/magcomp/readme/QuickStart.kt"
        val code = "fun headings" + repository.resolve(file).readText().substringAfter("fun headings")
        assertTrue(code in repository.resolve("README.md").readText(), code)

        val heading = async { headings(FakeApp(sensors)).first { " deg +- " in it } }
        withTimeout(20_000) { while (sensors.registrations.size < 2) yield() }
        val events = events(tumbling(600)) + SensorSample.Up(UpSample(700 * STEP_NS, Vector3(0.0, 0.0, 9.8)))
        events.forEach(sensors::deliver)
        assertTrue(Regex("[0-9.]+ deg \\+- [0-9.]+").matches(heading.await()), heading.await())
    }

    @Test
    fun `it shows a heading, goes on over a rotation, and says what is missing`(): Unit = runBlocking {
        val model = CompassViewModel(FakeApp(sensors))
        val heading = async { model.text.first { "give or take" in it } }
        withTimeout(20_000) { while (sensors.registrations.size < 2) yield() }
        val events = events(tumbling(600)) + SensorSample.Up(UpSample(700 * STEP_NS, Vector3(0.0, 0.0, 9.8)))
        events.forEach(sensors::deliver)
        assertTrue(Regex("[0-9.]+ deg, give or take [0-9.]+").matches(heading.await()), heading.await())
        // turned: the latest at once, though no event comes
        assertTrue("give or take" in model.text.first())
        assertEquals(1, sensors.most.get())
        withTimeout(20_000) { while (sensors.registrations.isNotEmpty()) delay(10) }

        assertEquals("this phone has no magnetometer; hide the compass", CompassViewModel(FakeApp(FakeSensorManager())).text.first())
    }
}
