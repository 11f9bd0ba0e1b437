package org.magcomp

import android.hardware.Sensor
import android.hardware.SensorManager
import android.os.Handler
import java.util.concurrent.CopyOnWriteArrayList
import java.util.concurrent.CountDownLatch
import java.util.concurrent.atomic.AtomicBoolean
import java.util.concurrent.atomic.AtomicLong
import kotlin.concurrent.thread
import kotlin.random.Random
import kotlin.time.Duration.Companion.ZERO
import kotlin.time.Duration.Companion.milliseconds
import kotlinx.coroutines.CompletableDeferred
import kotlinx.coroutines.CoroutineScope
import kotlinx.coroutines.Dispatchers
import kotlinx.coroutines.cancelAndJoin
import kotlinx.coroutines.delay
import kotlinx.coroutines.flow.first
import kotlinx.coroutines.flow.take
import kotlinx.coroutines.flow.toList
import kotlinx.coroutines.launch
import kotlinx.coroutines.runBlocking
import kotlinx.coroutines.withTimeout
import kotlinx.coroutines.yield
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertThrows
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.core.*

/** Any number of users of one source. */
class OneRunTest {
    private val mag = Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED
    private val sensors = FakeSensorManager(mag, Sensor.TYPE_GRAVITY, Sensor.TYPE_ACCELEROMETER, Sensor.TYPE_GYROSCOPE)
    private val scope = CoroutineScope(Dispatchers.Default)

    private fun magnetic(timeNs: Long) = sensors.deliver(mag, timeNs, 1f, 2f, (timeNs % 97).toFloat(), 0f, 0f, 0f)

    private suspend fun until(what: () -> Boolean) = withTimeout(120_000) { while (!what()) yield() }

    /** So many steps of a phone that is turned, whose gravity is silent. */
    private fun Phone.play(steps: Int) = repeat(steps) {
        for (event in advance(still = false)) {
            if (event is SensorSample.Up) {
                with(event.sample.upMS2) { sensors.deliver(Sensor.TYPE_ACCELEROMETER, event.timeNs, x.toFloat(), y.toFloat(), z.toFloat()) }
            } else {
                sensors.deliver(event)
            }
        }
        Handler.pass(10)
    }

    @Test
    fun `where gravity is silent, a compass that joins late has headings too, and each sensor is registered once`() = runBlocking {
        val source = sensors.source()
        val readings = List(2) { CopyOnWriteArrayList<CompensatedReading>() }
        val phone = Phone(1)
        val compasses = readings.mapIndexed { k, it ->
            scope.launch { Compass(source, grace = ZERO).readings().collect(it::add) }.also {
                if (k == 0) sensors.registered(3) else until { readings[1].isNotEmpty().also { phone.play(1) } }
                phone.play(50)
            }
        }
        phone.play(2000)
        until { readings.all { it.lastOrNull()?.sample?.timeNs == phone.timeNs } }
        for (got in readings) {
            assertTrue(got.last().reading.heading != null)
            assertEquals(0L, got.sumOf { it.droppedBefore })
        }
        assertEquals(Sensor.TYPE_ACCELEROMETER, source.sensors.value!!.up!!.type)
        assertEquals(1, sensors.most.get())
        compasses[0].cancelAndJoin()
        assertEquals(3, sensors.registrations.size)
        compasses[1].cancelAndJoin()
        assertEquals(Pair(0, 0), Pair(sensors.registrations.size, sensors.threads))
    }

    @Test
    fun `a recorder beside a compass leaves what is known of the sensors`() = runBlocking {
        val source = sensors.source()
        val compass = scope.launch { Compass(source, grace = ZERO).readings().collect { } }
        sensors.registered(3)
        sensors.tell(mag, SensorManager.SENSOR_STATUS_ACCURACY_HIGH)
        val recorded = CopyOnWriteArrayList<SensorSample>()
        val recorder = scope.launch { source.samples().collect { recorded += it } }
        until { recorded.isNotEmpty().also { magnetic(STEP_NS) } }
        assertEquals(SensorAccuracy.HIGH, source.sensors.value!!.magnetometer.accuracy)
        recorder.cancelAndJoin()
        assertEquals(SensorAccuracy.HIGH, source.sensors.value!!.magnetometer.accuracy)
        assertEquals(3, sensors.registrations.size)
        compass.cancelAndJoin()
        // the next run knows nothing of it
        val next = scope.launch { source.samples().collect { } }
        sensors.registered(3)
        assertEquals(SensorAccuracy.UNKNOWN, source.sensors.value!!.magnetometer.accuracy)
        next.cancelAndJoin()
    }

    @Test
    fun `compasses and recorders that come and go at random miss nothing while they are there`() = runBlocking {
        val source = sensors.source()
        val stop = AtomicBoolean()
        val player = thread {
            var timeNs = 0L
            while (!stop.get()) {
                timeNs += STEP_NS
                magnetic(timeNs)
                Thread.sleep(0, 100_000)
            }
        }
        val compass = Compass(source, grace = 5.milliseconds)
        val users = List(8) { k ->
            scope.launch {
                val random = Random(k)
                repeat(40) {
                    val count = random.nextInt(1, 12)
                    val times = if (k % 2 == 0) {
                        compass.readings().take(count).toList().also { got -> assertTrue(got.all { it.droppedBefore == 0L }) }.map { it.sample.timeNs }
                    } else {
                        source.samples().take(count).toList().map { it.timeNs }
                    }
                    assertEquals(List(count) { times[0] + it * STEP_NS }, times)
                    delay(random.nextLong(5))
                }
            }
        }
        users.forEach { it.join() }
        assertTrue(users.none { it.isCancelled })
        until { sensors.registrations.isEmpty() && sensors.threads == 0 }
        assertEquals(1, sensors.most.get())
        stop.set(true)
        player.join()
        compass.close()
    }

    @Test
    fun `who takes none for a minute is told, after what has waited, and the others go on`() = runBlocking {
        val source = sensors.source()
        val gate = CompletableDeferred<Unit>()
        val slow = CopyOnWriteArrayList<SensorSample>()
        val error = CopyOnWriteArrayList<Throwable>()
        val now = CoroutineScope(Dispatchers.Unconfined)
        val stuck = now.launch {
            runCatching { source.samples().collect { slow += it; gate.await() } }.exceptionOrNull()?.let(error::add)
        }
        val other = AtomicLong()
        val quick = now.launch { source.samples().collect { other.set(it.timeNs) } }
        var k = 0L
        until { (slow.isNotEmpty() && other.get() > 0).also { magnetic(++k) } }
        repeat(20_000) { magnetic(++k) }
        assertEquals(Pair(1, k), Pair(slow.size, other.get()))
        gate.complete(Unit)
        withTimeout(120_000) { stuck.join() }
        assertTrue(error.single() is SensorException.NotTaken, "${error.single()}")
        assertEquals(18_001, slow.size, "those of a minute, and the one that was being taken")
        assertEquals(3, sensors.registrations.size)
        quick.cancelAndJoin()
        assertEquals(0, sensors.registrations.size)
    }

    /** As an app filters the phone's events. */
    private class Shifted(private val of: MagneticFieldSource) : MagneticFieldSource by of {
        val threads = CopyOnWriteArrayList<Thread>()

        override suspend fun deliver(taker: EventTaker) = of.deliver(object : EventTaker by taker {
            override fun take(event: RawEvent) {
                threads += Thread.currentThread()
                taker.take(event.copy().apply { x += 5 })
            }
        })
    }

    @Test
    fun `a source that wraps the phone's is estimated on the thread of its sensors, and tells of silence`() = runBlocking {
        val source = sensors.source()
        val shifted = Shifted(source)
        val (wrapped, plain) = List(2) { CopyOnWriteArrayList<CompensatedReading>() }
        val now = CoroutineScope(Dispatchers.Unconfined)
        val one = now.launch { Compass(shifted, grace = ZERO).readings().collect(wrapped::add) }
        val two = now.launch { Compass(source, grace = ZERO).readings().collect(plain::add) }
        var k = 0L
        until { (wrapped.isNotEmpty() && plain.isNotEmpty()).also { if (!it) magnetic(++k * STEP_NS) } }
        wrapped.clear()
        shifted.threads.clear()
        magnetic(++k * STEP_NS)
        assertEquals(plain.last().sample.fieldUt.x + 5, wrapped.single().sample.fieldUt.x)
        assertEquals(listOf(Thread.currentThread()), shifted.threads.toList())
        assertEquals(1, sensors.most.get())
        repeat(300) { Handler.pass(10) }
        assertTrue((wrapped.last().stream as StreamStatus.Silent).sensors.contains(PhoneSensor.MAGNETOMETER))
        assertEquals(2, wrapped.size)
        one.cancelAndJoin()
        two.cancelAndJoin()
        until { sensors.registrations.isEmpty() }
    }

    @Test
    fun `one that fails ends alone`() = runBlocking {
        val source = sensors.source()
        val good = Compass(source, grace = ZERO)
        val bad = Compass(source, grace = ZERO)
        val got = CopyOnWriteArrayList<CompensatedReading>()
        val going = scope.launch { good.readings().collect(got::add) }
        sensors.registered(3)
        val failed = scope.launch {
            assertThrows(MagcompException.Panicked::class.java) {
                runBlocking { bad.readings().collect { TestHooks.panicOnPurpose(bad.kept!!.compensator.handle) } }
            }
        }
        var k = 0L
        until { failed.isCompleted.also { if (!it) magnetic(++k * STEP_NS) } }
        assertTrue(!failed.isCancelled)
        magnetic(++k * STEP_NS)
        until { got.last().sample.timeNs == k * STEP_NS }
        going.cancelAndJoin()
        assertEquals(0, sensors.registrations.size)
    }

    @Test
    fun `the app's work holds no reading up`() = runBlocking {
        val compass = Compass(sensors.source(), grace = ZERO)
        val got = AtomicLong()
        val collector = CoroutineScope(Dispatchers.Unconfined).launch { compass.headings().collect { got.set(it.timeNs) } }
        sensors.registered(3)
        // every thread that coroutines have is busy
        val gate = CountDownLatch(1)
        val busy = List(200) { listOf(scope.launch { gate.await() }, scope.launch(Dispatchers.IO) { gate.await() }) }.flatten()
        for (k in 1L..300) {
            magnetic(k * STEP_NS)
            assertEquals(k * STEP_NS, got.get(), "within the event")
        }
        gate.countDown()
        busy.forEach { it.join() }
        collector.cancelAndJoin()
        until { sensors.registrations.isEmpty() }
    }

    @Test
    fun `an event that waits for others is not lost to a compass that stays`() = runBlocking {
        val compass = Compass(sensors.source(SensorOptions()), grace = ZERO)
        val reading = scope.launch { assertEquals(STEP_NS, compass.readings().first().sample.timeNs) }
        sensors.registered(3)
        magnetic(STEP_NS)
        yield()
        assertTrue(reading.isActive)
        sensors.deliver(Sensor.TYPE_GYROSCOPE, STEP_NS + 60_000_000, 0f, 0f, 0f)
        withTimeout(120_000) { reading.join() }
        assertTrue(!reading.isCancelled)
    }
}
