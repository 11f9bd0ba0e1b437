package org.magcomp

import java.util.Random
import kotlinx.coroutines.flow.Flow
import kotlinx.coroutines.flow.asFlow
import kotlinx.coroutines.flow.flow
import kotlinx.coroutines.flow.toList
import kotlinx.coroutines.runBlocking
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertFalse
import org.junit.jupiter.api.Assertions.assertNotNull
import org.junit.jupiter.api.Assertions.assertThrows
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test

/** When a calibration is saved. */
class SavingTest {
    /** A store that knows at which event it was called. */
    private class Kept(var snapshot: String? = null) : CalibrationStore {
        var nowS = 0.0
        val savedS = mutableListOf<Double>()

        override fun load(): String? = snapshot

        override fun save(snapshot: String) {
            savedS += nowS
            this.snapshot = snapshot
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
        return runBlocking { played.compensated(store = store, capacity = events.size).toList() }
    }

    @Test
    fun `a session of 20 s that a crash ended is there at the next launch`() {
        val store = Kept()
        var atCrash: String? = null
        readings(events(tumbling(2000)), store) { atCrash = store.snapshot }
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
        assertEquals(1, readings.count { it.reading.status is Status.Rejected })
        val tracking = readings.first { it.reading.status == Status.Tracking }
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
        // what the store should know, from a compensator of our own
        val changedS = mutableListOf<Double>()
        var (latest, atRest) = listOf<String?>(null, null)
        Compensator().use { compensator ->
            for (event in turned) {
                compensator.pushAll(listOf(event))
                val snapshot = compensator.snapshotCalibration()
                if (snapshot != latest) changedS += seconds(event)
                latest = snapshot
                if (event == rested.last()) atRest = snapshot
            }
        }
        val (before, after) = changedS.partition { it <= 60.0 }
        assertTrue(before.last() < 20.0 && after.isNotEmpty(), "the data show a rest, and a change after it: ${before.last()}")

        val store = Kept()
        readings(rested, store)
        assertTrue(store.savedS.last() <= before.last() + 10.201, "${store.savedS}")
        assertEquals(atRest, store.snapshot, "the last change was saved, though it came within 10 s of the save before")

        val again = Kept()
        readings(turned, again)
        val first = again.savedS.first { it > 60.0 }
        assertTrue(first - after.first() in 0.0..0.201, "10 s had long passed: changed at ${after.first()}, saved at $first")

        // a next launch that ends before the first magnetometer sample
        val next = Kept(atRest)
        readings(events(tumbling(1)).take(1), next)
        assertEquals(emptyList<Double>(), next.savedS)
    }

    @Test
    fun `nothing is saved before there is a calibration`() {
        val store = Kept()
        readings(events(tumbling(20)), store)
        assertEquals(emptyList<Double>(), store.savedS)
    }

    @Test
    fun `what a store throws ends the readings, and the events`() {
        class Full : Exception("the disk is full")
        class Failing(val atLoad: Boolean) : CalibrationStore {
            override fun load(): String? = if (atLoad) throw Full() else null

            override fun save(snapshot: String) = throw Full()
        }
        for (atLoad in listOf(true, false)) {
            var toTheEnd = false
            val source: Flow<SensorSample> = flow {
                for (event in events(tumbling(2000))) emit(event)
                toTheEnd = true
            }
            assertThrows(Full::class.java) { runBlocking { source.compensated(store = Failing(atLoad)).toList() } }
            assertFalse(toTheEnd)
        }
        // one that nobody calls does no harm
        runBlocking { events(tumbling(20)).asFlow().compensated(store = Failing(atLoad = false)).toList() }
    }

    private fun seconds(event: SensorSample) = event.timeNs * 1e-9

    /** A device that lies still where the tumbling of 1500 samples left it: noise of 0.3 uT. */
    private fun still(samples: IntRange): List<SensorSample> {
        val random = Random(4)
        val last = tumbling(1500).takeLast(3)
        return samples.flatMap { k ->
            val values = DoubleArray(3) { last[it] + 0.3 * random.nextGaussian() }
            events(values, beginNs = k * STEP_NS)
        }
    }
}
