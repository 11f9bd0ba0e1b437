//! The bank: hypotheses about when tau changed last and what changed, weighed by their joint probability with all samples
//! (Bayesian online change-point detection, Adams and MacKay 2007, with moments as sufficient statistics).
//!     log joint of a child = log joint of its parent at the onset + log(hazard dt) + log P(kind) + its own evidence
//! A child begins where a sample surprises the best hypothesis, and now and then without one. What is published is the mean and
//! the second moment of the mixture.

use super::angle;
use super::hypothesis::{Gate, Gaussian, Hypothesis, Kind, Sample};
use super::noise::Level;
use super::parameters::{Tau, TauMatrix, shape};
use super::tuning::{Jump, Tuning};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Hypotheses that are kept.
pub(super) const MOST: usize = 16;
/// Former calibrations that are remembered.
const FORMER: usize = 4;
/// Two calibrations nearer than this (units) are one.
const SAME_FORMER: f64 = 0.03;
/// Samples of the best hypothesis before a change that no sample announces is looked for, s.
const YOUNG_S: f64 = 0.32;
/// Mixture weights below this do not count.
const NO_WEIGHT: f64 = 1e-5;
/// A former calibration is believed to hold again up to this, uT.
const FORMER_UT: f64 = 0.3;
/// A centre of the coordinates further from the samples than this (units) is moved: moments about it are badly conditioned.
const FAR: f64 = 6.0;

/// See the module.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Bank {
    all: [Option<Hypothesis>; MOST],
    former: [Option<Gaussian>; FORMER],
    next_id: u32,
    turn: usize,
    since_look_s: f64,
}

/// The mixture of all hypotheses.
pub(super) struct Mixture {
    pub known: Gaussian,
    /// Expected direction error all around, rad^2.
    pub error: f64,
}

impl Bank {
    pub fn new() -> Self {
        Self { all: [const { None }; MOST], former: [None; FORMER], next_id: 0, turn: 0, since_look_s: 0.0 }
    }

    pub fn is_empty(&self) -> bool {
        self.all.iter().all(Option::is_none)
    }

    fn each(&self) -> impl Iterator<Item = &Hypothesis> {
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

    /// Hypotheses that know nothing but the first sample, or a calibration that was given.
    pub fn begin(
        &mut self,
        time_ns: i64,
        u: &Vector3<f64>,
        unit_ut: f64,
        strength: Option<f64>,
        given: Option<Gaussian>,
        tuning: &Tuning,
    ) {
        let walk = tuning.walks_ut[0] / unit_ut;
        let log = if given.is_some() { tuning.log_cold } else { 0.0 };
        self.begin_cold(time_ns, u, unit_ut, strength, log, tuning);
        if let Some(known) = given
            && let Some(mut hypothesis) = Hypothesis::new(Kind::Former, &known, u, unit_ut, 0.0, walk)
        {
            hypothesis.error = angle::expected(&known);
            self.next_id += 1;
            hypothesis.id = self.next_id;
            hypothesis.onset_ns = time_ns;
            self.insert(hypothesis);
        }
    }

    fn begin_cold(
        &mut self,
        time_ns: i64,
        u: &Vector3<f64>,
        unit_ut: f64,
        strength: Option<f64>,
        base: f64,
        tuning: &Tuning,
    ) {
        for (deviation, log) in tuning.cold {
            let prior = cold(u, deviation, strength);
            if let Some(mut hypothesis) =
                Hypothesis::new(Kind::Cold, &prior, u, unit_ut, base + log, tuning.walks_ut[0] / unit_ut)
            {
                // a minimum is found from either side; at the sample itself there is none
                hypothesis.known.mean[8] -= 0.9;
                self.next_id += 1;
                hypothesis.id = self.next_id;
                hypothesis.onset_ns = time_ns;
                self.insert(hypothesis);
            }
        }
    }

    /// A mean of neighbouring samples. Returns whether it surprised the best hypothesis.
    #[expect(clippy::too_many_arguments, reason = "one sample and what it is judged by")]
    pub fn push(
        &mut self,
        time_ns: i64,
        sample: &Sample,
        seconds: f64,
        period_s: f64,
        level: &Level,
        gate: &Gate,
        unit_ut: f64,
        strength: Option<f64>,
        tuning: &Tuning,
    ) -> bool {
        let Some(place) = self.best_place() else { return false };
        let Some(best) = &self.all[place] else { return false };
        let n = sample.count as f64;
        let judged = best.judges(level, gate);
        let surprise = best.surprise(&sample.u, n, level).filter(|(_, z2)| judged && 0.5 * z2 > gate.half_square * n);
        let log_rate = (tuning.hazard_per_h / 3600.0).ln();
        self.since_look_s += seconds;
        if best.error > gate.unsure * level.kappa {
            if self.since_look_s >= 8.0 * tuning.look_s {
                let base = best.log_joint() + tuning.log_cold + log_rate + self.since_look_s.ln();
                self.begin_cold(time_ns, &sample.u, unit_ut, strength, base, tuning);
                self.since_look_s = 0.0;
            }
        } else if let Some((e, _)) = surprise {
            self.spawn(
                place,
                time_ns,
                sample,
                Some(e.abs()),
                log_rate + seconds.max(1e-3).ln(),
                level,
                unit_ut,
                period_s,
                tuning,
            );
            self.since_look_s = 0.0;
        } else if !sample.stale && self.since_look_s >= tuning.look_s && best.age * period_s > YOUNG_S {
            let log_hazard = log_rate + self.since_look_s.ln();
            self.spawn(place, time_ns, sample, None, log_hazard, level, unit_ut, period_s, tuning);
            self.since_look_s = 0.0;
        }
        for hypothesis in self.all.iter_mut().flatten() {
            hypothesis.add(sample, level, gate);
        }
        self.fit(level, unit_ut, period_s, tuning);
        self.prune(tuning);
        surprise.is_some()
    }

    /// What may have changed now, from what the best hypothesis knew before.
    #[expect(clippy::too_many_arguments, reason = "one change and what it is judged by")]
    fn spawn(
        &mut self,
        place: usize,
        time_ns: i64,
        sample: &Sample,
        surprise: Option<f64>,
        log_hazard: f64,
        level: &Level,
        unit_ut: f64,
        period_s: f64,
        tuning: &Tuning,
    ) {
        let Some(parent) = &mut self.all[place] else { return };
        if parent.has_news() {
            parent.fit(level, tuning.growth);
            parent.absorb_if_known(tuning, unit_ut, period_s);
        }
        let parent = parent.clone();
        let base = parent.log_joint() + log_hazard;
        let centre = if (sample.u - parent.centre()).norm() > FAR { sample.u } else { *parent.centre() };
        let child = |bank: &mut Self, kind, prior: &Gaussian, log: f64| {
            if let Some(mut child) = Hypothesis::new(kind, prior, &centre, unit_ut, base + log, parent.walk) {
                child.former = Some(parent.known);
                child.set_motion(parent.moves, parent.walk, parent.rate(), (tuning.rate_ut_s / unit_ut).powi(2));
                bank.next_id += 1;
                child.id = bank.next_id;
                child.onset_ns = time_ns;
                bank.insert(child);
            }
        };
        // children share the device's rate of changes
        let log_place = (tuning.places_per_h / tuning.hazard_per_h).ln() - (tuning.places.len() as f64).ln();
        let kind = |jump: &Jump| if jump.diagonal > 0.01 { Kind::All } else { Kind::HardIron };
        match surprise {
            Some(e) => {
                for jump in &tuning.jumps {
                    // a change is not much smaller than the miss that shows one component of it
                    let least = if jump.hard_iron_ut > 10.0 { 1.5 * e } else { 0.0 };
                    let prior = after(&parent.known, jump, (jump.hard_iron_ut / unit_ut).max(least));
                    child(self, kind(jump), &prior, jump.log_prior);
                }
                for size in tuning.places {
                    child(self, Kind::Place, &elsewhere(&parent.known, size), log_place);
                }
                for former in self.former.into_iter().flatten() {
                    let jump = Jump { diagonal: 1e-3, off_diagonal: 1e-3, hard_iron_ut: FORMER_UT, log_prior: -2.0 };
                    child(self, Kind::Former, &after(&former, &jump, FORMER_UT / unit_ut), jump.log_prior);
                }
            }
            None => {
                for jump in &tuning.quiet_jumps {
                    child(self, kind(jump), &after(&parent.known, jump, jump.hard_iron_ut / unit_ut), jump.log_prior);
                }
                for size in tuning.places {
                    child(self, Kind::Place, &elsewhere(&parent.known, size), log_place);
                }
                self.consider_motion(&parent, unit_ut, tuning);
            }
        }
    }

    /// b may have begun to move, or to rest: the other of the two, where none competes yet.
    fn consider_motion(&mut self, parent: &Hypothesis, unit_ut: f64, tuning: &Tuning) {
        if parent.error.sqrt() >= 0.5 * tuning.absorb_moving_deg.to_radians() {
            return;
        }
        let moves = !parent.moves;
        let log = if moves { tuning.log_begins_to_move } else { tuning.log_comes_to_rest };
        if self.each().any(|h| h.moves == moves && h.log_joint() > parent.log_joint() + tuning.log_begins_to_move - 2.0)
        {
            return;
        }
        for slot in &mut self.all {
            if slot.as_ref().is_some_and(|h| h.moves == moves) {
                *slot = None;
            }
        }
        let jump = &tuning.moved;
        let prior = if moves { after(&parent.known, jump, jump.hard_iron_ut / unit_ut) } else { parent.known };
        let walk = tuning.walks_ut[usize::from(moves)] / unit_ut;
        if let Some(mut child) =
            Hypothesis::new(Kind::Motion, &prior, parent.centre(), unit_ut, parent.log_joint() + log, walk)
        {
            child.set_motion(moves, walk, Vector3::zeros(), (tuning.rate_ut_s / unit_ut).powi(2));
            child.continues(parent);
            self.insert(child);
        }
    }

    /// The best hypothesis first, the others in turn, within a budget of iterations.
    fn fit(&mut self, level: &Level, unit_ut: f64, period_s: f64, tuning: &Tuning) {
        let best = self.best_place();
        let mut left = tuning.iterations as isize;
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
            left -= hypothesis.fit(level, tuning.growth) as isize;
            hypothesis.absorb_if_known(tuning, unit_ut, period_s);
            if twin.is_none() && hypothesis.looks_for_twin(tuning.twin_deg.to_radians().powi(2)) {
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
                if let Some(found) = hypothesis.twin(level, tuning.growth, &start) {
                    self.insert(found);
                }
            }
        }
    }

    fn prune(&mut self, tuning: &Tuning) {
        let Some(best) = self.best_place() else { return };
        let top = self.all[best].as_ref().map_or(0.0, Hypothesis::log_joint);
        for place in 0..MOST {
            let Some(own) = &self.all[place] else { continue };
            let log = own.log_joint();
            let beaten = |(other, h): (usize, &Option<Hypothesis>)| {
                h.as_ref().is_some_and(|h| {
                    other != place && h.is_twin(own) && (h.log_joint() > log || h.log_joint() == log && other < place)
                })
            };
            if log < top + tuning.hopeless || !log.is_finite() || self.all.iter().enumerate().any(beaten) {
                self.all[place] = None;
            }
        }
        // what was known before a change that is certain by now may hold again some day
        if let Some(best) = self.best_place().and_then(|place| self.all[place].as_mut())
            && best.error.sqrt() < tuning.absorb_deg.to_radians()
            && let Some(former) = best.former.take()
        {
            let known = |slot: &Option<Gaussian>| slot.is_some_and(|g| (g.mean - former.mean).norm() <= SAME_FORMER);
            let place = self.former.iter().position(known).unwrap_or(FORMER - 1);
            self.former[..=place].rotate_right(1);
            self.former[0] = Some(former);
        }
    }

    /// Mean and second moment of all hypotheses by their probability; None while there are none.
    pub fn mixture(&self) -> Option<Mixture> {
        let top = self.best()?.log_joint();
        let weight = |h: &Hypothesis| (h.log_joint() - top).exp();
        let sum: f64 = self.each().map(weight).sum();
        let mean: Tau = self.each().map(|h| h.known.mean * (weight(h) / sum)).sum();
        let mut covariance = TauMatrix::zeros();
        for hypothesis in self.each() {
            let share = weight(hypothesis) / sum;
            if share > NO_WEIGHT {
                let off = hypothesis.known.mean - mean;
                covariance += (hypothesis.known.covariance + off * off.transpose()) * share;
            }
        }
        let known = Gaussian { mean, covariance };
        Some(Mixture { error: angle::expected(&known), known })
    }

    /// Probability of all hypotheses for which `is` holds.
    pub fn probability(&self, is: impl Fn(&Hypothesis) -> bool) -> f64 {
        let Some(top) = self.best().map(Hypothesis::log_joint) else { return 0.0 };
        let of = |h: &Hypothesis| (h.log_joint() - top).exp();
        let all: f64 = self.each().map(of).sum();
        self.each().filter(|h| is(h)).map(of).sum::<f64>() / all
    }
}

/// What was known, after a jump with `hard_iron` in units.
fn after(known: &Gaussian, jump: &Jump, hard_iron: f64) -> Gaussian {
    let mut covariance = known.covariance;
    // relative to the size of T: the gauge of the field strength is free
    let scale = shape(&known.mean).trace() / 3.0;
    for (at, sd) in [(0, jump.diagonal * scale), (3, jump.off_diagonal * scale), (6, hard_iron)] {
        (at..at + 3).for_each(|i| covariance[(i, i)] += sd * sd);
    }
    Gaussian { mean: known.mean, covariance }
}

/// What was known of the device, in another place.
fn elsewhere(known: &Gaussian, (strength, vertical): (f64, f64)) -> Gaussian {
    let mut covariance = known.covariance;
    for i in 0..6 {
        for j in 0..6 {
            covariance[(i, j)] += strength * strength * known.mean[i] * known.mean[j];
        }
    }
    covariance[(9, 9)] += vertical * vertical;
    Gaussian { mean: known.mean, covariance }
}

/// Before anything is known: T = k (I + deviation) with k for any field on Earth, 22 to 67 uT, or within 5 % of one that is
/// given; b within about a field strength of the first sample.
fn cold(u: &Vector3<f64>, deviation: f64, strength: Option<f64>) -> Gaussian {
    let (scale, scale_sd) = if strength.is_some() { (1.0, 0.05) } else { (1.05, 0.28) };
    let mut mean = Tau::zeros();
    let mut covariance = TauMatrix::zeros();
    covariance[(9, 9)] = 1.0;
    for i in 0..3 {
        mean[i] = scale;
        mean[6 + i] = u[i];
        covariance[(i, i)] += deviation * deviation;
        covariance[(3 + i, 3 + i)] = (0.7 * deviation).powi(2);
        covariance[(6 + i, 6 + i)] = 0.75 * 0.75;
        for j in 0..3 {
            covariance[(i, j)] += scale_sd * scale_sd;
        }
    }
    Gaussian { mean, covariance }
}

/// A calibration that was given, as far as it is trusted.
pub(super) fn given(tau: &Tau, unit_ut: f64, tuning: &Tuning) -> Gaussian {
    let (relative, b_ut) = tuning.given;
    let jump = Jump { diagonal: relative, off_diagonal: relative, hard_iron_ut: b_ut, log_prior: 0.0 };
    let mut known = after(&Gaussian { mean: *tau, covariance: TauMatrix::zeros() }, &jump, b_ut / unit_ut);
    known.covariance[(9, 9)] = 1.0;
    // the strength of this place may differ from that of the last
    for i in 0..3 {
        for j in 0..3 {
            known.covariance[(i, j)] += (0.1 * tau[i]) * (0.1 * tau[j]);
        }
    }
    known
}
