//! The estimator for a magnetometer without gyroscope: a bank of Kalman filters over stored frames.
//! One file an idea: `tuning` (every choice) · `parameters` (tau and derivatives) · `grouping` (neighbours averaged) · `frame` (what is
//! stored) · `state` (what is known, and a frame's update) · `rate` (how fast b moves) · `filter` (a hypothesis) · `spread` (what only noise
//! tells) · `bank` (hypotheses against each other) · `decision` (what is told of changes) · `published` (what is in force) · `explain` (for
//! people). The noise is learned by `noise/`. The derivation is in docs/dev/METHOD-ADAPTIVE.md.

mod bank;
mod decision;
mod explain;
mod filter;
mod frame;
mod grouping;
mod parameters;
mod published;
mod rate;
mod spread;
mod state;
#[cfg(test)]
mod tests;
mod tuning;

use crate::calibration::{Calibration, Given, typical_field_ut};
use crate::estimator::answer::Answer;
use crate::explanation::SampleUse;
use crate::math::elementary::{hypot, ln};
use crate::noise::{Markov, MeanSquare, Process, Stays};
use crate::priors::{OUTLYING, RARE};
use crate::reading::{HoldReason, Missing, Status};
use crate::sample::seconds;
use crate::sensing::tilt::calm;
use bank::{Bank, LATELY};
use decision::Decision;
use filter::Kind;
use frame::{Frame, Noise};
use grouping::{Group, Grouping};
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::{SMatrix, Vector3};
use parameters::{Gaussian, NOTHING, is_bounded};
use published::Published;
pub(crate) use tuning::Tuning;

/// Choice: samples before there can be an estimate: as many as nine parameters need, and some.
const FEWEST: usize = 16;

/// Where the device stays.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
struct Stay {
    at: Vector3<f64>,
    latest_ns: i64,
    frames: usize,
    /// The means of groups that become one frame.
    pooled: Group,
}

/// The estimator. All state is plain numbers.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Adaptive {
    tuning: Tuning,
    unit_ut: f64,
    strength_ut: Option<f64>,
    given: Option<Given>,
    /// The same over tau. It is seen through it whether the device turns: what is published may move where it does not.
    given_known: Option<Gaussian>,
    bank: Bank,
    uneven: Markov,
    tilt: Markov,
    stays: Stays,
    second: MeanSquare,
    differing: MeanSquare,
    tilt_white: MeanSquare,
    /// What the frame before missed, along the field and along the vertical.
    missed: Option<(f64, Option<f64>)>,
    raw: [Vector3<f64>; 2],
    period_s: f64,
    grouping: Grouping,
    stay: Stay,
    latest_ns: Option<i64>,
    published: Option<Published>,
    worst: f64,
    decision: Decision,
    count: u64,
    /// Sum of the directions seen through what was given, and of how many groups.
    seen: Vector3<f64>,
    groups: f64,
    /// What became of the latest complete group: only told.
    usage: Option<SampleUse>,
}

impl Adaptive {
    /// Knows nothing but, perhaps, the field's strength, uT, and a calibration to begin with.
    pub fn new(tuning: Tuning, strength_ut: Option<f64>, initial: Option<Given>) -> Self {
        Self::in_memory(Bank::new(typical_field_ut(strength_ut)), tuning, strength_ut, initial)
    }

    /// As new, in the memory that is there.
    pub fn restart(&mut self, initial: Option<Given>) {
        let mut bank = core::mem::take(&mut self.bank);
        bank.clear();
        *self = Self::in_memory(bank, self.tuning, self.strength_ut, initial);
    }

    fn in_memory(bank: Bank, tuning: Tuning, strength_ut: Option<f64>, initial: Option<Given>) -> Self {
        let unit_ut = typical_field_ut(strength_ut);
        let white = (tuning.noise_ut / unit_ut).powi(2);
        let mut new = Self {
            tuning,
            unit_ut,
            strength_ut,
            given: initial,
            given_known: initial.map(|given| bank::given(&given, unit_ut, tuning.place)),
            bank,
            uneven: Markov::new(tuning.uneven_ut / unit_ut, tuning.uneven_s),
            tilt: Markov::new(tuning.tilt_rad, tuning.tilt_s),
            stays: Stays::new(white * tuning.grouped),
            second: MeanSquare::new(white),
            differing: MeanSquare::new(white * tuning.grouped),
            tilt_white: MeanSquare::new(tuning.tilt_white_rad.powi(2)),
            missed: None,
            raw: [Vector3::zeros(); 2],
            period_s: 0.0,
            grouping: Grouping::default(),
            stay: Stay { latest_ns: i64::MAX, ..Stay::default() },
            latest_ns: None,
            published: None,
            worst: 0.0,
            decision: Decision::default(),
            count: 0,
            seen: Vector3::zeros(),
            groups: 0.0,
            usage: None,
        };
        new.bank.noise = new.noise();
        new
    }

    /// A raw sample, finite, times in order, and what gravity says with it, m/s^2.
    pub fn push(&mut self, time_ns: i64, raw_ut: &Vector3<f64>, up_m_s2: Option<Vector3<f64>>) -> (Status, Answer) {
        let u = raw_ut / self.unit_ut;
        let up = up_m_s2.and_then(|up| calm(&up));
        let period_s = self.latest_ns.replace(time_ns).map(|latest| seconds(latest, time_ns));
        self.period_s = period_s.filter(|it| *it < 1.0).unwrap_or(self.period_s);
        if self.count >= 2 {
            let square = (u - self.raw[1] * 2.0 + self.raw[0]).norm_squared() / (3.0 * 6.0);
            // values that repeat for ever leave nothing, and no number so small that it is slow
            self.second.add(square.max(NOTHING * NOTHING));
        }
        self.raw = [self.raw[1], u];
        self.count += 1;
        if self.count == 1 {
            self.published = self.given_known.map(|known| Published::new(known, self.unit_ut, self.strength_ut));
        }
        let radius = self.tuning.frame_ut / self.unit_ut + OUTLYING * self.white().sqrt();
        let longest = ((self.tuning.frame_s - self.period_s).max(0.0) * 1e9) as i64;
        for group in self.grouping.push((time_ns, u, up), radius, longest).into_iter().flatten() {
            self.take(&group);
        }
        (self.status(), self.answer(&u).without_gyroscope(up_m_s2))
    }

    /// White variance of a sample, units^2.
    fn white(&self) -> f64 {
        let v = self.second.value();
        let v = if v >= (self.tuning.frame_ut / self.unit_ut).powi(2) { self.differing.value() } else { v };
        v.max((self.tuning.floor_ut / self.unit_ut).powi(2))
    }

    /// What is believed of the noise now.
    fn noise(&self) -> Noise {
        let tuning = &self.tuning;
        let (uneven, tilt) = (self.uneven.process(), self.tilt.process());
        Noise {
            white: self.white(),
            uneven: Process { size: hypot(uneven.size, tuning.floor_ut / self.unit_ut), ..uneven },
            tilt_white: self.tilt_white.value().max(tuning.tilt_white_rad.powi(2)),
            tilt: Process { size: tilt.size.max(tuning.tilt_rad), lasts_s: tilt.lasts_s.max(tuning.tilt_s) },
        }
    }

    /// A complete group of neighbours.
    fn take(&mut self, group: &Group) {
        let tuning = self.tuning;
        let (count, time_ns) = (group.count, group.began_ns);
        let Some((pooled, stay, moved_s)) = self.pool(group) else {
            self.usage = Some(SampleUse::AtRest);
            return;
        };
        let (u, up, count) = (pooled.mean(), pooled.up.try_normalize(0.5 * pooled.count), count * pooled.count);
        let before = self.bank.frames.next.checked_sub(1).map(|number| self.bank.frames.at(number).time_ns);
        let seconds = before.map_or(tuning.frame_s, |before| seconds(before, time_ns));
        let noise = self.noise();
        if self.bank.frames.next == 0 {
            self.bank.noise = noise;
        } else if self.bank.noise.differs(&noise) {
            self.bank.believe(&noise, &tuning);
        }
        let mut frame = Frame { time_ns, u, up, count, seconds, moved_s, stay, ..Frame::default() };
        frame.believe(&self.bank.noise);
        if self.bank.all.is_empty() {
            let given = self.given_known.filter(|_| self.bank.frames.next == 0);
            if let Some(known) = &given {
                self.bank.begin_given(&frame, known);
            }
            let log = if given.is_some() { ln(RARE) } else { 0.0 };
            self.bank.begin_cold(&frame, log, self.strength_ut.is_some(), &tuning);
        }
        self.learn(&frame);
        self.bank.push(frame, self.strength_ut.is_some(), &tuning);
        let is_odd = self
            .bank
            .best()
            .is_some_and(|best| best.now.odd > 0 || best.now.place_ns == Some(time_ns) || best.onset_ns == time_ns);
        self.usage = Some(if is_odd { SampleUse::Gated } else { SampleUse::Used });
        self.publish(time_ns);
        if let Some(seen) = self.given_known.as_ref().and_then(|known| parameters::see(&known.mean, &u)) {
            self.seen += seen.direction;
            self.groups += 1.0;
        }
    }

    /// A group enters the means of its stay; such a mean where it is complete, its variance, and for how long the device moved before it, s.
    fn pool(&mut self, group: &Group) -> Option<(Group, f64, f64)> {
        let (u, time_ns) = (group.mean(), group.began_ns);
        let stays = (u - self.stay.at).norm()
            < self.tuning.frame_ut / self.unit_ut + 3.0 * (self.white() * self.tuning.grouped).sqrt();
        let mut moved_s = 0.0;
        if !stays {
            moved_s = seconds(self.stay.latest_ns, time_ns).clamp(0.0, 0.5);
            self.stay = Stay { at: u, ..Stay::default() };
            self.stays.end();
        }
        self.stay.latest_ns = time_ns;
        if let Some(seen) = self.bank.best().and_then(|best| parameters::see(&best.now.tau(), &u)) {
            self.stays.add((seen.radius - 1.0) / seen.slope);
        }
        let stay = &mut self.stay;
        stay.pooled.add((time_ns, u, group.up()));
        // of twice as many groups each, but for the first two
        let length = if self.tuning.stays { stay.frames.saturating_sub(1) } else { 0 };
        if stay.pooled.count < f64::from(1u32 << length) {
            return None;
        }
        let variance = self.stays.variance(length)?;
        stay.frames += 1;
        Some((core::mem::take(&mut stay.pooled), variance, moved_s))
    }

    /// What the best hypothesis misses tells of the noise, where it is known well enough.
    fn learn(&mut self, frame: &Frame) {
        let tuning = self.tuning;
        let Some(best) = self.bank.best() else { return };
        let is_young = best.length(&self.bank.frames) < LATELY;
        if best.now.odd > 0 || is_young || best.error > tuning.learn_deg.to_radians().powi(2) {
            self.missed = None;
            return;
        }
        let known = best.now.known();
        let (level, tilted, _) = best.now.level();
        let Some(seen) = parameters::see(&known.mean, &frame.u) else { return };
        let by_tau = parameters::gradient(&known.mean, &seen.direction, &seen.offset, 0.0) / seen.slope;
        let rho = known.variance(&by_tau);
        let miss = (seen.radius - 1.0) / seen.slope - level / seen.slope;
        let vertical = frame.up.map(|up| {
            let sine = up.dot(&seen.direction);
            let across = (up - seen.direction * sine) / seen.radius;
            let by_tau = parameters::gradient(&known.mean, &across, &seen.offset, 1.0);
            (sine - known.mean[9] - tilted, known.variance(&by_tau))
        });
        if let Some((before, vertical_before)) = self.missed {
            self.differing.add(0.5 * (miss - before).powi(2));
            if let Some((v, before)) = vertical.map(|v| v.0).zip(vertical_before) {
                self.tilt_white.add(0.5 * (v - before).powi(2));
            }
        }
        self.missed = Some((miss, vertical.map(|v| v.0)));
        if tuning.unevenness {
            self.uneven.add(miss, frame.white + rho, frame.moved_s);
        }
        if let Some((v, rho)) = vertical.filter(|_| tuning.tilting) {
            self.tilt.add(v, frame.tilt_white + rho, frame.seconds);
        }
    }

    /// Publishes the mixture once it is known well enough. While a cold start leads whose device has not turned, the old mean stays, with the
    /// mixture's covariance about it.
    fn publish(&mut self, time_ns: i64) {
        let Some(mixture) = self.bank.mixture() else { return };
        let mixture = Published::new(mixture, self.unit_ut, self.strength_ut);
        let is_shown = self.bank.best().is_some_and(|best| best.kind != Kind::Cold || best.is_shown(&self.tuning));
        let narrow = self.tuning.publish_deg.to_radians().powi(2);
        match &self.published {
            None if mixture.error >= narrow || !is_shown => {}
            Some(published) if !is_shown || !is_bounded(&mixture.known.mean) => {
                let off = mixture.known.mean - published.known.mean;
                let covariance = mixture.known.covariance + off * off.transpose();
                let known = Gaussian { mean: published.known.mean, covariance };
                self.published = Some(Published::new(known, self.unit_ut, self.strength_ut));
            }
            _ => self.published = Some(mixture).filter(|it| is_bounded(&it.known.mean)),
        }
        if self.published.is_some() {
            self.decision.review(&self.bank, time_ns, self.unit_ut, &self.tuning);
        }
        if (self.worst == 0.0 || self.count.is_multiple_of(16))
            && let Some(published) = &self.published
        {
            self.worst = published.worst();
        }
    }

    fn answer(&self, u: &Vector3<f64>) -> Answer {
        let degrees = |square: f64| square.max(0.0).sqrt().to_degrees().min(180.0);
        // what differs in strength and along the vertical differs across it, too; and what slid may be the place's
        let elsewhere = self.bank.best().map_or(0.0, |best| {
            let (level, tilted, _) = best.now.level();
            let beyond = parameters::beyond_earth(&best.now.tau(), self.unit_ut);
            0.5 * (level * level + tilted * tilted + beyond * beyond) + best.slid().norm_squared()
        });
        let noise = self.white() + self.bank.noise.uneven.size.powi(2);
        let corrected = self.published.and_then(|published| published.correct(u, noise, elsewhere));
        let (field_ut, field_covariance_ut2) = corrected.unzip();
        Answer {
            field_ut,
            field_covariance_ut2,
            worst_sigma_deg: self.published.map(|_| degrees(self.worst)),
            model_order: corrected.map(|_| self.decision.order),
            event: self.decision.event,
            ..Answer::default()
        }
    }

    fn status(&self) -> Status {
        let Some(published) = &self.published else {
            let have = self.count as usize;
            return Status::Collecting(if have < FEWEST {
                Missing::Samples { have, need: FEWEST }
            } else {
                Missing::Directions
            });
        };
        if let Some(since_ns) = self.decision.suspected_ns {
            return Status::Suspect { since_ns };
        }
        if let Some(since_ns) = self.decision.elsewhere {
            return Status::Disturbed { since_ns };
        }
        if published.error > self.tuning.publish_deg.to_radians().powi(2) || !self.has_learned() {
            return Status::Held(HoldReason::TooLittleRotation);
        }
        Status::Tracking
    }

    /// M, b and the field strength in force; before the first sample those that were given.
    pub fn calibration(&self) -> Option<Calibration> {
        match self.published {
            Some(published) => published.calibration(),
            None => self.untouched().map(|given| given.calibration),
        }
    }

    /// Whether live samples, from directions that differ, agree with the calibration in force.
    pub fn has_learned(&self) -> bool {
        let limit = (1.0 - self.tuning.shown_rad2) * self.groups * self.groups;
        self.published.is_some() && (self.given.is_none() || self.seen.norm_squared() < limit)
    }

    /// What was given, before the first sample.
    pub fn untouched(&self) -> Option<Given> {
        self.given.filter(|_| self.count == 0)
    }

    /// Covariance of [b_x b_y b_z (uT), m_xx m_yy m_zz m_xy m_xz m_yz].
    pub fn covariance(&self) -> Option<SMatrix<f64, 9, 9>> {
        self.published?.covariance()
    }

    /// Samples since the latest change.
    pub fn window(&self) -> usize {
        self.bank.best().map_or(0, |best| best.age as usize)
    }
}
