//! The adaptive estimator: M and b from the magnetometer alone, at the speed the information in the samples allows.
//!
//! Since the latest change the samples lie on one ellipsoid |T (u - beta)| = 1; what was known before is a Gaussian prior.
//! The estimate is the maximum a posteriori, in constant time from the moments of the samples. A change is noticed from
//! innovations that do not fit (large) or from evidence over spans (small); then hypotheses of what it freed compete, and
//! what they lead to is released when it is predicted to be better than what is in force.
//! One file an idea: `parameters` (tau and derivatives) · `likelihood` (from moments) · `hypothesis` (prior, fit, evidence) ·
//! `ladder` (which priors) · `rivals` (hypotheses against each other) · `starts` · `spread` (a first answer) · `samples` (segment and spans) · `neighbours` (averaged) · `noise` ·
//! `notice` (changes) · `change` (small ones) · `drift`, `rate`, `line` (slow ones) · `witness` (the place, not the device) · `angle` (errors as angles) ·
//! `publish` (the gate) · `answer` (what is in force) · `output`.
//! The derivation is in docs/METHOD.md.

mod angle;
mod answer;
mod change;
mod drift;
mod hypothesis;
mod ladder;
mod likelihood;
mod line;
mod neighbours;
mod noise;
mod notice;
mod output;
mod parameters;
mod publish;
mod rate;
mod rivals;
mod samples;
mod spread;
mod starts;
mod steadiness;
#[cfg(test)]
mod tests;
mod witness;

use crate::calibration::Calibration;
use crate::config::{Config, ConfigError};
use crate::ellipsoid::Moments;
use crate::reading::{Event, ModelOrder};
use crate::snapshot::{LARGEST_COUNT, checked};
use drift::Drift;
use hypothesis::{Gaussian, Hypothesis};
use ladder::{JUMPS, LOG_PRIOR_FORMER, LOG_PRIOR_IGNORED, TWINNED, TWINNED_COLD};
use likelihood::Likelihood;
use nalgebra::{Matrix3, Vector3};
use neighbours::Neighbours;
use noise::Noise;
use notice::{LARGE_CHANGE, RETURNED};
pub(crate) use output::AdaptiveOutput;
use parameters::Vector9;
use publish::Published;
use rate::Motion;
use rivals::Rivals;
use samples::Samples;
use serde::{Deserialize, Serialize};
use steadiness::Steadiness;
use witness::Witness;

/// The few numbers of the adaptive estimator.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct AdaptiveConfig {
    /// Magnetometer noise to start from, uT per axis. Default 0.5 (a Nexus 5: 0.48; iPhones 0.7 to 1.1). It is learned: a
    /// factor of 3 wrong does not matter after 300 samples.
    pub noise_ut: f64,
}

impl Default for AdaptiveConfig {
    fn default() -> Self {
        Self { noise_ut: 0.5 }
    }
}

impl AdaptiveConfig {
    /// Checks every field against its range.
    pub(crate) fn validate(&self) -> Result<(), ConfigError> {
        if (0.01..=20.0).contains(&self.noise_ut) {
            return Ok(());
        }
        Err(ConfigError { field: "adaptive.noise_ut", value: self.noise_ut.to_string(), expected: "0.01 to 20" })
    }
}

/// Least noise that is believed, uT: quantisation of phones' magnetometers is 0.05 to 0.15.
const LEAST_NOISE_UT: f64 = 0.03;
/// A sample that fits worse than this many standard deviations is not used: 1 in 150 000 by chance.
const GATE: f64 = 4.5;
/// The first samples of a segment fit many ellipsoids: gated is what lies further from the first of them than any field
/// strength reaches (units); the review drops what else was wrong.
const UNGATED: usize = 9;
const FARTHEST: f64 = 4.0;
/// So many of the latest samples decide about a large change.
const RECENT: usize = 24;
/// Samples of a segment before small changes in it are looked for.
const SCANNED_FROM: usize = 32;
/// Former calibrations that are remembered.
const FORMER: usize = 4;
/// Samples in a block that is absorbed into the prior: the span of that length stays.
const BLOCK_SPAN: usize = 3;
/// Expected direction error (degrees) above which nothing is absorbed: its linearisation would not hold.
const ABSORBED_BELOW_DEG: f64 = 1.5;
/// Noise is no more than so many times the variance by which neighbours differ, and so many standard deviations of the
/// room's unevenness.
const MORE_THAN_DIFFERING: f64 = 3.0;
const MORE_THAN_UNEVEN: f64 = 2.0;
/// Ages of a segment at which its samples are gated anew and other starts are tried.
const REVIEWS: [usize; 6] = [24, 48, 64, 96, 128, 192];
/// Hypotheses besides the best that iterate with a sample: in the first 12 of a segment, the first 32, and later.
const FIRST_TURNS: usize = 12;
const MOST_TURNS: usize = 8;
const FEWER_TURNS: usize = 4;
const YOUNG: usize = 32;
/// Most iterations of each with one of the first samples, where they come from all around: each moves the minimum far.
const ITERATIONS_YOUNG: usize = 3;

/// Above this expected error (degrees) the linearised covariance is not taken at its word.
const CLOSE_DEG: f64 = 5.0;

/// What competes since the latest change.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Trial {
    since_ns: i64,
    /// What was known before; None at the start.
    base: Option<Gaussian>,
    /// What was in force before.
    held: Option<Published>,
    /// Its result has been released.
    released: bool,
    /// The samples fit no ellipsoid.
    misfit: bool,
}

/// A sample of late, and whether it was gated.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Late {
    time_ns: i64,
    raw_ut: Vector3<f64>,
    gated: bool,
    alone: bool,
}

/// The estimator. All state is plain numbers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(remote = "Self")]
pub(crate) struct Adaptive {
    unit_ut: f64,
    strength_ut: Option<f64>,
    release_below_deg: f64,
    centre_ut: Vector3<f64>,
    started: bool,
    given: Option<Calibration>,
    samples: Samples,
    rivals: Rivals,
    trial: Option<Trial>,
    former: [Option<Gaussian>; FORMER],
    noise: Noise,
    steadiness: Steadiness,
    witness: Witness,
    drift: Drift,
    motion: Motion,
    late: [Option<Late>; RECENT],
    /// A second look at the latest samples has not helped: a change is called with the next one, which spreads the cost.
    called: bool,
    published: Option<Published>,
    order: ModelOrder,
    event: Option<Event>,
    count: u64,
    absorbed_ns: i64,
    direction_sigma_deg: f64,
    worst_sigma_deg: f64,
}

checked!(Adaptive, |it| {
    let centre = Moments::new(it.centre_ut, it.unit_ut);
    it.samples.segment().is_about(&centre)
        && it.count <= LARGEST_COUNT
        && [it.direction_sigma_deg, it.worst_sigma_deg].iter().all(|v| *v >= 0.0)
});

/// The field strength that coordinates are scaled by: the known one, or the middle of those accepted, uT.
fn unit_ut(config: &Config) -> f64 {
    let (low, high) = config.fit.field_range_ut;
    config.fit.field_strength_ut.unwrap_or((low * high).sqrt())
}

impl Adaptive {
    /// Knows nothing but, perhaps, a calibration to begin with.
    pub fn new(config: &Config, initial: Option<Calibration>) -> Self {
        Self::with(config, initial, Samples::new(Vector3::zeros(), unit_ut(config)))
    }

    /// Whether it was made with this config.
    pub fn belongs_to(&self, config: &Config) -> bool {
        let fit = &config.fit;
        let own = (self.unit_ut, self.strength_ut, self.release_below_deg);
        own == (unit_ut(config), fit.field_strength_ut, fit.max_direction_sigma_deg)
    }

    /// As new, in the memory that is there.
    pub fn restart(&mut self, config: &Config, initial: Option<Calibration>) {
        let samples = self.samples.restart(Vector3::zeros(), unit_ut(config));
        *self = Self::with(config, initial, samples);
    }

    fn with(config: &Config, initial: Option<Calibration>, samples: Samples) -> Self {
        let (fit, unit_ut) = (&config.fit, unit_ut(config));
        Self {
            unit_ut,
            strength_ut: fit.field_strength_ut,
            release_below_deg: fit.max_direction_sigma_deg,
            centre_ut: Vector3::zeros(),
            started: false,
            given: initial,
            samples,
            rivals: Rivals::new([], &[]),
            trial: None,
            former: [None; FORMER],
            noise: Noise::new(
                config.adaptive.noise_ut / unit_ut,
                LEAST_NOISE_UT / unit_ut,
                config.heading.field_sigma_ut / unit_ut,
            ),
            steadiness: Steadiness::new(),
            witness: Witness::new(),
            drift: Drift::default(),
            motion: Motion::default(),
            late: [None; RECENT],
            called: false,
            published: None,
            order: ModelOrder::Nothing,
            event: None,
            count: 0,
            absorbed_ns: 0,
            direction_sigma_deg: 180.0,
            worst_sigma_deg: 180.0,
        }
    }

    /// A raw sample, finite, times in order.
    pub fn push(&mut self, time_ns: i64, raw_ut: &Vector3<f64>) -> AdaptiveOutput {
        let unseen = self.steadiness.is_resting(self.noise.uneven_samples());
        let raw_ut = &(raw_ut - self.motion.go(time_ns, self.unit_ut, unseen));
        let leaps = self.steadiness.leaps(&(raw_ut / self.unit_ut));
        if !self.started {
            if self.given.is_none() && (leaps || !self.steadiness.is_known()) {
                return self.output(raw_ut);
            }
            self.begin(time_ns, raw_ut);
        }
        self.count += 1;
        let gated = leaps || self.is_gated(raw_ut);
        if let Some(before) = self.late[RECENT - 1] {
            self.noise.learn_period(time_ns.saturating_sub(before.time_ns) as f64 * 1e-9);
        }
        self.late.rotate_left(1);
        self.late[RECENT - 1] = Some(Late { time_ns, raw_ut: *raw_ut, gated, alone: self.steadiness.is_alone() });
        self.samples.noise = self.noise.variance.sqrt();
        let rests = !gated && self.rests(raw_ut);
        let onset = self.onset();
        if self.called || onset.odds >= LARGE_CHANGE {
            self.large_change(onset.first);
        } else if self.former_is_back() {
            self.large_change(RECENT - RETURNED);
        } else if !gated && !rests {
            self.samples.add(raw_ut);
            self.fit();
            if self.trial.is_some() && REVIEWS.contains(&self.samples.age) {
                self.review();
            } else if self.count.is_multiple_of(2) {
                self.look_for_small_change(time_ns);
            } else {
                self.absorb(time_ns);
            }
            self.look_for_a_rate(time_ns);
        }
        if !rests && !self.called {
            self.judge();
        }
        self.attest(time_ns, raw_ut, rests);
        if !self.called {
            self.publish(time_ns);
        }
        self.output(raw_ut)
    }

    /// Whether a sample tells nothing new: unevenness of the field lasts as long as the device does not move.
    fn rests(&mut self, raw_ut: &Vector3<f64>) -> bool {
        let (within, samples) = (self.noise.unevenness(), self.noise.uneven_samples());
        self.steadiness.rests(&(raw_ut / self.unit_ut), within, samples)
    }

    fn unit(&self, raw_ut: &Vector3<f64>) -> Vector3<f64> {
        (raw_ut - self.centre_ut) / self.unit_ut
    }

    /// The first sample.
    fn begin(&mut self, time_ns: i64, raw_ut: &Vector3<f64>) {
        self.started = true;
        self.absorbed_ns = time_ns;
        self.move_centre(raw_ut);
        let given = self.given.map(|calibration| ladder::given(&self.tau_of(&calibration), self.unit_ut));
        self.published = given.map(|known| Published { tau: known.mean, covariance: known.covariance, expected: 0.0 });
        self.compete(time_ns, given);
    }

    /// Coordinates about another sample; the segment starts anew there.
    fn move_centre(&mut self, raw_ut: &Vector3<f64>) {
        let by = (self.centre_ut - raw_ut) / self.unit_ut;
        self.centre_ut = *raw_ut;
        self.rivals.shift(&by);
        self.witness.shift(&by);
        self.motion.shift(&by);
        self.drift.shift(&by);
        self.former.iter_mut().flatten().for_each(|former| former.shift(&by));
        if let Some(base) = self.trial.as_mut().and_then(|trial| trial.base.as_mut()) {
            base.shift(&by);
        }
        let held = self.trial.as_mut().and_then(|trial| trial.held.as_mut());
        for published in self.published.iter_mut().chain(held) {
            (0..3).for_each(|i| published.tau[6 + i] += by[i]);
        }
        self.samples.clear(self.centre_ut);
    }

    /// Hypotheses of what may have happened since what was known, `base`.
    fn compete(&mut self, since_ns: i64, base: Option<Gaussian>) {
        let jumps = JUMPS.iter().filter_map(|jump| {
            let mut hypothesis = Hypothesis::new(jump.order, &jump.after(&base?), jump.log_prior)?;
            hypothesis.told = (jump.log_told - jump.log_prior).exp();
            Some(hypothesis)
        });
        let former = self.former.iter().flatten().filter_map(|former| {
            let prior = JUMPS[0].after(former);
            base.and_then(|_| Hypothesis::new(ModelOrder::Former, &prior, LOG_PRIOR_FORMER))
        });
        let ignored = if base.is_some() { LOG_PRIOR_IGNORED } else { 0.0 };
        let cold = ladder::cold(&self.centre_ut, self.unit_ut, self.strength_ut.is_some());
        let cold = cold.iter().filter(|_| base.is_none() || self.count == 0);
        let cold = cold.filter_map(|(order, prior, log)| Hypothesis::new(*order, prior, *log + ignored));
        self.rivals =
            Rivals::new(jumps.chain(former).chain(cold), if base.is_some() { &TWINNED } else { &TWINNED_COLD });
        // a trial that begins anew before anything was released still holds what the first one held
        let held = self.trial.filter(|trial| !trial.released).map_or(self.published, |trial| trial.held);
        self.trial = Some(Trial { since_ns, base, held, released: false, misfit: false });
        self.called = false;
        self.noise.forget_block();
        self.drift.reset();
        self.motion.stop();
        self.late.iter_mut().for_each(|late| *late = None);
        self.steadiness.accept();
    }

    /// Whether a sample is too far from where it is expected; the noise learns from it.
    fn is_gated(&mut self, raw_ut: &Vector3<f64>) -> bool {
        let Some(expected) = self.rivals.predict(&self.unit(raw_ut), &self.noise) else { return false };
        let slope_squared = expected.slope * expected.slope;
        let variance = self.noise.total() * slope_squared + expected.variance;
        let z = expected.excess / variance.sqrt();
        if !self.is_cold() {
            let most = if self.noise.is_known() { self.most_noise() } else { f64::INFINITY };
            self.noise.learn(expected.excess / expected.slope, expected.variance / slope_squared, most);
        }
        if self.samples.age >= SCANNED_FROM && z.abs() < GATE && self.trial.is_none_or(|trial| trial.released) {
            self.noise.learn_colour(z);
        }
        if self.trial.is_some() && self.samples.age < UNGATED {
            return self.unit(raw_ut).norm() > FARTHEST;
        }
        expected.likely < (-0.5 * GATE * GATE).exp()
    }

    /// The most that noise may be, units^2: what misses the fit by more is of two ellipsoids, or of one that moves.
    fn most_noise(&self) -> f64 {
        let uneven = MORE_THAN_UNEVEN * self.noise.unevenness();
        MORE_THAN_DIFFERING * self.steadiness.variance() + uneven * uneven
    }

    /// Whether nothing was known before this segment.
    fn is_cold(&self) -> bool {
        self.trial.is_some_and(|trial| trial.base.is_none())
    }

    fn likelihood_of(&self, moments: &Moments) -> Likelihood {
        Likelihood::new(moments, self.noise.variance, moments.count() as f64 / self.noise.correlation())
    }

    /// The samples of the segment, neighbours averaged: where what they miss by is white noise of a known level.
    fn neighbours(&self) -> Option<&Neighbours> {
        self.samples.neighbours().filter(|_| !self.is_cold() && self.noise.correlation() <= 1.0)
    }

    /// Of the segment.
    fn likelihood(&self) -> Likelihood {
        let Some(neighbours) = self.neighbours() else { return self.likelihood_of(self.samples.segment()) };
        let (moments, means) = (neighbours.all(), neighbours.means() as f64);
        let share = means / moments.count().max(1) as f64;
        Likelihood::new(&moments, self.noise.variance * share, means)
    }

    /// The hypotheses take in what has come.
    fn fit(&mut self) {
        self.fit_some(match self.samples.age {
            0..12 => FIRST_TURNS,
            12..YOUNG => MOST_TURNS,
            _ => FEWER_TURNS,
        });
    }

    /// The same, so many hypotheses besides the best.
    fn fit_some(&mut self, turns: usize) {
        let likelihood = self.likelihood();
        let age = self.samples.age;
        let in_trial = self.trial.is_some();
        if in_trial && (age < 64 || age.is_multiple_of(8)) {
            self.rivals.look_elsewhere(&likelihood, self.samples.segment(), if age < 64 { age } else { age / 8 });
        }
        let turns = if in_trial { turns } else { 0 };
        let iterations = if in_trial && age < YOUNG && spread::is_around(&self.samples) { ITERATIONS_YOUNG } else { 1 };
        self.rivals.refine(&likelihood, age, turns, iterations);
        if let Some(best) = self.rivals.best().filter(|_| self.is_cold()) {
            self.noise
                .learn_from_fit(best.distance_squared.min(self.most_noise()), self.samples.segment().count() as f64);
        }
    }

    fn tau_of(&self, calibration: &Calibration) -> Vector9 {
        let t = calibration.soft_iron_inverse() * (self.unit_ut / calibration.field_strength_ut());
        parameters::tau_of(&t, &self.unit(calibration.hard_iron_ut()))
    }

    fn strength_of(&self, t: &Matrix3<f64>) -> f64 {
        self.strength_ut.unwrap_or_else(|| self.unit_ut / t.determinant().cbrt())
    }
}
