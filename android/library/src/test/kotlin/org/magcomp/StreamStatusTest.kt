package org.magcomp

import android.hardware.Sensor
import android.hardware.SensorManager
import android.os.Handler
import java.util.concurrent.CopyOnWriteArrayList
import java.util.concurrent.Executor
import java.util.concurrent.LinkedBlockingQueue
import java.util.concurrent.TimeUnit
import kotlin.math.IEEErem
import kotlin.math.abs
import kotlin.time.Duration.Companion.ZERO
import kotlinx.coroutines.CoroutineScope
import kotlinx.coroutines.Dispatchers
import kotlinx.coroutines.Job
import kotlinx.coroutines.cancelAndJoin
import kotlinx.coroutines.flow.asFlow
import kotlinx.coroutines.flow.first
import kotlinx.coroutines.flow.toList
import kotlinx.coroutines.launch
import kotlinx.coroutines.runBlocking
import kotlinx.coroutines.withTimeout
import kotlinx.coroutines.yield
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertNotEquals
import org.junit.jupiter.api.Assertions.assertNotNull
import org.junit.jupiter.api.Assertions.assertNull
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.core.*

/** A heading that has stopped, or can't be, says so. */
class StreamStatusTest {
    private val mag = Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED
    private val sensors = FakeSensorManager(mag, Sensor.TYPE_GRAVITY, Sensor.TYPE_GYROSCOPE)
    private val phone = Phone(1, beginNs = 20_000_000_000_000)
    private val source = sensors.source()
    private val store = object : CalibrationStore {
        override fun load(): String? = throw IllegalStateException("of the store")

        override fun save(text: String) = throw IllegalStateException("of the store")
    }
    private val compass = Compass(source, store = store, grace = ZERO)
    private val readings = CopyOnWriteArrayList<CompensatedReading>()
    private val resources = englishResources()

    private fun kind(event: SensorSample) = when (event) {
        is SensorSample.Magnetic -> PhoneSensor.MAGNETOMETER
        is SensorSample.RotationRate -> PhoneSensor.GYROSCOPE
        is SensorSample.Up -> PhoneSensor.GRAVITY
    }

    private fun SensorSample.at(timeNs: Long) = when (this) {
        is SensorSample.Magnetic -> copy(sample.copy(timeNs = timeNs))
        is SensorSample.RotationRate -> copy(sample.copy(timeNs = timeNs))
        is SensorSample.Up -> copy(sample.copy(timeNs = timeNs))
    }

    /** So many steps of 10 ms of a phone that is turned. */
    private fun play(steps: Int, vararg mute: PhoneSensor, offNs: (PhoneSensor) -> Long = { 0 }) = repeat(steps) {
        val events = phone.advance(still = false)
        sensors.continuousNs = phone.timeNs
        for (event in events) if (kind(event) !in mute) sensors.deliver(event.at(event.timeNs + offNs(kind(event))))
        Handler.pass(10)
    }

    private fun collected(compass: Compass = this.compass, body: suspend () -> Unit) = runBlocking {
        val job: Job = CoroutineScope(Dispatchers.Unconfined).launch { compass.readings().collect(readings::add) }
        sensors.registered(3)
        body()
        job.cancelAndJoin()
    }

    private val silent = StreamStatus.Silent(setOf(PhoneSensor.MAGNETOMETER))

    @Test
    fun `a magnetometer that falls silent is a reading without a heading, once, until it speaks`() = collected {
        play(1500)
        val before = readings.last()
        assertNotNull(before.reading.heading)
        assertEquals(StreamStatus.Live, before.stream)
        play(1000, PhoneSensor.MAGNETOMETER)
        sensors.tell(mag, SensorManager.SENSOR_STATUS_ACCURACY_LOW)
        assertEquals(1501, readings.size, "told once")
        val told = readings.last()
        assertEquals(silent, told.stream)
        assertEquals(true, told.sensors!!.magnetometer.isSilent)
        assertEquals("of the store", told.storeError!!.message)
        with(told.reading) {
            assertEquals(List<Any?>(5) { null }, listOf(heading, attitude, fieldUt, filteredFieldUt, totalFieldUt))
            assertEquals(List<Any?>(3) { null }, listOf(sigmaT, directionSigmaDeg, worstSigmaDeg))
            assertEquals(Triple(before.sample.timeNs, before.reading.window, before.reading.coverage), Triple(timeNs, window, coverage))
            assertEquals(CompensationStatus.Rejected(RejectReason.NotFinite), status)
        }
        assertTrue(told.sample.fieldUt.x.isNaN())
        val shown = shown(told)
        assertNull(shown.headingDeg)
        assertEquals("the magnetometer delivers nothing", shown.text(resources))
        assertNull(shown.guidance(resources))
        // who joins now is told at once, however long ago it was
        play(1000, PhoneSensor.MAGNETOMETER)
        assertEquals(silent, withTimeout(120_000) { compass.headings().first() }.stream)
        play(1)
        assertEquals(StreamStatus.Live, readings.last().stream)
        assertEquals(phone.timeNs, readings.last().sample.timeNs)
        assertEquals(0L, readings.sumOf { it.droppedBefore })
    }

    @Test
    fun `a silence has no model order`() = collected(Compass(source, CompensationConfig(method = CompensationMethod.ADAPTIVE), grace = ZERO)) {
        play(1500)
        assertNotNull(readings.last().reading.modelOrder)
        play(300, PhoneSensor.MAGNETOMETER)
        assertEquals(silent, readings.last().stream)
        assertNull(readings.last().reading.modelOrder)
    }

    @Test
    fun `who comes back to sensors that are silent is told again`() {
        val others = CoroutineScope(Dispatchers.Unconfined).launch { source.samples().collect { } }
        repeat(2) {
            collected { withTimeout(120_000) { while (readings.lastOrNull()?.stream != silent) play(1, PhoneSensor.MAGNETOMETER).also { yield() } } }
            readings.clear()
        }
        runBlocking { others.cancelAndJoin() }
    }

    @Test
    fun `sensors that never spoke are told, and all of them in one sentence`() = collected {
        play(300, *PhoneSensor.entries.toTypedArray())
        val told = readings.single()
        assertEquals(StreamStatus.Silent(PhoneSensor.entries.toSet()), told.stream)
        assertEquals(Pair(0L, null), Pair(told.reading.timeNs, told.reading.event))
        assertNull(told.reading.heading)
        assertEquals("the sensors deliver nothing; bring the app to the foreground", told.stream.text(resources))
    }

    @Test
    fun `a gyroscope or a gravity that falls silent is told with the readings`() = collected {
        play(1500)
        play(250, PhoneSensor.GYROSCOPE)
        assertEquals(StreamStatus.Silent(setOf(PhoneSensor.GYROSCOPE)), readings.last().stream)
        assertEquals("the gyroscope delivers nothing", readings.last().stream.text(resources))
        assertNotNull(readings.last().reading.heading)
        play(250, PhoneSensor.GRAVITY)
        assertEquals(StreamStatus.Silent(setOf(PhoneSensor.GRAVITY)), readings.last().stream)
        assertNotEquals(StreamStatus.Silent(setOf(PhoneSensor.GYROSCOPE)), readings.last().stream)
        assertEquals("the gravity sensor delivers nothing", readings.last().stream.text(resources))
        play(1)
        assertEquals(StreamStatus.Live, readings.last().stream)
        assertEquals(2001, readings.size)
    }

    @Test
    fun `who joins gets the latest reading while it is less than a second old`() = collected {
        play(100)
        val latest = readings.last()
        sensors.continuousNs += 999_999_999
        assertTrue(withTimeout(120_000) { compass.readings().first() } === latest)
        assertEquals(latest.sample.timeNs, withTimeout(120_000) { compass.headings().first() }.timeNs)
        sensors.continuousNs += 1
        val got = CopyOnWriteArrayList<CompensatedReading>()
        val late = CoroutineScope(Dispatchers.Unconfined).launch { compass.readings().collect(got::add) }
        assertEquals(0, got.size)
        phone.advance(still = false).forEach(sensors::deliver)
        assertEquals(listOf(phone.timeNs to 0L), got.map { it.sample.timeNs to it.droppedBefore })
        late.cancelAndJoin()
    }

    @Test
    fun `who joins screens for whole readings gets the next one, and what came before is not dropped`() = runBlocking {
        val scope = CoroutineScope(Dispatchers.Unconfined)
        val screen = scope.launch { compass.headings().collect { } }
        sensors.registered(3)
        play(100)
        val got = CopyOnWriteArrayList<CompensatedReading>()
        val file = scope.launch { compass.readings().collect(got::add) }
        assertEquals(0, got.size)
        play(2)
        assertEquals(listOf(phone.timeNs - STEP_NS to 0L, phone.timeNs to 0L), got.map { it.sample.timeNs to it.droppedBefore })
        file.cancelAndJoin()
        screen.cancelAndJoin()
    }

    @Test
    fun `a vertical of another time is told after a second`() = collected {
        // as a clock that jumps again and again, so that none can be made out
        var k = 0
        play(99) { if (it == PhoneSensor.GRAVITY) -3_600_000_000_000L * ++k else 0 }
        assertTrue(readings.all { it.stream == StreamStatus.Live })
        play(300) { if (it == PhoneSensor.GRAVITY) -3_600_000_000_000L * ++k else 0 }
        val told = readings.last()
        assertEquals(StreamStatus.NoVertical, told.stream)
        assertNull(told.reading.heading)
        assertEquals("no vertical: the gravity sensor delivers nothing that fits the magnetometer's times", shown(told).text(resources))
    }

    @Test
    fun `a refused sample's time says nothing of the vertical`() = collected {
        play(1500)
        readings.clear()
        repeat(300) {
            sensors.deliver(mag, Long.MAX_VALUE / 2, 1f, 2f, 3f, 0f, 0f, 0f)
            play(1)
        }
        val (refused, taken) = readings.partition { it.reading.status is CompensationStatus.Rejected }
        assertTrue(refused.size >= 290 && taken.size >= 200, "${refused.size} and ${taken.size}")
        assertTrue(readings.all { it.stream == StreamStatus.Live })
    }

    @Test
    fun `of a source without a vertical it is told as well`() = runBlocking {
        val fields = List(300) { phone.advance(still = false) }.flatten().filter { it !is SensorSample.Up }
        val told = fields.asFlow().compensated().toList()
        assertEquals(List(101) { StreamStatus.Live } + List(199) { StreamStatus.NoVertical }, told.map { it.stream })
        // who is asked to turn the phone mends no vertical
        val (live, without) = told.partition { it.stream == StreamStatus.Live }
        assertNotNull(shown(live.last()).guidance(resources))
        assertNotNull(without.first().reading.status.guidance(resources))
        for (reading in without) assertNull(shown(reading).guidance(resources))
        val all = List(300) { phone.advance(still = false) }.flatten()
        assertTrue(all.asFlow().compensated().toList().all { it.stream == StreamStatus.Live })
    }

    @Test
    fun `a sensor with another clock is brought to the magnetometer's within about a second`() {
        val hours = 10_800_000_000_000L
        val same = StreamStatusTest()
        same.collected { same.play(1500) }
        for (off in listOf(
            mapOf(PhoneSensor.MAGNETOMETER to -1_000_000_000L),
            mapOf(PhoneSensor.MAGNETOMETER to hours),
            mapOf(PhoneSensor.GYROSCOPE to -hours),
            mapOf(PhoneSensor.GRAVITY to -hours),
            mapOf(PhoneSensor.GRAVITY to -hours, PhoneSensor.GYROSCOPE to -2 * hours),
        )) {
            readings.clear()
            val other = StreamStatusTest()
            other.collected {
                other.play(1500) { off[it] ?: 0 }
                val found = other.readings.drop(300)
                val last = found.last().reading
                assertEquals(StreamStatus.Live, found.last().stream, "$off")
                assertEquals(SensorMode.GYROSCOPE_AND_GRAVITY, last.mode, "$off")
                assertEquals(CompensationStatus.Tracking, last.status, "$off")
                // only the magnetometer's clock may be behind the phone's, and it is no sleep
                val source = other.source
                assertEquals(0.0, source.hiddenS, "$off")
                assertEquals(1_000L + (off[PhoneSensor.MAGNETOMETER]?.takeIf { abs(it) > 1_000_000_000 } ?: 0), source.eventTimeNs(1_000), "$off")
                // soon as good as with one clock
                for (k in listOf(599, 1199)) {
                    val (one, theirs) = Pair(same.readings[k].reading.heading!!, other.readings[k].reading.heading!!)
                    val apartDeg = abs((one.headingDeg - theirs.headingDeg).IEEErem(360.0))
                    assertTrue(apartDeg < 3 && theirs.headingSigmaDeg!! < 1.3 * one.headingSigmaDeg!!, "$off, $k: $one, $theirs")
                }
            }
        }
    }

    @Test
    fun `a magnetometer that begins late, where the sensors' clock stands in sleep, has the clock of the others`() = runBlocking {
        val got = CopyOnWriteArrayList<SensorSample>()
        val collecting = CoroutineScope(Dispatchers.Unconfined).launch { source.samples().collect { got += it } }
        sensors.registered(3)
        // an hour of sleep before
        fun play(steps: Int, isThere: Boolean) = repeat(steps) {
            val events = phone.advance(still = false)
            sensors.continuousNs = phone.timeNs + 3_600_000_000_000
            for (event in events) if (isThere || kind(event) != PhoneSensor.MAGNETOMETER) sensors.deliver(event)
        }
        play(300, isThere = false)
        play(300, isThere = true)
        assertEquals((1..600).map { 20_000_000_000_000 + it * STEP_NS }, got.filterIsInstance<SensorSample.RotationRate>().map { it.timeNs })
        collecting.cancelAndJoin()
    }

    @Test
    fun `events that are late, alone or in batches, have the same clock`() = runBlocking {
        val options = SensorOptions(maxReportLatencyUs = 1_000_000, holdS = 0.0)
        val got = CopyOnWriteArrayList<SensorSample>()
        val collecting = CoroutineScope(Dispatchers.Default).launch { sensors.source(options).samples().collect { got += it } }
        sensors.registered(3)
        val sent = ArrayList<SensorSample>()
        repeat(20) {
            val batch = List(100) { phone.advance(still = false) }.flatten()
            // sensor by sensor, and the clock goes on between them
            for (kind in PhoneSensor.entries) {
                sensors.continuousNs = phone.timeNs + 30_000_000L * kind.ordinal
                batch.filter { kind(it) == kind }.forEach { sensors.deliver(it); sent += inFloats(it) }
            }
        }
        withTimeout(120_000) { while (got.size < sent.size) yield() }
        assertEquals(sent.map { it.timeNs }, got.map { it.timeNs })
        collecting.cancelAndJoin()
    }

    @Test
    fun `a listener of Java is told of silence, and one for a screen gets the latest alone`() = runBlocking {
        val waiting = LinkedBlockingQueue<Runnable>()
        val headings = CopyOnWriteArrayList<CompassReading>()
        val listener = object : HeadingListener {
            override fun onHeading(reading: CompassReading) {
                headings += reading
            }

            override fun onEnd(error: Exception?) = Unit
        }
        val running = compass.start(Executor(waiting::add), listener)
        val all = CopyOnWriteArrayList<CompensatedReading>()
        val every = compass.start(
            Executor { it.run() },
            object : CompassReadingListener {
                override fun onReading(reading: CompensatedReading) {
                    all += reading
                }

                override fun onEnd(error: Exception?) = Unit
            },
        )
        sensors.registered(3)
        play(100)
        // the first is under way, the latest waits; those between are counted
        waiting.poll(60, TimeUnit.SECONDS)!!.run()
        waiting.poll(60, TimeUnit.SECONDS)!!.run()
        assertEquals(listOf(all[0].sample.timeNs, all[99].sample.timeNs), headings.map { it.timeNs })
        play(300, PhoneSensor.MAGNETOMETER)
        waiting.poll(60, TimeUnit.SECONDS)!!.run()
        assertEquals(silent, headings.last().stream)
        assertEquals(silent, all.last().stream)
        assertEquals(101, all.size)
        running.close()
        every.close()
        withTimeout(120_000) { while (sensors.registrations.isNotEmpty()) yield() }
    }
}
