// made by bindings/generate.sh from bindings/status.toml and bindings/reading.toml
package org.magcomp.core

{% macro whole(field) %}
whole(WHOLE{{ " + " ~ 2 * field.place if field.place }})
{%- endmacro %}
{% macro real(field) %}
slots[REAL{{ " + " ~ field.place if field.place }}]
{%- endmacro %}
{% macro read(field) %}
{% if field.kind == "count" %}{{ whole(field) }}.toInt(){% elif field.kind == "time" %}{{ whole(field) }}{% elif field.kind == "axis" %}DeviceAxis.entries[{{ whole(field) }}.toInt()]{% elif field.kind == "signed_axis" %}{{ real(field) }}.toInt(){% elif field.kind == "real" %}{{ real(field) }}{% elif field.kind == "FitProblem" %}fitProblem(){% else %}{{ by_name[field.kind].name|camel }}(){% endif %}
{%- endmacro %}
{% macro made(one, case) %}
{{ one.name|app }}.{{ case.name }}{% if case.fields %}({% for field in case.fields %}{{ read(field) }}{{ ", " if not loop.last }}{% endfor %}){% endif %}
{%- endmacro %}
/**
 * A reading that is filled again and again, so that a stream of sensor events allocates nothing.
 *
 * A value that is not known is NaN here; [toReading] makes an immutable [MagneticReading] of it, where such a value is null. A buffer is
 * not thread-safe: give every thread its own.
 */
public class ReadingBuffer {
    internal val slots: DoubleArray = DoubleArray(FastPath.slots)

    /** Time of the sample, nanoseconds. */
    public var timeNs: Long = 0
        internal set

{% for field in reading.fields %}
{% for leaf in field.leaves %}
{% if field.is_enum %}
    /** {{ field.meaning }}{{ " Null " ~ field.none ~ "." if field.none }} */
    public val {{ field.name|camel }}: {{ field.kind|app }}{{ "?" if field.none }} get() = {{ field.kind|app }}.entries{% if field.none %}.getOrNull(slots[{{ leaf.slot }}].toInt()){% else %}[slots[{{ leaf.slot }}].toInt()]{% endif %}


{% else %}
{% for name, document in leaf.buffer|items %}
    /** {{ document }} */
    public val {{ name }}: {{ "Int" if leaf.kind == "count" else "Double" }} get() = slots[{{ leaf.slot }}{{ " + " ~ loop.index0 if loop.index0 }}]{{ ".toInt()" if leaf.kind == "count" }}

{% endfor %}
{% endif %}
{% endfor %}
{% endfor %}
    /** The latest change that was decided. Allocates when it is another one than before. */
    public val event: FieldEvent?
        get() {
            val kind = FieldEventKind.entries.getOrNull(slots[EVENT].toInt())
            val sinceNs = whole(EVENT_TIMES)
            val decidedNs = whole(EVENT_TIMES + 2)
            val isSame = latestEvent.let { it != null && it.kind == kind && it.sinceNs == sinceNs && it.decidedNs == decidedNs }
            if (!isSame) latestEvent = kind?.let { FieldEvent(it, sinceNs = sinceNs, decidedNs = decidedNs) }
            return latestEvent
        }
    private var latestEvent: FieldEvent? = null

    /** What the compensator is doing, and why. Allocates for a status that carries data. */
    public val status: CompensationStatus
        get() = when (val kind = slots[STATUS].toInt()) {
{% for case in by_name.Status.cases %}
            {{ case.code }} -> {{ made(by_name.Status, case) }}
{% endfor %}
            else -> error("status $kind: the library's native part is of another version")
        }

    /** The same as an immutable record. */
    public fun toReading(): MagneticReading = reading(timeNs, event, status)

    /** The numbers with another time, event and status. */
    internal fun reading(timeNs: Long, event: FieldEvent?, status: CompensationStatus): MagneticReading = MagneticReading(
        timeNs = timeNs,
{% for field in reading.fields %}
{% set first = field.leaves[0] %}
{% set number = "slots[" ~ first.slot ~ "]" %}
        {{ field.name|camel }} = {% if field.kind == "vector" %}vector({{ first.slot }}){% elif field.kind == "real" %}known({{ number }}){% elif field.kind == "count" %}{{ number }}.toInt(){% elif field.kind == "share" %}{{ number }}{% else %}{{ field.name|camel }}{{ "()" if field.parts }}{% endif %},
{% endfor %}
        event = event,
        status = status,
    )

{% for field in reading.fields if field.parts %}
    private fun {{ field.name|camel }}(): {{ field.kind|app }}? = known(slots[{{ field.leaves[0].slot }}])?.let {
        {{ field.kind|app }}(
{% for leaf in field.leaves %}
            {{ leaf.name|camel }} = {% if loop.first %}it{% elif leaf.none %}known(slots[{{ leaf.slot }}]){% else %}slots[{{ leaf.slot }}]{% endif %},
{% endfor %}
        )
    }

{% endfor %}
{% for one in [by_name.Missing, by_name.HoldReason, by_name.RejectReason] %}
    private fun {{ one.name|camel }}(): {{ one.name|app }} =
        when (val reason = slots[REASON].toInt()) {
{% for case in one.cases %}
            {{ case.code }} -> {{ made(one, case) }}
{% endfor %}
            else -> error("{{ one.name|snake|replace("_", " ") }} $reason: the library's native part is of another version")
        }

{% endfor %}
    private fun fitProblem(): FitProblem =
        when (val problem = slots[FIT_PROBLEM].toInt()) {
{% for case in by_name.FitProblem.cases %}
            {{ case.code }} -> {{ made(by_name.FitProblem, case) }}
{% endfor %}
            else -> error("fit problem $problem: the library's native part is of another version")
        }

    private fun vector(at: Int): DeviceVector? = if (slots[at].isNaN()) null else DeviceVector(slots[at], slots[at + 1], slots[at + 2])

    /** A whole number from its upper and lower 32 bits. */
    private fun whole(at: Int): Long = (slots[at].toLong() shl 32) or slots[at + 1].toLong()

    internal companion object {
{% for leaf in reading.leaves if "+" not in leaf.slot %}
        const val {{ leaf.slot }} = {{ leaf.at }}
{% endfor %}
{% set n = reading.numbers %}
        const val EVENT = {{ n }}
        const val EVENT_TIMES = {{ n + 1 }}
        const val STATUS = {{ n + 5 }}
        const val REASON = {{ n + 6 }}
        const val FIT_PROBLEM = {{ n + 7 }}
        const val REAL = {{ n + 8 }}
        const val WHOLE = {{ n + 11 }}
        const val POINTING = {{ n + 15 }}

        fun known(value: Double): Double? = if (value.isNaN()) null else value
    }
}
