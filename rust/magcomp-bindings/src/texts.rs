//! What the library says to its users, in every language: the statuses' texts, then those of `bindings/texts.toml`, as Android's string resources and
//! Swift's `Localizable.strings`.

use crate::placeholders::{Placeholder, parts, placeholders};
use crate::table::Enum;
use std::collections::{BTreeMap, BTreeSet};

/// What stands at the head of what is made.
const MADE: &str = "made by bindings/generate.sh from bindings/status.toml and bindings/texts.toml";

/// A text by its name, in the languages that have it.
pub struct Text {
    pub name: String,
    pub languages: BTreeMap<String, String>,
}

/// The texts of the enums, then those of the file.
pub fn read(enums: &[Enum], text: &str) -> Result<Vec<Text>, String> {
    let file: toml::Table = text.parse().map_err(|error| format!("bindings/texts.toml: {error}"))?;
    let mut all: Vec<Text> = Vec::new();
    for case in enums.iter().flat_map(|one| &one.cases) {
        all.extend(case.key.as_ref().map(|name| Text { name: name.clone(), languages: case.text.clone() }));
    }
    for (name, languages) in file {
        let languages = languages.try_into().map_err(|error| format!("bindings/texts.toml: {name}: {error}"))?;
        all.push(Text { name, languages });
    }
    for (k, text) in all.iter().enumerate() {
        let of = |language: &str| -> Result<Vec<Placeholder>, String> {
            let mut found =
                placeholders(text.languages.get(language).ok_or(format!("the text {} has no {language}", text.name))?)
                    .map_err(|why| format!("the text {} of {language}: {why}", text.name))?;
            found.sort_by(|a, b| a.name.cmp(&b.name));
            Ok(found)
        };
        let english = of("en")?;
        for language in text.languages.keys() {
            if of(language)? != english {
                return Err(format!("the text {} of {language} has other placeholders than English", text.name));
            }
        }
        if all[..k].iter().any(|other| other.name == text.name) {
            return Err(format!("the text {} is there twice", text.name));
        }
    }
    Ok(all)
}

impl Text {
    /// An English sentence, as it stands in another.
    pub fn as_a_clause(&self) -> String {
        let sentence = self.english().trim_end_matches('.');
        sentence[..1].to_lowercase() + &sentence[1..]
    }

    fn english(&self) -> &str {
        &self.languages["en"]
    }

    /// With the placeholders of `printf`, numbered as English has them.
    fn formatted(&self, language: &str, text_kind: &str, int_kind: &str) -> String {
        let order = placeholders(self.english()).expect("it was read");
        let (between, found) =
            parts(self.languages.get(language).map_or(self.english(), String::as_str)).expect("it was read");
        let mut made = between[0].to_owned();
        for (placeholder, after) in found.iter().zip(&between[1..]) {
            let number = 1 + order.iter().position(|it| it.name == placeholder.name).expect("English has it");
            let kind = match placeholder.kind.as_str() {
                "text" => text_kind.to_owned(),
                "int" => int_kind.to_owned(),
                decimals => format!("{decimals}f"),
            };
            made += &format!("%{number}${kind}{after}");
        }
        made
    }

    fn is_apples(&self) -> bool {
        self.name.starts_with("ios_")
    }

    fn is_androids(&self) -> bool {
        self.name.starts_with("android_")
    }

    fn android_name(&self) -> String {
        format!("magcomp_{}", self.name.strip_prefix("android_").unwrap_or(&self.name))
    }
}

fn android_escaped(text: &str) -> String {
    let escaped = text.replace('&', "&amp;").replace('<', "&lt;").replace('\'', "\\'");
    if escaped.starts_with(['@', '?']) { format!("\\{escaped}") } else { escaped }
}

/// The files that have the texts, by their paths in the repository.
pub fn files(texts: &[Text]) -> Vec<(String, String)> {
    let mut made = Vec::new();
    for language in texts.iter().flat_map(|text| text.languages.keys()).collect::<BTreeSet<_>>() {
        let (code, region) = language.split_once('-').unwrap_or((language, ""));
        let mut strings = format!("<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<!-- {MADE} -->\n<resources>\n");
        // Android looks in the English ones for a string that is left out, Apple's systems do not
        for text in texts.iter().filter(|text| !text.is_apples() && text.languages.contains_key(language)) {
            let value = android_escaped(&text.formatted(language, "s", "d"));
            strings += &format!("    <string name=\"{}\">{value}</string>\n", text.android_name());
        }
        strings += "</resources>\n";
        let values = match (code, region) {
            ("en", "") => "values".to_owned(),
            (_, "") => format!("values-{code}"),
            _ => format!("values-{code}-r{region}"),
        };
        made.push((format!("android/library/src/main/res/{values}/strings.xml"), strings));
        let mut strings = format!("/* {MADE} */\n");
        for text in texts.iter().filter(|text| !text.is_androids()) {
            strings += &format!("\"{}\" = \"{}\";\n", text.name, text.formatted(language, "@", "lld"));
        }
        made.push((format!("ios/Sources/Magcomp/Resources/{language}.lproj/Localizable.strings"), strings));
    }
    // the same in Swift, for an app that was copied without the package's bundle
    let mut swift = format!(
        "// swift-format-ignore-file\n// {MADE}\n\n/// The package's English `Localizable.strings`.\nlet englishTexts: [String: String] = [\n"
    );
    for text in texts.iter().filter(|text| !text.is_androids()) {
        swift += &format!("    \"{}\": \"{}\",\n", text.name, text.formatted("en", "@", "lld"));
    }
    made.push(("ios/Sources/Magcomp/EnglishTexts.swift".to_owned(), swift + "]\n"));
    // what Android's own tools make of the resources, for Maven's build, which has none of them
    let mut java = format!(
        "package org.magcomp;\n\n/** Stands in for the class that Android's tools make of the resources; {MADE}. No artifact has it. */\nfinal class R {{\n    static final class string {{\n"
    );
    let mut symbols = String::new();
    for (text, id) in texts.iter().filter(|text| !text.is_apples()).zip(0x7f0e_0000..) {
        java += &format!("        static int {} = {id:#x};\n", text.android_name());
        symbols += &format!("int string {} 0x0\n", text.android_name());
    }
    made.push(("android/library/src/maven/java/org/magcomp/R.java".to_owned(), java + "    }\n}\n"));
    made.push(("android/aar/src/main/aar/R.txt".to_owned(), symbols));
    made
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(file: &str) -> String {
        read(&[], file).err().expect("a refusal")
    }

    #[test]
    fn a_translation_counts_its_placeholders_as_english_does() {
        let texts = read(
            &[],
            "so.de = \"von {need:int} erst {have:int} <'>\"\nso.en = \"{have:int} of {need:int}\"\n[to]\nen = \"to\"\npt-BR = \"a\"",
        );
        let made = super::files(&texts.unwrap());
        let content =
            |path: &str| made.iter().find(|(its, _)| its.ends_with(path)).map(|(_, content)| content.as_str()).unwrap();
        assert!(content("de.lproj/Localizable.strings").contains("\"so\" = \"von %2$lld erst %1$lld <'>\";"));
        assert!(content("values-de/strings.xml").contains("\"magcomp_so\">von %2$d erst %1$d &lt;\\'></string>"));
        // what a language leaves out: nothing on Android, English on Apple's systems
        assert!(!content("values-pt-rBR/strings.xml").contains("magcomp_so"));
        assert!(content("pt-BR.lproj/Localizable.strings").contains("\"so\" = \"%1$lld of %2$lld\";"));
    }

    #[test]
    fn what_cannot_be_a_text_is_refused() {
        for (text, why) in [
            ("{have:int} {have:int}", "twice"),
            ("{have:char}", "no placeholder"),
            ("{have}", "no kind"),
            ("a } b", "brace"),
            ("a { b", "brace"),
            ("5 % of", "% sign"),
        ] {
            assert!(refused(&format!("so.en = \"{text}\"")).contains(why), "{text}");
        }
        assert!(refused("so.de = \"x\"").ends_with("so has no en"));
        assert!(
            refused("so.en = \"{a:int}\"\nso.de = \"{a:.1}\"")
                .ends_with("so of de has other placeholders than English")
        );
        assert!(refused("so = 3").contains("texts.toml: so: "));
    }
}
