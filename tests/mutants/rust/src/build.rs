//! Writes the mutants, leaves out those that do not compile, and builds the tests once.

use std::collections::{HashMap, HashSet};
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;

use crate::find::{Found, Kind};
use crate::write::{SWITCH, Written, written};

/// Of tests/host those that judge readings by something other than former readings, and count no allocations.
const HOST: [&str; 14] = [
    "aided",
    "attitude",
    "contracts",
    "direct",
    "event_order",
    "explain",
    "facts",
    "given",
    "headings",
    "kept",
    "laws",
    "misbehaving",
    "outside",
    "relaunch",
];
const LAB: [&str; 6] = ["adaptive", "aided", "disturbed", "north", "recordings", "streams"];
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    Core,
    Host,
    /// Simulated runs, of which only the readings are compared.
    Judge,
    Lab,
}

/// A test binary, and the folder of its package.
#[derive(Clone)]
pub struct Binary {
    pub stage: Stage,
    pub folder: PathBuf,
    pub file: PathBuf,
}

fn cargo(tree: &Path, arguments: &[&str]) -> (bool, Vec<Value>) {
    let out = Command::new("cargo")
        .args(arguments)
        .arg("--message-format=json")
        .current_dir(tree)
        .stderr(Stdio::inherit())
        .output()
        .expect("cargo");
    let lines =
        String::from_utf8_lossy(&out.stdout).lines().filter_map(|line| serde_json::from_str(line).ok()).collect();
    (out.status.success(), lines)
}

fn errors(lines: &[Value]) {
    for line in lines.iter().filter(|it| it["message"]["level"] == "error") {
        eprintln!("{}", line["message"]["rendered"].as_str().unwrap_or(""));
    }
}

/// Writes what differs: the others are not built again.
fn put(path: &Path, text: &[u8]) {
    if fs::read(path).is_ok_and(|it| it == text) {
        return;
    }
    fs::create_dir_all(path.parent().expect("a folder")).expect("made");
    fs::write(path, text).expect("written");
}

/// All files but those with mutants.
fn copy(tree: &Path, source: &Path, found: &Found) {
    let out = Command::new("git").args(["ls-files", "-z"]).output().expect("git");
    for name in String::from_utf8(out.stdout).expect("names").split_terminator('\0').map(Path::new) {
        if name == source.join("lib.rs") {
            let text = fs::read_to_string(name).expect("the root");
            put(
                &tree.join(name),
                format!("#![allow(arithmetic_overflow, unconditional_panic)]\n{text}\nmod mutant;\n").as_bytes(),
            );
        } else if name == Path::new("rust/magcomp-lab/Cargo.toml") {
            // its unit tests say nothing of the core
            let text = fs::read_to_string(name).expect("a manifest");
            put(&tree.join(name), format!("{text}\n[lib]\ntest = false\n").as_bytes());
        } else if name.is_file() && !found.files.iter().any(|it| it.path == name) {
            put(&tree.join(name), &fs::read(name).expect("a file"));
        }
    }
    put(
        &tree.join(source).join("mutant.rs"),
        SWITCH.replace("COUNT", &(found.mutants.len() + 1).to_string()).as_bytes(),
    );
    let judge = fs::read("tests/mutants/rust/judge.rs").expect("the judge");
    put(&tree.join("rust/magcomp-lab/tests/judge_mutants.rs"), &judge);
}

/// Whether each is kept.
pub fn build(tree: &Path, source: &Path, found: &Found) -> Vec<bool> {
    assert!(!found.files.iter().any(|it| it.path == source.join("lib.rs")), "lib.rs has no mutants");
    copy(tree, source, found);
    // of the last time
    let list = tree.join("left_out.txt");
    let known = fs::read_to_string(&list).unwrap_or_default();
    let known: HashSet<&str> = known.lines().collect();
    let mut kept: Vec<bool> = found.mutants.iter().map(|it| !known.contains(&*it.name)).collect();
    loop {
        let mut all = HashMap::new();
        for (number, file) in found.files.iter().enumerate() {
            let out = written(found, &kept, number);
            put(&tree.join(&file.path), out.text.as_bytes());
            all.insert(file.path.to_str().expect("a name").to_owned(), out);
        }
        let (ok, lines) = cargo(tree, &["check", "--quiet", "-p", "magcomp", "--lib"]);
        let before = kept.iter().filter(|it| **it).count();
        if !ok {
            for line in
                lines.iter().filter(|it| it["reason"] == "compiler-message" && it["message"]["level"] == "error")
            {
                leave_out(found, &all, &line["message"], &mut kept);
            }
        }
        let names: Vec<&str> = found.mutants.iter().zip(&kept).filter(|it| !it.1).map(|it| &*it.0.name).collect();
        put(&list, names.join("\n").as_bytes());
        if ok {
            break;
        }
        let after = kept.iter().filter(|it| **it).count();
        eprintln!("{} of {before} do not compile", before - after);
        if after == before {
            errors(&lines);
            panic!("an error that is no mutant's");
        }
    }
    kept
}

/// The tests of a stage; all with the features of all, so that no crate is built twice.
pub fn tests(tree: &Path, stage: Stage) -> Vec<Binary> {
    let names: &[&str] = match stage {
        Stage::Core => &[],
        Stage::Host => &HOST,
        Stage::Judge => &["judge_mutants"],
        Stage::Lab => &LAB,
    };
    let mut arguments =
        vec!["test", "--no-run", "--quiet", "-p", "magcomp", "-p", "magcomp-tests", "-p", "magcomp-lab"];
    if stage == Stage::Core {
        arguments.push("--lib");
    }
    names.iter().for_each(|name| arguments.extend(["--test", name]));
    let (ok, lines) = cargo(tree, &arguments);
    if !ok {
        errors(&lines);
        panic!("the tests do not build");
    }
    // both packages may have a test of a name
    let package = match stage {
        Stage::Core => "rust/magcomp",
        Stage::Host => "tests",
        Stage::Judge | Stage::Lab => "rust/magcomp-lab",
    };
    let folder = fs::canonicalize(tree).expect("the tree").join(package);
    let built = lines.iter().filter(|it| it["reason"] == "compiler-artifact" && it["profile"]["test"] == true);
    let own = built.filter(|it| it["manifest_path"].as_str().is_some_and(|it| Path::new(it).parent() == Some(&folder)));
    own.filter_map(|it| Some(Binary { stage, folder: folder.clone(), file: PathBuf::from(it["executable"].as_str()?) }))
        .collect()
}

/// The mutant whose text an error is in, or all of the innermost place; else, of a borrow or a variable that is not set, the statements left out
/// between the parts of the message.
fn leave_out(found: &Found, all: &HashMap<String, Written>, message: &Value, kept: &mut [bool]) {
    let spans = || {
        message["spans"].as_array().into_iter().flatten().filter_map(|it| {
            let file = all.get(it["file_name"].as_str()?)?;
            Some((
                file,
                it["byte_start"].as_u64()? as usize,
                it["byte_end"].as_u64()? as usize,
                it["is_primary"] == true,
            ))
        })
    };
    for is_primary in [true, false] {
        let mut is_found = false;
        for (file, from, to, _) in spans().filter(|it| it.3 == is_primary) {
            let holds = |at: &Range<usize>| at.start <= from && to <= at.end;
            if let Some((_, number)) = file.mutants.iter().filter(|it| holds(&it.0)).min_by_key(|it| it.0.len()) {
                kept[*number] = false;
                is_found = true;
            } else if let Some((_, site)) =
                file.sites.iter().filter(|it| is_primary && holds(&it.0)).min_by_key(|it| it.0.len())
            {
                found.sites[*site].mutants.iter().for_each(|it| kept[*it] = false);
                is_found = true;
            }
        }
        if is_found {
            return;
        }
    }
    let Some((file, ..)) = spans().next() else { return };
    let (from, to) = spans().fold((usize::MAX, 0), |(from, to), it| (from.min(it.1), to.max(it.2)));
    for (at, site) in &file.sites {
        if found.sites[*site].kind == Kind::LeftOut && from <= at.start && at.end <= to {
            found.sites[*site].mutants.iter().for_each(|it| kept[*it] = false);
        }
    }
}
