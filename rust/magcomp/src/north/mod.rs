//! Headings from outside: a GNSS course, ARKit's or ARCore's yaw, a landmark. North is carried by the gyroscope from one to the next, and leads
//! where it is known better than by the magnetometer.
//!
//! ```text
//! n <- R n turned by -d dt,   P <- F P F' + diag(q^2, 0)           between samples: R the turn, d what is left of the gyroscope's bias about up, P of (n, d)
//! r = heading - angle(n, axis),   v = sigma^2 T / dt               a heading; those of less than T = 10 s repeat one another's
//!                                                                  errors; v is less where s would stay above sigma
//! (n, d) corrected by K r,   K = P_n / (s^2 + v),   s^2 = P_nn     where r^2 < 9 (s^2 + sigma^2); else it speaks for a rival of n
//! f <- f turned about up by w (n - f),   w = s_f^2 / (s^2 + s_f^2),   its sigma w s + (1 - w) s_f        while s < s_f, its own sigma
//! ```
//! Where n and f exclude each other, f is turned all the way. Where n is known no better than f, it begins anew at f.
//! A rival takes over once more seconds of headings speak for it than for n. The estimators do not know of any of this. One file each: `history` (the
//! turns of the last seconds, for headings that come late), `carried` (n and s), `offset` (a mounting, a declination). Source: docs/dev/METHOD.md.

mod carried;
mod history;
mod offset;
#[cfg(test)]
mod tests;

use crate::estimator::answer::{Answer, Carry, KnownNorth};
use crate::explanation::OutsideTest;
use crate::level::Level;
use crate::reading::HeadingAid;
use crate::sample::{HeadedAxis, HeadingSample, NorthReference, seconds};
use crate::sensing::pairing::{EventRejection, MAX_LEAD_S};
use arrayvec::ArrayVec;
use carried::{Carried, OWN_SUPPORT_S, Own, REPEAT_S, Told, wrap};
use core::f64::consts::PI;
use history::{History, LATEST_S};
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::{Matrix3, Vector3};
use offset::Offset;

/// Choice: headings that wait for the magnetometer sample after them: a second of a camera's yaw at 30 Hz is more than any system holds back.
const WAITING: usize = 32;
/// Choice: size of a declination before anything is known, deg: where people live it is less than 20 nearly everywhere.
const DECLINATION_DEG: f64 = 15.0;

/// North as headings from outside tell it.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct North {
    waiting: ArrayVec<HeadingSample, WAITING>,
    history: History,
    carried: Option<Carried>,
    rival: Option<Carried>,
    mounting: Option<Offset>,
    declination: Option<Offset>,
    heard: Option<Heard>,
}

/// The latest heading that was used or ignored.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
struct Heard {
    time_ns: i64,
    was: HeadingAid,
    off_rad: f64,
    /// What `off_rad` was judged by, rad^2.
    expected_rad2: f64,
}

impl North {
    /// Takes a heading; one that is refused changes nothing.
    pub fn push(&mut self, heading: HeadingSample, latest_ns: Option<i64>) -> Result<(), EventRejection> {
        let HeadingSample { time_ns, heading_deg, sigma_deg, axis, .. } = heading;
        let axis = if let HeadedAxis::Device(axis) = axis { axis } else { Vector3::y() };
        if ![heading_deg, sigma_deg].iter().chain(&axis).all(|it| it.is_finite()) {
            return Err(EventRejection::NotFinite);
        }
        if !(sigma_deg > 0.0 && sigma_deg <= 180.0 && heading_deg.abs() <= 360.0 && axis.norm() > 0.0) {
            return Err(EventRejection::OutOfRange);
        }
        let ahead_s = latest_ns.map_or(0.0, |latest| seconds(latest, time_ns));
        if ahead_s > MAX_LEAD_S {
            return Err(EventRejection::Ahead);
        }
        let is_used = self.heard.is_some_and(|heard| time_ns <= heard.time_ns);
        if is_used || ahead_s < -LATEST_S {
            return Err(EventRejection::Late);
        }
        let place = self.waiting.partition_point(|other| other.time_ns < time_ns);
        if self.waiting.get(place).is_some_and(|other| other.time_ns == time_ns) {
            return Err(EventRejection::Duplicate);
        }
        if self.waiting.is_full() && place == 0 {
            return Err(EventRejection::Late);
        }
        let oldest = self.waiting.is_full().then(|| self.waiting.remove(0));
        self.waiting.insert(place - usize::from(oldest.is_some()), heading);
        Ok(())
    }

    /// Time passed, or the clock is another: where north is is lost. What was learned of a mounting and of the declination stays.
    pub fn pause(&mut self) {
        *self = Self { mounting: self.mounting, declination: self.declination, ..Self::default() };
    }

    /// The declination that true headings have shown, degrees, and its standard deviation.
    pub fn declination_deg(&self) -> Option<(f64, f64)> {
        self.declination.map(|it| (it.angle_rad.to_degrees(), it.variance_rad2.sqrt().to_degrees()))
    }

    /// One sample: what the estimator answered, with the headings from outside.
    pub fn step(&mut self, time_ns: i64, answer: &mut Answer, declination_deg: Option<f64>) {
        let Some(carry) = &answer.carry else {
            (self.carried, self.rival, self.history) = (None, None, History::default());
            return;
        };
        self.history.turn(time_ns, &carry.turn);
        if self.carried.is_none() && self.rival.is_none() && self.waiting.is_empty() {
            return; // nobody speaks
        }
        let carry = *carry;
        let own = Own::of(answer, carry.tilt_rad2).or_else(|| Own::unknown(carry.up?));
        for it in [&mut self.carried, &mut self.rival].into_iter().flatten() {
            it.step(&carry, own.as_ref().map(|own| &own.level.up));
        }
        let Some(own) = own else { return };
        while self.waiting.first().is_some_and(|heading| heading.time_ns <= time_ns) {
            let heading = self.waiting.remove(0);
            self.hear(&heading, &own, declination_deg);
        }
        let Some(carried) = &mut self.carried else { return };
        if carried.is_no_better_than(&own) {
            carried.begin_at(&own);
        } else {
            lead(answer, &own, carried, &carry);
        }
    }

    /// What the latest headings are worth, unless it is long ago.
    pub fn aid(&self, time_ns: i64) -> Option<HeadingAid> {
        let Heard { time_ns: heard_ns, was, .. } = self.heard?;
        let is_recent = seconds(heard_ns, time_ns) < 2.0 * OWN_SUPPORT_S;
        match was {
            HeadingAid::Used if self.carried.as_ref().is_some_and(|it| it.leads) => Some(HeadingAid::Leads),
            was => is_recent.then_some(was),
        }
    }

    /// The latest heading, as long as [`Self::aid`] tells of it.
    pub fn explain(&self, time_ns: i64) -> Option<OutsideTest> {
        let (aid, heard, carried) = (self.aid(time_ns)?, self.heard?, self.carried.as_ref()?);
        Some(OutsideTest {
            aid,
            off_deg: heard.off_rad.to_degrees(),
            expected_deg: heard.expected_rad2.sqrt().to_degrees(),
            north_sigma_deg: carried.variance_rad2().sqrt().to_degrees(),
        })
    }

    /// One heading, at a sample at or after its time.
    fn hear(&mut self, heading: &HeadingSample, own: &Own, declination_deg: Option<f64>) {
        let Some(told) = self.read(heading, own, declination_deg) else { return };
        let up = own.level.up;
        if self.carried.is_none() && !own.is_known() {
            let north = Carried::told(&own.level, &told);
            let (time_ns, was, expected_rad2) = (heading.time_ns, HeadingAid::Used, north.variance_rad2());
            self.heard = Some(Heard { time_ns, was, off_rad: 0.0, expected_rad2 });
            self.carried = Some(north);
            return;
        }
        let north = self.carried.get_or_insert_with(|| Carried::of(own));
        let Some(off_rad) = told.off_rad(north, &up) else { return };
        let agrees = north.agrees(off_rad, told.angle_rad2());
        let expected_rad2 = north.variance_rad2() + told.angle_rad2();
        if agrees {
            north.correct(off_rad, &told, &up);
            north.support_s = north.support_s.min(2.0 * OWN_SUPPORT_S);
            self.rival.take_if(|rival| rival.loses(told.new_s));
        } else {
            self.doubt(&told, off_rad, own);
        }
        let was = if agrees { HeadingAid::Used } else { HeadingAid::Disagrees };
        self.heard = Some(Heard { time_ns: heading.time_ns, was, off_rad, expected_rad2 });
    }

    /// A heading as an angle from magnetic north of an axis of the device as it lies now. `None` where no turn is known from its time to now, or
    /// the axis is nearly vertical.
    fn read(&mut self, heading: &HeadingSample, own: &Own, declination_deg: Option<f64>) -> Option<Told> {
        let axis = match heading.axis {
            HeadedAxis::Device(axis) => axis,
            HeadedAxis::Vehicle => self
                .mounting
                .map(|mounting| mounting.axis)
                .filter(|axis| own.level.told_bearing(axis).is_some())
                .unwrap_or_else(|| Vector3::ith(own.level.up.iamin(), 1.0)),
        };
        let now = self.history.brought(&axis, heading.time_ns)?;
        let own_bearing = own.level.told_bearing(&now)?;
        let since_s = self.heard.map_or(f64::INFINITY, |it| seconds(it.time_ns, heading.time_ns));
        let mut told = Told {
            axis: now,
            bearing_rad: heading.heading_deg.to_radians(),
            own_bearing_rad: own_bearing,
            own_rad2: heading.sigma_deg.to_radians().powi(2),
            common_rad2: 0.0,
            new_s: since_s.min(REPEAT_S),
            is_vehicle: heading.axis == HeadedAxis::Vehicle,
        };
        match (told.is_vehicle, heading.reference, declination_deg) {
            (false, NorthReference::True, Some(declination_deg)) => told.bearing_rad -= declination_deg.to_radians(),
            (false, NorthReference::Magnetic, _) => {}
            (false, NorthReference::True, None) => {
                let size_rad = DECLINATION_DEG.to_radians();
                told.less(self.declination.get_or_insert_with(|| Offset::unknown(size_rad, axis)), own);
            }
            (true, ..) => {
                self.mounting.take_if(|mounting| mounting.axis != axis);
                if self.mounting.is_none() && !own.is_known() {
                    // how the device lies in the vehicle only a field can tell
                    return None;
                }
                told.less(self.mounting.get_or_insert_with(|| Offset::unknown(PI, axis)), own);
            }
        }
        Some(told)
    }

    /// A heading that contradicts what is known speaks for another north, or for a device that was moved in its holder.
    fn doubt(&mut self, told: &Told, off_rad: f64, own: &Own) {
        let (Some(north), up) = (&self.carried, own.level.up) else { return };
        let rival = self.rival.take().and_then(|mut rival| {
            let off_rad = told.off_rad(&rival, &up).filter(|off_rad| rival.agrees(*off_rad, told.angle_rad2()))?;
            rival.correct(off_rad, told, &up);
            Some(rival)
        });
        let rival = rival.unwrap_or_else(|| Carried::told(&own.level, told));
        if told.is_vehicle && rival.support_s > REPEAT_S {
            // the gyroscope has seen a turn that the vehicle did not make
            if let Some(mounting) = &mut self.mounting {
                mounting.begin_at(off_rad, told.own_bearing_rad, north.variance_rad2() + told.own_rad2);
            }
        } else if !told.is_vehicle && rival.support_s > north.support_s {
            self.carried = Some(rival);
        } else {
            self.rival = Some(rival);
        }
    }
}

impl Told {
    /// By how much its axis is clockwise of where a north has it.
    fn off_rad(&self, north: &Carried, up: &Vector3<f64>) -> Option<f64> {
        Some(wrap(self.bearing_rad - north.level(up).told_bearing(&self.axis)?))
    }

    /// Variance, rad^2.
    fn angle_rad2(&self) -> f64 {
        self.own_rad2 + self.common_rad2
    }

    /// Learns an offset from it, and takes that off.
    fn less(&mut self, offset: &mut Offset, own: &Own) {
        if own.is_known() {
            let difference_rad = self.bearing_rad - self.own_bearing_rad;
            offset.learn(difference_rad, self.own_bearing_rad, own.variance_rad2 + self.own_rad2);
        }
        self.bearing_rad -= offset.angle_rad;
        self.common_rad2 = offset.variance_rad2;
    }
}

/// The answer with its field turned about the vertical to where `north` is; without a field, with that alone.
fn lead(answer: &mut Answer, own: &Own, north: &Carried, carry: &Carry) {
    let (towards, variance_rad2) = north.published(own);
    let Level { north: direction, up, .. } = towards;
    answer.north = Some(KnownNorth { north: direction, variance_rad2, up, tilt_rad2: carry.tilt_rad2 });
    let (Some(field_ut), Some(covariance)) = (answer.filtered_field_ut, answer.filtered_covariance_ut2) else {
        return;
    };
    let (own, up) = (&own.level, own.level.up);
    let horizontal_ut = field_ut.cross(&up).norm();
    let field_ut = towards.north * horizontal_ut + up * field_ut.dot(&up);
    // what it knows across comes from the headings; the rest turns with it
    let turned = towards.frame() * own.frame().transpose();
    let rest = Matrix3::identity() - towards.east * towards.east.transpose();
    let covariance = rest * turned * covariance * turned.transpose() * rest
        + towards.east * towards.east.transpose() * (variance_rad2 * horizontal_ut * horizontal_ut);
    (answer.filtered_field_ut, answer.filtered_covariance_ut2) = (Some(field_ut), Some(covariance));
}
