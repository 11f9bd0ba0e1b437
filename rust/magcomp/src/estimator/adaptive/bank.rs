//! The bank: hypotheses about when tau changed last and what changed, weighed by their joint probability with all samples
//! (Bayesian online change-point detection, Adams and MacKay 2007, with moments as sufficient statistics).
//!     log joint of a child = log joint of its parent at the onset + log(hazard dt) + log P(kind) + its own evidence
//! A child begins where a sample surprises the best hypothesis, and now and then without one. What is published is the mean and
//! the second moment of the mixture.

use super::hypothesis::{Hypothesis, Kind};
use super::motion::Motion;
use super::parameters::{Gaussian, Tau, TauMatrix, shape, tau_of};
use super::setting::{Sample, Setting};
use super::tuning::Tuning;
use crate::calibration::Given;
use crate::math::symmetric::{basis, six};
use nalgebra::{SMatrix, Vector3};
use std::f64::consts::LN_2;
use std::ops::Range;

/// Hypotheses that are kept.
pub(super) const MOST: usize = 16;
/// Former calibrations that are remembered.
const FORMER: usize = 4;
/// A centre of the moments further from the samples than this (field strengths) is moved: moments about it are badly conditioned.
const FAR: f64 = 6.0;
/// Variance below which no element of a given T or beta is believed to be known.
const LEAST_VARIANCE: f64 = 1e-8;
/// Mixture weights below this do not count.
const NO_WEIGHT: f64 = 1e-5;

/// What a change begins from: the name of the change before it, what was known, the log joint probability of that and a change
/// that is over now; and of a change that is not, with the latest miss.
struct Before {
    id: u32,
    known: Gaussian,
    log: f64,
    born: (f64, f64),
}

/// See the module.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Bank {
    all: [Option<Hypothesis>; MOST],
    former: [Option<Gaussian>; FORMER],
    next_id: u32,
    turn: usize,
    since_look_s: f64,
}

impl Bank {
    pub fn new() -> Self {
        Self { all: [const { None }; MOST], former: [None; FORMER], next_id: 0, turn: 0, since_look_s: 0.0 }
    }

    pub fn is_empty(&self) -> bool {
        self.all.iter().all(Option::is_none)
    }

    /// All hypotheses, in no order.
    pub fn each(&self) -> impl Iterator<Item = &Hypothesis> {
        self.all.iter().flatten()
    }

    fn best_place(&self) -> Option<usize> {
        let log = |i: &usize| self.all[*i].as_ref().map_or(f64::NEG_INFINITY, Hypothesis::log_joint);
        (0..MOST).filter(|i| self.all[*i].is_some()).max_by(|a, b| log(a).total_cmp(&log(b)))
    }

    /// The likeliest hypothesis.
    pub fn best(&self) -> Option<&Hypothesis> {
        self.best_place().and_then(|place| self.all[place].as_ref())
    }

    /// In a free place, or in that of the least likely one that is less likely.
    fn insert(&mut self, hypothesis: Hypothesis) {
        if !hypothesis.log_joint().is_finite() {
            return;
        }
        let log = |slot: &Option<Hypothesis>| slot.as_ref().map_or(f64::NEG_INFINITY, Hypothesis::log_joint);
        if let Some(worst) = self.all.iter_mut().min_by(|a, b| log(a).total_cmp(&log(b)))
            && log(worst) < hypothesis.log_joint()
        {
            *worst = Some(hypothesis);
        }
    }

    /// Enters a hypothesis that begins now.
    fn begin_one(&mut self, mut hypothesis: Hypothesis, time_ns: i64) {
        self.next_id += 1;
        (hypothesis.id, hypothesis.onset_ns) = (self.next_id, time_ns);
        self.insert(hypothesis);
    }

    /// Hypotheses that know nothing but the first sample, or a calibration that was given.
    pub fn begin(&mut self, time_ns: i64, u: &Vector3<f64>, given: Option<Gaussian>, at: &Setting) {
        self.begin_cold(time_ns, u, if given.is_some() { at.tuning.log_cold } else { 0.0 }, at);
        if let Some(known) = given
            && let Some(mut hypothesis) = Hypothesis::new(Kind::Former, &known, u, 0.0, at)
        {
            hypothesis.error = known.error();
            self.begin_one(hypothesis, time_ns);
        }
    }

    fn begin_cold(&mut self, time_ns: i64, u: &Vector3<f64>, base: f64, at: &Setting) {
        for deviation in [at.tuning.cold_little, at.tuning.cold_much] {
            let prior = cold(u, deviation, at);
            if let Some(mut hypothesis) = Hypothesis::new(Kind::Cold, &prior, u, base - LN_2, at) {
                // a minimum is found from either side; at the sample itself there is none
                hypothesis.known.mean[8] -= 0.9;
                self.begin_one(hypothesis, time_ns);
            }
        }
    }

    /// By how much a sample, in units, misses what the best hypothesis expects, where it knows enough to call that a surprise.
    pub fn surprise(&self, sample: &Sample, at: &Setting) -> Option<f64> {
        let best = self.best().filter(|best| best.judges(at))?;
        best.surprise(&sample.u, sample.count as f64, at).map(f64::abs)
    }

    /// A mean of neighbouring samples, `seconds` after the one before, and by how much it surprises.
    pub fn push(&mut self, time_ns: i64, sample: &Sample, surprise: Option<f64>, seconds: f64, at: &Setting) {
        let Some(place) = self.best_place() else { return };
        let Some(best) = &self.all[place] else { return };
        let tuning = at.tuning;
        self.since_look_s += seconds;
        if best.error > tuning.unsure_deg.to_radians().powi(2) * at.level.kappa {
            if self.since_look_s >= 8.0 * tuning.look_s() {
                let base = best.log_joint() + tuning.log_cold + expected(tuning.devices_per_h, self.since_look_s).ln();
                self.begin_cold(time_ns, &sample.u, base, at);
                self.since_look_s = 0.0;
            }
        } else if surprise.is_some() {
            self.spawn(place, time_ns, sample, surprise, seconds.max(1e-3), at);
            self.since_look_s = 0.0;
        } else if !sample.stale
            && self.since_look_s >= tuning.look_s()
            && best.age * at.period_s > 2.0 * tuning.look_s()
        {
            self.spawn(place, time_ns, sample, None, self.since_look_s, at);
            self.since_look_s = 0.0;
        }
        for hypothesis in self.all.iter_mut().flatten() {
            hypothesis.add(sample, at);
        }
        self.fit(at);
        self.prune(time_ns, tuning);
    }

    /// What may have changed within the latest `seconds`, from what the best hypothesis knew before.
    fn spawn(
        &mut self,
        place: usize,
        time_ns: i64,
        sample: &Sample,
        surprise: Option<f64>,
        seconds: f64,
        at: &Setting,
    ) {
        let tuning = at.tuning;
        let Some(parent) = &mut self.all[place] else { return };
        if parent.has_news() {
            parent.fit(at);
            parent.absorb_if_known(at);
        }
        let parent = parent.clone();
        let begins = parent.log_joint() + expected(tuning.changes_per_h(), seconds).ln();
        // what is large does not come without a surprise; what goes on for a while is not small
        let sizes = if surprise.is_some() { 0..2 } else { 0..1 };
        let miss = surprise.unwrap_or(0.0);
        let before = Before { id: parent.id, known: parent.known, log: begins, born: (begins, 0.0) };
        self.begin_children(time_ns, &before, &parent, sample, (sizes, miss), at);
        if surprise.is_none() {
            self.consider_motion(&parent, at);
        }
        // or its change ends only now
        if let Some(known) = parent.former {
            let log = parent.in_progress + (seconds / tuning.change_s).ln();
            let before = Before { id: parent.parent, known, log, born: (parent.in_progress, parent.missed_before) };
            self.begin_children(time_ns, &before, &parent, sample, (1..2, miss), at);
        }
    }

    /// All kinds of changes of these sizes.
    fn begin_children(
        &mut self,
        time_ns: i64,
        before: &Before,
        parent: &Hypothesis,
        sample: &Sample,
        (sizes, miss): (Range<usize>, f64),
        at: &Setting,
    ) {
        let tuning = at.tuning;
        let centre = if (sample.u - parent.centre()).norm() > FAR { sample.u } else { *parent.centre() };
        // kinds share the rate of changes
        let Before { id, ref known, log, born } = *before;
        let log_device = log + (tuning.devices_per_h / tuning.changes_per_h()).ln();
        let log_place = log + (tuning.places_per_h / tuning.changes_per_h()).ln();
        let child = |bank: &mut Self, kind, size: usize, prior: &Gaussian, log_child: f64| {
            if let Some(mut child) = Hypothesis::new(kind, prior, &centre, log_child, at) {
                (child.size, child.parent) = (size as u8, id);
                child.former = Some(*known);
                (child.in_progress, child.missed_before) = born;
                child.motion = Motion::new(parent.motion.moves, parent.motion.rate, at);
                bank.begin_one(child, time_ns);
            }
        };
        let changed = |bank: &mut Self, kind, size, iron: f64, b: f64| {
            // with M or without; both sizes where both may be
            let share = 2.0 * sizes.len() as f64;
            child(bank, kind, size, &after(known, iron, b, tuning), log_device - share.ln());
        };
        for size in sizes.clone() {
            let (b_ut, place) = match size {
                0 => (tuning.small_ut, tuning.small_place),
                _ => (tuning.large_ut, tuning.large_place),
            };
            // a change is not much smaller than the miss that shows one component of it
            let b = if size == 0 { b_ut / at.unit_ut } else { (b_ut / at.unit_ut).max(1.5 * miss) };
            changed(self, Kind::HardIron, size, 0.0, b);
            changed(self, Kind::All, size, tuning.iron_per_ut * b_ut, b);
            child(self, Kind::Place, size, &elsewhere(known, place), log_place - (sizes.len() as f64).ln());
        }
        if sizes.contains(&1) {
            for (index, former) in self.former.into_iter().flatten().enumerate() {
                child(self, Kind::Former, index, &former, log_device - 8.0_f64.ln());
            }
        }
    }

    /// b may have begun to move, or to rest: the other of the two, where none competes yet.
    fn consider_motion(&mut self, parent: &Hypothesis, at: &Setting) {
        let tuning = at.tuning;
        if parent.error.sqrt() >= 0.5 * tuning.absorb_moving_deg.to_radians() {
            return;
        }
        let moves = !parent.motion.moves;
        let log = parent.log_joint() + tuning.log_moves;
        if self.each().any(|h| h.motion.moves == moves && h.log_joint() > log - 2.0) {
            return;
        }
        for slot in &mut self.all {
            if slot.as_ref().is_some_and(|h| h.motion.moves == moves) {
                *slot = None;
            }
        }
        let prior = if moves {
            after(&parent.known, tuning.iron_per_ut * tuning.small_ut, tuning.moved_ut / at.unit_ut, tuning)
        } else {
            parent.known
        };
        if let Some(mut child) = Hypothesis::new(parent.kind, &prior, parent.centre(), log, at) {
            child.motion = Motion::new(moves, Vector3::zeros(), at);
            child.continues(parent);
            self.insert(child);
        }
    }

    /// The best hypothesis first, the others in turn, within a budget of iterations.
    fn fit(&mut self, at: &Setting) {
        let best = self.best_place();
        let mut left = at.tuning.iterations as isize;
        let mut twin = None;
        self.turn = (self.turn + 1) % MOST;
        let order = best.into_iter().chain((0..MOST).map(|i| (self.turn + i) % MOST).filter(|i| Some(*i) != best));
        for place in order {
            if left <= 0 {
                break;
            }
            let Some(hypothesis) = &mut self.all[place] else { continue };
            if !hypothesis.wants_fit() {
                continue;
            }
            left -= hypothesis.fit(at) as isize;
            hypothesis.absorb_if_known(at);
            if twin.is_none() && hypothesis.looks_for_twin(at.tuning.twin_deg.to_radians().powi(2)) {
                left -= 8;
                twin = Some(place);
            }
        }
        if let Some(hypothesis) = twin.and_then(|place| self.all[place].clone()) {
            let mut starts = [None; 7];
            starts[0] = Some(hypothesis.mirrored());
            if hypothesis.kind == Kind::Cold && hypothesis.samples() < 100.0 {
                for k in 0..6 {
                    starts[1 + k] = Some(hypothesis.beside(k / 2, if k % 2 == 0 { 1.0 } else { -1.0 }));
                }
            }
            for start in starts.into_iter().flatten() {
                if let Some(found) = hypothesis.twin(at, &start) {
                    self.insert(found);
                }
            }
        }
    }

    fn prune(&mut self, time_ns: i64, tuning: &Tuning) {
        let Some(best) = self.best_place() else { return };
        let top = self.all[best].as_ref().map_or(0.0, Hypothesis::log_joint);
        for place in 0..MOST {
            let Some(own) = &self.all[place] else { continue };
            let log = own.log_joint();
            let beaten = |(other, h): (usize, &Option<Hypothesis>)| {
                h.as_ref().is_some_and(|h| {
                    other != place
                        && (h.is_twin(own, tuning.same_place) || h.is_neighbour(own, time_ns))
                        && (h.log_joint() > log || h.log_joint() == log && other < place)
                })
            };
            if log < top + tuning.log_hopeless || !log.is_finite() || self.all.iter().enumerate().any(beaten) {
                self.all[place] = None;
            }
        }
        // what was known before a change that is certain by now may hold again some day
        if let Some(best) = self.best_place().and_then(|place| self.all[place].as_mut())
            && best.error.sqrt() < tuning.absorb_deg.to_radians()
            && let Some(former) = best.former.take()
        {
            let known =
                |slot: &Option<Gaussian>| slot.is_some_and(|g| (g.mean - former.mean).norm() <= tuning.same_place);
            let place = self.former.iter().position(known).unwrap_or(FORMER - 1);
            self.former[..=place].rotate_right(1);
            self.former[0] = Some(former);
        }
    }

    /// Mean and second moment of all hypotheses by their probability; None while there are none.
    pub fn mixture(&self, at: &Setting) -> Option<Gaussian> {
        let best = self.best()?;
        let changing = best.former.map(|former| {
            let wide =
                after(&former, at.tuning.iron_per_ut * at.tuning.large_ut, at.tuning.large_ut / at.unit_ut, at.tuning);
            elsewhere(&wide, at.tuning.large_place)
        });
        let mut parts = [None; MOST + 1];
        for (part, slot) in parts.iter_mut().zip(&self.all) {
            *part = slot.as_ref().map(|h| (&h.known, (h.log_joint() - best.log_joint()).exp()));
        }
        parts[MOST] = changing.as_ref().map(|known| (known, (best.in_progress - best.log_joint()).exp()));
        let sum: f64 = parts.iter().flatten().map(|(_, weight)| weight).sum();
        let mean: Tau = parts.iter().flatten().map(|(known, weight)| known.mean * (weight / sum)).sum();
        let mut covariance = TauMatrix::zeros();
        for (known, weight) in parts.iter().flatten().filter(|(_, weight)| *weight > NO_WEIGHT * sum) {
            let off = known.mean - mean;
            covariance += (known.covariance + off * off.transpose()) * (weight / sum);
        }
        Some(Gaussian { mean, covariance })
    }

    /// Probability of all hypotheses for which `is` holds.
    pub fn probability(&self, is: impl Fn(&Hypothesis) -> bool) -> f64 {
        let Some(top) = self.best().map(Hypothesis::log_joint) else { return 0.0 };
        let of = |h: &Hypothesis| (h.log_joint() - top).exp();
        let all: f64 = self.each().map(of).sum();
        self.each().filter(|h| is(h)).map(of).sum::<f64>() / all
    }
}

/// How many changes are expected within some seconds.
fn expected(per_h: f64, seconds: f64) -> f64 {
    per_h * seconds / 3600.0
}

/// What was known, after a change of M by a relative `iron` and of b by `b` units, as standard deviations.
fn after(known: &Gaussian, iron: f64, b: f64, tuning: &Tuning) -> Gaussian {
    let mut covariance = known.covariance;
    // relative to the size of T: the gauge of the field strength is free
    let scale = shape(&known.mean).trace() / 3.0;
    for (at, sd) in [(0, iron * scale), (3, tuning.cross * iron * scale), (6, b)] {
        (at..at + 3).for_each(|i| covariance[(i, i)] += sd * sd);
    }
    Gaussian { mean: known.mean, covariance }
}

/// What was known of the device, in a place whose field is different by `size` (strength, and the vertical part).
fn elsewhere(known: &Gaussian, size: f64) -> Gaussian {
    let mut covariance = known.covariance;
    for i in 0..6 {
        for j in 0..6 {
            covariance[(i, j)] += size * size * known.mean[i] * known.mean[j];
        }
    }
    covariance[(9, 9)] += size * size;
    Gaussian { mean: known.mean, covariance }
}

/// Before anything is known: T = k (I + deviation) with k for any field on Earth, or near that which is given; b within about a field strength of the first sample.
fn cold(u: &Vector3<f64>, deviation: f64, at: &Setting) -> Gaussian {
    let tuning = at.tuning;
    let (scale, scale_sd) = match at.strength_ut {
        Some(_) => (1.0, tuning.small_place),
        None => (tuning.cold_scale, tuning.cold_scale_sd),
    };
    let mut mean = Tau::zeros();
    let mut covariance = TauMatrix::zeros();
    covariance[(9, 9)] = 1.0;
    for i in 0..3 {
        mean[i] = scale;
        mean[6 + i] = u[i];
        covariance[(i, i)] += deviation * deviation;
        covariance[(3 + i, 3 + i)] = (tuning.cross * deviation).powi(2);
        covariance[(6 + i, 6 + i)] = tuning.cold_centre * tuning.cold_centre;
        for j in 0..3 {
            covariance[(i, j)] += scale_sd * scale_sd;
        }
    }
    Gaussian { mean, covariance }
}

/// A calibration that was given.
pub(super) fn given(given: &Given, at: &Setting) -> Gaussian {
    let per_unit = at.unit_ut / given.calibration.field_strength_ut();
    let t = given.calibration.soft_iron_inverse() * per_unit;
    let mean = tau_of(&t, &(given.calibration.hard_iron_ut() / at.unit_ut));
    // T = k M^-1: dT = -T dM T / k
    let mut by = SMatrix::<f64, 9, 9>::zeros();
    for (k, dm) in basis().into_iter().enumerate() {
        by.fixed_view_mut::<6, 1>(0, 3 + k).copy_from(&six(&(t * dm * t / -per_unit)));
    }
    by.fixed_view_mut::<3, 3>(6, 0).fill_diagonal(1.0 / at.unit_ut);
    let mut covariance = TauMatrix::zeros();
    covariance.fixed_view_mut::<9, 9>(0, 0).copy_from(&(by * given.covariance * by.transpose()));
    // what was measured best is not known better than this
    (0..9).for_each(|k| covariance[(k, k)] += LEAST_VARIANCE);
    // the strength of this place may differ from that of the last
    let mut known = elsewhere(&Gaussian { mean, covariance }, 2.0 * at.tuning.small_place);
    known.covariance[(9, 9)] = 1.0;
    known
}
