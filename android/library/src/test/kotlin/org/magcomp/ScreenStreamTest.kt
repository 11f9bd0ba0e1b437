package org.magcomp

import android.hardware.Sensor
import java.util.concurrent.CopyOnWriteArrayList
import kotlin.time.Duration.Companion.ZERO
import kotlin.time.Duration.Companion.milliseconds
import kotlin.time.Duration.Companion.seconds
import kotlinx.coroutines.CompletableDeferred
import kotlinx.coroutines.CoroutineScope
import kotlinx.coroutines.Dispatchers
import kotlinx.coroutines.cancelAndJoin
import kotlinx.coroutines.delay
import kotlinx.coroutines.flow.flow
import kotlinx.coroutines.flow.last
import kotlinx.coroutines.launch
import kotlinx.coroutines.runBlocking
import kotlinx.coroutines.withTimeout
import kotlinx.coroutines.yield
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertFalse
import org.junit.jupiter.api.Assertions.assertNull
import org.junit.jupiter.api.Assertions.assertThrows
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.core.*

/** What a screen collects, and what a file does. */
class ScreenStreamTest {
    private val sensors = FakeSensorManager(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, Sensor.TYPE_GRAVITY, Sensor.TYPE_GYROSCOPE)
    private val compass = Compass(sensors.source(), grace = ZERO)
    private val phone = Phone(1, reported = HARD_IRON_UT)
    private val scope = CoroutineScope(Dispatchers.Unconfined)

    private fun play(steps: Int) = repeat(steps) { phone.advance(still = false).forEach(sensors::deliver) }

    @Test
    fun `a slow screen sees the latest heading, a slow file every reading`() = runBlocking {
        val gate = CompletableDeferred<Unit>()
        val headings = CopyOnWriteArrayList<CompassReading>()
        val readings = CopyOnWriteArrayList<CompensatedReading>()
        val screen = scope.launch { compass.headings().collect { headings += it; gate.await() } }
        val file = scope.launch { compass.readings().collect { readings += it; gate.await() } }
        sensors.registered(3)
        play(2000)
        gate.complete(Unit)
        withTimeout(120_000) { while (readings.size < 2000 || headings.size < 2) yield() }
        assertEquals(List(2000) { (it + 1) * STEP_NS }, readings.map { it.sample.timeNs })
        assertEquals(0L, readings.sumOf { it.droppedBefore })
        assertEquals(listOf(STEP_NS, 2000 * STEP_NS), headings.map { it.timeNs })
        screen.cancelAndJoin()
        file.cancelAndJoin()
    }

    @Test
    fun `one that is too far behind loses the oldest, counted`() = runBlocking {
        val gate = CompletableDeferred<Unit>()
        val readings = CopyOnWriteArrayList<CompensatedReading>()
        val file = scope.launch { compass.readings().collect { readings += it; gate.await() } }
        sensors.registered(3)
        play(Compass.MOST_WAITING + 11)
        gate.complete(Unit)
        withTimeout(120_000) { while (readings.lastOrNull()?.sample?.timeNs != phone.timeNs) yield() }
        assertEquals(Compass.MOST_WAITING + 1, readings.size)
        assertEquals(10L, readings[1].droppedBefore)
        val (whole, told) = Pair(readings[2], readings[1])
        assertTrue(told.sensors === whole.sensors && told.sensors != null, "what else it says is there")
        assertEquals(phone.timeNs, readings.last().sample.timeNs)
        file.cancelAndJoin()
    }

    @Test
    fun `states wait first, have each reading, and use the sensors while they are collected`() = runBlocking {
        val states = CopyOnWriteArrayList<CompassState>()
        val collected = compass.states()
        assertEquals(0, sensors.registrations.size, "asking starts nothing")
        val screen = scope.launch { collected.collect(states::add) }
        assertEquals(listOf<CompassState>(CompassState.Waiting), states.toList())
        sensors.registered(3)
        play(2)
        assertEquals(listOf(STEP_NS, 2 * STEP_NS), states.drop(1).map { (it as CompassState.Live).reading.timeNs })
        val other = scope.launch { compass.states().collect { } }
        assertEquals(1, sensors.most.get())
        screen.cancelAndJoin()
        other.cancelAndJoin()
        withTimeout(120_000) { while (sensors.registrations.isNotEmpty()) delay(1) }
    }

    @Test
    fun `states end with the error, and the next collector begins anew`() = runBlocking {
        sensors.refuse = Sensor.TYPE_GRAVITY
        val refused = withTimeout(120_000) { compass.states().last() } as CompassState.Ended
        assertTrue(refused.error is SensorException.Refused)
        sensors.refuse = null
        val states = CopyOnWriteArrayList<CompassState>()
        val screen = scope.launch { compass.states().collect(states::add) }
        sensors.registered(3)
        play(1)
        assertEquals(phone.timeNs, (states.last() as CompassState.Live).reading.timeNs)
        screen.cancelAndJoin()
    }

    @Test
    fun `two screens of one compass have each the heading as it is turned, also one of Java`() = runBlocking {
        // turned further while it collects
        var turned = ScreenRotation.DEG90
        val (upright, landscape, camera) = List(3) { CopyOnWriteArrayList<CompassReading>() }
        val java = CopyOnWriteArrayList<CompassReading>()
        val listener = object : HeadingListener {
            override fun onHeading(reading: CompassReading) {
                java += reading
            }

            override fun onEnd(error: Exception?) = Unit
        }
        val whole = CopyOnWriteArrayList<CompensatedReading>()
        val screens = listOf(
            scope.launch { compass.headings().collect(upright::add) },
            scope.launch { compass.headings { turned }.collect(landscape::add) },
            scope.launch { compass.headings(ReferenceAxis.CAMERA).collect(camera::add) },
            scope.launch { compass.readings().collect(whole::add) },
        )
        val running = compass.start({ it.run() }, listener, ReferenceAxis.TOP_EDGE) { ScreenRotation.DEG180 }
        compass.declinationDeg = 3.0
        sensors.registered(3)
        // each has a twin whose config says the same
        val flat = List(1500) { phone.advance(still = false) }.flatten()
        flat.forEach { if (it.timeNs == 1000 * STEP_NS) turned = ScreenRotation.DEG270; sensors.deliver(it) }
        fun twin(axis: ReferenceAxis, rotation: ScreenRotation) =
            Compensator(CompensationConfig(heading = HeadingConfig(axis, rotation, 3.0))).use { it.pushReported(flat.map(::inFloats)) }
        for ((got, axis, rotation) in listOf(
            Triple(upright, ReferenceAxis.AUTO, { ScreenRotation.DEG0 }),
            Triple(landscape, ReferenceAxis.AUTO, { turned }),
            Triple(camera, ReferenceAxis.CAMERA, { ScreenRotation.DEG0 }),
            Triple(java, ReferenceAxis.TOP_EDGE, { ScreenRotation.DEG180 }),
        )) {
            turned = ScreenRotation.DEG90
            val before = twin(axis, rotation())
            turned = ScreenRotation.DEG270
            val after = twin(axis, rotation())
            assertEquals(1500, got.size, "$axis")
            var compared = 0
            got.forEachIndexed { k, reading ->
                val expected = (if (k < 999) before[k] else after[k]).heading
                assertEquals(expected == null, reading.headingDeg == null, "$axis $k")
                expected ?: return@forEachIndexed
                assertEquals(0.0, Math.IEEEremainder(expected.headingDeg - reading.headingDeg!!, 360.0), 1e-7, "$axis $k")
                assertEquals(expected.headingSigmaDeg!!, reading.headingSigmaDeg!!, 1e-6 * expected.headingSigmaDeg!!, "$axis $k")
                val same = whole[k].headingOn(if (k < 999 && got === landscape) ScreenRotation.DEG90 else rotation(), axis)!!
                assertEquals(with(reading) { listOf(headingDeg, headingSigmaDeg, trueHeadingDeg) }, with(same) { listOf(headingDeg, headingSigmaDeg, trueHeadingDeg) })
                assertEquals(0.0, Math.IEEEremainder(expected.trueHeadingDeg!! - same.trueHeadingDeg!!, 360.0), 1e-7, "$axis $k")
                assertEquals(expected.inclinationDeg!!, same.inclinationDeg!!, 1e-6, "$axis $k")
                compared += 1
            }
            assertTrue(compared > 1000, "$axis $compared")
        }
        running.close()
        screens.forEach { it.cancelAndJoin() }
    }

    /** As a compass gives them to its estimator. */
    private fun Compensator.pushReported(events: List<SensorSample>): List<MagneticReading> = events.mapNotNull { event ->
        when (event) {
            is SensorSample.Magnetic -> push(event.sample)
            is SensorSample.RotationRate -> with(event.sample.rateRadS) { pushRotationRate(event.timeNs, x, y, z) }.let { null }
            is SensorSample.Up -> with(event.sample.upMS2) { pushUp(event.timeNs, x, y, z) }.let { null }
        }
    }

    @Test
    fun `a rotation that can't be told is an error of its screen alone`() = runBlocking {
        val got = CopyOnWriteArrayList<CompassReading>()
        val other = scope.launch { compass.headings().collect(got::add) }
        val states = CopyOnWriteArrayList<CompassState>()
        val broken = scope.launch { compass.states { error("of the app") }.collect(states::add) }
        sensors.registered(3)
        play(2)
        broken.join()
        assertEquals("of the app", (states.last() as CompassState.Ended).error!!.message)
        assertEquals(2, got.size)
        other.cancelAndJoin()
    }

    @Test
    fun `one heading is the first that is as sure as asked for, else the latest reading says why`() = runBlocking {
        suspend fun asked(steps: Int, ask: suspend () -> CompassReading?): CompassReading? {
            var found: CompassReading? = null
            val asking = CoroutineScope(Dispatchers.Default).launch { found = ask() }
            withTimeout(120_000) { while (sensors.registrations.size < 3 && asking.isActive) yield() }
            for (k in 1..steps) if (asking.isActive) play(1)
            withTimeout(120_000) { asking.join() }
            return found
        }
        val first = asked(3000) { compass.heading(within = 60.seconds) }!!
        assertTrue(first.headingSigmaDeg!! > 10, "the data show one: ${first.headingSigmaDeg}")
        val sure = asked(3000) { compass.heading(within = 60.seconds, worstSigmaDeg = 10.0) }!!
        assertTrue(sure.headingSigmaDeg!! <= 10, "${sure.headingSigmaDeg}")
        val whole = CopyOnWriteArrayList<CompensatedReading>()
        val file = scope.launch { compass.readings().collect(whole::add) }
        val turned = asked(3000) { compass.heading(within = 60.seconds, axis = ReferenceAxis.TOP_EDGE) { ScreenRotation.DEG180 } }!!
        val same = whole.first { it.sample.timeNs == turned.timeNs }
        assertEquals(same.headingOn(ScreenRotation.DEG180, ReferenceAxis.TOP_EDGE)!!.headingDeg, turned.headingDeg)
        file.cancelAndJoin()
        val why = asked(20) { compass.heading(within = 3.seconds, worstSigmaDeg = 1e-6) }!!
        assertTrue(why.headingSigmaDeg!! > 1e-6, "$why")
        val none = asked(0) { Compass(sensors.source(), grace = ZERO).heading(within = 1.milliseconds) }
        assertNull(none)
        for (wrong in listOf<suspend () -> Any?>({ compass.heading(within = ZERO) }, { compass.heading(worstSigmaDeg = Double.NaN) })) {
            assertThrows(IllegalArgumentException::class.java) { runBlocking { wrong() } }
        }
    }

    @Test
    fun `a source's Error is in the state and ends nothing else`() = runBlocking {
        val broken = object : FlowSource() {
            override fun played() = flow<SensorSample> { throw StackOverflowError("on purpose") }
        }
        val told = withTimeout(120_000) { Compass(broken).states().last() } as CompassState.Ended
        assertTrue(told.error!!.cause is StackOverflowError)
    }

    @Test
    fun `a phone is asked whether it has a compass, and nothing is registered`() {
        val (mag, acc) = Pair(Sensor.TYPE_MAGNETIC_FIELD, Sensor.TYPE_ACCELEROMETER)
        fun has(vararg types: Int) = FakeSensorManager(*types).let { SensorManagerSource.isAvailable(FakeApp(it)).also { _ -> assertEquals(0, it.most.get()) } }
        assertTrue(has(mag, acc) && has(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, Sensor.TYPE_GRAVITY))
        assertFalse(has(acc) || has(mag))
    }
}
