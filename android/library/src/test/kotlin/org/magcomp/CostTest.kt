package org.magcomp

import android.hardware.Sensor
import android.hardware.SensorEvent
import java.lang.management.ManagementFactory
import java.util.Locale
import java.util.concurrent.atomic.AtomicInteger
import java.util.concurrent.atomic.AtomicLong
import kotlinx.coroutines.Dispatchers
import kotlinx.coroutines.cancelAndJoin
import kotlinx.coroutines.delay
import kotlinx.coroutines.launch
import kotlinx.coroutines.runBlocking
import kotlinx.coroutines.withTimeout
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test

/** What a reading costs from the sensors' listener to the collector, with a gyroscope event and one of gravity beside each sample. */
class CostTest {
    private val threads = ManagementFactory.getThreadMXBean() as com.sun.management.ThreadMXBean

    private fun allocated() = threads.getThreadAllocatedBytes(threads.allThreadIds).sum()

    /** Of all threads but this one, which plays and waits. */
    private fun cpuOfOthersNs() = threads.allThreadIds.filter { it != Thread.currentThread().id }.sumOf { threads.getThreadCpuTime(it).coerceAtLeast(0) }

    @Test
    fun `a reading through a compass allocates its records and little more`() = runBlocking {
        val types = intArrayOf(Sensor.TYPE_GYROSCOPE, Sensor.TYPE_GRAVITY, Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED)
        val sensors = FakeSensorManager(*types)
        // as an app has it: in order, with a store that is called every 10 s
        val store = object : CalibrationStore {
            override fun load(): String? = null

            override fun save(text: String) = Unit
        }
        val compass = Compass(sensors.source(SensorOptions()), store = store, graceMs = 0)
        val latestNs = AtomicLong()
        val count = AtomicInteger()
        val collecting = launch(Dispatchers.Default) {
            compass.readings().collect {
                latestNs.set(it.sample.timeNs)
                count.incrementAndGet()
            }
        }
        withTimeout(20_000) { while (sensors.registrations.size < 3) delay(1) }
        val listener = sensors.registrations[0].listener
        // Android's own events, used again and again, so that the player allocates nothing
        val events = types.map { SensorEvent(sensors.getDefaultSensor(it)!!, 0, 0, FloatArray(6)) }
        val phone = Phone(1)
        val played = List(4000) { phone.advance(still = false) }.flatten().map { event ->
            when (event) {
                is SensorSample.RotationRate -> event.sample.rateRadS
                is SensorSample.Up -> event.sample.upMS2
                is SensorSample.Magnetic -> event.sample.fieldUt
            }.let { Triple(it.x.toFloat(), it.y.toFloat(), it.z.toFloat()) }
        }
        var k = 0L
        var listenerNs = 0L
        fun play(samples: Int) {
            repeat(samples) {
                k += 1
                for (n in 0..2) {
                    val (x, y, z) = played[(3 * (k - 1) + n).toInt() % played.size]
                    val event = events[n]
                    event.timestamp = k * STEP_NS
                    event.values[0] = x
                    event.values[1] = y
                    event.values[2] = z
                    val begin = System.nanoTime()
                    listener.onSensorChanged(event)
                    listenerNs += System.nanoTime() - begin
                }
                // as fast as the estimator goes, and no faster: nothing is dropped
                while (latestNs.get() < (k - 1) * STEP_NS) Thread.onSpinWait()
            }
        }
        play(4000)
        listenerNs = 0
        val (bytesBefore, cpuBefore, countBefore) = Triple(allocated(), cpuOfOthersNs(), count.get())
        play(SAMPLES)
        val bytes = (allocated() - bytesBefore) / SAMPLES
        val us = (cpuOfOthersNs() - cpuBefore + listenerNs) * 1e-3 / SAMPLES
        println(String.format(Locale.ROOT, "a reading through Compass: %d bytes, %.1f us; %d of %d arrived", bytes, us, count.get() - countBefore, SAMPLES))
        collecting.cancelAndJoin()
        assertTrue(bytes < MOST, "$bytes bytes")
    }

    private companion object {
        const val SAMPLES = 20_000
        const val MOST = 2000
    }
}
