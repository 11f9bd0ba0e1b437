package org.magcomp

import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.core.*

class TextsTest {
    private val resources = englishResources()

    @Test
    fun `what a screen reader says`() {
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
    fun `both platforms have the same texts, with the same placeholders, in every language`() {
        val line = Regex(""""(\w+)" = "(.*)";""")
        // Android alone has those of `android_`
        val androids = repository.resolve("bindings/texts.toml").readLines().filter { it.startsWith("[android_") }
            .map { "magcomp_" + it.removeSurrounding("[android_", "]") }.toSet()
        assertTrue(englishStrings.keys.containsAll(androids), "$androids")
        for ((language, folder) in mapOf("en" to "values", "de" to "values-de", "es" to "values-es")) {
            // and Apple's systems alone those of `ios_`
            val swift = repository.resolve("ios/Sources/Magcomp/Resources/$language.lproj/Localizable.strings").readLines()
                .mapNotNull(line::matchEntire).map { it.destructured }.filterNot { (name) -> name.startsWith("ios_") }
                .associate { (name, text) -> "magcomp_$name" to text.replace("\$@", "\$s").replace("\$lld", "\$d") }
            assertEquals(strings(folder) - androids, swift)
            assertEquals(stringNames.values.toList(), strings(folder).keys.toList())
        }
        assertTrue(englishStrings.size >= 30)
    }
}
