//! What a hypothesis has come to know, and how a frame changes it. State:
//!     x = (tau: T, beta, mu;  level, uneven;  tilted level, tilt;  bias of the accelerometer)
//! level: by how much the place's field is stronger than usual (a jump is a new place); uneven: a first-order Markov process of
//! the device's motion; the same two of the vertical part. Frames k say
//!     (|T (u - beta)| - 1) / slope = (level + uneven) / slope + noise,      up.n = mu + tilted level + tilt + noise,   n = T (u - beta) / |.|
//! A state that takes tau for the truth has the last seven numbers alone.
//! Both are free of scale, and their derivatives are taken at the sample's foot on the ellipsoid: else a smaller T makes both noise
//! and miss smaller, and any noise asks for a larger ellipsoid.
//! Evidence: the product of the innovations' probabilities. An innovation beyond all noise is a spike (left out, at a price); two
//! in a row are a new place (at a price).

#[cfg(test)]
mod tests;

use super::frame::{Frame, Frames};
use super::parameters::{BESIDE, COUNT, Gaussian, LEAST_VARIANCE, Numbers, STATES, Seen, Tau, gradient, see, shape};
use super::rate::{Over, Rate};
use super::spread::Spread;
use super::tuning::Tuning;
use crate::math::elementary::ln;
use crate::noise::{Lasting, Process};
use crate::priors::{OUTLYING, RARE};
use core::f64::consts::FRAC_1_SQRT_2;
use core::ops::Range;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::{Matrix3, SMatrix, Vector3};

/// Format: place of the level of the place in the state, after tau.
const LEVEL: usize = 0;
/// Format: place of the place's unevenness in the state, after tau.
const UNEVEN: usize = 1;
/// Format: place of the level of the vertical part in the state, after tau.
const TILTED: usize = 2;
/// Format: place of a tilt that lasts in the state, after tau.
const TILT: usize = 3;
/// Format: place of the accelerometer's bias, three axes in the state, after tau.
const BIAS: usize = 4;
/// Data sheet: bias of an accelerometer, in gravities: 0.1 to 0.2 m/s^2.
const BIAS_G: f64 = 0.02;
/// Mathematics: sine of a dip, 84 degrees, beyond which the level part of the field is too small to divide by.
const STEEPEST: f64 = 0.995;
/// Mathematics: a covariance that has died out to this is nothing: numbers that go on dying out become subnormal, and slow.
const DUST: f64 = 1e-100;
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
    /// How b moves, where it does: units a second.
    pub rates: Option<Process>,
}

#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct State<const N: usize = STATES> {
    pub x: Numbers<N>,
    pub p: SMatrix<f64, N, N>,
    /// How fast b moves.
    pub rate: Rate<N>,
    /// How far the directions differ.
    spread: Spread,
    /// Frames in a row that were no noise.
    pub odd: u32,
    pub log: f64,
    /// Onset of the present place, where it is not the usual one.
    pub place_ns: Option<i64>,
}

impl<const N: usize> Default for State<N> {
    fn default() -> Self {
        Self {
            x: Numbers::zeros(),
            p: SMatrix::zeros(),
            rate: Rate::default(),
            spread: Spread::default(),
            odd: 0,
            log: 0.0,
            place_ns: None,
        }
    }
}

impl<const N: usize> State<N> {
    /// Where the numbers beside tau begin.
    const AT: usize = N - BESIDE;
    const KNOWS_TAU: bool = N == STATES;

    /// A scalar miss e + g (x - lin), its variance with noise r, and P g.
    pub fn innovation(&self, lin: &Tau, e: f64, g: &Numbers<N>, r: f64) -> (f64, f64, Numbers<N>) {
        let mut pg = Numbers::<N>::zeros();
        // a third of the derivatives are none
        (0..N).filter(|j| g[*j] != 0.0).for_each(|j| pg.axpy(g[j], &self.p.column(j), 1.0));
        let mut nu = e;
        for i in 0..Self::AT {
            nu += g[i] * (self.x[i] - lin[i]);
        }
        for i in Self::AT..N {
            nu += g[i] * self.x[i];
        }
        (nu, g.dot(&pg).max(0.0) + r, pg)
    }

    pub fn update(&mut self, nu: f64, s: f64, pg: &Numbers<N>) {
        let k = pg / s;
        self.x -= k * nu;
        (0..N).for_each(|j| self.p.column_mut(j).axpy(-pg[j], &k, 1.0));
        self.log -= 0.5 * (nu * nu / s + ln(core::f64::consts::TAU * s));
    }

    fn reset(&mut self, at: usize, variance: f64) {
        self.x[at] = 0.0;
        self.p.row_mut(at).fill(0.0);
        self.p.column_mut(at).fill(0.0);
        self.rate.with.row_mut(at).fill(0.0);
        self.p[(at, at)] = variance;
    }

    fn lasts(&mut self, at: usize, Lasting { phi, variance }: Lasting) {
        let at = Self::AT + at;
        let fade = |x: f64| if (x * phi).abs() < DUST { 0.0 } else { x * phi };
        self.x[at] = fade(self.x[at]);
        for i in 0..N {
            self.p[(i, at)] = fade(self.p[(i, at)]);
            self.p[(at, i)] = fade(self.p[(at, i)]);
        }
        self.rate.with.row_mut(at).apply(|x| *x = fade(*x));
        self.p[(at, at)] += (1.0 - phi * phi) * variance;
    }

    /// A miss nu of variance s, with derivative g.
    fn learn(&mut self, nu: f64, s: f64, g: &Numbers<N>, pg: &Numbers<N>, way: &Way) {
        if Self::KNOWS_TAU && way.rates.is_some() {
            self.rate.update(nu, s, g, pg);
        }
        self.update(nu, s, pg);
    }

    /// One frame, linear about `lin`; impossible from here on where lin is none of its.
    pub fn step(&mut self, lin: &Tau, frame: &Frame, way: Way, tuning: &Tuning) {
        let moved = self.predict(frame, &way, tuning);
        if frame.time_ns < way.done_ns {
            return;
        }
        let Some(seen) = see(lin, &frame.u) else {
            self.log = f64::NEG_INFINITY;
            return;
        };
        // what is not linear: a centre that is off by d across the line of sight
        let across = if Self::KNOWS_TAU { (self.p[(6, 6)] + self.p[(7, 7)] + self.p[(8, 8)]) / 3.0 } else { 0.0 };
        let Some(s) = self.add_field(lin, &seen, across, frame, &way, tuning) else { return };
        if Self::KNOWS_TAU && tuning.spread {
            self.spread.walk(moved);
            self.spread.add(frame, &seen.direction, s);
        }
        self.add_up(lin, &seen, across, frame, &way, tuning);
    }

    /// What lasts fades, and b moves; by how much its variance along an axis grows.
    fn predict(&mut self, frame: &Frame, way: &Way, tuning: &Tuning) -> f64 {
        let rough = if tuning.rough && frame.time_ns < way.rough_until_ns { ROUGH * ROUGH } else { 1.0 };
        self.lasts(UNEVEN, Lasting { variance: frame.uneven.variance * rough, ..frame.uneven });
        self.lasts(TILT, frame.tilt);
        let mut moved = 0.0;
        if Self::KNOWS_TAU {
            moved = way.walk * way.walk * frame.seconds;
            (6..9).for_each(|i| self.p[(i, i)] += moved);
            if let Some(rates) = way.rates {
                moved += self.moves(rates, frame.seconds);
            }
        }
        moved
    }

    /// The strength of a frame's field. Its variance, where it is no spike.
    fn add_field(
        &mut self,
        lin: &Tau,
        seen: &Seen,
        across: f64,
        frame: &Frame,
        way: &Way,
        tuning: &Tuning,
    ) -> Option<f64> {
        let mut g = Numbers::<N>::zeros();
        if Self::KNOWS_TAU {
            let by_tau = gradient(lin, &seen.direction, &(seen.offset / seen.radius), 0.0) / seen.slope;
            g.fixed_rows_mut::<COUNT>(0).copy_from(&by_tau);
        }
        (g[Self::AT + LEVEL], g[Self::AT + UNEVEN]) = (-1.0 / seen.slope, -1.0 / seen.slope);
        let e = (seen.radius - 1.0) / seen.slope;
        let (mut nu, mut s, mut pg) = self.innovation(lin, e, &g, frame.white);
        if nu * nu > OUTLYING * OUTLYING * (s + across * across) {
            self.odd += 1;
            if self.odd < 2 {
                self.log += ln(RARE * 0.5);
                if frame.up.is_some() {
                    self.log += ln(0.5);
                }
                return None;
            }
            // another place
            self.moves_to(tuning.place, frame.time_ns);
            self.log += ln(tuning.places_per_h * frame.seconds / 3600.0);
            (nu, s, pg) = self.innovation(lin, e, &g, frame.white);
        }
        self.odd = 0;
        self.learn(nu, s, &g, &pg, way);
        Some(s)
    }

    /// The part of its direction along the vertical.
    fn add_up(&mut self, lin: &Tau, seen: &Seen, across: f64, frame: &Frame, way: &Way, tuning: &Tuning) {
        let Some(up) = frame.up else { return };
        let sine = up.dot(&seen.direction);
        let mu = lin[9].clamp(-STEEPEST, STEEPEST);
        let level =
            (up - seen.direction * sine).try_normalize(1e-6).unwrap_or_else(Vector3::zeros) * (1.0 - mu * mu).sqrt();
        let mut g = Numbers::<N>::zeros();
        if Self::KNOWS_TAU {
            g.fixed_rows_mut::<COUNT>(0).copy_from(&gradient(lin, &(level / seen.radius), &seen.offset, 1.0));
        }
        (g[Self::AT + TILTED], g[Self::AT + TILT]) = (-1.0, -1.0);
        if tuning.accelerometer_bias {
            let turned = seen.direction - (seen.direction * mu + level) * mu;
            (0..3).for_each(|i| g[Self::AT + BIAS + i] = -turned[i]);
        }
        let (nu, s, pg) = self.innovation(lin, sine - lin[9], &g, frame.tilt_white);
        if nu * nu > OUTLYING * OUTLYING * (s + across) {
            self.log += ln(RARE * 0.5);
        } else {
            self.learn(nu, s, &g, &pg, way);
        }
    }

    /// Frames one after the other, linear about `lin`.
    pub fn follow(&mut self, lin: &Tau, frames: &Frames, numbers: Range<u64>, way: Way, tuning: &Tuning) {
        numbers.for_each(|number| self.step(lin, frames.at(number), way, tuning));
    }

    /// Another place, whose strength and vertical part differ from the usual ones by `sd`.
    pub fn moves_to(&mut self, sd: f64, time_ns: i64) {
        self.reset(Self::AT + LEVEL, sd * sd);
        self.reset(Self::AT + TILTED, sd * sd);
        self.place_ns = Some(time_ns);
    }

    /// b moves for a while; by how much its variance along an axis grows.
    fn moves(&mut self, rates: Process, seconds: f64) -> f64 {
        let sum = |p: &SMatrix<f64, N, N>| p[(6, 6)] + p[(7, 7)] + p[(8, 8)];
        let before = sum(&self.p);
        let Over { phi, by, own, with, walked } = Over::new(rates, seconds);
        (0..3).for_each(|i| self.x[6 + i] += by * self.rate.mean[i]);
        // P of b with all, then with itself
        let carried = self.rate.with * by;
        for j in 0..3 {
            for i in 0..N {
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
}

impl State {
    /// Nothing of the place is known.
    pub fn new(known: &Gaussian, uneven: f64, tilt: f64) -> Self {
        let mut state = Self::default();
        for (at, variance) in [(LEVEL, LEAST_VARIANCE), (TILTED, LEAST_VARIANCE), (UNEVEN, uneven), (TILT, tilt)] {
            state.p[(COUNT + at, COUNT + at)] = variance;
        }
        (COUNT + BIAS..STATES).for_each(|i| state.p[(i, i)] = BIAS_G * BIAS_G);
        state.knows(known);
        state
    }

    /// The same place, another device.
    pub fn with(&self, known: &Gaussian) -> Self {
        let mut state = self.clone();
        (0..COUNT).for_each(|i| state.reset(i, 0.0));
        state.knows(known);
        state
    }

    fn knows(&mut self, known: &Gaussian) {
        self.x.fixed_rows_mut::<COUNT>(0).copy_from(&known.mean);
        self.p.fixed_view_mut::<COUNT, COUNT>(0, 0).copy_from(&known.covariance);
        self.begin_spread();
    }

    /// The same, taking tau for the truth.
    pub fn fixed(&self) -> State<BESIDE> {
        State {
            x: self.x.fixed_rows::<BESIDE>(COUNT).into(),
            p: self.p.fixed_view::<BESIDE, BESIDE>(COUNT, COUNT).into(),
            odd: self.odd,
            place_ns: self.place_ns,
            ..State::default()
        }
    }

    /// What is known of tau.
    pub fn known(&self) -> Gaussian {
        Gaussian { mean: self.tau(), covariance: self.p.fixed_view::<COUNT, COUNT>(0, 0).into() }
    }

    /// Along which axis noise tells of b, and the least variance that can be known there.
    pub fn noise(&self) -> Option<(Vector3<f64>, f64)> {
        self.spread.least(&shape(&self.tau()))
    }

    /// What is known, without what only noise tells.
    pub fn honest(&self) -> Gaussian {
        self.known().without(self.noise())
    }

    /// What is known now is what is known before what comes.
    pub fn begin_spread(&mut self) {
        let strength = self.p.fixed_view::<3, 3>(0, 0).sum() / 9.0;
        self.spread = Spread::new(self.p.fixed_view::<3, 3>(6, 6).into(), strength, self.p[(9, 9)]);
    }

    /// b may be off by so much more, units per axis, and T, an element on the diagonal.
    pub fn widen(&mut self, step: f64, iron: f64) {
        for i in 0..3 {
            self.p[(i, i)] += iron.powi(2);
            self.p[(3 + i, 3 + i)] += (FRAC_1_SQRT_2 * iron).powi(2);
            self.p[(6 + i, 6 + i)] += step.powi(2);
        }
    }

    /// T, beta and mu.
    pub fn tau(&self) -> Tau {
        self.x.fixed_rows::<COUNT>(0).into()
    }

    /// Level of the place, with its variance.
    pub fn level(&self) -> (f64, f64, f64) {
        let (level, tilted) = (COUNT + LEVEL, COUNT + TILTED);
        (self.x[level], self.x[tilted], self.p[(level, level)].max(self.p[(tilted, tilted)]))
    }
}
