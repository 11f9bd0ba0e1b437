package org.magcomp

import android.hardware.Sensor
import java.util.concurrent.CompletableFuture
import java.util.concurrent.ExecutionException
import java.util.concurrent.LinkedBlockingQueue
import java.util.concurrent.RejectedExecutionException
import java.util.concurrent.ThreadPoolExecutor
import java.util.concurrent.TimeUnit
import java.util.concurrent.atomic.AtomicInteger
import kotlin.time.Duration.Companion.ZERO
import kotlinx.coroutines.flow.Flow
import kotlinx.coroutines.flow.asFlow
import kotlinx.coroutines.flow.flow
import kotlinx.coroutines.withTimeout
import org.junit.jupiter.api.AfterEach
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertFalse
import org.junit.jupiter.api.Assertions.assertInstanceOf
import org.junit.jupiter.api.Assertions.assertNull
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.core.*

/** What ends the readings of a listener, whoever threw it. */
class CompassListenerTest {
    private val executor = ThreadPoolExecutor(1, 1, 0, TimeUnit.SECONDS, LinkedBlockingQueue()) { Thread(it, "of the app") }
    private val sensors =
        FakeSensorManager(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, Sensor.TYPE_GRAVITY, Sensor.TYPE_GYROSCOPE)

    @AfterEach
    fun end() {
        executor.shutdownNow()
    }

    private inner class Listening(val onReading: (Int) -> Unit = {}) : CompassReadingListener {
        val readings = AtomicInteger()
        val ends = AtomicInteger()
        private val ended = CompletableFuture<Pair<Exception?, String>>()

        override fun onReading(reading: CompensatedReading) = onReading(readings.incrementAndGet())

        override fun onEnd(error: Exception?) {
            ends.incrementAndGet()
            val left = "${sensors.registrations.size} sensors, ${sensors.threads} threads"
            ended.complete(Pair(error, "$left, on the thread ${Thread.currentThread().name.substringBefore(" @")}"))
        }

        /** What it was told at the end; the sensors must be unregistered then. */
        fun error(): Exception? {
            val (error, left) = ended.get(60, TimeUnit.SECONDS)
            assertEquals("0 sensors, 0 threads, on the thread of the app", left)
            assertEquals(1, ends.get())
            return error
        }
    }

    private val events = events(tumbling(300))

    @Test
    fun `a listener too many`() {
        val others = List(FakeSensorManager.LISTENER_LIMIT) { FakeSensorManager.Silent() }
        val magnetometer = sensors.getDefaultSensor(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED)
        others.forEach { sensors.registerListener(it, magnetometer, 1, 0) }
        val listening = object : CompassReadingListener {
            val ended = CompletableFuture<Exception?>()

            override fun onReading(reading: CompensatedReading) = Unit

            override fun onEnd(error: Exception?) {
                ended.complete(error)
            }
        }
        Compass(sensors.source()).start(executor, listening)
        val error = assertInstanceOf(SensorException.Refused::class.java, listening.ended.get(60, TimeUnit.SECONDS))
        assertEquals("magnetometer", error.sensor)
        assertEquals(others, sensors.registrations.map { it.listener }, "the others go on")
        assertEquals(0, sensors.threads)
    }

    @Test
    fun `what the listener throws`() {
        // one that coroutines take for a cancellation, too
        for (thrown in listOf(IllegalStateException("of the app"), java.util.concurrent.CancellationException("of the app"))) {
            val listening = Listening { if (it == 2) throw thrown }
            Compass(sensors.source(), grace = ZERO).start(executor, listening)
            while (sensors.registrations.size < 3) Thread.yield()
            for (k in 1L..5) sensors.deliver(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, k * STEP_NS, 1f, 2f, k.toFloat())
            // coroutines may have copied it
            val error = listening.error()!!
            assertEquals(Pair(thrown.javaClass, thrown.message), Pair(error.javaClass, error.message))
            assertEquals(2, listening.readings.get(), "no reading after it")
        }
    }

    @Test
    fun `what the source throws, at once, later, or as a cancellation`() {
        class OfTheSource : RuntimeException()
        val sources = listOf(
            object : FlowSource() {
                override fun played(): Flow<SensorSample> = throw OfTheSource()
            },
            Played(flow { throw OfTheSource() }),
            Played(
                flow {
                    events.forEach { emit(it) }
                    throw OfTheSource()
                },
            ),
        )
        for (source in sources) {
            val listening = Listening()
            Compass(source).start(executor, listening)
            assertInstanceOf(OfTheSource::class.java, listening.error())
        }
        val listening = Listening()
        Compass(Played(flow { withTimeout(1) { kotlinx.coroutines.awaitCancellation() } })).start(executor, listening)
        assertInstanceOf(kotlinx.coroutines.TimeoutCancellationException::class.java, listening.error())
    }

    @Test
    fun `a config out of range`() {
        val listening = Listening()
        Compass(Played(events), CompensationConfig(rangeUt = -1.0)).start(executor, listening)
        assertEquals("range_ut", assertInstanceOf(MagcompException.Config::class.java, listening.error()).field)
    }

    @Test
    fun `an Error of the source, or of the listener, is the cause of what it is told`() {
        val broken = Listening()
        Compass(Played(flow { throw StackOverflowError("of the source") })).start(executor, broken)
        val listening = Listening { throw StackOverflowError("of the app") }
        Compass(Played(events)).start(executor, listening)
        for (it in listOf(broken, listening)) {
            assertInstanceOf(StackOverflowError::class.java, assertInstanceOf(ExecutionException::class.java, it.error()).cause)
        }
    }

    @Test
    fun `the end of the source is no error`() {
        val listening = Listening()
        Compass(Played(events)).start(executor, listening)
        assertNull(listening.error())
        assertTrue(listening.readings.get() > 0)
    }

    @Test
    fun `after closing it is told nothing, not even what it throws itself`() {
        val running = CompletableFuture<AutoCloseable>()
        val thrown = CompletableFuture<Unit>()
        val listening = Listening {
            running.get(60, TimeUnit.SECONDS).close()
            thrown.complete(Unit)
            throw IllegalStateException("of the app")
        }
        running.complete(Compass(Played(events)).start(executor, listening))
        thrown.get(60, TimeUnit.SECONDS)
        // what follows on the executor
        repeat(100) { executor.submit { }.get(60, TimeUnit.SECONDS) }
        assertEquals(1, listening.readings.get())
        assertEquals(0, listening.ends.get())
        assertFalse(executor.isShutdown)
    }

    @Test
    fun `what waits on the executor when it is closed is not called any more`() {
        val waiting = LinkedBlockingQueue<Runnable>()
        for (played in listOf(events, emptyList())) {
            val listening = Listening()
            val running = Compass(Played(played)).start({ waiting.add(it) }, listening)
            val call = waiting.poll(60, TimeUnit.SECONDS)!!
            running.close()
            call.run()
            assertEquals(Pair(0, 0), Pair(listening.readings.get(), listening.ends.get()))
            waiting.clear()
        }
    }

    @Test
    fun `closing ends it whatever the executor does, also one that forgets what it had accepted`() {
        // the first reading waits behind this, and is forgotten
        executor.execute { runCatching { Thread.sleep(600_000) } }
        val running = Compass(sensors.source(), grace = ZERO).start(executor, Listening())
        while (sensors.registrations.size < 3) Thread.yield()
        sensors.deliver(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, STEP_NS, 1f, 2f, 3f)
        executor.shutdownNow()
        assertEquals(3, sensors.registrations.size)
        running.close()
        while (sensors.registrations.isNotEmpty() || sensors.threads > 0) Thread.yield()
    }

    @Test
    fun `an executor that was shut down, before or meanwhile`() {
        class Told : CompassReadingListener {
            val ended = CompletableFuture<Exception?>()
            val readings = AtomicInteger()

            override fun onReading(reading: CompensatedReading) {
                if (readings.incrementAndGet() == 3) executor.shutdownNow()
            }

            override fun onEnd(error: Exception?) {
                ended.complete(error)
            }
        }
        for (expected in listOf(3, 0)) {
            val told = Told()
            Compass(sensors.source(), grace = ZERO).start(executor, told)
            val player = kotlin.concurrent.thread {
                var k = 1L
                while (!told.ended.isDone) {
                    sensors.deliver(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, k++ * STEP_NS, 1f, 2f, k.toFloat())
                    Thread.sleep(1)
                }
            }
            assertInstanceOf(RejectedExecutionException::class.java, told.ended.get(60, TimeUnit.SECONDS))
            player.join()
            assertEquals(expected, told.readings.get())
            assertEquals("0 sensors, 0 threads", "${sensors.registrations.size} sensors, ${sensors.threads} threads")
        }
    }
}
