//! The table as templates ask for it: every name in every spelling, and where a field lies on the wire.

use crate::names::{camel, snake};
use crate::table::{Case, Enum, Field, as_rust};
use crate::texts::placeholders;
use serde::Serialize;
use std::collections::BTreeMap;

#[derive(Clone, Serialize)]
pub struct EnumView {
    pub name: String,
    meaning: String,
    core: String,
    c: Option<String>,
    /// In Kotlin and in Swift.
    app: String,
    snake: String,
    camel: String,
    /// `reject reason`.
    words: String,
    has_fields: bool,
    has_reals: bool,
    has_texts: bool,
    /// Whether the core has a text for it.
    says: bool,
    default: Option<String>,
    grows: bool,
    cases: Vec<CaseView>,
}

#[derive(Clone, Serialize)]
pub struct CaseView {
    name: String,
    snake: String,
    camel: String,
    screaming: String,
    code: i32,
    c: Option<i32>,
    meaning: String,
    /// The meaning, and the hint for developers.
    document: String,
    developers: Option<String>,
    remedy: Option<String>,
    guidance: Option<String>,
    heading: Option<String>,
    fields: Vec<FieldView>,
    /// The field that is an enum of the table.
    nested: Option<FieldView>,
    /// The status that has it as its reason.
    under: Option<String>,
    /// What the core says, as Rust formats it; of an event without how long it took.
    says: Option<String>,
    /// Whether that names the axes of its fields as one types them.
    has_axes: bool,
    /// Name of its text; none where its field says it all.
    text: Option<String>,
    /// What the text's placeholders stand for, in their order.
    told: Vec<FieldView>,
}

#[derive(Clone, Serialize)]
pub struct FieldView {
    name: String,
    camel: String,
    kind: String,
    meaning: String,
    example: String,
    /// Which of the whole numbers or reals of a status it is.
    place: usize,
}

/// The enums in the table's order. `renamed`: their names in Kotlin and Swift.
pub fn enums(table: &[Enum], renamed: &BTreeMap<String, String>) -> Result<Vec<EnumView>, String> {
    let mut views = table.iter().map(|one| EnumView::of(one, renamed)).collect::<Result<Vec<_>, String>>()?;
    for status in table.iter().filter(|one| one.name == "Status").flat_map(|one| &one.cases) {
        let Some(why) = status.nested() else { continue };
        for case in views.iter_mut().filter(|one| one.name == why.kind).flat_map(|one| &mut one.cases) {
            case.under = Some(status.name.clone());
        }
    }
    Ok(views)
}

impl EnumView {
    fn of(one: &Enum, renamed: &BTreeMap<String, String>) -> Result<Self, String> {
        let cases: Result<Vec<_>, String> = one.cases.iter().map(|case| CaseView::of(one, case)).collect();
        let fields = || one.cases.iter().flat_map(|case| &case.fields);
        Ok(Self {
            name: one.name.clone(),
            meaning: one.meaning.clone(),
            core: one.core.clone().unwrap_or_else(|| one.name.clone()),
            c: one.c.clone(),
            app: renamed.get(&one.name).cloned().unwrap_or_else(|| one.name.clone()),
            snake: snake(&one.name),
            camel: camel(&one.name),
            words: snake(&one.name).replace('_', " "),
            has_fields: fields().next().is_some(),
            has_reals: fields().any(is_real),
            has_texts: one.texts.is_some(),
            says: one.cases.iter().any(|case| !case.text.is_empty()),
            default: one.default.clone(),
            grows: one.grows,
            cases: cases?,
        })
    }
}

fn document(case: &Case) -> String {
    let Some(hint) = &case.developers else { return case.meaning.clone() };
    let end = if hint.ends_with('?') { "" } else { "." };
    format!("{} {}{}{end}", case.meaning, hint[..1].to_uppercase(), &hint[1..])
}

/// A text as the core formats it. An enum that stands alone says what it holds; an event's own text ends before how long it took.
fn says(one: &Enum, case: &Case) -> Option<String> {
    let says_any = one.cases.iter().any(|case| !case.text.is_empty());
    let Some(text) = case.text.get("en") else { return case.nested().filter(|_| says_any).map(|_| "{0}".to_owned()) };
    let mut said =
        text.strip_suffix(" in {took_s:.1} s").unwrap_or(text).replace(":int}", "}").replace("{axes:text}", "{}");
    if let Some(nested) = case.nested() {
        said = said.replace(&format!("{{{}:text}}", nested.name), "{0}");
    }
    Some(said.replace(":text}", "}"))
}

fn is_real(field: &Field) -> bool {
    ["real", "signed_axis"].contains(&field.kind.as_str())
}

impl CaseView {
    fn of(one: &Enum, case: &Case) -> Result<Self, String> {
        let fields: Vec<FieldView> = (0..case.fields.len()).map(|k| FieldView::of(&case.fields, k)).collect();
        let english = case.text.get("en");
        let asked = english.map_or_else(Vec::new, |text| placeholders(text));
        let told: Result<Vec<FieldView>, String> = asked
            .into_iter()
            .map(|placeholder| {
                // what no field is: the axes as one types them, and how long an event took
                let own = |name: &str, kind: &str| {
                    let (name, kind, camel) = (name.to_owned(), kind.to_owned(), camel(name));
                    FieldView { name, camel, kind, meaning: String::new(), example: String::new(), place: 0 }
                };
                if let Some(field) = fields.iter().find(|field| field.name == placeholder.name) {
                    return Ok(field.clone());
                }
                match placeholder.name.as_str() {
                    "axes" if fields.len() == 3 && fields.iter().all(|field| field.kind == "signed_axis") => {
                        Ok(own("axes", "axes"))
                    }
                    "took_s" if one.name == "EventKind" => Ok(own("took_s", "took")),
                    name => Err(format!(
                        "bindings/status.toml: {}.{}: its text asks for {name}, and it has no such field",
                        one.name, case.name
                    )),
                }
            })
            .collect();
        Ok(Self {
            name: case.name.clone(),
            snake: snake(&case.name),
            camel: camel(&case.name),
            screaming: snake(&case.name).to_uppercase(),
            code: case.code,
            c: case.c,
            meaning: case.meaning.clone(),
            document: document(case),
            developers: case.developers.clone(),
            remedy: case.remedy.clone(),
            guidance: case.guidance.clone(),
            heading: case.heading.clone(),
            nested: case.nested().and_then(|nested| fields.iter().find(|field| field.name == nested.name).cloned()),
            text: one
                .texts
                .as_ref()
                .filter(|_| english.is_some())
                .map(|begins| format!("{begins}_{}", snake(&case.name))),
            under: None,
            says: says(one, case),
            has_axes: english.is_some_and(|text| text.contains("{axes:text}")),
            told: told?,
            fields,
        })
    }
}

impl FieldView {
    fn of(fields: &[Field], k: usize) -> Self {
        let field = &fields[k];
        let example = match &field.example {
            Some(toml::Value::String(case)) => format!("Axis::{case}"),
            other => other.as_ref().map_or_else(String::new, as_rust),
        };
        Self {
            name: field.name.clone(),
            camel: camel(&field.name),
            kind: field.kind.clone(),
            meaning: field.meaning.clone(),
            example,
            place: fields[..k].iter().filter(|before| is_real(before) == is_real(field)).count(),
        }
    }
}
