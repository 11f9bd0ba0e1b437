package org.magcomp

import android.hardware.Sensor
import java.lang.ref.WeakReference
import java.util.concurrent.CopyOnWriteArrayList
import java.util.concurrent.atomic.AtomicInteger
import kotlin.time.Duration.Companion.ZERO
import kotlin.time.Duration.Companion.milliseconds
import kotlin.time.Duration.Companion.seconds
import kotlinx.coroutines.CompletableDeferred
import kotlinx.coroutines.CoroutineScope
import kotlinx.coroutines.Dispatchers
import kotlinx.coroutines.ExperimentalCoroutinesApi
import kotlinx.coroutines.NonCancellable
import kotlinx.coroutines.async
import kotlinx.coroutines.awaitCancellation
import kotlinx.coroutines.cancelAndJoin
import kotlinx.coroutines.delay
import kotlinx.coroutines.flow.first
import kotlinx.coroutines.flow.flow
import kotlinx.coroutines.flow.take
import kotlinx.coroutines.flow.toList
import kotlinx.coroutines.launch
import kotlinx.coroutines.runBlocking
import kotlinx.coroutines.test.StandardTestDispatcher
import kotlinx.coroutines.test.advanceTimeBy
import kotlinx.coroutines.test.runCurrent
import kotlinx.coroutines.test.runTest
import kotlinx.coroutines.withContext
import kotlinx.coroutines.withTimeout
import kotlinx.coroutines.yield
import org.junit.jupiter.api.AfterEach
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertNotNull
import org.junit.jupiter.api.Assertions.assertNull
import org.junit.jupiter.api.Assertions.assertThrows
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.core.*

/** One compass, collected by screens that come and go. */
@OptIn(ExperimentalCoroutinesApi::class) // the clock of a test
class SharedCompassTest {
    private val sensors =
        FakeSensorManager(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, Sensor.TYPE_GRAVITY, Sensor.TYPE_GYROSCOPE, hardIron = false)
    private val events = events(tumbling(2000)).map(::inFloats)
    private val stores = mutableListOf<Store>()

    /** Takes its time, and knows when it is called at a wrong one. */
    private inner class Store(val delayMs: Long) : CalibrationStore {
        @Volatile
        var text: String? = null
        val loads = AtomicInteger()
        val saves = AtomicInteger()
        private val calls = AtomicInteger()
        val overlapped = AtomicInteger()

        init {
            stores += this
        }

        private fun <T> call(what: () -> T): T {
            if (calls.incrementAndGet() > 1) overlapped.incrementAndGet()
            Thread.sleep(delayMs)
            return what().also { calls.decrementAndGet() }
        }

        override fun load() = call { text.also { loads.incrementAndGet() } }

        override fun save(text: String) = call { this.text = text.also { saves.incrementAndGet() } }
    }

    @AfterEach
    fun `no sensor was registered twice, and no call of a store came within another`() {
        assertTrue(sensors.most.get() <= 1, "${sensors.most.get()} registrations of one sensor")
        for (store in stores) assertEquals(0, store.overlapped.get())
    }

    @Test
    fun `200 rotations change nothing`() = runBlocking {
        val expected = Compensator(CompensationConfig(heading = HeadingConfig(axis = ReferenceAxis.AUTO))).use { it.pushAll(events) }
        for (store in listOf(Store(0), Store(30))) {
            val compass = Compass(sensors.source(), store = store)
            for (rotation in 0 until 200) {
                val part = events.subList(20 * rotation, 20 * rotation + 20)
                val screen = async { compass.readings().first { it.sample.timeNs == part.last().timeNs } }
                registered(3)
                // some come before the screen is back
                part.forEach(sensors::deliver)
                assertEquals(expected[10 * rotation + 9], screen.await().reading, "after rotation $rotation")
                assertEquals(3, sensors.registrations.size)
            }
            assertEquals(1, store.loads.get())
            ended()
            assertNotNull(store.text)
        }
    }

    @Test
    fun `200 rotations that take longer than the sensors go on never lose the calibration`() = runBlocking {
        for (store in listOf(Store(0), Store(3))) {
            val compass = Compass(sensors.source(), store = store, grace = ZERO)
            var calibrated = false
            for (rotation in 0 until 200) {
                val part = events.subList(20 * rotation, 20 * rotation + 20)
                val screen = async { compass.readings().take(10).toList() }
                registered(3)
                part.forEach(sensors::deliver)
                val readings = screen.await()
                assertEquals(0, sensors.registrations.size)
                if (calibrated) assertTrue(readings.all { it.reading.fieldUt != null }, "lost at rotation $rotation")
                calibrated = calibrated || readings.last().reading.fieldUt != null
                // the process may die now
                assertEquals(calibrated, store.text != null)
            }
            assertTrue(calibrated)
            assertEquals(1, store.loads.get())
            // and with the process: what the last rotation had
            val next = async { Compass(sensors.source(), store = store, grace = ZERO).readings().first() }
            registered(3)
            sensors.deliver(events[1])
            assertNotNull(next.await().reading.fieldUt)
        }
    }

    @Test
    fun `a second collector gets the latest reading at once and then the same`() = runBlocking {
        val compass = Compass(sensors.source(), grace = ZERO)
        val collected = List(3) { CopyOnWriteArrayList<CompensatedReading>() }
        fun collecting(n: Int, count: Int) = async { compass.readings().take(count).toList(collected[n]) }
        suspend fun arrived(vararg counts: Int) =
            withTimeout(120_000) { while (collected.map { it.size } != counts.toList()) yield() }
        fun field(k: Long) = sensors.deliver(SensorSample.Magnetic(MagneticSample(k, DeviceVector(1.0, 2.0, k.toDouble()))))

        val one = collecting(0, 4)
        registered(3)
        field(1)
        arrived(1, 0, 0)
        field(2)
        arrived(2, 0, 0)
        val two = collecting(1, 2)
        val three = collecting(2, 3)
        arrived(2, 1, 1)
        field(3)
        arrived(3, 2, 2)
        field(4)
        assertEquals(listOf(1L, 2L, 3L, 4L), one.await().map { it.sample.timeNs })
        assertEquals(listOf(2L, 3L), two.await().map { it.sample.timeNs })
        assertTrue(two.await()[1] === one.await()[2], "one estimator")
        assertEquals(0L, (one.await() + two.await() + three.await()).sumOf { it.droppedBefore }, "what came before a collector is not dropped")
        assertEquals(0, sensors.registrations.size)
    }

    @Test
    fun `what is left by the last collector is saved before the grace time has passed`() = runBlocking {
        val store = Store(0)
        val compass = Compass(sensors.source(), store = store, grace = 600.seconds)
        val screen = launch { compass.readings().collect { } }
        registered(3)
        for (event in events.take(1000)) sensors.deliver(event)
        val last = compass.readings().first { it.sample.timeNs == events[999].timeNs }
        assertEquals(CompensationStatus.Tracking, last.reading.status)
        val before = store.saves.get()
        screen.cancelAndJoin()
        withTimeout(120_000) { while (store.saves.get() == before) delay(1) }
        assertEquals(3, sensors.registrations.size, "the sensors go on")
        val kept = Compensator().use { it.apply { adoptKept(store.text!!, null) }.calibration()!! }
        val found = Compensator().use { it.apply { pushAll(events.take(1000)) }.calibration()!! }
        assertEquals(found.hardIronUt, kept.hardIronUt)
    }

    @Test
    fun `after the grace time the sensors rest, and the next collector goes on with what was learned`() = runBlocking {
        val compass = Compass(sensors.source(), grace = 1.milliseconds)
        val collecting = launch { compass.readings().first { it.sample.timeNs == events[999].timeNs } }
        registered(3)
        events.take(1000).forEach(sensors::deliver)
        collecting.join()
        ended()
        val next = async { compass.readings().first() }
        registered(3)
        val later = (events[1999] as SensorSample.Magnetic).sample
        sensors.deliver(SensorSample.Magnetic(later))
        val reading = next.await()
        assertEquals(later.timeNs, reading.sample.timeNs, "nothing of before")
        assertNotNull(reading.reading.fieldUt)
        assertTrue(reading.reading.window > 100, "the whole state was kept: ${reading.reading.window}")
    }

    @Test
    fun `who comes back within the grace time ends it, and who leaves again has all of it`() = runTest {
        val compass = Compass(sensors.source(), CompensationConfig(), null, grace = 5.seconds, StandardTestDispatcher(testScheduler))
        suspend fun visit() {
            val screen = launch { compass.readings().collect { } }
            runCurrent()
            assertEquals(3, sensors.registrations.size)
            screen.cancelAndJoin()
            runCurrent()
        }
        visit()
        advanceTimeBy(1000)
        visit()
        val again = launch { compass.readings().collect { } }
        advanceTimeBy(3000)
        again.cancelAndJoin()
        // the first grace time would end at 5 s
        for ((ms, registered) in listOf(1001L to 3, 3990L to 3, 20L to 0)) {
            advanceTimeBy(ms)
            runCurrent()
            assertEquals(registered, sensors.registrations.size, "$ms")
        }
        assertEquals(1, sensors.most.get())
    }

    @Test
    fun `after an error the next collector begins anew`() = runBlocking {
        val compass = Compass(sensors.source())
        sensors.refuse = Sensor.TYPE_GRAVITY
        repeat(2) { assertThrows(SensorException.Refused::class.java) { runBlocking { compass.readings().first() } } }
        sensors.refuse = null
        val next = async { compass.readings().first() }
        registered(3)
        sensors.deliver(events[1])
        assertNull(next.await().reading.fieldUt)
        ended()
    }

    @Test
    fun `a source is collected on a thread that does nothing else, a store is called elsewhere`() = runBlocking {
        val (sources, stores) = List(2) { CopyOnWriteArrayList<String>() }
        fun here() = Thread.currentThread().name.substringBefore(" @")
        val store = object : CalibrationStore {
            override fun load(): String? = null.also { stores += here() }

            override fun save(text: String) {
                stores += here()
            }
        }
        val source = object : FlowSource() {
            override fun played() = flow { for (event in events.take(1000)) emit(event.also { sources += here() }) }
        }
        Compass(source, store = store).readings().toList()
        assertEquals(setOf("magcomp compass"), sources.toSet())
        assertTrue(stores.size >= 2 && "magcomp compass" !in stores, "$stores")
    }

    @Test
    fun `after a defect the next collector begins anew`() = runBlocking {
        val store = Store(0)
        val compass = Compass(sensors.source(), store = store, grace = ZERO)
        val arrived = CopyOnWriteArrayList<CompensatedReading>()
        val broken = async { runCatching { compass.readings().toList(arrived) }.exceptionOrNull() }
        registered(3)
        events.take(1000).forEach(sensors::deliver)
        withTimeout(120_000) { while (arrived.lastOrNull()?.sample?.timeNs != events[999].timeNs) yield() }
        TestHooks.panicOnPurpose(compass.kept!!.compensator.handle)
        sensors.deliver(events[1001])
        assertTrue(broken.await() is MagcompException.Panicked)
        assertEquals(0, sensors.registrations.size)
        val next = async { compass.readings().first() }
        registered(3)
        sensors.deliver(events[1003])
        assertNotNull(next.await().reading.fieldUt, "with what the store has")
    }

    @Test
    fun `a recording that is played again keeps the calibration alone`() = runBlocking {
        val recording = repository.resolve("tests/recordings/broad_34_attached_magnet_3cm.csv.gz")
        val compass = Compass(RecordingSource(recording))
        val first = compass.readings().toList()
        val again = compass.readings().first()
        assertTrue(again.reading.status !is CompensationStatus.Rejected, "${again.reading.status}")
        assertNotNull(again.reading.fieldUt)
        assertTrue(again.sample.timeNs < first.last().sample.timeNs)
    }

    @Test
    fun `an Error of the source ends every collector with it`() = runBlocking {
        val broken = object : FlowSource() {
            override fun played() = flow {
                emit(events.first { it is SensorSample.Magnetic })
                delay(50)
                throw StackOverflowError("on purpose")
            }
        }
        val compass = Compass(broken)
        // on a phone, what nobody catches ends the app
        val uncaught = CopyOnWriteArrayList<Throwable>()
        val before = Thread.getDefaultUncaughtExceptionHandler()
        Thread.setDefaultUncaughtExceptionHandler { _, error -> uncaught += error }
        try {
            val ends = List(3) { async { runCatching { compass.readings().toList() }.exceptionOrNull() } }
            for (end in ends) assertTrue(withTimeout(120_000) { end.await() } is StackOverflowError)
            compass.close()
            withTimeout(120_000) { while (compass.kept != null) yield() }
        } finally {
            Thread.setDefaultUncaughtExceptionHandler(before)
        }
        assertEquals(emptyList<Throwable>(), uncaught.toList())
    }

    @Test
    fun `closing ends every collector, saves, frees the sensors and the estimator`() = runBlocking {
        for (delivered in listOf(0, 1000)) {
            val store = Store(0)
            val compass = Compass(sensors.source(), store = store)
            val arrived = CopyOnWriteArrayList<CompensatedReading>()
            val collectors = List(2) { async { compass.readings().toList(arrived) } }
            registered(3)
            events.take(delivered).forEach(sensors::deliver)
            fun last() = arrived.count { it.sample.timeNs == events[999].timeNs }
            withTimeout(120_000) { while (delivered > 0 && last() < 2) yield() }
            val estimation = compass.kept
            compass.close()
            compass.close()
            for (collector in collectors) withTimeout(120_000) { collector.await() }
            ended()
            withTimeout(120_000) { while (compass.kept != null) yield() }
            assertEquals(delivered > 0, store.text != null)
            estimation?.let { assertThrows(MagcompException.Closed::class.java) { it.compensator.calibration() } }
            assertThrows(MagcompException.Closed::class.java) { runBlocking { compass.readings().first() } }
        }
        // nobody ever collected
        Compass(sensors.source()).close()
    }

    @Test
    fun `what comes after a collector has left is kept for nobody`() = runBlocking {
        val compass = Compass(sensors.source(), grace = ZERO)
        val staying = CoroutineScope(Dispatchers.Unconfined).launch { compass.readings().collect { } }
        registered(3)
        CoroutineScope(Dispatchers.Unconfined).launch { compass.readings().collect { } }.cancelAndJoin()
        var told: WeakReference<CompensatedReading>? = null
        val seeing = CoroutineScope(Dispatchers.Unconfined).launch { compass.readings().collect { told = WeakReference(it) } }
        sensors.deliver(events[1])
        seeing.cancelAndJoin()
        // the latest is kept for who joins
        sensors.deliver(events[3])
        withTimeout(120_000) { while (told!!.get() != null) delay(1).also { System.gc() } }
        staying.cancelAndJoin()
    }

    @Test
    fun `a run that begins with an event a little too late goes on, one of another clock does not`() = runBlocking {
        for ((backNs, goesOn) in listOf(1_000_000L to true, 999_000_000L to true, 1_001_000_000L to false)) {
            val compass = Compass(sensors.source(), grace = ZERO)
            val phone = Phone(1)
            fun play(steps: Int) = repeat(steps) { phone.advance(still = false).forEach(sensors::deliver) }
            val readings = CopyOnWriteArrayList<CompensatedReading>()
            suspend fun run(body: () -> Unit) {
                val job = CoroutineScope(Dispatchers.Unconfined).launch { compass.readings().collect(readings::add) }
                registered(3)
                body()
                job.cancelAndJoin()
            }
            run { play(1500) }
            val before = readings.last().reading
            assertEquals(CompensationStatus.Tracking, before.status)
            readings.clear()
            run {
                sensors.deliver(SensorSample.Up(UpSample(phone.timeNs - backNs, DeviceVector(0.0, 0.0, 9.81))))
                play(1)
            }
            assertEquals(goesOn, readings.last().reading.window >= before.window, "$backNs")
            compass.close()
        }
    }

    /** Knows how many of its runs are under way, and takes its time to end one. */
    private class Slow(private val error: Throwable? = null) : FlowSource() {
        private val running = AtomicInteger()
        val most = AtomicInteger()
        val ends = AtomicInteger()

        override fun played() = flow {
            running.incrementAndGet().let { now -> most.updateAndGet { maxOf(it, now) } }
            try {
                events(tumbling(2)).forEach { emit(it) }
                error?.let { throw it }
                awaitCancellation()
            } finally {
                withContext(NonCancellable) { delay(20) }
                running.decrementAndGet()
                ends.incrementAndGet()
            }
        }
    }

    @Test
    fun `a run begins only after the one before has ended`() = runBlocking {
        for (graceMs in listOf(0L, 1L)) {
            val slow = Slow()
            val compass = Compass(slow, grace = graceMs.milliseconds)
            val screens = List(20) { k ->
                launch(Dispatchers.Default) {
                    delay(7L * k)
                    compass.readings().first()
                }
            }
            withTimeout(120_000) { screens.forEach { it.join() } }
            withTimeout(120_000) { while (slow.ends.get() == 0) yield() }
            assertEquals(1, slow.most.get())
        }
    }

    @Test
    fun `an estimator with a defect is closed, and another begins`() = runBlocking {
        val defect = MagcompException.Panicked("of a test")
        val compass = Compass(Slow(defect), grace = ZERO)
        val broken = CompletableDeferred<Estimation>()
        val error = runCatching { compass.readings().collect { broken.complete(compass.kept!!) } }.exceptionOrNull()
        assertEquals("of a test", (error as MagcompException.Panicked).what)
        val estimation = broken.await()
        assertThrows(MagcompException.Closed::class.java) { estimation.compensator.calibration() }
        assertTrue(compass.readings().first().reading.status is CompensationStatus.Collecting)
    }

    private suspend fun registered(count: Int) = withTimeout(120_000) { while (sensors.registrations.size < count) yield() }

    private suspend fun ended() = withTimeout(120_000) { while (sensors.registrations.isNotEmpty() || sensors.threads > 0) delay(1) }
}
