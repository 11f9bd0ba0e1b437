//! Slow change. Does b rest or move? For each a filter is carried on: side by side they absorb the same blocks of samples,
//! linear where the fit stands. Between them rest hardly walks; the other does, beta at random (and a fiftieth of it T) and along
//! a `Course` whose rate lasts a minute, while the device moves. What each predicts of a block is its log evidence, with
//! v = g + Lambda (tau - tau_0), Lambda = P^-1,
//!     (v^T (H + Lambda)^-1 v - log det (I + P H) - L - (tau - tau_0)^T Lambda (tau - tau_0)) / 2
//! added up. The one that moves never falls further behind than LEAST: what moves now need not have moved before. Rest may fall
//! by SMALL_CHANGE_ADRIFT, as a place where the field differs may be left again, and then begins anew from the other. That one
//! begins anew from rest once it knows b no better than CLOSE_DEG: what may be anywhere fits every place.
//! By their weights they are one Gaussian, the prior of the next block.

use super::angle::is_close;
use super::hypothesis::Gaussian;
use super::likelihood::Likelihood;
use super::notice::SMALL_CHANGE_ADRIFT;
use super::parameters::Vector9;
use super::rate::Course;
use crate::ellipsoid::ldl::Ldl;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Random walks of b at rest and where it moves, uT per square root of a second.
const REST_UT: f64 = 0.003;
const WALK_UT: f64 = 0.2;
/// A rate where it moves, uT/s per axis, and how long it lasts, s: a magnet that is drawn near.
const RATE_UT: f64 = 0.5;
const RATE_S: f64 = 60.0;
/// Walk of T over that of beta.
const SHAPE_SHARE: f64 = 0.02;
/// Least log evidence for motion, against rest.
const LEAST: f64 = -4.0;
/// Odds of motion before the samples speak; a share less than MATTERS counts for nothing.
const RARE: f64 = 0.05;
const MATTERS: f64 = 0.1;

/// What is known where b rests and where it moves, and the log evidence for motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Drift {
    known: Option<(Gaussian, Course)>,
    evidence: f64,
}

/// What is known after a walk of `walk_ut` (uT per square root of a second) over `seconds`.
fn walked(known: &Gaussian, walk_ut: f64, unit_ut: f64, seconds: f64) -> Gaussian {
    let mut walked = *known;
    let variance = (walk_ut / unit_ut).powi(2) * seconds;
    for i in 0..6 {
        walked.covariance[(i, i)] += variance * SHAPE_SHARE * SHAPE_SHARE;
    }
    for i in 6..9 {
        walked.covariance[(i, i)] += variance;
    }
    walked
}

/// What is known after `seconds` at rest.
pub(super) fn rested(known: &Gaussian, unit_ut: f64, seconds: f64) -> Gaussian {
    walked(known, REST_UT, unit_ut, seconds)
}

/// Log evidence of a block of samples, up to what does not depend on what is known, and what it makes of it; linear at tau.
pub(super) fn take(known: &Gaussian, block: &Likelihood, tau: &Vector9) -> Option<(f64, Gaussian)> {
    let point = block.at(tau)?;
    let (gradient, raw, curvature) = block.expansion(tau, &point);
    let prior = Ldl::new(&known.covariance)?;
    let information = prior.inverse();
    let off = tau - known.mean;
    let back = information * off;
    let factors = Ldl::new(&(raw + information))?;
    let square = factors.square(&(block.score(tau, &point) + back));
    let evidence = 0.5 * (square - factors.log_det - prior.log_det - point.cost - off.dot(&back));
    let factors = Ldl::new(&(curvature + information))?;
    Some((evidence, Gaussian { mean: tau - factors.solve(&(gradient + back)), covariance: factors.inverse() }))
}

fn variance(unit_ut: f64) -> f64 {
    (RATE_UT / unit_ut).powi(2)
}

impl Drift {
    /// Nothing but this is known.
    pub fn begin(&mut self, known: &Gaussian, unit_ut: f64) {
        *self = Self { known: Some((*known, Course::new(*known, variance(unit_ut)))), evidence: 0.0 };
    }

    /// Whether it has.
    pub fn has_begun(&self) -> bool {
        self.known.is_some()
    }

    /// How likely b moves.
    fn share(&self) -> f64 {
        let odds = RARE * self.evidence.exp();
        match odds / (1.0 + odds) {
            share if share < MATTERS => 0.0,
            share if share > 1.0 - MATTERS => 1.0,
            share => share,
        }
    }

    /// Whether b may be moving.
    pub fn is_on(&self) -> bool {
        self.share() > 0.0
    }

    /// A block of samples, linear at tau.
    pub fn learn(&mut self, block: &Likelihood, tau: &Vector9, unit_ut: f64) {
        let Some((rest, course)) = &mut self.known else { return };
        let Some((at_rest, after)) = take(rest, block, tau) else { return };
        *rest = after;
        if let Some((moving, after)) = take(&course.known, block, tau).filter(|(_, after)| is_close(after)) {
            course.learn(&after);
            self.evidence = (self.evidence + moving - at_rest).max(LEAST);
            if self.evidence > SMALL_CHANGE_ADRIFT {
                (*rest, self.evidence) = (after, -LEAST);
            }
        } else {
            (*course, self.evidence) = (Course::new(*rest, variance(unit_ut)), LEAST);
        }
    }

    /// What is known where b rests.
    pub fn at_rest(&mut self) -> Option<&mut Gaussian> {
        self.known.as_mut().map(|(rest, _)| rest)
    }

    /// What is known by both.
    pub fn mixture(&self) -> Option<Gaussian> {
        let (rest, Course { known: moving, .. }) = self.known.as_ref()?;
        let share = self.share();
        let off = moving.mean - rest.mean;
        let between = off * off.transpose() * (share * (1.0 - share));
        Some(Gaussian {
            mean: rest.mean + off * share,
            covariance: rest.covariance * (1.0 - share) + moving.covariance * share + between,
        })
    }

    /// `seconds` more, the device moving for `seen_s` of them, in coordinates that move.
    pub fn walk(&mut self, moving: &Vector3<f64>, unit_ut: f64, seconds: f64, seen_s: f64) {
        let Some((rest, course)) = &mut self.known else { return };
        *rest = rested(rest, unit_ut, seconds);
        course.carry(moving, seen_s, RATE_S, variance(unit_ut), |known| walked(known, WALK_UT, unit_ut, seconds));
    }

    /// The coordinates move faster by this from now on.
    pub fn accelerate(&mut self, by: &Vector3<f64>) {
        self.known.iter_mut().for_each(|(_, course)| course.rate -= by);
    }

    /// Other coordinates.
    pub fn shift(&mut self, by: &Vector3<f64>) {
        if let Some((rest, course)) = &mut self.known {
            rest.shift(by);
            course.known.shift(by);
        }
    }

    /// After a change the past says nothing about drift.
    pub fn reset(&mut self) {
        *self = Self::default();
    }
}

#[cfg(test)]
mod tests {
    use super::super::parameters::{Matrix9, tau_of};
    use super::*;
    use crate::ellipsoid::Moments;
    use nalgebra::Matrix3;

    const UNIT_UT: f64 = 50.0;
    const NOISE: f64 = 0.03;

    /// What comes of blocks of 64 samples of the unit sphere about (x, 0, 0) that count as one each; of each block `seen` gives x and
    /// whether it is an arc: which way it points, degrees, and how much larger the field is there. Whether b is said to move in the
    /// end, and where it is.
    fn follow(blocks: i32, seen: impl Fn(i32) -> (f64, Option<(f64, f64)>)) -> (bool, Vector3<f64>) {
        let known =
            Gaussian { mean: tau_of(&Matrix3::identity(), &Vector3::zeros()), covariance: Matrix9::identity() * 1e-4 };
        let mut drift = Drift::default();
        drift.begin(&known, UNIT_UT);
        let mut tau = known.mean;
        for block in 0..blocks {
            let (x, arc) = seen(block);
            let mut moments = Moments::new(Vector3::zeros(), UNIT_UT);
            for k in 0..64 {
                let a = f64::from(block * 64 + k);
                let (angle, larger) = arc.map_or((a * 0.7, 0.0), |(angle, larger)| (angle.to_radians(), larger));
                let turn = if arc.is_some() { 0.05 } else { 1.0 };
                let beside = Vector3::new(0.0, (a * 1.3).cos(), (a * 0.31 + 1.0).sin()) * turn;
                let direction = (Vector3::new(angle.sin(), 0.0, angle.cos()) + beside).normalize();
                let radius = 1.0 + larger + NOISE * (a * 12.9898).sin();
                moments.add(&((direction * radius + Vector3::x() * x) * UNIT_UT));
            }
            drift.learn(&Likelihood::new(&moments, 0.5 * NOISE * NOISE, 1.0), &tau, UNIT_UT);
            tau = drift.mixture().expect("begun").mean;
            drift.walk(&Vector3::zeros(), UNIT_UT, 0.64, 0.64);
        }
        (drift.is_on(), tau.fixed_rows::<3>(6).into_owned())
    }

    #[test]
    fn what_moves_is_followed_and_what_rests_rests() {
        let (on, b) = follow(94, |_| (0.0, None));
        assert!(!on && b.norm() < 0.005, "at rest: {on}, {b:?}");
        // 0.5 uT/s from 20 s on
        let x = |block: i32| 0.01 * 0.64 * f64::from((block - 31).max(0));
        let (on, b) = follow(94, |block| (x(block), None));
        assert!(on && (b - Vector3::x() * x(93)).norm() < 0.03, "moving: {on}, {b:?}");
    }

    /// Not turned but for three seconds at a place where the field is a tenth larger: a b that went unseen would explain it.
    #[test]
    fn what_one_arc_shows_for_a_while_is_no_motion() {
        for angle in [40.0, 60.0, 80.0] {
            let arc = |block: i32| if (60..64).contains(&block) { (angle, 0.1) } else { (0.0, 0.0) };
            let (on, b) = follow(94, |block| (0.0, Some(arc(block))));
            assert!(!on && b.norm() < 0.05, "{angle} deg away: {on}, {b:?}");
        }
    }
}
