// made by bindings/generate.sh from bindings/status.toml and bindings/reading.toml
package org.magcomp.core

{% macro whole(field) %}
whole(slots, at + WHOLE{{ " + " ~ 2 * field.place if field.place }})
{%- endmacro %}
{% macro real(field) %}
slots[at + REAL{{ " + " ~ field.place if field.place }}]
{%- endmacro %}
{% macro read(field) %}
{% if field.kind == "count" %}{{ whole(field) }}.toInt(){% elif field.kind == "time" %}{{ whole(field) }}{% elif field.kind == "axis" %}DeviceAxis.entries[{{ whole(field) }}.toInt()]{% elif field.kind == "signed_axis" %}{{ real(field) }}.toInt(){% elif field.kind == "real" %}{{ real(field) }}{% elif field.kind == "FitProblem" %}fitProblem(slots, at){% else %}{{ by_name[field.kind].name|camel }}(slots, at, reason){% endif %}
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
    public val {{ field.name|camel }}: {{ field.kind|app }}{{ "?" if field.none }} get() = {{ field.name|camel }}(slots, 0)

{% else %}
{% for name, document in leaf.buffer|items %}
    /** {{ document }} */
    public val {{ name }}: {{ "Int" if leaf.kind == "count" else "Double" }} get() = slots[{{ leaf.slot }}{{ " + " ~ loop.index0 if loop.index0 }}]{{ ".toInt()" if leaf.kind == "count" }}

{% endfor %}
{% endif %}
{% endfor %}
{% endfor %}
    /** The latest change that was decided. Allocates when it is another one than before. */
    public val event: FieldEvent? get() = event(slots, 0, latestEvent).also { latestEvent = it }
    private var latestEvent: FieldEvent? = null

    /** What the compensator is doing, and why. Allocates for a status that carries data. */
    public val status: CompensationStatus get() = status(slots)

    /** The same as an immutable record. */
    public fun toReading(): MagneticReading = reading(slots, 0, timeNs, event, status)

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

        /** The numbers of a reading but for event and status. */
        const val NUMBERS = {{ n }}

{% for field in reading.fields if field.parts %}
        fun {{ field.name|camel }}(slots: DoubleArray, at: Int = 0): {{ field.kind|app }}? = known(slots[at + {{ field.leaves[0].slot }}])?.let {
            {{ field.kind|app }}(
{% for leaf in field.leaves %}
                {{ leaf.name|camel }} = {% if loop.first %}it{% elif leaf.none %}known(slots[at + {{ leaf.slot }}]){% else %}slots[at + {{ leaf.slot }}]{% endif %},
{% endfor %}
            )
        }

{% endfor %}
        fun reading(slots: DoubleArray, at: Int, timeNs: Long): MagneticReading = reading(slots, at, timeNs, event(slots, at), status(slots, at))

        /** Of [slots] the [NUMBERS] alone are read. */
        fun reading(slots: DoubleArray, at: Int, timeNs: Long, event: FieldEvent?, status: CompensationStatus): MagneticReading = MagneticReading(
            timeNs = timeNs,
{% for field in reading.fields %}
{% set first = field.leaves[0] %}
{% set number = "slots[at + " ~ first.slot ~ "]" %}
            {{ field.name|camel }} = {% if field.kind == "vector" %}vectorOrNull(slots, at + {{ first.slot }}){% elif field.kind == "real" %}known({{ number }}){% elif field.kind == "count" %}{{ number }}.toInt(){% elif field.kind == "share" %}{{ number }}{% else %}{{ field.name|camel }}(slots, at){% endif %},
{% endfor %}
            event = event,
            status = status,
        )

        fun status(slots: DoubleArray, at: Int = 0): CompensationStatus {
            val reason = slots[at + REASON].toInt()
            return when (val kind = slots[at + STATUS].toInt()) {
{% for case in by_name.Status.cases %}
                {{ case.code }} -> {{ made(by_name.Status, case) }}
{% endfor %}
                else -> error("status $kind: the library's native part is of another version")
            }
        }

{% for field in reading.fields if field.is_enum %}
        private fun {{ field.name|camel }}(slots: DoubleArray, at: Int): {{ field.kind|app }}{{ "?" if field.none }} = {{ field.kind|app }}.entries{% if field.none %}.getOrNull(slots[at + {{ field.leaves[0].slot }}].toInt()){% else %}[slots[at + {{ field.leaves[0].slot }}].toInt()]{% endif %}


{% endfor %}
        /** [before] where it is the same. */
        private fun event(slots: DoubleArray, at: Int, before: FieldEvent? = null): FieldEvent? {
            val kind = FieldEventKind.entries.getOrNull(slots[at + EVENT].toInt()) ?: return null
            val sinceNs = whole(slots, at + EVENT_TIMES)
            val decidedNs = whole(slots, at + EVENT_TIMES + 2)
            if (before != null && before.kind == kind && before.sinceNs == sinceNs && before.decidedNs == decidedNs) return before
            return FieldEvent(kind, sinceNs = sinceNs, decidedNs = decidedNs)
        }

{% for one in [by_name.Missing, by_name.HoldReason, by_name.RejectReason] %}
        private fun {{ one.name|camel }}(slots: DoubleArray, at: Int, reason: Int): {{ one.name|app }} =
            when (reason) {
{% for case in one.cases %}
                {{ case.code }} -> {{ made(one, case) }}
{% endfor %}
                else -> error("{{ one.name|snake|replace("_", " ") }} $reason: the library's native part is of another version")
            }

{% endfor %}
        private fun fitProblem(slots: DoubleArray, at: Int): FitProblem =
            when (val problem = slots[at + FIT_PROBLEM].toInt()) {
{% for case in by_name.FitProblem.cases %}
                {{ case.code }} -> {{ made(by_name.FitProblem, case) }}
{% endfor %}
                else -> error("fit problem $problem: the library's native part is of another version")
            }

        fun known(value: Double): Double? = if (value.isNaN()) null else value

        private fun vectorOrNull(slots: DoubleArray, at: Int): DeviceVector? = if (slots[at].isNaN()) null else vector(slots, at)

        fun vector(slots: DoubleArray, at: Int) = DeviceVector(slots[at], slots[at + 1], slots[at + 2])

        /** A whole number from its upper and lower 32 bits. */
        private fun whole(slots: DoubleArray, at: Int): Long = (slots[at].toLong() shl 32) or slots[at + 1].toLong()
    }
}
