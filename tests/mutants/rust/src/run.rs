//! Asks the tests about each mutant.

use std::collections::{BTreeMap, HashSet};
use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::time::Instant;

use crate::build::{self, Binary, Stage};
use crate::find::Found;

/// How many mutants run at once.
const AT_ONCE: usize = 2;
/// A test that takes longer is not asked, s of a processor: `MAGCOMP_LONGEST_S`, or this.
const LONGEST_S: f64 = 40.0;

struct Test {
    binary: usize,
    name: String,
    seconds: f64,
    reaches: HashSet<usize>,
    /// What a judge's run prints.
    said: Vec<String>,
}

/// What became of a mutant, in the order of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Fate {
    Module,
    Core,
    Host,
    Lab,
    /// Not known yet.
    Open,
    /// No test reaches it, nor a simulated run.
    Unreached,
    /// No simulated run reads otherwise.
    NoReading,
    /// Some do, in no decimal that counts.
    Rounding,
    /// Some do, and no test fails.
    Readings,
}

const FATES: [Fate; 9] = [
    Fate::Module,
    Fate::Core,
    Fate::Host,
    Fate::Lab,
    Fate::Open,
    Fate::Unreached,
    Fate::NoReading,
    Fate::Rounding,
    Fate::Readings,
];

struct Asked<'a> {
    tree: &'a Path,
    binaries: Vec<Binary>,
    tests: Vec<Test>,
}

impl Asked<'_> {
    /// Some tests of one binary. An endless loop ends by its processor time: the clock of a busy machine says nothing.
    fn process(&self, binary: usize, names: &[&str], most_s: f64, mutant: &str) -> Output {
        let binary = &self.binaries[binary];
        let limit = format!("ulimit -t {}; ulimit -c 0; exec \"$0\" \"$@\"", most_s.ceil() as u64);
        Command::new("bash")
            .args(["-c", &limit])
            .arg(&binary.file)
            .args(["--exact", "--include-ignored", "--test-threads=1"])
            .args(if binary.stage == Stage::Judge { &["--nocapture"][..] } else { &[] })
            .args(names)
            .current_dir(&binary.folder)
            .env("CARGO_MANIFEST_DIR", &binary.folder)
            .env("MAGCOMP_MUTANT", mutant)
            .env("PROPTEST_MAX_SHRINK_ITERS", "0")
            .stdin(Stdio::null())
            .output()
            .expect("a test")
    }

    fn said(out: &Output) -> Vec<String> {
        String::from_utf8_lossy(&out.stdout)
            .lines()
            .filter_map(|it| Some(it[it.find("judge ")?..].to_owned()))
            .collect()
    }

    /// What fails of these, in batches, the quick ones first.
    fn killed_by(&self, number: usize, mut tests: Vec<&Test>) -> Option<String> {
        tests.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
        let mut most_s = 0.5;
        while !tests.is_empty() {
            let (mut batch, mut sum_s): (BTreeMap<usize, Vec<&str>>, f64) = (BTreeMap::new(), 0.0);
            let mut taken = 0;
            for test in &tests {
                if taken > 0 && sum_s + test.seconds > most_s {
                    break;
                }
                sum_s += test.seconds;
                batch.entry(test.binary).or_default().push(&test.name);
                taken += 1;
            }
            tests.drain(..taken);
            most_s *= 2.0;
            for (binary, names) in batch {
                let out = self.process(binary, &names, 3.0 + 10.0 * sum_s, &(number + 1).to_string());
                if !out.status.success() {
                    let text = String::from_utf8_lossy(&out.stdout).into_owned();
                    let failed = text.lines().find(|it| it.ends_with("FAILED") && it.starts_with("test "));
                    return Some(failed.map_or_else(
                        || format!("{} ({})", names[0], out.status),
                        |it| it[5..].replace(" ... FAILED", ""),
                    ));
                }
            }
        }
        None
    }

    /// Those of a stage that reach a mutant.
    fn reaching(&self, stage: Stage, number: usize) -> Vec<&Test> {
        self.tests.iter().filter(|it| self.binaries[it.binary].stage == stage && it.reaches.contains(&number)).collect()
    }

    fn of_core(&self, found: &Found, number: usize) -> Option<(Fate, String)> {
        let own = own_tests(&found.mutants[number].module);
        let (module, core) = self.reaching(Stage::Core, number).into_iter().partition(|it| it.name.starts_with(&own));
        let by = |fate, tests| Some((fate, self.killed_by(number, tests)?));
        by(Fate::Module, module).or_else(|| by(Fate::Core, core))
    }

    fn of_host(&self, number: usize) -> Option<(Fate, String)> {
        Some((Fate::Host, self.killed_by(number, self.reaching(Stage::Host, number))?))
    }

    fn of_lab(&self, number: usize) -> Option<(Fate, String)> {
        Some((Fate::Lab, self.killed_by(number, self.reaching(Stage::Lab, number))?))
    }

    /// Whether simulated runs read otherwise.
    fn of_runs(&self, number: usize) -> (Fate, String) {
        if self.tests.iter().all(|it| !it.reaches.contains(&number)) {
            return (Fate::Unreached, String::new());
        }
        let (mut otherwise, mut counts, mut worst) = (0, false, String::new());
        let mut runs = 0;
        for test in self.reaching(Stage::Judge, number) {
            let out = self.process(test.binary, &[&test.name], 10.0 + 10.0 * test.seconds, &(number + 1).to_string());
            let said = Self::said(&out);
            runs += test.said.len();
            if said.len() != test.said.len() {
                (otherwise, counts, worst) = (otherwise + 1, true, format!("{}: {}", test.name, out.status));
            }
            for (before, now) in test.said.iter().zip(&said).filter(|(before, now)| before != now) {
                otherwise += 1;
                let field = |line: &str, at| line.split(' ').nth(at).map(str::to_owned);
                let decimals = if before.contains("csv.gz") { 3 } else { 4 };
                if field(before, decimals) != field(now, decimals) {
                    counts = true;
                    let tail = |line: &str| line.split_once("heading ").map_or(String::new(), |it| it.1.to_owned());
                    if tail(before) != tail(now) || worst.is_empty() {
                        worst = format!("{}: {} -> {}", test.name, tail(before), tail(now));
                    }
                }
            }
        }
        let said = format!("{otherwise} of {runs} runs; {worst}");
        if otherwise == 0 {
            return (Fate::NoReading, format!("{runs} runs"));
        }
        if !counts {
            return (Fate::Rounding, said);
        }
        (Fate::Readings, said)
    }
}

/// Of estimator/aided/watch.rs the tests whose names begin so.
fn own_tests(module: &str) -> String {
    let parts: Vec<&str> = module.trim_end_matches(".rs").split('/').collect();
    let depth = if parts[0] == "estimator" { 2 } else { 1 };
    format!("{}::", parts[..depth.min(parts.len())].join("::"))
}

/// The share a mutant is in: the same whatever else is listed, unless its line moves.
fn is_in(share: &str, name: &str) -> bool {
    let (k, n) = share.split_once('/').expect("a share like 1/4");
    let [k, n] = [k, n].map(|it| it.parse::<u64>().expect("a number"));
    let mut hash = DefaultHasher::new();
    name.hash(&mut hash);
    hash.finish() % n == k % n
}

pub fn run(tree: &Path, found: &Found, kept: &[bool], share: &str, word: &str) {
    let mut asked = Asked { tree, binaries: Vec::new(), tests: Vec::new() };
    let accepted = fs::read_to_string(tree.join("tests/mutants/rust/accepted.txt")).expect("a file");
    let is_chosen = |name: &str| {
        let (file, change) = name.split_once(' ').expect("a place");
        let without = format!("{}: {change}", file.split(':').next().expect("a file"));
        is_in(share, name) && name.contains(word) && !accepted.lines().any(|it| it == without)
    };
    let chosen: Vec<usize> =
        (0..found.mutants.len()).filter(|it| kept[*it] && is_chosen(&found.mutants[*it].name)).collect();
    let mut fates = BTreeMap::new();
    let mut left = chosen;
    for stage in [Stage::Core, Stage::Host, Stage::Judge, Stage::Lab] {
        listed(&mut asked, stage);
        for (number, found_out) in at_once(&left, |number| {
            let found_out = match stage {
                Stage::Core => asked.of_core(found, *number),
                Stage::Host => asked.of_host(*number),
                Stage::Judge => Some(asked.of_runs(*number)),
                Stage::Lab => asked.of_lab(*number),
            };
            if let Some((fate, by)) = &found_out {
                println!("{fate:?}: {} | {by}", found.mutants[*number].name);
            }
            (*number, found_out.map_or(Fate::Open, |it| it.0))
        }) {
            if stage != Stage::Lab || found_out != Fate::Open {
                fates.insert(number, found_out);
            }
        }
        left = fates.iter().filter(|it| matches!(it.1, Fate::Open | Fate::Readings)).map(|it| *it.0).collect();
        table(found, &fates);
        if left.is_empty() {
            break;
        }
    }
}

/// `what` of each, some at once; in no order.
fn at_once<T: Sync, R: Send>(all: &[T], what: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let (next, done) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    std::thread::scope(|scope| {
        for _ in 0..AT_ONCE {
            scope.spawn(|| {
                while let Some(one) = all.get(next.fetch_add(1, Relaxed)) {
                    let found = what(one);
                    done.lock().expect("no panic").push(found);
                }
            });
        }
    });
    done.into_inner().expect("no panic")
}

/// Every test by itself: how long it takes, and what it reaches.
fn listed(asked: &mut Asked<'_>, stage: Stage) {
    let first = asked.binaries.len();
    asked.binaries.extend(build::tests(asked.tree, stage));
    let mut all = Vec::new();
    for (binary, it) in asked.binaries.iter().enumerate().skip(first) {
        let names = |ignored: &[&str]| -> HashSet<String> {
            let out = Command::new(&it.file).args(["--list", "--format=terse"]).args(ignored).output().expect("a list");
            String::from_utf8_lossy(&out.stdout)
                .lines()
                .filter_map(|it| it.strip_suffix(": test").map(str::to_owned))
                .collect()
        };
        let mut names: Vec<_> = names(&[]).difference(&names(&["--ignored"])).cloned().collect();
        names.sort();
        all.extend(names.into_iter().map(|name| (binary, name)));
    }
    let longest_s = std::env::var("MAGCOMP_LONGEST_S").ok().and_then(|it| it.parse().ok()).unwrap_or(LONGEST_S);
    let known = &*asked;
    let tests = at_once(&all, |(binary, name)| {
        let file: PathBuf = std::env::temp_dir().join(format!(
            "magcomp-mutants-{}-{binary}-{}",
            std::process::id(),
            name.replace(':', "-")
        ));
        let begin = Instant::now();
        let out = known.process(*binary, &[name], longest_s, &format!("reach:{}", file.display()));
        let seconds = begin.elapsed().as_secs_f64();
        let text = fs::read_to_string(&file).unwrap_or_default();
        let _ = fs::remove_file(&file);
        if !out.status.success() {
            println!("without a mutant, {name} fails, or runs for too long: not asked");
            return None;
        }
        let reaches = text.lines().filter_map(|it| Some(it.parse::<usize>().ok()? - 1)).collect();
        Some(Test { binary: *binary, name: name.clone(), seconds, reaches, said: Asked::said(&out) })
    });
    let before = asked.tests.len();
    asked.tests.extend(tests.into_iter().flatten());
    let spent: f64 = asked.tests[before..].iter().map(|it| it.seconds).sum();
    println!("{} tests, {spent:.0} s", asked.tests.len() - before);
    if std::env::var_os("MAGCOMP_TIMES").is_some() {
        asked.tests[before..].sort_by(|a, b| b.seconds.total_cmp(&a.seconds));
        for test in asked.tests[before..].iter().take(40) {
            println!("{} {:.1} s, reaches {}", test.name, test.seconds, test.reaches.len());
        }
    }
}

fn table(found: &Found, fates: &BTreeMap<usize, Fate>) {
    let mut lines: BTreeMap<String, [usize; 9]> = BTreeMap::new();
    for (number, fate) in fates {
        let module = &found.mutants[*number].module;
        let folder = module.rsplit_once('/').map_or("", |it| it.0);
        for name in [module.clone(), format!("{folder}/ all")] {
            lines.entry(name).or_default()[FATES.iter().position(|it| it == fate).expect("listed")] += 1;
        }
    }
    println!(
        "\n| file | mutants | module's tests | core's | tests/host | lab | open | unreached | no reading | rounding | readings, no test |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
    for (name, counts) in lines {
        let counted: Vec<_> = counts.iter().map(|it| it.to_string()).collect();
        println!("| {name} | {} | {} |", counts.iter().sum::<usize>(), counted.join(" | "));
    }
}
