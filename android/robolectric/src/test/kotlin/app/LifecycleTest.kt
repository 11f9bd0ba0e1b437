package app

import android.hardware.Sensor
import android.os.Looper
import android.view.Surface
import org.junit.After
import org.junit.Assert.assertEquals
import org.junit.Assert.assertTrue
import org.junit.Test
import org.junit.runner.RunWith
import org.magcomp.PhoneSensor
import org.magcomp.StreamStatus
import org.magcomp.core.CompensationStatus
import org.magcomp.core.ScreenRotation
import org.robolectric.Robolectric
import org.robolectric.RobolectricTestRunner
import org.robolectric.RuntimeEnvironment
import org.robolectric.Shadows.shadowOf
import org.robolectric.annotation.Config
import org.robolectric.shadows.ShadowDisplay

/** What happens to an app, on the framework's own activities, services, loopers, preferences and displays. */
abstract class Lifecycles {
    private val app get() = RuntimeEnvironment.getApplication() as App
    private fun kept() = app.getSharedPreferences("org.magcomp", 0).getString("calibration", null)

    /** Until what other threads do is done; the limit is for a test that hangs. */
    private fun until(what: String, done: () -> Boolean) {
        val endNs = System.nanoTime() + 120_000_000_000
        while (!done()) {
            if (System.nanoTime() > endNs) throw AssertionError("never: $what")
            Thread.sleep(1)
            shadowOf(Looper.getMainLooper()).idle()
        }
    }

    private fun hasThread() = Thread.getAllStackTraces().keys.any { it.name == "magcomp" }

    @After
    fun `nothing goes on`() {
        app.compass.close()
        until("its thread has ended") { !hasThread() }
    }

    @Test
    fun `create, rotate, background, resume after ten minutes, another launch`() {
        val phone = Phone(app)
        val controller = Robolectric.buildActivity(CompassActivity::class.java).setup()
        until("registered") { phone.listeners.size == 1 }
        val listener = phone.listeners.single()
        assertEquals(setOf(Sensor.TYPE_GYROSCOPE, Sensor.TYPE_GRAVITY, Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED), phone.registered(listener))
        phone.play(1500)
        var activity = controller.get()
        // readings come to a screen by way of other threads
        until("a heading is shown") { "give or take" in activity.label.text && activity.latest?.status == CompensationStatus.Tracking }

        @Suppress("DEPRECATION")
        shadowOf(ShadowDisplay.getDefaultDisplay()).setRotation(Surface.ROTATION_90)
        controller.recreate()
        activity = controller.get()
        phone.play(100)
        assertEquals("the same listener goes on", listener, phone.listeners.single())
        assertEquals(ScreenRotation.DEG90, activity.rotation())
        until("a heading is shown after the turn") { activity.latest?.headingDeg != null && activity.shown > 0 }

        controller.pause().stop()
        until("saved before the grace time has passed") { kept() != null }
        val shown = activity.shown
        phone.play(10)
        assertEquals("the grace time", 1, phone.listeners.size)
        assertEquals(shown, activity.shown)
        until("released") { phone.listeners.isEmpty() }

        phone.rest(600_000)
        controller.restart().start().resume()
        until("registered again") { phone.listeners.size == 1 }
        phone.play(100)
        until("a heading goes on") { activity.latest?.headingDeg != null && activity.shown > shown }

        controller.pause().stop().destroy()
        app.compass.close()
        until("released, and its thread has ended") { phone.listeners.isEmpty() && !hasThread() }
        // the process is another one: a compass over the same preferences
        val again = org.magcomp.Compass(app)
        val first = java.util.concurrent.CompletableFuture<org.magcomp.CompassReading>()
        val running = again.start({ it.run() }, object : org.magcomp.HeadingListener {
            override fun onHeading(reading: org.magcomp.CompassReading) {
                if (reading.headingSigmaDeg?.let { it < 30 } == true) first.complete(reading)
            }

            override fun onEnd(error: Exception?) = Unit
        })
        until("registered by the next launch") { phone.listeners.size == 1 }
        // what was kept is taken over when it comes, on a busy machine after the first samples; without it nothing is known of a phone that lies still
        until("a heading from what was kept") {
            phone.play(1, isTurned = false)
            first.isDone
        }
        running.close()
        again.close()
        until("released by the next launch") { phone.listeners.isEmpty() }
    }

    @Test
    fun `no magnetometer`() {
        Phone(app, listOf(Sensor.TYPE_ACCELEROMETER))
        val controller = Robolectric.buildActivity(CompassActivity::class.java).setup()
        until("said") { controller.get().label.text.isNotEmpty() }
        assertEquals("this phone has no magnetometer; hide the compass", "${controller.get().label.text}")
    }

    @Test
    fun `no gyroscope, and the calibrated magnetometer alone`() {
        val phone = Phone(app, listOf(Sensor.TYPE_ACCELEROMETER, Sensor.TYPE_MAGNETIC_FIELD))
        val controller = Robolectric.buildActivity(CompassActivity::class.java).setup()
        until("registered") { phone.listeners.size == 1 }
        phone.play(1500)
        until("tracking") { controller.get().latest?.status == CompensationStatus.Tracking }
        val reading = controller.get().latest!!
        assertTrue("${reading.status}", reading.headingDeg != null)
        assertEquals("this phone has no gyroscope", reading.sensors!!.withoutGyroscope)
    }

    @Test
    fun `two activities share the sensors, and one goes on without the other`() {
        val phone = Phone(app)
        val one = Robolectric.buildActivity(CompassActivity::class.java).setup()
        val two = Robolectric.buildActivity(OtherActivity::class.java).setup()
        until("registered") { phone.listeners.size == 1 }
        phone.play(1500)
        assertEquals(1, phone.listeners.size)
        until("both have the same heading") {
            one.get().latest?.headingDeg != null && one.get().latest?.timeNs == two.get().latest?.timeNs
        }
        one.pause().stop().destroy()
        val before = two.get().latest!!.timeNs
        phone.play(10)
        until("the other goes on") { two.get().latest!!.timeNs > before }
        assertEquals(1, phone.listeners.size)
        two.pause().stop().destroy()
        until("released") { phone.listeners.isEmpty() }
    }

    @Test
    fun `a service in the background is told that the sensors are silent, and when they are not`() {
        val phone = Phone(app)
        val service = Robolectric.buildService(CompassService::class.java).create()
        shadowOf(Looper.getMainLooper()).idle()
        until("registered") { phone.listeners.size == 1 }
        phone.play(1500)
        val readings = service.get().readings
        until("a heading") { readings.lastOrNull()?.headingDeg != null }
        // the system delivers nothing more; the clock of the sensors' own looper goes on
        until("told") {
            phone.rest(100)
            readings.last().stream != StreamStatus.Live
        }
        assertEquals(StreamStatus.Silent(PhoneSensor.entries.toSet()), readings.last().stream)
        assertEquals(null, readings.last().headingDeg)
        phone.play(10)
        // each sensor is heard by its own first event, and readings come with the magnetometer's
        until("told that they are back") { readings.last().stream == StreamStatus.Live }
        service.destroy()
        until("released") { phone.listeners.isEmpty() }
    }
}

@RunWith(RobolectricTestRunner::class)
@Config(sdk = [35], application = App::class)
class LifecycleTest : Lifecycles()

@RunWith(RobolectricTestRunner::class)
@Config(sdk = [21], application = App::class)
class OldLifecycleTest : Lifecycles()
