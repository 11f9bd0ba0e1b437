//! `bindings/codes.txt`: every code that was ever given. Codes are ABI, so a line of it never changes and never goes.

use crate::table::Enum;
use std::collections::BTreeMap;
use std::fmt::Write;

const HEAD: &str = "\
# Every code that a case of bindings/status.toml was ever given, on the border's wire and in C. bindings/generate.sh adds new ones, and refuses
# a case whose code is another one here, or one that another case had. A case that is gone keeps its line.
";

/// The page with the codes of these enums added, or what is refused.
pub fn updated(page: &str, enums: &[Enum]) -> Result<String, String> {
    let mut known: BTreeMap<(String, i32), String> = BTreeMap::new();
    for line in page.lines().filter(|line| !line.starts_with('#')) {
        let wrong = || format!("bindings/codes.txt: expected `PLACE ENUM CASE CODE`, found `{line}`");
        let [place, of, case, code] = line.split(' ').collect::<Vec<_>>().try_into().map_err(|_| wrong())?;
        let code = code.parse().map_err(|_| wrong())?;
        if let Some(other) = known.insert((format!("{place} {of}"), code), case.to_owned()) {
            return Err(format!("bindings/codes.txt: {place} {of} {code} is there twice, for {other} and for {case}"));
        }
    }
    for one in enums {
        for case in &one.cases {
            let border = Some((format!("border {}", one.name), case.code));
            let c = one.c.as_ref().zip(case.c).map(|(of, code)| (format!("c {of}"), code));
            for (place, code) in border.into_iter().chain(c) {
                let before = known.iter().find(|((its, _), name)| *its == place && **name == case.name);
                if let Some(((_, before), _)) = before
                    && *before != code
                {
                    return Err(format!(
                        "bindings/status.toml: {place} {} has the code {code}, and had {before}; codes are ABI and do not change",
                        case.name
                    ));
                }
                let name = known.entry((place.clone(), code)).or_insert_with(|| case.name.clone());
                if *name != case.name {
                    return Err(format!(
                        "bindings/status.toml: {place} {} has the code {code}, which {name} has or had; take one that is free",
                        case.name
                    ));
                }
            }
        }
    }
    let mut page = HEAD.to_owned();
    for ((place, code), case) in &known {
        writeln!(page, "{place} {case} {code}").expect("a string");
    }
    Ok(page)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::read;

    fn table(first: (&str, i32), second: (&str, i32)) -> Vec<Enum> {
        let case = |(name, c)| format!("[[Kind.cases]]\nname = \"{name}\"\nc = {c}\nmeaning = \"x\"\n");
        read(&format!("[Kind]\nmeaning = \"x\"\nc = \"Reason\"\n{}{}", case(first), case(second))).unwrap()
    }

    const PAGE: &str = "border Kind One 0\nborder Kind Two 1\nc Reason One 5\nc Reason Two 7\n";

    #[test]
    fn a_page_grows_and_keeps_what_is_gone() {
        let page = updated("", &table(("One", 5), ("Two", 7))).unwrap();
        assert_eq!(page, format!("{HEAD}{PAGE}"));
        assert_eq!(updated(&page, &table(("One", 5), ("Two", 7))).unwrap(), page);
        let without_two = &table(("One", 5), ("Two", 7))[0];
        let mut without_two = without_two.clone();
        without_two.cases.pop();
        assert_eq!(updated(&page, &[without_two]).unwrap(), page);
    }

    #[test]
    fn a_code_that_changed_is_refused() {
        let why = updated(PAGE, &table(("One", 6), ("Two", 7))).unwrap_err();
        assert_eq!(
            why,
            "bindings/status.toml: c Reason One has the code 6, and had 5; codes are ABI and do not change"
        );
        let why = updated(PAGE, &table(("Two", 7), ("One", 5))).unwrap_err();
        assert_eq!(
            why,
            "bindings/status.toml: border Kind Two has the code 0, and had 1; codes are ABI and do not change"
        );
    }

    #[test]
    fn a_code_of_another_case_is_refused_also_of_one_that_is_gone() {
        let why = updated(PAGE, &table(("One", 5), ("Three", 8))).unwrap_err();
        assert_eq!(
            why,
            "bindings/status.toml: border Kind Three has the code 1, which Two has or had; take one that is free"
        );
        let why = updated(&PAGE.replace("border Kind Two 1\n", ""), &table(("One", 5), ("Three", 7))).unwrap_err();
        assert_eq!(
            why,
            "bindings/status.toml: c Reason Three has the code 7, which Two has or had; take one that is free"
        );
    }

    #[test]
    fn a_damaged_page_is_refused() {
        let ours = table(("One", 5), ("Two", 7));
        for line in ["border Kind One", "border Kind One x", "border Kind One 0 1", ""] {
            assert!(updated(&format!("{PAGE}{line}\n"), &ours).unwrap_err().contains("expected `PLACE"), "{line}");
        }
        assert!(updated(&format!("{PAGE}c Reason Four 7\n"), &ours).unwrap_err().ends_with("for Two and for Four"));
    }
}
