// made by bindings/generate.sh from bindings/status.toml
//! The enums of what the compensator is doing, and why, with the codes of the C header.

use magcomp_core as core;

{% macro open(called, meaning, zero) %}
/// {{ meaning }}
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum {{ called }} {
{% if zero %}
    /// {{ zero }}
    None = 0,
{% endif %}
{% endmacro %}
{% macro arm(case) %}
{{ case.name }}{{ "(..)" if case.nested else " { .. }" if case.fields }}
{%- endmacro %}
{{ open("Status", "What the compensator is doing.", "") }}
{%- for case in by_name.Status.cases %}
    /// {{ case.meaning }}{{ " `reason` says why." if case.nested }}
    {{ case.name }} = {{ case.c }},
{% endfor %}
}

{{ open("Reason", "Why the status is what it is.", "The status says it all.") }}
{%- for case in by_name.Missing.cases|chain(by_name.HoldReason.cases)|chain(by_name.RejectReason.cases)|sort(attribute="c") %}
    /// {{ case.under }}: {{ case.document[:1]|lower }}{{ case.document[1:] }}{{ " See `fit_problem`." if case.nested }}
    {{ case.name }} = {{ case.c }},
{% endfor %}
}

{% for one, zero in [(by_name.FitProblem, "`reason` is about no fit."), (by_name.EventKind, "None yet."), (by_name.SensorMode, ""), (by_name.ModelOrder, "The estimator does not tell."), (by_name.HeadingAid, "None came in the last two minutes.")] %}
{{ open(one.c, one.meaning, zero) }}
{%- for case in one.cases %}
    /// {{ case.document }}
    {{ case.name }} = {{ case.c }},
{% endfor %}
}

impl From<core::{{ one.core }}> for {{ one.c }} {
    fn from(it: core::{{ one.core }}) -> Self {
        match it {
{% for case in one.cases %}
            core::{{ one.core }}::{{ arm(case) }} => Self::{{ case.name }},
{% endfor %}
        }
    }
}

{% endfor %}
/// Status, reason, problem of a fit, and since when, ns.
pub(crate) fn told(status: &core::Status) -> (Status, Reason, FitProblem, i64) {
    let none = FitProblem::None;
    match status {
{% for status in by_name.Status.cases %}
{% if status.nested %}
        core::Status::{{ status.name }}(why) => match why {
{% for case in by_name[status.nested.kind].cases %}
            core::{{ by_name[status.nested.kind].core }}::{% if case.nested %}{{ case.name }}(problem) => (Status::{{ status.name }}, Reason::{{ case.name }}, (*problem).into(), 0),
{% else %}{{ arm(case) }} => (Status::{{ status.name }}, Reason::{{ case.name }}, none, 0),
{% endif %}
{% endfor %}
        },
{% elif status.fields %}
        core::Status::{{ status.name }} { since_ns } => (Status::{{ status.name }}, Reason::None, none, *since_ns),
{% else %}
        core::Status::{{ status.name }} => (Status::{{ status.name }}, Reason::None, none, 0),
{% endif %}
{% endfor %}
    }
}
