//! The worth of each choice of the estimators, and of each mechanism: simulated groups and recordings with the choice halved and doubled, with the
//! mechanism off. Figures and their noise: `score`; what they are tried on: `bench`.

use super::bench::{stream, trial};
use super::score::{Moves, Unit, Way};
use super::view::{Found, Row, SensitivityOptions, Subject, page};
use crate::catalogue::Variant;
use crate::error::LabError;
use crate::parallel::cores;
use crate::progress;
use crate::table::Table;
use crate::trials::Folder;
use magcomp::Tunings;
use std::ops::RangeInclusive;
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
        }
    }
}

/// Every choice, then every mechanism, with its part, that is asked for.
fn subjects(options: &SensitivityOptions) -> Result<Vec<(&'static str, Subject)>, LabError> {
    let choices = Tunings::list().map(|(part, choice)| (part, Subject::Choice(choice)));
    let mechanisms = Tunings::mechanisms().map(|(part, mechanism)| (part, Subject::Mechanism(mechanism)));
    let all: Vec<_> = choices.filter(|_| !options.switches).chain(mechanisms).collect();
    let fits = |name: &str, part: &String| name.contains(part.as_str());
    if let Some(unknown) = options.only.iter().find(|part| !all.iter().any(|(_, it)| fits(it.name(), part))) {
        let what = if options.switches { "mechanism" } else { "choice or mechanism" };
        let why = format!("no {what} has '{unknown}' in its name; docs/dev/TUNING.md lists all");
        return Err(LabError::Usage(why));
    }
    let is_asked_for = |name: &str| options.only.is_empty() || options.only.iter().any(|part| fits(name, part));
    Ok(all.into_iter().filter(|(_, it)| is_asked_for(it.name())).collect())
}

/// A piece of work: nothing that two of them need is made twice.
enum Job<'a> {
    Stream(&'a (Way, Vec<Tunings>), &'a Variant, u64),
    Trial(&'a Folder, &'a Path),
}

/// Every choice and mechanism that is asked for, as the page docs/dev/TUNING.md.
///
/// # Errors
/// [`LabError::Usage`] for a name that nothing has, for one seed alone, and where a folder has no recording with a reference;
/// [`LabError::Recording`] names a file that is at fault.
pub fn run(options: &SensitivityOptions) -> Result<Table, LabError> {
    if options.seeds.start() == options.seeds.end() {
        return Err(LabError::Usage("one seed tells no noise; give two at least, such as --seeds 1-8".to_owned()));
    }
    let subjects = subjects(options)?;
    let mut settings: Vec<(Way, Vec<Tunings>)> = Way::ALL.map(|way| (way, vec![Tunings::default()])).to_vec();
    let mut places = Vec::new();
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
    let variants = settings.iter().map(|(way, _)| Ok((*way, way.variants(&options.groups)?)));
    let variants: Vec<(Way, Vec<Variant>)> = variants.collect::<Result<_, LabError>>()?;
    let (units, samples) = play(&settings, &variants, &folders, &options.seeds)?;
    let row = |(part, subject, way, places): (&'static str, Subject, Way, std::ops::Range<usize>)| {
        let own: Vec<&Unit> = units.iter().filter(|unit| unit.way == way).collect();
        Row { part, subject, way, moves: places.map(|setting| Moves::of(&own, setting)).collect() }
    };
    let rows = places.into_iter().map(row).collect();
    Ok(page(&Found { options, rows, units, variants, samples }))
}

/// Every stream and every trial with every setting of its way, and the samples that were played.
fn play(
    settings: &[(Way, Vec<Tunings>)],
    variants: &[(Way, Vec<Variant>)],
    folders: &[Folder],
    seeds: &RangeInclusive<u64>,
) -> Result<(Vec<Unit>, usize), LabError> {
    let mut jobs = Vec::new();
    for folder in folders {
        jobs.extend(folder.paths.iter().map(|path| Job::Trial(folder, path.as_path())));
    }
    for (own, (_, variants)) in settings.iter().zip(variants) {
        jobs.extend(variants.iter().flat_map(|it| seeds.clone().map(move |seed| Job::Stream(own, it, seed))));
    }
    let found = progress::map("sensitivity", &jobs, cores(), |job| match job {
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
        assert_eq!(names(options(&["quarantine"], false)).unwrap(), ["quarantine"]);
        let both = names(options(&["noise_ut", "quarantine"], false)).unwrap();
        assert_eq!(both, ["noise_ut", "quarantine"]);
        let all = names(options(&[], false)).unwrap().len();
        let switches = names(options(&[], true)).unwrap().len();
        assert_eq!(
            (all, switches),
            (Tunings::list().count() + Tunings::mechanisms().count(), Tunings::mechanisms().count())
        );
        let refused = |options| names(options).unwrap_err().to_string();
        assert!(refused(options(&["quarantine", "nobody"], false)).contains("'nobody'"));
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
