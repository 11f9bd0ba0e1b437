package org.magcomp

import android.hardware.Sensor
import java.io.ByteArrayOutputStream
import java.io.File
import java.math.BigDecimal
import java.util.concurrent.CopyOnWriteArrayList
import java.util.concurrent.CountDownLatch
import java.util.concurrent.atomic.AtomicLong
import java.util.zip.GZIPInputStream
import kotlin.time.Duration.Companion.ZERO
import kotlinx.coroutines.CoroutineScope
import kotlinx.coroutines.Dispatchers
import kotlinx.coroutines.async
import kotlinx.coroutines.awaitCancellation
import kotlinx.coroutines.cancelAndJoin
import kotlinx.coroutines.delay
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
import org.magcomp.core.*

class RecorderTest {
    @TempDir
    lateinit var folder: File

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
            t_s,own_t_s,mx,my,mz,sys_mx,sys_my,sys_mz,sys_accuracy,ax,ay,az,gx,gy,gz,about
            0.000000000,,1.5,-2.0,300.0,1.0,-2.0,200.0,,0.0,-9.5,2.25,1.0E-6,0.5,-0.25,"magcomp $VERSION; MAKER MODEL, Android 15"
            0.000000001,,,,,,,,,0.0,-9.5,2.25,,,,
            0.010000000,,,,,,,,,,,,1.0E-6,0.5,-0.25,
            1.500000000,,1.5,-2.0,300.0,,,,,,,,,,,

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

    private fun rows(file: File) = file.readLines().drop(1).map { it.split(',') }

    @Test
    fun `late events, and a second of one time, are rows of their own with their own times`() = runBlocking {
        val file = folder.resolve("r.csv")
        assertEquals(7L, Played(listOf(up(20), up(20), up(10), rate(15), rate(20), up(30), up(20))).record(file))
        val expected = listOf("0" to "", "1" to "0", "2" to "-10", "3" to "-5", "4" to "0", "10" to "", "11" to "0")
        assertEquals(expected.map { (t, own) -> Pair(t.toInt(), own.toIntOrNull()) }, rows(file).map { Pair(ns(it[0])!!, ns(it[1])) })
    }

    private fun ns(cell: String) = cell.replace(".", "").toIntOrNull()

    @Test
    fun `a sensor with another clock loses nothing, and its own times are there`() = runBlocking {
        val hours = 10_800_000_000_000L
        for (offNs in listOf(0L, 1_000_000_000L, hours, -hours)) {
            val sensors = FakeSensorManager(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, Sensor.TYPE_GRAVITY, Sensor.TYPE_GYROSCOPE)
            val phone = Phone(1, beginNs = 20_000_000_000_000)
            val source = sensors.source(SensorOptions())
            val file = folder.resolve("$offNs.csv")
            // a clock by which every row is written at once
            val nowNs = AtomicLong()
            val recording = async(Dispatchers.Default) { source.record(file, 100_000_000) { nowNs.addAndGet(1_000_000_000) } }
            sensors.registered(3)
            sensors.tell(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, 2)
            repeat(1500) {
                val events = phone.advance(still = false)
                sensors.continuousNs = phone.timeNs
                for (event in events) {
                    sensors.deliver(if (event is SensorSample.RotationRate) event.copy(event.sample.copy(timeNs = event.timeNs + offNs)) else event)
                }
            }
            // all but those that still wait for their turn
            withTimeout(120_000) { while (rows(file).count { it.getOrNull(12)?.isNotEmpty() == true } < 1490) delay(20) }
            recording.cancelAndJoin()
            val rows = rows(file)
            val (fields, rates) = Pair(rows.filter { it[2] != "" }, rows.filter { it[12] != "" })
            assertTrue(fields.size in 1480..1500 && rates.size in 1480..1500, "$offNs: ${fields.size} fields, ${rates.size} rates")
            assertTrue(fields.all { it[8] == "2" }, "what the system says of it")
            val times = rows.map { BigDecimal(it[0]) }
            assertTrue(times.zipWithNext().all { (one, next) -> one < next }, "$offNs: strictly after one another")
            // each at its sensor's own time
            fun own(row: List<String>) = BigDecimal(row[1].ifEmpty { row[0] })
            val step = BigDecimal("0.010000000")
            for (of in listOf(fields, rates)) for ((one, next) in of.map(::own).zipWithNext()) assertEquals(step, next - one, "$offNs")
            assertEquals(BigDecimal(offNs).movePointLeft(9).setScale(9), own(rates[0]) - own(fields[0]))
            // soon on one clock
            val late = rates.drop(400).map { BigDecimal(it[0]) }
            assertTrue(late.zipWithNext().all { (one, next) -> (next - one).subtract(step).abs() < BigDecimal("0.000001") }, "$offNs")
            // and a compass has its heading from it
            val last = Compass(RecordingSource(file)).readings().toList().last().reading
            assertEquals(Pair(CompensationStatus.Tracking, SensorMode.GYROSCOPE_AND_GRAVITY), Pair(last.status, last.mode), "$offNs")
        }
    }

    @Test
    fun `times that begin again go on in the file, and a pause stays one`() = runBlocking {
        val file = folder.resolve("r.csv")
        val hourNs = 3_600_000_000_000
        val events = listOf(field(5_000_000_000), field(5_010_000_000), field(10), field(10_000_010), up(10_000_010), rate(hourNs), field(hourNs))
        assertEquals(7L, Played(events).record(file))
        val times = rows(file).map { it[0] }
        assertEquals(listOf("0.000000000", "0.010000000", "0.010000001", "0.020000001"), times.take(4))
        // a gyroscope that is first after a pause: nobody knows yet that it is one
        assertEquals(listOf("0.020000002", "3600.009999991"), times.takeLast(2))
        assertEquals("-4.999999990", rows(file)[2][1])
    }

    @Test
    fun `who made it and what with is in its first row`() = runBlocking {
        val sensors = FakeSensorManager(Sensor.TYPE_MAGNETIC_FIELD, Sensor.TYPE_ACCELEROMETER)
        val file = folder.resolve("r.csv")
        val nowNs = AtomicLong()
        val recording = async(Dispatchers.Default) { sensors.source().record(file, 100_000_000) { nowNs.get() } }
        sensors.registered(2)
        var timeNs = 0L
        withTimeout(120_000) {
            while (!file.exists() || file.readLines().size < 2) {
                nowNs.addAndGet(1_000_000_000)
                sensors.deliver(Sensor.TYPE_MAGNETIC_FIELD, ++timeNs, 1f, 2f, 3f)
                delay(5)
            }
        }
        recording.cancelAndJoin()
        val about = "\"magcomp $VERSION; MAKER MODEL, Android 15; magnetometer m\"\"1\"\" of maker, inc; up a of maker\""
        assertTrue(file.readLines()[1].endsWith(about), file.readText())
        assertTrue("<version>$VERSION</version>" in repository.resolve("android/pom.xml").readText())
    }

    @Test
    fun `a process that is killed loses a second, packed or not`() = runBlocking {
        for (name in listOf("r.csv", "r.csv.gz")) {
            val sensors = FakeSensorManager(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, Sensor.TYPE_GRAVITY, Sensor.TYPE_GYROSCOPE)
            // a clock by which a second passes from row to row
            val nowNs = AtomicLong()
            val file = folder.resolve(name)
            val recording = async(Dispatchers.Default) { sensors.source().record(file, 100_000_000) { nowNs.addAndGet(1_000_000_000) } }
            sensors.registered(3)
            val phone = Phone(1)
            repeat(1000) { phone.advance(still = false).forEach(sensors::deliver) }
            // what is there without an end
            fun cut(): List<String> {
                val text = ByteArrayOutputStream()
                try {
                    val bytes = file.readBytes().inputStream()
                    val unpacked = if (name.endsWith(".gz")) GZIPInputStream(bytes) else bytes
                    // one by one: a reader would lose what it has read when it is cut off
                    generateSequence { unpacked.read().takeIf { it >= 0 } }.forEach(text::write)
                } catch (_: java.io.EOFException) {
                    // cut off
                }
                return text.toString().removeSuffix("\n").lines()
            }
            withTimeout(120_000) { while (cut().size < 1000) delay(5) }
            val lines = cut()
            // the last line may be cut, and the first names the sensors
            assertTrue(lines.dropLast(1).drop(2).all { line -> line.count { it == ',' } == 15 }, "whole rows")
            recording.cancelAndJoin()
        }
    }

    @Test
    fun `a file with something in it stays, an empty one is taken`() = runBlocking {
        val file = folder.resolve("r.csv").apply { writeText("mine") }
        val error = assertThrows(FileAlreadyExistsException::class.java) { runBlocking { Played(listOf(up(1))).record(file) } }
        assertTrue("another name" in error.message!!, error.message)
        assertEquals("mine", file.readText())
        assertEquals(1L, Played(listOf(up(1))).record(File.createTempFile("recording", ".csv", folder)))
    }

    @Test
    fun `it is written on a thread for that, and so is a source of one's own collected`() = runBlocking {
        val threads = CopyOnWriteArrayList<Thread>()
        val noted = object : FlowSource() {
            override fun played() = flow {
                threads += Thread.currentThread()
                emit(up(1))
            }
        }
        val mine = Thread.currentThread()
        noted.record(folder.resolve("r.csv"), 1000) { 0L.also { threads += Thread.currentThread() } }
        assertTrue(threads.size > 1 && mine !in threads, "$threads")
    }

    @Test
    fun `it ends before it is too large, with a file that plays`() = runBlocking {
        val endless = object : FlowSource() {
            override fun played() = flow {
                var k = 0L
                while (true) {
                    k += STEP_NS
                    emit(rate(k))
                    emit(field(k))
                }
            }
        }
        val file = folder.resolve("r.csv")
        val least = folder.resolve("least.csv")
        assertTrue(endless.record(least, mostBytes = 1000) > 0 && least.length() <= 1000, "${least.length()}")
        val events = endless.record(file, mostBytes = 10_000)
        assertTrue(file.length() in 9_600..10_000, "${file.length()}")
        assertEquals(events, RecordingSource(file).samples().toList().size.toLong())
        assertThrows(IllegalArgumentException::class.java) { runBlocking { endless.record(file, mostBytes = 999) } }
        assertTrue(file.length() > 9_700, "what is refused changes nothing")
    }

    @Test
    fun `cancelled it has written all so far, beside a compass, on sensors registered once`() = runBlocking {
        val sensors = FakeSensorManager(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, Sensor.TYPE_GRAVITY, Sensor.TYPE_GYROSCOPE)
        val compass = Compass(sensors.source(), grace = ZERO)
        val phone = Phone(1, reported = HARD_IRON_UT)
        val readings = CopyOnWriteArrayList<CompensatedReading>()
        val reading = CoroutineScope(Dispatchers.Unconfined).launch { compass.readings().collect(readings::add) }
        sensors.registered(3)
        val file = folder.resolve("r.csv.gz")
        val recording = async(Dispatchers.Default) { compass.record(file) }
        // until it has begun
        withTimeout(120_000) {
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
        assertTrue(text.drop(2).all { it.count { c -> c == ',' } == 15 }, "whole rows")
        reading.cancelAndJoin()
        assertEquals(0, sensors.registrations.size)
    }

    @Test
    fun `what waits for it when it is cancelled is written, as far as there is room`() = runBlocking {
        for ((name, mostBytes) in listOf("all.csv" to 100_000L, "full.csv" to 1000L)) {
            val given = CountDownLatch(1)
            val source = object : FlowSource() {
                override fun played() = flow {
                    for (k in 1L..100) emit(field(k * STEP_NS))
                    given.countDown()
                    awaitCancellation()
                }
            }
            val file = folder.resolve(name)
            val writing = CountDownLatch(1)
            // its first row is written when it is cancelled
            var calls = 0
            val recording = async(Dispatchers.Default) { source.record(file, mostBytes) { if (++calls > 1) writing.await(); 0 } }
            withTimeout(120_000) { while (given.count > 0) delay(1) }
            recording.cancel()
            writing.countDown()
            recording.join()
            if (name == "all.csv") assertEquals(100, rows(file).size) else assertTrue(file.length() in 600..1000, "${file.length()}")
        }
    }

    @Test
    fun `an error of the source is that of the recording, whatever it is`() {
        val broken = object : FlowSource() {
            override fun played() = flow {
                emit(up(1))
                throw NoSuchElementException("of the app")
            }
        }
        val file = folder.resolve("r.csv")
        val error = assertThrows(NoSuchElementException::class.java) { runBlocking { broken.record(file) } }
        assertEquals("of the app", error.message)
        assertEquals(1, rows(file).size)
    }

    @Test
    fun `a file that can't be written is an error, and no sensor stays registered`() = runBlocking {
        val sensors = FakeSensorManager(Sensor.TYPE_MAGNETIC_FIELD, Sensor.TYPE_GRAVITY)
        assertThrows(java.io.IOException::class.java) { runBlocking { sensors.source().record(folder.resolve("none/r.csv")) } }
        assertEquals(0, sensors.most.get())
        val waiting = object : FlowSource() {
            override fun played() = flow<SensorSample> { awaitCancellation() }
        }
        val file = folder.resolve("r.csv")
        val recording = async(Dispatchers.Default) { waiting.record(file) }
        withTimeout(120_000) { while (!file.exists()) delay(1) }
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
