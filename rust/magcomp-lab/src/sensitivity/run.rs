//! The worth of each choice of the estimators, and of each mechanism: simulated groups and recordings with the choice halved and doubled, with the
//! mechanism off. Figures and their noise: `score`; what they are tried on: `bench`.

use super::bench::{TOGETHER, stream, trial};
use super::score::{Contrast, Moves, Unit, Way};
use super::view::{Found, Row, SensitivityOptions, Subject, csv, page};
use crate::catalogue::Variant;
use crate::parallel::{cores, map_shown};
use crate::trials::Folder;
use magcomp::{Mechanism, Tunings};
use magcomp_replay::error::RunError;
use magcomp_replay::table::Table;
use std::ops::{Range, RangeInclusive};
use std::path::Path;

impl Subject {
    /// Its settings: half and double, or off.
    fn tunings(self, part: &str) -> Vec<Tunings> {
        let with = |set: &dyn Fn(&mut Tunings) -> bool| {
            let mut tunings = Tunings::default();
            assert!(set(&mut tunings), "{part} {} is listed", self.name());
            tunings
        };
        match self {
            Self::Choice(choice) => {
                [0.5, 2.0].map(|factor| with(&|it| it.set(part, choice.name, choice.value * factor))).to_vec()
            }
            Self::Mechanism(mechanism) => vec![with(&|it| it.switch_off(part, mechanism.name))],
            Self::Pair(one, other) => {
                vec![with(&|it| it.switch_off(part, one.name) && it.switch_off(part, other.name))]
            }
        }
    }
}

/// Every choice, then every mechanism, with its part, that is asked for.
fn subjects(options: &SensitivityOptions) -> Result<Vec<(&'static str, Subject)>, RunError> {
    let choices = Tunings::list().map(|(part, choice)| (part, Subject::Choice(choice)));
    let mechanisms = Tunings::mechanisms().map(|(part, mechanism)| (part, Subject::Mechanism(mechanism)));
    let all: Vec<_> = choices.filter(|_| !options.switches).chain(mechanisms).collect();
    let fits = |name: &str, part: &String| name.contains(part.as_str());
    if let Some(unknown) = options.only.iter().find(|part| !all.iter().any(|(_, it)| fits(&it.name(), part))) {
        let what = if options.switches { "mechanism" } else { "choice or mechanism" };
        let why = format!("no {what} has '{unknown}' in its name; docs/dev/TUNING.md lists all");
        return Err(RunError::Usage(why));
    }
    let is_asked_for = |name: &str| options.only.is_empty() || options.only.iter().any(|part| fits(name, part));
    let mut found: Vec<_> = all.into_iter().filter(|(_, it)| is_asked_for(&it.name())).collect();
    found.extend(pairs(&found));
    Ok(found)
}

/// Each pair of these mechanisms that reads the same state.
fn pairs(subjects: &[(&'static str, Subject)]) -> Vec<(&'static str, Subject)> {
    let mut pairs = Vec::new();
    for (part, names) in TOGETHER {
        let own = |name: &&str| {
            subjects.iter().find_map(|(of, subject)| match subject {
                Subject::Mechanism(mechanism) if of == part && mechanism.name == *name => Some(*mechanism),
                _ => None,
            })
        };
        let own: Vec<_> = names.iter().filter_map(own).collect();
        for (k, one) in own.iter().enumerate() {
            pairs.extend(own[k + 1..].iter().map(|other| (*part, Subject::Pair(one, other))));
        }
    }
    pairs
}

/// A piece of work: nothing that two of them need is made twice.
enum Job<'a> {
    Stream(&'a (Way, Vec<Tunings>), &'a Variant, u64),
    Trial(&'a Folder, &'a Path),
}

/// Every choice and mechanism that is asked for, and each pair of mechanisms that reads the same state: the page docs/dev/TUNING.md, and all figures
/// as CSV.
///
/// # Errors
/// [`RunError::Usage`] for a name that nothing has, for one seed alone, and where a folder has no recording with a reference;
/// [`RunError::Recording`] names a file that is at fault.
pub fn run(options: &SensitivityOptions) -> Result<(Table, String), RunError> {
    if options.seeds.start() == options.seeds.end() {
        return Err(RunError::Usage("one seed tells no noise; give two at least, such as --seeds 1-8".to_owned()));
    }
    let subjects = subjects(options)?;
    let mut settings: Vec<(Way, Vec<Tunings>)> = Way::ALL.map(|way| (way, vec![Tunings::default()])).to_vec();
    let mut places: Vec<Place> = Vec::new();
    for (part, subject) in subjects {
        for (way, own) in settings.iter_mut().filter(|(way, _)| Way::of(part).contains(way)) {
            let tunings = subject.tunings(part);
            places.push((part, subject, *way, own.len()..own.len() + tunings.len()));
            own.extend(tunings);
        }
    }
    // a way in which nothing is tried
    settings.retain(|(_, own)| own.len() > 1);
    let folders = options.recordings.iter().map(|path| Folder::open(path, options.index.as_deref()));
    let folders: Vec<Folder> = folders.collect::<Result<_, _>>()?;
    if folders.iter().map(|folder| folder.paths.len()).sum::<usize>() == 1 {
        let why = "one recording tells no spread; name a folder with two at least";
        return Err(RunError::Usage(why.to_owned()));
    }
    let variants = settings.iter().map(|(way, _)| Ok((*way, way.variants(&options.groups)?)));
    let variants: Vec<(Way, Vec<Variant>)> = variants.collect::<Result<_, RunError>>()?;
    let (units, samples) = play(&settings, &variants, &folders, &options.seeds)?;
    let setting_of = |part: &str, mechanism: &Mechanism, way: Way| {
        let is_it = |it: &&Place| it.0 == part && it.2 == way && it.1.is(mechanism);
        places.iter().find(is_it).map_or(0, |(.., settings)| settings.start)
    };
    let row = |(part, subject, way, settings): &Place| {
        let own: Vec<&Unit> = units.iter().filter(|unit| unit.way == *way).collect();
        let contrasts: Vec<Contrast> = match subject {
            Subject::Pair(one, other) => {
                let [one, other] = [one, other].map(|it| setting_of(part, it, *way));
                vec![Contrast::beyond(settings.start, one, other)]
            }
            _ => settings.clone().map(Contrast::of).collect(),
        };
        let moves = contrasts.iter().map(|contrast| Moves::of(&own, contrast)).collect();
        Row { part, subject: *subject, way: *way, moves }
    };
    let rows: Vec<Row> = places.iter().map(row).collect();
    let csv = csv(&rows);
    Ok((page(&Found { options, rows, units, variants, samples }), csv))
}

/// A subject in one way, and the numbers of its settings.
type Place = (&'static str, Subject, Way, Range<usize>);

/// Every stream and every trial with every setting of its way, and the samples that were played.
fn play(
    settings: &[(Way, Vec<Tunings>)],
    variants: &[(Way, Vec<Variant>)],
    folders: &[Folder],
    seeds: &RangeInclusive<u64>,
) -> Result<(Vec<Unit>, usize), RunError> {
    let mut jobs = Vec::new();
    for folder in folders {
        jobs.extend(folder.paths.iter().map(|path| Job::Trial(folder, path.as_path())));
    }
    for (own, (_, variants)) in settings.iter().zip(variants) {
        jobs.extend(variants.iter().flat_map(|it| seeds.clone().map(move |seed| Job::Stream(own, it, seed))));
    }
    let found = map_shown("sensitivity", &jobs, cores(), |job| match job {
        Job::Stream((way, own), variant, seed) => {
            stream(*way, variant, *seed, own).map(|(unit, rows)| (vec![unit], rows))
        }
        Job::Trial(folder, path) => trial(folder, path, settings),
    });
    let (mut units, mut samples) = (Vec::new(), 0);
    for found in found {
        let (own, rows) = found?;
        units.extend(own);
        samples += rows;
    }
    Ok((units, samples))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn options(only: &[&str], switches: bool) -> SensitivityOptions {
        let only = only.iter().map(|name| (*name).to_owned()).collect();
        SensitivityOptions { recordings: Vec::new(), index: None, groups: Vec::new(), only, switches, seeds: 1..=2 }
    }

    #[test]
    fn what_is_asked_for_is_tried() {
        let names = |options| subjects(&options).map(|all| all.iter().map(|(_, it)| it.name()).collect::<Vec<_>>());
        assert_eq!(names(options(&["followed"], false)).unwrap(), ["followed"]);
        // a pair where both are asked for, in the order of the list of states
        let pair = names(options(&["quarantine", "hold"], true)).unwrap();
        assert!(
            pair.contains(&"hold + quarantine".to_owned()) && pair.iter().filter(|it| it.contains(" + ")).count() >= 1,
            "{pair:?}"
        );
        let both = names(options(&["noise_ut", "followed"], false)).unwrap();
        assert_eq!(both, ["noise_ut", "followed"]);
        let single = |switches| {
            let all = names(options(&[], switches)).unwrap();
            all.iter().filter(|name| !name.contains(" + ")).count()
        };
        let (all, switches) = (single(false), single(true));
        assert_eq!(
            (all, switches),
            (Tunings::list().count() + Tunings::mechanisms().count(), Tunings::mechanisms().count())
        );
        let refused = |options| names(options).unwrap_err().to_string();
        assert!(refused(options(&["followed", "nobody"], false)).contains("'nobody'"));
        assert!(refused(options(&["noise_ut"], true)).contains("no mechanism has 'noise_ut'"));
        let alone = SensitivityOptions { seeds: 3..=3, ..options(&[], false) };
        assert!(run(&alone).unwrap_err().to_string().contains("one seed tells no noise"));
    }

    #[test]
    fn a_choice_has_half_and_double_and_a_mechanism_is_off() {
        for (part, subject) in subjects(&options(&[], false)).unwrap() {
            let tunings = subject.tunings(part);
            let is_choice = matches!(subject, Subject::Choice(_));
            assert_eq!(tunings.len(), if is_choice { 2 } else { 1 }, "{part} {}", subject.name());
            assert!(tunings.iter().all(|one| *one != Tunings::default()), "{part} {}", subject.name());
        }
    }
}
