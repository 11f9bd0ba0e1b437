// made by bindings/generate.sh from bindings/reading.toml
//! The answer to one magnetometer sample as it crosses the border: uniffi's record, and the struct of plain numbers.

use crate::convert::count;
use crate::record::{Attitude, Heading, Vector3};
use crate::status::{Event, EventKind, FlatStatus, ModelOrder, NONE, SensorMode, Status};
use magcomp::nalgebra;

{% macro rust_type(field) %}
{% set inner = "Vector3" if field.kind == "vector" else "f64" if field.kind in ["real", "share"] else "i32" if field.kind == "count" else field.kind %}
{{ "Option<" ~ inner ~ ">" if field.none else inner }}
{%- endmacro %}
{% macro flat_type(leaf) %}
{{ "[f64; 3]" if leaf.kind == "vector" else "f64" if leaf.kind in ["real", "share"] else "i32" }}
{%- endmacro %}
{% macro from_core(field) %}
{% if not field.core %}{{ field.name }}: None{% elif field.kind == "count" %}{{ field.name }}: count({{ field.name }}){% elif field.kind in ["real", "share"] %}{{ field.name }}{% elif field.none %}{{ field.name }}: {{ field.name }}.map(Into::into){% else %}{{ field.name }}: {{ field.name }}.into(){% endif %}
{%- endmacro %}
{% macro flat_value(field) %}
{% if field.kind == "vector" %}vector({{ field.name }}){% elif field.kind == "real" %}number({{ field.name }}){% elif field.kind == "count" %}count({{ field.name }}){% elif field.is_enum %}{% if field.none %}{{ field.name }}.map_or(NONE, |it| {{ field.kind }}::from(it).code()){% else %}{{ field.kind }}::from({{ field.name }}).code(){% endif %}{% else %}{{ field.name }}{% endif %}
{%- endmacro %}
/// The answer to one magnetometer sample. A value that is not known is none, never NaN.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Record)]
pub struct Reading {
    /// Time of the sample, nanoseconds.
    pub time_ns: i64,
{% for field in reading.fields %}
    /// {{ field.meaning }}{{ " None " ~ field.none ~ "." if field.none }}
    pub {{ field.name }}: {{ rust_type(field) }},
{% endfor %}
    /// The latest change that was decided, kept until the next. None before the first.
    pub event: Option<Event>,
    /// What the compensator is doing, and why.
    pub status: Status,
}

impl From<magcomp::Reading> for Reading {
    fn from(it: magcomp::Reading) -> Self {
        let magcomp::Reading { time_ns{% for field in reading.fields if field.core %}, {{ field.name }}{% endfor %}, event, status } = it;
        Self {
            time_ns,
{% for field in reading.fields %}
            {{ from_core(field) }},
{% endfor %}
            event: event.map(Into::into),
            status: status.into(),
        }
    }
}

/// `MagcompEvent`.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct FlatEvent {
    pub(crate) kind: i32,
    pub(crate) since_ns: i64,
    pub(crate) decided_ns: i64,
}

/// `MagcompReading`.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct FlatReading {
{% for leaf in reading.leaves %}
    pub(crate) {{ leaf.flat }}: {{ flat_type(leaf) }},
{% endfor %}
    pub(crate) event: FlatEvent,
    pub(crate) status: FlatStatus,
}

impl FlatReading {
    /// What the core's reading does not have comes beside it.
    pub(crate) fn of(it: &magcomp::Reading{% for field in reading.fields if not field.core %}, {{ field.name }}: Option<f64>{% endfor %}) -> Self {
        // the time is the caller's own
        let magcomp::Reading { time_ns: _{% for field in reading.fields if field.core %}, {{ field.name }}{% endfor %}, event, status } = *it;
        let vector = |v: Option<nalgebra::Vector3<f64>>| v.map_or([f64::NAN; 3], Into::into);
        let number = |v: Option<f64>| v.unwrap_or(f64::NAN);
{% for field in reading.fields if field.parts %}
        let {{ field.name }} = {{ field.name }}.map({{ field.kind }}::from);
{% endfor %}
        Self {
{% for field in reading.fields %}
{% if field.parts %}
{% for leaf in field.leaves %}
            {{ leaf.flat }}: number({{ field.name }}.{{ "and_then" if leaf.none else "map" }}(|it| it.{{ leaf.name }})),
{% endfor %}
{% else %}
            {{ field.name }}{% if field.kind != "share" %}: {{ flat_value(field) }}{% endif %},
{% endif %}
{% endfor %}
            event: event.map_or(FlatEvent { kind: NONE, since_ns: 0, decided_ns: 0 }, |it| FlatEvent {
                kind: EventKind::from(it.kind).code(),
                since_ns: it.since_ns,
                decided_ns: it.decided_ns,
            }),
            status: Status::from(status).into(),
        }
    }
}
