package org.magcomp

import java.util.Locale
import kotlin.random.Random
import org.json.JSONObject
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertNull
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.core.*

class TextsTest {
    private val resources = englishResources()

    @Test
    fun `the English texts are the core's own words`() {
        val random = Random(1)
        val seen = mutableSetOf<Class<*>>()
        repeat(200) {
            for (status in statuses(random)) {
                assertEquals(status.text(), status.text(resources))
                val (missing, held) = Pair((status as? CompensationStatus.Collecting)?.missing, (status as? CompensationStatus.Held)?.reason)
                seen += listOfNotNull(status, missing, held, (status as? CompensationStatus.Rejected)?.reason)
                    .map { it.javaClass }
                seen += listOfNotNull(((status as? CompensationStatus.Collecting)?.missing as? CollectingReason.Fit)?.problem).map { it.javaClass }
            }
        }
        val all = listOf(CompensationStatus::class, CollectingReason::class, HoldReason::class, RejectReason::class, FitProblem::class)
            .flatMap { kind -> kind.java.declaredClasses.filter { kind.java.isAssignableFrom(it) } }
        assertEquals(30, all.size)
        assertEquals(all.toSet(), seen, "every kind was asked")
        val events = JSONObject(repository.resolve("tests/vectors/facts.json").readText()).getJSONArray("events")
        val asked = (0 until events.length()).map(events::getJSONObject).map { case ->
            val kind = FieldEventKind.valueOf(case.getString("kind").replace(Regex("(?<=[a-z])(?=[A-Z])"), "_").uppercase(Locale.ROOT))
            assertEquals(case.getString("text"), FieldEvent(kind, case.getLong("since_ns"), case.getLong("decided_ns")).text(resources))
            kind
        }
        assertEquals(FieldEventKind.entries, asked)
        for (aid in HeadingAid.entries) assertEquals(aid.text(), aid.text(resources))
    }

    @Test
    fun `what the user can do, and what a screen reader says`() {
        val turn = "Turn the phone."
        val eight = "Turn the phone about all its axes, as if drawing an eight."
        val pickUp = "Pick the phone up and turn it."
        val expected = mapOf(
            CompensationStatus.Collecting(CollectingReason.Rotation) to turn,
            CompensationStatus.Held(HoldReason.TooLittleRotation) to turn,
            CompensationStatus.Collecting(CollectingReason.Directions) to eight,
            CompensationStatus.Collecting(CollectingReason.Fit(FitProblem.NotFinite)) to eight,
            CompensationStatus.Held(HoldReason.FitRefused(FitProblem.NotFinite)) to eight,
            CompensationStatus.Held(HoldReason.LowUniformity) to eight,
            CompensationStatus.Collecting(CollectingReason.Samples(1, 2)) to pickUp,
            CompensationStatus.Held(HoldReason.AtRest) to pickUp,
            CompensationStatus.Disturbed(1) to "Walk away from metal and magnets.",
        )
        for ((status, guidance) in expected) assertEquals(guidance, status.guidance(resources))
        for (status in statuses(Random(1)) - expected.keys) {
            val asks = status is CompensationStatus.Collecting || status is CompensationStatus.Disturbed ||
                (status as? CompensationStatus.Held)?.reason.let { it is HoldReason.FitRefused }
            if (!asks) assertNull(status.guidance(resources), "$status")
        }
        fun heading(deg: Double, sigmaDeg: Double?) = CompassHeading(deg, sigmaDeg, null, 60.0)
        assertEquals("no heading yet", null.spoken(resources))
        assertEquals("heading 0 degrees, give or take 3", heading(359.6, 2.1).spoken(resources))
        assertEquals("heading 90 degrees, give or take 180", heading(89.7, null).spoken(resources))
    }

    @Test
    fun `an error has one sentence for the user and another for the developer`() {
        val missing = SensorException.Missing("magnetometer", "hide the compass")
        assertEquals("This phone has no compass.", missing.text(resources))
        assertEquals("this phone has no magnetometer; hide the compass", missing.message)
        val others = listOf(MagcompException.Closed(), SensorException.NotTaken(3), RecordingException("a", 1, null, "b"), NativeLibraryException(Error()))
        for (error in others) assertEquals("The compass does not work now.", error.text(resources))
    }

    @Test
    fun `both platforms have the same texts, with the same placeholders`() {
        val line = Regex(""""(\w+)" = "(.*)";""")
        val swift = repository.resolve("ios/Sources/Magcomp/Resources/en.lproj/Localizable.strings").readLines()
            .mapNotNull(line::matchEntire).associate { "magcomp_" + it.groupValues[1] to it.groupValues[2] }
        // Apple's systems alone have those of `ios_`
        val shared = swift.filterKeys { !it.startsWith("magcomp_ios_") }
        // and Android alone those of `android_`
        val androids = repository.resolve("bindings/texts/en.txt").readLines().filter { it.startsWith("android_") }
            .map { "magcomp_" + it.removePrefix("android_").substringBefore(" = ") }
        assertTrue(englishStrings.keys.containsAll(androids), "$androids")
        assertEquals(englishStrings - androids.toSet(), shared.mapValues { (_, text) -> text.replace("\$@", "\$s").replace("\$lld", "\$d") })
        assertEquals(englishStrings.keys.toList(), stringNames.values.toList())
        assertTrue(englishStrings.size >= 30)
    }

    @Test
    fun `the other languages say all of it, with their own numbers`() {
        val poor = CompensationStatus.Collecting(CollectingReason.Fit(FitProblem.PoorCoverage(12.5, 10.0)))
        for ((language, turn, fit) in listOf(
            Triple(
                "de", "Das Telefon drehen.",
                "sammelt: der erwartete Richtungsfehler von 12,5 Grad ist größer als 10,0 Grad; das Gerät in mehr Richtungen drehen",
            ),
            Triple(
                "es", "Girar el teléfono.",
                "recogiendo: el error de dirección previsto de 12,5 grados supera 10,0 grados; girar el dispositivo en más direcciones",
            ),
        )) {
            val strings = strings("values-$language")
            assertEquals(englishStrings.keys, strings.keys)
            val theirs = resources(Locale.forLanguageTag(language), strings)
            assertEquals(turn, CompensationStatus.Held(HoldReason.TooLittleRotation).guidance(theirs))
            assertEquals(fit, poor.text(theirs))
            // a placeholder of another kind would throw
            for (status in statuses(Random(1))) assertTrue(status.text(theirs).isNotEmpty())
        }
    }

    private fun statuses(random: Random): List<CompensationStatus> {
        // never half way between two decimals
        fun real() = random.nextDouble(-3000.0, 3000.0)
        fun whole() = random.nextInt(0, 10_000)
        val axes = listOf(1, 2, 3).shuffled(random).map { if (random.nextBoolean()) it else -it }
        val problems = listOf(
            FitProblem.TooFewSamples(whole()), FitProblem.Planar(real()), FitProblem.PoorCoverage(real(), real()),
            FitProblem.Inconsistent(real(), real()), FitProblem.NotAnEllipsoid, FitProblem.FieldOutOfRange(real(), real(), real()),
            FitProblem.NotFinite,
        )
        val missing = problems.map { CollectingReason.Fit(it) } +
            listOf(CollectingReason.Samples(whole(), whole()), CollectingReason.Rotation, CollectingReason.Directions)
        val held = problems.map { HoldReason.FitRefused(it) } + HoldReason.LowUniformity + HoldReason.Constant + HoldReason.AtRest +
            HoldReason.TooLittleRotation + HoldReason.NoGyroscope
        val rejected = listOf(
            RejectReason.NotFinite, RejectReason.OutOfRange(real(), real()), RejectReason.Saturated(DeviceAxis.entries.random(random), real(), real()),
            RejectReason.TimeNotAfter(random.nextLong(), random.nextLong()), RejectReason.TimeJump(real(), 604_800.0),
            RejectReason.Stuck(whole()), axes.let { (x, y, z) -> RejectReason.Axes(x, y, z) },
        )
        return missing.map { CompensationStatus.Collecting(it) } + held.map { CompensationStatus.Held(it) } +
            listOf(CompensationStatus.Tracking, CompensationStatus.Suspect(1), CompensationStatus.Disturbed(1)) +
            rejected.map { CompensationStatus.Rejected(it) }
    }
}
