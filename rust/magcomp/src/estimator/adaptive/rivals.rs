//! The hypotheses that compete on the samples of one segment, weighed by their evidence: weight_i ~ exp(log evidence_i).
//!
//! What is not decided yet is counted as uncertainty: about any tau the mixture has the second moment
//!     sum weight_i (P_i + (tau_i - tau)(tau_i - tau)^T).
//! A flat arc of samples leaves two places for b. Wide hypotheses therefore have a twin that is kept on the other side, so
//! that the doubt is in the mixture.
//!
//! Two places differ in L by delta, and noise alone makes differences of variance 4 n (1 - rho^2), rho the correlation of
//! their residuals (`likelihood`), which for a flat arc and its mirror image is most of n. If delta were expected, its log odds
//! were delta/2 of delta / (delta + n (1 - rho^2)): so much of the difference counts.

use super::angle::AngularWeight;
use super::hypothesis::{Gaussian, Hypothesis, NO_EVIDENCE};
use super::likelihood::Likelihood;
use super::noise::Noise;
use super::parameters::{Matrix9, Vector9, see, shape, vector_gradient};
use super::starts::{mirrored, starts};
use crate::ellipsoid::Moments;
use crate::reading::ModelOrder;
use crate::snapshot::{LARGEST_COUNT, checked};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Most hypotheses at a time.
const MOST: usize = 20;
/// Twins at a time: they are neighbours, so that each call looks after one.
const TWINS: usize = 4;
/// A twin closer than this to its sibling (units) has lost its own place.
const SAME_PLACE: f64 = 0.1;
/// Hypotheses whose log evidence lies this far below the best one's are given up ...
const HOPELESS: f64 = 30.0;
/// ... but not before so many samples, in the segment and since they began: the first ones fit many.
const PATIENCE: usize = 96;
/// Mean square error by all, over that by the best, below which they agree.
const AGREEMENT: f64 = 1.5;
/// Weights below this are left out of the mixture.
const NEGLIGIBLE: f64 = 1e-4;
/// Mean square of an angle of which nothing is known, radians^2.
const ANY_DIRECTION_RAD2: f64 = std::f64::consts::PI * std::f64::consts::PI / 3.0;
/// What a hypothesis costs besides its iterations, iterations.
const SETTLING: usize = 2;
/// Another start must lower F by this before it is preferred: noise alone makes differences of about 1.
const MARGIN: f64 = 0.5;

/// See the module.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(remote = "Self")]
pub(super) struct Rivals {
    all: [Option<Hypothesis>; MOST],
    /// Whose twin each is.
    sibling: [Option<usize>; MOST],
    weights: [f64; MOST],
    best: usize,
    turn: usize,
    /// Samples since they began.
    age: usize,
}

checked!(Rivals, |it| {
    let places = it.sibling.iter().flatten().chain([&it.best, &it.turn]);
    places.into_iter().all(|place| *place < MOST)
        && it.weights.iter().all(|weight| (0.0..=1.0).contains(weight))
        && it.age as u64 <= LARGEST_COUNT
});

/// What a sample is expected to read as: its radius, and the innovation's variance through the parameters.
#[derive(Clone, Copy, Debug)]
pub(super) struct Prediction {
    /// Radius expected less 1.
    pub excess: f64,
    /// Variance of it, from the parameters alone.
    pub variance: f64,
    /// |dr/du|.
    pub slope: f64,
    /// How well it fits, the mean of exp(-z^2 / 2) over the hypotheses: one that matters and fits is enough.
    pub likely: f64,
}

impl Rivals {
    pub fn new(hypotheses: impl IntoIterator<Item = Hypothesis>, twinned: &[usize]) -> Self {
        let mut all = [None; MOST];
        let mut count = 0;
        for (slot, hypothesis) in all.iter_mut().zip(hypotheses) {
            *slot = Some(hypothesis);
            count += 1;
        }
        let mut sibling = [None; MOST];
        for (k, other) in (count..MOST).zip(twinned) {
            (all[k], sibling[k]) = (all[*other], Some(*other));
        }
        let mut rivals = Self { all, sibling, weights: [0.0; MOST], best: 0, turn: 0, age: 0 };
        rivals.weigh(None);
        rivals
    }

    /// It is the turn of the former calibrations.
    pub fn turn_to_former(&mut self) {
        let is_former = |slot: &Option<Hypothesis>| slot.as_ref().is_some_and(|h| h.order == ModelOrder::Former);
        self.turn = self.all.iter().position(is_former).map_or(self.turn, |k| (k + MOST - 1) % MOST);
    }

    /// Weights, and the best. Returns the log evidences they are of.
    fn weigh(&mut self, likelihood: Option<&Likelihood>) -> [f64; MOST] {
        let largest = |logs: &[f64; MOST], from: usize| {
            (0..MOST).fold(from, |best, k| if logs[k] > logs[best] { k } else { best })
        };
        let own = self.all.each_ref().map(|slot| slot.as_ref().map_or(NO_EVIDENCE, |h| h.log_evidence));
        let reference = self.all[largest(&own, self.best)];
        let mut logs = own;
        if let (Some(likelihood), Some(reference)) = (likelihood, reference) {
            for (log, h) in logs.iter_mut().zip(&self.all) {
                if let Some(h) = h.as_ref().filter(|h| h.log_evidence > NO_EVIDENCE) {
                    let delta = h.samples_cost - reference.samples_cost;
                    let noise = likelihood.disagreement(&h.posterior.mean, &reference.posterior.mean);
                    *log += 0.5 * delta * noise / (delta.abs() + noise).max(f64::MIN_POSITIVE);
                }
            }
        }
        // a place that a twin has lost counts once
        for ((log, twin), other) in logs.iter_mut().zip(&self.all).zip(&self.sibling) {
            let both = twin.as_ref().zip(other.and_then(|other| self.all[other].as_ref()));
            if both.is_some_and(|(twin, other)| (twin.posterior.mean - other.posterior.mean).norm() < SAME_PLACE) {
                *log = NO_EVIDENCE;
            }
        }
        self.best = largest(&logs, self.best);
        let most = logs[self.best];
        let weights = logs.map(|log| if log > NO_EVIDENCE { (log - most).exp() } else { 0.0 });
        let sum: f64 = weights.iter().sum();
        self.weights = weights.map(|weight| if sum > 0.0 { weight / sum } else { 0.0 });
        logs
    }

    /// The one with the most evidence.
    pub fn best(&self) -> Option<&Hypothesis> {
        self.all[self.best].as_ref()
    }

    /// Of those that have weight the one that leaves most open.
    pub fn widest(&self) -> Option<&Hypothesis> {
        self.weighty().map(|(hypothesis, _)| hypothesis).max_by(|a, b| a.openness().total_cmp(&b.openness()))
    }

    /// Whether all that have weight lead to about the same directions as the best.
    pub fn agree(&self) -> bool {
        self.best().is_some_and(|best| {
            let Gaussian { mean, covariance } = &best.posterior;
            let weight = AngularWeight::sphere(mean);
            weight.expected(&self.spread_about(mean)) < AGREEMENT * weight.expected(covariance)
        })
    }

    fn weighty(&self) -> impl Iterator<Item = (&Hypothesis, f64)> {
        let known = self.all.iter().zip(self.weights).filter_map(|(slot, weight)| Some((slot.as_ref()?, weight)));
        known.filter(|(_, weight)| *weight > NEGLIGIBLE)
    }

    /// Mean of the mixture: no other tau has a smaller second moment about it.
    pub fn mean(&self) -> Option<Vector9> {
        let (mut sum, mut total) = (Vector9::zeros(), 0.0);
        for (hypothesis, weight) in self.weighty() {
            sum += hypothesis.posterior.mean * weight;
            total += weight;
        }
        (total > 0.0).then(|| sum / total)
    }

    /// Second moment of the mixture about tau.
    pub fn spread_about(&self, tau: &Vector9) -> Matrix9 {
        let mut sum = Matrix9::zeros();
        for (hypothesis, weight) in self.weighty() {
            let off = hypothesis.posterior.mean - tau;
            sum += (hypothesis.posterior.covariance + off * off.transpose()) * weight;
        }
        sum
    }

    /// Mean square of the angle about `up` (unit vector) between where `field`, of the corrected sample u, points and where it
    /// does by each of them, radians^2: with n across the horizontal part of T (u - beta), of length r,
    /// angle^2 + s / (1 + s / s_any), s = n^T G P G^T n / r^2. Weighed by the prior for what is told.
    pub fn heading_rad2(&self, u: &Vector3<f64>, up: &Vector3<f64>, field: &Vector3<f64>) -> f64 {
        let (mut sum, mut total) = (0.0, 0.0);
        let east = field.cross(up);
        for (hypothesis, weight) in self.weighty() {
            let weight = weight * hypothesis.told;
            let Gaussian { mean, covariance } = &hypothesis.posterior;
            let Some(seen) = see(mean, u) else { continue };
            let across = seen.direction.cross(up);
            let angle = up.dot(&east.cross(&across)).atan2(east.dot(&across));
            let gradient = vector_gradient(mean, &seen.offset).tr_mul(&across) / (across.norm_squared() * seen.radius);
            let spread = gradient.dot(&(covariance * gradient));
            sum += weight * (angle * angle + spread / (1.0 + spread / ANY_DIRECTION_RAD2));
            total += weight;
        }
        if total > 0.0 { sum / total } else { ANY_DIRECTION_RAD2 }
    }

    /// What is expected of a sample, by all of them. The sample's own noise turns the
    /// gradients, too: its share of their spread is no uncertainty of the prediction and is taken off.
    pub fn predict(&self, u: &Vector3<f64>, noise: &Noise) -> Option<Prediction> {
        let (mut sum, mut squares, mut slope, mut likely, mut total) = (0.0, 0.0, 0.0, 0.0, 0.0);
        let (mut steep, mut steepest) = (Vector3::zeros(), 0.0);
        for (hypothesis, weight) in self.weighty() {
            let tau = &hypothesis.posterior.mean;
            let Some(seen) = see(tau, u) else { continue };
            let excess = seen.radius - 1.0;
            sum += weight * excess;
            let square = excess * excess;
            let variance = hypothesis.variance_at(u, &seen, noise.variance);
            squares += weight * (square + variance);
            likely += weight * (-0.5 * square / (noise.total() * seen.slope * seen.slope + variance)).exp();
            slope += weight * seen.slope;
            steep += shape(tau) * seen.direction * weight;
            steepest += weight * seen.slope * seen.slope;
            total += weight;
        }
        if total <= 0.0 {
            return None;
        }
        let excess = sum / total;
        let turned = steepest / total - (steep / total).norm_squared();
        let variance = (squares / total - excess * excess - noise.variance * turned).max(0.0);
        Some(Prediction { excess, variance, slope: slope / total, likely: likely / total })
    }

    /// All start from `place`.
    pub fn place(&mut self, place: &Vector9) {
        self.all.iter_mut().flatten().for_each(|h| h.posterior.mean = *place);
    }

    /// The samples have become more: the best and others in turn iterate, at most `iterations` times each, as long as `turns`
    /// of them with one iteration each would; all are weighed.
    pub fn refine(&mut self, likelihood: &Likelihood, samples: usize, turns: usize, iterations: usize) {
        let best = self.best;
        for slot in self.all.iter_mut().flatten() {
            slot.rescore(likelihood);
        }
        let mut left = (1 + turns) * (1 + SETTLING);
        if let Some(hypothesis) = &mut self.all[best] {
            left = left.saturating_sub(SETTLING + hypothesis.refine(likelihood, iterations));
        }
        // where the best one stands may be the better place for another, too
        let place = self.best().map(|h| h.posterior.mean);
        for _ in 0..MOST {
            self.turn = (self.turn + 1) % MOST;
            if self.turn == best {
                continue;
            }
            if let Some(hypothesis) = &mut self.all[self.turn] {
                if left <= SETTLING {
                    self.turn = (self.turn + MOST - 1) % MOST;
                    break;
                }
                if let Some(place) = place.as_ref().filter(|_| self.sibling[self.turn].is_none()) {
                    hypothesis.consider(likelihood, place, MARGIN);
                }
                left = left.saturating_sub(SETTLING + hypothesis.refine(likelihood, iterations.min(left - SETTLING)));
            }
        }
        let logs = self.weigh(Some(likelihood));
        let largest = logs[self.best];
        self.age += 1;
        if samples.min(self.age) >= PATIENCE {
            for (slot, log) in self.all.iter_mut().zip(logs) {
                if log < largest - HOPELESS {
                    *slot = None;
                }
            }
        }
    }

    /// Other places to iterate from, for the hypotheses that may go there; one of them at a time, so that no sample costs much.
    pub fn look_elsewhere(&mut self, likelihood: &Likelihood, segment: &Moments, turn: usize) {
        let (mean, covariance) = segment.cloud();
        for k in (turn % TWINS..MOST).step_by(TWINS) {
            let Some(place) = self.sibling[k].and_then(|other| self.all[other].as_ref()).map(|h| h.posterior.mean)
            else {
                continue;
            };
            if let Some(twin) = &mut self.all[k]
                && (twin.log_evidence <= NO_EVIDENCE || (twin.posterior.mean - place).norm() < SAME_PLACE)
            {
                twin.move_to(likelihood, &mirrored(&place, &mean, &covariance));
            }
        }
        if self.sibling[turn % MOST].is_some() {
            return;
        }
        let Some(hypothesis) = &mut self.all[turn % MOST] else { return };
        for start in starts(&hypothesis.posterior.mean, &mean, &covariance) {
            hypothesis.consider(likelihood, &start, MARGIN);
        }
    }

    /// The coordinates move.
    pub fn shift(&mut self, by: &Vector3<f64>) {
        self.all.iter_mut().flatten().for_each(|h| h.shift(by));
    }

    /// z^2 of a sample under the best alone.
    pub fn fits(&self, u: &Vector3<f64>, noise: &Noise) -> f64 {
        let fit = || {
            let best = self.best()?;
            let seen = see(&best.posterior.mean, u)?;
            let (square, own) = ((seen.radius - 1.0).powi(2), noise.total() * seen.slope * seen.slope);
            // where the sample's own noise explains it, what the parameters add need not be known
            let rest = if square < own { 0.0 } else { best.variance_at(u, &seen, noise.variance) };
            Some(square / (own + rest))
        };
        fit().unwrap_or(f64::INFINITY)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of two hypotheses as likely as each other one is right, and the other off by an angle that no gradient tells.
    #[test]
    fn a_heading_that_is_far_off_is_told_as_an_angle() {
        let at = |centre: Vector3<f64>, sd: f64| {
            let mut mean = Vector9::zeros();
            (0..3).for_each(|i| (mean[i], mean[6 + i]) = (1.0, centre[i]));
            let mut covariance = Matrix9::identity() * 1e-12;
            (6..9).for_each(|i| covariance[(i, i)] = sd * sd);
            Hypothesis::new(ModelOrder::HardIron, &Gaussian { mean, covariance }, 0.0).expect("a Gaussian")
        };
        let (field, up) = (Vector3::new(0.0, 0.5, -0.8), Vector3::z());
        let rms_deg = |offset: Vector3<f64>, sd: f64| {
            let rivals = Rivals::new([at(Vector3::zeros(), sd), at(offset, sd)], &[]);
            rivals.heading_rad2(&field, &up, &field).sqrt().to_degrees()
        };
        let half = 0.5_f64.sqrt();
        // it says that the field is (0.5, 0.5), and (0, -0.5): 45 and 180 deg
        assert!((rms_deg(Vector3::new(-0.5, 0.0, 0.3), 1e-6) - 45.0 * half).abs() < 1e-3);
        assert!((rms_deg(Vector3::new(0.0, 1.0, 0.0), 1e-6) - 180.0 * half).abs() < 1e-3);
        // both the same, sd of b 0.02 across 0.5; and not known at all
        assert!((rms_deg(Vector3::zeros(), 0.02) - (0.02_f64 / 0.5).to_degrees()).abs() < 0.01);
        assert!((rms_deg(Vector3::zeros(), 100.0) - 180.0 / 3.0_f64.sqrt()).abs() < 0.1);
    }

    /// What is released is where the mixture's second moment is least.
    #[test]
    fn about_its_mean_the_mixture_spreads_least() {
        let at = |place: f64, log_prior: f64| {
            let gaussian = Gaussian { mean: Vector9::repeat(place), covariance: Matrix9::identity() * 0.01 };
            Hypothesis::new(ModelOrder::All, &gaussian, log_prior).expect("a Gaussian")
        };
        // weights 3 : 1
        let rivals = Rivals::new([at(1.0, 3.0_f64.ln()), at(2.0, 0.0)], &[]);
        let mean = rivals.mean().expect("weights");
        assert!((mean - Vector9::repeat(1.25)).norm() < 1e-12, "{mean}");
        let spread = |place: f64| rivals.spread_about(&Vector9::repeat(place)).trace();
        // 9 (0.01 + 3/4 1/4)
        assert!((spread(1.25) - 9.0 * (0.01 + 0.1875)).abs() < 1e-12);
        assert!(spread(1.25) < spread(1.0).min(spread(1.2)).min(spread(1.3)));
    }
}
