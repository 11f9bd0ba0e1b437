//! The files that are made: their paths in the repository and what stands in them.

use crate::names::{camel, snake};
use crate::{config, reading, table, texts};
use minijinja::syntax::SyntaxConfig;
use minijinja::value::Serde;
use minijinja::{AutoEscape, Environment, UndefinedBehavior, Value};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// A file by its path in the repository.
pub type File = (String, String);

/// Files that are a template's, by the template's name in `bindings/templates`.
const WHOLE: &[(&str, &str)] = &[
    ("core.rs", "rust/magcomp/src/status.rs"),
    ("status.rs", "rust/magcomp-ffi/src/status.rs"),
    ("reading.rs", "rust/magcomp-ffi/src/reading.rs"),
    ("slots.rs", "rust/magcomp-ffi/src/fast/slots.rs"),
    ("config_core.rs", "rust/magcomp/src/config.rs"),
    ("config.rs", "rust/magcomp-ffi/src/config/records.rs"),
    ("config_c.rs", "c/src/settings.rs"),
    ("settings.py", "python/magcomp/_settings.py"),
    ("Builders.kt", "android/library/src/main/kotlin/org/magcomp/core/Builders.kt"),
    ("magcomp.h", "rust/magcomp-ffi/include/magcomp.h"),
    ("status_c.rs", "c/src/status.rs"),
    ("ReadingBuffer.kt", "android/library/src/main/kotlin/org/magcomp/core/ReadingBuffer.kt"),
    ("StatusTexts.kt", "android/library/src/main/kotlin/org/magcomp/StatusTexts.kt"),
    ("FastReading.swift", "ios/Sources/Magcomp/FastReading.swift"),
    ("status.py", "python/magcomp/_status.py"),
    ("StatusTexts.swift", "ios/Sources/Magcomp/StatusTexts.swift"),
];

/// Pages of which a part is a template's. The part stands between a line that names the template and one that ends it.
const PARTS: &[(&str, &[&str])] = &[
    ("docs/STATUS.md", &["statuses", "reasons", "events"]),
    ("ios/Sources/Magcomp/Magcomp.docc/WhatTheStatusMeans.md", &["statuses_docc"]),
];

/// All that a template may ask for.
#[derive(Serialize)]
struct Values {
    enums: Vec<table::Enum>,
    /// The same by their names.
    by_name: BTreeMap<String, table::Enum>,
    reading: reading::Layout,
    /// What settings choose from.
    choices: Vec<table::Enum>,
    settings: Vec<config::Group>,
    members: Vec<config::Field>,
}

/// Folders in which there is nothing but what is made here.
const FOLDERS: [&str; 2] = ["android/library/src/main/res", "ios/Sources/Magcomp/Resources"];

fn content(root: &Path, path: &str) -> Result<String, String> {
    fs::read_to_string(root.join(path)).map_err(|error| format!("{path}: {error}"))
}

/// All that is made of the tables in this repository.
pub fn files(root: &Path) -> Result<Vec<File>, String> {
    let renamed = names(root, &["bindings", "kotlin", "rename"])?;
    let nested = names(root, &["swift", "nested"])?;
    let mut enums = table::read(&content(root, "bindings/status.toml")?)?;
    let config::Settings { choices, groups: settings, members } =
        config::read(&content(root, "bindings/config.toml")?)?;
    let reading = reading::read(&content(root, "bindings/reading.toml")?, &enums)?;
    let all = texts::read(&enums, &content(root, "bindings/texts.toml")?)?;
    for case in enums.iter_mut().flat_map(|one| &mut one.cases) {
        let Some(name) = &case.guidance else { continue };
        let text = all.iter().find(|text| text.name == *name).ok_or_else(|| {
            format!(
                "bindings/status.toml: {} has the guidance {name}, which bindings/texts.toml does not have",
                case.name
            )
        })?;
        case.remedy.get_or_insert_with(|| text.as_a_clause());
    }
    let mut made = texts::files(&all);
    let by_name = enums.iter().chain(&choices).map(|one| (one.name.clone(), one.clone())).collect();
    let values = Value::from(Serde(Values { enums, by_name, reading, choices, settings, members }));
    let mut environment = Environment::new();
    let syntax = SyntaxConfig::builder().trim_blocks(true).lstrip_blocks(true).keep_trailing_newline(true).build();
    environment.set_syntax(syntax.expect("the usual delimiters"));
    environment.set_undefined_behavior(UndefinedBehavior::Strict);
    environment.set_auto_escape_callback(|_| AutoEscape::None);
    environment.add_filter("snake", |name: &str| snake(name));
    environment.add_filter("camel", |name: &str| camel(name));
    let app = move |name: &str| renamed.get(name).map_or(name, String::as_str).to_owned();
    environment.add_filter("app", app.clone());
    // as `app`, but for a type that Swift puts into another one
    environment.add_filter("swift", move |name: &str| {
        let name = app(name);
        nested.get(&name).cloned().unwrap_or(name)
    });
    let rendered = |template: &str| -> Result<String, String> {
        let source = content(root, &format!("bindings/templates/{template}"))?;
        environment
            .render_named_str(template, &source, values.clone())
            .map_err(|error| format!("bindings/templates/{template}: {error:#}"))
    };
    for (template, path) in WHOLE {
        made.push(((*path).to_owned(), rendered(template)?));
    }
    for (path, templates) in PARTS {
        let mut page = content(root, path)?;
        for template in *templates {
            page = with_part(&page, template, &rendered(&format!("{template}.md"))?)
                .map_err(|why| format!("{path}{why}"))?;
        }
        made.push(((*path).to_owned(), page));
    }
    Ok(made)
}

/// A page whose part of this name is another one.
fn with_part(page: &str, name: &str, part: &str) -> Result<String, String> {
    let begins = format!("<!-- made by bindings/generate.sh from bindings/status.toml: {name} -->\n");
    let missing = |what: &str| format!(" has no line `{}`", what.trim_end());
    let (before, rest) = page.split_once(&begins).ok_or_else(|| missing(&begins))?;
    let (_, after) = rest.split_once("<!-- end -->\n").ok_or_else(|| missing("<!-- end -->"))?;
    Ok(format!("{before}{begins}{part}<!-- end -->\n{after}"))
}

/// Names that uniffi gives in Kotlin and Swift, which have the same, or where Swift puts some of these: a table of uniffi's settings.
fn names(root: &Path, table: &[&str]) -> Result<BTreeMap<String, String>, String> {
    let path = "rust/magcomp-ffi/uniffi.toml";
    let settings: toml::Table = content(root, path)?.parse().map_err(|error| format!("{path}: {error}"))?;
    let found = table.iter().try_fold(&settings, |found, name| found.get(*name)?.as_table());
    let names = found.ok_or_else(|| format!("{path} has no [{}]", table.join(".")))?;
    Ok(names.iter().filter_map(|(name, to)| Some((name.clone(), to.as_str()?.to_owned()))).collect())
}

/// Paths of all files in a folder and the folders in it, sorted.
fn below(root: &Path, folder: &str) -> Result<BTreeSet<String>, String> {
    let mut found = BTreeSet::new();
    for entry in fs::read_dir(root.join(folder)).map_err(|error| format!("{folder}: {error}"))? {
        let entry = entry.map_err(|error| format!("{folder}: {error}"))?;
        let path = format!("{folder}/{}", entry.file_name().to_string_lossy());
        if entry.path().is_dir() { found.extend(below(root, &path)?) } else { _ = found.insert(path) }
    }
    Ok(found)
}

/// Writes the files, and removes those of [`FOLDERS`] that are made no more; with `is_check` it names the first that is not as it would be.
pub fn kept(root: &Path, files: &[File], is_check: bool) -> Result<(), String> {
    let stale = |path: &str| format!("{path} is not what the tables make; run bindings/generate.sh and commit");
    for (path, text) in files {
        if content(root, path).is_ok_and(|found| found == *text) {
            continue;
        }
        if is_check {
            return Err(stale(path));
        }
        let file = root.join(path);
        let folder = file.parent().expect("a folder");
        fs::create_dir_all(folder).and_then(|()| fs::write(&file, text)).map_err(|error| format!("{path}: {error}"))?;
    }
    for folder in FOLDERS {
        for path in below(root, folder)?.into_iter().filter(|path| files.iter().all(|(made, _)| made != path)) {
            if is_check {
                return Err(stale(&path));
            }
            fs::remove_file(root.join(&path)).map_err(|error| format!("{path}: {error}"))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_of_a_page_is_replaced_and_nothing_else() {
        let page = "a\n<!-- made by bindings/generate.sh from bindings/status.toml: b -->\nold\n<!-- end -->\nc\n";
        assert_eq!(with_part(page, "b", "new\n").unwrap(), page.replace("old", "new"));
        assert!(with_part(page, "c", "").unwrap_err().contains("no line `<!-- made"));
        assert!(with_part(&page.replace("<!-- end -->", ""), "b", "").unwrap_err().contains("no line `<!-- end -->`"));
    }

    #[test]
    fn the_repository_has_what_the_tables_make() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let files = files(&root).unwrap();
        assert!(files.len() > WHOLE.len() + 6, "{}", files.len());
        kept(&root, &files, true).unwrap();
    }
}
