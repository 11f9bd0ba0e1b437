//! `bindings/status.toml`: every enum that says what the library is doing, its cases, and what each says in every language.

use serde::Deserialize;
use std::collections::BTreeMap;

/// Kinds of fields that are no enum of the table.
pub const PLAIN_KINDS: [&str; 5] = ["count", "time", "real", "axis", "signed_axis"];

/// An enum of the border.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Enum {
    #[serde(default)]
    pub name: String,
    pub meaning: String,
    /// Its name in the core, where that is another.
    pub core: Option<String>,
    /// The enum of C that has its cases.
    pub c: Option<String>,
    /// What the names of its texts begin with.
    pub texts: Option<String>,
    pub cases: Vec<Case>,
}

/// One of its cases.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Case {
    pub name: String,
    pub code: i32,
    pub c: Option<i32>,
    pub meaning: String,
    pub developers: Option<String>,
    pub remedy: Option<String>,
    pub guidance: Option<String>,
    pub heading: Option<String>,
    #[serde(default)]
    pub fields: Vec<Field>,
    #[serde(default)]
    pub text: BTreeMap<String, String>,
}

/// What a case carries.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Field {
    pub name: String,
    pub kind: String,
    pub meaning: String,
    pub example: Option<toml::Value>,
}

impl Case {
    /// The enum that is all the case carries, by the table's name.
    pub fn nested(&self) -> Option<&Field> {
        self.fields.iter().find(|field| !PLAIN_KINDS.contains(&field.kind.as_str()))
    }
}

/// Reads the table, and refuses what the languages could not be made from.
pub fn read(text: &str) -> Result<Vec<Enum>, String> {
    let table: toml::Table = text.parse().map_err(|error| format!("bindings/status.toml: {error}"))?;
    let mut enums = Vec::new();
    for (name, value) in table {
        let mut one: Enum = value.try_into().map_err(|error| format!("bindings/status.toml: {name}: {error}"))?;
        one.name = name;
        enums.push(one);
    }
    for one in &enums {
        one.check(&enums).map_err(|why| format!("bindings/status.toml: {}{why}", one.name))?;
    }
    Ok(enums)
}

impl Enum {
    fn check(&self, all: &[Enum]) -> Result<(), String> {
        let first = self.cases.first().map_or(0, |case| case.code);
        for (k, case) in self.cases.iter().enumerate() {
            let refuse = |why: String| Err(format!(".{}: {why}", case.name));
            if let Some(other) = self.cases[..k].iter().find(|other| other.name == case.name || other.code == case.code)
            {
                return refuse(format!("its name or its code {} is that of {} too", case.code, other.name));
            }
            // uniffi counts cases in the order of their declaration
            if case.code != first + k as i32 {
                return refuse(format!(
                    "code is {}, expected {}: codes count up, a new case comes last",
                    case.code,
                    first + k as i32
                ));
            }
            if case.fields.len() > 1 && case.nested().is_some() {
                return refuse("an enum is the only field of its case".to_owned());
            }
            for field in &case.fields {
                let is_enum = all.iter().any(|one| one.name == field.kind);
                if !is_enum && !PLAIN_KINDS.contains(&field.kind.as_str()) {
                    return refuse(format!(
                        "field {} has the kind {}, expected {PLAIN_KINDS:?} or an enum of the table",
                        field.name, field.kind
                    ));
                }
                if !is_enum && field.example.is_none() {
                    return refuse(format!("field {} has no example", field.name));
                }
            }
            let count =
                |kinds: &[&str]| case.fields.iter().filter(|field| kinds.contains(&field.kind.as_str())).count();
            if count(&["count", "time", "axis"]) > 2 || count(&["real", "signed_axis"]) > 3 {
                return refuse("the border carries two whole numbers and three others".to_owned());
            }
            if self.texts.is_some() && case.nested().is_none() && !case.text.contains_key("en") {
                return refuse("it has no text.en".to_owned());
            }
        }
        Ok(())
    }
}
