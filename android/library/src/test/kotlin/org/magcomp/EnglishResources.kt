package org.magcomp

import android.content.res.Resources
import java.util.Locale
import javax.xml.parsers.DocumentBuilderFactory
import org.w3c.dom.Element
import sun.misc.Unsafe

/** The English string resources. */
internal val englishStrings: Map<String, String> = strings("values")

/** The string resources of a folder, read from their file. */
internal fun strings(folder: String): Map<String, String> {
    val file = repository.resolve("android/library/src/main/res/$folder/strings.xml")
    val nodes = DocumentBuilderFactory.newInstance().newDocumentBuilder().parse(file).getElementsByTagName("string")
    return (0 until nodes.length).map { nodes.item(it) as Element }.associate { it.getAttribute("name") to it.textContent.replace("\\'", "'") }
}

internal val stringNames = R.string::class.java.declaredFields.onEach { it.isAccessible = true }.associate { it.getInt(null) to it.name }

/** As much of a phone's resources as texts need; Android's own need the platform's native part. */
@Suppress("DEPRECATION") // its only constructor
private class FileResources : Resources(null, null, null) {
    lateinit var locale: Locale
    lateinit var strings: Map<String, String>

    override fun getString(id: Int): String = strings.getValue(stringNames.getValue(id))

    override fun getString(id: Int, vararg values: Any): String = String.format(locale, getString(id), *values)
}

/** Made without its constructor, which calls Android's native part. */
internal fun resources(locale: Locale, strings: Map<String, String>): Resources {
    val unsafe = Unsafe::class.java.getDeclaredField("theUnsafe").apply { isAccessible = true }.get(null) as Unsafe
    val made = unsafe.allocateInstance(FileResources::class.java) as FileResources
    return made.apply { this.locale = locale }.apply { this.strings = strings }
}

internal fun englishResources(): Resources = resources(Locale.ENGLISH, englishStrings)
