package org.magcomp

import android.hardware.Sensor
import java.io.File
import java.util.concurrent.CopyOnWriteArrayList
import java.util.zip.GZIPInputStream
import kotlinx.coroutines.CoroutineScope
import kotlinx.coroutines.Dispatchers
import kotlinx.coroutines.async
import kotlinx.coroutines.awaitCancellation
import kotlinx.coroutines.cancelAndJoin
import kotlinx.coroutines.delay
import kotlinx.coroutines.flow.asFlow
import kotlinx.coroutines.flow.flow
import kotlinx.coroutines.flow.toList
import kotlinx.coroutines.launch
import kotlinx.coroutines.runBlocking
import kotlinx.coroutines.withTimeout
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertThrows
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.junit.jupiter.api.io.TempDir

class RecorderTest {
    @TempDir
    lateinit var folder: File

    private class Played(val events: List<SensorSample>) : MagneticFieldSource {
        override fun samples() = events.asFlow()
    }

    private fun up(timeNs: Long) = SensorSample.Up(UpSample(timeNs, DeviceVector(0.0, -9.5, 2.25)))

    private fun rate(timeNs: Long) = SensorSample.RotationRate(RotationRateSample(timeNs, DeviceVector(1e-6, 0.5, -0.25)))

    private fun field(timeNs: Long, reported: DeviceVector? = null) = SensorSample.Magnetic(MagneticSample(timeNs, DeviceVector(1.5, -2.0, 300.0), reported))

    @Test
    fun `every event is a row at its own time, those of one time share one`() = runBlocking {
        val file = folder.resolve("r.csv")
        val t = 345_600_000_000_000
        val events = listOf(rate(t), up(t), field(t, DeviceVector(0.5, 0.0, 100.0)), up(t + 1), rate(t + 10_000_000), field(t + 1_500_000_000))
        assertEquals(6L, Played(events).record(file))
        val expected = """
            t_s,mx,my,mz,sys_mx,sys_my,sys_mz,ax,ay,az,gx,gy,gz
            0.000000000,1.5,-2.0,300.0,1.0,-2.0,200.0,0.0,-9.5,2.25,1.0E-6,0.5,-0.25
            0.000000001,,,,,,,0.0,-9.5,2.25,,,
            0.010000000,,,,,,,,,,1.0E-6,0.5,-0.25
            1.500000000,1.5,-2.0,300.0,,,,,,,,,

        """.trimIndent()
        assertEquals(expected, file.readText())
    }

    @Test
    fun `what was recorded plays the same events`() = runBlocking {
        val phone = Phone(1)
        // each sensor at its own times, the first at 0
        val events = List(1500) { phone.advance(still = false) }.flatten().map(::inFloats).map {
            val timeNs = it.timeNs - STEP_NS
            when (it) {
                is SensorSample.Magnetic -> SensorSample.Magnetic(it.sample.copy(timeNs = timeNs + 3_000_000))
                is SensorSample.Up -> SensorSample.Up(it.sample.copy(timeNs = timeNs + 1_000_000))
                is SensorSample.RotationRate -> SensorSample.RotationRate(it.sample.copy(timeNs = timeNs))
            }
        }.sortedBy { it.timeNs }
        val file = folder.resolve("r.csv.gz")
        assertEquals(4500L, Played(events).record(file))
        // a text of a float is that of the nearest double
        assertEquals(events, RecordingSource(file).samples().toList().map(::inFloats))
    }

    @Test
    fun `late events, and a second of one time, are left out`() = runBlocking {
        val file = folder.resolve("r.csv")
        assertEquals(3L, Played(listOf(up(20), up(20), up(10), rate(15), rate(20), up(30))).record(file))
        assertEquals(listOf("0.000000000", "0.000000010"), file.readLines().drop(1).map { it.substringBefore(",") })
    }

    @Test
    fun `it ends before it is too large, with a file that plays`() = runBlocking {
        val endless = object : MagneticFieldSource {
            override fun samples() = flow {
                var k = 0L
                while (true) {
                    k += STEP_NS
                    emit(rate(k))
                    emit(field(k))
                }
            }
        }
        val file = folder.resolve("r.csv")
        val events = endless.record(file, mostBytes = 10_000)
        assertTrue(file.length() in 9_700..10_000, "${file.length()}")
        assertEquals(events, RecordingSource(file).samples().toList().size.toLong())
        assertThrows(IllegalArgumentException::class.java) { runBlocking { endless.record(file, mostBytes = 999) } }
        assertTrue(file.length() > 9_700, "what is refused changes nothing")
    }

    @Test
    fun `cancelled it has written all so far, beside a compass, on sensors registered once`() = runBlocking {
        val sensors = FakeSensorManager(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, Sensor.TYPE_GRAVITY, Sensor.TYPE_GYROSCOPE)
        val compass = Compass(sensors.source(), graceMs = 0)
        val phone = Phone(1, reported = HARD_IRON_UT)
        val readings = CopyOnWriteArrayList<CompensatedReading>()
        val reading = CoroutineScope(Dispatchers.Unconfined).launch { compass.readings().collect(readings::add) }
        sensors.registered(3)
        val file = folder.resolve("r.csv.gz")
        val recording = async(Dispatchers.Default) { compass.record(file) }
        // until it has begun
        withTimeout(20_000) {
            while (file.length() == 0L) {
                phone.advance(still = false).forEach(sensors::deliver)
                delay(1)
            }
        }
        repeat(2000) { phone.advance(still = false).forEach(sensors::deliver) }
        assertEquals(1, sensors.most.get())
        delay(1)
        recording.cancelAndJoin()
        val text = GZIPInputStream(file.inputStream()).bufferedReader().readLines()
        assertTrue(text.size > 1, "${text.size} lines")
        assertTrue(text.drop(1).all { it.count { c -> c == ',' } == 12 }, "whole rows")
        reading.cancelAndJoin()
        assertEquals(0, sensors.registrations.size)
    }

    @Test
    fun `a file that can't be written is an error, and no sensor stays registered`() = runBlocking {
        val sensors = FakeSensorManager(Sensor.TYPE_MAGNETIC_FIELD, Sensor.TYPE_GRAVITY)
        assertThrows(java.io.IOException::class.java) { runBlocking { sensors.source().record(folder.resolve("none/r.csv")) } }
        assertEquals(0, sensors.most.get())
        val waiting = object : MagneticFieldSource {
            override fun samples() = flow<SensorSample> { awaitCancellation() }
        }
        val file = folder.resolve("r.csv")
        val recording = async(Dispatchers.Default) { waiting.record(file) }
        withTimeout(20_000) { while (!file.exists()) delay(1) }
        recording.cancelAndJoin()
        assertEquals(1, file.readLines().size)
    }

    @Test
    fun `a recording may leave cells of a sensor empty, all of them`() = runBlocking {
        fun played(text: String) = runBlocking { RecordingSource("r") { text.reader() }.samples().toList() }
        assertEquals(listOf(up(1_000_000_000), field(2_000_000_000)), played("t_s,mx,my,mz,ax,ay,az\n1,,,,0,-9.5,2.25\n2,1.5,-2,300, ,,\n"))
        val error = assertThrows(RecordingException::class.java) { played("t_s,mx,my,mz\n1,1,,3\n") }
        assertEquals(2 to "my", error.line to error.column)
    }
}
