// made by bindings/generate.sh from bindings/config.toml
//! What can be chosen, checked once.

use crate::calibration::Calibration;
use crate::range::{ConfigError, in_range};
use alloc::{borrow::ToOwned, string::ToString};

{% for one in choices %}
/// {{ one.meaning }} The default is `{{ one.default }}`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
{% if one.grows %}
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
{% endif %}
pub enum {{ one.name }} {
{% for case in one.cases %}
    /// {{ case.meaning }}
{% if case.name == one.default %}
    #[default]
{% endif %}
    {{ case.name }},
{% endfor %}
}

{% endfor %}
{% for group in settings if group.core %}
/// {{ group.meaning }}
#[derive(Clone, {{ "Copy, " if group.name != "Config" }}Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub struct {{ group.name }} {
{% for field in group.fields if field.core %}
    /// {{ field.meaning|replace("{default}", field.usual) }}{{ " Why: " ~ field.why ~ "." if field.why }}
{% set its = {"real": "f64", "count": "usize", "flag": "bool"}[field.kind]|default(field.kind) %}
    pub {{ field.name }}: {{ "Option<" ~ its ~ ">" if field.none else its }},
{% endfor %}
}

impl Default for {{ group.name }} {
    fn default() -> Self {
        Self {
{% for field in group.fields if field.core %}
            {{ field.name }}: {{ field.default }},
{% endfor %}
        }
    }
}

impl {{ group.name }} {
    /// Whether every field is inside its range.
    ///
    /// # Errors
    /// [`ConfigError`] names the first field that is not, and its range.
    pub{{ "(crate)" if group.name != "Config" }} fn validate(&self) -> Result<(), ConfigError> {
{% for field in group.fields if field.range and field.range[1] is number %}
        in_range("{{ field.place }}", self.{{ field.name }}, {{ field.range[0] }}..={{ field.range[1] }}, "{{ field.unit }}")?;
{% endfor %}
{% for field in group.fields if field.range and field.range[1] is string %}
        if !({{ field.range[0] }}..=self.{{ field.range[1] }}).contains(&self.{{ field.name }}) {
            let is_small = self.{{ field.name }} < {{ field.range[0] }};
            let expected = if is_small { "at least {{ field.range[0] }} {{ field.unit }}" } else { "at most {{ field.place|replace(field.name, field.range[1]) }}" }.to_owned();
            return Err(ConfigError { field: "{{ field.place }}", value: self.{{ field.name }}.to_string(), expected });
        }
{% endfor %}
{% for field in group.fields if field.is_group %}
        self.{{ field.name }}.validate()?;
{% endfor %}
        Ok(())
    }
}
{{ "\n" if not loop.last }}
{%- endfor %}
