// made by bindings/generate.sh from bindings/status.toml
@file:JvmName("Texts")
@file:JvmMultifileClass

package org.magcomp

import android.content.res.Resources
import kotlin.math.abs
import org.magcomp.core.*

{% macro value(field) %}
{% if field.kind == "axis" %}{{ field.name|camel }}.name.lowercase(){% elif field.kind == "axes" %}listOf(x, y, z).joinToString(",", transform = ::typed){% elif field.kind == "took_s" %}(decidedNs.toDouble() - sinceNs.toDouble()) * 1e-9{% elif field.kind in by_name %}{{ field.name|camel }}.text(resources){% else %}{{ field.name|camel }}{% endif %}
{%- endmacro %}
{% macro is_case(one, case) %}
{{ "is " if case.fields }}{{ one.name|app }}.{{ case.name }}
{%- endmacro %}
{% for one in enums if one.texts and one.cases|selectattr("fields")|list or one.name in ["Missing", "HoldReason"] %}
{% if one.name == "Status" %}
/**
 * One sentence that an app may show, in the language of [resources]. An app translates or rewords it with a string resource of the same
 * name. In English it is the sentence of `text()`, without a call into the native library.
 */
public{% else %}internal{% endif %} fun {{ one.name|app }}.text(resources: Resources): String = when (this) {
{% for case in one.cases %}
    {{ is_case(one, case) }} -> {% if case.key %}resources.getString(R.string.magcomp_{{ case.key }}{% for field in case.told %}, {{ value(field) }}{% endfor %}){% else %}{{ case.nested.name|camel }}.text(resources){% endif %}

{% endfor %}
}

{% endfor %}
/** An axis as one types it: `-x`. What is none is the nearest, as in the core's own text. */
private fun typed(axis: Int): String = (if (axis < 0) "-" else "") + "xyz"[abs(axis).coerceIn(1, 3) - 1]

/** One sentence an app may show of a change that was decided, in the language of [resources]. */
public fun FieldEvent.text(resources: Resources): String {
    val id = when (kind) {
{% for case in by_name.EventKind.cases %}
        {{ by_name.EventKind.name|app }}.{{ case.name|snake|upper }} -> R.string.magcomp_{{ case.key }}
{% endfor %}
    }
    return resources.getString(id, (decidedNs.toDouble() - sinceNs.toDouble()) * 1e-9)
}

/** One sentence an app may show of what headings from outside are worth, in the language of [resources]. */
public fun HeadingAid.text(resources: Resources): String = resources.getString(
    when (this) {
{% for case in by_name.HeadingAid.cases %}
        HeadingAid.{{ case.name|snake|upper }} -> R.string.magcomp_{{ case.key }}
{% endfor %}
    },
)

/** What the user can do for a better heading, in the language of [resources]; null if there is nothing to do. */
public fun {{ by_name.Status.name|app }}.guidance(resources: Resources): String? = when (this) {
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
}?.let(resources::getString)
