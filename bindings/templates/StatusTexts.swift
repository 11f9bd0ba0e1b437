// swift-format-ignore-file
// made by bindings/generate.sh from bindings/status.toml

import Foundation

{% macro value(field) %}
{% if field.kind == "axis" %}{{ field.name|camel }}.name{% elif field.kind == "axes" %}[x, y, z].map(typed).joined(separator: ","){% elif field.kind == "took_s" %}tookS{% elif field.kind == "count" %}Int64({{ field.name|camel }}){% elif field.kind in by_name %}{{ field.name|camel }}.localizedText{% else %}{{ field.name|camel }}{% endif %}
{%- endmacro %}
{% macro bound(case, names) %}
.{{ case.name|camel }}{% if case.fields and (case.told or not case.key) %}({% for field in case.fields %}let {{ field.name|camel }}{{ ", " if not loop.last }}{% endfor %}){% endif %}
{%- endmacro %}
{% for one in enums if one.texts and one.name != "EventKind" %}
extension {{ one.name|swift }} {
{% if one.name in ["Status", "HeadingAid"] %}
    /// One sentence an app may show{% if one.name == "HeadingAid" %} of what headings from outside are worth{% endif %}, in the app's language where the package has it, else in English.
    public var localizedText: String {
{% else %}
    fileprivate var localizedText: String {
{% endif %}
        switch self {
{% for case in one.cases %}
        case {{ bound(case) }}: {% if case.key %}say("{{ case.key }}"{% for field in case.told %}, {{ value(field) }}{% endfor %}){% else %}{{ case.nested.name|camel }}.localizedText{% endif %}

{% endfor %}
        }
    }
}

{% endfor %}
/// An axis as one types it: `-x`. What is none is the nearest.
private func typed(_ axis: Int) -> String {
    (axis < 0 ? "-" : "") + ["x", "y", "z"][min(max(Int(clamping: axis.magnitude), 1), 3) - 1]
}

extension {{ "Status"|swift }} {
    /// What the person can do for a better heading, in the app's language; nil: nothing.
    public var localizedGuidance: String? {
        switch self {
{% for status in by_name.Status.cases %}
{% if status.nested and by_name[status.nested.kind].cases|selectattr("guidance")|list %}
{% for case in by_name[status.nested.kind].cases %}
        case .{{ status.name|camel }}(.{{ case.name|camel }}): {% if case.guidance %}say("{{ case.guidance }}"){% else %}nil{% endif %}

{% endfor %}
{% else %}
        case .{{ status.name|camel }}: {% if status.guidance %}say("{{ status.guidance }}"){% else %}nil{% endif %}

{% endif %}
{% endfor %}
        }
    }
}

extension FieldEvent {
    /// One sentence an app may show of a change that was decided, in the app's language.
    public var localizedText: String {
        let tookS = (Double(decidedNs) - Double(sinceNs)) * 1e-9
        return switch kind {
{% for case in by_name.EventKind.cases %}
        case .{{ case.name|camel }}: say("{{ case.key }}", tookS)
{% endfor %}
        }
    }
}
