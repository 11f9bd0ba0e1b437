package org.magcomp

import android.hardware.Sensor
import android.os.Handler
import java.util.concurrent.CopyOnWriteArrayList
import kotlinx.coroutines.CoroutineScope
import kotlinx.coroutines.Dispatchers
import kotlinx.coroutines.cancelAndJoin
import kotlinx.coroutines.launch
import kotlinx.coroutines.runBlocking
import kotlinx.coroutines.withTimeout
import kotlinx.coroutines.yield
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.core.*

/** Sensors that are registered and deliver nothing. */
class SilenceTest {
    private val mag = Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED
    private val gravity = Sensor.TYPE_GRAVITY
    private val gyroscope = Sensor.TYPE_GYROSCOPE
    private val all = intArrayOf(mag, Sensor.TYPE_MAGNETIC_FIELD, gravity, Sensor.TYPE_ACCELEROMETER, gyroscope)

    /** So many milliseconds, in which these sensors deliver every 10 ms. */
    private fun FakeSensorManager.play(ms: Int, vararg types: Int) = repeat(ms / 10) {
        for (type in types) deliver(type, 1, 1f, 2f, 3f)
        Handler.pass(10)
    }

    private fun collecting(sensors: FakeSensorManager, source: SensorManagerSource, registered: Int = 3, body: () -> Unit) = runBlocking {
        val samples = CopyOnWriteArrayList<SensorSample>()
        val job = CoroutineScope(Dispatchers.Unconfined).launch { source.samples().collect { samples += it } }
        sensors.registered(registered)
        withTimeout(120_000) { while (source.sensors.value == null) yield() }
        body()
        job.cancelAndJoin()
        assertEquals(0, sensors.registrations.size)
        samples
    }

    private fun SensorManagerSource.silent() = sensors.value!!.run { listOf(magnetometer.isSilent, up!!.isSilent, gyroscope!!.isSilent) }

    @Test
    fun `a sensor that is registered but silent is told, and at once when it speaks`() {
        val sensors = FakeSensorManager(*all)
        val source = sensors.source()
        collecting(sensors, source) {
            assertEquals(listOf(false, false, false), source.silent(), "not at once")
            sensors.play(2100, gravity, gyroscope)
            assertEquals(listOf(true, false, false), source.silent())
            sensors.deliver(mag, 1, 1f, 2f, 3f)
            assertEquals(listOf(false, false, false), source.silent())
            sensors.play(2600, gravity, mag)
            assertEquals(listOf(false, false, true), source.silent())
            // none at all, as in the background: gravity stays
            sensors.play(3100)
            assertEquals(listOf(true, true, true), source.silent())
            assertEquals(gravity, source.sensors.value!!.up!!.type)
            sensors.play(10, gravity, gyroscope, mag)
            assertEquals(listOf(false, false, false), source.silent())
        }
    }

    @Test
    fun `it is told after 2 s beyond latency and rate, not before`() {
        fun toldAfterMs(options: SensorOptions): Int {
            var toldMs = 0
            val sensors = FakeSensorManager(*all)
            val source = sensors.source(options)
            collecting(sensors, source) {
                while (!source.sensors.value!!.magnetometer.isSilent) {
                    sensors.play(10, gyroscope)
                    toldMs += 10
                }
            }
            return toldMs
        }
        assertTrue(toldAfterMs(SensorOptions()) in 2000..2100)
        assertTrue(toldAfterMs(SensorOptions(rateHz = 1)) in 3000..3100)
        assertTrue(toldAfterMs(SensorOptions(maxReportLatencyUs = 8_000_000)) in 10_000..10_100)
    }

    @Test
    fun `a sensor that speaks now and then is not silent`() {
        val sensors = FakeSensorManager(*all)
        val source = sensors.source()
        collecting(sensors, source) {
            repeat(20) {
                sensors.play(1000)
                sensors.play(10, mag)
                assertEquals(false, source.sensors.value!!.magnetometer.isSilent)
            }
        }
    }

    @Test
    fun `the accelerometer takes the place of a gravity that alone is silent, also one that sends nonsense`() {
        val sensors = FakeSensorManager(*all)
        val source = sensors.source()
        val samples = collecting(sensors, source) {
            repeat(300) {
                sensors.deliver(gravity, FloatArray(1))
                if (source.sensors.value!!.up!!.type == gravity) sensors.play(10, mag)
            }
            val up = source.sensors.value!!.up!!
            assertEquals(Sensor.TYPE_ACCELEROMETER to false, up.type to up.isSilent)
            assertEquals(setOf(mag, Sensor.TYPE_ACCELEROMETER, gyroscope), sensors.registrations.map { it.sensor.type }.toSet())
            // it has its own two seconds
            sensors.play(1500, mag)
            assertEquals(false, source.sensors.value!!.up!!.isSilent)
            sensors.play(10, Sensor.TYPE_ACCELEROMETER)
            sensors.play(2600, mag)
            assertEquals(true, source.sensors.value!!.up!!.isSilent)
        }
        assertEquals(1, samples.count { it is SensorSample.Up })
    }

    @Test
    fun `without a gyroscope gravity stays too while all are silent, and gives way while the magnetometer goes on`() {
        val sensors = FakeSensorManager(mag, gravity, Sensor.TYPE_ACCELEROMETER)
        val source = sensors.source()
        collecting(sensors, source, registered = 2) {
            sensors.play(5000)
            assertEquals(gravity to true, source.sensors.value!!.up!!.run { type to isSilent })
            assertEquals(setOf(mag, gravity), sensors.registrations.map { it.sensor.type }.toSet())
            sensors.play(2600, mag)
            assertEquals(Sensor.TYPE_ACCELEROMETER, source.sensors.value!!.up!!.type)
        }
    }

    @Test
    fun `an event of gravity that comes after the accelerometer has taken over counts no more`() {
        val sensors = FakeSensorManager(*all)
        val source = sensors.source()
        val samples = collecting(sensors, source) {
            val listener = sensors.registrations[0].listener
            sensors.play(2600, mag)
            assertEquals(Sensor.TYPE_ACCELEROMETER, source.sensors.value!!.up!!.type)
            listener.onSensorChanged(android.hardware.SensorEvent(sensors.getDefaultSensor(gravity)!!, 0, 1, floatArrayOf(7f, 7f, 7f)))
            sensors.play(10, Sensor.TYPE_ACCELEROMETER)
        }
        assertEquals(listOf(1.0), samples.filterIsInstance<SensorSample.Up>().map { it.sample.upMS2.x })
    }

    @Test
    fun `gravity stays where no accelerometer is, or the system refuses it`() {
        for (refuse in listOf(null, Sensor.TYPE_ACCELEROMETER)) {
            val types = if (refuse == null) all.filter { it != Sensor.TYPE_ACCELEROMETER }.toIntArray() else all
            val sensors = FakeSensorManager(*types).apply { this.refuse = refuse }
            val source = sensors.source()
            collecting(sensors, source) {
                sensors.play(5000, mag)
                assertEquals(gravity to true, source.sensors.value!!.up!!.run { type to isSilent })
                assertEquals(3, sensors.registrations.size)
            }
        }
    }
}
