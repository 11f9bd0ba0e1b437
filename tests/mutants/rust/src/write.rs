//! The files with all their mutants.

use std::ops::Range;

use crate::find::{Found, Kind};

/// What chooses the mutant. 0 is none; `reach:FILE` runs none and writes to FILE the number of each whose place is reached.
pub const SWITCH: &str = r#"//! Chooses a mutant.
use std::io::Write;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};
use std::sync::OnceLock;

const UNREAD: u32 = u32::MAX;
const REACH: u32 = u32::MAX - 1;
static CHOSEN: AtomicU32 = AtomicU32::new(UNREAD);
static REACHED: [AtomicBool; COUNT] = [const { AtomicBool::new(false) }; COUNT];
static FILE: OnceLock<std::fs::File> = OnceLock::new();

#[inline]
pub(crate) fn is(number: u32) -> bool {
    let chosen = CHOSEN.load(Relaxed);
    chosen == number || chosen >= REACH && rarely(number)
}

#[cold]
#[inline(never)]
fn rarely(number: u32) -> bool {
    if CHOSEN.load(Relaxed) == UNREAD {
        let value = std::env::var("MAGCOMP_MUTANT").unwrap_or_default();
        let file = value.strip_prefix("reach:");
        if let Some(file) = file {
            FILE.get_or_init(|| std::fs::OpenOptions::new().append(true).create(true).open(file).expect("a file"));
        }
        CHOSEN.store(if file.is_some() { REACH } else { value.parse().unwrap_or(0) }, Relaxed);
        return is(number);
    }
    if let Some(mut file) = FILE.get()
        && !REACHED[number as usize].swap(true, Relaxed)
    {
        let _ = file.write_all(format!("{number}\n").as_bytes());
    }
    false
}
"#;

/// A file as it is written, and where in it each mutant and each site is.
#[derive(Default)]
pub struct Written {
    pub text: String,
    pub mutants: Vec<(Range<usize>, usize)>,
    pub sites: Vec<(Range<usize>, usize)>,
}

pub fn written(found: &Found, kept: &[bool], file: usize) -> Written {
    let mut sites: Vec<usize> = (0..found.sites.len())
        .filter(|it| found.sites[*it].file == file && found.sites[*it].mutants.iter().any(|it| kept[*it]))
        .collect();
    sites.sort_by_key(|it| {
        let at = &found.sites[*it].at;
        (at.start, std::cmp::Reverse(at.end))
    });
    let mut out = Written::default();
    put(found, kept, &found.files[file].text, 0..found.files[file].text.len(), &sites, &mut out);
    out
}

/// The text of `at`, in which these sites are.
fn put(found: &Found, kept: &[bool], text: &str, at: Range<usize>, mut sites: &[usize], out: &mut Written) {
    let mut done = at.start;
    while let [first, rest @ ..] = sites {
        let site = &found.sites[*first];
        let inside = rest.iter().take_while(|it| found.sites[**it].at.start < site.at.end).count();
        out.text.push_str(&text[done..site.at.start]);
        let begin = out.text.len();
        let numbers: Vec<usize> = site.mutants.iter().copied().filter(|it| kept[*it]).collect();
        let asked = |number: usize| format!("crate::mutant::is({})", number + 1);
        if site.kind == Kind::Instead {
            out.text.push('(');
        }
        for number in numbers {
            let from = out.text.len();
            match site.kind {
                Kind::Instead => {
                    out.text.push_str(&format!("if {} {{ {} }} else ", asked(number), found.mutants[number].text))
                }
                Kind::LeftOut => out.text.push_str(&format!("if !{} ", asked(number))),
                Kind::Between => out.text.push_str(&found.mutants[number].text.replacen("{}", &asked(number), 1)),
            }
            out.mutants.push((from..out.text.len(), number));
        }
        if site.kind != Kind::Between {
            out.text.push_str("{ ");
        }
        put(found, kept, text, site.at.clone(), &rest[..inside], out);
        if site.kind != Kind::Between {
            out.text.push_str(" }");
        }
        if site.kind == Kind::Instead {
            out.text.push(')');
        }
        out.sites.push((begin..out.text.len(), *first));
        done = site.at.end;
        sites = &rest[inside..];
    }
    out.text.push_str(&text[done..at.end]);
}
