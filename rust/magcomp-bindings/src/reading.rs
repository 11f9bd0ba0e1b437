//! `bindings/reading.toml`: the flat reading's fields, and where each lies, as templates ask for them. What serde skips follows from the rest.

use crate::names::camel;
use crate::table::Enum;
use serde::{Deserialize, Serialize};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    fields: Vec<Field>,
}

/// A field, or a part of one: a place in the struct and among the doubles.
#[derive(Clone, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct Field {
    name: String,
    kind: String,
    meaning: String,
    /// When it is not known; of a record's part, while the record is.
    none: Option<String>,
    slot: Option<String>,
    #[serde(default)]
    flat: String,
    /// Names in Kotlin's buffer, each with its document.
    #[serde(default)]
    buffer: toml::Table,
    #[serde(default = "is_in_core")]
    core: bool,
    #[serde(default)]
    parts: Vec<Field>,
    #[serde(skip_deserializing)]
    is_enum: bool,
    /// Where its first double is.
    #[serde(skip_deserializing)]
    at: usize,
    /// Its parts; of one without, itself.
    #[serde(skip_deserializing)]
    leaves: Vec<Field>,
}

fn is_in_core() -> bool {
    true
}

/// The layout: the fields, and how many doubles they take.
#[derive(Serialize)]
pub struct Layout {
    fields: Vec<Field>,
    /// Those of all fields, in their order.
    leaves: Vec<Field>,
    numbers: usize,
}

/// Reads the table, and refuses what has no place.
pub fn read(text: &str, enums: &[Enum]) -> Result<Layout, String> {
    let Table { mut fields } = toml::from_str(text).map_err(|error| format!("bindings/reading.toml: {error}"))?;
    let (mut leaves, mut numbers) = (Vec::<Field>::new(), 0);
    for field in &mut fields {
        field.is_enum = enums.iter().any(|one| one.name == field.kind);
        field.leaves = if field.parts.is_empty() { vec![field.clone()] } else { field.parts.clone() };
        for leaf in &mut field.leaves {
            leaf.complete(&mut numbers).map_err(|why| format!("bindings/reading.toml: {}: {why}", leaf.name))?;
            if leaves.iter().any(|other| other.slot == leaf.slot || other.flat == leaf.flat) {
                return Err(format!("bindings/reading.toml: {}: its slot or its name is there twice", leaf.flat));
            }
            leaves.push(leaf.clone());
        }
    }
    Ok(Layout { fields, leaves, numbers })
}

impl Field {
    fn complete(&mut self, numbers: &mut usize) -> Result<(), String> {
        let width = match self.kind.as_str() {
            "vector" => 3,
            "real" | "share" | "count" => 1,
            _ if self.is_enum => 1,
            other => {
                return Err(format!(
                    "its kind is {other}, expected vector, real, share, count, an enum, or a record with parts"
                ));
            }
        };
        if self.slot.is_none() {
            return Err("it has no slot".to_owned());
        }
        if self.flat.is_empty() {
            self.flat.clone_from(&self.name);
        }
        if self.buffer.is_empty() && width == 1 {
            let none = self.none.as_ref().map_or(String::new(), |none| format!(" NaN {none}."));
            self.buffer.insert(camel(&self.flat), format!("{}{none}", self.meaning).into());
        }
        if self.buffer.len() != width {
            return Err(format!("it has {} names in the buffer, expected {width}", self.buffer.len()));
        }
        self.at = *numbers;
        *numbers += width;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const REAL: &str =
        "[[fields]]\nname = \"a_ut\"\nkind = \"real\"\nslot = \"A\"\nmeaning = \"x.\"\nnone = \"where y\"\n";

    #[test]
    fn fields_lie_one_after_the_other() {
        let vector = "[[fields]]\nname = \"v\"\nkind = \"vector\"\nslot = \"V\"\nmeaning = \"x\"\nbuffer.x = \"a\"\nbuffer.y = \"b\"\nbuffer.z = \"c\"\n";
        let layout = read(&format!("{vector}{REAL}"), &[]).unwrap();
        assert_eq!((layout.numbers, layout.leaves[1].at), (4, 3));
        assert_eq!(layout.leaves[1].buffer["aUt"].as_str(), Some("x. NaN where y."));
    }

    #[test]
    fn what_has_no_place_is_refused() {
        let refused = |fields: &str| read(fields, &[]).err().unwrap();
        assert!(refused(&REAL.replace("slot = \"A\"\n", "")).contains("no slot"));
        assert!(refused(&REAL.replace("\"real\"", "\"complex\"")).contains("kind is complex"));
        assert!(refused(&REAL.replace("\"real\"", "\"vector\"")).contains("0 names in the buffer, expected 3"));
        assert!(refused(&format!("{REAL}{REAL}")).contains("twice"));
        assert!(refused(&REAL.replace("none", "nine")).contains("unknown field `nine`"));
    }
}
