//! What a hypothesis has come to know, and how a frame changes it. State:
//!     x = (tau: T, beta, mu;  level, uneven;  tilted level, tilt;  bias of the accelerometer)
//! level: by how much the place's field is stronger than usual (a jump is a new place); uneven: a first-order Markov process of
//! the device's motion; the same two of the vertical part. Frames k say
//!     (|T (u - beta)| - 1) / slope = (level + uneven) / slope + noise,      up.n = mu + tilted level + tilt + noise,   n = T (u - beta) / |.|
//! Both are free of scale, and their derivatives are taken at the sample's foot on the ellipsoid: else a smaller T makes both noise
//! and miss smaller, and any noise asks for a larger ellipsoid.
//! Evidence: the product of the innovations' probabilities. An innovation beyond all noise is a spike (left out, at a price); two
//! in a row are a new place (at a price).

#[cfg(test)]
mod tests;

use super::frame::{Frame, Frames};
use super::parameters::{Covariance, Gaussian, LEAST_VARIANCE, Numbers, STATES, Tau, gradient, see, shape};
use super::rate::{Over, Rate};
use super::spread::{Before, Spread};
use super::tuning::Tuning;
use crate::math::elementary::ln;
use crate::noise::{Lasting, Process};
use crate::priors::{OUTLYING, RARE};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::FRAC_1_SQRT_2;
use std::ops::Range;

/// Format: place of the level of the place in the state, after tau.
const LEVEL: usize = 10;
/// Format: place of the place's unevenness in the state.
const UNEVEN: usize = 11;
/// Format: place of the level of the vertical part in the state.
const TILTED: usize = 12;
/// Format: place of a tilt that lasts in the state.
const TILT: usize = 13;
/// Format: place of the accelerometer's bias, three axes in the state.
const BIAS: usize = 14;
/// Data sheet: bias of an accelerometer, in gravities: 0.1 to 0.2 m/s^2.
const BIAS_G: f64 = 0.02;
/// Mathematics: sine of a dip, 84 degrees, beyond which the level part of the field is too small to divide by.
const STEEPEST: f64 = 0.995;
/// Choice: on the way to another place the field is so many times as uneven.
const ROUGH: f64 = 4.0;

/// How b and the place are on the way since the onset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Way {
    /// Random walk of b, units per root second.
    pub walk: f64,
    /// Until then the way to another place is uneven.
    pub rough_until_ns: i64,
    /// Until then the device changes: any field is as likely as another, one unit wide.
    pub done_ns: i64,
    /// Whether the vertical is of use; else any angle between field and vertical is as likely as another, one radian wide.
    pub heeds_vertical: bool,
    /// Whether tau is taken for the truth.
    pub is_fixed: bool,
    /// How b moves, where it does: units a second.
    pub rates: Option<Process>,
}

impl Way {
    /// For a state that takes tau for the truth.
    pub fn fixed(self) -> Self {
        Self { walk: 0.0, is_fixed: true, rates: None, ..self }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct State {
    pub x: Numbers,
    pub p: Covariance,
    /// How fast b moves.
    pub rate: Rate,
    /// How far the directions differ.
    spread: Spread,
    /// Frames in a row that were no noise.
    pub odd: u32,
    pub log: f64,
    /// Onset of the present place, where it is not the usual one.
    pub place_ns: Option<i64>,
}

/// State and covariance after a scalar miss e + g (x - lin) with variance r.
pub(super) fn innovation(state: &State, lin: &Tau, e: f64, g: &Numbers, r: f64) -> (f64, f64, Numbers) {
    let pg = state.p * g;
    let mut nu = e;
    for i in 0..10 {
        nu += g[i] * (state.x[i] - lin[i]);
    }
    for i in 10..STATES {
        nu += g[i] * state.x[i];
    }
    (nu, g.dot(&pg).max(0.0) + r, pg)
}

pub(super) fn update(state: &mut State, nu: f64, s: f64, pg: &Numbers) {
    let k = pg / s;
    state.x -= k * nu;
    state.p -= k * pg.transpose();
    state.log -= 0.5 * (nu * nu / s + ln(std::f64::consts::TAU * s));
}

fn reset(state: &mut State, at: usize, variance: f64) {
    state.x[at] = 0.0;
    for i in 0..STATES {
        state.p[(i, at)] = 0.0;
        state.p[(at, i)] = 0.0;
    }
    state.rate.with.row_mut(at).fill(0.0);
    state.p[(at, at)] = variance;
}

impl State {
    /// Nothing of the place is known.
    pub fn new(known: &Gaussian, uneven: f64, tilt: f64) -> Self {
        let mut x = Numbers::zeros();
        x.fixed_rows_mut::<10>(0).copy_from(&known.mean);
        let mut p = Covariance::zeros();
        p.fixed_view_mut::<10, 10>(0, 0).copy_from(&known.covariance);
        (p[(LEVEL, LEVEL)], p[(TILTED, TILTED)]) = (LEAST_VARIANCE, LEAST_VARIANCE);
        (p[(UNEVEN, UNEVEN)], p[(TILT, TILT)]) = (uneven, tilt);
        (BIAS..STATES).for_each(|i| p[(i, i)] = BIAS_G * BIAS_G);
        let mut state =
            Self { x, p, rate: Rate::default(), spread: Spread::default(), odd: 0, log: 0.0, place_ns: None };
        state.begin_spread();
        state
    }

    /// The same place, another device.
    pub fn with(&self, known: &Gaussian) -> Self {
        let mut state = self.clone();
        for i in 0..10 {
            reset(&mut state, i, 0.0);
        }
        state.x.fixed_rows_mut::<10>(0).copy_from(&known.mean);
        state.p.fixed_view_mut::<10, 10>(0, 0).copy_from(&known.covariance);
        state.begin_spread();
        state
    }

    fn lasts(&mut self, at: usize, Lasting { phi, variance }: Lasting) {
        self.x[at] *= phi;
        for i in 0..STATES {
            self.p[(i, at)] *= phi;
            self.p[(at, i)] *= phi;
        }
        self.rate.with.row_mut(at).scale_mut(phi);
        self.p[(at, at)] += (1.0 - phi * phi) * variance;
    }

    /// b moves for a while; by how much its variance along an axis grows.
    fn moves(&mut self, rates: Process, seconds: f64) -> f64 {
        let sum = |p: &Covariance| p[(6, 6)] + p[(7, 7)] + p[(8, 8)];
        let before = sum(&self.p);
        let Over { phi, by, own, with, walked } = Over::new(rates, seconds);
        (0..3).for_each(|i| self.x[6 + i] += by * self.rate.mean[i]);
        // P of b with all, then with itself
        let carried = self.rate.with * by;
        for j in 0..3 {
            for i in 0..STATES {
                self.p[(i, 6 + j)] += carried[(i, j)];
                self.p[(6 + j, i)] += carried[(i, j)];
            }
            for i in 0..3 {
                self.p[(6 + i, 6 + j)] += by * by * self.rate.own[(i, j)];
                self.rate.with[(6 + i, j)] += by * self.rate.own[(i, j)];
            }
            self.p[(6 + j, 6 + j)] += walked;
        }
        self.rate.with *= phi;
        (0..3).for_each(|j| self.rate.with[(6 + j, j)] += with);
        self.rate.mean *= phi;
        self.rate.own = self.rate.own * (phi * phi) + Matrix3::from_diagonal_element(own);
        ((sum(&self.p) - before) / 3.0).max(0.0)
    }

    /// A miss nu of variance s, with derivative g.
    fn learn(&mut self, nu: f64, s: f64, g: &Numbers, pg: &Numbers, way: &Way) {
        if way.rates.is_some() {
            self.rate.update(nu, s, g, pg);
        }
        update(self, nu, s, pg);
    }

    /// One frame, linear about `lin`; false where lin is none of its.
    pub fn step(&mut self, lin: &Tau, frame: &Frame, way: Way, tuning: &Tuning) -> bool {
        let rough = if tuning.rough && frame.time_ns < way.rough_until_ns { ROUGH * ROUGH } else { 1.0 };
        self.lasts(UNEVEN, Lasting { variance: frame.uneven.variance * rough, ..frame.uneven });
        self.lasts(TILT, frame.tilt);
        let mut moved = way.walk * way.walk * frame.seconds;
        (6..9).for_each(|i| self.p[(i, i)] += moved);
        if let Some(rates) = way.rates {
            moved += self.moves(rates, frame.seconds);
        }
        if frame.time_ns < way.done_ns {
            return true;
        }
        let Some(seen) = see(lin, &frame.u) else { return false };
        let mut g = Numbers::zeros();
        g.fixed_rows_mut::<10>(0)
            .copy_from(&(gradient(lin, &seen.direction, &(seen.offset / seen.radius), 0.0) / seen.slope));
        (g[LEVEL], g[UNEVEN]) = (-1.0 / seen.slope, -1.0 / seen.slope);
        let e = (seen.radius - 1.0) / seen.slope;
        let (mut nu, mut s, mut pg) = innovation(self, lin, e, &g, frame.white);
        // what is not linear: a centre that is off by d across the line of sight
        let across = (self.p[(6, 6)] + self.p[(7, 7)] + self.p[(8, 8)]) / 3.0;
        let is_odd = |nu: f64, s: f64| nu * nu > OUTLYING * OUTLYING * (s + across * across);
        let mut v = None;
        if let Some(up) = frame.up.filter(|_| way.heeds_vertical) {
            let mut gv = Numbers::zeros();
            let sine = up.dot(&seen.direction);
            let mu = lin[9].clamp(-STEEPEST, STEEPEST);
            let level = (up - seen.direction * sine).try_normalize(1e-6).unwrap_or_else(Vector3::zeros)
                * (1.0 - mu * mu).sqrt();
            let across = level / seen.radius;
            let up = seen.direction * mu + level;
            gv.fixed_rows_mut::<10>(0).copy_from(&gradient(lin, &across, &seen.offset, 1.0));
            (gv[TILTED], gv[TILT]) = (-1.0, -1.0);
            let turned = seen.direction - up * mu;
            if tuning.accelerometer_bias {
                (0..3).for_each(|i| gv[BIAS + i] = -turned[i]);
            }
            v = Some((sine - lin[9], gv));
        }
        if is_odd(nu, s) {
            self.odd += 1;
            if self.odd < 2 {
                self.log += ln(RARE * 0.5);
                if v.is_some() {
                    self.log += ln(0.5);
                }
                return true;
            }
            // another place
            let variance = tuning.place * tuning.place;
            reset(self, LEVEL, variance);
            reset(self, TILTED, variance);
            self.log += ln(tuning.places_per_h * frame.seconds / 3600.0);
            self.place_ns = Some(frame.time_ns);
            (nu, s, pg) = innovation(self, lin, e, &g, frame.white);
        }
        self.odd = 0;
        self.learn(nu, s, &g, &pg, &way);
        if tuning.spread && !way.is_fixed {
            self.spread.walk(moved);
            self.spread.add(&frame.u, &seen.direction, frame.white, frame.uneven.variance, s);
            if let Some(up) = frame.up.filter(|_| way.heeds_vertical) {
                self.spread.tilt(&up, frame.tilt.variance);
            }
        }
        if let Some((e, g)) = v {
            let (nu, s, pg) = innovation(self, lin, e, &g, frame.tilt_white);
            if nu * nu > OUTLYING * OUTLYING * (s + across) {
                self.log += ln(RARE * 0.5);
            } else {
                self.learn(nu, s, &g, &pg, &way);
            }
        }
        true
    }

    /// Frames one after the other, linear about `lin`; false where lin is none of theirs.
    pub fn follow(&mut self, lin: &Tau, frames: &Frames, mut numbers: Range<u64>, way: Way, tuning: &Tuning) -> bool {
        numbers.all(|number| self.step(lin, frames.at(number), way, tuning))
    }

    /// The same, taking a point for the truth.
    pub fn fixed_at(&self, tau: &Tau) -> Self {
        let mut state = self.clone();
        for i in 0..10 {
            reset(&mut state, i, 0.0);
            state.x[i] = tau[i];
        }
        state.log = 0.0;
        state
    }

    /// What is known of tau.
    pub fn known(&self) -> Gaussian {
        Gaussian { mean: self.tau(), covariance: self.p.fixed_view::<10, 10>(0, 0).into() }
    }

    /// What is known, without what only noise tells.
    pub fn honest(&self) -> Gaussian {
        let mut known = self.known();
        if let Some((axis, least)) = self.spread.least(&shape(&known.mean)) {
            let by_axis = known.covariance.fixed_columns::<3>(6) * axis;
            let variance = by_axis.fixed_rows::<3>(6).dot(&axis);
            if variance < least {
                known.covariance += by_axis * by_axis.transpose() * ((least - variance) / (variance * variance));
            }
        }
        known
    }

    /// What is known now is what is known before what comes.
    pub fn begin_spread(&mut self) {
        self.spread = Spread::new(Before {
            beta: self.p.fixed_view::<3, 3>(6, 6).into(),
            strength: self.p.fixed_view::<3, 3>(0, 0).sum() / 9.0,
            vertical: self.p[(9, 9)],
        });
    }

    /// b may be off by so much more, units per axis, and T, an element on the diagonal.
    pub fn widen(&mut self, step: f64, iron: f64) {
        for i in 0..3 {
            self.p[(i, i)] += iron.powi(2);
            self.p[(3 + i, 3 + i)] += (FRAC_1_SQRT_2 * iron).powi(2);
            self.p[(6 + i, 6 + i)] += step.powi(2);
        }
    }

    /// Takes what is known of T, beta and mu for as sure as this.
    pub fn take_for_known(&mut self, honest: &Gaussian) {
        self.p.fixed_view_mut::<10, 10>(0, 0).copy_from(&honest.covariance);
    }

    /// Another place, whose strength and vertical part differ from the usual ones by `sd`.
    pub fn moves_to(&mut self, sd: f64, time_ns: i64) {
        reset(self, LEVEL, sd * sd);
        reset(self, TILTED, sd * sd);
        self.place_ns = Some(time_ns);
    }

    /// T, beta and mu.
    pub fn tau(&self) -> Tau {
        self.x.fixed_rows::<10>(0).into()
    }

    /// Level of the place, with its variance.
    pub fn level(&self) -> (f64, f64, f64) {
        (self.x[LEVEL], self.x[TILTED], self.p[(LEVEL, LEVEL)].max(self.p[(TILTED, TILTED)]))
    }
}
