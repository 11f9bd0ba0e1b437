//! `bindings/reading.toml`: the flat reading's fields, and where each lies.

use crate::names::camel;
use crate::table::Enum;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    fields: Vec<Field>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Field {
    name: String,
    kind: String,
    meaning: String,
    none: Option<String>,
    slot: Option<String>,
    flat: Option<String>,
    #[serde(default)]
    buffer: toml::Table,
    core: Option<bool>,
    #[serde(default)]
    parts: Vec<Field>,
}

/// A field as templates ask for it. One without parts is its own only leaf.
#[derive(Clone, Serialize)]
pub struct FieldView {
    name: String,
    camel: String,
    kind: String,
    /// Of a record or an enum, in Kotlin and Swift.
    app: String,
    is_enum: bool,
    is_record: bool,
    meaning: String,
    none: Option<String>,
    core: bool,
    leaves: Vec<LeafView>,
}

/// One place in the struct and among the doubles.
#[derive(Clone, Serialize)]
struct LeafView {
    name: String,
    camel: String,
    kind: String,
    flat: String,
    slot: String,
    /// Of its first double.
    at: usize,
    width: usize,
    /// When it is not known; of a record's part, while the record is.
    none: Option<String>,
    /// Names in Kotlin's buffer, each with its document.
    buffer: Vec<(String, String)>,
}

/// The layout: the fields, and how many doubles they take.
#[derive(Serialize)]
pub struct Layout {
    fields: Vec<FieldView>,
    /// Those of all fields, in their order.
    leaves: Vec<LeafView>,
    numbers: usize,
}

/// Reads the table, and refuses what has no place.
pub fn read(text: &str, enums: &[Enum], renamed: &BTreeMap<String, String>) -> Result<Layout, String> {
    let table: Table = toml::from_str(text).map_err(|error| format!("bindings/reading.toml: {error}"))?;
    let (mut fields, mut numbers) = (Vec::new(), 0);
    for field in &table.fields {
        let view = FieldView::of(field, &mut numbers, enums, renamed);
        fields.push(view.map_err(|why| format!("bindings/reading.toml: {}: {why}", field.name))?);
    }
    let leaves: Vec<LeafView> = fields.iter().flat_map(|field| field.leaves.iter().cloned()).collect();
    for (k, leaf) in leaves.iter().enumerate() {
        if leaves[..k].iter().any(|other| other.slot == leaf.slot || other.flat == leaf.flat) {
            return Err(format!("bindings/reading.toml: {}: its slot or its name is there twice", leaf.flat));
        }
    }
    Ok(Layout { fields, leaves, numbers })
}

impl FieldView {
    fn of(
        field: &Field,
        numbers: &mut usize,
        enums: &[Enum],
        renamed: &BTreeMap<String, String>,
    ) -> Result<Self, String> {
        let is_enum = enums.iter().any(|one| one.name == field.kind);
        let is_record = !field.parts.is_empty();
        let parts = if is_record { &field.parts[..] } else { std::slice::from_ref(field) };
        let leaves: Result<Vec<_>, String> = parts.iter().map(|part| LeafView::of(part, numbers, is_enum)).collect();
        Ok(Self {
            name: field.name.clone(),
            camel: camel(&field.name),
            app: renamed.get(&field.kind).unwrap_or(&field.kind).clone(),
            kind: field.kind.clone(),
            is_enum,
            is_record,
            meaning: field.meaning.clone(),
            none: field.none.clone(),
            core: field.core.unwrap_or(true),
            leaves: leaves?,
        })
    }
}

impl LeafView {
    fn of(part: &Field, numbers: &mut usize, is_enum: bool) -> Result<Self, String> {
        let width = match part.kind.as_str() {
            "vector" => 3,
            "real" | "share" | "count" => 1,
            _ if is_enum => 1,
            other => {
                return Err(format!(
                    "{} has the kind {other}, expected vector, real, share, count, an enum, or a record with parts",
                    part.name
                ));
            }
        };
        let flat = part.flat.as_ref().unwrap_or(&part.name);
        let mut buffer = Vec::new();
        for (name, document) in &part.buffer {
            buffer.push((name.clone(), document.as_str().ok_or("a buffer's document is a text")?.to_owned()));
        }
        if buffer.is_empty() && width == 1 {
            let none = part.none.as_ref().map_or(String::new(), |none| format!(" NaN {none}."));
            buffer.push((camel(flat), format!("{}{none}", part.meaning)));
        }
        if buffer.len() != width {
            return Err(format!("{} has {} names in the buffer, expected {width}", part.name, buffer.len()));
        }
        let at = *numbers;
        *numbers += width;
        Ok(Self {
            name: part.name.clone(),
            camel: camel(&part.name),
            kind: part.kind.clone(),
            flat: flat.clone(),
            slot: part.slot.clone().ok_or_else(|| format!("{} has no slot", part.name))?,
            at,
            width,
            none: part.none.clone(),
            buffer,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layout(fields: &str) -> Result<Layout, String> {
        read(fields, &[], &BTreeMap::new())
    }

    const REAL: &str =
        "[[fields]]\nname = \"a_ut\"\nkind = \"real\"\nslot = \"A\"\nmeaning = \"x.\"\nnone = \"where y\"\n";

    #[test]
    fn fields_lie_one_after_the_other() {
        let vector = "[[fields]]\nname = \"v\"\nkind = \"vector\"\nslot = \"V\"\nmeaning = \"x\"\nbuffer.x = \"a\"\nbuffer.z = \"b\"\nbuffer.y = \"c\"\n";
        let layout = layout(&format!("{vector}{REAL}")).unwrap();
        assert_eq!((layout.numbers, layout.fields[1].leaves[0].at), (4, 3));
        assert_eq!(layout.fields[1].leaves[0].buffer, [("aUt".to_owned(), "x. NaN where y.".to_owned())]);
        // as they stand in the file
        let names: Vec<&str> = layout.fields[0].leaves[0].buffer.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["x", "z", "y"]);
    }

    #[test]
    fn what_has_no_place_is_refused() {
        assert!(layout(&REAL.replace("slot = \"A\"\n", "")).err().unwrap().contains("no slot"));
        assert!(layout(&REAL.replace("\"real\"", "\"complex\"")).err().unwrap().contains("kind complex"));
        assert!(
            layout(&REAL.replace("\"real\"", "\"vector\""))
                .err()
                .unwrap()
                .contains("0 names in the buffer, expected 3")
        );
        assert!(layout(&format!("{REAL}{REAL}")).err().unwrap().contains("twice"));
        assert!(layout(&REAL.replace("none", "nine")).err().unwrap().contains("unknown field `nine`"));
    }
}
