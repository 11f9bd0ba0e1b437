package org.magcomp

import java.io.File
import java.util.zip.ZipFile
import kotlinx.validation.api.dump
import kotlinx.validation.api.filterOutNonPublic
import kotlinx.validation.api.loadApiFromJvmClasses
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.core.*

class ApiTest {
    @Test
    fun `the API is the one that was agreed on`() {
        val places = listOf(Compass::class, MagneticReading::class).map { File(it.java.protectionDomain.codeSource.location.toURI()) }
        val classes = places.flatMap(::classes)
        val found = classes.asSequence().map { it.inputStream() }
            .loadApiFromJvmClasses().filterOutNonPublic().dump(StringBuilder()).toString()
        assertTrue("public final class org/magcomp/Compass " in found)
        val agreed = repository.resolve("android/library/api/library.api")
        if (found == agreed.readText()) return
        val now = repository.resolve("android/library/target/library.api").apply { writeText(found) }
        assertEquals(agreed.readText(), found, "if the change is meant, copy $now to $agreed")
    }

    /** A compiler reads classes up to one minor version newer than itself: android/README.md promises Kotlin 2.1. */
    @Test
    fun `an app's Kotlin 2_1 reads the classes`() {
        for (type in listOf(Compass::class, MagneticReading::class)) {
            assertEquals(listOf(2, 2), type.java.getAnnotation(Metadata::class.java).metadataVersion.take(2))
        }
    }

    /** A folder's or a jar's, which of the two Maven's goal decides. */
    private fun classes(place: File): List<ByteArray> {
        if (place.isDirectory) return place.walk().filter { it.extension == "class" }.map { it.readBytes() }.toList()
        return ZipFile(place).use { jar ->
            jar.entries().asSequence().filter { it.name.endsWith(".class") }
                .map { jar.getInputStream(it).readBytes() }.toList()
        }
    }
}
