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
    /// The case that the core's default is.
    pub default: Option<String>,
    /// Whether the core's may get more cases: of settings.
    #[serde(default)]
    pub grows: bool,
    /// The enum of C that has its cases.
    pub c: Option<String>,
    /// What the names of its texts begin with.
    pub texts: Option<String>,
    /// The code of its first case.
    #[serde(default)]
    pub first: i32,
    pub cases: Vec<Case>,
}

/// One of its cases.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Case {
    pub name: String,
    /// On the wire: as uniffi does, by the order of the cases.
    #[serde(skip)]
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

/// A number of the table as Rust has it.
pub fn as_rust(value: &toml::Value) -> String {
    match value {
        toml::Value::Float(number) => format!("{number:?}"),
        toml::Value::Integer(number) => number.to_string(),
        other => other.as_str().unwrap_or_default().to_owned(),
    }
}

/// Reads the table.
pub fn read(text: &str) -> Result<Vec<Enum>, String> {
    enums("bindings/status.toml", text.parse().map_err(|error| format!("bindings/status.toml: {error}"))?)
}

/// The enums of a file; refuses what the languages could not be made from.
pub fn enums(file: &str, table: toml::Table) -> Result<Vec<Enum>, String> {
    let mut enums = Vec::new();
    for (name, value) in table {
        let mut one: Enum = value.try_into().map_err(|error| format!("{file}: {name}: {error}"))?;
        one.name = name;
        for (case, code) in one.cases.iter_mut().zip(one.first..) {
            case.code = code;
        }
        enums.push(one);
    }
    for one in &enums {
        one.check(&enums).map_err(|why| format!("{file}: {}{why}", one.name))?;
    }
    Ok(enums)
}

impl Enum {
    fn check(&self, all: &[Enum]) -> Result<(), String> {
        for (k, case) in self.cases.iter().enumerate() {
            let refuse = |why: String| Err(format!(".{}: {why}", case.name));
            if self.cases[..k].iter().any(|other| other.name == case.name) {
                return refuse("it is there twice".to_owned());
            }
            if case.fields.len() > 1 && case.nested().is_some() {
                return refuse("an enum is the only field of its case".to_owned());
            }
            for (k, field) in case.fields.iter().enumerate() {
                if case.fields[..k].iter().any(|other| other.name == field.name) {
                    return refuse(format!("field {} is there twice", field.name));
                }
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

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: &str = r#"
        [Kind]
        meaning = "x"
        texts = "kind"

        [[Kind.cases]]
        name = "One"
        meaning = "x"
        text.en = "one of {many:int}"
        fields = [{ name = "many", kind = "count", meaning = "x", example = 3 }]

        [[Kind.cases]]
        name = "Two"
        meaning = "x"
        fields = [{ name = "other", kind = "Other", meaning = "x" }]

        [Other]
        meaning = "x"

        [[Other.cases]]
        name = "Only"
        meaning = "x"
    "#;

    fn refused(was: &str, is: &str) -> String {
        assert!(TABLE.contains(was), "{was}");
        read(&TABLE.replace(was, is)).expect_err(is)
    }

    #[test]
    fn a_table_is_read_in_its_order() {
        let enums = read(TABLE).unwrap();
        assert_eq!(enums.iter().map(|one| one.name.as_str()).collect::<Vec<_>>(), ["Kind", "Other"]);
        assert_eq!(enums[0].cases[1].nested().map(|field| field.kind.as_str()), Some("Other"));
        assert!(enums[0].cases[0].nested().is_none());
    }

    #[test]
    fn what_the_languages_cannot_be_made_from_is_refused_by_name() {
        assert_eq!(refused("\"Two\"", "\"One\""), "bindings/status.toml: Kind.One: it is there twice");
        assert!(refused("\"count\"", "\"number\"").contains("field many has the kind number"));
        assert!(refused(", example = 3", "").contains("field many has no example"));
        assert!(refused("text.en", "text.de").contains("Kind.One: it has no text.en"));
        assert!(
            refused(
                "meaning = \"x\" }]",
                "meaning = \"x\" }, { name = \"a\", kind = \"count\", meaning = \"x\", example = 1 }]"
            )
            .contains("only field")
        );
        let again = "example = 3 }, { name = \"many\", kind = \"count\", meaning = \"x\", example = 3 }";
        assert!(refused("example = 3 }", again).contains("field many is there twice"));
        let many = |kind: &str, n: usize| {
            let field = |k| format!("{{ name = \"a{k}\", kind = \"{kind}\", meaning = \"x\", example = 1 }}");
            let fields = (0..n).map(field).collect::<Vec<_>>().join(", ");
            TABLE.replace("{ name = \"many\", kind = \"count\", meaning = \"x\", example = 3 }", &fields)
        };
        for (kind, most) in [("time", 2), ("axis", 2), ("real", 3), ("signed_axis", 3)] {
            assert!(read(&many(kind, most)).is_ok(), "{kind}");
            assert!(read(&many(kind, most + 1)).unwrap_err().contains("two whole numbers and three others"), "{kind}");
        }
        assert!(refused("texts = \"kind\"", "text = \"kind\"").contains("unknown field `text`"));
    }
}
