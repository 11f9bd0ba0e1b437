// made by bindings/generate.sh from bindings/status.toml
package org.magcomp

import kotlin.math.abs
import org.magcomp.core.*

{% macro value(field) %}
{% if field.kind == "axis" %}{{ field.name|camel }}.name.lowercase(){% elif field.kind == "axes" %}listOf(x, y, z).joinToString(",", transform = ::typed){% elif field.kind == "took_s" %}(decidedNs.toDouble() - sinceNs.toDouble()) * 1e-9{% elif field.kind in by_name %}{{ field.name|camel }}.text(strings){% else %}{{ field.name|camel }}{% endif %}
{%- endmacro %}
{% macro is_case(one, case) %}
{{ "is " if case.fields }}{{ one.name|app }}.{{ case.name }}
{%- endmacro %}
{% for one in enums if one.texts and one.cases|selectattr("fields")|list or one.name in ["Missing", "HoldReason"] %}
internal fun {{ one.name|app }}.text(strings: Strings): String = when (this) {
{% for case in one.cases %}
    {{ is_case(one, case) }} -> {% if case.key %}strings.say(R.string.magcomp_{{ case.key }}{% for field in case.told %}, {{ value(field) }}{% endfor %}){% else %}{{ case.nested.name|camel }}.text(strings){% endif %}

{% endfor %}
}

{% endfor %}
/** An axis as one types it: `-x`. What is none is the nearest, as in the core's own text. */
private fun typed(axis: Int): String = (if (axis < 0) "-" else "") + "xyz"[abs(axis).coerceIn(1, 3) - 1]

internal fun FieldEvent.text(strings: Strings): String {
    val id = when (kind) {
{% for case in by_name.EventKind.cases %}
        {{ by_name.EventKind.name|app }}.{{ case.name|snake|upper }} -> R.string.magcomp_{{ case.key }}
{% endfor %}
    }
    return strings.say(id, (decidedNs.toDouble() - sinceNs.toDouble()) * 1e-9)
}

internal fun HeadingAid.text(strings: Strings): String = strings.say(
    when (this) {
{% for case in by_name.HeadingAid.cases %}
        HeadingAid.{{ case.name|snake|upper }} -> R.string.magcomp_{{ case.key }}
{% endfor %}
    },
)

internal fun {{ by_name.Status.name|app }}.guidance(): Int? = when (this) {
{% for status in by_name.Status.cases %}
{% if status.nested and by_name[status.nested.kind].cases|selectattr("guidance")|list %}
    {{ is_case(by_name.Status, status) }} -> when ({{ status.nested.name|camel }}) {
{% for case in by_name[status.nested.kind].cases %}
        {{ is_case(by_name[status.nested.kind], case) }} -> {{ "R.string.magcomp_" ~ case.guidance if case.guidance else "null" }}
{% endfor %}
    }
{% else %}
    {{ is_case(by_name.Status, status) }} -> {{ "R.string.magcomp_" ~ status.guidance if status.guidance else "null" }}
{% endif %}
{% endfor %}
}
