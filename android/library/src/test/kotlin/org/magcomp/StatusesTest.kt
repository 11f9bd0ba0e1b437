package org.magcomp

import java.util.Locale
import kotlin.random.Random
import org.json.JSONArray
import org.json.JSONObject
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import org.magcomp.core.*

/** Every status, reason, event and heading aid against `tests/vectors/statuses.json`, where they stand by hand for all languages. */
class StatusesTest {
    private val known = JSONObject(repository.resolve("tests/vectors/statuses.json").readText())
    private val languages = mapOf("en" to "values", "de" to "values-de", "es" to "values-es")
        .mapValues { (language, folder) -> resources(Locale.forLanguageTag(language), strings(folder)) }

    @Test
    fun `a status is read from JNI, and said in every language`() {
        for (case in list("statuses")) {
            val status = read(case)
            assertEquals(case.getString("status").replace(": ", "="), snake(status.toString().replace(Regex("(missing|reason|problem)="), "")))
            assertEquals(listOf("label", "en").map(case::getString), listOf(status.label(), status.text()))
            for ((language, resources) in languages) assertEquals(case.getString(language), status.text(resources))
            assertEquals(case.opt("guidance"), status.guidance(languages.getValue("en")))
        }
        val kinds = listOf(CompensationStatus::class, CollectingReason::class, HoldReason::class, RejectReason::class, FitProblem::class)
        val all = kinds.flatMap { kind -> kind.java.declaredClasses.filter(kind.java::isAssignableFrom) }
        assertEquals(all.toSet(), list("statuses").flatMap { parts(read(it)) }.map { it.javaClass }.toSet())
    }

    @Test
    fun `the English texts have the core's own numbers, whatever they are`() {
        val random = Random(1)
        repeat(200) {
            for (case in list("statuses")) {
                // never half way between two decimals
                val status = read(case, { random.nextLong(0, 10_000) }) { random.nextDouble(-3000.0, 3000.0) }
                assertEquals(status.text(), status.text(languages.getValue("en")))
            }
        }
    }

    @Test
    fun `an event and a heading aid are said in every language`() {
        for ((case, kind) in list("events").zip(FieldEventKind.entries)) {
            assertEquals(case.getString("kind").lowercase(), kind.name.replace("_", "").lowercase())
            assertEquals(case.getInt("border"), kind.ordinal)
            val event = FieldEvent(kind, case.getLong("since_ns"), case.getLong("decided_ns"))
            for ((language, resources) in languages) assertEquals(case.getString(language), event.text(resources))
        }
        for ((case, aid) in list("heading_aids").zip(HeadingAid.entries)) {
            assertEquals(listOf(case.getString("name").uppercase(), case.getString("en")), listOf(aid.name, aid.text()))
            for ((language, resources) in languages) assertEquals(case.getString(language), aid.text(resources))
        }
        assertEquals(listOf(FieldEventKind.entries.size, HeadingAid.entries.size), listOf("events", "heading_aids").map { list(it).size })
    }

    private fun list(key: String): List<JSONObject> = known.getJSONArray(key).let { list -> List(list.length(), list::getJSONObject) }

    /** As the border writes it, with other numbers where there are any; axes stay. */
    private fun read(case: JSONObject, whole: (Long) -> Long = { it }, real: (Double) -> Double = { it }): CompensationStatus {
        fun array(key: String) = case.optJSONArray(key) ?: JSONArray()
        val buffer = ReadingBuffer()
        val slots = buffer.slots
        val hasAxis = Regex("\\b(axis|x): ") in case.getString("status")
        for ((k, at) in listOf(ReadingBuffer.STATUS, ReadingBuffer.REASON, ReadingBuffer.FIT_PROBLEM).withIndex()) slots[at] = array("border").getDouble(k)
        for (k in 0 until array("whole").length()) {
            val number = array("whole").getLong(k).let { if (hasAxis) it else whole(it) }
            slots[ReadingBuffer.WHOLE + 2 * k] = (number shr 32).toDouble()
            slots[ReadingBuffer.WHOLE + 2 * k + 1] = (number and 0xffff_ffff).toDouble()
        }
        for (k in 0 until array("real").length()) slots[ReadingBuffer.REAL + k] = array("real").getDouble(k).let { if (hasAxis) it else real(it) }
        return buffer.status
    }

    private fun snake(text: String) = text.replace(Regex("(?<=[a-z])([A-Z])(?=\\w*=)")) { "_" + it.value.lowercase() }

    /** The status and the reasons in it. */
    private fun parts(of: Any): List<Any> =
        listOf(of) + of.javaClass.methods.filter { it.name in listOf("getMissing", "getReason", "getProblem") }.flatMap { parts(it(of)) }
}
