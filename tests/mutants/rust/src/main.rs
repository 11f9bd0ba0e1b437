//! Compiles every mutant of the core's files into one library, where the environment variable `MAGCOMP_MUTANT` chooses the one that runs, and asks
//! the tests: those of the mutant's own module, all of the core, tests/host, and, where a simulated run (judge.rs) reads otherwise with it, the lab's.
//! Each mutant is asked only what reaches it.
//!
//! `magcomp-mutants TREE SHARE WORD PATH...`, in the repository: TREE is its copy with the mutants, of which only what changed is written; SHARE is like 1/4, every fourth on average, by a fixed
//! hash; WORD is in the names of the mutants that run; PATH is a file or folder below rust/magcomp/src.

mod build;
mod find;
mod run;
mod write;

use std::path::{Path, PathBuf};

fn files(path: &Path, into: &mut Vec<PathBuf>) {
    if path.is_dir() {
        let mut inside: Vec<_> =
            std::fs::read_dir(path).expect("a folder").map(|it| it.expect("an entry").path()).collect();
        inside.sort();
        inside.iter().for_each(|it| files(it, into));
    } else if path.extension().is_some_and(|it| it == "rs") && !path.components().any(|it| it.as_os_str() == "tests") {
        if path.file_name().is_some_and(|it| it != "tests.rs") {
            into.push(path.to_owned());
        }
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [tree, share, word, paths @ ..] = &arguments[..] else { panic!("TREE SHARE WORD PATH...") };
    let tree = PathBuf::from(tree);
    let source = Path::new("rust/magcomp/src");
    let mut names = Vec::new();
    paths.iter().for_each(|path| files(&source.join(path), &mut names));
    let mut all = find::Found::default();
    names.iter().for_each(|path| {
        all.read(path, path.strip_prefix(source).expect("a file of the core").to_str().expect("a name"))
    });
    let kept = build::build(&tree, source, &all);
    println!("{} mutants, of which {} compile", all.mutants.len(), kept.iter().filter(|it| **it).count());
    run::run(&tree, &all, &kept, share, word);
}
