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
import kotlinx.coroutines.flow.first
import kotlinx.coroutines.flow.flow
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
        assertEquals(1998L, headings[1].details.droppedBefore)
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
    fun `a state flow has the latest, uses the sensors while it is collected, and is empty afterwards`() = runBlocking {
        assertEquals(CompassState.Waiting, compass.state.value)
        assertEquals(0, sensors.registrations.size, "asking starts nothing")
        val screen = scope.launch { compass.state.collect { } }
        sensors.registered(3)
        play(1500)
        assertEquals(phone.timeNs, (compass.state.value as CompassState.Live).reading.timeNs)
        assertTrue(compass.state === compass.state)
        val other = scope.launch { compass.state.collect { } }
        assertEquals(1, sensors.most.get())
        screen.cancelAndJoin()
        other.cancelAndJoin()
        withTimeout(120_000) { while (sensors.registrations.isNotEmpty() || compass.state.value != CompassState.Waiting) delay(1) }
    }

    @Test
    fun `a state flow has the error, and the next collector begins anew`() = runBlocking {
        sensors.refuse = Sensor.TYPE_GRAVITY
        val refused = withTimeout(120_000) { compass.state.first { it is CompassState.Ended } } as CompassState.Ended
        assertTrue(refused.error is SensorException.Refused)
        sensors.refuse = null
        val screen = scope.launch { compass.state.collect { } }
        sensors.registered(3)
        play(1)
        assertEquals(phone.timeNs, (compass.state.value as CompassState.Live).reading.timeNs)
        screen.cancelAndJoin()
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
        val broken = object : MagneticFieldSource {
            override fun samples() = flow<SensorSample> { throw StackOverflowError("on purpose") }
        }
        val told = withTimeout(120_000) { Compass(broken).state.first { it is CompassState.Ended } } as CompassState.Ended
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
