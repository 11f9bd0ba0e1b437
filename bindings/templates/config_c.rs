// made by bindings/generate.sh from bindings/config.toml
//! The settings as members of C's struct, and what some of them choose from.

use crate::error::Failure;

{# C's value of an enum's default #}
{% macro value(field) %}
{% set one = by_name[field.kind] %}
{{ one.c ~ "::" ~ one.default ~ " as i32" if one.c else (one.cases|selectattr("name", "equalto", one.default)|first).c }}
{%- endmacro %}
{% for one in choices if one.c %}
/// {{ one.meaning }}
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum {{ one.c }} {
{% for case in one.cases if case.c is not none %}
    /// {{ case.meaning }}
    {{ case.name }} = {{ case.c }},
{% endfor %}
}

{% endfor %}
/// Settings. magcomp_config_default fills in the defaults; change what is to differ. As text, for magcomp_compensator_create, they have
/// these names; those of a heading are in {"heading": {}}, those of the paper's method in {"windowed": {}}. What differs, and what is there alone:
///
{% for group in settings if group.core %}
{% for field in group.fields if field.core and not field.is_group and (not field.c or field.kind in by_name) %}
/// - {{ field.place }}: {{ field.meaning|replace("{default}", field.usual) if not field.c }}{{ ' {"soft_iron": [9 numbers], "hard_iron_ut": [3 numbers], "field_strength_ut": |h|}' if field.kind == "Calibration" }}{% if field.kind in by_name %}{{ " " if not field.c }}One of "{{ by_name[field.kind].cases|map(attribute="name")|join('", "') }}".{% endif %}

{% endfor %}
{% endfor %}
#[derive(Clone, Copy)]
#[repr(C)]
pub struct Config {
    /// sizeof(magcomp_config).
    pub size: usize,
{% for field in members %}
{% set one = by_name[field.kind] if field.kind in by_name else false %}
{% set usual = ("MAGCOMP_" ~ one.c|upper ~ "_" ~ one.default|snake|upper if one.c else value(field)) if one else "NaN" if field.none else field.usual %}
    /// {{ "A magcomp_" ~ one.c|lower ~ ". " if one and one.c }}{{ field.meaning|replace("{default}", usual) }}{{ " One of " ~ one.cases|map(attribute="c")|join(", ") ~ "." if one and not one.c }}
    pub {{ field.c_name }}: {{ "f64" if field.kind == "real" else "i32" }},
{% endfor %}
}

impl Default for Config {
    fn default() -> Self {
        let it = magcomp_core::Config::default();
        Self {
            size: size_of::<Self>(),
{% for field in members %}
            {{ field.c_name }}: {{ value(field) if field.kind in by_name else "it." ~ field.place ~ (".unwrap_or(f64::NAN)" if field.none else "") }},
{% endfor %}
        }
    }
}

/// `then!(lines, c, Config { its members })`.
#[cfg(test)]
macro_rules! members {
    ($then:ident, $lines:ident, $c:literal) => { $then!($lines, $c, Config { size, {% for field in members %}{{ field.c_name }}{{ ", " if not loop.last }}{% endfor %} }) };
}
#[cfg(test)]
pub(crate) use members;

fn known(value: f64) -> Option<f64> {
    (!value.is_nan()).then_some(value)
}

{% macro chosen(field) %}
{% set one = by_name[field.kind] %}
match self.{{ field.c_name }} {
{% for case in one.cases if case.c is not none %}
                {{ "it if it == " ~ one.c ~ "::" ~ case.name ~ " as i32" if one.c else case.c }} => magcomp_core::{{ one.name }}::{{ case.name }},
{% endfor %}
                it => return Err(Failure::config(format!("{{ field.c_name }} is {it}, expected {% if one.c %}a magcomp_{{ one.c|lower }}{% else %}{% for case in one.cases %}{{ case.c }}{{ " or " if loop.index == loop.length - 1 else ", " if not loop.last }}{% endfor %}{% endif %}"))),
            }
{%- endmacro %}
// C may have all members of a group, or some
#[allow(clippy::needless_update)]
impl Config {
{% for group in settings if group.name in ["Config", "HeadingConfig"] %}
    pub(crate) fn {{ "core" if group.name == "Config" else "heading" }}(&self) -> Result<magcomp_core::{{ group.name }}, Failure> {
        Ok(magcomp_core::{{ group.name }} {
{% for field in group.fields if field.c or field.name == "heading" %}
            {{ field.name }}: {% if field.is_group %}self.heading()?{% elif field.kind in by_name %}{{ chosen(field) }}{% elif field.none %}known(self.{{ field.c_name }}){% else %}self.{{ field.c_name }}{% endif %},
{% endfor %}
            ..magcomp_core::{{ group.name }}::default()
        })
    }
{{ "\n" if not loop.last }}
{%- endfor %}
}
