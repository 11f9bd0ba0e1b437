// made by bindings/generate.sh from bindings/config.toml
//! What a setting can be that is no number.

use crate::convert::same;

{% for one in choices %}
/// {{ one.meaning }}
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
pub enum {{ one.name }} {
{% for case in one.cases %}
    /// {{ case.meaning }}
    {{ case.name }},
{% endfor %}
}

{% endfor %}
same! {
{% for one in choices %}
    {{ one.name }}: {{ one.name }} { {% for case in one.cases %}{{ case.name }}{{ ", " if not loop.last }}{% endfor %} }
{% endfor %}
}
