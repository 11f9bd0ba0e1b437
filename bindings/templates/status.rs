// made by bindings/generate.sh from bindings/status.toml and bindings/config.toml
//! What the compensator is doing, and why, and what a setting can be that is no number: the core's enums as they cross the border, and their codes on the wire.

use crate::convert::{Cross, same};

{% macro rust_type(field) %}
{%- if field.kind in ["count", "signed_axis"] %}i32{% elif field.kind == "time" %}i64{% elif field.kind == "real" %}f64{% elif field.kind == "axis" %}Axis{% else %}{{ field.kind }}{% endif %}
{%- endmacro %}
{% macro pattern(case) %}
{% if case.fields %} { {% for field in case.fields %}{{ field.name }}{% if not loop.last %}, {% endif %}{% endfor %} }{% endif %}
{%- endmacro %}
{# what a case's numbers are on the wire, after its codes #}
{% macro numbers(case) %}
{% set wholes = [] %}
{% if case.fields and not case.nested %}
{%- for field in case.fields if field.kind in ["count", "time", "axis"] %}{% if loop.first %}.whole({% endif %}{% if field.kind == "time" %}{{ field.name }}{% elif field.kind == "axis" %}{{ field.name }}.code().into(){% else %}{{ field.name }}.into(){% endif %}{% if loop.last %}{% if loop.length == 1 %}, 0{% endif %}){% else %}, {% endif %}{% endfor %}
{%- for field in case.fields if field.kind in ["real", "signed_axis"] %}{% if loop.first %}.real({% endif %}{{ field.name }}{% if field.kind == "signed_axis" %}.into(){% endif %}{% if loop.last %}{{ ", f64::NAN" * (3 - loop.length) }}){% else %}, {% endif %}{% endfor %}
{%- endif %}
{%- endmacro %}
{% for one in enums|chain(choices) %}
/// {{ one.meaning }}{{ " `text()` says it in a sentence." if one.name in ["Status", "HeadingAid"] }}
#[derive(Clone, Copy, Debug, PartialEq, {{ "Eq, " if not one.cases|selectattr("fields")|list }}uniffi::Enum)]
pub enum {{ one.name }} {
{% for case in one.cases %}
    /// {{ case.document }}
    {{ case.name }}{% if case.fields %} {
{% for field in case.fields %}
        /// {{ field.meaning }}
        {{ field.name }}: {{ rust_type(field) }},
{% endfor %}
    }{% endif %},
{% endfor %}
}

{% endfor %}
impl Cross<Axis> for magcomp::Axis {
    fn cross(self) -> Axis {
        self.into()
    }
}

impl Cross<magcomp::Axis> for Axis {
    fn cross(self) -> magcomp::Axis {
        self.into()
    }
}

same! {
{% for one in enums|chain(choices) %}
    {{ one.name }}: {{ one.core }} { {% for case in one.cases %}{{ case.name }}{% if case.nested %}({{ case.nested.name }}){% else %}{{ pattern(case) }}{% endif %}{{ ", " if not loop.last }}{% endfor %} }
{% endfor %}
}

/// A change that was decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Record)]
pub struct Event {
    /// What changed.
    pub kind: EventKind,
    /// Time of the first sample that no longer fitted, nanoseconds.
    pub since_ns: i64,
    /// Time of the decision, nanoseconds.
    pub decided_ns: i64,
}

impl From<magcomp::Event> for Event {
    fn from(it: magcomp::Event) -> Self {
        let magcomp::Event { kind, since_ns, decided_ns } = it;
        Self { kind: kind.into(), since_ns, decided_ns }
    }
}

#[uniffi::export]
impl Status {
    /// One sentence an app may show.
    pub fn text(&self) -> String {
        magcomp::Status::from(*self).to_string()
    }

    /// One word for tables and logs: {% for case in by_name.Status.cases %}`{{ case.name|snake }}`{{ ", " if not loop.last }}{% endfor %}.
    pub fn label(&self) -> String {
        magcomp::Status::from(*self).label().to_owned()
    }
}
{% for name, what in [("RejectReason", "an app may show"), ("EventRejection", "for a log"), ("FitProblem", "an app may show"), ("HeadingAid", "an app may show")] %}

#[uniffi::export]
impl {{ name }} {
    /// One sentence {{ what }}.
    pub fn text(&self) -> String {
        magcomp::{{ by_name[name].core }}::from(*self).to_string()
    }
}
{% endfor %}
{% for one in enums if not one.cases|selectattr("fields")|list and one.name not in ["HeadingAid"] %}

impl {{ one.name }} {
    pub(crate) fn code(self) -> i32 {
        self as i32{{ " + " ~ one.cases[0].code if one.cases[0].code }}
    }
}
{% endfor %}

/// No case, where a number is a case's code.
pub(crate) const NONE: i32 = -1;

/// `MagcompStatus`.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct FlatStatus {
    pub(crate) kind: i32,
    pub(crate) reason: i32,
    pub(crate) problem: i32,
    pub(crate) whole: [i64; 2],
    pub(crate) real: [f64; 3],
}

impl FlatStatus {
    const fn of(kind: i32, reason: i32) -> Self {
        Self { kind, reason, problem: NONE, whole: [0; 2], real: [f64::NAN; 3] }
    }

    const fn whole(self, first: i64, second: i64) -> Self {
        Self { whole: [first, second], ..self }
    }

    const fn real(self, first: f64, second: f64, third: f64) -> Self {
        Self { real: [first, second, third], ..self }
    }
}

impl FitProblem {
    /// A status whose reason this is.
    fn of(self, kind: i32, reason: i32) -> FlatStatus {
        let with = |problem| FlatStatus { problem, ..FlatStatus::of(kind, reason) };
        match self {
{% for case in by_name.FitProblem.cases %}
            Self::{{ case.name }}{{ pattern(case) }} => with({{ case.code }}){{ numbers(case) }},
{% endfor %}
        }
    }
}

impl From<Status> for FlatStatus {
    fn from(status: Status) -> Self {
        match status {
{% for status in by_name.Status.cases %}
{% if status.nested %}
            Status::{{ status.name }} { {{ status.nested.name }} } => match {{ status.nested.name }} {
{% for case in by_name[status.nested.kind].cases %}
                {{ status.nested.kind }}::{{ case.name }}{{ pattern(case) }} => {% if case.nested %}{{ case.nested.name }}.of({{ status.code }}, {{ case.code }}){% else %}Self::of({{ status.code }}, {{ case.code }}){{ numbers(case) }}{% endif %},
{% endfor %}
            },
{% else %}
            Status::{{ status.name }}{{ pattern(status) }} => Self::of({{ status.code }}, NONE){{ numbers(status) }},
{% endif %}
{% endfor %}
        }
    }
}
