package org.magcomp.sample

import android.content.res.Resources
import android.view.Surface
import androidx.compose.ui.ImageComposeScene
import androidx.compose.ui.test.ExperimentalTestApi
import androidx.compose.ui.test.assertIsOff
import androidx.compose.ui.test.onNodeWithContentDescription
import androidx.compose.ui.test.onNodeWithText
import androidx.compose.ui.test.performClick
import androidx.compose.ui.test.runDesktopComposeUiTest
import androidx.compose.ui.unit.Density
import androidx.compose.ui.use
import java.io.File
import java.util.Locale
import javax.imageio.ImageIO
import javax.xml.parsers.DocumentBuilderFactory
import kotlin.math.cos
import kotlin.math.sin
import kotlin.time.Duration.Companion.ZERO
import kotlinx.coroutines.async
import kotlinx.coroutines.awaitCancellation
import kotlinx.coroutines.flow.MutableStateFlow
import kotlinx.coroutines.flow.first
import kotlinx.coroutines.flow.flow
import kotlinx.coroutines.flow.flowOf
import kotlinx.coroutines.flow.toList
import kotlinx.coroutines.runBlocking
import kotlinx.coroutines.withTimeout
import org.jetbrains.skia.EncodedImageFormat
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertNull
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.Compass
import org.magcomp.CompensatedReading
import org.magcomp.EventTaker
import org.magcomp.MagneticFieldSource
import org.magcomp.RawEvent
import org.magcomp.SensorAccuracy
import org.magcomp.SensorsInUse
import org.magcomp.UsedSensor
import org.magcomp.core.CollectingReason
import org.magcomp.core.CompassHeading
import org.magcomp.core.CompensationStatus
import org.magcomp.core.DeviceVector
import org.magcomp.core.FieldEvent
import org.magcomp.core.FieldEventKind
import org.magcomp.core.HeadingAid
import org.magcomp.core.HeadingFrame
import org.magcomp.core.HoldReason
import org.magcomp.core.MagneticReading
import org.magcomp.core.MagneticSample
import org.magcomp.core.ReferenceAxis
import org.magcomp.core.ScreenRotation
import org.magcomp.core.SensorMode
import org.magcomp.core.SensorSample
import org.magcomp.core.heading
import org.magcomp.screenRotation
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

// without its constructor, which calls Android's native part
internal val resources = (Unsafe::class.java.getDeclaredField("theUnsafe").apply { isAccessible = true }.get(null) as Unsafe)
    .allocateInstance(English::class.java) as Resources

class ScreenTest {
    private val unseen = listOf(DeviceVector(1.0, 0.0, 0.0), DeviceVector(0.0, -1.0, 0.0), DeviceVector(0.0, 0.6, 0.8), DeviceVector(-0.7, 0.1, -0.7))

    private fun answer(
        status: CompensationStatus,
        headingDeg: Double? = 41.6,
        timeNs: Long = 0,
        event: FieldEvent? = null,
        unseen: List<DeviceVector> = this.unseen,
        aid: HeadingAid? = null,
    ) = CompensatedReading(
        MagneticReading(
            timeNs = timeNs, fieldUt = headingDeg?.let { DeviceVector(20.0, 5.0, -40.0) }, fieldSigmaUt = null, filteredFieldUt = null,
            totalFieldUt = headingDeg?.let { 45.0 }, heading = headingDeg?.let { CompassHeading(it, 12.4, it + 3, 60.0) }, attitude = null, sigmaT = null,
            window = 0, coverage = 0.5, directionSigmaDeg = null, worstSigmaDeg = null, modelOrder = null, reportedHardIronJumpUt = null,
            mode = SensorMode.GYROSCOPE_AND_GRAVITY, event = event, status = status,
        ),
        MagneticSample(timeNs, DeviceVector(1.0, 2.0, 3.0)),
        unseen,
        headingAid = aid,
    )

    @Test
    fun `the stand-in of R names the sample's own strings`() {
        assertEquals(own.keys - "app_name", names("org.magcomp.sample.R\$string").values.toSet() - "app_name")
    }

    @Test
    fun `every part of a reading is said`() {
        val event = FieldEvent(FieldEventKind.DEVICE_STEP, 1_000_000_000, 2_410_000_000)
        val state = ScreenModel(resources).show(answer(CompensationStatus.Held(HoldReason.TooLittleRotation), event = event), systemDeg = 47.2)
        assertEquals("42° ± 13°", state.heading, "as wide as the rose's sector, which is rounded up")
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
        val state = ScreenModel(resources).show(answer(CompensationStatus.Disturbed(1)), systemDeg = null)
        assertEquals("Walk away from metal and magnets.", state.banner)
        assertNull(state.guidance)
        assertNull(state.systemHeading)
    }

    @Test
    fun `without a heading the rose is empty`() {
        val state = ScreenModel(resources).show(answer(CompensationStatus.Collecting(CollectingReason.Rotation), headingDeg = null), systemDeg = null)
        assertNull(state.roseDeg)
        assertNull(state.next)
        assertEquals(listOf("no heading yet", "no heading yet", "Turn the phone."), listOf(state.heading, state.spoken, state.guidance))
    }

    @Test
    fun `the rose goes the shorter way round`() {
        val model = ScreenModel(resources)
        model.show(answer(CompensationStatus.Tracking, 350.0, timeNs = 0), null)
        // half of 20 degrees in a half-life
        assertEquals(0.0, model.show(answer(CompensationStatus.Tracking, 10.0, timeNs = 100_000_000), null).roseDeg!!, 1e-9)
    }

    @Test
    fun `an error and the end are said, and nothing of before stays`(): Unit = runBlocking {
        fun source(events: kotlinx.coroutines.flow.Flow<SensorSample>) = object : MagneticFieldSource {
            override suspend fun deliver(taker: EventTaker) = events.collect { taker.take(RawEvent().set(it)) }
        }
        val sample = SensorSample.Magnetic(MagneticSample(1, DeviceVector(1.0, 2.0, 3.0)))
        val over = ScreenModel(resources).states(Compass(source(flowOf(sample)), grace = ZERO), MutableStateFlow(null)).toList()
        assertEquals("the readings have ended", over.last().status)
        assertNull(over.last().roseDeg)
        assertTrue(over.size == 2 && over[0].status.startsWith("collecting: "), "$over")
        val broken = ScreenModel(resources).states(Compass(source(flow { error("broken") }), grace = ZERO), MutableStateFlow(null)).toList()
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

    /** The device to east, north, up: lying flat, its top edge at an angle from north. */
    private fun flat(topEdgeDeg: Double) = Math.toRadians(topEdgeDeg).let { a ->
        floatArrayOf(cos(a).toFloat(), sin(a).toFloat(), 0f, -sin(a).toFloat(), cos(a).toFloat(), 0f, 0f, 0f, 1f)
    }

    @Test
    fun `the system's heading and ours turn together with the screen`() {
        val display = listOf(Surface.ROTATION_0, Surface.ROTATION_90, Surface.ROTATION_180, Surface.ROTATION_270)
        for (topEdgeDeg in listOf(0.0, 30.0, 200.0)) {
            // 20 uT to the north, 40 down, in the device
            val a = Math.toRadians(topEdgeDeg)
            val field = DeviceVector(-20 * sin(a), 20 * cos(a), -40.0)
            for (rotation in display) {
                val frame = HeadingFrame(ReferenceAxis.AUTO, screenRotation(rotation), null)
                val ours = heading(field, DeviceVector(0.0, 0.0, 1.0), frame)!!.headingDeg
                val system = headingDeg(flat(topEdgeDeg), rotation)!!
                assertEquals(0.0, Math.IEEEremainder(ours - system, 360.0), 1e-3, "$topEdgeDeg, $rotation")
            }
        }
    }

    @Test
    fun `the sphere turns with the screen`() {
        val up = answer(CompensationStatus.Tracking, unseen = listOf(DeviceVector(1.0, 0.5, 0.2)))
        fun on(rotation: ScreenRotation) = ScreenModel(resources).show(up, null, rotation).unseen.single()
        // of a screen that is turned left by 90 degrees the device's right edge is the top
        assertEquals(DeviceVector(1.0, 0.5, 0.2), on(ScreenRotation.DEG0))
        assertEquals(DeviceVector(-0.5, 1.0, 0.2), on(ScreenRotation.DEG90))
        assertEquals(DeviceVector(-1.0, -0.5, 0.2), on(ScreenRotation.DEG180))
        assertEquals(DeviceVector(0.5, -1.0, 0.2), on(ScreenRotation.DEG270))
        assertEquals(on(ScreenRotation.DEG90), ScreenModel(resources).show(up, null, ScreenRotation.DEG90).next)
    }

    @Test
    fun `a magnetometer that is silent is said, though there is no reading`(): Unit = runBlocking {
        val used = UsedSensor(14, "m", "v", SensorAccuracy.HIGH)
        val silent = object : MagneticFieldSource {
            override suspend fun deliver(taker: EventTaker) {
                taker.heard(SensorsInUse(used, null, null, null))
                taker.heard(SensorsInUse(used.copy(isSilent = true), null, null, null))
                awaitCancellation()
            }
        }
        val states = async { ScreenModel(resources).states(Compass(silent, grace = ZERO), MutableStateFlow(null)).first() }
        assertTrue("the magnetometer delivers nothing" in withTimeout(120_000) { states.await() }.status)
    }

    private val letters = listOf("N", "E", "S", "W")

    private fun drawn(state: ScreenState, isDark: Boolean = false, letters: List<String> = this.letters) =
        ImageComposeScene(720, 1480, Density(2f)).use { scene ->
            scene.setContent { CompassScreen(state, letters, isDark) }
            scene.render().encodeToData(EncodedImageFormat.PNG)!!.bytes
        }

    private fun image(png: ByteArray) = ImageIO.read(png.inputStream())

    /** The pixels in which two pictures differ. */
    private fun differing(one: ScreenState, other: ScreenState, letters: List<String>, otherLetters: List<String>): List<Pair<Int, Int>> {
        val (a, b) = Pair(image(drawn(one, letters = letters)), image(drawn(other, letters = otherLetters)))
        val at = (0 until a.height).flatMap { y -> (0 until a.width).filter { x -> a.getRGB(x, y) != b.getRGB(x, y) }.map { x -> Pair(x, y) } }
        assertTrue(at.isNotEmpty(), "the same picture")
        return at
    }

    /** Their middle, from the middle of the rose: right and up, in its radii. */
    private fun where(one: ScreenState, other: ScreenState, letters: List<String> = this.letters, otherLetters: List<String> = letters): Pair<Double, Double> {
        val at = differing(one, other, letters, otherLetters)
        // the rose is the first thing: 260 dp below a margin of 24
        return Pair((at.map { it.first }.average() - 360) / 260, -(at.map { it.second }.average() - 308) / 260)
    }

    @Test
    fun `the rose turns against the heading, its letters clockwise`() {
        for ((headingDeg, x, y) in listOf(Triple(0.0, 0.0, 0.9), Triple(90.0, -0.9, 0.0), Triple(180.0, 0.0, -0.9), Triple(270.0, 0.9, 0.0))) {
            val state = ScreenState(roseDeg = headingDeg, sigmaDeg = 0.0)
            val north = where(state, state, letters, listOf("", "E", "S", "W"))
            assertEquals(x, north.first, 0.1, "N at $headingDeg")
            assertEquals(y, north.second, 0.1, "N at $headingDeg")
        }
        val north = ScreenState(roseDeg = 0.0, sigmaDeg = 0.0)
        assertEquals(0.9, where(north, north, letters, listOf("N", "", "S", "W")).first, 0.1, "E is to the right")
        assertEquals(-0.9, where(north, north, letters, listOf("N", "E", "S", "")).first, 0.1, "W is to the left")
        // the needle and its sector point to N
        assertTrue(where(north, north.copy(sigmaDeg = 20.0)).second > 0.3)
        assertTrue(where(north.copy(roseDeg = 90.0), north.copy(roseDeg = 90.0, sigmaDeg = 20.0)).first < -0.3)
        // one standard deviation to either side, as far as the number
        val (narrow, wide) = listOf(north, north.copy(sigmaDeg = 20.0)).map { image(drawn(it)) }
        fun isInSector(deg: Int) = Math.toRadians(deg.toDouble()).let { a ->
            Pair((360 + 150 * sin(a)).toInt(), (308 - 150 * cos(a)).toInt()).let { (x, y) -> narrow.getRGB(x, y) != wide.getRGB(x, y) }
        }
        assertEquals(listOf(false, true, true, true, true, false), listOf(-22, -18, -10, 10, 18, 22).map(::isInSector))
        for (unknown in listOf(-1.0, Double.NaN)) assertEquals(0.0, where(north, north.copy(sigmaDeg = unknown)).second, 0.1, "the whole rose")
        // letters stay upright: most of a T is above its middle
        for (headingDeg in listOf(0.0, 90.0, 180.0, 225.0)) {
            val state = ScreenState(roseDeg = headingDeg, sigmaDeg = 0.0)
            val y = differing(state, state, listOf("T", "", "", ""), listOf("", "", "", "")).map { it.second }
            assertTrue(y.average() < (y.min() + y.max()) / 2.0 - 1, "at $headingDeg")
        }
        // the lubber line is at the top of an empty rose
        val empty = image(drawn(ScreenState()))
        val ink = (0 until empty.height).flatMap { y -> (0 until empty.width).filter { x -> empty.getRGB(x, y) == 0xff1b1b1b.toInt() }.map { x -> Pair(x, y) } }
        assertTrue(ink.isNotEmpty() && ink.all { (x, y) -> x in 350..370 && y in 40..80 }, "$ink")
    }

    @Test
    fun `the sphere has right on the right and up above`() {
        val none = ScreenState(unseen = listOf(DeviceVector(0.0, 0.0, 1.0)))
        fun dot(v: DeviceVector) = where(none, none.copy(unseen = none.unseen + v))
        val (middle, right, up) = Triple(dot(DeviceVector(0.0, 0.1, 1.0)), dot(DeviceVector(0.9, 0.0, 0.0)), dot(DeviceVector(0.0, 0.9, 0.0)))
        assertTrue(right.first > middle.first + 0.1, "$middle, $right")
        assertTrue(up.second > middle.second + 0.1, "$middle, $up")
        val ring = where(none, none.copy(pointing = DeviceVector(-0.9, 0.0, 0.0)))
        assertTrue(ring.first < middle.first - 0.1, "$ring")
    }

    @OptIn(ExperimentalTestApi::class)
    @Test
    fun `a screen reader hears the rose as one sentence, and every line of text`() = runDesktopComposeUiTest(720, 1480) {
        val state = ScreenModel(resources).show(answer(CompensationStatus.Held(HoldReason.TooLittleRotation)), systemDeg = 47.2)
        setContent { CompassScreen(state, letters, isDark = false) }
        onNodeWithContentDescription("heading 42 degrees, give or take 13").assertExists()
        // its letters would be heard one by one
        for (letter in letters) onNodeWithText(letter).assertDoesNotExist()
        for (text in listOf(state.heading, state.trueHeading!!, state.systemHeading!!, state.status, state.guidance!!)) onNodeWithText(text).assertExists()
    }

    @OptIn(ExperimentalTestApi::class)
    @Test
    fun `a switch says whether a course helps, and sets it`() = runDesktopComposeUiTest(720, 1480) {
        val wanted = mutableListOf<Boolean>()
        val state = ScreenModel(resources).show(answer(CompensationStatus.Tracking, aid = HeadingAid.DISAGREES), systemDeg = null)
        setContent { CompassScreen(state, letters, isDark = false, switches = listOf(ScreenSwitch(isOn = false, own.getValue("course_off")) { wanted += it })) }
        onNodeWithText("the heading from outside disagrees, and is ignored").assertExists()
        onNodeWithText("course of the GNSS: does not help").assertIsOff().performClick()
        assertEquals(listOf(true), wanted)
    }

    @OptIn(ExperimentalTestApi::class)
    @Test
    fun `a recording is shared by a button`() = runDesktopComposeUiTest(720, 1480) {
        var shared = 0
        setContent { CompassScreen(ScreenState(), letters, isDark = false, buttons = listOf(ScreenButton(own.getValue("share")) { shared += 1 })) }
        onNodeWithText("share the recording").performClick()
        assertEquals(1, shared)
    }

    /** The picture of android/README.md is one of these. */
    @Test
    fun `the screen is drawn, in light and dark`() {
        val event = FieldEvent(FieldEventKind.DEVICE_STEP, 1_000_000_000, 2_410_000_000)
        val state = ScreenModel(resources).show(answer(CompensationStatus.Disturbed(1), event = event), systemDeg = 58.0)
        val picture = File(System.getProperty("picture"))
        picture.writeBytes(drawn(state))
        val (light, dark) = Pair(ImageIO.read(picture), image(drawn(state, isDark = true)))
        assertEquals(0xfffafafa.toInt(), light.getRGB(4, 4))
        assertEquals(0xff111417.toInt(), dark.getRGB(4, 4))
        // the rose turns, the sector widens, the banner goes
        fun differs(other: ScreenState) = image(drawn(other)).let { its ->
            (0 until its.height).any { y -> (0 until its.width).any { x -> its.getRGB(x, y) != light.getRGB(x, y) } }
        }
        assertTrue(!differs(state), "the same state is the same picture")
        for (other in listOf(state.copy(roseDeg = 90.0), state.copy(sigmaDeg = 40.0), state.copy(banner = null), state.copy(next = null))) {
            assertTrue(differs(other), "$other")
        }
    }
}
