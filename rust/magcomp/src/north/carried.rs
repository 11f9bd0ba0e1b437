//! A direction of north that the gyroscope carries.

#[cfg(test)]
mod tests;

use crate::estimator::answer::{Answer, Carry};
use crate::level::Level;
use crate::math::elementary::{atan2, cos, gain, sin, sin_cos};
use crate::priors::{BEYOND_CHANCE, ROOM_S, SETTLED_S};
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::{Matrix3, Vector3};

/// Headings within this time have the same error, s: a course that multipath bends, a step to the side (rust/magcomp-lab/tests/north.rs).
pub(super) const REPEAT_S: f64 = 2.0 * SETTLED_S;
/// For so long another north must be told before it is believed instead of the magnetometer's, s, and twice as long instead of headings that have agreed for
/// as long: twice as long as one walks backwards.
pub(super) const OWN_SUPPORT_S: f64 = 2.0 * ROOM_S;
/// Choice: an axis whose horizontal part is less has no heading: 60 deg of elevation, as the judge of the recordings has it.
const LEAST_HORIZONTAL: f64 = 0.5;

impl Level {
    /// Clockwise from north, rad; `None` for an axis that is nearly vertical, whose heading no source tells.
    pub(super) fn told_bearing(&self, axis: &Vector3<f64>) -> Option<f64> {
        self.bearing(axis, LEAST_HORIZONTAL)
    }

    /// Its columns.
    pub(super) fn frame(&self) -> Matrix3<f64> {
        Matrix3::from_columns(&[self.east, self.north, self.up])
    }

    /// Turned clockwise about up.
    fn turned(&self, by_rad: f64) -> Self {
        let (sin, cos) = sin_cos(by_rad);
        let north = self.north * cos + self.east * sin;
        Self { east: north.cross(&self.up), north, ..*self }
    }
}

/// A heading from outside as it is used.
pub(super) struct Told {
    /// What points there, device frame now.
    pub axis: Vector3<f64>,
    /// From magnetic north, rad; and where the magnetometer has it.
    pub bearing_rad: f64,
    pub own_bearing_rad: f64,
    /// Variance as it was told, and that of the mounting or the declination it was read with, rad^2.
    pub own_rad2: f64,
    pub common_rad2: f64,
    /// Seconds since the one before, as far as its error may be another.
    pub new_s: f64,
    pub is_vehicle: bool,
}

/// What the magnetometer says of north at a sample, if anything.
pub(super) struct Own {
    pub level: Level,
    pub variance_rad2: f64,
}

impl Own {
    /// A field that dips deep turns with an `up` that leans.
    pub fn of(answer: &Answer, tilt_rad2: f64) -> Option<Self> {
        let field_ut = answer.filtered_field_ut?;
        let level = Level::of(&field_ut, &answer.up?)?;
        let variance_rad2 = level.variance_rad2(&answer.filtered_covariance_ut2?, tilt_rad2, answer.common_rad2);
        Some(Self { level, variance_rad2 })
    }

    /// Nothing of north: of the level directions any is called so.
    pub fn unknown(up: Vector3<f64>) -> Option<Self> {
        let level = Level::of(&Vector3::ith(up.iamin(), 1.0), &up)?;
        Some(Self { level, variance_rad2: f64::INFINITY })
    }

    /// Whether it says anything.
    pub fn is_known(&self) -> bool {
        self.variance_rad2.is_finite()
    }
}

/// North, and how well it is known.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Carried {
    level: Level,
    /// s^2 but for what all headings have in common, rad^2.
    own_rad2: f64,
    /// What is left of the gyroscope's bias about the vertical, as headings have shown it, rad/s; its variance, and its covariance with north's.
    drift_rad_s: f64,
    drift_rad2_s2: f64,
    shared_rad2_s: f64,
    is_bias_told: bool,
    /// Variance of the mounting or the declination that the headings were read with, rad^2.
    common_rad2: f64,
    /// Seconds of headings that speak for it.
    pub support_s: f64,
    /// It is published.
    pub leads: bool,
}

impl Carried {
    /// What the magnetometer says.
    pub fn of(own: &Own) -> Self {
        Self::new(own.level, own.variance_rad2, 0.0, OWN_SUPPORT_S)
    }

    /// What a heading says alone.
    pub fn told(own: &Level, told: &Told) -> Self {
        Self::new(own.turned(told.own_bearing_rad - told.bearing_rad), told.own_rad2, told.common_rad2, told.new_s)
    }

    fn new(level: Level, own_rad2: f64, common_rad2: f64, support_s: f64) -> Self {
        Self {
            level,
            own_rad2,
            drift_rad_s: 0.0,
            // until the first turn says how large it may be
            drift_rad2_s2: f64::INFINITY,
            shared_rad2_s: 0.0,
            is_bias_told: false,
            common_rad2,
            support_s,
            leads: false,
        }
    }

    /// East, north and up for an `up` that has become another a little.
    pub fn level(&self, up: &Vector3<f64>) -> Level {
        Level::of(&self.level.north, up).unwrap_or(self.level)
    }

    /// s^2, rad^2.
    pub fn variance_rad2(&self) -> f64 {
        self.own_rad2 + self.common_rad2
    }

    /// The device turned.
    pub fn step(&mut self, carry: &Carry, up: Option<&Vector3<f64>>) {
        let north = carry.turn * self.level.north;
        let up = up.copied().unwrap_or(carry.turn * self.level.up);
        if carry.is_bias_told != self.is_bias_told {
            (self.is_bias_told, self.drift_rad2_s2) = (carry.is_bias_told, f64::INFINITY);
        }
        let Carry { bias_rad2_s2, span_s, .. } = *carry;
        if self.drift_rad2_s2 > bias_rad2_s2 {
            // the turn has it off
            let left = bias_rad2_s2 / self.drift_rad2_s2;
            (self.drift_rad_s, self.shared_rad2_s) = (self.drift_rad_s * left, self.shared_rad2_s * left);
            self.drift_rad2_s2 = bias_rad2_s2;
        }
        if let Some(level) = Level::of(&north, &up) {
            self.level = level.turned(-self.drift_rad_s * span_s);
        }
        self.own_rad2 += span_s * (2.0 * self.shared_rad2_s + self.drift_rad2_s2 * span_s) + carry.noise_rad2;
        self.shared_rad2_s += self.drift_rad2_s2 * span_s;
        // it wanders, and turns with the device
        self.drift_rad2_s2 += (bias_rad2_s2 - self.drift_rad2_s2) * gain(span_s, OWN_SUPPORT_S);
    }

    /// Whether a heading that is off by so much, with this variance, may be right.
    pub fn agrees(&self, off_rad: f64, told_rad2: f64) -> bool {
        off_rad * off_rad < BEYOND_CHANCE.powi(2) * (self.variance_rad2() + told_rad2)
    }

    /// A heading that is off by so much. What its offset is off by repeats in each, so it is not averaged.
    pub fn correct(&mut self, off_rad: f64, told: &Told, up: &Vector3<f64>) {
        if told.common_rad2 == 0.0 {
            self.own_rad2 += self.common_rad2;
        }
        // one that repeats the error of the last counts for little, but north is as well known as it says
        let repeated_rad2 = told.own_rad2 * REPEAT_S / told.new_s;
        let beyond_rad2 = self.own_rad2 - told.own_rad2;
        let as_told_rad2 = if beyond_rad2 > 0.0 { self.own_rad2 * told.own_rad2 / beyond_rad2 } else { f64::INFINITY };
        let expected_rad2 = self.own_rad2 + repeated_rad2.min(as_told_rad2);
        let gain = self.own_rad2 / expected_rad2;
        // the axis' heading grows as north turns back
        self.level = self.level(up).turned(-gain * off_rad);
        self.drift_rad_s += self.shared_rad2_s / expected_rad2 * off_rad;
        self.drift_rad2_s2 -= self.shared_rad2_s.powi(2) / expected_rad2;
        self.own_rad2 *= 1.0 - gain;
        self.shared_rad2_s *= 1.0 - gain;
        self.common_rad2 = told.common_rad2;
        self.support_s += told.new_s;
    }

    /// A heading of so many seconds spoke for another one: whether none is left that speaks for this.
    pub fn loses(&mut self, seconds: f64) -> bool {
        self.support_s -= seconds;
        self.support_s <= 0.0
    }

    /// Whether the magnetometer knows north as well, and does not exclude this; if not, it leads.
    pub fn is_no_better_than(&mut self, own: &Own) -> bool {
        let Some(off_rad) = own.level.told_bearing(&self.level.north) else { return false };
        self.leads = self.variance_rad2() < own.variance_rad2 || !self.agrees(off_rad, own.variance_rad2);
        !self.leads
    }

    /// North as it is published, and its variance, rad^2. How much of the magnetometer's error is in both is not known, and taken to be all: the mean by
    /// their variances is as sure as the mean of their standard deviations.
    pub fn published(&self, own: &Own) -> (Level, f64) {
        let carried = self.level(&own.level.up);
        let (mine_rad2, own_rad2) = (self.variance_rad2(), own.variance_rad2);
        match own.level.told_bearing(&carried.north).filter(|off_rad| own.is_known() && self.agrees(*off_rad, own_rad2))
        {
            Some(off_rad) => {
                let share = mine_rad2 / (mine_rad2 + own_rad2);
                let sd_rad = mine_rad2.sqrt() * (1.0 - share) + own_rad2.sqrt() * share;
                (carried.turned(-share * off_rad), sd_rad * sd_rad)
            }
            None => (carried, mine_rad2),
        }
    }

    /// Goes on from what the magnetometer says.
    pub fn begin_at(&mut self, own: &Own) {
        let (level, own_rad2) = (own.level, own.variance_rad2);
        *self = Self { level, own_rad2, shared_rad2_s: 0.0, common_rad2: 0.0, leads: false, ..*self };
    }
}

/// An angle in [-pi, pi].
pub(super) fn wrap(rad: f64) -> f64 {
    atan2(sin(rad), cos(rad))
}
