//! What choices and mechanisms are tried on: simulated groups and recordings, each made or read once and played with every setting.

use super::score::{Kind, Outcome, Unit, Way};
use crate::catalogue::{Group, Variant, find};
use crate::score::Figures;
use crate::trials::{Folder, MAGNETS, MagnetScore, Trial, TrialScore};
use magcomp::{Config, Method, Tunings};
use magcomp_replay::error::RunError;
use magcomp_replay::{Ignore, Player, Step};
use std::path::Path;

/// A variant or two of every group that exercises the estimator with a gyroscope: extend it with the catalogue.
const WITH_GYROSCOPE: &[&str] = &[
    "phone-walk-drift",
    "one-axis.random-0.6",
    "pause.2s-b",
    "latitude.58ut85-walk",
    "steps.b50-m",
    "motion.walk",
    "places.uneven5",
    "places.room60s",
    "sensors.late40-game",
    "faults.gyroflipped-walk",
    "swinging.bridge-mixed",
    "shaken.sway",
    "magnets.strong-walk",
    "magnets.start-strong-walk",
    "back.thrice-walk",
    "back.place-back-walk",
    "launches.30ut-at-rest",
    "resampled.line8-look",
    "slow.all10-mixed",
    "conventions.degrees-look",
    "accelerometer.frozen-game",
    "gyroscope.zeros-walk",
];
/// The same for the magnetometer alone. A walker who turns seldom is no task there, and a stream without an accelerometer has no heading.
const ALONE: &[&str] = &[
    "alone.step",
    "alone.stroll-steady",
    "alone.place",
    "alone.drift",
    "motion.game",
    "motion.look",
    "sensors.noise1-game",
    "faults.accelbias-game",
];
/// Direction and time of the magnets on recordings.
const MAGNETS_SEED: u64 = 1;
/// Mechanisms that read the same state, with their part: each pair of a line is tried off at once.
pub(super) const TOGETHER: &[(&str, &[&str])] = &[
    ("aided", &["hold", "left", "ramp", "new_place", "quarantine", "probation"]),
    ("aided", &["unevenness", "local_learning", "local_gate", "followed", "hard_iron_walk"]),
    ("aided", &["gyroscope_axes", "delay", "recent", "second_order"]),
    ("aided", &["follow", "long_up"]),
    ("aided", &["misfit", "feigned", "forget"]),
    ("adaptive", &["cold_again", "leap", "twins", "spread"]),
    ("adaptive", &["looks", "moves", "gradual", "recall"]),
    ("adaptive", &["rough", "unevenness", "stays"]),
    ("adaptive", &["tilting", "accelerometer_bias"]),
    ("compensator", &["rails", "stuck"]),
];
/// Parts of the core that have a part in one way alone; all others are tried in both.
const IN_ONE_WAY: [(&str, Way); 3] =
    [("adaptive", Way::Alone), ("aided", Way::WithGyroscope), ("start", Way::WithGyroscope)];

impl Way {
    pub const ALL: [Self; 2] = [Self::WithGyroscope, Self::Alone];

    /// The ways in which a part of the core works.
    pub fn of(part: &str) -> Vec<Self> {
        let one = IN_ONE_WAY.iter().find(|(name, _)| *name == part);
        one.map_or(Self::ALL.to_vec(), |(_, way)| vec![*way])
    }

    /// In tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::WithGyroscope => "with gyroscope",
            Self::Alone => "alone",
        }
    }

    /// Its variants, of these groups if there are any.
    pub fn variants(self, groups: &[Group]) -> Result<Vec<Variant>, RunError> {
        let names = match self {
            Self::WithGyroscope => WITH_GYROSCOPE,
            Self::Alone => ALONE,
        };
        let mut variants =
            names.iter().map(|name| find(name).map_err(RunError::Usage)).collect::<Result<Vec<_>, _>>()?;
        variants.retain(|variant| groups.is_empty() || groups.contains(&variant.group));
        Ok(variants)
    }

    fn method(self) -> Method {
        match self {
            Self::WithGyroscope => Method::Auto,
            Self::Alone => Method::Adaptive,
        }
    }

    fn ignore(self) -> Ignore {
        Ignore { gyroscope: self == Self::Alone, accelerometer: false }
    }

    /// How long after the first row of a recording it is begun, s: without a gyroscope much hangs on how a recording happens to begin.
    fn begins_s(self) -> &'static [f64] {
        match self {
            Self::WithGyroscope => &[0.0],
            Self::Alone => &[0.0, 3.0, 6.0, 9.0, 12.0],
        }
    }
}

/// The stream of a variant and a seed with every setting, and the samples that were played.
pub(super) fn stream(way: Way, variant: &Variant, seed: u64, settings: &[Tunings]) -> Result<(Unit, usize), RunError> {
    let scenario = variant.scenario(seed);
    let (simulation, initial) = (scenario.run(), variant.initial(&scenario));
    let recording = simulation.recording(&variant.name);
    let outcomes = settings.iter().map(|tunings| {
        let config = Config { initial, ..variant.config() };
        let mut player = Player::tuned(config, way.method(), way.ignore(), *tunings)?.adopting(variant.kept(&scenario));
        let steps: Vec<Step> = recording.rows.iter().map(|row| player.play(row)).collect();
        let figures = Figures::of(&simulation, &steps);
        Ok(Outcome {
            false_steps: figures.false_steps as f64,
            hours: variant.duration_s / 3600.0,
            ..Outcome::of(figures.answered.unwrap_or(1.0), figures.error.heading_deg, figures.z2)
        })
    });
    let outcomes = outcomes.collect::<Result<Vec<_>, RunError>>()?;
    let unit = Unit {
        way,
        kind: Kind::Stream,
        name: variant.name.clone(),
        group: variant.group.name(),
        stratum: variant.name.clone(),
        outcomes,
    };
    Ok((unit, recording.rows.len() * settings.len()))
}

/// A recording with every setting of each way, and the samples that were played. A way in which it cannot be judged is left out.
pub(super) fn trial(
    folder: &Folder,
    path: &Path,
    settings: &[(Way, Vec<Tunings>)],
) -> Result<(Vec<Unit>, usize), RunError> {
    let trial = folder.read(path)?;
    let (mut units, mut rows) = (Vec::new(), 0);
    for (way, settings) in settings {
        let (with_magnets, played) = magnets(&trial, *way, settings)?;
        units.extend(with_magnets);
        rows += played;
        let mut outcomes = Vec::new();
        for tunings in settings {
            let begun = way.begins_s().iter().map(|begin_s| trial.play(*begin_s, way.method(), way.ignore(), *tunings));
            let scores: Vec<TrialScore> = begun.filter_map(Result::transpose).collect::<Result<_, _>>()?;
            rows += scores.iter().map(|score| score.rows).sum::<usize>();
            outcomes.extend(together(&scores));
        }
        if outcomes.len() == settings.len() {
            let (name, group) = (trial.name.clone(), trial.group.clone());
            units.push(Unit { way: *way, kind: Kind::Trial, stratum: group.clone(), name, group, outcomes });
        }
    }
    Ok((units, rows))
}

/// Every magnet on a trial with every setting, and the samples that were played; those that can't be judged with each setting are left out.
fn magnets(trial: &Trial, way: Way, settings: &[Tunings]) -> Result<(Vec<Unit>, usize), RunError> {
    let (mut units, mut rows) = (Vec::new(), 0);
    // the first of them is none
    for magnet in MAGNETS.iter().skip(1).filter(|_| trial.takes_magnets()) {
        let play = |tunings: &Tunings| trial.with_magnet(magnet, MAGNETS_SEED, (way.method(), way.ignore(), *tunings));
        let scores = settings.iter().filter_map(|tunings| play(tunings).transpose());
        let scores: Vec<MagnetScore> = scores.collect::<Result<_, _>>()?;
        rows += scores.iter().map(|score| score.rows).sum::<usize>();
        let outcome = |score: &MagnetScore| {
            let figures = &score.figures;
            Outcome {
                false_steps: (figures.false_steps + figures.again + figures.missed) as f64,
                hours: score.hours,
                ..Outcome::of(figures.answered.unwrap_or(1.0), score.settled_deg, figures.z2)
            }
        };
        if scores.len() == settings.len() {
            let (name, group) = (trial.name.clone(), format!("magnet, {}", magnet.name));
            let outcomes = scores.iter().map(outcome).collect();
            units.push(Unit { way, kind: Kind::Magnet, stratum: group.clone(), name, group, outcomes });
        }
    }
    Ok((units, rows))
}

/// The plays of one trial as one: means of error and z2, all of the false steps and hours, the worst absolute heading.
fn together(scores: &[TrialScore]) -> Option<Outcome> {
    let each = scores.iter().map(|it| Outcome::of(it.answered, it.heading_deg, it.z2));
    let count = scores.len() as f64;
    let mean = each.reduce(|a, b| Outcome { error: a.error + b.error, z2: a.z2 + b.z2, ..a })?;
    Some(Outcome {
        error: mean.error / count,
        z2: mean.z2 / count,
        false_steps: scores.iter().map(|it| it.false_steps as f64).sum(),
        hours: scores.iter().map(|it| it.hours).sum(),
        absolute_deg: scores.iter().filter_map(|it| it.absolute_deg).reduce(f64::max),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::ValueEnum;

    /// A group that is new in the catalogue must be exercised here: those below have no heading with a gyroscope, or last for half an hour.
    #[test]
    fn every_group_is_tried() {
        let named = |way: Way| way.variants(&[]).unwrap().into_iter().map(|variant| variant.group).collect::<Vec<_>>();
        let all = Way::ALL.map(named).concat();
        for group in Group::value_variants() {
            let is_left_out = matches!(group, Group::Long | Group::Paper);
            assert_eq!(all.contains(group), !is_left_out, "{group:?}: give it a variant or two above");
        }
        let few = Way::Alone.variants(&[Group::Alone]).unwrap();
        assert!(few.len() == 4 && Way::WithGyroscope.variants(&[Group::Alone]).unwrap().is_empty());
    }

    #[test]
    fn a_part_is_tried_where_it_works() {
        let of = |part| Way::of(part);
        assert_eq!((of("adaptive"), of("aided")), (vec![Way::Alone], vec![Way::WithGyroscope]));
        assert_eq!((of("start"), of("sensing")), (vec![Way::WithGyroscope], Way::ALL.to_vec()));
    }

    #[test]
    fn mechanisms_that_read_the_same_state_are_mechanisms_of_their_part() {
        for (part, names) in TOGETHER {
            for name in *names {
                let is_there = magcomp::Tunings::mechanisms().any(|(own, it)| own == *part && it.name == *name);
                assert!(is_there, "{part} has no mechanism {name} any more: take it out of TOGETHER");
            }
        }
    }

    #[test]
    fn plays_of_one_trial_are_one() {
        let score = |heading_deg, answered, absolute_deg, false_steps| TrialScore {
            heading_deg,
            answered,
            z2: Some(4.0),
            absolute_deg,
            false_steps,
            hours: 0.5,
            rows: 10,
        };
        let found = together(&[score(Some(2.0), 1.0, Some(5.0), 1), score(None, 0.0, None, 2)]).unwrap();
        // no heading counts as 30 degrees
        assert!((found.error - (2.0_f64 * 30.0).ln() / 2.0).abs() < 1e-12 && (found.z2 - 4.0_f64.ln()).abs() < 1e-12);
        assert_eq!((found.false_steps, found.hours, found.absolute_deg), (3.0, 1.0, Some(5.0)));
        assert_eq!(together(&[]), None);
    }
}
