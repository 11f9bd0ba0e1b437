//! `bindings/config.toml`: the settings, what can be chosen, and both as templates ask for them.

use crate::names::{camel, snake};
use crate::table::{self, Enum, as_rust};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use toml::Value;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Group {
    meaning: String,
    place: String,
    core: Option<bool>,
    fields: Vec<Field>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Field {
    name: String,
    #[serde(default = "real")]
    kind: String,
    meaning: String,
    why: Option<String>,
    unit: Option<String>,
    #[serde(default)]
    range: Vec<Value>,
    default: Option<Value>,
    #[serde(default)]
    none: bool,
    phone: Option<String>,
    core: Option<String>,
    c: Option<usize>,
    c_name: Option<String>,
}

fn real() -> String {
    "real".to_owned()
}

/// A group of settings.
#[derive(Serialize)]
pub struct GroupView {
    name: String,
    /// In Kotlin.
    app: String,
    meaning: String,
    fields: Vec<FieldView>,
    /// The members of the core's struct.
    core: Vec<String>,
    /// Whether that is made too.
    is_made: bool,
}

#[derive(Clone, Serialize)]
pub struct FieldView {
    name: String,
    camel: String,
    kind: String,
    /// Its type in the core, at the border, in Kotlin and in Python.
    rust: String,
    border: String,
    kotlin: String,
    python: String,
    /// Of an enum: C's default.
    c_value: Option<String>,
    /// With the default on phones; with the core's; with C's.
    meaning: String,
    document: String,
    c_meaning: String,
    why: Option<String>,
    none: bool,
    is_group: bool,
    /// Where the core has it; empty: it does not.
    core: String,
    /// The core's, as Rust has it.
    default: Option<String>,
    phone: Option<String>,
    /// As Rust has them.
    least: Option<String>,
    most: Option<String>,
    /// The setting that it is at most.
    below: Option<String>,
    unit: String,
    /// Where an error says it is: `windowed.n_min`.
    place: String,
    c: Option<usize>,
    c_name: String,
}

/// What the table has.
pub struct Settings {
    pub choices: Vec<Enum>,
    pub groups: Vec<GroupView>,
    /// The members of C's struct, in their order.
    pub members: Vec<FieldView>,
}

/// A number as prose has it: `100 000`, `0.01`, `2`.
fn spoken(number: &Value) -> String {
    let number = number.as_float().map_or_else(|| as_rust(number), |x| x.to_string());
    match number.len() {
        5.. if number.bytes().all(|b| b.is_ascii_digit()) => {
            let (thousands, rest) = number.split_at(number.len() - 3);
            format!("{thousands} {rest}")
        }
        _ => number,
    }
}

/// Reads the table. `renamed`: names in Kotlin.
pub fn read(text: &str, renamed: &BTreeMap<String, String>) -> Result<Settings, String> {
    const FILE: &str = "bindings/config.toml";
    let all: toml::Table = text.parse().map_err(|error| format!("{FILE}: {error}"))?;
    let (choices, table): (toml::Table, toml::Table) =
        all.into_iter().partition(|(_, value)| value.get("cases").is_some());
    let choices = table::enums(FILE, choices)?;
    let renamed = |name: &str| renamed.get(name).map_or_else(|| name.to_owned(), Clone::clone);
    let mut groups = Vec::new();
    for (name, value) in &table {
        let group: Group = value.clone().try_into().map_err(|error| format!("{FILE}: {name}: {error}"))?;
        let mut core: Vec<String> = Vec::new();
        let mut fields: Vec<FieldView> = Vec::new();
        for field in &group.fields {
            let refuse = |why: &str| format!("{FILE}: {name}.{}: {why}", field.name);
            if fields.iter().any(|other| other.name == field.name) {
                return Err(refuse("it is there twice"));
            }
            let its = field.core.as_ref().unwrap_or(&field.name);
            if its.is_empty() && field.phone.is_none() {
                return Err(refuse("the core does not have it, so it needs a default"));
            }
            let member = its.split('.').next().unwrap_or_default();
            if !member.is_empty() && !core.iter().any(|known| known == member) {
                core.push(member.to_owned());
            }
            let view =
                field.view(&group, &choices, table.contains_key(&field.kind), &renamed).map_err(|why| refuse(&why))?;
            fields.push(view);
        }
        let (name, app, is_made) = (name.clone(), renamed(name), group.core.unwrap_or(true));
        groups.push(GroupView { name, app, meaning: group.meaning, fields, core, is_made });
    }
    let mut members: Vec<FieldView> =
        groups.iter().flat_map(|group| &group.fields).filter(|field| field.c.is_some()).cloned().collect();
    members.sort_by_key(|field| field.c);
    if let Some((_, out)) = members.iter().enumerate().find(|(k, field)| field.c != Some(k + 1)) {
        return Err(format!("{FILE}: {}: the members of C's struct count from 1, a new one comes last", out.place));
    }
    Ok(Settings { choices, groups, members })
}

impl Field {
    fn view(
        &self,
        group: &Group,
        choices: &[Enum],
        is_group: bool,
        renamed: &dyn Fn(&str) -> String,
    ) -> Result<FieldView, String> {
        let choice = choices.iter().find(|one| one.name == self.kind);
        let kind = self.kind.as_str();
        let [kotlin, rust, python] = match kind {
            "real" => ["Double", "f64", "float"].map(ToOwned::to_owned),
            "count" => ["Int", "usize", "int"].map(ToOwned::to_owned),
            "flag" => ["Boolean", "bool", "bool"].map(ToOwned::to_owned),
            "Calibration" => [renamed(kind), kind.to_owned(), format!("Initial{kind}")],
            _ if is_group || choice.is_some() => [renamed(kind), kind.to_owned(), kind.replace("Config", "Settings")],
            _ => return Err("its kind is not real, count, flag, Calibration, or in the table".to_owned()),
        };
        let chosen = choice.and_then(|one| one.default.clone());
        let default = match (&self.default, &chosen) {
            _ if self.none => Some("None".to_owned()),
            (Some(value), _) => Some(as_rust(value)),
            (None, Some(case)) => Some(format!("{}::{case}", self.kind)),
            (None, None) => is_group.then(|| format!("{}::default()", self.kind)),
        };
        let is_made = group.core.unwrap_or(true) && self.core.as_deref() != Some("");
        if is_made && (default.is_none() || ["real", "count"].contains(&kind) && self.range.len() != 2) {
            return Err("the core's struct is made, so it needs a default, and a number a range".to_owned());
        }
        let below = self.range.get(1).and_then(Value::as_str).map(ToOwned::to_owned);
        let (unit, words) = match self.name.rsplit('_').next() {
            Some("ut") => ("uT", "microtesla"),
            Some("deg") => ("deg", "degrees"),
            _ => [self.unit.as_deref().unwrap_or_default(); 2].into(),
        };
        let usual = match &self.default {
            _ if self.none => "none".to_owned(),
            Some(value) => spoken(value),
            None => chosen.as_ref().map_or_else(String::new, |case| format!("`{case}`")),
        };
        let told = |default: &str| {
            let range = self.range.iter().map(spoken).collect::<Vec<_>>().join(" to ");
            self.meaning.replace("{unit}", words).replace("{range}", &range).replace("{default}", default)
        };
        let on_phones = self.phone.as_ref().and_then(|it| it.split_once("::")).map(|(_, case)| format!("`{case}`"));
        let chosen_c = choice.and_then(|one| one.cases.iter().find(|case| Some(&case.name) == chosen.as_ref()));
        let (c_default, c_value) = match chosen_c.zip(choice) {
            Some((case, Enum { c: Some(c), .. })) => (
                Some(format!("MAGCOMP_{}_{}", c.to_uppercase(), snake(&case.name).to_uppercase())),
                Some(format!("{c}::{} as i32", case.name)),
            ),
            Some((case, _)) => [case.c.map(|code| code.to_string()), case.c.map(|code| code.to_string())].into(),
            None => (self.none.then(|| "NaN".to_owned()), None),
        };
        let document = told(&usual);
        Ok(FieldView {
            name: self.name.clone(),
            camel: camel(&self.name),
            border: if kind == "count" { "i32".to_owned() } else { rust.clone() },
            rust,
            kotlin,
            python,
            c_value,
            meaning: on_phones.map_or_else(|| document.clone(), |default| told(&default)),
            c_meaning: c_default.map_or_else(|| document.clone(), |default| told(&default)),
            document,
            why: self.why.clone(),
            none: self.none,
            is_group,
            core: self.core.clone().unwrap_or_else(|| self.name.clone()),
            default,
            phone: self.phone.clone(),
            least: self.range.first().map(as_rust),
            most: self.range.get(1).filter(|_| below.is_none()).map(as_rust),
            below,
            unit: format!("{unit}{}", if self.none { ", or none" } else { "" }),
            place: if group.place.is_empty() { self.name.clone() } else { format!("{}.{}", group.place, self.name) },
            c: self.c,
            c_name: self.c_name.clone().unwrap_or_else(|| self.name.clone()),
            kind: self.kind.clone(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_a_setting_is_refused() {
        let why = |field: &str| {
            read(&format!("[G]\nmeaning = \"x\"\nplace = \"g\"\n{field}"), &BTreeMap::new()).err().unwrap_or_default()
        };
        let real = "[[G.fields]]\nname = \"a\"\nkind = \"real\"\nrange = [0.5, 10000]\ndefault = 2.0\nmeaning = \"{range}, {default}\"\n";
        assert_eq!(why(real), "");
        assert!(why(&format!("{real}{real}")).contains("G.a: it is there twice"));
        assert!(why(&format!("{real}core = \"\"\n")).contains("needs a default"));
        assert!(why(&real.replace("real", "number")).contains("its kind"));
        assert!(why(&real.replace("default = 2.0\n", "")).contains("needs a default"));
        assert!(why(&real.replace(", 10000]", "]")).contains("a number a range"));
        assert!(why(&format!("{real}c = 2\n")).contains("g.a: the members of C's struct count from 1"));
        assert!(why(&format!("{real}limit = 1\n")).contains("unknown field `limit`"));
        let settings = read(&format!("[G]\nmeaning = \"x\"\nplace = \"g\"\n{real}"), &BTreeMap::new()).unwrap();
        assert_eq!(settings.groups[0].fields[0].meaning, "0.5 to 10 000, 2");
    }
}
