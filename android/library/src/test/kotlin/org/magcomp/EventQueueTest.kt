package org.magcomp

import android.hardware.Sensor
import kotlinx.coroutines.async
import kotlinx.coroutines.flow.take
import kotlinx.coroutines.flow.toList
import kotlinx.coroutines.runBlocking
import kotlinx.coroutines.withTimeout
import kotlinx.coroutines.yield
import org.json.JSONArray
import org.json.JSONObject
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertNotEquals
import org.junit.jupiter.api.Assertions.assertThrows
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.core.*

class EventQueueTest {
    @Test
    fun `the order is that of Rust and Swift`() {
        val cases = JSONObject(repository.resolve("tests/vectors/event_order.json").readText()).getJSONArray("cases")
        assertTrue(cases.length() >= 20)
        for (k in 0 until cases.length()) {
            val case = cases.getJSONObject(k)
            val queue = EventQueue(case.getDouble("hold_s"))
            val events = lists(case.getJSONArray("deliveries")).map { (kind, timeNs) -> event(kind, timeNs) }
            val numbers = java.util.IdentityHashMap<SensorSample, Long>()
            events.forEachIndexed { k, event -> numbers[event] = k.toLong() }
            val released = mutableListOf<List<Long>>()
            fun released(call: ((SensorSample) -> Unit) -> Unit) {
                val now = mutableListOf<Long>()
                call { now += numbers.getValue(it) }
                released += now
            }
            for (event in events) released { queue.push(event, it) }
            released { queue.flush(it) }
            assertEquals(lists(case.getJSONArray("released")), released, case.getString("name"))
        }
    }

    @Test
    fun `times may be any, and a hold out of range is refused`() {
        val queue = EventQueue(0.25)
        val times = listOf(Long.MIN_VALUE, 0, Long.MAX_VALUE, Long.MIN_VALUE + 1, -1, Long.MAX_VALUE - 1)
        val out = mutableListOf<SensorSample>()
        for (timeNs in times) for (kind in 0L..2) queue.push(event(kind, timeNs)) { out += it }
        queue.flush { out += it }
        assertEquals(18, out.size)
        // further apart than 64 bits can say: another clock, before which nothing waits
        for ((one, other) in listOf(Long.MAX_VALUE - 5 to Long.MIN_VALUE + 5, Long.MIN_VALUE + 5 to Long.MAX_VALUE - 5)) {
            val gone = mutableListOf<Long>()
            for (timeNs in listOf(one, other)) queue.push(event(2, timeNs)) { gone += it.timeNs }
            assertEquals(listOf(one), gone)
            queue.flush { }
        }
        for (holdS in listOf(-0.01, 0.26, Double.NaN)) assertThrows(IllegalArgumentException::class.java) { EventQueue(holdS) }
        assertThrows(IllegalArgumentException::class.java) { SensorOptions(holdS = 0.26) }
        assertEquals(0.15, SensorOptions(maxReportLatencyUs = 100_000).heldS, 1e-12)
        assertEquals(0.25, SensorOptions(maxReportLatencyUs = 900_000).heldS)
        // a copy keeps what it was asked for, and what suits the latency follows that
        assertEquals(0.25, SensorOptions(maxReportLatencyUs = 200_000).heldS, 1e-12)
        assertEquals(0.01, SensorOptions(holdS = 0.01, maxReportLatencyUs = 200_000).heldS)
    }

    /** 20 s of a recording at 95 Hz, as Android's sensors deliver it. */
    @Test
    fun `batches of 20, 100 and 200 ms give the headings that no batches give`() = runBlocking {
        val rows = RecordingSource(repository.resolve("tests/recordings/broad_34_attached_magnet_3cm.csv.gz")).samples().toList()
            .chunked(3).filterIndexed { k, _ -> k % 3 == 0 }.take(1900)
        // each sensor at its own times
        val events = rows.flatMap { row ->
            val (rate, up, field) = row
            listOf(
                rate,
                SensorSample.Magnetic((field as SensorSample.Magnetic).sample.copy(timeNs = field.timeNs + 1_000_000)),
                SensorSample.Up((up as SensorSample.Up).sample.copy(timeNs = up.timeNs + 3_000_000)),
            )
        }
        val one = readings(events, batchMs = 0)
        assertTrue(one.count { it.heading != null } > 800, "the data show headings")
        for (batchMs in listOf(20L, 100L, 200L)) assertEquals(one, readings(events, batchMs), "$batchMs ms")
        // the test can fail
        assertNotEquals(one, readings(events, batchMs = 100, holdS = 0.0))
    }

    private suspend fun readings(events: List<SensorSample>, batchMs: Long, holdS: Double? = null): List<MagneticReading> {
        val sensors = FakeSensorManager(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, Sensor.TYPE_GRAVITY, Sensor.TYPE_GYROSCOPE, hardIron = false)
        val source = sensors.source(SensorOptions(maxReportLatencyUs = (1000 * batchMs).toInt(), holdS = holdS))
        return kotlinx.coroutines.coroutineScope {
            val readings = async { source.samples().compensated().take(events.size / 3 - 50).toList() }
            withTimeout(120_000) { while (sensors.registrations.size < 3) yield() }
            if (batchMs == 0L) {
                events.forEach(sensors::deliver)
            } else {
                // a batch is delivered sensor by sensor, the magnetometer's first
                for (batch in events.groupBy { it.timeNs / (1_000_000 * batchMs) }.toSortedMap().values) {
                    batch.sortedBy { if (it is SensorSample.Magnetic) 0 else if (it is SensorSample.Up) 1 else 2 }.forEach(sensors::deliver)
                }
            }
            withTimeout(120_000) { readings.await() }.map { it.reading }
        }
    }

    private fun event(kind: Long, timeNs: Long): SensorSample {
        val v = DeviceVector(1.0, 2.0, 3.0)
        return when (kind) {
            0L -> SensorSample.RotationRate(RotationRateSample(timeNs, v))
            1L -> SensorSample.Up(UpSample(timeNs, v))
            else -> SensorSample.Magnetic(MagneticSample(timeNs, v))
        }
    }

    private fun lists(json: JSONArray): List<List<Long>> = (0 until json.length()).map { k ->
        val inner = json.getJSONArray(k)
        (0 until inner.length()).map(inner::getLong)
    }
}
