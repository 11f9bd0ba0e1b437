//! A recording's figures, and the sums over groups of recordings.

use super::bound::Bounding;
use super::figures::{FIGURES, Worse};
use super::folder::name_of;
use super::groups::{Groups, Rule};
use magcomp::{Config, HeadingConfig, ReferenceAxis};
use magcomp_recordings::error::RecordingError;
use magcomp_recordings::import::{ImportOptions, Opened, open};
use magcomp_recordings::recording::{Extent, Row};
use magcomp_replay::error::RunError;
use magcomp_replay::{Ignore, Judge, Judgement, Player, usual_part};
use serde::Serialize;
use std::borrow::Borrow;
use std::collections::BTreeMap;
use std::path::Path;

/// The axis whose heading is judged: the top edge of the screen.
const AXIS: ReferenceAxis = ReferenceAxis::TopEdge;

/// The figures of one recording.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Score {
    /// Its name: that of its file, without .csv or .csv.gz.
    pub recording: String,
    /// Its group.
    pub group: String,
    /// How far magnetic north is east of the reference's, degrees.
    pub declination_deg: f64,
    /// Its length, hours.
    pub hours: f64,
    /// Rows whose heading is judged.
    pub rows: usize,
    /// Device steps that were declared.
    pub device_steps: usize,
    /// By name ([`FIGURES`]); none where too few rows have one.
    #[serde(flatten)]
    pub figures: BTreeMap<&'static str, Option<f64>>,
}

/// A figure over the recordings of a group that have it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// Median: the mean of the middle two of an even number.
    pub median: f64,
    /// Nine of ten are not worse, linear between two of them.
    pub p90: f64,
    /// The worst of all.
    pub worst: f64,
}

/// The sums over a group.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GroupScore {
    /// Its name.
    pub group: String,
    /// Its recordings.
    pub recordings: usize,
    /// Their length, hours.
    pub hours: f64,
    /// Device steps that were declared in all of them.
    pub device_steps: usize,
    /// By name ([`FIGURES`]); none where no recording has one.
    #[serde(flatten)]
    pub figures: BTreeMap<&'static str, Option<Summary>>,
}

/// What a folder of recordings came to.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Trials {
    /// By name.
    pub recordings: Vec<Score>,
    /// In the order of the index.
    pub groups: Vec<GroupScore>,
    /// Parts that may be wrong: numbers that are rare in a recording, lines of the index that fit nothing.
    pub warnings: Vec<String>,
}

impl Score {
    /// Plays a recording and judges it. Warnings about it come beside.
    pub(super) fn of(path: &Path, groups: &Groups, ignore: Ignore) -> Result<(Self, Vec<String>), RunError> {
        let recording = name_of(path);
        let Rule { group, declination_deg, .. } = groups.find(&recording);
        let opened = open(&[path.to_owned()], &ImportOptions::default())?;
        let warnings = opened.warnings.clone();
        let (found, bound_deg) = judged(opened, *declination_deg, ignore)?;
        let score = Self {
            group: group.to_owned(),
            recording,
            declination_deg: *declination_deg,
            hours: found.duration_s / 3600.0,
            rows: found.absolute_heading.rows,
            device_steps: found.device_changes.len(),
            figures: FIGURES.iter().map(|figure| (figure.name, (figure.of)(&found, bound_deg))).collect(),
        };
        Ok((score, warnings))
    }
}

/// A recording through the default config, with its declination; and the bound, degrees.
fn judged(
    Opened { mut source, .. }: Opened,
    declination_deg: f64,
    ignore: Ignore,
) -> Result<(Judgement, Option<f64>), RunError> {
    let player = Player::new(&config(declination_deg), ignore)?;
    let extent = *source.extent();
    let mut bounding = Bounding::default();
    let rows = source.rows()?.inspect(|row| row.iter().for_each(|row| bounding.add(row)));
    let found = judge_rows(player, &extent, rows)?;
    Ok((found, bounding.finish()))
}

/// The default config where magnetic north is so far east of the reference's.
pub(super) fn config(declination_deg: f64) -> Config {
    let heading = HeadingConfig { axis: AXIS, declination_deg: Some(declination_deg), ..HeadingConfig::default() };
    Config { heading, ..Config::default() }
}

/// Rows through a player, judged from 20 s after the first of them on.
pub(super) fn judge_rows<R: Borrow<Row>>(
    mut player: Player,
    extent: &Extent,
    rows: impl Iterator<Item = Result<R, RecordingError>>,
) -> Result<Judgement, RunError> {
    let mut judge = Judge::new(extent, usual_part(extent), AXIS);
    for row in rows {
        let row = row?;
        judge.add(row.borrow(), &player.play(row.borrow()));
    }
    Ok(judge.finish())
}

/// Scores, and the warnings of all of them and of the index.
pub(super) fn with_warnings(scores: Vec<(Score, Vec<String>)>, groups: &Groups) -> (Vec<Score>, Vec<String>) {
    let (scores, warnings): (Vec<Score>, Vec<Vec<String>>) = scores.into_iter().unzip();
    let mut warnings = warnings.concat();
    warnings.extend(groups.unused(scores.iter().map(|score| score.recording.as_str())));
    (scores, warnings)
}

impl GroupScore {
    /// Of all groups that have recordings, in the order of the index.
    pub(super) fn of_all(scores: &[Score], groups: &Groups) -> Vec<Self> {
        let of = |group: &str| {
            let own: Vec<&Score> = scores.iter().filter(|score| score.group == group).collect();
            (!own.is_empty()).then(|| Self::of(group, &own))
        };
        groups.names().into_iter().filter_map(of).collect()
    }

    fn of(group: &str, scores: &[&Score]) -> Self {
        let summed = FIGURES.iter().filter(|figure| figure.worse != Worse::Neither);
        let summary = |figure: &super::Figure| {
            let values = scores.iter().filter_map(|score| score.figures[figure.name]);
            (figure.name, Summary::of(values.collect(), figure.worse))
        };
        Self {
            group: group.to_owned(),
            recordings: scores.len(),
            hours: scores.iter().map(|score| score.hours).sum(),
            device_steps: scores.iter().map(|score| score.device_steps).sum(),
            figures: summed.map(summary).collect(),
        }
    }
}

impl Summary {
    /// None of no values.
    pub(super) fn of(mut values: Vec<f64>, worse: Worse) -> Option<Self> {
        values.sort_by(f64::total_cmp);
        if worse == Worse::Small {
            values.reverse();
        }
        let last = values.len().checked_sub(1)?;
        let at = |share: f64| {
            let place = share * last as f64;
            let (below, above) = (place.floor() as usize, place.ceil() as usize);
            values[below] + (values[above] - values[below]) * place.fract()
        };
        Some(Self { median: at(0.5), p90: at(0.9), worst: values[last] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nine_of_ten_are_not_worse_whichever_side_is_bad() {
        let values: Vec<f64> = (0..=10).rev().map(f64::from).collect();
        let large = Summary::of(values.clone(), Worse::Large).unwrap();
        assert_eq!(large, Summary { median: 5.0, p90: 9.0, worst: 10.0 });
        let small = Summary::of(values, Worse::Small).unwrap();
        assert_eq!(small, Summary { median: 5.0, p90: 1.0, worst: 0.0 });
        assert_eq!(Summary::of(vec![1.0, 2.0], Worse::Large).unwrap().median, 1.5);
        assert_eq!(Summary::of(Vec::new(), Worse::Large), None);
    }
}
