package org.magcomp.aar

import java.io.ByteArrayInputStream
import java.io.File
import java.net.URLClassLoader
import java.nio.ByteBuffer
import java.nio.ByteOrder
import java.util.zip.ZipFile
import java.util.zip.ZipInputStream
import javax.xml.parsers.DocumentBuilderFactory
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.w3c.dom.Element

/** Opens the AAR as an app's build would, and checks every part. */
class AarTest {
    private val aar = File(System.getProperty("aar"))
    private val release = System.getProperty("aar.release").toBoolean()
    private val parts = ZipFile(aar).use { zip ->
        zip.entries().asSequence().filter { !it.isDirectory }.associate { it.name to zip.getInputStream(it).readBytes() }
    }
    private val abis = System.getProperty("android.abis").split(" ")
    private val known = mapOf("arm64-v8a" to 183, "armeabi-v7a" to 40, "x86_64" to 62, "x86" to 3)
    private val machines = abis.associateWith(known::getValue)
    private val classes = ZipInputStream(ByteArrayInputStream(parts.getValue("classes.jar"))).use { zip ->
        generateSequence { zip.nextEntry }.map { it.name to zip.readBytes() }.toMap()
    }

    @Test
    fun `it has every part and no other`() {
        val expected = setOf(
            "AndroidManifest.xml",
            "classes.jar",
            "R.txt",
            "proguard.txt",
            "META-INF/com/android/build/gradle/aar-metadata.properties",
            "META-INF/LICENSE-MIT",
            "META-INF/LICENSE-APACHE",
            "META-INF/THIRD-PARTY-NOTICES",
            "res/values/strings.xml",
        ) + machines.keys.map { "jni/$it/libmagcomp_ffi.so" }
        assertEquals(expected.sorted(), parts.keys.filterNot { it.startsWith("res/values-") }.sorted())
        if (release) assertEquals(known.keys, machines.keys, "an AAR that ships serves every phone")
        for ((name, bytes) in parts) assertTrue(bytes.isNotEmpty(), name)
    }

    @Test
    fun `the manifest names package, minimum SDK, and what the artifact is for`() {
        val root = xml(parts.getValue("AndroidManifest.xml"))
        assertEquals("org.magcomp", root.getAttribute("package"))
        val sdk = root.getElementsByTagName("uses-sdk").item(0) as Element
        assertEquals(System.getProperty("min.sdk"), sdk.getAttribute("android:minSdkVersion"))
        val warns = "NOT FOR USE" in String(parts.getValue("AndroidManifest.xml"))
        assertEquals(!release, warns)
        assertEquals(!release, "structure-check" in aar.name)
    }

    @Test
    fun `the native libraries are what their folders say, with 16 KB pages`() {
        for ((abi, machine) in machines) {
            val elf = ByteBuffer.wrap(parts.getValue("jni/$abi/libmagcomp_ffi.so")).order(ByteOrder.LITTLE_ENDIAN)
            assertEquals(0x464c457f, elf.getInt(0), abi)
            val wide = elf.get(4).toInt() == 2
            assertEquals("64" in abi, wide, abi)
            assertEquals(machine, elf.getShort(18).toInt(), abi)
            val table = if (wide) elf.getLong(32).toInt() else elf.getInt(28)
            val size = elf.getShort(if (wide) 54 else 42).toInt()
            val count = elf.getShort(if (wide) 56 else 44).toInt()
            val headers = (0 until count).map { table + it * size }
            val loads = headers.filter { elf.getInt(it) == PT_LOAD }
            assertTrue(loads.isNotEmpty(), abi)
            for (at in loads) {
                val align = if (wide) elf.getLong(at + 48) else elf.getInt(at + 28).toLong()
                assertEquals(0L, align % 0x4000, "$abi: alignment $align")
            }
            // the NDK's own mark: stand-ins have none, a shipping library must
            val marked = "Android\u0000" in String(parts.getValue("jni/$abi/libmagcomp_ffi.so"), Charsets.ISO_8859_1)
            if (release) assertTrue(marked, "$abi is not linked by the NDK; run android/build-native.sh")
        }
    }

    @Test
    fun `the libraries export what the classes declare`() {
        val jar = File.createTempFile("classes", ".jar").apply { writeBytes(parts.getValue("classes.jar")) }
        val declared = URLClassLoader(arrayOf(jar.toURI().toURL()), javaClass.classLoader).use { loader ->
            Class.forName("org.magcomp.core.FastPath", false, loader).declaredMethods
                .filter { java.lang.reflect.Modifier.isNative(it.modifiers) }
                .map { "Java_org_magcomp_core_FastPath_" + it.name }
        }
        jar.delete()
        assertTrue(declared.size >= 5, "$declared")
        for (abi in machines.keys) {
            val text = String(parts.getValue("jni/$abi/libmagcomp_ffi.so"), Charsets.ISO_8859_1)
            for (name in declared) assertTrue("\u0000$name\u0000" in text, "$abi exports $name")
            assertTrue("TestHooks" !in text, "$abi holds test hooks")
        }
    }

    @Test
    fun `the classes are those of the library and the bindings, for every Android`() {
        val core = listOf("Compensator", "ConstantField", "NativeCompensator", "CompensationConfig").map { "core/$it" }
        for (name in listOf("Compass", "SensorManagerSource", "CompassReadingListener") + core) {
            assertTrue("org/magcomp/$name.class" in classes, name)
        }
        for ((name, bytes) in classes.filterKeys { it.endsWith(".class") }) {
            assertTrue(name.startsWith("org/magcomp/"), "$name belongs to a dependency")
            assertTrue(!name.startsWith("org/magcomp/R.") && !name.startsWith("org/magcomp/R$"), "$name is made by the app's build")
            assertEquals(52, ByteBuffer.wrap(bytes).getShort(6).toInt(), "$name: class file level of Java 8")
        }
    }

    @Test
    fun `the texts are there, and R names them`() {
        val strings = xml(parts.getValue("res/values/strings.xml")).getElementsByTagName("string")
        val names = (0 until strings.length).map { (strings.item(it) as Element).getAttribute("name") }
        assertTrue("magcomp_status_tracking" in names)
        assertEquals(names.map { "int string $it 0x0" }, String(parts.getValue("R.txt")).trim().lines())
    }

    @Test
    fun `the keep rules cover what is found by name`() {
        val rules = String(parts.getValue("proguard.txt"))
        val kept = Regex("""-keep class (org\.magcomp\.core\.\w+)""").findAll(rules).map { it.groupValues[1] }.toSet()
        assertTrue("-keep class com.sun.jna.** { *; }" in rules)
        assertTrue("-keepattributes RuntimeVisibleAnnotations" in rules, "Structure.FieldOrder")
        // every class with native methods, JNI's and those JNA registers
        val native = classes.filterKeys { it.endsWith(".class") }.keys.map { it.removeSuffix(".class").replace('/', '.') }.filter { name ->
            Class.forName(name, false, javaClass.classLoader).declaredMethods.any { java.lang.reflect.Modifier.isNative(it.modifiers) }
        }
        assertTrue(native.isNotEmpty())
        assertEquals(native.toSet(), kept)
    }

    @Test
    fun `the POM names the dependencies an app needs`() {
        val pom = xml(File(aar.path.removeSuffix(".aar") + ".pom").readBytes())
        fun text(of: Element, tag: String) = of.getElementsByTagName(tag).item(0)?.textContent
        assertEquals("aar", text(pom, "packaging"))
        assertEquals(aar.name.substringBeforeLast("-"), text(pom, "artifactId"))
        val dependencies = pom.getElementsByTagName("dependency").let { nodes -> (0 until nodes.length).map { nodes.item(it) as Element } }
        val byName = dependencies.associateBy { text(it, "artifactId") }
        assertEquals(setOf("kotlin-stdlib", "kotlinx-coroutines-android", "jna"), byName.keys)
        assertEquals("aar", text(byName.getValue("jna"), "type"), "the jar has no libraries for Android")
        for (dependency in dependencies) assertTrue(text(dependency, "version")!!.matches(Regex("""\d+\.\d+\.\d+""")))
        assertTrue('@' !in File(aar.path.removeSuffix(".aar") + ".pom").readText(), "every placeholder was filled")
    }

    @Test
    fun `the POM says what Central asks for`() {
        val pom = xml(File(aar.path.removeSuffix(".aar") + ".pom").readBytes())
        fun each(path: String): List<String> = path.split("/").fold(listOf(pom)) { nodes, tag ->
            nodes.flatMap { node ->
                node.childNodes.let { all -> (0 until all.length).map(all::item) }.filterIsInstance<Element>().filter { it.tagName == tag }
            }
        }.map { it.textContent.trim() }
        for (path in listOf("name", "description", "url", "licenses/license/name", "developers/developer/name", "scm/url", "scm/connection")) {
            assertTrue(each(path).isNotEmpty() && each(path).all { it.isNotEmpty() }, path)
        }
        assertEquals(each("licenses/license/name").size, each("licenses/license/url").size, "a licence without its text")
        for (url in each("url") + each("licenses/license/url") + each("scm/url")) assertTrue(url.startsWith("https://"), url)
        assertTrue(!release || "OWNER" !in each("url").single(), "where the project lives has to be said: Cargo.toml, repository")
    }

    @Test
    fun `the sources and their pages are there`() {
        fun names(classifier: String) = ZipFile(File(aar.path.removeSuffix(".aar") + "-$classifier.jar")).use { jar ->
            jar.entries().asSequence().map { it.name }.toList()
        }
        for (source in listOf("Compass.kt", "core/NativeLibrary.kt", "core/magcomp_ffi.kt")) assertTrue("org/magcomp/$source" in names("sources"), source)
        val pages = names("javadoc")
        assertTrue("index.html" in pages)
        // of the library, and of the bindings
        for (page in listOf("org.magcomp/-compass/", "org.magcomp.core/-magnetic-reading/", "org.magcomp.core/-magcomp-exception/")) {
            assertTrue(pages.any { it.endsWith("${page}index.html") }, page)
        }
    }

    private fun xml(bytes: ByteArray): Element =
        DocumentBuilderFactory.newInstance().newDocumentBuilder().parse(ByteArrayInputStream(bytes)).documentElement

    private companion object {
        const val PT_LOAD = 1
    }
}
