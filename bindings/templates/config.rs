// made by bindings/generate.sh from bindings/config.toml
//! The settings' records and their conversions: what was left out becomes the core's default.

// one way to write a member, whichever struct of the core's it is in
#![allow(clippy::field_reassign_with_default)]

use crate::convert::count;
use crate::error::MagcompError;
use crate::record::Calibration;
use crate::status::{ {%- for one in choices %}{{ one.name }}{{ ", " if not loop.last }}{% endfor %}};

/// A count of the core's; `field` is where it stands in the config.
fn size(field: &str, n: i32) -> Result<usize, MagcompError> {
    usize::try_from(n).map_err(|_| MagcompError::Config {
        field: field.to_owned(),
        value: n.to_string(),
        expected: "0 or above".to_owned(),
    })
}

{% macro as_some(field) %}
{% if not field.core %}Some({{ field.phone }}){% elif field.none %}{{ field.core }}{{ ".map(Into::into)" if field.kind != "real" }}{% elif field.kind == "real" %}Some({{ field.core }}){% elif field.kind == "count" %}Some(count({{ field.core }})){% else %}Some({{ field.core }}.into()){% endif %}
{%- endmacro %}
{% macro from_core(field) %}
{% if field.none and field.kind == "real" and field.core == field.name %}{{ field.name }}{% else %}{{ field.name }}: {{ as_some(field) }}{% endif %}
{%- endmacro %}
{% for group in settings %}
/// {{ group.meaning }}{{ " `default_config()` shows them all." if group.name == "Config" }}
#[derive(Clone, Debug, Default, PartialEq, uniffi::Record)]
pub struct {{ group.name }} {
{% for field in group.fields %}
    /// {{ field.meaning|replace("{default}", "`" ~ (field.phone|split("::"))[1] ~ "`" if field.phone and "::" in field.phone else field.usual) }}
    #[uniffi(default = None)]
    pub {{ field.name }}: Option<{{ {"real": "f64", "count": "i32", "flag": "bool"}[field.kind]|default(field.kind) }}>,
{% endfor %}
}

impl From<magcomp::{{ group.name }}> for {{ group.name }} {
    fn from(core: magcomp::{{ group.name }}) -> Self {
        let magcomp::{{ group.name }} { {{ group.members|join(", ") }} } = core;
        Self {
{% for field in group.fields %}
            {{ from_core(field) }},
{% endfor %}
        }
    }
}

impl TryFrom<{{ group.name }}> for magcomp::{{ group.name }} {
    type Error = MagcompError;
    fn try_from(it: {{ group.name }}) -> Result<Self, MagcompError> {
        let mut core = Self::default();
{% for field in group.fields if field.core %}
{% if field.is_group %}
        core.{{ field.core }} = it.{{ field.name }}.unwrap_or_default().try_into()?;
{% elif field.none %}
        core.{{ field.core }} = it.{{ field.name }}{{ ".map(TryInto::try_into).transpose()?" if field.kind != "real" }};
{% elif field.phone %}
        core.{{ field.core }} = it.{{ field.name }}.unwrap_or({{ field.phone }}){{ ".into()" if field.kind not in ["real", "flag"] }};
{% else %}
        if let Some(value) = it.{{ field.name }} {
            core.{{ field.core }} = {% if field.kind == "real" %}value{% elif field.kind == "count" %}size("{{ field.place }}", value)?{% else %}value.into(){% endif %};
        }
{% endif %}
{% endfor %}
{% if group.name == "Config" %}
        core.validate()?;
{% endif %}
        Ok(core)
    }
}
{{ "\n" if not loop.last }}
{%- endfor %}
