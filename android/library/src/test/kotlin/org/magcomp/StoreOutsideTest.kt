package org.magcomp

import android.hardware.Sensor
import java.util.concurrent.CopyOnWriteArrayList
import java.util.concurrent.CountDownLatch
import java.util.concurrent.atomic.AtomicInteger
import kotlin.time.Duration.Companion.ZERO
import kotlinx.coroutines.CoroutineScope
import kotlinx.coroutines.Dispatchers
import kotlinx.coroutines.ExperimentalCoroutinesApi
import kotlinx.coroutines.cancelAndJoin
import kotlinx.coroutines.delay
import kotlinx.coroutines.launch
import kotlinx.coroutines.runBlocking
import kotlinx.coroutines.test.StandardTestDispatcher
import kotlinx.coroutines.test.advanceTimeBy
import kotlinx.coroutines.test.runTest
import kotlinx.coroutines.withContext
import kotlinx.coroutines.withTimeout
import kotlinx.coroutines.yield
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertNotNull
import org.junit.jupiter.api.Assertions.assertNull
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.core.*

/** A store that takes its time, beside the phone's sensors. */
@OptIn(ExperimentalCoroutinesApi::class) // the clock of a test
class StoreOutsideTest {
    private val sensors = FakeSensorManager(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, Sensor.TYPE_GRAVITY, Sensor.TYPE_GYROSCOPE)
    private val phone = Phone(1)

    /** Each call waits for its gate. */
    private class Slow(@Volatile var text: String? = null) : CalibrationStore {
        val mayLoad = CountDownLatch(1)
        val maySave = CountDownLatch(1)
        val saves = AtomicInteger()
        private val calls = AtomicInteger()
        val overlaps = AtomicInteger()

        @Volatile
        var fails: Exception? = null

        private fun <T> call(what: () -> T): T {
            if (calls.incrementAndGet() > 1) overlaps.incrementAndGet()
            return try {
                what()
            } finally {
                calls.decrementAndGet()
            }
        }

        override fun load() = call { mayLoad.await().let { text } }

        override fun save(text: String) = call {
            saves.incrementAndGet()
            maySave.await()
            fails?.let { throw it }
            this.text = text
        }
    }

    private val readings = CopyOnWriteArrayList<CompensatedReading>()

    private fun play(steps: Int) = repeat(steps) { phone.advance(still = false).forEach(sensors::deliver) }

    private suspend fun until(what: () -> Boolean) = withTimeout(120_000) { while (!what()) delay(1) }

    private fun collected(store: CalibrationStore, body: suspend (Compass) -> Unit) = runBlocking {
        val compass = Compass(sensors.source(), store = store, grace = ZERO)
        val job = CoroutineScope(Dispatchers.Unconfined).launch { compass.readings().collect(readings::add) }
        body(compass)
        job.cancelAndJoin()
        compass.close()
    }

    private fun learned() = Compensator().use { it.pushAll(List(3000) { phone.advance(still = false) }.flatten()).let { _ -> it.keep(NOW_S)!! } }

    @Test
    fun `a save that takes long holds no reading, and is not asked for again meanwhile`() {
        val store = Slow().apply { mayLoad.countDown() }
        collected(store) {
            sensors.registered(3)
            play(6000)
            assertEquals(6000, readings.size, "all within their events")
            until { store.saves.get() == 1 }
            store.maySave.countDown()
            until { store.text != null }
            // the next is due long since
            play(30)
            until { store.saves.get() == 2 }
        }
        assertTrue(store.saves.get() in 2..3, "and at the end where it has changed: ${store.saves.get()}")
        assertEquals(0, store.overlaps.get())
    }

    @Test
    fun `what is loaded late is taken over then, unless better was learned`() {
        val text = learned()
        for (isLearned in listOf(false, true)) {
            readings.clear()
            val store = Slow(text).apply { maySave.countDown() }
            collected(store) { compass ->
                // the run goes on without
                sensors.registered(3)
                play(if (isLearned) 3000 else 5)
                assertEquals(isLearned, readings.last().reading.fieldUt != null)
                val before = compass.kept!!.compensator.calibration()
                store.mayLoad.countDown()
                if (isLearned) {
                    withTimeout(120_000) { compass.kept!!.settled() }
                    play(1)
                    assertEquals(before!!.hardIronUt.x, compass.kept!!.compensator.calibration()!!.hardIronUt.x, 0.5)
                } else {
                    withTimeout(120_000) { while (readings.last().reading.fieldUt == null) play(1).also { yield() } }
                    assertTrue(readings.size < 1000, "too soon to be learned: ${readings.size}")
                }
            }
        }
    }

    @Test
    fun `an error of a load or a save is told with the readings, and gone after a save that went well`() {
        val store = object : CalibrationStore {
            @Volatile
            var isFull = true

            override fun load(): String? = throw IllegalStateException("no such file")

            override fun save(text: String) {
                if (isFull) throw IllegalStateException("the disk is full")
            }
        }
        collected(store) {
            sensors.registered(3)
            play(1)
            assertEquals("no such file", readings.last().storeError!!.message)
            withTimeout(120_000) { while (readings.last().storeError?.message != "the disk is full") play(1).also { yield() } }
            store.isFull = false
            withTimeout(120_000) { while (readings.last().storeError != null) play(1).also { yield() } }
        }
    }

    @Test
    fun `what a store refused is saved at the next end, though it is still the same`() = runBlocking {
        val store = object : CalibrationStore {
            val asked = AtomicInteger()

            @Volatile
            var text: String? = null

            override fun load(): String? = null

            override fun save(text: String) {
                if (asked.incrementAndGet() == 1) throw IllegalStateException("once")
                this.text = text
            }
        }
        val compass = Compass(sensors.source(), store = store, grace = ZERO)
        // two runs of one calibration: the second has one event of gravity
        repeat(2) { run ->
            val job = CoroutineScope(Dispatchers.Unconfined).launch { compass.readings().collect(readings::add) }
            sensors.registered(3)
            if (run == 0) withTimeout(120_000) { while (store.asked.get() == 0) play(1).also { yield() } }
            if (run == 1) sensors.deliver(SensorSample.Up(UpSample(phone.timeNs + STEP_NS, DeviceVector(0.0, 0.0, 9.81))))
            job.cancelAndJoin()
        }
        until { store.text != null }
        assertEquals(2, store.asked.get())
        compass.close()
    }

    @Test
    fun `a run waits 0,1 s for what is kept, and no longer`() = runTest {
        for ((afterMs, isThere) in listOf(90L to false, 110L to true)) {
            val store = Slow()
            val compass = Compass(sensors.source(), CompensationConfig(), store, grace = ZERO, StandardTestDispatcher(testScheduler))
            val job = launch { compass.readings().collect { } }
            advanceTimeBy(afterMs)
            // the time is the test's, the thread of the sensors is its own
            if (isThere) {
                withContext(Dispatchers.Default) { sensors.registered(3) }
            } else {
                assertEquals(0, sensors.registrations.size, "after $afterMs ms")
            }
            store.mayLoad.countDown()
            store.maySave.countDown()
            job.cancelAndJoin()
        }
    }

    @Test
    fun `a run begins with what is kept, which who leaves waits to be saved`() {
        val store = Slow(learned()).apply {
            mayLoad.countDown()
            maySave.countDown()
        }
        collected(store) {
            sensors.registered(3)
            play(1)
            assertNotNull(readings.single().reading.fieldUt)
            store.text = null
            play(3000)
        }
        assertNotNull(store.text, "before the collector has left")
        assertNull(readings.last().storeError)
    }
}
