// made by bindings/generate.sh from bindings/status.toml
//! What the compensator is doing, and why.

use alloc::{format, string::String};

{% macro rust_type(field) %}
{%- if field.kind == "count" %}usize{% elif field.kind == "signed_axis" %}i8{% elif field.kind == "time" %}i64{% elif field.kind == "real" %}f64{% else %}Axis{% endif %}
{%- endmacro %}
{% for one in enums %}
/// {{ one.meaning }}{{ " Its text is one sentence an app may show." if one.texts }}
#[derive(Clone, Copy, Debug, {{ "Default, " if one.default }}PartialEq{{ ", Eq" if not one.cases|selectattr("fields")|list }}{{ ", serde::Serialize, serde::Deserialize" if one.name != "EventRejection" }}{{ ", thiserror::Error" if one.cases|selectattr("says")|list }})]
{% if one.name != "Axis" %}
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
{% endif %}
pub enum {{ one.core }} {
{% for case in one.cases %}
    /// {{ case.document }}
{% if case.says %}
    #[error("{{ case.says }}"{{ ", typed([*.x, *.y, *.z])" if "{axes:text}" in case.text.en|default("") }})]
{% endif %}
{% if one.default == case.name %}
    #[default]
{% endif %}
    {{ case.name }}{% if case.nested %}({{ by_name[case.nested.kind].core }}){% elif case.fields %} {
{% for field in case.fields %}
        /// {{ field.meaning }}
        {{ field.name }}: {{ rust_type(field) }},
{% endfor %}
    }{% endif %},
{% endfor %}
}

{% endfor %}
impl Status {
    /// One word for tables and logs: {% for case in by_name.Status.cases %}`{{ case.name|snake }}`{{ ", " if not loop.last }}{% endfor %}.
    #[must_use]
    pub fn label(&self) -> &'static str {
        match self {
{% for case in by_name.Status.cases %}
            Self::{{ case.name }}{{ "(_)" if case.nested else " { .. }" if case.fields }} => "{{ case.name|snake }}",
{% endfor %}
        }
    }
}

/// Axes as one types them: `y,-x,z`.
fn typed(axes: [i8; 3]) -> String {
    let name = |axis: i8| ["x", "y", "z"][usize::from(axis.unsigned_abs().clamp(1, 3)) - 1];
    axes.map(|axis| format!("{}{}", if axis < 0 { "-" } else { "" }, name(axis))).join(",")
}
