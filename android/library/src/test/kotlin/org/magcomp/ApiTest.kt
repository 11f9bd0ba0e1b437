package org.magcomp

import java.io.File
import kotlinx.validation.api.dump
import kotlinx.validation.api.filterOutNonPublic
import kotlinx.validation.api.loadApiFromJvmClasses
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test

class ApiTest {
    /** What uniffi makes public for itself; an app has no use for it. */
    private val machinery = Regex("(FfiConverter|RustBuffer|Uniffi|Native(Comp|Const)|Disposable|InternalException|NoHandle).*")

    @Test
    fun `the API is the one that was agreed on`() {
        val places = listOf(Compass::class, Reading::class).map { File(it.java.protectionDomain.codeSource.location.toURI()) }
        val classes = places.flatMap { place -> place.walk().filter { it.extension == "class" && !machinery.matches(it.name) }.sorted() }
        val found = classes.asSequence().map { it.inputStream() }.loadApiFromJvmClasses().filterOutNonPublic().dump(StringBuilder()).toString()
        assertTrue("public final class org/magcomp/Compass " in found, "the classes are folders: run it from Maven's reactor")
        val agreed = repository.resolve("android/library/api/library.api")
        if (found == agreed.readText()) return
        val now = repository.resolve("android/library/target/library.api").apply { writeText(found) }
        assertEquals(agreed.readText(), found, "if the change is meant, copy $now to $agreed")
    }
}
