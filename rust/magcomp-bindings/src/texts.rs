//! What the library says to its users, in every language: the table's texts, then those of `bindings/texts`, as Android's string resources and Swift's
//! `Localizable.strings`.

use crate::names::snake;
use crate::table::Enum;
use std::collections::BTreeMap;

/// What stands at the head of what is made.
const MADE: &str = "made by bindings/generate.sh from bindings/status.toml and bindings/texts";

/// A text by its name, in the languages that have it.
pub struct Text {
    pub name: String,
    pub languages: BTreeMap<String, String>,
}

/// A placeholder `{name:kind}`: `text`, `int`, or a number with so many decimals such as `.1`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Placeholder {
    pub name: String,
    pub kind: String,
}

/// The parts of a text: what stands between placeholders, and these.
fn parts(text: &str) -> Result<(Vec<&str>, Vec<Placeholder>), String> {
    let (mut between, mut found, mut rest) = (Vec::new(), Vec::<Placeholder>::new(), text);
    while let Some((before, after)) = rest.split_once('{') {
        let (inside, after) = after.split_once('}').ok_or("a brace that is no placeholder")?;
        let (name, kind) =
            inside.split_once(':').ok_or_else(|| format!("{{{inside}}} has no kind, as {{name:int}}"))?;
        let is_number = kind.len() == 2 && kind.starts_with('.') && kind.as_bytes()[1].is_ascii_digit();
        let is_name = !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        if !is_name || !(is_number || kind == "text" || kind == "int") {
            return Err(format!("{{{inside}}} is no placeholder, expected {{name:text}}, {{name:int}} or {{name:.1}}"));
        }
        if found.iter().any(|other| other.name == name) {
            return Err(format!("{{{name}}} is there twice"));
        }
        found.push(Placeholder { name: name.to_owned(), kind: kind.to_owned() });
        between.push(before);
        rest = after;
    }
    between.push(rest);
    if between.iter().any(|part| part.contains(['{', '}'])) {
        return Err("a brace that is no placeholder".to_owned());
    }
    // each would need care in one of the formats
    if text.contains(['%', '\\', '"', '\n']) || text.trim() != text || text.is_empty() {
        return Err("a % sign, a backslash, a quote, a line's end, a space at an end or no text at all".to_owned());
    }
    Ok((between, found))
}

/// The placeholders of a text that `read` has let pass.
pub fn placeholders(text: &str) -> Vec<Placeholder> {
    parts(text).expect("it was read").1
}

/// Those of the table, then those of the files: name of the language, content.
pub fn read(enums: &[Enum], files: &[(String, String)]) -> Result<Vec<Text>, String> {
    let mut all: Vec<Text> = Vec::new();
    for one in enums {
        let Some(begins) = &one.texts else { continue };
        let told = one.cases.iter().filter(|case| !case.text.is_empty());
        all.extend(
            told.map(|case| Text { name: format!("{begins}_{}", snake(&case.name)), languages: case.text.clone() }),
        );
    }
    let of_table = all.len();
    // English says which there are, and in which order
    let english_first =
        files.iter().filter(|(code, _)| code == "en").chain(files.iter().filter(|(code, _)| code != "en"));
    for (language, content) in english_first {
        for (number, line) in content.lines().enumerate() {
            let place = format!("bindings/texts/{language}.txt:{}", number + 1);
            if line.starts_with('#') || line.trim().is_empty() {
                continue;
            }
            let (name, text) = line.split_once(" = ").ok_or_else(|| format!("{place}: expected `name = text`"))?;
            let is_name = name.chars().all(|c| c.is_ascii_lowercase() || c == '_');
            let known = all.iter().position(|it| it.name == name);
            if !is_name || known.is_some_and(|k| k < of_table) {
                return Err(format!("{place}: {name} is no name, or one of bindings/status.toml"));
            }
            let known = match known {
                None if language == "en" => {
                    all.push(Text { name: name.to_owned(), languages: BTreeMap::new() });
                    all.len() - 1
                }
                None => return Err(format!("{place}: {name} is not in en.txt")),
                Some(k) => k,
            };
            if all[known].languages.insert(language.clone(), text.to_owned()).is_some() {
                return Err(format!("{place}: {name} is there twice"));
            }
        }
    }
    for text in &all {
        let sorted = |language: &str| -> Result<Vec<Placeholder>, String> {
            let mut found = parts(&text.languages[language])
                .map_err(|why| format!("the text {} of {language}: {why}", text.name))?
                .1;
            found.sort_by(|a, b| a.name.cmp(&b.name));
            Ok(found)
        };
        if !text.languages.contains_key("en") {
            return Err(format!("the text {} is not there in English", text.name));
        }
        let english = sorted("en")?;
        for language in text.languages.keys() {
            let theirs = sorted(language)?;
            if theirs != english {
                let named = |all: &[Placeholder]| {
                    all.iter().map(|it| format!("{{{}:{}}}", it.name, it.kind)).collect::<Vec<_>>().join(" ")
                };
                return Err(format!(
                    "the text {} of {language} has the placeholders '{}', and English '{}'",
                    text.name,
                    named(&theirs),
                    named(&english)
                ));
            }
        }
    }
    Ok(all)
}

impl Text {
    fn english(&self) -> &str {
        &self.languages["en"]
    }

    /// With the placeholders of `printf`, numbered as English has them.
    fn formatted(&self, language: &str, text_kind: &str, int_kind: &str) -> String {
        let order = placeholders(self.english());
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
pub fn files(texts: &[Text], languages: &[String]) -> Vec<(String, String)> {
    let mut made = Vec::new();
    for language in languages {
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

    fn file(language: &str, content: &str) -> (String, String) {
        (language.to_owned(), content.to_owned())
    }

    fn refused(files: &[(String, String)]) -> String {
        read(&[], files).err().expect("a refusal")
    }

    #[test]
    fn a_translation_counts_its_placeholders_as_english_does() {
        let files = [
            file("de", "so = von {need:int} erst {have:int} <'>\n"),
            file("en", "# x\n\nso = {have:int} of {need:int}\n"),
        ];
        let texts = read(&[], &files).unwrap();
        assert_eq!(texts[0].formatted("de", "@", "lld"), "von %2$lld erst %1$lld <'>");
        let made = super::files(&texts, &["de".to_owned(), "pt-BR".to_owned()]);
        let content =
            |path: &str| made.iter().find(|(its, _)| its.ends_with(path)).map(|(_, content)| content.as_str()).unwrap();
        assert!(
            content("values-de/strings.xml")
                .contains("<string name=\"magcomp_so\">von %2$d erst %1$d &lt;\\'></string>")
        );
        // what a language leaves out: nothing on Android, English on Apple's systems
        assert!(!content("values-pt-rBR/strings.xml").contains("magcomp_so"));
        assert!(content("pt-BR.lproj/Localizable.strings").contains("\"so\" = \"%1$lld of %2$lld\";"));
    }

    #[test]
    fn what_cannot_be_a_text_is_refused() {
        assert!(refused(&[file("en", "so = {have:int} {have:int}\n")]).contains("twice"));
        assert!(refused(&[file("en", "so = {have:char}\n")]).contains("no placeholder"));
        assert!(refused(&[file("en", "so = {have}\n")]).contains("no kind"));
        assert!(refused(&[file("en", "so = a } b\n")]).contains("brace"));
        assert!(refused(&[file("en", "so = a { b\n")]).contains("brace"));
        assert!(refused(&[file("en", "so = 5 % of\n")]).contains("% sign"));
        assert!(refused(&[file("en", "so = x\nso = y\n")]).contains("twice"));
        assert!(refused(&[file("en", "so: x\n")]).contains("en.txt:1: expected"));
        assert!(refused(&[file("en", "so = x\n"), file("de", "wo = y\n")]).contains("de.txt:1: wo is not in en.txt"));
        assert!(
            refused(&[file("en", "so = {a:int}\n"), file("de", "so = {a:.1}\n")])
                .ends_with("de has the placeholders '{a:.1}', and English '{a:int}'")
        );
    }
}
