package org.magcomp

import android.hardware.Sensor
import android.hardware.SensorEvent
import java.lang.management.ManagementFactory
import java.util.Locale
import java.util.concurrent.atomic.AtomicLong
import kotlin.time.Duration.Companion.ZERO
import kotlinx.coroutines.Dispatchers
import kotlinx.coroutines.cancelAndJoin
import kotlinx.coroutines.delay
import kotlinx.coroutines.flow.map
import kotlinx.coroutines.launch
import kotlinx.coroutines.runBlocking
import kotlinx.coroutines.withTimeout
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.core.*

/** What a reading costs from the sensors' listener to the collector, with a gyroscope event and one of gravity beside each sample. */
class CostTest {
    @Test
    fun `a reading through a compass allocates little more than its numbers`() {
        // in a process of its own, as an app has it: a JVM with assertions, as that of tests, gives every coroutine a name
        for ((looks, most) in mapOf("heading" to 300, "record" to 1100)) {
            val said = inProcessOfItsOwn("org.magcomp.CostMain", looks, options = NATIVE + "-Xmx256m")
            println("a reading through Compass, of which the collector looks at the $looks: ${said.trim()}")
            val (bytes, arrived) = Regex("(\\d+) bytes.* (\\d+) of $SAMPLES").find(said)!!.destructured
            assertEquals(SAMPLES, arrived.toInt(), said)
            assertTrue(bytes.toInt() in 1..most, said)
        }
    }

    private companion object {
        val NATIVE = listOf("java.library.path", "jna.library.path").map { "-D$it=${System.getProperty(it)}" } +
            "-Drepository.root=${System.getProperty("repository.root")}"
    }
}

private const val SAMPLES = 20_000

/** Prints bytes and microseconds a reading, and how many arrived. */
object CostMain {
    private val threads = ManagementFactory.getThreadMXBean() as com.sun.management.ThreadMXBean

    private fun allocated() = threads.getThreadAllocatedBytes(threads.allThreadIds).sum()

    /** Of all threads but this one, which plays and waits. */
    private fun cpuOfOthersNs() = threads.allThreadIds.filter { it != Thread.currentThread().id }.sumOf { threads.getThreadCpuTime(it).coerceAtLeast(0) }

    /** As an app has it: in order, with a store that is called every 10 s. */
    private object Store : CalibrationStore {
        override fun load(): String? = null

        override fun save(text: String) = Unit
    }

    private val latestNs = AtomicLong()
    private var count = 0

    @Volatile
    private var sum = 0.0

    @JvmStatic
    fun main(arguments: Array<String>) = runBlocking {
        val types = intArrayOf(Sensor.TYPE_GYROSCOPE, Sensor.TYPE_GRAVITY, Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED)
        val sensors = FakeSensorManager(*types)
        val compass = Compass(sensors.source(SensorOptions()), store = Store, grace = ZERO)
        val collecting = launch(Dispatchers.Default) {
            when (arguments.single()) {
                "heading" -> compass.headings().collect {
                    sum += (it.headingDeg ?: 0.0) + (it.headingSigmaDeg ?: 0.0) + if (it.status == CompensationStatus.Tracking) 1 else 0
                    arrived(it.timeNs)
                }
                else -> compass.readings().map { it.reading }.collect {
                    sum += (it.heading?.headingDeg ?: 0.0) + (it.fieldUt?.x ?: 0.0)
                    arrived(it.timeNs)
                }
            }
        }
        withTimeout(120_000) { while (sensors.registrations.size < 3) delay(1) }
        val player = Player(sensors, types)
        // until the JVM has compiled it
        player.play(SAMPLES)
        player.listenerNs = 0
        val (bytesBefore, cpuBefore, countBefore) = Triple(allocated(), cpuOfOthersNs(), count)
        player.play(SAMPLES)
        val bytes = (allocated() - bytesBefore) / SAMPLES
        val us = (cpuOfOthersNs() - cpuBefore + player.listenerNs) * 1e-3 / SAMPLES
        val bareUs = player.bareUs()
        println(String.format(Locale.ROOT, "%d bytes, %.1f us, of which %.1f over JNI alone; %d of %d", bytes, us, bareUs, count - countBefore, SAMPLES))
        collecting.cancelAndJoin()
    }

    private fun arrived(timeNs: Long) {
        count += 1
        latestNs.set(timeNs)
    }

    private class Player(sensors: FakeSensorManager, types: IntArray) {
        private val listener = sensors.registrations[0].listener

        // Android's own events, used again and again, so that the player allocates nothing
        private val events = types.map { SensorEvent(sensors.getDefaultSensor(it)!!, 0, 0, FloatArray(6)) }
        private val played = Phone(1).let { phone -> List(4000) { phone.advance(still = false) } }.flatten().map { event ->
            RawEvent().apply { set(event) }.run { floatArrayOf(x.toFloat(), y.toFloat(), z.toFloat()) }
        }
        private var k = 0L
        var listenerNs = 0L

        /** What the estimator takes for the same events over JNI, microseconds a sample, once the JVM has compiled it. */
        fun bareUs(): Double = Compensator().use { compensator ->
            val out = ReadingBuffer()
            var k = 0L
            fun play(): Double {
                val begin = threads.currentThreadCpuTime
                repeat(SAMPLES) {
                    k += 1
                    val (rate, up, field) = Triple(played(3 * k - 3), played(3 * k - 2), played(3 * k - 1))
                    compensator.pushRotationRate(k * STEP_NS, rate[0].toDouble(), rate[1].toDouble(), rate[2].toDouble())
                    compensator.pushUp(k * STEP_NS, up[0].toDouble(), up[1].toDouble(), up[2].toDouble())
                    compensator.push(k * STEP_NS, field[0].toDouble(), field[1].toDouble(), field[2].toDouble(), out)
                }
                return (threads.currentThreadCpuTime - begin) * 1e-3 / SAMPLES
            }
            play()
            play()
        }

        private fun played(k: Long) = played[k.toInt() % played.size]

        fun play(samples: Int) {
            repeat(samples) {
                k += 1
                for (n in 0..2) {
                    val event = events[n]
                    event.timestamp = k * STEP_NS
                    played[(3 * (k - 1) + n).toInt() % played.size].copyInto(event.values)
                }
                // of the processor: the clock on the wall counts what others do
                val begin = threads.currentThreadCpuTime
                for (n in 0..2) listener.onSensorChanged(events[n])
                listenerNs += threads.currentThreadCpuTime - begin
                // as fast as the estimator goes, and no faster: nothing is dropped
                while (latestNs.get() < k * STEP_NS) Thread.onSpinWait()
            }
        }
    }
}
