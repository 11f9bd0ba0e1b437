//! A magnet put on recordings, by arithmetic: no real one, whose field would saturate a sensor or magnetise a phone.
//!
//! raw + w (d + A raw): d, the hard iron, in a random direction; A, the soft iron, random, symmetric and without a trace, the given share by its
//! spectral norm; w from 0 to 1, at once or eased. Direction, A and time are drawn for each recording, magnet and seed: put on at 45 to 60 % of the
//! recording, or at 38 to 42 % and taken off at 68 to 72 %.
//!
//! Judged as simulations are ([`crate::score`]), from the magnet on: a heading against the reference, less the constant (circular median) that the rows
//! from 20 s to the magnet have, so that nothing is forgiven that the magnet does. In place of the angles of c and f: how far their azimuths by
//! the reference are off, less the constants of the same rows. Where nothing is put on, the second half is judged.

use super::score::config;
use super::tuned::{Folder, Trial};
use crate::catalogue::{hash, symmetric};
use crate::course::Course;
use crate::parallel::map_shown;
use crate::random::{Purpose, Random};
use crate::score::{Figures, Mode, Sample};
use crate::simulate::{Change, ChangeKind};
use magcomp::nalgebra::{Matrix3, Vector3};
use magcomp::{Event, Method, ReferenceAxis, Tunings};
use magcomp_recordings::recording::Row;
use magcomp_replay::error::RunError;
use magcomp_replay::statistics::{median, rms};
use magcomp_replay::{Ignore, Player, azimuth_deg, off_deg, reference_heading_deg};
use serde::Serialize;
use std::num::NonZeroUsize;
use std::ops::RangeInclusive;
use std::path::Path;

/// What a table and a page must say of its rows.
pub const LABEL: &str = "arithmetic, not a real magnet";
/// Rows before are judged from here on, s.
const FROM_S: f64 = 20.0;
/// After the end of a change its transient is over, s.
const SETTLED_S: f64 = 5.0;
/// Rows with a heading before the magnet, and judged ones after it, at least.
const FEWEST: usize = 100;

/// A magnet that can be put on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Magnet {
    /// In a few words.
    pub name: &'static str,
    /// Its hard iron, uT.
    pub hard_ut: f64,
    /// Its soft iron, a share.
    pub soft: f64,
    /// How long it takes to come, s.
    pub over_s: f64,
    /// It is taken off again.
    pub comes_off: bool,
}

/// All of them, in the order of the tables; the first is none.
pub const MAGNETS: [Magnet; 10] = [
    at_once("nothing", 0.0),
    at_once("8 uT at once", 8.0),
    at_once("27 uT at once", 27.0),
    at_once("100 uT at once", 100.0),
    at_once("300 uT at once", 300.0),
    Magnet { over_s: 1.0, ..at_once("27 uT over 1 s", 27.0) },
    Magnet { over_s: 3.0, ..at_once("60 uT over 3 s", 60.0) },
    Magnet { over_s: 10.0, ..at_once("150 uT over 10 s", 150.0) },
    Magnet { soft: 0.05, ..at_once("60 uT and 5 % of soft iron", 60.0) },
    Magnet { comes_off: true, ..at_once("27 uT on and off", 27.0) },
];

const fn at_once(name: &'static str, hard_ut: f64) -> Magnet {
    Magnet { name, hard_ut, soft: 0.0, over_s: 0.0, comes_off: false }
}

/// What a seed makes of a magnet on a recording. Times are after the first row.
#[derive(Clone, Debug)]
pub(super) struct Drawn {
    course: Course,
    hard_ut: Vector3<f64>,
    soft: Matrix3<f64>,
    /// When it changes, from and to, s.
    changes_s: Vec<(f64, f64)>,
    /// Judged from here on, s.
    begins_s: f64,
}

impl Magnet {
    pub(super) fn draw(&self, recording: &str, seed: u64, duration_s: f64) -> Drawn {
        let random = &mut Random::new(seed ^ hash(&format!("{recording} {}", self.name)), Purpose::Magnet);
        let hard_ut = random.direction() * self.hard_ut;
        let soft = symmetric(1.0, random);
        let soft = soft - Matrix3::identity() * (soft.trace() / 3.0);
        let soft = soft * (self.soft / soft.symmetric_eigenvalues().amax());
        let shares = if self.comes_off { (0.38, 0.42) } else { (0.45, 0.60) };
        let at_s = random.uniform(shares.0, shares.1) * duration_s;
        let until_s = self.comes_off.then(|| random.uniform(0.68, 0.72) * duration_s);
        let is_there = self.hard_ut > 0.0;
        let changes = [Some(at_s), until_s].into_iter().flatten().filter(|_| is_there);
        Drawn {
            course: Course::Held { at_s, over_s: self.over_s, until_s },
            hard_ut,
            soft,
            changes_s: changes.map(|at_s| (at_s, at_s + self.over_s)).collect(),
            begins_s: if is_there { at_s } else { duration_s / 2.0 },
        }
    }
}

impl Drawn {
    /// A row with it, so long after the first, s: the raw field, and the operating system's.
    pub fn put_on(&self, row: &Row, after_s: f64) -> Row {
        let share = self.course.at(after_s);
        let with = |field_ut: Vector3<f64>| field_ut + (self.hard_ut + self.soft * field_ut) * share;
        Row { field_ut: with(row.field_ut), system_ut: row.system_ut.map(with), ..row.clone() }
    }
}

/// A magnet on a recording.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MagnetScore {
    /// The recording.
    pub recording: String,
    /// Its group.
    pub group: String,
    /// The magnet's name.
    pub magnet: &'static str,
    /// What it is.
    pub label: &'static str,
    /// The seed of its direction and time.
    pub seed: u64,
    /// Length of the recording, hours.
    pub hours: f64,
    /// From 5 s after the end of the changes on, root mean square of the heading's error, degrees.
    pub settled_deg: Option<f64>,
    /// Largest error of a heading from the magnet on, degrees.
    pub worst_deg: Option<f64>,
    /// From the begin of each change until a device step is told, s; none where it is not.
    pub told_s: Vec<Option<f64>>,
    /// At the end: b less what it was before the first change and what was added since, uT; none with soft iron.
    pub hard_iron_off_ut: Option<f64>,
    /// As of a simulation, from the magnet on.
    #[serde(flatten)]
    pub figures: Figures,
    /// Rows that were played.
    #[serde(skip)]
    pub rows: usize,
}

/// All magnets on the recordings of a folder.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MagnetTrials {
    /// What they are.
    pub label: &'static str,
    /// Names of the groups, in the order of the index.
    pub groups: Vec<String>,
    /// By recording, magnet and seed.
    pub runs: Vec<MagnetScore>,
    /// Recordings that were left out, with the reason.
    pub warnings: Vec<String>,
}

/// Puts every magnet on every recording of `folder` that has a reference and no magnet of its own, once for each seed; `index` and `threads` as of
/// [`super::judge_folder`].
///
/// # Errors
/// [`RunError::Recording`] names the file that is at fault; [`RunError::Usage`] where a magnet can be put on no recording.
pub fn put_on_folder(
    folder: &Path,
    index: Option<&Path>,
    seeds: &RangeInclusive<u64>,
    ignore: Ignore,
    threads: NonZeroUsize,
) -> Result<MagnetTrials, RunError> {
    let path = folder;
    let folder = Folder::open(path, index)?;
    let played = map_shown("magnets", &folder.paths, threads, |file| -> Result<_, RunError> {
        let trial = folder.read(file)?;
        if !trial.takes_magnets() {
            return Ok((Vec::new(), Some(format!("{}: left out, it has a magnet of its own", trial.name))));
        }
        let mut runs = Vec::new();
        for (magnet, seed) in MAGNETS.iter().flat_map(|magnet| seeds.clone().map(move |seed| (magnet, seed))) {
            let settings = (Method::Auto, ignore, Tunings::default());
            runs.extend(trial.with_magnet(magnet, seed, settings)?);
        }
        let is_short = runs.len() < MAGNETS.len() * seeds.clone().count();
        let short = || format!("{}: too few headings before or after some magnets to judge them", trial.name);
        Ok((runs, is_short.then(short)))
    });
    let (mut runs, mut warnings) = (Vec::new(), Vec::new());
    for found in played {
        let (own, warning): (Vec<MagnetScore>, Option<String>) = found?;
        runs.extend(own);
        warnings.extend(warning);
    }
    if runs.is_empty() {
        let why = "a magnet can be put on no recording of this folder: each needs a minute, 100 headings before it, and none of its own (magnet_s)";
        return Err(RunError::Usage(format!("{}: {why}", path.display())));
    }
    let groups = folder.groups.names().into_iter().map(str::to_owned).collect();
    Ok(MagnetTrials { label: LABEL, groups, runs, warnings })
}

/// A row's errors with the constants still in, and b.
struct Moment {
    sample: Sample,
    hard_iron_ut: Option<Vector3<f64>>,
    event: Option<Event>,
}

impl Trial {
    /// Plays the recording with a magnet put on; none where too little is left to judge: less than 100 headings before it or rows after it.
    pub fn with_magnet(
        &self,
        magnet: &Magnet,
        seed: u64,
        (method, ignore, tunings): (Method, Ignore, Tunings),
    ) -> Result<Option<MagnetScore>, RunError> {
        let player = Player::tuned(config(self.declination_deg), method, ignore, tunings)?;
        Ok(self.magnet_score(magnet, seed, player))
    }

    /// Whether a magnet can be put on: one that sits on it already would be another.
    pub fn takes_magnets(&self) -> bool {
        self.magnet_s.is_none()
    }

    fn magnet_score(&self, magnet: &Magnet, seed: u64, mut player: Player) -> Option<MagnetScore> {
        let (first, last) = (self.rows.first()?, self.rows.last()?);
        let (first_s, first_ns, duration_s) = (first.time_s, first.time_ns, last.time_s - first.time_s);
        let drawn = magnet.draw(&self.name, seed, duration_s);
        let played = self.rows.iter().map(|row| {
            let after_s = row.time_s - first_s;
            moment(&drawn.put_on(row, after_s), after_s, first_ns, &mut player)
        });
        let mut moments: Vec<Moment> = played.collect();
        if !take_constants_out(&mut moments, drawn.begins_s) {
            return None;
        }
        let before = moments.iter().rev().find(|moment| moment.sample.time_s < drawn.begins_s)?.hard_iron_ut;
        for moment in &mut moments {
            let added_ut = drawn.hard_ut * drawn.course.at(moment.sample.time_s);
            let true_ut = before.filter(|_| magnet.soft == 0.0).map(|before| before + added_ut);
            moment.sample.hard_iron_ut = moment.hard_iron_ut.zip(true_ut).map(|(found, it)| (found - it).norm());
        }
        let samples: Vec<Sample> = moments.iter().map(|moment| moment.sample).collect();
        let change = |(begins_s, ends_s): &(f64, f64)| Change {
            begins_s: *begins_s,
            ends_s: *ends_s,
            size_ut: magnet.hard_ut,
            kind: ChangeKind::Device,
        };
        let changes: Vec<Change> = drawn.changes_s.iter().map(change).collect();
        let rate_hz = samples.len() as f64 / duration_s;
        let events = moments.iter().filter_map(|moment| moment.event);
        let figures = Figures::judged(&samples, events, &changes, rate_hz, drawn.begins_s);
        let is_settled =
            |time_s: f64| drawn.changes_s.iter().all(|(from, to)| time_s < *from || time_s > to + SETTLED_S);
        let after = || samples.iter().filter(|sample| sample.time_s > drawn.begins_s);
        let settled = after().filter(|sample| is_settled(sample.time_s)).filter_map(|sample| sample.heading_deg);
        Some(MagnetScore {
            recording: self.name.clone(),
            group: self.group.clone(),
            magnet: magnet.name,
            label: LABEL,
            seed,
            hours: duration_s / 3600.0,
            settled_deg: rms(settled),
            worst_deg: after().filter_map(|sample| sample.heading_deg.map(f64::abs)).reduce(f64::max),
            told_s: figures.stretches[1..].iter().map(|stretch| stretch.declared_s).collect(),
            hard_iron_off_ut: samples.last().and_then(|sample| sample.hard_iron_ut),
            figures,
            rows: samples.len(),
        })
    }
}

/// What the player makes of a row; times are after the first.
fn moment(row: &Row, after_s: f64, first_ns: i64, player: &mut Player) -> Moment {
    let step = player.play(row);
    let reading = &step.reading;
    let true_deg = reference_heading_deg(row, ReferenceAxis::TopEdge);
    let published_deg = reading.heading.map(|heading| heading.true_heading_deg.unwrap_or(heading.heading_deg));
    let azimuth = |field_ut: Option<Vector3<f64>>| field_ut.and_then(|field_ut| azimuth_deg(row, &field_ut));
    let corrected_deg = azimuth(reading.field_ut);
    let sample = Sample {
        time_s: after_s,
        mode: Mode::of(&reading.status),
        is_level: true_deg.is_some(),
        heading_deg: published_deg.zip(true_deg).map(|(found_deg, true_deg)| off_deg(found_deg, true_deg)),
        sigma_deg: reading.heading.and_then(|heading| heading.heading_sigma_deg).filter(|sigma| *sigma > 0.0),
        carried_deg: azimuth(reading.filtered_field_ut),
        corrected_deg,
        calibration_deg: corrected_deg,
        hard_iron_ut: None,
    };
    let event = reading.event.map(|event| Event {
        since_ns: event.since_ns - first_ns,
        decided_ns: event.decided_ns - first_ns,
        ..event
    });
    Moment { sample, hard_iron_ut: step.calibration.map(|known| *known.hard_iron_ut()), event }
}

/// Takes out of each error its constant before the magnet. Says whether there is enough before it and after.
fn take_constants_out(moments: &mut [Moment], begins_s: f64) -> bool {
    let is_before = |sample: &Sample| sample.time_s > FROM_S && sample.time_s < begins_s;
    let is_judged = |sample: &Sample| sample.is_level && sample.time_s > begins_s;
    let judged = moments.iter().filter(|moment| is_judged(&moment.sample)).count();
    let errors: [fn(&mut Sample) -> &mut Option<f64>; 3] =
        [|it| &mut it.heading_deg, |it| &mut it.carried_deg, |it| &mut it.calibration_deg];
    for (k, error) in errors.iter().enumerate() {
        let before = moments.iter_mut().filter(|moment| is_before(&moment.sample));
        let before: Vec<f64> = before.filter_map(|moment| *error(&mut moment.sample)).collect();
        if k == 0 && (before.len() < FEWEST || judged < FEWEST) {
            return false;
        }
        let centre_deg = centre_deg(&before);
        moments.iter_mut().for_each(|moment| {
            let error = error(&mut moment.sample);
            *error = error.map(|error| off_deg(error, centre_deg)).map(|off| if k == 0 { off } else { off.abs() });
        });
    }
    true
}

/// The circular median: that of the sines and that of the cosines.
fn centre_deg(errors_deg: &[f64]) -> f64 {
    let of = |part: fn(f64) -> f64| median(errors_deg.iter().map(|it| part(it.to_radians())).collect()).unwrap_or(0.0);
    if errors_deg.is_empty() { 0.0 } else { of(f64::sin).atan2(of(f64::cos)).to_degrees() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trials::folder::name_of;

    fn lab_sensor() -> Trial {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/recordings");
        let folder = Folder::open(&folder, None).unwrap();
        let path = folder.paths.iter().find(|path| name_of(path) == "broad_01_slow_rotation_A").unwrap();
        folder.read(path).unwrap()
    }

    /// What is added, when, and that it is another one for each recording, magnet and seed, and the same again.
    #[test]
    fn a_magnet_adds_what_it_says_when_it_says() {
        for magnet in &MAGNETS {
            for seed in 1..20 {
                let drawn = magnet.draw("one", seed, 100.0);
                let row = Row { field_ut: Vector3::new(20.0, -5.0, 40.0), ..Row::default() };
                let added = |after_s: f64| drawn.put_on(&row, after_s).field_ut - row.field_ut;
                assert_eq!(added(37.9), Vector3::zeros(), "{}", magnet.name);
                let soft = 0.05 * row.field_ut.norm();
                let whole = added(67.9 + if magnet.comes_off { 0.0 } else { 7.1 });
                let is_whole = (whole.norm() - magnet.hard_ut).abs() <= if magnet.soft > 0.0 { soft } else { 1e-9 };
                assert!(is_whole, "{}: {} uT", magnet.name, whole.norm());
                assert_eq!(magnet.soft > 0.0, drawn.soft != Matrix3::zeros());
                assert!(
                    drawn.soft.trace().abs() < 1e-12
                        && (drawn.soft.symmetric_eigenvalues().amax() - magnet.soft).abs() < 1e-12
                );
                assert_eq!(added(99.0).norm() < 1e-9, magnet.hard_ut == 0.0 || magnet.comes_off, "{}", magnet.name);
                let [first, ..] = drawn.changes_s[..] else {
                    assert_eq!((magnet.hard_ut, drawn.begins_s), (0.0, 50.0));
                    continue;
                };
                assert!((if magnet.comes_off { 38.0..42.0 } else { 45.0..60.0 }).contains(&first.0));
                assert!((first.1 - first.0 - magnet.over_s).abs() < 1e-9);
                assert_eq!(drawn.changes_s.len(), 1 + usize::from(magnet.comes_off));
                assert!(added(first.0 - 0.01).norm() == 0.0 && (added(first.1 + 0.01) - whole).norm() < 1e-9);
            }
        }
        let of = |name: &str, magnet: usize, seed: u64| MAGNETS[magnet].draw(name, seed, 100.0);
        assert_eq!(
            (of("one", 2, 1).hard_ut, of("one", 2, 1).begins_s),
            (of("one", 2, 1).hard_ut, of("one", 2, 1).begins_s)
        );
        for other in [of("two", 2, 1), of("one", 9, 1), of("one", 2, 2)] {
            assert_ne!(of("one", 2, 1).hard_ut, other.hard_ut);
        }
    }

    /// The undisturbed lab sensor: a magnet of 27 uT is told once and costs little; without one nothing is due, and the figures are those of the second half.
    #[test]
    fn a_magnet_is_judged_as_a_change_of_a_simulation_is() {
        let trial = lab_sensor();
        let with = |magnet: &Magnet, ignore| {
            trial.with_magnet(magnet, 1, (Method::Auto, ignore, Tunings::default())).unwrap().unwrap()
        };
        let [none, on, off] = [0, 2, 9].map(|k| with(&MAGNETS[k], Ignore::default()));
        assert_eq!((none.figures.due, none.figures.false_steps, none.told_s.len()), (0, 0, 0));
        assert!(none.figures.error.heading_deg.is_some_and(|deg| (0.3..4.0).contains(&deg)), "{none:?}");
        assert_eq!((on.figures.due, on.figures.missed, off.figures.due), (1, 0, 2));
        assert!(on.told_s[0].is_some_and(|s| (0.0..5.0).contains(&s)), "{:?}", on.told_s);
        assert!(on.hard_iron_off_ut.is_some_and(|ut| ut < 4.0) && on.worst_deg.is_some_and(|deg| deg < 20.0), "{on:?}");
        let alone = with(&MAGNETS[2], Ignore { gyroscope: true, accelerometer: false });
        assert_ne!(alone.figures.error.heading_deg, on.figures.error.heading_deg);
        // soft iron changes b by what it makes of b: that is not told
        assert_eq!(with(&MAGNETS[8], Ignore::default()).hard_iron_off_ut, None);
        assert!(
            Trial { rows: trial.rows[..900].to_vec(), ..lab_sensor() }
                .with_magnet(&MAGNETS[2], 1, (Method::Auto, Ignore::default(), Tunings::default()))
                .unwrap()
                .is_none()
        );
        assert!(trial.takes_magnets() && !Trial { magnet_s: Some((1.0, 2.0)), ..lab_sensor() }.takes_magnets());
    }
}
