//! `bindings/config.toml`: the settings as they cross the border.

use crate::names::camel;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Group {
    meaning: String,
    place: String,
    fields: Vec<Field>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Field {
    name: String,
    kind: String,
    meaning: String,
    #[serde(default)]
    none: bool,
    core: Option<String>,
    default: Option<String>,
}

/// A record of settings.
#[derive(Serialize)]
pub struct GroupView {
    name: String,
    /// In Kotlin.
    app: String,
    meaning: String,
    fields: Vec<FieldView>,
    /// The members of the core's struct.
    core: Vec<String>,
}

#[derive(Serialize)]
struct FieldView {
    name: String,
    camel: String,
    kind: String,
    kotlin: String,
    meaning: String,
    none: bool,
    is_group: bool,
    /// Where the core has it; empty: it does not.
    core: String,
    default: Option<String>,
    /// Where an error says it is: `windowed.n_min`.
    place: String,
}

/// Reads the table. `renamed`: names in Kotlin.
pub fn read(text: &str, renamed: &BTreeMap<String, String>) -> Result<Vec<GroupView>, String> {
    let table: toml::Table = text.parse().map_err(|error| format!("bindings/config.toml: {error}"))?;
    let mut groups = Vec::new();
    for (name, value) in &table {
        let group: Group =
            value.clone().try_into().map_err(|error| format!("bindings/config.toml: {name}: {error}"))?;
        let renamed = |name: &str| renamed.get(name).map_or_else(|| name.to_owned(), Clone::clone);
        let mut core: Vec<String> = Vec::new();
        let mut fields: Vec<FieldView> = Vec::new();
        for field in group.fields {
            let refuse = |why: &str| Err(format!("bindings/config.toml: {name}.{}: {why}", field.name));
            if fields.iter().any(|other| other.name == field.name) {
                return refuse("it is there twice");
            }
            let its = field.core.clone().unwrap_or_else(|| field.name.clone());
            if its.is_empty() && field.default.is_none() {
                return refuse("the core does not have it, so it needs a default");
            }
            let member = its.split('.').next().unwrap_or_default();
            if !member.is_empty() && !core.iter().any(|known| known == member) {
                core.push(member.to_owned());
            }
            let is_group = table.contains_key(&field.kind);
            fields.push(FieldView {
                camel: camel(&field.name),
                kotlin: match field.kind.as_str() {
                    "real" => "Double".to_owned(),
                    "count" => "Int".to_owned(),
                    "flag" => "Boolean".to_owned(),
                    kind if kind.starts_with(char::is_uppercase) => renamed(kind),
                    _ => return refuse("its kind is not real, count, flag, or a type of the border"),
                },
                place: if group.place.is_empty() {
                    field.name.clone()
                } else {
                    format!("{}.{}", group.place, field.name)
                },
                name: field.name,
                kind: field.kind,
                meaning: field.meaning,
                none: field.none,
                is_group,
                core: its,
                default: field.default,
            });
        }
        groups.push(GroupView { name: name.clone(), app: renamed(name), meaning: group.meaning, fields, core });
    }
    Ok(groups)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_a_setting_is_refused() {
        let why = |field: &str| {
            read(&format!("[G]\nmeaning = \"x\"\nplace = \"g\"\n{field}"), &BTreeMap::new()).err().unwrap_or_default()
        };
        let real = "[[G.fields]]\nname = \"a\"\nkind = \"real\"\nmeaning = \"x\"\n";
        assert_eq!(why(real), "");
        assert!(why(&format!("{real}{real}")).contains("G.a: it is there twice"));
        assert!(why(&format!("{real}core = \"\"\n")).contains("needs a default"));
        assert!(why(&real.replace("real", "number")).contains("its kind"));
        assert!(why(&format!("{real}range = \"0 to 1\"\n")).contains("unknown field `range`"));
    }
}
