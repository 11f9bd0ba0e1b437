package org.magcomp

import android.content.res.Resources
import java.util.Locale
import javax.xml.parsers.DocumentBuilderFactory
import org.w3c.dom.Element
import sun.misc.Unsafe

/** The English string resources, read from their file. */
internal val englishStrings: Map<String, String> = run {
    val file = repository.resolve("android/library/src/main/res/values/strings.xml")
    val nodes = DocumentBuilderFactory.newInstance().newDocumentBuilder().parse(file).getElementsByTagName("string")
    (0 until nodes.length).map { nodes.item(it) as Element }.associate { it.getAttribute("name") to it.textContent.replace("\\'", "'") }
}

internal val stringNames = R.string::class.java.declaredFields.onEach { it.isAccessible = true }.associate { it.getInt(null) to it.name }

/** As much of a phone's resources as texts need; Android's own need the platform's native part. */
@Suppress("DEPRECATION") // its only constructor
private class English : Resources(null, null, null) {
    override fun getString(id: Int): String = englishStrings.getValue(stringNames.getValue(id))

    override fun getString(id: Int, vararg values: Any): String = String.format(Locale.ENGLISH, getString(id), *values)
}

/** Made without its constructor, which calls Android's native part. */
internal fun englishResources(): Resources {
    val unsafe = Unsafe::class.java.getDeclaredField("theUnsafe").apply { isAccessible = true }.get(null) as Unsafe
    return unsafe.allocateInstance(English::class.java) as Resources
}
