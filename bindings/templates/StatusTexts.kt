// made by bindings/generate.sh from bindings/status.toml
package org.magcomp

import kotlin.math.abs
import org.magcomp.core.*

{% macro value(field) %}
{% if field.kind == "axis" %}{{ field.camel }}.name.lowercase(){% elif field.kind == "axes" %}listOf(x, y, z).joinToString(",", transform = ::typed){% elif field.kind == "took" %}(decidedNs.toDouble() - sinceNs.toDouble()) * 1e-9{% elif field.kind in by_name %}{{ field.camel }}.text(strings){% else %}{{ field.camel }}{% endif %}
{%- endmacro %}
{% macro is_case(one, case) %}
{{ "is " if case.fields }}{{ one.app }}.{{ case.name }}
{%- endmacro %}
{% for one in enums if one.has_texts and one.has_fields or one.name in ["Missing", "HoldReason"] %}
internal fun {{ one.app }}.text(strings: Strings): String = when (this) {
{% for case in one.cases %}
    {{ is_case(one, case) }} -> {% if case.text %}strings.say(R.string.magcomp_{{ case.text }}{% for field in case.told %}, {{ value(field) }}{% endfor %}){% else %}{{ case.nested.camel }}.text(strings){% endif %}

{% endfor %}
}

{% endfor %}
/** An axis as one types it: `-x`. What is none is the nearest, as in the core's own text. */
private fun typed(axis: Int): String = (if (axis < 0) "-" else "") + "xyz"[abs(axis).coerceIn(1, 3) - 1]

internal fun FieldEvent.text(strings: Strings): String {
    val id = when (kind) {
{% for case in by_name.EventKind.cases %}
        {{ by_name.EventKind.app }}.{{ case.screaming }} -> R.string.magcomp_{{ case.text }}
{% endfor %}
    }
    return strings.say(id, (decidedNs.toDouble() - sinceNs.toDouble()) * 1e-9)
}

internal fun HeadingAid.text(strings: Strings): String = strings.say(
    when (this) {
{% for case in by_name.HeadingAid.cases %}
        HeadingAid.{{ case.screaming }} -> R.string.magcomp_{{ case.text }}
{% endfor %}
    },
)

internal fun {{ by_name.Status.app }}.guidance(): Int? = when (this) {
{% for status in by_name.Status.cases %}
{% if status.nested and by_name[status.nested.kind].cases|selectattr("guidance")|list %}
    {{ is_case(by_name.Status, status) }} -> when ({{ status.nested.camel }}) {
{% for case in by_name[status.nested.kind].cases %}
        {{ is_case(by_name[status.nested.kind], case) }} -> {{ "R.string.magcomp_" ~ case.guidance if case.guidance else "null" }}
{% endfor %}
    }
{% else %}
    {{ is_case(by_name.Status, status) }} -> {{ "R.string.magcomp_" ~ status.guidance if status.guidance else "null" }}
{% endif %}
{% endfor %}
}
