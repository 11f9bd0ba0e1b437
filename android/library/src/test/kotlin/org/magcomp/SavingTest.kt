package org.magcomp

import java.util.Random
import kotlin.math.abs
import kotlin.math.cos
import kotlin.math.sin
import kotlin.math.sqrt
import kotlinx.coroutines.flow.Flow
import kotlinx.coroutines.flow.asFlow
import kotlinx.coroutines.flow.flow
import kotlinx.coroutines.flow.toList
import kotlinx.coroutines.runBlocking
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertFalse
import org.junit.jupiter.api.Assertions.assertNotEquals
import org.junit.jupiter.api.Assertions.assertNotNull
import org.junit.jupiter.api.Assertions.assertThrows
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.core.*

/** When a calibration is saved. */
class SavingTest {
    /** A store that knows at which event it was called. */
    private class Kept(var text: String? = null) : CalibrationStore {
        var nowS = 0.0
        val savedS = mutableListOf<Double>()

        override fun load(): String? = text

        override fun save(text: String) {
            savedS += nowS
            this.text = text
        }
    }

    /** Plays events to a store's compensator; [end] runs after the last, before the collection ends. */
    private fun readings(events: List<SensorSample>, store: Kept, end: () -> Unit = {}): List<CompensatedReading> {
        val played = flow {
            for (event in events) {
                store.nowS = seconds(event)
                emit(event)
            }
            end()
        }
        return runBlocking { played.compensated(store = store).toList() }
    }

    @Test
    fun `a session of 20 s that a crash ended is there at the next launch`() {
        val store = Kept()
        var atCrash: String? = null
        readings(events(tumbling(2000)), store) { atCrash = store.text }
        val next = readings(events(tumbling(1)), Kept(atCrash)).single()
        assertNotNull(next.reading.fieldUt, "calibrated from the first sample on")
    }

    @Test
    fun `it is saved when tracking begins, every 10 s while it changes, and at the end`() {
        val store = Kept()
        val events = events(tumbling(2500)).toMutableList()
        // one that is rejected for its time, an hour back, changes no interval
        val refused = (events[1001] as SensorSample.Magnetic).sample
        events.add(1002, SensorSample.Magnetic(refused.copy(timeNs = refused.timeNs - 3_600_000_000_000)))
        val readings = readings(events, store)
        assertEquals(1, readings.count { it.reading.status is CompensationStatus.Rejected })
        val tracking = readings.first { it.reading.status == CompensationStatus.Tracking }
        assertEquals(4, store.savedS.size, "${store.savedS}")
        assertEquals(tracking.sample.timeNs * 1e-9, store.savedS.first())
        assertEquals(25.0, store.savedS.last())
        for ((one, next) in store.savedS.dropLast(1).zipWithNext()) assertTrue(next - one in 9.999..10.201, "${store.savedS}")
    }

    @Test
    fun `it is not saved again until it has changed`() {
        val moved = events(tumbling(1500))
        val rested = moved + still(1500 until 6000)
        val turned = rested + events(tumbling(600), beginNs = 6000 * STEP_NS)
        val (before, after) = changes(turned).map { it.first }.partition { it <= 60.0 }
        assertTrue(before.last() < 40.0 && after.isNotEmpty(), "the data show a rest, and a change after it: ${before.last()}")

        val again = Kept()
        readings(turned, again)
        val first = again.savedS.first { it > 60.0 }
        assertTrue(first - after.first() in 0.0..0.201, "10 s had long passed: changed at ${after.first()}, saved at $first")

    }

    @Test
    fun `a device at rest is saved no more, nor at the end, nor at the next launch`() {
        val alone = events(tumbling(1500)) + still(1500 until 6000)
        for (rested in listOf(alone, handHeld(2000, 4000))) {
            val changes = changes(rested)
            val latest = changes.last().second
            val changedS = changes.last { apartUt(it.second, latest) > 0.01 }.first
            assertTrue(changedS < 40.0, "the data show a rest: $changedS")
            val store = Kept()
            readings(rested, store)
            assertTrue(store.savedS.last() <= changedS + 10.201, "${store.savedS}")
            val kept = Compensator().use {
                it.adoptKept(store.text!!, null)
                it.calibration()!!
            }
            assertTrue(apartUt(kept, latest) <= 0.01, "the last change was saved, though within 10 s of the save before: $kept, $latest")
            // a next launch that ends before the first magnetometer sample
            val next = Kept(store.text)
            readings(rested.take(1), next)
            assertEquals(emptyList<Double>(), next.savedS)
        }
        // or else the gyroscope's part is the same as the magnetometer's alone
        val (moved, last) = Compensator().use { compensator ->
            val (before, after) = handHeld(2000, 4000).partition { seconds(it) <= 50 }
            compensator.pushAll(before)
            Pair(compensator.calibration(), compensator.apply { pushAll(after) }.calibration())
        }
        assertNotEquals(moved, last, "the field strength follows the noise")
    }

    private fun apartUt(one: MagnetometerCalibration, other: MagnetometerCalibration): Double =
        with(one.hardIronUt + other.hardIronUt * -1.0) { maxOf(abs(x), abs(y), abs(z)) }

    /** When a compensator of our own changes hard iron or soft iron, and to what. */
    private fun changes(events: List<SensorSample>): List<Pair<Double, MagnetometerCalibration>> = Compensator().use { compensator ->
        var latest: MagnetometerCalibration? = null
        events.mapNotNull { event ->
            compensator.pushAll(listOf(event))
            val found = compensator.calibration()
            if (found == null || found.copy(fieldStrengthUt = 1.0) == latest) return@mapNotNull null
            latest = found.copy(fieldStrengthUt = 1.0)
            Pair(seconds(event), found)
        }
    }

    @Test
    fun `nothing is saved before there is a calibration`() {
        val store = Kept()
        readings(events(tumbling(20)), store)
        assertEquals(emptyList<Double>(), store.savedS)
    }

    @Test
    fun `what a store throws is told with the readings, which go on, and is tried again`() {
        class Full : Exception("the disk is full")
        class Failing(val atLoad: Boolean) : CalibrationStore {
            var tries = 0

            override fun load(): String? = if (atLoad) throw Full() else null

            override fun save(text: String) {
                tries += 1
                if (tries <= 2) throw Full()
            }
        }
        for (atLoad in listOf(true, false)) {
            val store = Failing(atLoad)
            val readings = runBlocking { events(tumbling(2800)).asFlow().compensated(store = store).toList() }
            assertEquals(2800, readings.size)
            assertEquals(atLoad, readings.first().storeError is Full)
            assertTrue(readings[1500].storeError is Full)
            assertEquals(null, readings.last().storeError, "saved at last")
            assertEquals(4, store.tries)
        }
    }

    private fun seconds(event: SensorSample) = event.timeNs * 1e-9

    /** A phone with a gyroscope, turned by hand for some samples and still from then on: noise of 0.3 uT. */
    private fun handHeld(moving: Int, still: Int): List<SensorSample> {
        val random = Random(6)
        fun noisy(v: DeviceVector, noise: Double) = DeviceVector(
            v.x + noise * random.nextGaussian(),
            v.y + noise * random.nextGaussian(),
            v.z + noise * random.nextGaussian(),
        )
        var up = DeviceVector(0.0, 0.0, 9.81)
        var field = DeviceVector(0.0, 22.0, -42.0)
        return (1..moving + still).flatMap { k ->
            val (t, timeNs) = Pair(k * 0.01, k * STEP_NS)
            val rate = if (k <= moving) DeviceVector(0.8 * sin(0.9 * t), 0.9 * cos(0.7 * t), 0.7 * sin(1.3 * t + 1)) else DeviceVector(0.0, 0.0, 0.0)
            up = seen(up, rate)
            field = seen(field, rate)
            val raw = DeviceVector(field.x + 30, field.y - 20, field.z + 40)
            listOf(
                SensorSample.RotationRate(RotationRateSample(timeNs, noisy(rate, 0.002))),
                SensorSample.Up(UpSample(timeNs, noisy(up, 0.02))),
                SensorSample.Magnetic(MagneticSample(timeNs, noisy(raw, 0.3))),
            )
        }
    }

    /** A vector of the world as the device sees it after turning at a rate for 10 ms: Rodrigues' formula. */
    private fun seen(v: DeviceVector, rate: DeviceVector): DeviceVector {
        val speed = sqrt(rate.x * rate.x + rate.y * rate.y + rate.z * rate.z)
        if (speed == 0.0) return v
        val (x, y, z) = Triple(rate.x / speed, rate.y / speed, rate.z / speed)
        val (c, s) = Pair(cos(0.01 * speed), sin(0.01 * speed))
        val along = (x * v.x + y * v.y + z * v.z) * (1 - c)
        return DeviceVector(
            v.x * c - (y * v.z - z * v.y) * s + x * along,
            v.y * c - (z * v.x - x * v.z) * s + y * along,
            v.z * c - (x * v.y - y * v.x) * s + z * along,
        )
    }

    /** A device that lies still where the tumbling of 1500 samples left it: noise of 0.3 uT. */
    private fun still(samples: IntRange): List<SensorSample> {
        val random = Random(4)
        val last = tumbling(1500).takeLast(3)
        return samples.flatMap { k ->
            val values = DoubleArray(3) { last[it] + 0.3 * random.nextGaussian() }
            events(values, beginNs = k * STEP_NS, at = 1499)
        }
    }
}
