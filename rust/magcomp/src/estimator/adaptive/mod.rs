//! The adaptive estimator: M and b from the magnetometer alone, at the speed the information in the samples allows.
//!
//! Since the latest change the samples lie on one ellipsoid |T (u - beta)| = 1; when that change was, and what it changed, is
//! not known. A bank of hypotheses says each what it may be; the samples weigh them; the mixture is published.
//! One file an idea: `tuning` (every choice) · `parameters` (tau and derivatives) · `likelihood` (from moments) ·
//! `hypothesis` (prior, fit, evidence) · `motion` (b that moves) · `bank` (hypotheses against each other) · `noise` (white, and of the place) ·
//! `vertical` (gravity's constraint) · `grouping` (neighbours averaged) · `decision` (what is
//! told of changes) · `published` (what is in force) · `explain` (for people).
//! The derivation is in docs/METHOD.md.

mod bank;
mod decision;
mod explain;
mod grouping;
mod hypothesis;
mod likelihood;
mod motion;
mod noise;
mod parameters;
mod published;
mod setting;
mod tuning;
mod vertical;

use crate::calibration::{Calibration, Given, UNEVEN_UT, typical_field_ut};
use crate::estimator::answer::Answer;
use crate::explanation::SampleUse;
use crate::reading::{HoldReason, Missing, Status};
use crate::sensing::tilt::GRAVITY_M_S2;
use bank::Bank;
use decision::Decision;
use grouping::{Group, Grouping};
use nalgebra::{SMatrix, Vector3};
use noise::{Level, Noise};
use parameters::{Gaussian, is_bounded};
use published::Published;
use setting::{Sample, Setting};
pub(crate) use tuning::Tuning;

/// Samples before there can be an estimate: as many as nine parameters need, and some.
const FEWEST: usize = 16;

/// Mean square turn, about one axis at least, after which a given calibration was looked at from sides enough to be confirmed, rad^2.
const TURNED_RAD2: f64 = 0.1;

/// Where the device stays, and for how long, samples.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Stay {
    at: Vector3<f64>,
    samples: f64,
}

/// The estimator. All state is plain numbers.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Adaptive {
    tuning: Tuning,
    unit_ut: f64,
    strength_ut: Option<f64>,
    given: Option<Given>,
    bank: Bank,
    noise: Noise,
    grouping: Grouping,
    stay: Stay,
    latest_ns: Option<i64>,
    group_ns: Option<i64>,
    published: Option<Published>,
    worst: f64,
    decision: Decision,
    count: u64,
    /// Sum of the corrected directions, and of how many groups.
    seen: Vector3<f64>,
    groups: u64,
    /// What became of the latest complete group: only told.
    usage: Option<SampleUse>,
}

impl Adaptive {
    /// Knows nothing but, perhaps, the field's strength, uT, and a calibration to begin with.
    pub fn new(tuning: Tuning, strength_ut: Option<f64>, initial: Option<Given>) -> Self {
        let unit_ut = typical_field_ut(strength_ut);
        Self {
            tuning,
            unit_ut,
            strength_ut,
            given: initial,
            bank: Bank::new(),
            noise: Noise::new(&tuning, unit_ut),
            grouping: Grouping::default(),
            stay: Stay { at: Vector3::zeros(), samples: 0.0 },
            latest_ns: None,
            group_ns: None,
            published: None,
            worst: 0.0,
            decision: Decision::default(),
            count: 0,
            seen: Vector3::zeros(),
            groups: 0,
            usage: None,
        }
    }

    /// A raw sample, finite, times in order, and what gravity says with it, m/s^2.
    pub fn push(&mut self, time_ns: i64, raw_ut: &Vector3<f64>, up_m_s2: Option<Vector3<f64>>) -> (Status, Answer) {
        let u = raw_ut / self.unit_ut;
        let calm = |up: &Vector3<f64>| (up.norm() / GRAVITY_M_S2 - 1.0).abs() < self.tuning.calm;
        let up = up_m_s2.filter(calm).map(|up| up.normalize());
        let seconds = self.latest_ns.map(|latest| time_ns.saturating_sub(latest) as f64 * 1e-9);
        self.latest_ns = Some(time_ns);
        self.noise.raw(&u, seconds);
        self.count += 1;
        if self.bank.is_empty() {
            self.begin(time_ns, &u);
        }
        let radius = self.tuning.group_ut / self.unit_ut + 4.5 * self.noise.white().sqrt();
        let longest = ((self.tuning.group_s - self.noise.period_s()).max(0.0) * 1e9) as i64;
        for group in self.grouping.push((time_ns, u, up), radius, longest).into_iter().flatten() {
            self.take(&group);
        }
        (self.status(), self.answer(&u).without_gyroscope(up_m_s2))
    }

    fn setting<'a>(&self, tuning: &'a Tuning) -> Setting<'a> {
        Setting::new(tuning, self.unit_ut, self.strength_ut, self.noise.period_s(), self.noise.level())
    }

    fn begin(&mut self, time_ns: i64, u: &Vector3<f64>) {
        let tuning = self.tuning;
        let at = self.setting(&tuning);
        let given = self.given.map(|given| bank::given(&given, &at));
        self.published = given.map(|known| Published::new(known, self.unit_ut, self.strength_ut));
        self.bank.begin(time_ns, u, given, &at);
    }

    /// A complete group of neighbours.
    fn take(&mut self, group: &Group) {
        let tuning = self.tuning;
        let at = self.setting(&tuning);
        let (u, count) = (group.mean(), group.samples().len());
        let seconds = self.group_ns.map_or(0.0, |before| group.began_ns().saturating_sub(before) as f64 * 1e-9);
        self.group_ns = Some(group.began_ns());
        let stale = self.stays(&u, count as f64, &at.level);
        let sample = Sample { u, raw_ut: u * self.unit_ut, up: group.up(), count, stale };
        let surprise = self.bank.surprise(&sample, &at);
        self.usage = Some(match surprise {
            _ if stale => SampleUse::AtRest,
            Some(_) => SampleUse::Gated,
            None => SampleUse::Used,
        });
        if !stale {
            self.learn_noise(group, surprise.is_some(), &at.level);
        }
        self.bank.push(group.began_ns(), &sample, surprise, seconds.min(1.0), &at);
        self.publish(group.began_ns(), &at);
        if let Some(seen) = self.published.and_then(|published| parameters::see(&published.known.mean, &u)) {
            self.seen += seen.direction;
            self.groups += 1;
        }
    }

    /// What the best hypothesis misses tells of the noise, where it is known well enough.
    fn learn_noise(&mut self, group: &Group, surprised: bool, level: &Level) {
        let Some(best) = self.bank.best() else { return };
        let white = best.error / level.kappa;
        let count = group.samples().len() as f64;
        if best.age * self.noise.period_s() <= 0.5 || white.sqrt() >= 5.0_f64.to_radians() || surprised {
            self.noise.interrupt();
            return;
        }
        let known = best.known;
        if let Some(up) = group.up() {
            let (e, g) = vertical::miss(&known.mean, &group.mean(), &up);
            let rho = g.dot(&(known.covariance * g)).max(0.0);
            let lasting = rho < self.noise.tilt();
            self.noise.vertical((e, count), rho / level.kappa, lasting);
        }
        for u in group.samples() {
            if let Some((e, g)) = parameters::distance(&known.mean, u) {
                let rho = g.dot(&(known.covariance * g)).max(0.0);
                self.noise.distance(e, rho / level.kappa, rho < level.white + level.uneven);
            }
        }
    }

    /// A device that stays sees one place of an uneven field again and again: whether it has told of it already.
    fn stays(&mut self, u: &Vector3<f64>, count: f64, level: &Level) -> bool {
        if (u - self.stay.at).norm() > self.tuning.group_ut / self.unit_ut {
            self.stay = Stay { at: *u, samples: 0.0 };
        }
        self.stay.samples += count;
        let place = level.uneven.max((UNEVEN_UT / self.unit_ut).powi(2));
        let worth = if level.kappa > 2.0 { level.kappa * level.white / place } else { 1.0 / self.noise.period_s() };
        self.stay.samples > worth.max(count)
    }

    /// The mixture, where it is known well enough or much better than what is in force; else that, as sure as the mixture says.
    fn publish(&mut self, time_ns: i64, at: &Setting) {
        let Some(mixture) = self.bank.mixture(at) else { return };
        let mixture = Published::new(mixture, self.unit_ut, self.strength_ut);
        let narrow = self.tuning.publish_deg.to_radians().powi(2);
        let held = self.published.filter(|_| mixture.error >= narrow).map(|published| {
            let off = mixture.known.mean - published.known.mean;
            let covariance = mixture.known.covariance + off * off.transpose();
            Published::new(Gaussian { mean: published.known.mean, covariance }, self.unit_ut, self.strength_ut)
        });
        let better = mixture.error < narrow || held.is_some_and(|held| mixture.error < 0.25 * held.error);
        if better && is_bounded(&mixture.known.mean) {
            self.published = Some(mixture);
            self.decision.review(&self.bank, time_ns, &self.tuning);
        } else if held.is_some() {
            self.published = held;
        }
        self.decision.watch(&self.bank, &self.tuning);
        if self.count.is_multiple_of(16)
            && let Some(published) = &self.published
        {
            self.worst = published.worst();
        }
    }

    fn answer(&self, u: &Vector3<f64>) -> Answer {
        let at = self.setting(&self.tuning);
        let degrees = |square: f64| square.max(0.0).sqrt().to_degrees().min(180.0);
        let corrected = self.published.and_then(|published| published.correct(u, &at));
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
        if let Some(since_ns) = self.decision.elsewhere_ns() {
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
        let was_turned = || {
            let groups = self.groups as f64;
            self.seen.norm_squared() < (1.0 - TURNED_RAD2) * groups * groups
        };
        self.published.is_some() && (self.given.is_none() || was_turned())
    }

    /// What was given, before the first sample.
    pub fn untouched(&self) -> Option<Given> {
        self.given.filter(|_| self.bank.is_empty())
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
