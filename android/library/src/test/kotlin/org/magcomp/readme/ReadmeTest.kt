package org.magcomp.readme

import android.hardware.Sensor
import android.hardware.SensorManager
import android.view.Surface
import com.facebook.react.bridge.ReactApplicationContext
import io.flutter.plugin.common.EventChannel
import kotlinx.coroutines.async
import kotlinx.coroutines.delay
import kotlinx.coroutines.flow.first
import kotlinx.coroutines.runBlocking
import kotlinx.coroutines.withTimeout
import kotlinx.coroutines.yield
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.Compass
import org.magcomp.FakeApp
import org.magcomp.FakeSensorManager
import org.magcomp.STEP_NS
import org.magcomp.core.DeviceVector
import org.magcomp.core.SensorSample
import org.magcomp.core.UpSample
import org.magcomp.events
import org.magcomp.repository
import org.magcomp.tumbling

class ReadmeTest {
    private val sensors = FakeSensorManager(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, Sensor.TYPE_GRAVITY, hardIron = false)

    private val marked = Regex("""// what follows is in (\S+); ReadmeTest compares them\n""")
    private val snippets = repository.resolve("android/library/src/test/kotlin/org/magcomp/readme").listFiles()!!.mapNotNull { file ->
        val text = file.readText()
        marked.find(text)?.let { it.groupValues[1] to text.substring(it.range.last + 1) }
    }

    @Test
    fun `every snippet of a document is compiled here, but Gradle's`() {
        val fenced = Regex("(?s)```kotlin\n(.*?)```")
        for (document in listOf("README.md", "android/README.md", "android/GUIDE.md", "android/MIGRATION.md", "docs/FRAMEWORKS.md")) {
            val shown = fenced.findAll(repository.resolve(document).readText()).map { it.groupValues[1] }
            val compiled = snippets.filter { it.first == document }.map { it.second }
            assertTrue(compiled.isNotEmpty(), document)
            for (code in compiled) assertTrue(shown.any { code in it }, "$document lacks $code")
            for (block in shown) assertTrue("mplementation(\"" in block || compiled.any { it in block }, "$document: $block")
        }
    }

    @Test
    fun `what took Android's angles and rotation vectors takes these`(): Unit = runBlocking {
        val compass = Compass(FakeApp(sensors))
        val last = async { compass.readings().first { it.sample.timeNs == 600 * STEP_NS } }
        withTimeout(120_000) { while (sensors.registrations.size < 2) yield() }
        val events = events(tumbling(600)) + SensorSample.Up(UpSample(700 * STEP_NS, DeviceVector(0.0, 0.0, 9.8)))
        events.forEach(sensors::deliver)
        last.await()
        // the latest, as no more comes
        val (v, angles) = Pair(rotationVectors(compass).first(), orientations(compass) { Surface.ROTATION_90 }.first())
        val (matrix, turned, expected) = Triple(FloatArray(9), FloatArray(9), FloatArray(3))
        SensorManager.getRotationMatrixFromVector(matrix, v)
        SensorManager.remapCoordinateSystem(matrix, SensorManager.AXIS_Y, SensorManager.AXIS_MINUS_X, turned)
        SensorManager.getOrientation(turned, expected)
        val found = with(angles) { listOf(azimuthDeg, pitchDeg, rollDeg) }
        for (k in 0..2) assertEquals(Math.toDegrees(expected[k].toDouble()), found[k], 0.01, "$k")
        compass.close()
    }

    @Test
    fun `the first page's snippet shows a heading`(): Unit = runBlocking {
        val heading = async { HeadingViewModel(FakeApp(sensors)).text.first { " deg +- " in it } }
        withTimeout(120_000) { while (sensors.registrations.size < 2) yield() }
        val events = events(tumbling(600)) + SensorSample.Up(UpSample(700 * STEP_NS, DeviceVector(0.0, 0.0, 9.8)))
        events.forEach(sensors::deliver)
        assertTrue(Regex("[0-9.]+ deg \\+- [0-9.]+").matches(heading.await()), heading.await())
    }

    @Test
    fun `the bridges to React Native and Flutter tell a heading, or what is missing`(): Unit = runBlocking {
        val context = ReactApplicationContext(FakeApp(sensors))
        val module = MagcompModule(context)
        module.addListener("heading")
        withTimeout(120_000) { while (sensors.registrations.size < 2) yield() }
        events(tumbling(600)).forEach(sensors::deliver)
        fun isTold() = synchronized(context.emitted) { context.emitted.any { (_, it) -> (it as Map<*, *>)["headingDeg"] is Double } }
        withTimeout(120_000) { while (!isTold()) delay(10) }
        module.removeListeners(1)
        withTimeout(120_000) { while (sensors.registrations.isNotEmpty()) delay(10) }
        module.invalidate()

        val heard = mutableListOf<Any?>()
        val handler = HeadingHandler(FakeApp(FakeSensorManager()), this)
        handler.onListen(null, object : EventChannel.EventSink {
            override fun success(event: Any?) = heard.plusAssign(event)
        })
        withTimeout(120_000) { while (heard.isEmpty()) yield() }
        handler.onCancel(null)
        assertEquals(listOf(mapOf("headingDeg" to null, "sigmaDeg" to null, "text" to "This phone has no compass.")), heard.toList())
    }

    @Test
    fun `it shows a heading, goes on over a rotation, and says what is missing`(): Unit = runBlocking {
        val model = CompassViewModel(FakeApp(sensors))
        val heading = async { model.text { Surface.ROTATION_0 }.first { "give or take" in it } }
        withTimeout(120_000) { while (sensors.registrations.size < 2) yield() }
        val events = events(tumbling(600)) + SensorSample.Up(UpSample(700 * STEP_NS, DeviceVector(0.0, 0.0, 9.8)))
        events.forEach(sensors::deliver)
        assertTrue(Regex("[0-9]+°, give or take [0-9]+°").matches(heading.await()), heading.await())
        // turned: the latest at once, though no event comes
        assertTrue("give or take" in model.text { Surface.ROTATION_90 }.first())
        assertEquals(1, sensors.most.get())
        withTimeout(120_000) { while (sensors.registrations.isNotEmpty()) delay(10) }

        assertEquals("This phone has no compass.", CompassViewModel(FakeApp(FakeSensorManager())).text { Surface.ROTATION_0 }.first())
    }
}
