//! A hypothesis is a Kalman filter over the frames since its beginning, linear about one point `lin`. State:
//!     x = (tau: T, beta, mu;  level, uneven;  tilted level, tilt)
//! level: by how much the place's field is stronger than usual (a jump is a new place); uneven: a first-order Markov process of
//! the device's motion; the same two of the vertical part. Frames k say
//!     (|T (u - beta)| - 1) / slope = (level + uneven) / slope + noise,      up.n = mu + tilted level + tilt + noise,   n = T (u - beta) / |.|
//! Both are free of scale, and their derivatives are taken at the sample's foot on the ellipsoid: else a smaller T makes both noise
//! and miss smaller, and any noise asks for a larger ellipsoid.
//! Where the mean has moved from `lin`, the filter runs again from its beginning about the new point (iterated filter =
//! Gauss-Newton); all frames are always linear about the same point, so that no information arises that is not there.
//! Evidence: the product of the innovations' probabilities. An innovation beyond all noise is a spike (left out, at a price); two
//! in a row are a new place (at a price).

#[cfg(test)]
mod tests;

use super::frame::{Frame, Frames};
use super::parameters::{Gaussian, Tau, TauMatrix, beyond_earth, gradient, is_bounded, see, shape};
use super::spread::{Before, Spread};
use super::tuning::Tuning;
use crate::math::ldl::Ldl;
use crate::noise::Lasting;
use nalgebra::{SMatrix, SVector, Vector3};

/// Format: numbers of a state.
pub(super) const STATES: usize = 17;
pub(super) type Numbers = SVector<f64, STATES>;
pub(super) type Covariance = SMatrix<f64, STATES, STATES>;
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
/// Choice: square of the standard deviations beyond which an innovation is no noise.
const OUTLIER: f64 = 16.0;
/// Choice: a mean that is so far from `lin` (units, and relative for T) wants another run.
const MOVED: f64 = 0.04;
/// Choice: hypotheses of one change nearer than this are in one place (units, and relative for T).
const SAME_PLACE: f64 = 0.05;
/// Choice: on the way to another place the field is so many times as uneven.
const ROUGH: f64 = 4.0;

/// What a hypothesis says has changed at its onset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Cold,
    Device,
    Place,
    Former,
}

/// How b and the place are on the way since the onset.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Way {
    /// Random walk of b, units per root second.
    walk: f64,
    /// Until then the way to another place is uneven.
    rough_until_ns: i64,
    /// Until then the device changes: any field is as likely as another, one unit wide.
    done_ns: i64,
    /// Whether the vertical is of use; else any angle between field and vertical is as likely as another, one radian wide.
    heeds_vertical: bool,
}

impl Way {
    /// For a state whose b is fixed.
    fn still(self) -> Self {
        Self { walk: 0.0, ..self }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct State {
    pub x: Numbers,
    pub p: Covariance,
    /// How far the directions differ.
    spread: Spread,
    /// Frames in a row that were no noise.
    pub odd: u32,
    pub log: f64,
    /// Onset of the present place, where it is not the usual one.
    pub place_ns: Option<i64>,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Filter {
    pub kind: Kind,
    pub id: u32,
    pub parent: u32,
    pub size: u8,
    pub moves: bool,
    /// Whether the vertical is of use.
    pub heeds_vertical: bool,
    /// The change takes a while.
    pub takes_time: bool,
    pub onset_ns: i64,
    pub begun: u64,
    base: State,
    pub first: u64,
    lin: Tau,
    pub now: State,
    pub age: f64,
    pub former: Option<Gaussian>,
    /// Expected direction error, rad^2.
    pub error: f64,
    /// The strength of the field before anything is known, as a standard deviation of its logarithm about the unit.
    pub scale_sd: Option<f64>,
    stuck: bool,
    /// Sum of the directions since it began, and of how many frames.
    seen: Vector3<f64>,
    frames: f64,
    /// The state that takes `lin` for the truth.
    pub fixed: State,
    pub gain: f64,
}

pub(super) fn known(state: &State) -> Gaussian {
    let covariance: TauMatrix = state.p.fixed_view::<10, 10>(0, 0).into();
    Gaussian { mean: state.x.fixed_rows::<10>(0).into(), covariance }
}

/// State and covariance after a scalar miss e + g (x - lin) with variance r.
fn innovation(state: &State, lin: &Tau, e: f64, g: &Numbers, r: f64) -> (f64, f64, Numbers) {
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

fn update(state: &mut State, nu: f64, s: f64, pg: &Numbers) {
    let k = pg / s;
    state.x -= k * nu;
    state.p -= k * pg.transpose();
    state.log -= 0.5 * (nu * nu / s + (std::f64::consts::TAU * s).ln());
}

fn reset(state: &mut State, at: usize, variance: f64) {
    state.x[at] = 0.0;
    for i in 0..STATES {
        state.p[(i, at)] = 0.0;
        state.p[(at, i)] = 0.0;
    }
    state.p[(at, at)] = variance;
}

impl State {
    /// Nothing of the place is known.
    pub fn new(known: &Gaussian, uneven: f64, tilt: f64) -> Self {
        let mut x = Numbers::zeros();
        x.fixed_rows_mut::<10>(0).copy_from(&known.mean);
        let mut p = Covariance::zeros();
        p.fixed_view_mut::<10, 10>(0, 0).copy_from(&known.covariance);
        (p[(LEVEL, LEVEL)], p[(TILTED, TILTED)]) = (1e-8, 1e-8);
        (p[(UNEVEN, UNEVEN)], p[(TILT, TILT)]) = (uneven, tilt);
        (BIAS..STATES).for_each(|i| p[(i, i)] = BIAS_G * BIAS_G);
        let mut state = Self { x, p, spread: Spread::default(), odd: 0, log: 0.0, place_ns: None };
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
        self.p[(at, at)] += (1.0 - phi * phi) * variance;
    }

    /// One frame, linear about `lin`; false where lin is none of its.
    fn step(&mut self, lin: &Tau, frame: &Frame, way: Way, tuning: &Tuning) -> bool {
        let rough = if frame.time_ns < way.rough_until_ns { ROUGH * ROUGH } else { 1.0 };
        self.lasts(UNEVEN, Lasting { variance: frame.uneven.variance * rough, ..frame.uneven });
        self.lasts(TILT, frame.tilt);
        (6..9).for_each(|i| self.p[(i, i)] += way.walk * way.walk * frame.seconds);
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
        let is_odd = |nu: f64, s: f64| nu * nu > OUTLIER * (s + across * across);
        let mut v = None;
        if let Some(up) = frame.up.filter(|_| way.heeds_vertical) {
            let mut gv = Numbers::zeros();
            let sine = up.dot(&seen.direction);
            let mu = lin[9].clamp(-0.995, 0.995);
            let level = (up - seen.direction * sine).try_normalize(1e-6).unwrap_or_else(Vector3::zeros)
                * (1.0 - mu * mu).sqrt();
            let across = level / seen.radius;
            let up = seen.direction * mu + level;
            gv.fixed_rows_mut::<10>(0).copy_from(&gradient(lin, &across, &seen.offset, 1.0));
            (gv[TILTED], gv[TILT]) = (-1.0, -1.0);
            let turned = seen.direction - up * mu;
            (0..3).for_each(|i| gv[BIAS + i] = -turned[i]);
            v = Some((sine - lin[9], gv));
        }
        if is_odd(nu, s) {
            self.odd += 1;
            if self.odd < 2 {
                self.log += (tuning.spikes * 0.5).ln();
                if v.is_some() {
                    self.log += 0.5_f64.ln();
                }
                return true;
            }
            // another place
            let variance = tuning.place * tuning.place;
            reset(self, LEVEL, variance);
            reset(self, TILTED, variance);
            self.log += (tuning.places_per_h / 3600.0 * 0.2).ln();
            self.place_ns = Some(frame.time_ns);
            (nu, s, pg) = innovation(self, lin, e, &g, frame.white);
        }
        self.odd = 0;
        update(self, nu, s, &pg);
        if way.walk > 0.0 {
            self.spread.walk(way.walk * way.walk * frame.seconds);
            self.spread.add(&frame.u, &seen.direction, frame.white, frame.uneven.variance, s);
            if let Some(up) = frame.up.filter(|_| way.heeds_vertical) {
                self.spread.tilt(&up, frame.tilt.variance);
            }
        }
        if let Some((e, g)) = v {
            let (nu, s, pg) = innovation(self, lin, e, &g, frame.tilt_white);
            if nu * nu > OUTLIER * (s + across) {
                self.log += 0.05_f64.ln();
            } else {
                update(self, nu, s, &pg);
            }
        }
        true
    }

    /// What is known, without what only noise tells.
    pub fn honest(&self) -> Gaussian {
        let mut known = known(self);
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

impl Filter {
    pub fn new(kind: Kind, base: State, lin: Tau, first: u64, onset_ns: i64) -> Self {
        let now = base.clone();
        let mut filter = Self {
            kind,
            id: 0,
            parent: 0,
            size: 0,
            moves: false,
            heeds_vertical: true,
            takes_time: false,
            onset_ns,
            begun: first,
            base,
            first,
            lin,
            now,
            age: 0.0,
            former: None,
            error: f64::MAX,
            scale_sd: None,
            stuck: false,
            gain: 0.0,
            seen: Vector3::zeros(),
            frames: 0.0,
            fixed: State {
                x: Numbers::zeros(),
                p: Covariance::zeros(),
                spread: Spread::default(),
                odd: 0,
                log: 0.0,
                place_ns: None,
            },
        };
        filter.fixed = filter.fixed_at(&lin);
        filter.error = filter.known().error();
        filter
    }

    /// The same from this frame on, but b moves, or rests.
    pub fn fork(&self, moves: bool, number: u64) -> Self {
        let mut base = self.now.clone();
        base.log -= 7.0;
        let lin = self.known().mean;
        let begun = Self::new(self.kind, base, lin, number, self.onset_ns);
        Self {
            moves,
            base: begun.base,
            now: begun.now,
            fixed: begun.fixed,
            first: number,
            lin,
            scale_sd: None,
            ..self.clone()
        }
    }

    /// Log of the joint probability; at `lin` where the mean lies where the frames do not follow.
    pub fn log_joint(&self) -> f64 {
        self.now.log - self.gain
    }

    pub fn known(&self) -> Gaussian {
        known(&self.now)
    }

    fn way(&self, tuning: &Tuning, unit_ut: f64) -> Way {
        let after = |seconds: f64| self.onset_ns.saturating_add((seconds * 1e9) as i64);
        Way {
            walk: if self.moves { tuning.moving_ut } else { tuning.walk_ut } / unit_ut,
            rough_until_ns: if self.kind == Kind::Place { after(tuning.change_s) } else { i64::MIN },
            heeds_vertical: self.heeds_vertical,
            done_ns: if self.takes_time { after(tuning.ramp_s) } else { i64::MIN },
        }
    }

    fn kill(&mut self) {
        self.now.log = f64::NEG_INFINITY;
    }

    /// The latest frame.
    pub fn add(&mut self, frame: &Frame, tuning: &Tuning, unit_ut: f64) {
        self.age += frame.count;
        self.stuck = false;
        if let Some(seen) = see(&self.lin, &frame.u) {
            self.seen += seen.direction;
            self.frames += 1.0;
        }
        let way = self.way(tuning, unit_ut);
        if !self.now.step(&self.lin, frame, way, tuning) || !self.fixed.step(&self.lin, frame, way.still(), tuning) {
            self.kill();
        }
    }

    fn off(&self) -> Tau {
        let mut off: Tau = self.now.x.fixed_rows::<10>(0) - self.lin;
        off[9] = 0.0;
        off
    }

    pub fn wants_run(&self) -> bool {
        self.log_joint().is_finite() && !self.stuck && self.off().norm() > MOVED
    }

    /// What is known at the beginning, linear about `lin`.
    pub fn start(&self) -> State {
        let mut state = self.base.clone();
        if let Some(sd) = self.scale_sd {
            let scale = (self.lin[0] + self.lin[1] + self.lin[2]) / 3.0;
            let mut g = Numbers::zeros();
            (0..3).for_each(|i| g[i] = 1.0 / (3.0 * scale));
            let (nu, s, pg) = innovation(&state, &self.lin, scale.ln(), &g, sd * sd);
            update(&mut state, nu, s, &pg);
            state.begin_spread();
        }
        state
    }

    /// Begins to be linear about a point.
    pub fn restart(&mut self) {
        self.now = self.start();
    }

    /// Log probability of a point before the frames of the window, up to a constant.
    pub fn log_prior(&self, tau: &Tau) -> f64 {
        let p: TauMatrix = self.base.p.fixed_view::<10, 10>(0, 0).into();
        let d: Tau = tau - self.base.x.fixed_rows::<10>(0);
        let Some(factors) = Ldl::new(&p) else { return f64::NEG_INFINITY };
        let mut log = -0.5 * d.dot(&factors.solve(&d));
        if let Some(sd) = self.scale_sd {
            let scale = (tau[0] + tau[1] + tau[2]) / 3.0;
            log -= 0.5 * (scale.ln() / sd).powi(2);
        }
        log
    }

    /// A state that takes a point for the truth.
    fn fixed_at(&self, tau: &Tau) -> State {
        let mut state = self.base.clone();
        for i in 0..10 {
            reset(&mut state, i, 0.0);
            state.x[i] = tau[i];
        }
        state.log = 0.0;
        state
    }

    /// Runs again from its beginning about where it has come to, as far as that explains the frames better. Returns the frames.
    pub fn run(&mut self, frames: &Frames, tuning: &Tuning, unit_ut: f64) -> u64 {
        let full: Tau = self.now.x.fixed_rows::<10>(0).into();
        let own = self.log_prior(&self.lin) + self.fixed.log;
        let mut part = (0.5 / self.off().norm()).min(1.0);
        let mut cost = 0;
        let length = frames.next - self.first;
        let way = self.way(tuning, unit_ut);
        for _ in 0..4 {
            let lin = self.lin + (full - self.lin) * part;
            if is_bounded(&lin) {
                let mut fixed = self.fixed_at(&lin);
                cost += length;
                let fits =
                    (self.first..frames.next).all(|number| fixed.step(&lin, frames.at(number), way.still(), tuning));
                if fits && self.log_prior(&lin) + fixed.log > own - 0.1 {
                    self.lin = lin;
                    self.fixed = fixed;
                    self.now = self.start();
                    for number in self.first..frames.next {
                        if !self.now.step(&self.lin, frames.at(number), way, tuning) {
                            self.kill();
                            break;
                        }
                    }
                    return cost + length;
                }
            }
            part *= 0.35;
        }
        self.stuck = true;
        cost
    }

    pub fn judge(&mut self, unit_ut: f64) {
        let known = self.known();
        self.error = known.error();
        let off = self.off();
        self.gain = 0.0;
        if off.norm() > 2.0 * MOVED {
            self.gain = Ldl::new(&known.covariance).map_or(0.0, |factors| 0.5 * off.dot(&factors.solve(&off)));
        }
        let beyond = beyond_earth(&known.mean, unit_ut);
        self.gain += 0.5 * (beyond / 0.05).powi(2);
    }

    /// The oldest frames become part of the beginning.
    pub fn forget(&mut self, until: u64, frames: &Frames, tuning: &Tuning, unit_ut: f64) {
        let way = self.way(tuning, unit_ut);
        self.base = self.start();
        self.scale_sd = None;
        while self.first < until {
            if !self.base.step(&self.lin, frames.at(self.first), way, tuning) {
                self.kill();
            }
            self.first += 1;
        }
        // what the point says of the frames that are left
        self.fixed = self.fixed_at(&self.lin);
        for number in self.first..frames.next {
            self.fixed.step(&self.lin, frames.at(number), way.still(), tuning);
        }
    }

    /// Whether another that is less likely says the same: twins in one place, and changes of nearly the same time, whose onsets are kept on a grid
    /// that doubles with their age.
    pub fn makes_needless(&self, other: &Self, latest: u64) -> bool {
        let is_twin = || (self.known().mean - other.known().mean).norm() < SAME_PLACE;
        if (self.moves, self.heeds_vertical) != (other.moves, other.heeds_vertical) {
            return false;
        }
        if self.id == other.id {
            return is_twin();
        }
        let age = |it: &Self| (latest - it.begun) as f64;
        let says = |it: &Self| (it.kind, it.size, it.parent);
        says(self) == says(other)
            && other.kind != Kind::Cold
            && age(self).max(age(other)) < 2.0 * age(self).min(age(other))
    }

    /// Mean square by which the directions turned since it began, rad^2.
    pub fn turned(&self) -> f64 {
        1.0 - self.seen.norm_squared() / (self.frames * self.frames).max(1.0)
    }

    /// Whether the device turned enough since it began to show what it says.
    pub fn is_shown(&self, tuning: &Tuning) -> bool {
        self.kind == Kind::Place || self.turned() > tuning.shown_rad2
    }

    pub fn length(&self, frames: &Frames) -> u64 {
        frames.next - self.first
    }

    /// The same frames about another point.
    pub fn about(&self, lin: Tau, frames: &Frames, tuning: &Tuning, unit_ut: f64) -> Self {
        let mut other = self.clone();
        other.lin = lin;
        other.again(frames, tuning, unit_ut);
        other
    }

    /// The frames again, about the same point.
    pub fn again(&mut self, frames: &Frames, tuning: &Tuning, unit_ut: f64) {
        self.now = self.start();
        self.fixed = self.fixed_at(&self.lin);
        let way = self.way(tuning, unit_ut);
        for number in self.first..frames.next {
            let frame = frames.at(number);
            if !self.now.step(&self.lin, frame, way, tuning) || !self.fixed.step(&self.lin, frame, way.still(), tuning)
            {
                self.kill();
            }
        }
        self.judge(unit_ut);
    }
}
