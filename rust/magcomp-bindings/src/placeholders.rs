//! What a text leaves open.

/// A placeholder `{name:kind}`: `text`, `int`, or a number with so many decimals such as `.1`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Placeholder {
    pub name: String,
    pub kind: String,
}

/// The parts of a text: what stands between placeholders, and these.
pub fn parts(text: &str) -> Result<(Vec<&str>, Vec<Placeholder>), String> {
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

/// The placeholders of a text.
pub fn placeholders(text: &str) -> Result<Vec<Placeholder>, String> {
    Ok(parts(text)?.1)
}
