package org.magcomp.sample

import android.content.res.Resources
import androidx.compose.ui.ImageComposeScene
import androidx.compose.ui.unit.Density
import androidx.compose.ui.use
import java.io.File
import java.util.Locale
import javax.imageio.ImageIO
import javax.xml.parsers.DocumentBuilderFactory
import kotlinx.coroutines.flow.MutableStateFlow
import kotlinx.coroutines.flow.flow
import kotlinx.coroutines.flow.flowOf
import kotlinx.coroutines.flow.toList
import kotlinx.coroutines.runBlocking
import org.jetbrains.skia.EncodedImageFormat
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertNull
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.Compass
import org.magcomp.CompensatedReading
import org.magcomp.Event
import org.magcomp.EventKind
import org.magcomp.Heading
import org.magcomp.HoldReason
import org.magcomp.MagneticFieldSource
import org.magcomp.MagneticSample
import org.magcomp.Missing
import org.magcomp.Reading
import org.magcomp.SensorMode
import org.magcomp.SensorSample
import org.magcomp.Status
import org.magcomp.Vector3
import org.w3c.dom.Element
import sun.misc.Unsafe

private val repository = File(System.getProperty("repository.root"))

private fun strings(module: String, unescaped: (String) -> String): Map<String, String> {
    val file = repository.resolve("android/$module/src/main/res/values/strings.xml")
    val nodes = DocumentBuilderFactory.newInstance().newDocumentBuilder().parse(file).getElementsByTagName("string")
    return (0 until nodes.length).map { nodes.item(it) as Element }.associate { it.getAttribute("name") to unescaped(it.textContent) }
}

private fun names(holder: String): Map<Int, String> =
    Class.forName(holder).declaredFields.onEach { it.isAccessible = true }.associate { it.getInt(null) to it.name }

private val own = strings("sample") { it }
private val texts = own + strings("library") { it.replace("\\'", "'") }
private val ids = names("org.magcomp.R\$string") + names("org.magcomp.sample.R\$string")

@Suppress("DEPRECATION") // its only constructor
private class English : Resources(null, null, null) {
    override fun getString(id: Int): String = texts.getValue(ids.getValue(id))

    override fun getString(id: Int, vararg values: Any): String = String.format(Locale.ENGLISH, getString(id), *values)
}

class ScreenTest {
    // without its constructor, which calls Android's native part
    private val resources = (Unsafe::class.java.getDeclaredField("theUnsafe").apply { isAccessible = true }.get(null) as Unsafe)
        .allocateInstance(English::class.java) as Resources
    private val unseen = listOf(Vector3(1.0, 0.0, 0.0), Vector3(0.0, -1.0, 0.0), Vector3(0.0, 0.6, 0.8), Vector3(-0.7, 0.1, -0.7))

    private fun answer(status: Status, headingDeg: Double? = 41.6, timeNs: Long = 0, event: Event? = null) = CompensatedReading(
        Reading(
            timeNs = timeNs, fieldUt = headingDeg?.let { Vector3(20.0, 5.0, -40.0) }, fieldSigmaUt = null, filteredFieldUt = null,
            totalFieldUt = headingDeg?.let { 45.0 }, heading = headingDeg?.let { Heading(it, 12.4, it + 3, 60.0) }, attitude = null, sigmaT = null,
            window = 0, coverage = 0.5, directionSigmaDeg = null, worstSigmaDeg = null, modelOrder = null, reportedHardIronJumpUt = null,
            mode = SensorMode.GYROSCOPE_AND_GRAVITY, event = event, status = status,
        ),
        MagneticSample(timeNs, Vector3(1.0, 2.0, 3.0)),
        unseen,
    )

    @Test
    fun `the stand-in of R names the sample's own strings`() {
        assertEquals(own.keys - "app_name", names("org.magcomp.sample.R\$string").values.toSet() - "app_name")
    }

    @Test
    fun `every part of a reading is said`() {
        val event = Event(EventKind.DEVICE_STEP, 1_000_000_000, 2_410_000_000)
        val state = ScreenModel(resources).show(answer(Status.Held(HoldReason.TooLittleRotation), event = event), systemDeg = 47.2)
        assertEquals("42° ± 12°", state.heading)
        assertEquals(41.6, state.roseDeg)
        assertEquals(12.4, state.sigmaDeg)
        assertEquals("true north: 45°", state.trueHeading)
        assertEquals("the system says 47°", state.systemHeading)
        assertEquals("45.0 µT", state.field)
        assertEquals("held: turn the device to learn more", state.status)
        assertEquals("the device's own disturbance changed: relearned in 1.4 s", state.event)
        assertEquals("Turn the phone. Bring the ring to the large dot.", state.guidance)
        assertEquals("directions seen: 50 %", state.seen)
        assertEquals("heading 42 degrees, give or take 13", state.spoken)
        // of the missing directions the one nearest to where the field points
        assertEquals(unseen[0], state.next)
        assertNull(state.banner)
    }

    @Test
    fun `interference is a banner, and its advice is not said twice`() {
        val state = ScreenModel(resources).show(answer(Status.Disturbed(1)), systemDeg = null)
        assertEquals("Walk away from metal and magnets.", state.banner)
        assertNull(state.guidance)
        assertNull(state.systemHeading)
    }

    @Test
    fun `without a heading the rose is empty`() {
        val state = ScreenModel(resources).show(answer(Status.Collecting(Missing.Rotation), headingDeg = null), systemDeg = null)
        assertNull(state.roseDeg)
        assertNull(state.next)
        assertEquals(listOf("no heading yet", "no heading yet", "Turn the phone."), listOf(state.heading, state.spoken, state.guidance))
    }

    @Test
    fun `the rose goes the shorter way round`() {
        val model = ScreenModel(resources)
        model.show(answer(Status.Tracking, 350.0, timeNs = 0), null)
        // half of 20 degrees in a half-life
        assertEquals(0.0, model.show(answer(Status.Tracking, 10.0, timeNs = 100_000_000), null).roseDeg!!, 1e-9)
    }

    @Test
    fun `an error and the end are said, and nothing of before stays`(): Unit = runBlocking {
        fun source(events: kotlinx.coroutines.flow.Flow<SensorSample>) = object : MagneticFieldSource {
            override fun samples() = events
        }
        val sample = SensorSample.Magnetic(MagneticSample(1, Vector3(1.0, 2.0, 3.0)))
        val over = ScreenModel(resources).states(Compass(source(flowOf(sample)), graceMs = 0), MutableStateFlow(null)).toList()
        assertEquals("the readings have ended", over.last().status)
        assertNull(over.last().roseDeg)
        assertTrue(over.size == 2 && over[0].status.startsWith("collecting: "), "$over")
        val broken = ScreenModel(resources).states(Compass(source(flow { error("broken") }), graceMs = 0), MutableStateFlow(null)).toList()
        assertTrue("broken" in broken.single().status)
    }

    @Test
    fun `the system's heading is that of the direction between top edge and camera`() {
        fun matrix(vararg rows: Int) = FloatArray(9) { rows[it].toFloat() }
        // flat, top edge north, then east
        assertEquals(0.0, headingDeg(matrix(1, 0, 0, 0, 1, 0, 0, 0, 1)))
        assertEquals(90.0, headingDeg(matrix(0, 1, 0, -1, 0, 0, 0, 0, 1)))
        // upright, the camera to the east
        assertEquals(90.0, headingDeg(matrix(0, 0, -1, -1, 0, 0, 0, 1, 0)))
        assertNull(headingDeg(matrix(0, 1, 0, 0, 0, 1, 1, 0, 0)))
    }

    /** The picture of android/README.md is one of these. */
    @Test
    fun `the screen is drawn, in light and dark`() {
        val event = Event(EventKind.DEVICE_STEP, 1_000_000_000, 2_410_000_000)
        val letters = listOf("N", "E", "S", "W")
        val state = ScreenModel(resources).show(answer(Status.Disturbed(1), event = event), systemDeg = 58.0)
        fun drawn(state: ScreenState, isDark: Boolean) = ImageComposeScene(720, 1480, Density(2f)).use { scene ->
            scene.setContent { CompassScreen(state, letters, isDark) }
            scene.render().encodeToData(EncodedImageFormat.PNG)!!.bytes
        }
        fun image(png: ByteArray) = ImageIO.read(png.inputStream())
        val picture = File(System.getProperty("picture"))
        picture.writeBytes(drawn(state, isDark = false))
        val (light, dark) = Pair(ImageIO.read(picture), image(drawn(state, isDark = true)))
        assertEquals(0xfffafafa.toInt(), light.getRGB(4, 4))
        assertEquals(0xff111417.toInt(), dark.getRGB(4, 4))
        // the rose turns, the sector widens, the banner goes
        fun differs(other: ScreenState) = image(drawn(other, isDark = false)).let { its ->
            (0 until its.height).any { y -> (0 until its.width).any { x -> its.getRGB(x, y) != light.getRGB(x, y) } }
        }
        assertTrue(!differs(state), "the same state is the same picture")
        for (other in listOf(state.copy(roseDeg = 90.0), state.copy(sigmaDeg = 40.0), state.copy(banner = null), state.copy(next = null))) {
            assertTrue(differs(other), "$other")
        }
    }
}
