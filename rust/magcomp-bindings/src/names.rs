//! One name in the spelling of each language.

/// `NotFinite` is `not_finite`.
pub fn snake(name: &str) -> String {
    let mut made = String::new();
    for (k, letter) in name.char_indices() {
        if letter.is_ascii_uppercase() && k > 0 {
            made.push('_');
        }
        made.push(letter.to_ascii_lowercase());
    }
    made
}

/// `limit_ut` is `limitUt`, `NotFinite` is `notFinite`.
pub fn camel(name: &str) -> String {
    let mut made = String::new();
    let mut is_start = false;
    for letter in name.chars() {
        match letter {
            '_' => is_start = true,
            _ if is_start => {
                made.push(letter.to_ascii_uppercase());
                is_start = false;
            }
            _ if made.is_empty() => made.push(letter.to_ascii_lowercase()),
            _ => made.push(letter),
        }
    }
    made
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_spelled_as_the_languages_do() {
        assert_eq!([snake("X"), snake("NotAnEllipsoid")], ["x", "not_an_ellipsoid"]);
        assert_eq!(
            [camel("NotAnEllipsoid"), camel("up_m_s2"), camel("since_ns")],
            ["notAnEllipsoid", "upMS2", "sinceNs"]
        );
    }
}
