package org.magcomp

import android.hardware.Sensor
import java.util.concurrent.CopyOnWriteArrayList
import kotlinx.coroutines.Dispatchers
import kotlinx.coroutines.ExperimentalCoroutinesApi
import kotlinx.coroutines.cancelAndJoin
import kotlinx.coroutines.delay
import kotlinx.coroutines.launch
import kotlinx.coroutines.runBlocking
import kotlinx.coroutines.test.advanceTimeBy
import kotlinx.coroutines.test.currentTime
import kotlinx.coroutines.test.runCurrent
import kotlinx.coroutines.test.runTest
import kotlinx.coroutines.withTimeout
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test

/** Sensors that are registered and deliver nothing. */
@OptIn(ExperimentalCoroutinesApi::class)
class SilenceTest {
    private val all = intArrayOf(
        Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, Sensor.TYPE_MAGNETIC_FIELD, Sensor.TYPE_GRAVITY, Sensor.TYPE_ACCELEROMETER, Sensor.TYPE_GYROSCOPE,
    )

    /** Delivers of these types again and again, until [until]. */
    private suspend fun playUntil(sensors: FakeSensorManager, vararg types: Int, until: () -> Boolean) = withTimeout(20_000) {
        while (!until()) {
            for (type in types) sensors.deliver(type, 1, 1f, 2f, 3f)
            delay(1)
        }
    }

    @Test
    fun `a sensor that is registered but silent is told, and when it speaks`() = runBlocking {
        val sensors = FakeSensorManager(*all)
        val source = sensors.source(silenceMs = 100)
        val compass = Compass(source, graceMs = 0)
        val collecting = launch { compass.readings().collect { } }
        fun silent() = compass.sensors.value?.run { listOf(magnetometer.isSilent, up!!.isSilent, gyroscope!!.isSilent) }
        sensors.registered(3)
        assertEquals(listOf(false, false, false), silent(), "not at once")
        playUntil(sensors, Sensor.TYPE_GRAVITY, Sensor.TYPE_GYROSCOPE) { silent() == listOf(true, false, false) }
        playUntil(sensors, Sensor.TYPE_GRAVITY, Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED) { silent() == listOf(false, false, true) }
        // none at all, as in the background: gravity stays
        withTimeout(20_000) { while (silent() != listOf(true, true, true)) delay(1) }
        delay(200)
        assertEquals(Sensor.TYPE_GRAVITY, compass.sensors.value!!.up!!.type)
        playUntil(sensors, Sensor.TYPE_GRAVITY, Sensor.TYPE_GYROSCOPE, Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED) { silent() == listOf(false, false, false) }
        collecting.cancelAndJoin()
        assertEquals(0, sensors.registrations.size)
    }

    @Test
    fun `it is told after 2 s beyond latency and rate, not before`() {
        // in the time of the test, which nothing else passes
        fun toldAfterMs(options: SensorOptions): Long {
            var toldMs = 0L
            runTest {
                val sensors = FakeSensorManager(*all)
                val source = sensors.source(options, silenceMs = 2000)
                val collecting = launch { source.samples().collect { } }
                runCurrent()
                while (!source.sensors.value!!.magnetometer.isSilent) {
                    sensors.deliver(Sensor.TYPE_GYROSCOPE, 1, 0f, 0f, 0f)
                    advanceTimeBy(10)
                    runCurrent()
                }
                toldMs = currentTime
                collecting.cancelAndJoin()
            }
            return toldMs
        }
        assertTrue(toldAfterMs(SensorOptions()) in 2000..2100)
        assertTrue(toldAfterMs(SensorOptions(rateHz = 1)) in 3000..3100)
        assertTrue(toldAfterMs(SensorOptions(maxReportLatencyUs = 8_000_000)) in 10_000..10_100)
    }

    @Test
    fun `a sensor that speaks now and then is not silent, and an event ends a silence`() = runTest {
        val sensors = FakeSensorManager(*all)
        val source = sensors.source(silenceMs = 2000)
        val collecting = launch { source.samples().collect { } }
        runCurrent()
        repeat(20) {
            advanceTimeBy(1000)
            sensors.deliver(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, it + 1L, 1f, 2f, 3f)
            runCurrent()
            assertEquals(false, source.sensors.value!!.magnetometer.isSilent)
        }
        collecting.cancelAndJoin()
    }

    @Test
    fun `the accelerometer takes the place of a gravity that alone is silent, also one that sends nonsense`() = runBlocking {
        val sensors = FakeSensorManager(*all)
        val source = sensors.source(silenceMs = 100)
        val ups = CopyOnWriteArrayList<SensorSample>()
        val collecting = launch(Dispatchers.Default) { source.samples().collect { if (it is SensorSample.Up) ups += it } }
        sensors.registered(3)
        playUntil(sensors, Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED) {
            sensors.deliver(Sensor.TYPE_GRAVITY, FloatArray(1))
            source.sensors.value!!.up!!.type == Sensor.TYPE_ACCELEROMETER
        }
        val types = setOf(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, Sensor.TYPE_ACCELEROMETER, Sensor.TYPE_GYROSCOPE)
        withTimeout(20_000) { while (sensors.registrations.map { it.sensor.type }.toSet() != types) delay(1) }
        playUntil(sensors, Sensor.TYPE_ACCELEROMETER) { ups.isNotEmpty() }
        assertEquals(false, source.sensors.value!!.up!!.isSilent)
        collecting.cancelAndJoin()
        assertEquals(0, sensors.registrations.size)
    }

    @Test
    fun `gravity stays where no accelerometer is, or the system refuses it`() = runBlocking {
        for (refuse in listOf(null, Sensor.TYPE_ACCELEROMETER)) {
            val types = if (refuse == null) all.filter { it != Sensor.TYPE_ACCELEROMETER }.toIntArray() else all
            val sensors = FakeSensorManager(*types).apply { this.refuse = refuse }
            val source = sensors.source(silenceMs = 40)
            val collecting = launch { source.samples().collect { } }
            sensors.registered(3)
            playUntil(sensors, Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED) { source.sensors.value!!.up!!.isSilent }
            repeat(50) { playUntil(sensors, Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED) { true }; delay(2) }
            assertEquals(Sensor.TYPE_GRAVITY, source.sensors.value!!.up!!.type)
            assertEquals(3, sensors.registrations.size)
            collecting.cancelAndJoin()
        }
    }
}
