package org.magcomp

import android.hardware.Sensor
import java.util.concurrent.CopyOnWriteArrayList
import java.util.concurrent.CountDownLatch
import java.util.concurrent.Executor
import java.util.concurrent.TimeUnit
import java.util.concurrent.atomic.AtomicInteger
import java.util.concurrent.atomic.AtomicReference
import kotlin.concurrent.thread
import kotlin.time.Duration.Companion.ZERO
import kotlinx.coroutines.CoroutineScope
import kotlinx.coroutines.Dispatchers
import kotlinx.coroutines.async
import kotlinx.coroutines.cancelAndJoin
import kotlinx.coroutines.delay
import kotlinx.coroutines.flow.first
import kotlinx.coroutines.flow.flow
import kotlinx.coroutines.flow.last
import kotlinx.coroutines.flow.toList
import kotlinx.coroutines.launch
import kotlinx.coroutines.runBlocking
import kotlinx.coroutines.withTimeout
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertNotNull
import org.junit.jupiter.api.Assertions.assertNotSame
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.core.*

/** An app's code that blocks, throws or leaves no dispatcher free holds up nobody else. */
class ForeignCodeTest {
    private val sensors = FakeSensorManager(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, Sensor.TYPE_GRAVITY, Sensor.TYPE_GYROSCOPE)

    // as in an app: what a collector does is done elsewhere
    private val source = sensors.source(executor = FakeSensorManager.ELSEWHERE)
    private val phone = Phone(1)
    private val gate = CountDownLatch(1)

    private fun play(steps: Int) = repeat(steps) { phone.advance(still = false).forEach(sensors::deliver) }

    private suspend fun until(what: () -> Boolean) = withTimeout(120_000) { while (!what()) delay(1) }

    /** Stays until the gate opens, and says so. */
    private inner class Blocked {
        val calls = AtomicInteger()

        fun call() {
            calls.incrementAndGet()
            check(gate.await(300, TimeUnit.SECONDS))
        }
    }

    /** While some code is blocked another compass has each of its readings, and who joins the source gets its events. */
    private fun othersGoOn(blocked: Blocked) = runBlocking {
        val other = Compass(source, grace = ZERO)
        val got = CopyOnWriteArrayList<CompensatedReading>()
        val collecting = CoroutineScope(Dispatchers.IO).launch { other.readings().collect(got::add) }
        sensors.registered(3)
        until { (blocked.calls.get() > 0 && got.isNotEmpty()).also { play(1) } }
        val before = got.size
        play(500)
        until { got.size >= before + 500 }
        assertEquals(1, blocked.calls.get(), "it is blocked all the time")
        val joined = async(Dispatchers.IO) { source.samples().first() }
        until { joined.isCompleted.also { play(1) } }
        assertEquals(1, sensors.most.get())
        gate.countDown()
        collecting.cancelAndJoin()
        assertEquals(0L, got.sumOf { it.droppedBefore })
    }

    @Test
    fun `a listener that blocks, on an executor that runs at once`() {
        val blocked = Blocked()
        val listener = object : HeadingListener {
            override fun onHeading(reading: CompassReading) = if (gate.count > 0) blocked.call() else Unit

            override fun onEnd(error: Exception?) = Unit
        }
        Compass(source, grace = ZERO).start(Executor { it.run() }, listener).use { othersGoOn(blocked) }
    }

    @Test
    fun `an unconfined collector that blocks, of headings, of events, of the sensors in use`() {
        for (use in 0..2) {
            val test = ForeignCodeTest()
            val blocked = test.Blocked()
            val here = CoroutineScope(Dispatchers.Unconfined).launch {
                when (use) {
                    0 -> Compass(test.source, grace = ZERO).headings().collect { if (test.gate.count > 0) blocked.call() }
                    1 -> test.source.samples().collect { if (test.gate.count > 0) blocked.call() }
                    else -> test.source.sensors.collect { if (it != null && test.gate.count > 0) blocked.call() }
                }
            }
            test.othersGoOn(blocked)
            runBlocking { here.cancelAndJoin() }
        }
    }

    @Test
    fun `a thread of an app's own source delivers no longer than a reading is told`() = runBlocking {
        val delivers = CopyOnWriteArrayList<Boolean>()
        val own = object : FlowSource() {
            override fun played() = flow {
                for (event in events(tumbling(2))) {
                    emit(event)
                    delivers += Handover.isDelivering()
                }
            }
        }
        assertEquals(2, Compass(own, grace = ZERO).readings().toList().size)
        assertEquals(List(4) { false }, delivers.toList())
    }

    @Test
    fun `the rotation of Java's screen is asked on its executor`() = runBlocking {
        val main = java.util.concurrent.Executors.newSingleThreadExecutor { Thread(it, "main of the app") }
        val asked = CopyOnWriteArrayList<String>()
        val listener = object : HeadingListener {
            override fun onHeading(reading: CompassReading) = Unit

            override fun onEnd(error: Exception?) = Unit
        }
        val running = Compass(source, grace = ZERO).start(main, listener) {
            asked += Thread.currentThread().name.substringBefore(" @")
            ScreenRotation.DEG0
        }
        sensors.registered(3)
        until { (asked.size > 1).also { play(1) } }
        assertEquals(setOf("main of the app"), asked.toSet())
        running.close()
        main.shutdown()
        until { sensors.registrations.isEmpty() }
    }

    @Test
    fun `who is led off a thread that delivers is on another one, however quick that is`() {
        // it has gone on before `execute` returns
        Handover.executor = Executor { task -> thread { task.run() }.join() }
        var there: Thread? = null
        val here = thread {
            Handover.delivers()
            CoroutineScope(Dispatchers.Unconfined).launch {
                Handover.away()
                there = Thread.currentThread()
            }
        }
        here.join()
        assertNotNull(there)
        assertNotSame(here, there)
    }

    @Test
    fun `the end of a listener that throws, on an executor that runs at once, is told on another thread than that which delivers`() = runBlocking {
        // as quick as can be: the listener has thrown before the thread that delivers goes on
        val source = sensors.source(executor = { task -> thread { task.run() }.join() })
        val told = AtomicReference<Pair<Thread, Exception?>>()
        val listener = object : CompassReadingListener {
            override fun onReading(reading: CompensatedReading) = error("of the app")

            override fun onEnd(error: Exception?) = told.set(Thread.currentThread() to error)
        }
        // within the grace time, so that nothing ends before it is told
        val compass = Compass(source)
        compass.start(Executor { it.run() }, listener)
        sensors.registered(3)
        play(1)
        val (thread, error) = told.get()
        assertEquals("of the app", error!!.message)
        assertNotSame(Thread.currentThread(), thread)
        compass.close()
        until { sensors.registrations.isEmpty() }
    }

    @Test
    fun `a listener that waits for a thread which begins to collect the same source`() = runBlocking {
        val main = java.util.concurrent.Executors.newSingleThreadExecutor()
        val waited = CountDownLatch(1)
        val entered = CountDownLatch(1)
        val begun = CountDownLatch(1)
        val listener = object : HeadingListener {
            override fun onHeading(reading: CompassReading) {
                if (entered.count == 0L) return
                entered.countDown()
                begun.await()
                main.submit { }.get()
                waited.countDown()
            }

            override fun onEnd(error: Exception?) = Unit
        }
        val running = Compass(source, grace = ZERO).start(Executor { it.run() }, listener)
        sensors.registered(3)
        val player = CoroutineScope(Dispatchers.IO).launch { while (true) play(1).also { delay(1) } }
        assertTrue(entered.await(120, TimeUnit.SECONDS))
        main.execute { runBlocking { begun.countDown(); source.samples().first() } }
        assertTrue(waited.await(120, TimeUnit.SECONDS), "neither waits for the other")
        player.cancelAndJoin()
        running.close()
        main.shutdown()
    }

    @Test
    fun `while nothing else runs on the default dispatcher a compass begins, goes on and ends`() = runBlocking {
        val busy = List(maxOf(2, Runtime.getRuntime().availableProcessors())) { CountDownLatch(1) }
        val jobs = busy.map { begun -> CoroutineScope(Dispatchers.Default).launch { begun.countDown(); gate.await() } }
        busy.forEach { assertTrue(it.await(120, TimeUnit.SECONDS)) }
        try {
            val got = CopyOnWriteArrayList<CompassReading>()
            val stores = AtomicInteger()
            val store = object : CalibrationStore {
                override fun load(): String? = null.also { stores.incrementAndGet() }

                override fun save(text: String) = Unit
            }
            val compass = Compass(source, store = store, grace = ZERO)
            val screen = CoroutineScope(Dispatchers.IO).launch { compass.headings().collect(got::add) }
            until { sensors.registrations.size == 3 }
            until { got.isNotEmpty().also { play(1) } }
            assertEquals(1, stores.get())
            screen.cancel()
            until { sensors.registrations.isEmpty() && sensors.threads == 0 }
            compass.close()
            until { compass.kept == null }
        } finally {
            gate.countDown()
            jobs.forEach { it.join() }
        }
    }

    @Test
    fun `an Error of a store is told with the readings, and ends nothing`() = runBlocking {
        val uncaught = CopyOnWriteArrayList<Throwable>()
        val before = Thread.getDefaultUncaughtExceptionHandler()
        Thread.setDefaultUncaughtExceptionHandler { _, error -> uncaught += error }
        try {
            val store = object : CalibrationStore {
                override fun load(): String? = throw NoClassDefFoundError("of the app")

                override fun save(text: String): Unit = throw StackOverflowError("of the app")
            }
            val compass = Compass(source, store = store, grace = ZERO)
            val got = CopyOnWriteArrayList<CompensatedReading>()
            val screen = CoroutineScope(Dispatchers.IO).launch { compass.readings().collect(got::add) }
            sensors.registered(3)
            until { got.isNotEmpty().also { play(1) } }
            assertTrue(got.last().storeError!!.cause is NoClassDefFoundError, "${got.last().storeError}")
            until { (got.last().storeError?.cause is StackOverflowError).also { play(10) } }
            screen.cancelAndJoin()
            compass.close()
            until { compass.kept == null }
        } finally {
            Thread.setDefaultUncaughtExceptionHandler(before)
        }
        assertEquals(emptyList<Throwable>(), uncaught.toList())
    }

    @Test
    fun `a collector that waits for another who joins gets it`() = runBlocking {
        // even where it runs within the reading's own call
        val compass = Compass(sensors.source(), grace = ZERO)
        val other = AtomicInteger()
        val joined = CountDownLatch(1)
        val waiting = CoroutineScope(Dispatchers.Unconfined).launch {
            compass.readings().collect {
                if (joined.count == 0L) return@collect
                CoroutineScope(Dispatchers.IO).launch {
                    compass.readings().collect {
                        other.incrementAndGet()
                        joined.countDown()
                    }
                }
                assertTrue(joined.await(120, TimeUnit.SECONDS), "the reading that is told is there for who joins")
            }
        }
        sensors.registered(3)
        play(1)
        assertEquals(1, other.get())
        waiting.cancelAndJoin()
        compass.close()
        until { sensors.registrations.isEmpty() }
    }

    @Test
    fun `closing ends the states, for who collects them and for who comes later`() = runBlocking {
        val compass = Compass(sensors.source(), grace = ZERO)
        val states = CopyOnWriteArrayList<CompassState>()
        val screen = CoroutineScope(Dispatchers.Unconfined).launch { compass.states().collect(states::add) }
        sensors.registered(3)
        play(1500)
        assertNotNull((states.last() as CompassState.Live).reading.headingDeg)
        compass.close()
        screen.join()
        assertTrue((states.last() as CompassState.Ended).error is MagcompException.Closed, "${states.last()}")
        until { sensors.registrations.isEmpty() }
        val late = withTimeout(120_000) { compass.states().toList() }
        assertEquals(CompassState.Waiting, late[0])
        assertTrue((late[1] as CompassState.Ended).error is MagcompException.Closed, "$late")
    }

    @Test
    fun `the end of a source is the end of the states, without an error, and of who listens, also where the source knows its sensors`() = runBlocking {
        class Finite : MagneticFieldSource {
            override suspend fun deliver(taker: EventTaker) {
                taker.heard(SensorsInUse(UsedSensor(Sensor.TYPE_MAGNETIC_FIELD, "m", "", SensorAccuracy.HIGH), null, null, null))
                Played(events(tumbling(3))).deliver(taker)
            }
        }
        val ended = withTimeout(120_000) { Compass(Finite()).states().last() } as CompassState.Ended
        assertEquals(null, ended.error)
        val told = java.util.concurrent.CompletableFuture<Pair<Int, Exception?>>()
        val listener = object : CompassReadingListener {
            var count = 0

            override fun onReading(reading: CompensatedReading) {
                count += 1
                assertEquals("m", reading.sensors!!.magnetometer.name)
            }

            override fun onEnd(error: Exception?) {
                told.complete(count to error)
            }
        }
        Compass(Finite()).start(Executor { it.run() }, listener)
        assertEquals(3 to null, told.get(20, TimeUnit.SECONDS))
    }
}
