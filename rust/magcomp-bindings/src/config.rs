//! `bindings/config.toml`: the settings and what can be chosen, as templates ask for them. What serde skips follows from the rest.

use crate::table::{self, Enum, as_rust};
use serde::{Deserialize, Serialize};
use toml::Value;

const FILE: &str = "bindings/config.toml";

/// A group of settings.
#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Group {
    #[serde(skip_deserializing)]
    name: String,
    meaning: String,
    place: String,
    /// Whether the core's struct is made too.
    #[serde(default = "is_made")]
    core: bool,
    fields: Vec<Field>,
    /// The members of the core's struct.
    #[serde(skip_deserializing)]
    members: Vec<String>,
}

fn is_made() -> bool {
    true
}

#[derive(Clone, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Field {
    name: String,
    #[serde(default = "real")]
    kind: String,
    /// `{default}` still stands for it.
    meaning: String,
    why: Option<String>,
    /// As an error tells it.
    #[serde(default)]
    unit: String,
    #[serde(default)]
    range: Vec<Value>,
    /// The core's; in the end as Rust has it.
    default: Option<Value>,
    #[serde(default)]
    none: bool,
    phone: Option<String>,
    /// Where the core has it; empty: it does not.
    core: Option<String>,
    c: Option<usize>,
    c_name: Option<String>,
    /// The core's default, as prose has it.
    #[serde(skip_deserializing)]
    usual: String,
    #[serde(skip_deserializing)]
    is_group: bool,
    /// Where an error says it is: `windowed.n_min`.
    #[serde(skip_deserializing)]
    place: String,
}

fn real() -> String {
    "real".to_owned()
}

/// What the table has.
pub struct Settings {
    pub choices: Vec<Enum>,
    pub groups: Vec<Group>,
    /// The members of C's struct, in their order.
    pub members: Vec<Field>,
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

/// Reads the table.
pub fn read(text: &str) -> Result<Settings, String> {
    let all: toml::Table = text.parse().map_err(|error| format!("{FILE}: {error}"))?;
    let (choices, table): (toml::Table, toml::Table) =
        all.into_iter().partition(|(_, value)| value.get("cases").is_some());
    let choices = table::enums(FILE, choices)?;
    let names: Vec<String> = table.keys().cloned().collect();
    let mut groups = Vec::new();
    for (name, value) in table {
        let mut group: Group = value.try_into().map_err(|error| format!("{FILE}: {name}: {error}"))?;
        group.name = name;
        for k in 0..group.fields.len() {
            let (before, rest) = group.fields.split_at_mut(k);
            let field = &mut rest[0];
            let is_twice = before.iter().any(|other| other.name == field.name);
            field.is_group = names.contains(&field.kind);
            field.place = format!("{}.{}", group.place, field.name).trim_start_matches('.').to_owned();
            let core = if is_twice { Err("it is there twice") } else { field.complete(&choices, group.core) };
            let core = core.map_err(|why| format!("{FILE}: {}.{}: {why}", group.name, field.name))?;
            if !core.is_empty() && !group.members.contains(&core) {
                group.members.push(core);
            }
        }
        groups.push(group);
    }
    let mut members: Vec<Field> =
        groups.iter().flat_map(|group| &group.fields).filter(|field| field.c.is_some()).cloned().collect();
    members.sort_by_key(|field| field.c);
    if let Some((_, out)) = members.iter().enumerate().find(|(k, field)| field.c != Some(k + 1)) {
        return Err(format!("{FILE}: {}: the members of C's struct count from 1, a new one comes last", out.place));
    }
    Ok(Settings { choices, groups, members })
}

impl Field {
    /// Fills in what follows; the member of the core's struct that it is in.
    fn complete(&mut self, choices: &[Enum], is_made: bool) -> Result<String, &'static str> {
        let kind = self.kind.as_str();
        let choice = choices.iter().find(|one| one.name == kind);
        if !self.is_group && choice.is_none() && !["real", "count", "flag", "Calibration"].contains(&kind) {
            return Err("its kind is not real, count, flag, Calibration, or in the table");
        }
        let chosen = choice.and_then(|one| one.default.as_ref());
        let (default, usual) = match (&self.default, chosen) {
            _ if self.none => (Some("None".to_owned()), "none".to_owned()),
            (Some(value), _) => (Some(as_rust(value)), spoken(value)),
            (None, Some(case)) => (Some(format!("{kind}::{case}")), format!("`{case}`")),
            (None, None) => (self.is_group.then(|| format!("{kind}::default()")), String::new()),
        };
        let core = self.core.get_or_insert_with(|| self.name.clone());
        if core.is_empty() && self.phone.is_none() {
            return Err("the core does not have it, so it needs a default");
        }
        let is_number = ["real", "count"].contains(&kind);
        if is_made && !core.is_empty() && (default.is_none() || is_number && self.range.len() != 2) {
            return Err("the core's struct is made, so it needs a default, and a number a range");
        }
        let (unit, words) = match self.name.rsplit('_').next() {
            Some("ut") => ("uT", "microtesla"),
            Some("deg") => ("deg", "degrees"),
            _ => [self.unit.as_str(); 2].into(),
        };
        let range = self.range.iter().map(spoken).collect::<Vec<_>>().join(" to ");
        self.meaning = self.meaning.replace("{unit}", words).replace("{range}", &range);
        self.unit = format!("{unit}{}", if self.none { ", or none" } else { "" });
        self.c_name.get_or_insert_with(|| self.name.clone());
        (self.default, self.usual) = (default.map(Value::String), usual);
        Ok(core.split('.').next().unwrap_or_default().to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_a_setting_is_refused() {
        let with = |field: &str| read(&format!("[G]\nmeaning = \"x\"\nplace = \"g\"\n{field}"));
        let why = |field: &str| with(field).err().unwrap_or_default();
        let real = "[[G.fields]]\nname = \"a\"\nkind = \"real\"\nrange = [0.5, 10000]\ndefault = 2.0\nmeaning = \"{range}, {default}\"\n";
        assert_eq!(why(real), "");
        assert!(why(&format!("{real}{real}")).contains("G.a: it is there twice"));
        assert!(why(&format!("{real}core = \"\"\n")).contains("needs a default"));
        assert!(why(&real.replace("real", "number")).contains("its kind"));
        assert!(why(&real.replace("default = 2.0\n", "")).contains("needs a default"));
        assert!(why(&real.replace(", 10000]", "]")).contains("a number a range"));
        assert!(why(&format!("{real}c = 2\n")).contains("g.a: the members of C's struct count from 1"));
        assert!(why(&format!("{real}limit = 1\n")).contains("unknown field `limit`"));
        let field = &with(real).unwrap().groups[0].fields[0];
        assert_eq!([&field.meaning, &field.usual], ["0.5 to 10 000, {default}", "2"]);
    }
}
