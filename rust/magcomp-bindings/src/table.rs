//! `bindings/status.toml`: every enum that says what the library is doing, its cases, and what each says in every language, as templates ask for it. What
//! serde skips follows from the rest.

use crate::names::snake;
use crate::placeholders::placeholders;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Kinds of fields that are no enum of the table.
const PLAIN_KINDS: [&str; 5] = ["count", "time", "real", "axis", "signed_axis"];

/// An enum of the border.
#[derive(Clone, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Enum {
    #[serde(skip_deserializing)]
    pub name: String,
    pub meaning: String,
    /// Its name in the core.
    #[serde(default)]
    pub core: String,
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
#[derive(Clone, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Case {
    pub name: String,
    /// On the wire: as uniffi does, by the order of the cases.
    #[serde(skip_deserializing)]
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
    /// The meaning, and the hint for developers.
    #[serde(skip_deserializing)]
    document: String,
    /// The enum that is all the case carries.
    #[serde(skip_deserializing)]
    nested: Option<Field>,
    /// The status that has it as its reason.
    #[serde(skip_deserializing)]
    under: Option<String>,
    /// What the core says, as Rust formats it; of an event without how long it took.
    #[serde(skip_deserializing)]
    says: Option<String>,
    /// Name of its text; none where its field says it all.
    #[serde(skip_deserializing)]
    pub key: Option<String>,
    /// What the text's placeholders stand for, in their order.
    #[serde(skip_deserializing)]
    told: Vec<Field>,
}

/// What a case carries.
#[derive(Clone, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Field {
    pub name: String,
    pub kind: String,
    pub meaning: String,
    /// Which of the whole numbers or reals of a status it is.
    #[serde(skip_deserializing)]
    place: usize,
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
        enums.push(one);
    }
    let names: Vec<String> = enums.iter().map(|one| one.name.clone()).collect();
    for one in &mut enums {
        one.complete(&names).map_err(|why| format!("{file}: {}{why}", one.name))?;
    }
    let statuses =
        enums.iter().filter(|one| one.name == "Status").flat_map(|one| one.cases.clone()).collect::<Vec<_>>();
    for (status, why) in statuses.iter().filter_map(|status| status.nested.as_ref().map(|why| (status, why))) {
        for case in enums.iter_mut().filter(|one| one.name == why.kind).flat_map(|one| &mut one.cases) {
            case.under = Some(status.name.clone());
        }
    }
    Ok(enums)
}

impl Enum {
    /// Checks it, and fills in what follows.
    fn complete(&mut self, all: &[String]) -> Result<(), String> {
        if self.core.is_empty() {
            self.core.clone_from(&self.name);
        }
        let says_any = self.cases.iter().any(|case| !case.text.is_empty());
        for k in 0..self.cases.len() {
            let (before, rest) = self.cases.split_at_mut(k);
            let case = &mut rest[0];
            case.code = self.first + k as i32;
            if before.iter().any(|other| other.name == case.name) {
                return Err(format!(".{}: it is there twice", case.name));
            }
            case.complete(self.texts.as_deref(), says_any, all).map_err(|why| format!(".{}: {why}", case.name))?;
        }
        Ok(())
    }
}

fn is_real(field: &Field) -> bool {
    ["real", "signed_axis"].contains(&field.kind.as_str())
}

impl Case {
    fn complete(&mut self, texts: Option<&str>, says_any: bool, all: &[String]) -> Result<(), String> {
        self.nested = self.fields.iter().find(|field| !PLAIN_KINDS.contains(&field.kind.as_str())).cloned();
        if let Some(nested) = &self.nested {
            if self.fields.len() > 1 {
                return Err("an enum is the only field of its case".to_owned());
            }
            if !all.contains(&nested.kind) {
                let (name, kind) = (&nested.name, &nested.kind);
                return Err(format!(
                    "field {name} has the kind {kind}, expected {PLAIN_KINDS:?} or an enum of the table"
                ));
            }
        }
        let (mut wholes, mut reals) = (0, 0);
        for k in 0..self.fields.len() {
            let (before, rest) = self.fields.split_at_mut(k);
            if before.iter().any(|other| other.name == rest[0].name) {
                return Err(format!("field {} is there twice", rest[0].name));
            }
            let count = if is_real(&rest[0]) { &mut reals } else { &mut wholes };
            rest[0].place = *count;
            *count += 1;
        }
        if wholes > 2 || reals > 3 {
            return Err("the border carries two whole numbers and three others".to_owned());
        }
        self.document = self.developers.as_ref().map_or_else(
            || self.meaning.clone(),
            |hint| {
                format!(
                    "{} {}{}{}",
                    self.meaning,
                    hint[..1].to_uppercase(),
                    &hint[1..],
                    if hint.ends_with('?') { "" } else { "." }
                )
            },
        );
        let Some(english) = self.text.get("en") else {
            self.says = self.nested.as_ref().filter(|_| says_any).map(|_| "{0}".to_owned());
            let lacks = texts.is_some() && self.nested.is_none();
            return if lacks { Err("it has no text.en".to_owned()) } else { Ok(()) };
        };
        // an event's own text ends before how long it took
        let said = english.strip_suffix(" in {took_s:.1} s").unwrap_or(english);
        let said = said.replace(":int}", "}").replace("{axes:text}", "{}");
        let nested = self.nested.as_ref().map_or_else(String::new, |nested| format!("{{{}:text}}", nested.name));
        self.says = Some(if nested.is_empty() { said } else { said.replace(&nested, "{0}") }.replace(":text}", "}"));
        self.key = texts.map(|begins| format!("{begins}_{}", snake(&self.name)));
        for placeholder in placeholders(english)? {
            let name = placeholder.name;
            // what no field is: the axes as one types them, and how long an event took
            let own = || Field { kind: name.clone(), name: name.clone(), meaning: String::new(), place: 0 };
            let its = self.fields.iter().find(|field| field.name == name).cloned();
            let is_own = name == "took_s" || name == "axes" && self.fields.len() == 3;
            let its = its.or_else(|| is_own.then(own));
            self.told.push(its.ok_or_else(|| format!("its text asks for {name}, and it has no such field"))?);
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
        fields = [{ name = "many", kind = "count", meaning = "x" }]

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

    fn why(table: &str) -> String {
        read(table).err().unwrap_or_default()
    }

    #[test]
    fn a_table_is_read_in_its_order_and_completed() {
        let enums = read(TABLE).unwrap();
        assert_eq!(enums.iter().map(|one| one.name.as_str()).collect::<Vec<_>>(), ["Kind", "Other"]);
        let [one, two] = &enums[0].cases[..] else { panic!("two cases") };
        assert_eq!((one.code, one.key.as_deref(), one.says.as_deref()), (0, Some("kind_one"), Some("one of {many}")));
        assert!((one.nested.is_none(), two.code, two.says.as_deref()) == (true, 1, Some("{0}")));
        assert_eq!(two.nested.as_ref().map(|field| field.kind.as_str()), Some("Other"));
    }

    #[test]
    fn what_the_languages_cannot_be_made_from_is_refused_by_name() {
        let field = "{ name = \"many\", kind = \"count\", meaning = \"x\" }";
        for (was, is, says) in [
            ("\"Two\"", "\"One\"", "Kind.One: it is there twice"),
            ("\"count\"", "\"number\"", "Kind.One: field many has the kind number"),
            ("text.en", "text.de", "Kind.One: it has no text.en"),
            ("many:int", "much:int", "Kind.One: its text asks for much"),
            (field, &format!("{field}, {field}"), "Kind.One: field many is there twice"),
            ("\"Other\", meaning = \"x\" }", &format!("\"Other\", meaning = \"x\" }}, {field}"), "only field"),
            ("texts = \"kind\"", "text = \"kind\"", "unknown field `text`"),
        ] {
            let why = why(&TABLE.replace(was, is));
            assert!(why.starts_with("bindings/status.toml: Kind") && why.contains(says), "{was}: {why}");
        }
        for (kind, most) in [("time", 2), ("axis", 2), ("real", 3), ("signed_axis", 3)] {
            let many = |n: usize| {
                let more = (1..n).map(|k| format!("{{ name = \"a{k}\", kind = \"{kind}\", meaning = \"x\" }}"));
                let first = field.replace("count", kind);
                why(&TABLE.replace(field, &more.fold(first, |all, one| format!("{all}, {one}"))))
            };
            assert_eq!(many(most), "", "{kind}");
            assert!(many(most + 1).contains("two whole numbers and three others"), "{kind}");
        }
    }
}
