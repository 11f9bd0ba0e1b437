package org.magcomp.core

import com.sun.jna.Native
import java.io.File
import java.io.IOException
import org.magcomp.NativeLibraryException

/**
 * The native library, loaded once: over JNI for `FastPath`, and over JNA for the generated code, each of whose calls asks here first
 * (`bindings/uniffi.pl`). So both reach one copy of it, whatever an app calls first.
 */
internal object NativeLibrary {
    private const val NAME = "magcomp_ffi"
    private val failure: LinkageError? = load()

    /** @throws NativeLibraryException when it can't be loaded */
    fun check() {
        failure?.let { throw NativeLibraryException(it) }
    }

    private fun load(): LinkageError? =
        try {
            try {
                System.loadLibrary(NAME)
            } catch (e: UnsatisfiedLinkError) {
                loadFromJar(e)
            }
            // the generated code binds its functions, and compares versions
            uniffiEnsureInitialized()
            null
        } catch (e: LinkageError) {
            e
        }

    /** From magcomp-host.jar, in the unit tests of an app. */
    private fun loadFromJar(otherwise: UnsatisfiedLinkError) {
        val file = try {
            // a copy for this class loader alone: where classes lie in a folder, JNA answers the file itself, which the JVM loads once
            File.createTempFile(NAME, ".so").apply { deleteOnExit() }.also {
                Native.extractFromResourcePath(NAME, NativeLibrary::class.java.classLoader).copyTo(it, overwrite = true)
            }
        } catch (_: IOException) {
            throw otherwise
        }
        System.load(file.path)
        // JNA would extract another, which would not know the objects of this one
        System.setProperty("uniffi.component.$NAME.libraryOverride", file.path)
    }
}

/** What an error says in a sentence; without the native library its fields. The generated code asks here (`bindings/uniffi.pl`). */
internal fun MagcompException.sentence(otherwise: String): String = try {
    text()
} catch (_: RuntimeException) {
    otherwise
}
