package org.magcomp

import java.io.File
import kotlinx.coroutines.flow.toList
import kotlinx.coroutines.runBlocking
import org.json.JSONArray
import org.json.JSONObject
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.core.*

/** Rust's numbers, uniffi's and JNI's are the same, bit for bit; `examples/expected.rs` wrote Rust's. */
class RustAgreementTest {
    private val expected = File(System.getProperty("rust.expected")).readLines().groupBy { it.substringBefore(' ') }
    private val recording = RecordingSource(repository.resolve("tests/recordings/broad_34_attached_magnet_3cm.csv.gz"))
    private val events = runBlocking { recording.samples().toList() }

    @Test
    fun `a recording over JNI, one event at a time`() {
        val readings = Compensator().use { compensator -> events.mapNotNull { push(compensator, it) } }
        assertReadings(readings)
        assertTrue(readings.any { it.heading != null && it.status is CompensationStatus.Tracking }, "the recording shows something")
    }

    @Test
    fun `a recording over JNI, as a list`() {
        assertReadings(Compensator().use { it.pushAll(events) })
    }

    @Test
    fun `a buffer that is used again shows the event of its latest reading`() {
        val buffer = ReadingBuffer()
        val later = 1_000_000_000_000
        val (first, second) = listOf(0, later).map { shift ->
            Compensator().use { compensator ->
                for (event in events) when (event) {
                    is SensorSample.Magnetic -> with(event.sample) { compensator.push(timeNs + shift, fieldUt.x, fieldUt.y, fieldUt.z, buffer) }
                    is SensorSample.RotationRate -> push(compensator, SensorSample.RotationRate(with(event.sample) { copy(timeNs = timeNs + shift) }))
                    is SensorSample.Up -> push(compensator, SensorSample.Up(with(event.sample) { copy(timeNs = timeNs + shift) }))
                }
            }
            buffer.event!!
        }
        assertEquals(first.copy(sinceNs = first.sinceNs + later, decidedNs = first.decidedNs + later), second)
    }

    @Test
    fun `a recording over uniffi`() {
        val readings = NativeCompensator(CompensationConfig()).use { native ->
            events.mapNotNull {
                when (it) {
                    is SensorSample.Magnetic -> native.push(it.sample)
                    is SensorSample.RotationRate -> null.also { _ -> ignoreRejected { native.pushRotationRate(it.sample) } }
                    is SensorSample.Up -> null.also { _ -> ignoreRejected { native.pushUp(it.sample) } }
                }
            }
        }
        assertReadings(readings)
        val overJni = Compensator().use { compensator -> events.mapNotNull { push(compensator, it) } }
        assertEquals(readings, overJni, "every field, status and its data too")
    }

    @Test
    fun `a recording as a flow`() = runBlocking {
        val readings = recording.samples().compensated().toList()
        assertEquals(0, readings.sumOf { it.droppedBefore })
        assertReadings(readings.map { it.reading })
    }

    @Test
    fun `fits of the golden vectors`() {
        val cases = vectors("ellipsoid.json").getJSONArray("cases")
        val ours = (0 until cases.length()).map { number ->
            val case = cases.getJSONObject(number)
            val points = case.getJSONArray("points_ut")
            ConstantField().use { session ->
                for (k in 0 until points.length()) session.add(vector(points.getJSONArray(k)))
                val name = "fit " + case.getString("name").replace(' ', '_')
                try {
                    val (soft, b, strength) = session.finish().calibration
                    name + bits(b.x, b.y, b.z, soft.xx, soft.yy, soft.zz, soft.xy, soft.xz, soft.yz, strength)
                } catch (_: MagcompException.Fit) {
                    name + bits(null)
                }
            }
        }
        assertEquals(expected.getValue("fit"), ours)
    }

    @Test
    fun `headings of the golden vectors`() {
        val attitudes = vectors("headings.json").getJSONArray("attitudes")
        val ours = (0 until attitudes.length()).map { number ->
            val attitude = attitudes.getJSONObject(number)
            val field = vector(attitude.getJSONArray("field_ut"))
            val up = vector(attitude.getJSONArray("up"))
            val all = ReferenceAxis.entries.flatMap { axis ->
                ScreenRotation.entries.map { heading(field, up, HeadingFrame(axis, it))?.headingDeg }
            }
            "heading $number" + bits(*all.toTypedArray())
        }
        assertEquals(expected.getValue("heading"), ours)
    }

    @Test
    fun `headings of attitudes computed by hand`() {
        val facts = vectors("headings.json").getJSONArray("facts")
        assertTrue(facts.length() >= 12)
        for (number in 0 until facts.length()) {
            val fact = facts.getJSONObject(number)
            val rotation = ScreenRotation.entries[fact.getInt("screen_rotation_deg") / 90]
            for ((axis, key) in ReferenceAxis.entries.zip(listOf("top_edge_deg", "camera_deg", "auto_deg"))) {
                val found = heading(vector(fact.getJSONArray("field_ut")), vector(fact.getJSONArray("up")), HeadingFrame(axis, rotation))
                val name = fact.getString("name") + ", " + key
                if (fact.isNull(key)) {
                    assertEquals(null, found, name)
                } else {
                    val off = Math.IEEEremainder(found!!.headingDeg - fact.getDouble(key), 360.0)
                    assertEquals(0.0, off, 1e-9, name)
                    assertEquals(fact.getDouble("inclination_deg"), found.inclinationDeg!!, 1e-9, name)
                }
            }
        }
    }

    private fun assertReadings(readings: List<MagneticReading>) {
        val ours = readings.map {
            val field = it.fieldUt
            val heading = it.heading
            val attitude = it.attitude
            "reading ${it.timeNs} ${it.status.label()}" + bits(
                field?.x, field?.y, field?.z, it.totalFieldUt, heading?.headingDeg, heading?.headingSigmaDeg,
                heading?.inclinationDeg, attitude?.w, attitude?.x, attitude?.y, attitude?.z, attitude?.sigmaDeg, it.sigmaT,
                it.window.toDouble(), it.coverage,
            )
        }
        val theirs = expected.getValue("reading")
        assertEquals(theirs.size, ours.size)
        for ((their, our) in theirs.zip(ours)) assertEquals(their, our)
    }

    private fun push(compensator: Compensator, event: SensorSample): MagneticReading? {
        when (event) {
            is SensorSample.Magnetic -> return compensator.push(event.sample)
            is SensorSample.RotationRate -> with(event.sample.rateRadS) { compensator.pushRotationRate(event.timeNs, x, y, z) }
            is SensorSample.Up -> with(event.sample.upMS2) { compensator.pushUp(event.timeNs, x, y, z) }
        }
        return null
    }

    private fun ignoreRejected(push: () -> Unit) {
        try {
            push()
        } catch (_: MagcompException.EventRejected) {
            // JNI answers false
        }
    }

    private fun bits(vararg values: Double?): String =
        values.joinToString("") { " " + (it?.let { value -> java.lang.Long.toHexString(value.toRawBits()) } ?: "-") }

    private fun vectors(name: String) = JSONObject(repository.resolve("tests/vectors/$name").readText())

    private fun vector(json: JSONArray) = DeviceVector(json.getDouble(0), json.getDouble(1), json.getDouble(2))
}
