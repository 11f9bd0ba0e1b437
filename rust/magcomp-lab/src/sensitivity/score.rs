//! How far a setting moves a figure, and how far chance does.
//!
//! A figure is the mean of what each stream, or each trial, changes by: each is its own comparison, with the setting and without. Its noise
//! is that mean's standard error: from seed to seed of each variant, or from trial to trial.

/// No error counts more, or less, degrees; no z2 less.
const MOST_DEG: f64 = 30.0;
const LEAST_DEG: f64 = 0.1;
const LEAST_Z2: f64 = 0.01;
/// A figure has moved that changes by so many times its noise.
pub(super) const MOVED: f64 = 2.0;
/// One group's has where it does by so many: it is the most of all groups, and of some forty figures chance alone moves one by three.
pub(super) const MOVED_IN_A_GROUP: f64 = 4.0;
/// The least noise, of logarithms and of degrees: a change of less than twice that is worth no choice.
const LEAST_NOISE: f64 = 0.005;
const LEAST_NOISE_DEG: f64 = 0.05;

/// With which sensors a setting is tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    WithGyroscope,
    Alone,
}

/// What one setting comes to on one stream or trial.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Outcome {
    /// Logarithms of the heading's error, degrees, and of z2.
    pub error: f64,
    pub z2: f64,
    /// Device steps that nothing explains, of a magnet also those that tell it again and the one that does not come; and in how many hours.
    pub false_steps: f64,
    pub hours: f64,
    /// Error with the reference's constant left in, degrees.
    pub absolute_deg: Option<f64>,
}

impl Outcome {
    /// The share without a heading counts as the largest error. It does so in logarithms: squares of 30 degrees would hide all others.
    pub fn of(answered: f64, heading_deg: Option<f64>, z2: Option<f64>) -> Self {
        let error = heading_deg.unwrap_or(MOST_DEG).clamp(LEAST_DEG, MOST_DEG).ln();
        let error = answered * error + (1.0 - answered) * MOST_DEG.ln();
        Self { error, z2: z2.unwrap_or(1.0).max(LEAST_Z2).ln(), ..Self::default() }
    }
}

/// What is played.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    /// A simulated stream.
    Stream,
    /// A recording.
    Trial,
    /// A recording with a magnet put on: arithmetic.
    Magnet,
}

/// One of them with every setting of its way; the usual one is the first.
#[derive(Clone, Debug)]
pub(super) struct Unit {
    pub way: Way,
    pub kind: Kind,
    pub name: String,
    pub group: String,
    /// Units that are alike but for chance.
    pub stratum: String,
    pub outcomes: Vec<Outcome>,
}

/// How far a figure moves, and its noise; infinite where it cannot be told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Moved {
    pub by: f64,
    pub noise: f64,
}

impl Moved {
    /// How many times its noise.
    pub fn noises(&self, least_noise: f64) -> f64 {
        self.by.abs() / self.noise.max(least_noise)
    }
}

/// All figures of one setting; none where nothing was tried that has them.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Moves {
    /// Logarithms of error and z2 of the simulated groups.
    pub streams: Option<[Moved; 2]>,
    /// The group, of streams or trials, that moves by the most noises: its name, which figure, and by how much.
    pub most: Option<(String, &'static str, Moved)>,
    /// Logarithms of error and z2 of the recordings.
    pub trials: Option<[Moved; 2]>,
    /// False device steps an hour of the recordings.
    pub false_per_h: Option<Moved>,
    /// The worst absolute heading of the recordings, degrees.
    pub worst_deg: Option<Moved>,
    /// Logarithms of error and z2 behind magnets put on recordings, and wrong and missed device steps an hour.
    pub magnets: Option<[Moved; 2]>,
    pub wrong_per_h: Option<Moved>,
}

/// Settings whose figures are added, and those that are taken off.
pub(super) struct Contrast {
    pub plus: Vec<usize>,
    pub minus: Vec<usize>,
}

impl Contrast {
    /// A setting against the usual one.
    pub fn of(setting: usize) -> Self {
        Self { plus: vec![setting], minus: vec![0] }
    }

    /// What both at once change beyond the sum of what each does.
    pub fn beyond(both: usize, one: usize, other: usize) -> Self {
        Self { plus: vec![both, 0], minus: vec![one, other] }
    }

    fn change(&self, unit: &Unit, figure: impl Fn(&Outcome) -> f64) -> f64 {
        let sum = |settings: &[usize]| settings.iter().map(|at| figure(&unit.outcomes[*at])).sum::<f64>();
        sum(&self.plus) - sum(&self.minus)
    }
}

/// The mean over strata of their means, and its standard error.
pub(super) fn mean_of<'a>(changes: impl Iterator<Item = (&'a str, f64)>) -> Option<Moved> {
    let mut strata: Vec<(&str, Vec<f64>)> = Vec::new();
    for (name, change) in changes {
        match strata.iter_mut().find(|(own, _)| *own == name) {
            Some((_, all)) => all.push(change),
            None => strata.push((name, vec![change])),
        }
    }
    let count = strata.len() as f64;
    let (mut by, mut variance) = (0.0, 0.0);
    for (_, all) in &strata {
        let size = all.len() as f64;
        let mean = all.iter().sum::<f64>() / size;
        let squares: f64 = all.iter().map(|change| (change - mean).powi(2)).sum();
        by += mean / count;
        variance += if all.len() > 1 { squares / (size - 1.0) / size / count.powi(2) } else { f64::INFINITY };
    }
    (!strata.is_empty()).then(|| Moved { by, noise: variance.sqrt() })
}

impl Moves {
    /// Of these settings.
    pub fn of(units: &[&Unit], contrast: &Contrast) -> Self {
        let of = |kind: Kind| units.iter().copied().filter(move |unit| unit.kind == kind);
        type Figure = fn(&Outcome) -> f64;
        let change = |unit: &Unit, figure: Figure| contrast.change(unit, figure);
        let figures: [(&'static str, Figure); 2] = [("error", |it| it.error), ("z2", |it| it.z2)];
        let both = |found: [Option<Moved>; 2]| found[0].zip(found[1]).map(|(error, z2)| [error, z2]);
        let mut groups: Vec<(Kind, &str)> = units.iter().map(|unit| (unit.kind, unit.group.as_str())).collect();
        groups.sort_unstable();
        groups.dedup();
        let each = groups.into_iter().flat_map(|(kind, group)| {
            figures.map(|(name, figure)| {
                let own = of(kind).filter(|unit| unit.group == group);
                Some((group.to_owned(), name, mean_of(own.map(|unit| (unit.stratum.as_str(), change(unit, figure))))?))
            })
        });
        let most = each.flatten().filter(|(_, _, moved)| moved.noises(LEAST_NOISE) > 0.0);
        let (trials, magnets): (Vec<&Unit>, Vec<&Unit>) = (of(Kind::Trial).collect(), of(Kind::Magnet).collect());
        // one stratum: trials of one kind are few
        let spread = |units: &[&Unit], figure| mean_of(by_recording(units, |unit| change(unit, figure)).into_iter());
        Self {
            streams: both(figures.map(|(_, figure)| {
                mean_of(of(Kind::Stream).map(|unit| (unit.stratum.as_str(), change(unit, figure))))
            })),
            most: most.max_by(|(_, _, a), (_, _, b)| a.noises(LEAST_NOISE).total_cmp(&b.noises(LEAST_NOISE))),
            trials: both(figures.map(|(_, figure)| spread(&trials, figure))),
            false_per_h: false_per_h(&trials, contrast),
            // the worst of a sum is none of a setting
            worst_deg: (contrast.minus == [0]).then(|| worst_deg(&trials, contrast.plus[0])).flatten(),
            magnets: both(figures.map(|(_, figure)| spread(&magnets, figure))),
            wrong_per_h: false_per_h(&magnets, contrast),
        }
    }

    /// The names of the figures that move.
    pub fn moved(&self) -> Vec<&'static str> {
        let mut moved = Vec::new();
        let mut add = |name, found: Option<Moved>, least| {
            if found.is_some_and(|found| found.noises(least) > MOVED) {
                moved.push(name);
            }
        };
        let [error, z2] = self.streams.map_or([None; 2], |both| both.map(Some));
        add("error", error, LEAST_NOISE);
        add("z2", z2, LEAST_NOISE);
        let [error, z2] = self.trials.map_or([None; 2], |both| both.map(Some));
        add("recorded error", error, LEAST_NOISE);
        add("recorded z2", z2, LEAST_NOISE);
        add("false steps", self.false_per_h, 0.0);
        add("worst", self.worst_deg, LEAST_NOISE_DEG);
        let [error, z2] = self.magnets.map_or([None; 2], |both| both.map(Some));
        add("magnets' error", error, LEAST_NOISE);
        add("magnets' z2", z2, LEAST_NOISE);
        add("magnets' steps", self.wrong_per_h, 0.0);
        if self.most.as_ref().is_some_and(|(_, _, moved)| moved.noises(LEAST_NOISE) > MOVED_IN_A_GROUP) {
            moved.push("a group");
        }
        moved
    }
}

/// The mean over what was played of each recording: magnets on one are not independent.
fn by_recording<'a>(units: &[&'a Unit], change: impl Fn(&Unit) -> f64) -> Vec<(&'a str, f64)> {
    let mut names: Vec<&str> = units.iter().map(|unit| unit.name.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    let mean = |name: &str| {
        let own: Vec<f64> = units.iter().filter(|unit| unit.name == name).map(|unit| change(unit)).collect();
        ("", own.iter().sum::<f64>() / own.len() as f64)
    };
    names.into_iter().map(mean).collect()
}

/// False device steps an hour of all trials together; its noise is that of a ratio of sums.
fn false_per_h(trials: &[&Unit], contrast: &Contrast) -> Option<Moved> {
    let hours: f64 = trials.iter().map(|unit| unit.outcomes[0].hours).sum();
    let change = |unit: &Unit| contrast.change(unit, |it| it.false_steps);
    let by = trials.iter().map(|unit| change(unit)).sum::<f64>() / hours;
    let squares: f64 = trials.iter().map(|unit| (change(unit) - by * unit.outcomes[0].hours).powi(2)).sum();
    let count = trials.len() as f64;
    let noise = if trials.len() > 1 { (squares * count / (count - 1.0)).sqrt() / hours } else { f64::INFINITY };
    (hours > 0.0).then_some(Moved { by, noise })
}

/// The trials' absolute headings with a setting, the worst first, degrees.
pub(super) fn absolute_deg<'a>(trials: &[&'a Unit], setting: usize) -> Vec<(f64, &'a str)> {
    let each = trials.iter().filter_map(|unit| Some((unit.outcomes[setting].absolute_deg?, unit.name.as_str())));
    let mut all: Vec<(f64, &str)> = each.collect();
    all.sort_by(|(a, _), (b, _)| b.total_cmp(a));
    all
}

/// The worst absolute heading; its noise is how far the third worst usually is from it: which trial is the worst, and how bad it is, is chance.
fn worst_deg(trials: &[&Unit], setting: usize) -> Option<Moved> {
    let usual = absolute_deg(trials, 0);
    let worst = absolute_deg(trials, setting).first()?.0;
    let first = usual.first()?.0;
    Some(Moved { by: worst - first, noise: usual.get(2).map_or(f64::INFINITY, |third| first - third.0) })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit(kind: Kind, group: &str, stratum: &str, errors: [f64; 2]) -> Unit {
        let outcomes = errors.map(|error| Outcome { error, hours: 0.1, ..Outcome::default() }).to_vec();
        let (group, stratum) = (group.to_owned(), stratum.to_owned());
        Unit { way: Way::Alone, kind, name: "r".to_owned(), group, stratum, outcomes }
    }

    #[test]
    fn no_heading_counts_in_full_and_nothing_counts_more() {
        let error = |answered, heading_deg| Outcome::of(answered, heading_deg, None).error.exp();
        assert!((error(1.0, Some(5.0)) - 5.0).abs() < 1e-12 && (error(1.0, Some(90.0)) - 30.0).abs() < 1e-12);
        assert!((error(0.75, Some(6.0)) - 6.0_f64.powf(0.75) * 30.0_f64.powf(0.25)).abs() < 1e-9);
        assert!((error(0.0, None) - 30.0).abs() < 1e-12 && (error(1.0, Some(0.0)) - 0.1).abs() < 1e-12);
        let z2 = |z2| Outcome::of(1.0, Some(1.0), z2).z2.exp();
        assert!(
            (z2(None) - 1.0).abs() < 1e-12
                && (z2(Some(0.0)) - 0.01).abs() < 1e-12
                && (z2(Some(7.0)) - 7.0).abs() < 1e-12
        );
    }

    /// By hand: two strata, means 2 and 6; standard errors 1 and 2.
    #[test]
    fn a_mean_of_strata_has_the_noise_within_them() {
        let found = mean_of([("a", 1.0), ("b", 4.0), ("a", 3.0), ("b", 8.0)].into_iter()).unwrap();
        assert!((found.by - 4.0).abs() < 1e-12 && (found.noise - 5.0_f64.sqrt() / 2.0).abs() < 1e-12, "{found:?}");
        // what differs between strata is no noise, and one of a kind tells none
        assert_eq!(
            mean_of([("a", 1.0), ("a", 1.0), ("b", 9.0), ("b", 9.0)].into_iter()).unwrap(),
            Moved { by: 5.0, noise: 0.0 }
        );
        assert_eq!(mean_of([("a", 1.0), ("a", 1.0), ("b", 9.0)].into_iter()).unwrap().noise, f64::INFINITY);
        assert_eq!(mean_of(std::iter::empty()), None);
    }

    #[test]
    fn one_group_that_moves_is_named_though_all_together_do_not() {
        let quiet =
            |k: usize| unit(Kind::Stream, "motion", ["m1", "m2", "m3"][k % 3], [1.0, 1.0 + [0.2, -0.2][k / 3 % 2]]);
        let mut units: Vec<Unit> = (0..12).map(quiet).collect();
        units.extend((0..4).map(|k| unit(Kind::Stream, "magnets", "g", [1.0, 1.1 + 0.01 * f64::from(k)])));
        let all: Vec<&Unit> = units.iter().collect();
        let moves = Moves::of(&all, &Contrast::of(1));
        let (group, figure, moved) = moves.most.clone().unwrap();
        assert_eq!((group.as_str(), figure), ("magnets", "error"));
        assert!((moved.by - 0.115).abs() < 1e-9 && moves.moved() == ["a group"], "{moves:?}");
        let [error, z2] = moves.streams.unwrap();
        assert!((error.by - 0.115 / 4.0).abs() < 1e-9 && error.noise > error.by / 2.0 && z2.by == 0.0, "{error:?}");
        assert!(moves.trials.is_none() && moves.worst_deg.is_none() && moves.false_per_h.is_none());
        // nothing moves against itself
        let still = Moves::of(&all, &Contrast::of(0));
        assert!(still.moved().is_empty() && still.most.is_none());
        // in every group alike it is all of them
        let same: Vec<Unit> = units.iter().map(|it| unit(Kind::Stream, &it.group, &it.stratum, [1.0, 1.015])).collect();
        assert_eq!(Moves::of(&same.iter().collect::<Vec<_>>(), &Contrast::of(1)).moved(), ["error"]);
        let less: Vec<Unit> = units.iter().map(|it| unit(Kind::Stream, &it.group, &it.stratum, [1.0, 1.009])).collect();
        assert!(Moves::of(&less.iter().collect::<Vec<_>>(), &Contrast::of(1)).moved().is_empty());
    }

    #[test]
    fn false_steps_and_the_worst_count_where_they_exceed_their_noise() {
        let trial = |usual_deg, deg, steps| {
            let mut unit = unit(Kind::Trial, "g", "g", [1.0; 2]);
            unit.outcomes[0].absolute_deg = Some(usual_deg);
            unit.outcomes[1].absolute_deg = deg;
            (unit.outcomes[0].false_steps, unit.outcomes[1].false_steps) = (1.0, 1.0 + steps);
            unit
        };
        let moves = |trials: &[Unit]| Moves::of(&trials.iter().collect::<Vec<_>>(), &Contrast::of(1));
        // one trial of four with two more steps is chance, one more in each is not
        let one =
            moves(&[trial(10.0, Some(10.0), 2.0), trial(9.0, None, 0.0), trial(7.0, None, 0.0), trial(1.0, None, 0.0)]);
        let Moved { by, noise } = one.false_per_h.unwrap();
        // 2 steps in 0.4 h; deviations 1.5, -0.5, -0.5, -0.5
        assert!((by - 5.0).abs() < 1e-9 && (noise - (3.0_f64 * 4.0 / 3.0).sqrt() / 0.4).abs() < 1e-9);
        assert!(one.moved().is_empty(), "{:?}", one.moved());
        let each = [10.0, 9.0, 7.0].map(|deg| trial(deg, Some(deg), 1.0));
        assert_eq!(moves(&each).moved(), ["false steps"]);
        // the third worst is 3 degrees from the worst
        for (worst_deg, is_moved) in [(15.9, false), (16.1, true), (4.1, false), (3.9, true)] {
            let found = moves(&[10.0, 9.0, 7.0].map(|deg| trial(deg, Some(worst_deg), 0.0)));
            assert_eq!(found.moved() == ["worst"], is_moved, "{worst_deg}: {found:?}");
        }
    }

    /// Five magnets on each of two recordings are two that differ, not ten; and what both of two mechanisms do beyond the sum of what each does.
    #[test]
    fn magnets_on_one_recording_are_one_and_a_pair_counts_beyond_its_parts() {
        let magnet = |recording: &str, errors: [f64; 4]| {
            let mut unit = unit(Kind::Magnet, "27 uT", "27 uT", [0.0; 2]);
            unit.outcomes = errors.map(|error| Outcome { error, hours: 0.1, ..Outcome::default() }).to_vec();
            (unit.outcomes[3].false_steps, unit.name) = (2.0, recording.to_owned());
            unit
        };
        // alone they do 0.1 and 0.2, together 0.5 and 0.7
        let mut units: Vec<Unit> = (0..5).map(|_| magnet("one", [1.0, 1.1, 1.2, 1.5])).collect();
        units.extend((0..5).map(|_| magnet("two", [2.0, 2.1, 2.2, 2.7])));
        let all: Vec<&Unit> = units.iter().collect();
        let both = Moves::of(&all, &Contrast::of(3));
        let [error, _] = both.magnets.unwrap();
        assert!((error.by - 0.6).abs() < 1e-9 && (error.noise - 0.1).abs() < 1e-9, "{error:?}");
        assert!(
            (both.wrong_per_h.unwrap().by - 20.0).abs() < 1e-9
                && both.moved() == ["magnets' error", "magnets' steps", "a group"]
        );
        let beyond = Moves::of(&all, &Contrast::beyond(3, 1, 2));
        assert!((beyond.magnets.unwrap()[0].by - 0.3).abs() < 1e-9 && beyond.worst_deg.is_none());
        assert!(both.trials.is_none() && both.streams.is_none());
    }
}
