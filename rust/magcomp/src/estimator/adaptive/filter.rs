//! A hypothesis is a Kalman filter (`state`) over the frames since its beginning, linear about one point `lin`. Where the mean has moved from
//! it, the filter runs again from its beginning about the new point (iterated filter = Gauss-Newton); all stored frames are always linear
//! about the same point.

#[cfg(test)]
mod tests;

use super::frame::{Frame, Frames};
use super::parameters::{BESIDE, Gaussian, Numbers, Tau, beyond_earth, centre, is_bounded, see};
use super::rate::Rate;
use super::state::{State, Way};
use super::tuning::Tuning;
use crate::math::elementary::ln;
use crate::math::ldl::Ldl;
use crate::noise::Process;
use crate::priors::{IRON_PER_UT, SETTLED_S};
use crate::sample::seconds;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::Vector3;

/// Choice: calibrations nearer than this (units, and relative for T) are in one place. A mean that is further from `lin` wants another run.
const NEAR: f64 = 0.04;

/// Choice: what counts as known, degrees.
const KNOWN_DEG: f64 = 0.8;

/// What a hypothesis says has changed at its onset.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub(super) enum Kind {
    #[default]
    Cold,
    Device,
    Place,
    Former,
}

/// How large a change is, before it is seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub(super) enum Size {
    /// So small that it is just told.
    #[default]
    Least,
    /// A cover; another room.
    Usual,
    /// A magnet.
    Magnet,
}

/// What b does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub(super) enum HardIron {
    #[default]
    Rests,
    /// A battery charges.
    Drifts,
    /// A magnet is pushed on.
    Slides,
}

impl HardIron {
    /// How fast b moves, where it does: units a second.
    pub fn rates(self, tuning: &Tuning, unit_ut: f64) -> Option<Process> {
        let rate_ut_s = match self {
            Self::Rests => return None,
            Self::Drifts => tuning.drift_ut_s,
            Self::Slides => tuning.slide_ut_s,
        };
        Some(Process { size: rate_ut_s / unit_ut, lasts_s: SETTLED_S })
    }
}

/// A large change of the device, before it is done: b changes by what the field does meanwhile, but for what the device turns.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Leap {
    /// Along which axis noise told of b before it, and the least variance there: with `former` what was known.
    pub noise: Option<(Vector3<f64>, f64)>,
    /// The last frame before it: where, units, and when.
    pub from: Vector3<f64>,
    pub from_ns: i64,
    /// How fast the field turns, units a second.
    pub turning: f64,
    /// Standard deviation of the change before it is seen, units.
    pub step: f64,
}

#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Filter {
    pub kind: Kind,
    pub id: u32,
    pub parent: u32,
    pub size: Size,
    pub hard_iron: HardIron,
    /// The change takes a while.
    pub takes_time: bool,
    pub onset_ns: i64,
    pub begun: u64,
    base: State,
    pub first: u64,
    pub lin: Tau,
    pub now: State,
    pub age: f64,
    pub former: Option<Gaussian>,
    /// Until the first frame after a large change.
    pub leap: Option<Leap>,
    /// Expected direction error when it was last asked for, rad^2.
    pub error: f64,
    /// The strength of the field before anything is known, as a standard deviation of its logarithm about the unit.
    pub scale_sd: Option<f64>,
    stuck: bool,
    /// Sum of the directions since it began, and of how many frames.
    seen: Vector3<f64>,
    frames: f64,
    /// The state that takes `lin` for the truth.
    pub fixed: State<BESIDE>,
    /// What its probability loses where the mean has left the point that its frames are linear about, and for a field that the Earth's is not.
    pub penalty: f64,
}

impl Filter {
    pub fn new(kind: Kind, mut base: State, lin: Tau, first: u64, onset_ns: i64) -> Self {
        base.rate = Rate::default();
        let (now, fixed) = (base.clone(), base.fixed());
        let begun = first;
        Self { kind, onset_ns, begun, base, first, lin, now, error: f64::MAX, fixed, ..Self::default() }
    }

    /// The same from this frame on, but b moves so.
    pub fn fork(&self, hard_iron: HardIron, number: u64, log: f64, tuning: &Tuning, unit_ut: f64) -> Self {
        let mut base = self.now.clone();
        (base.log, base.rate) = (log, hard_iron.rates(tuning, unit_ut).map_or_else(Rate::default, Rate::new));
        Self {
            hard_iron,
            now: base.clone(),
            fixed: base.fixed(),
            base,
            first: number,
            lin: self.now.tau(),
            scale_sd: None,
            ..self.clone()
        }
    }

    /// By how much b has moved while a magnet slides on, units.
    pub fn slid(&self) -> Vector3<f64> {
        let before = self.former.filter(|_| self.hard_iron == HardIron::Slides);
        before.map_or_else(Vector3::zeros, |before| centre(&self.now.tau()) - centre(&before.mean))
    }

    /// Log of the joint probability of its onset and all frames.
    pub fn log_joint(&self) -> f64 {
        self.now.log - self.penalty
    }

    fn way(&self, tuning: &Tuning, unit_ut: f64) -> Way {
        let after = |seconds: f64| self.onset_ns.saturating_add((seconds * 1e9) as i64);
        Way {
            walk: tuning.walk_ut / unit_ut,
            rates: self.hard_iron.rates(tuning, unit_ut),
            rough_until_ns: if self.kind == Kind::Place { after(tuning.change_s) } else { i64::MIN },
            done_ns: if self.takes_time { after(tuning.ramp_s) } else { i64::MIN },
        }
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
        if frame.time_ns >= way.done_ns
            && let Some(leap) = self.leap.take()
        {
            self.leap_to(frame, &leap, unit_ut);
        }
        self.now.step(&self.lin, frame, way, tuning);
        if self.hard_iron == HardIron::Rests {
            self.fixed.step(&self.lin, frame, way, tuning);
        }
    }

    /// Whether a frame is none that it expects.
    pub fn is_surprised(&self, frame: &Frame, tuning: &Tuning, unit_ut: f64) -> bool {
        let mut tried = self.now.clone();
        tried.step(&self.lin, frame, self.way(tuning, unit_ut), tuning);
        self.leap.is_none() && tried.log.is_finite() && (tried.odd > 0 || tried.place_ns == Some(frame.time_ns))
    }

    /// The first frame after a large change tells b: the direction of the field is that from before, but for a turn.
    fn leap_to(&mut self, frame: &Frame, leap: &Leap, unit_ut: f64) {
        let by = frame.u - leap.from;
        let seconds = seconds(leap.from_ns, frame.time_ns);
        let iron = IRON_PER_UT * unit_ut * by.norm().min(leap.step);
        let variance = (leap.turning * seconds).powi(2) + iron * iron + 2.0 * frame.white;
        if variance >= leap.step * leap.step {
            return;
        }
        let Some(mut known) = self.former.map(|former| former.without(leap.noise)) else { return };
        (0..3).for_each(|i| known.mean[6 + i] += by[i]);
        // how probable such a change is, in three numbers; another place may turn the field by about as much as the device turns
        let log = self.base.log + 1.5 * ln(variance / (leap.step * leap.step));
        self.base = self.base.with(&known);
        let scale = (known.mean[0] + known.mean[1] + known.mean[2]) / 3.0;
        self.base.widen(variance.sqrt(), iron * scale);
        self.base.log = log;
        self.base.begin_spread();
        self.lin = known.mean;
        (self.now, self.fixed) = (self.base.clone(), self.base.fixed());
    }

    fn off(&self) -> Tau {
        let mut off = self.now.tau() - self.lin;
        off[9] = 0.0;
        off
    }

    pub fn wants_run(&self) -> bool {
        self.log_joint().is_finite() && !self.stuck && self.off().norm() > NEAR
    }

    /// What is known at the beginning, linear about `lin`.
    pub fn start(&self) -> State {
        let mut state = self.base.clone();
        if let Some(sd) = self.scale_sd {
            let scale = (self.lin[0] + self.lin[1] + self.lin[2]) / 3.0;
            let mut g = Numbers::zeros();
            (0..3).for_each(|i| g[i] = 1.0 / (3.0 * scale));
            let (nu, s, pg) = state.innovation(&self.lin, ln(scale), &g, sd * sd);
            state.update(nu, s, &pg);
            state.begin_spread();
        }
        state
    }

    /// Log probability of a point before the frames of the window, up to a constant.
    pub fn log_prior(&self, tau: &Tau) -> f64 {
        let before = self.base.known();
        let d = tau - before.mean;
        let Some(factors) = Ldl::new(&before.covariance) else { return f64::NEG_INFINITY };
        let mut log = -0.5 * d.dot(&factors.solve(&d));
        if let Some(sd) = self.scale_sd {
            let scale = (tau[0] + tau[1] + tau[2]) / 3.0;
            log -= 0.5 * (ln(scale) / sd).powi(2);
        }
        log
    }

    /// Runs again from its beginning about where it has come to, as far as that explains the frames better. Returns the frames.
    pub fn run(&mut self, frames: &Frames, tuning: &Tuning, unit_ut: f64) -> u64 {
        // no one point belongs to all frames of a b that moves: it goes on about where it is now
        if self.hard_iron != HardIron::Rests {
            self.base = self.now.clone();
            (self.first, self.lin) = (frames.next, self.now.tau());
            return 1;
        }
        let full = self.now.tau();
        let own = self.log_prior(&self.lin) + self.fixed.log;
        let mut part = (0.5 / self.off().norm()).min(1.0);
        let mut cost = 0;
        let length = frames.next - self.first;
        let way = self.way(tuning, unit_ut);
        for _ in 0..4 {
            let lin = self.lin + (full - self.lin) * part;
            if is_bounded(&lin) {
                let mut fixed = self.base.fixed();
                cost += length;
                fixed.follow(&lin, frames, self.first..frames.next, way, tuning);
                if self.log_prior(&lin) + fixed.log > own {
                    (self.lin, self.fixed) = (lin, fixed);
                    self.now = self.start();
                    self.now.follow(&lin, frames, self.first..frames.next, way, tuning);
                    return cost + length;
                }
            }
            part *= 0.5;
        }
        self.stuck = true;
        cost
    }

    /// Works out the expected direction error.
    pub fn estimate_error(&mut self) {
        self.error = self.now.known().error();
    }

    pub fn penalize(&mut self, tuning: &Tuning, unit_ut: f64) {
        let off = self.off();
        self.penalty = 0.0;
        if off.norm() > 2.0 * NEAR {
            self.penalty =
                Ldl::new(&self.now.known().covariance).map_or(0.0, |factors| 0.5 * off.dot(&factors.solve(&off)));
        }
        let beyond = beyond_earth(&self.now.tau(), unit_ut);
        self.penalty += 0.5 * (beyond / tuning.soft_iron).powi(2);
    }

    /// The oldest frames become part of the beginning.
    pub fn forget(&mut self, until: u64, frames: &Frames, tuning: &Tuning, unit_ut: f64) {
        let way = self.way(tuning, unit_ut);
        self.base = self.start();
        self.scale_sd = None;
        self.base.follow(&self.lin, frames, self.first..until, way, tuning);
        self.first = until;
        // what the point says of the frames that are left
        self.fixed = self.base.fixed();
        self.fixed.follow(&self.lin, frames, until..frames.next, way, tuning);
    }

    /// Whether a less likely hypothesis says what this one says: twins in one place, and changes of nearly the same time, whose onsets are kept on a
    /// grid that doubles with their age.
    pub fn makes_needless(&self, other: &Self, latest: u64) -> bool {
        let is_twin = || (self.now.tau() - other.now.tau()).norm() < NEAR;
        let means = |it: &Self| (it.hard_iron, it.leap.is_some());
        if means(self) != means(other) {
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

    /// Whether directions are known so well that nothing is open.
    pub fn is_known(&self) -> bool {
        self.error < KNOWN_DEG.to_radians().powi(2)
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

    /// The frames again, about `lin`.
    pub fn again(&mut self, frames: &Frames, tuning: &Tuning, unit_ut: f64) {
        (self.now, self.fixed) = (self.start(), self.base.fixed());
        let way = self.way(tuning, unit_ut);
        self.now.follow(&self.lin, frames, self.first..frames.next, way, tuning);
        self.fixed.follow(&self.lin, frames, self.first..frames.next, way, tuning);
        self.penalize(tuning, unit_ut);
        self.estimate_error();
    }
}
