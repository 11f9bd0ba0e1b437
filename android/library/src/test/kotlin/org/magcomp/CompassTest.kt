package org.magcomp

import java.io.File
import java.util.concurrent.CancellationException
import kotlin.math.abs
import kotlinx.coroutines.delay
import kotlinx.coroutines.flow.Flow
import kotlinx.coroutines.flow.MutableStateFlow
import kotlinx.coroutines.flow.asFlow
import kotlinx.coroutines.flow.flow
import kotlinx.coroutines.flow.last
import kotlinx.coroutines.flow.map
import kotlinx.coroutines.flow.onEach
import kotlinx.coroutines.flow.take
import kotlinx.coroutines.flow.toList
import kotlinx.coroutines.runBlocking
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertNotEquals
import org.junit.jupiter.api.Assertions.assertNotNull
import org.junit.jupiter.api.Assertions.assertNull
import org.junit.jupiter.api.Assertions.assertThrows
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.junit.jupiter.api.io.TempDir
import org.magcomp.core.*

class CompassTest {
    private class Kept(var text: String? = null) : CalibrationStore {
        var saves = 0

        override fun load(): String? = text

        override fun save(text: String) {
            saves += 1
            this.text = text
        }
    }

    private val events = events(tumbling(1500))

    @Test
    fun `a slow screen sees the latest, and the estimator loses none`() = runBlocking {
        val readings = Compass(Played(events)).headings().onEach { if (it.timeNs == STEP_NS) delay(500) }.toList()
        assertTrue(readings.size < 1500, "${readings.size} arrived")
        val last = Compensator().use { it.pushAll(events) }.last()
        assertEquals(Triple(last.timeNs, last.status, last.event), with(readings.last()) { Triple(timeNs, status, event) })
        assertEquals(last.heading!!.headingDeg, readings.last().headingDeg!!, 1e-9)
    }

    @Test
    fun `a fast collector loses none`() = runBlocking {
        val readings = events.asFlow().compensated().toList()
        assertEquals(Compensator().use { it.pushAll(events) }, readings.map { it.reading })
        assertEquals(0, readings.sumOf { it.droppedBefore })
    }

    @Test
    fun `the directions to turn to become fewer`() = runBlocking {
        val readings = events.asFlow().compensated().toList()
        val (first, last) = Pair(readings.first().unseenDirections, readings.last().unseenDirections)
        assertTrue(first.size >= 47, "${first.size} at the first sample")
        assertTrue(last.size < 24, "${last.size} after turning about")
        assertEquals(last.size / 48.0, 1 - readings.last().reading.coverage, 0.05, "renewed five times a second")
        val renewed = (1 until readings.size).filter { readings[it - 1].unseenDirections !== readings[it].unseenDirections }
        assertTrue(renewed.size > 10 && renewed.all { it % 20 == 0 }, "every 20 samples, and no more often: $renewed")
        for (at in renewed) assertNotEquals(readings[at - 1].unseenDirections, readings[at].unseenDirections, "the same list is not made again")
    }

    @Test
    fun `after a stamp an hour ahead guidance and saving go on`() = runBlocking {
        val store = Kept()
        val all = events(tumbling(6500)).toMutableList()
        val field = (all[199] as SensorSample.Magnetic).sample
        all.add(200, SensorSample.Magnetic(field.copy(timeNs = field.timeNs + 3_600_000_000_000)))
        val readings = all.asFlow().compensated(store = store).toList()
        assertTrue(readings.last().unseenDirections.size < 24, "${readings.last().unseenDirections.size} unseen")
        assertTrue(store.saves in 8..12, "saved ${store.saves} times in 65 s: every 10 s after the way back, too")
    }

    @Test
    fun `an error of the source arrives at the collector, after the readings before it`() {
        for (error in listOf(SensorException.Refused("magnetometer"), CancellationException("of the source"))) {
            val broken = flow {
                for (event in events.take(100)) emit(event)
                throw error
            }
            val readings = mutableListOf<CompensatedReading>()
            val arrived = assertThrows(Exception::class.java) { runBlocking { broken.compensated().toList(readings) } }
            // coroutines may have copied it
            assertEquals(Pair(error.javaClass, error.message), Pair(arrived.javaClass, arrived.message))
            assertEquals(50, readings.size)
        }
    }

    @Test
    fun `an error of the collector ends the source`() {
        class OfTheApp : Exception()
        assertThrows(OfTheApp::class.java) { runBlocking { events.asFlow().compensated().collect { throw OfTheApp() } } }
    }

    @Test
    fun `a source that never waits ends with its collector`() = runBlocking {
        var asked = 0L
        val source = generateSequence { if (asked < MANY) MagneticSample(++asked * STEP_NS, DeviceVector(1.0, 2.0, 3.0 + asked % 7)) else null }
        assertEquals(3, source.map { SensorSample.Magnetic(it) }.asFlow().compensated().take(3).toList().size)
        assertTrue(asked < MANY, "it was played to its end")
    }

    @Test
    fun `the calibration is kept from one launch to the next`() = runBlocking {
        val store = Kept()
        Compass(Played(events), store = store).readings().last()
        assertTrue(store.text!!.length < 4000, "no more than the next launch takes over")
        val again = Compass(Played(events.take(2)), store = store).readings().take(1).toList().single()
        assertNotNull(again.reading.fieldUt, "calibrated from the first sample on, though the clock began anew")
        assertTrue(again.reading.status !is CompensationStatus.Rejected)
    }

    @Test
    fun `a damaged store, or one of a newer version, is as none, and is told`() = runBlocking {
        val newer = Compensator().use {
            it.pushAll(events)
            newer(it.keep(NOW_S)!!)
        }
        for (text in listOf("", "{}", "nonsense", newer)) {
            val first = events.asFlow().compensated(store = Kept(text)).take(1).toList().single()
            assertNull(first.reading.fieldUt)
            val expected = if (text == newer) MagcompException.KeptNewer::class else MagcompException.KeptDamaged::class
            assertEquals(expected, first.storeError!!::class)
        }
    }

    @Test
    fun `preferences keep a text`() {
        val preferences = FakePreferences()
        val store = PreferencesStore(preferences)
        assertNull(store.load())
        store.save("a")
        store.save("b")
        assertEquals("b", PreferencesStore(preferences).load())
        // each situation has its own
        val app = FakeApp(FakeSensorManager())
        PreferencesStore(app, "mount").save("m")
        assertNull(PreferencesStore(app).load())
        assertEquals("m", PreferencesStore(app, "mount").load())
    }

    @Test
    fun `a declination may be set while readings come`(): Unit = runBlocking {
        val half = events.size / 2
        lateinit var compass: Compass
        val moving = flow {
            for ((k, event) in events.withIndex()) {
                if (k == half) compass.declinationDeg = 3.0
                emit(event)
            }
        }
        compass = Compass(Played(moving), CompensationConfig(heading = HeadingConfig(axis = ReferenceAxis.TOP_EDGE)))
        val readings = compass.readings().toList().map { it.reading }
        val still = Compensator(CompensationConfig(heading = HeadingConfig(axis = ReferenceAxis.TOP_EDGE))).use { it.pushAll(events) }
        assertEquals(still.take(half / 2), readings.take(half / 2))
        val (before, after) = Pair(still.last().heading!!, readings.last().heading!!)
        assertEquals(before.copy(trueHeadingDeg = trueHeadingDeg(before.headingDeg, 3.0)), after)
    }

    @Test
    fun `a compass has the config's frame where none is asked for`(): Unit = runBlocking {
        val heading = HeadingConfig(axis = ReferenceAxis.CAMERA, screenRotation = ScreenRotation.DEG90, declinationDeg = 3.0)
        val config = CompensationConfig(method = CompensationMethod.WINDOWED, heading = heading)
        val compass = Compass(Played(events), config)
        assertEquals(3.0, compass.declinationDeg)
        val expected = Compensator(config).use { it.pushAll(events) }.last()
        assertEquals(expected, compass.readings().last().reading)
        val shown = compass.headings().last()
        assertEquals(expected.heading!!.headingDeg, shown.headingDeg!!, 1e-9)
        assertEquals(expected.heading!!.trueHeadingDeg!!, shown.trueHeadingDeg!!, 1e-9)
        assertEquals(null, Compass(Played(events)).declinationDeg)
    }

    @Test
    fun `a compass and a compensator have the same defaults`(): Unit = runBlocking {
        assertEquals(defaultConfig().heading!!.axis, CompensationConfig().headingFrame().axis)
        val hardIron = DeviceVector(HARD_IRON[0], HARD_IRON[1], HARD_IRON[2])
        val reported = events.map { if (it is SensorSample.Magnetic) SensorSample.Magnetic(it.sample.copy(reportedHardIronUt = hardIron)) else it }
        val expected = Compensator().use { compensator ->
            reported.mapNotNull { event ->
                when (event) {
                    is SensorSample.Magnetic -> compensator.push(event.sample)
                    is SensorSample.RotationRate -> with(event.sample.rateRadS) { compensator.pushRotationRate(event.timeNs, x, y, z) }.let { null }
                    is SensorSample.Up -> with(event.sample.upMS2) { compensator.pushUp(event.timeNs, x, y, z) }.let { null }
                }
            }
        }
        assertNotNull(expected.first().fieldUt)
        assertEquals(expected.last(), Compass(Played(reported)).readings().last().reading)
        assertEquals(expected.last(), reported.asFlow().compensated().last().reading)
    }

    @Test
    fun `the system's own hard iron reaches the compensator`() = runBlocking {
        val (x, y, z) = HARD_IRON.toList()
        val samples = events.filterIsInstance<SensorSample.Magnetic>().map { it.sample.copy(reportedHardIronUt = DeviceVector(x, y, z)) }
        val config = CompensationConfig(useReportedHardIron = true)
        val readings = samples.map { SensorSample.Magnetic(it) }.asFlow().compensated(config).toList()
        assertNotNull(readings.first().reading.fieldUt, "the system's estimate is the first calibration")
        assertEquals(Compensator(config).use { c -> samples.map { c.push(it) } }, readings.map { it.reading })
        assertEquals(samples, readings.map { it.sample })
    }

    @Test
    fun `a recording that is not in order says where`(@TempDir folder: File) {
        fun error(text: String): RecordingException {
            val file = folder.resolve("r.csv").apply { writeText(text) }
            return assertThrows(RecordingException::class.java) { runBlocking { RecordingSource(file).samples().toList() } }
        }
        assertEquals(Pair(1, "mz"), error("t_s,mx,my\n").let { Pair(it.line, it.column) })
        assertEquals(Pair(3, "my"), error("t_s,mx,my,mz\n0,1,2,3\n1,1,x,3\n").let { Pair(it.line, it.column) })
        assertEquals(Pair(2, null), error("t_s,mx,my,mz\n0,1,2\n").let { Pair(it.line, it.column) })
        assertEquals(Pair(2, "t_s"), error("t_s,mx,my,mz\nnan,1,2,3\n").let { Pair(it.line, it.column) })
        assertEquals(Pair(2, "t_s"), error("t_s,mx,my,mz\n1e10,1,2,3\n").let { Pair(it.line, it.column) })
        assertEquals("r.csv, line 1: the header is missing", error("").message)
    }

    @Test
    fun `a recording's columns may come in any order`() = runBlocking {
        // with the mark, the line ends and the empty last line of a spreadsheet
        val text = "\uFEFFmz,note,mx,my,t_s,ax,ay,az\r\n3,?,1,2,0.25,0,0,9.8\r\n\r\n"
        val source = RecordingSource("text") { text.reader() }
        val expected = listOf(
            SensorSample.Up(UpSample(250_000_000, DeviceVector(0.0, 0.0, 9.8))),
            SensorSample.Magnetic(MagneticSample(250_000_000, DeviceVector(1.0, 2.0, 3.0))),
        )
        assertEquals(expected, source.samples().toList())
        assertEquals(expected, source.samples().toList(), "cold: it can be collected again")
    }

    private companion object {
        const val MANY = 300_000L
    }
}
