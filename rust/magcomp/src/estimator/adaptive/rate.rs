//! A rate of b: beta moves along a line, beta' = r, and r wanders slowly, r' = -r / RATE_S and noise that keeps its variance.
//!
//! A course is jointly Gaussian: tau = (T, beta) ~ N(m, P) at the middle of a block, r = r_0 + K (tau - m) + e, e ~ N(0, D).
//! What a block says about tau leaves K and D as they are, and r_0 follows m. In t seconds, with S the rows of beta,
//!     tau <- J tau + t S e,   J = I + t S K,   cov(r, tau) <- K P J^T + t D S^T,   R = K P K^T + D
//! and after that r decays. It begins with a fit of tau and r to the whole segment (`line`), and is carried on beside the
//! filters of `drift`. Whether r = 0 now: the density there before and after the samples (Dickey 1971),
//!     log B = r^T R^-1 r / 2 - log (det R_0 / det R) / 2
//! Where there is a rate, and the blocks to come are predicted better with it than by those, the coordinates move with it: then b rests in
//! them, and everything else is as it was.

use super::angle::is_close;
use super::drift::{rested, take};
use super::hypothesis::{Gaussian, Hypothesis};
use super::likelihood::Likelihood;
use super::line::{Line, Matrix12, Vector12};
use super::notice::ROUGH_DEG;
use super::parameters::{Matrix9, Vector9};
use super::rivals::Rivals;
use super::samples::{REVIEWED, span_length};
use super::{ABSORBED_BELOW_DEG, Adaptive, BLOCK_SPAN};
use crate::ellipsoid::Moments;
use crate::ellipsoid::ldl::Ldl;
use crate::reading::ModelOrder;
use crate::snapshot::{checked, is_covariance};
use nalgebra::{Matrix3, SMatrix, Vector3};
use serde::{Deserialize, Serialize};

/// Variance of the rates that b may have, (uT/s)^2 per axis: a warming phone, a magnet that is drawn near.
pub(super) const RATE_VARIANCE_UT: f64 = 0.09;
/// How long they last, s.
pub(super) const RATE_S: f64 = 400.0;
/// A longer time between samples is a gap, s.
const GAP_S: f64 = 1.0;
/// Log B from which there is a rate, and below which there is none any more.
const BEGINS: f64 = 6.0;
const ENDS: f64 = 0.0;
/// Log evidence by which the course must have predicted the latest blocks better.
const BETTER: f64 = 3.0;
/// Age of a segment of which nothing has been absorbed, from which and how often it is looked at.
const WHOLE_FROM: usize = 256;
const WHOLE_EVERY: usize = 64;
/// Square of an expected error, in the unevenness of the room, up to which what it bends, half that square, is a twentieth of
/// the unevenness.
const UNBENT: f64 = 0.1;
/// Square of a rate, in its variance, from which it is taken for an error: five standard deviations.
const PLAUSIBLE: f64 = 25.0;
/// What is kept from one block to the next of the log evidence for the course against rest.
const KEPT: f64 = 0.9;
/// Log evidence against a course from which it is begun anew.
const LOST: f64 = -10.0;

/// See the module. Rates in units per second.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(remote = "Self")]
pub(super) struct Course {
    pub known: Gaussian,
    pub rate: Vector3<f64>,
    pub gain: SMatrix<f64, 3, 9>,
    pub rest: Matrix3<f64>,
}

checked!(Course, |it| is_covariance(&it.rest));

/// The course of b, and the coordinates that may move with it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Motion {
    course: Option<Course>,
    /// Log evidence for the course against b at rest, of the latest blocks.
    ahead: f64,
    on: bool,
    /// The coordinates': units per second, and how far they have come, uT.
    rate: Vector3<f64>,
    pub gone_ut: Vector3<f64>,
    latest_ns: i64,
}

fn usual(unit_ut: f64) -> f64 {
    RATE_VARIANCE_UT / (unit_ut * unit_ut)
}

impl Course {
    pub fn new(known: Gaussian, variance: f64) -> Self {
        let rest = Matrix3::from_diagonal_element(variance);
        Self { known, rate: Vector3::zeros(), gain: SMatrix::zeros(), rest }
    }

    /// Of a joint Gaussian.
    pub fn of(mean: &Vector12, covariance: &Matrix12) -> Option<Self> {
        let known = Gaussian {
            mean: mean.fixed_rows::<9>(0).into_owned(),
            covariance: covariance.fixed_view::<9, 9>(0, 0).into_owned(),
        };
        let rate = mean.fixed_rows::<3>(9).into_owned();
        let mut course = Self { known, rate, gain: SMatrix::zeros(), rest: Matrix3::zeros() };
        let cross = covariance.fixed_view::<3, 9>(9, 0).into_owned();
        course.regress(&cross, &covariance.fixed_view::<3, 3>(9, 9).into_owned()).then_some(course)
    }

    /// K and D of cov(r, tau) and R.
    fn regress(&mut self, cross: &SMatrix<f64, 3, 9>, spread: &Matrix3<f64>) -> bool {
        let Some(factors) = Ldl::new(&self.known.covariance) else { return false };
        for i in 0..3 {
            self.gain.set_row(i, &factors.solve(&cross.row(i).transpose()).transpose());
        }
        let rest = spread - self.gain * cross.transpose();
        self.rest = (rest + rest.transpose()) * 0.5;
        true
    }

    /// What a block has made of tau.
    pub fn learn(&mut self, known: &Gaussian) {
        self.rate += self.gain * (known.mean - self.known.mean);
        self.known = *known;
    }

    /// R.
    pub fn spread(&self) -> Matrix3<f64> {
        self.gain * self.known.covariance * self.gain.transpose() + self.rest
    }

    /// What samples have made of tau, `seconds` later.
    pub fn ahead(&self, now: &Gaussian, seconds: f64) -> Gaussian {
        let rate = self.rate + self.gain * (now.mean - self.known.mean);
        let mut j = Matrix9::identity();
        let mut rows = j.fixed_view_mut::<3, 9>(6, 0);
        rows += self.gain * seconds;
        let mut mean = now.mean;
        let mut beta = mean.fixed_rows_mut::<3>(6);
        beta += rate * seconds;
        let mut covariance = j * now.covariance * j.transpose();
        let mut of_beta = covariance.fixed_view_mut::<3, 3>(6, 6);
        of_beta += self.rest * (seconds * seconds);
        Gaussian { mean, covariance }
    }

    /// `seconds` more, in coordinates that move; `walk` adds to what is known.
    pub fn carry(
        &mut self,
        moving: &Vector3<f64>,
        seconds: f64,
        lasting_s: f64,
        usual: f64,
        walk: impl Fn(&Gaussian) -> Gaussian,
    ) {
        let spread = self.spread();
        let mut cross = self.gain * self.known.covariance;
        let along = (cross * self.gain.transpose() + self.rest) * seconds;
        let mut of_beta = cross.fixed_view_mut::<3, 3>(0, 6);
        of_beta += along;
        self.known = walk(&self.ahead(&self.known, seconds));
        let keep = (-seconds / lasting_s).exp();
        let fresh = (1.0 - keep * keep) * usual;
        self.regress(&(cross * keep), &(spread * (keep * keep) + Matrix3::from_diagonal_element(fresh)));
        self.rate = (self.rate + moving) * keep - moving;
    }

    /// Whether the rate is one that b may have.
    fn is_plausible(&self, unit_ut: f64) -> bool {
        self.rate.norm_squared() < PLAUSIBLE * usual(unit_ut)
    }

    /// log B, in coordinates that move.
    pub fn log_evidence(&self, moving: &Vector3<f64>, unit_ut: f64) -> f64 {
        let Some(factors) = Ldl::new(&self.spread()) else { return f64::MIN };
        0.5 * (factors.square(&(self.rate + moving)) - 3.0 * usual(unit_ut).ln() + factors.log_det)
    }
}

/// What was known, Lambda and tau_0, and a block of samples, linearised at tau.
fn absorbed((prior, mean): (&Matrix9, &Vector9), block: &Likelihood, tau: &Vector9) -> Option<Gaussian> {
    let point = block.at(tau)?;
    let (gradient, _, curvature) = block.expansion(tau, &point);
    let factors = Ldl::new(&(prior + curvature))?;
    let gradient = gradient + prior * (tau - mean);
    Some(Gaussian { mean: tau - factors.solve(&gradient), covariance: factors.inverse() })
}

impl Motion {
    /// How far the coordinates have come at a time. Over a gap, and where a device that rests tells nothing, they stay.
    pub fn go(&mut self, time_ns: i64, unit_ut: f64, unseen: bool) -> Vector3<f64> {
        let seconds = time_ns.saturating_sub(self.latest_ns) as f64 * 1e-9;
        if !unseen && (0.0..GAP_S).contains(&seconds) {
            self.gone_ut += self.rate * (seconds * unit_ut);
        }
        self.latest_ns = time_ns;
        self.gone_ut
    }

    /// After a change the past says nothing about the rate.
    pub fn stop(&mut self) {
        *self = Self { gone_ut: self.gone_ut, latest_ns: self.latest_ns, ..Self::default() };
    }

    /// Other coordinates.
    pub fn shift(&mut self, by: &Vector3<f64>) {
        self.course.iter_mut().for_each(|course| course.known.shift(by));
    }

    /// The course that b moves along, if it does.
    pub fn course(&self) -> Option<&Course> {
        self.course.as_ref().filter(|_| self.on)
    }
}

impl Adaptive {
    /// Blocks of samples are absorbed into what was known before them once that is nearly linear.
    pub(super) fn absorb(&mut self, time_ns: i64) {
        let block = span_length(BLOCK_SPAN);
        let count = self.samples.segment().count();
        let bend = (UNBENT * self.noise.unevenness()).sqrt().to_degrees();
        let enough = if self.drift.has_begun() { ROUGH_DEG } else { bend.clamp(ABSORBED_BELOW_DEG, ROUGH_DEG) };
        let narrow = self.trial.is_none_or(|trial| trial.released) && self.direction_sigma_deg < enough;
        // what is still in doubt must not be taken for decided
        if count < 2 * block || !narrow || !self.rivals.agree() {
            return;
        }
        let (Some(best), Some(widest)) = (self.rivals.best().copied(), self.rivals.widest().copied()) else { return };
        let (older, timed) = self.samples.absorb(BLOCK_SPAN);
        let likelihood = self.likelihood_of(&older);
        let tau = best.posterior.mean;
        let period_s = self.noise.period_s();
        let seconds = (time_ns.saturating_sub(self.absorbed_ns) as f64 * 1e-9).clamp(0.0, 86_400.0);
        if self.drift.has_begun() {
            self.drift.learn(&likelihood, &tau, self.unit_ut);
        } else {
            let Some(known) = absorbed(best.prior(), &likelihood, &tau) else { return };
            self.drift.begin(&known, self.unit_ut);
        }
        self.absorbed_ns = time_ns;
        let Some(known) = self.drift.mixture() else { return };
        let course = match self.motion.course {
            Some(mut course) if self.motion.on => {
                if let Some(known) = self.drift.at_rest() {
                    course.learn(known);
                }
                course
            }
            Some(mut course) if self.motion.ahead > LOST && course.is_plausible(self.unit_ut) => {
                let along = self.along(&course.rate, block, count).map(|along| self.likelihood_of(&along));
                let mean = course.known.mean;
                let learned = take(&course.known, &along.unwrap_or(likelihood), &mean);
                if let Some((_, known)) = learned {
                    course.learn(&known);
                }
                course
            }
            // from the whole segment, or anew
            other => {
                self.motion.ahead = 0.0;
                let line = Line::new(&likelihood, &timed, period_s, widest.prior(), self.unit_ut);
                let fit = if other.is_none() { line.fit(&tau) } else { None };
                fit.unwrap_or_else(|| Course::new(known, usual(self.unit_ut)))
            }
        };
        let half_s = 0.5 * period_s * count as f64;
        let evidence = course.log_evidence(&self.motion.rate, self.unit_ut);
        let better = evidence > BEGINS && self.motion.ahead > BETTER;
        if !self.motion.on && better && course.is_plausible(self.unit_ut) && is_close(&course.known) {
            self.set_off(best.order, course, half_s + 0.5 * period_s * block as f64);
        } else {
            self.go_on(&best, course, evidence, half_s, seconds);
        }
    }

    /// From one block to the next.
    fn go_on(&mut self, best: &Hypothesis, mut course: Course, evidence: f64, ahead_s: f64, seconds: f64) {
        let unit_ut = self.unit_ut;
        let block = self.likelihood_of(self.samples.segment());
        let still = |known: &Gaussian| rested(known, unit_ut, seconds);
        let moved = self.motion.on && evidence > ENDS;
        if moved {
            course.carry(&self.motion.rate, ahead_s, RATE_S, usual(unit_ut), |known| *known);
            if let Some(known) = self.drift.at_rest() {
                *known = course.known;
            }
            self.drift.walk(&self.motion.rate, unit_ut, seconds, ahead_s);
            self.drift.accelerate(&course.rate);
            if let Some(known) = self.drift.at_rest() {
                course.known = *known;
            }
            self.motion.rate += std::mem::take(&mut course.rate);
        } else {
            course.carry(&self.motion.rate, ahead_s, RATE_S, usual(unit_ut), still);
            let moving = std::mem::take(&mut self.motion.rate);
            course.rate += moving;
            self.drift.walk(&moving, unit_ut, seconds, ahead_s);
            self.drift.accelerate(&-moving);
        }
        let Some(known) = self.drift.mixture() else { return };
        if !moved {
            let along = self.along(&course.rate, 0, self.samples.segment().count());
            let with = along.and_then(|along| take(&course.known, &self.likelihood_of(&along), &course.known.mean));
            let ahead = with
                .zip(take(&known, &block, &known.mean))
                .map_or(2.0 * LOST, |((with, _), (without, _))| with - without);
            self.motion.ahead = KEPT * self.motion.ahead + ahead;
        }
        (self.motion.on, self.motion.course) = (moved, Some(course));
        self.next_block(best.order, &known, &best.posterior.mean);
    }

    /// b is found to move, since `seconds` ago: from now on the coordinates move with it.
    fn set_off(&mut self, order: ModelOrder, mut course: Course, seconds: f64) {
        course.carry(&self.motion.rate, seconds, RATE_S, usual(self.unit_ut), |known| *known);
        let known = course.known;
        self.motion.rate += std::mem::take(&mut course.rate);
        (self.motion.on, self.motion.course) = (true, Some(course));
        self.drift.begin(&known, self.unit_ut);
        self.samples.clear(self.centre_ut);
        self.next_block(order, &known, &known.mean);
    }

    /// What is known before the samples that have not been absorbed; `tau` to iterate from.
    fn next_block(&mut self, order: ModelOrder, known: &Gaussian, tau: &Vector9) {
        let Some(mut next) = Hypothesis::new(order, known, 0.0) else { return };
        if self.samples.segment().count() > 0 {
            next.posterior.mean = *tau;
            next.refine(&self.likelihood_of(self.samples.segment()), 2);
        }
        self.rivals = Rivals::new([next], &[]);
        if let Some(trial) = self.trial.filter(|trial| trial.released) {
            self.remember(trial.base);
            self.trial = None;
        }
    }

    /// The samples from..to before the latest as they were had b stayed where it is in the middle of them.
    fn along(&self, rate: &Vector3<f64>, from: usize, to: usize) -> Option<Moments> {
        if to > self.samples.age.min(REVIEWED) {
            return None;
        }
        let mut moments = Moments::new(self.centre_ut, self.unit_ut);
        let step = rate * (self.noise.period_s() * self.unit_ut);
        let middle = 0.5 * (from + to - 1) as f64;
        (from..to).for_each(|back| moments.add(&(self.samples.latest(back) - step * (middle - back as f64))));
        Some(moments)
    }

    /// While nothing has been absorbed: a segment that b moves through may never be known well enough for that.
    pub(super) fn look_for_a_rate(&mut self, time_ns: i64) {
        let age = self.samples.age;
        let whole = age == self.samples.segment().count() && age == self.samples.timed.count();
        let open = self.trial.is_none_or(|trial| !trial.released) || !self.rivals.agree();
        if !whole || age < WHOLE_FROM || !age.is_multiple_of(WHOLE_EVERY) || open {
            return;
        }
        let Some(widest) = self.rivals.widest() else { return };
        let (order, period_s) = (widest.order, self.noise.period_s());
        let likelihood = self.likelihood_of(self.samples.segment());
        let line = Line::new(&likelihood, &self.samples.timed, period_s, widest.prior(), self.unit_ut);
        let Some(course) = line.fit(&widest.posterior.mean) else { return };
        if is_close(&course.known)
            && course.is_plausible(self.unit_ut)
            && course.log_evidence(&self.motion.rate, self.unit_ut) > BEGINS
        {
            self.absorbed_ns = time_ns;
            self.set_off(order, course, 0.5 * period_s * age as f64);
        }
    }
}
