//! The adaptive estimator: M and b from the magnetometer alone, at the speed the information in the samples allows.
//!
//! Since the latest change the samples lie on one ellipsoid |T (u - beta)| = 1; when that change was, and what it changed, is
//! not known. A bank of hypotheses says each what it may be; the samples weigh them; the mixture is published.
//! One file an idea: `tuning` (every choice) · `parameters` (tau and derivatives) · `likelihood` (from moments) ·
//! `hypothesis` (prior, fit, evidence) · `bank` (hypotheses against each other) · `noise` (white, and of the place) ·
//! `grouping` (neighbours averaged) · `angle` (errors as angles) · `output`.
//! The derivation is in docs/METHOD.md.

mod angle;
mod bank;
mod grouping;
mod hypothesis;
mod likelihood;
mod noise;
mod output;
mod parameters;
mod tuning;
mod vertical;

use crate::calibration::Calibration;
use crate::config::{Config, ConfigError};
use crate::reading::{Event, EventKind, HoldReason, Missing, ModelOrder, Status};
use bank::Bank;
use grouping::{Group, Grouping};
use hypothesis::{Gate, Gaussian, Kind, Sample};
use nalgebra::Vector3;
use noise::{Level, Noise, VerticalNoise};
pub(crate) use output::AdaptiveOutput;
use parameters::is_bounded;
use serde::{Deserialize, Serialize};
use tuning::Tuning;

/// The few numbers of the adaptive estimator.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct AdaptiveConfig {
    /// Magnetometer noise to start from, uT per axis. Default 0.5 (a Nexus 5: 0.48; iPhones 0.7 to 1.1). It is learned: a
    /// factor of 3 wrong does not matter after 300 samples.
    pub noise_ut: f64,
}

impl Default for AdaptiveConfig {
    fn default() -> Self {
        Self { noise_ut: 0.5 }
    }
}

impl AdaptiveConfig {
    /// Checks every field against its range.
    pub(crate) fn validate(&self) -> Result<(), ConfigError> {
        if (0.01..=20.0).contains(&self.noise_ut) {
            return Ok(());
        }
        Err(ConfigError { field: "adaptive.noise_ut", value: self.noise_ut.to_string(), expected: "0.01 to 20" })
    }
}

/// Standard gravity, and the share of it by which a vertical may be accelerated to be one.
const GRAVITY_M_S2: f64 = 9.806_65;
const CALM: f64 = 0.1;

const TUNING: Tuning = Tuning::PHONE;

/// What is in force.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Published {
    known: Gaussian,
    /// Expected direction error all around, rad^2.
    error: f64,
}

/// Where the device stays, and for how long, samples.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Stay {
    at: Vector3<f64>,
    samples: f64,
}

/// The estimator. All state is plain numbers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Adaptive {
    unit_ut: f64,
    strength_ut: Option<f64>,
    given: Option<Calibration>,
    bank: Box<Bank>,
    noise: Noise,
    vertical_noise: VerticalNoise,
    up: Option<Vector3<f64>>,
    grouping: Grouping,
    stay: Stay,
    latest_ns: Option<i64>,
    group_ns: Option<i64>,
    published: Option<Published>,
    surprised: bool,
    worst: f64,
    order: ModelOrder,
    event: Option<Event>,
    /// The hypothesis whose change was decided last.
    decided: u32,
    /// Since when the place is another one.
    place_ns: Option<i64>,
    count: u64,
}

impl Adaptive {
    /// Knows nothing but, perhaps, a calibration to begin with.
    pub fn new(config: &Config, initial: Option<Calibration>) -> Self {
        let fit = &config.fit;
        let middle = (fit.field_range_ut.0 * fit.field_range_ut.1).sqrt();
        let unit_ut = fit.field_strength_ut.unwrap_or(middle);
        let tuning = Tuning { noise_ut: config.adaptive.noise_ut, ..TUNING };
        Self {
            unit_ut,
            strength_ut: fit.field_strength_ut,
            given: initial,
            bank: Box::new(Bank::new()),
            noise: Noise::new(&tuning, unit_ut),
            vertical_noise: VerticalNoise::new(),
            up: None,
            grouping: Grouping::default(),
            stay: Stay { at: Vector3::zeros(), samples: 0.0 },
            latest_ns: None,
            group_ns: None,
            published: None,
            surprised: false,
            worst: 0.0,
            order: ModelOrder::Nothing,
            event: None,
            decided: 0,
            place_ns: None,
            count: 0,
        }
    }

    /// What gravity says with the next sample, m/s^2.
    pub fn level(&mut self, up_m_s2: Option<Vector3<f64>>) {
        let calm = |up: &Vector3<f64>| (up.norm() / GRAVITY_M_S2 - 1.0).abs() < CALM;
        self.up = up_m_s2.filter(calm).map(|up| up.normalize());
    }

    /// A raw sample, finite, times in order.
    pub fn push(&mut self, time_ns: i64, raw_ut: &Vector3<f64>) -> AdaptiveOutput {
        let u = raw_ut / self.unit_ut;
        let seconds = self.latest_ns.map(|latest| time_ns.saturating_sub(latest) as f64 * 1e-9);
        self.latest_ns = Some(time_ns);
        self.noise.raw(&u, seconds);
        self.count += 1;
        if self.bank.is_empty() {
            self.begin(time_ns, &u);
        }
        let level = self.noise.level(&self.vertical_noise);
        let radius = TUNING.group_ut / self.unit_ut + 4.5 * level.white.sqrt();
        let longest = ((TUNING.group_s - self.noise.period_s()).max(0.0) * 1e9) as i64;
        for group in self.grouping.push((time_ns, u, self.up), radius, longest).into_iter().flatten() {
            self.take(&group);
        }
        self.output(&u)
    }

    fn begin(&mut self, time_ns: i64, u: &Vector3<f64>) {
        let given = self.given.map(|calibration| {
            let t = calibration.soft_iron_inverse() * (self.unit_ut / calibration.field_strength_ut());
            bank::given(&parameters::tau_of(&t, &(calibration.hard_iron_ut() / self.unit_ut)), self.unit_ut, &TUNING)
        });
        self.published = given.map(|known| Published { known, error: angle::expected(&known) });
        self.bank.begin(time_ns, u, self.unit_ut, self.strength_ut, given, &TUNING);
        self.decided = self.bank.best().map_or(0, |best| best.id);
    }

    /// A complete group of neighbours.
    fn take(&mut self, group: &Group) {
        let level = self.noise.level(&self.vertical_noise);
        let (u, count) = (group.mean(), group.samples().len());
        let seconds = self.group_ns.map_or(0.0, |before| group.began_ns().saturating_sub(before) as f64 * 1e-9);
        self.group_ns = Some(group.began_ns());
        let stale = self.stays(&u, count as f64, &level);
        let half_square = -(TUNING.spike_share * level.white.sqrt() * std::f64::consts::TAU.sqrt() * self.unit_ut
            / TUNING.spike_range_ut)
            .ln();
        let gate = Gate {
            half_square,
            price: half_square / level.kappa.sqrt(),
            unsure: TUNING.unsure_deg.to_radians().powi(2),
        };
        let sample = Sample { u, raw_ut: u * self.unit_ut, up: group.up(), count, stale };
        let period_s = self.noise.period_s();
        if !stale {
            self.learn_noise(group, &level, &gate);
        }
        self.surprised = self.bank.push(
            group.began_ns(),
            &sample,
            seconds.min(1.0),
            period_s,
            &level,
            &gate,
            self.unit_ut,
            self.strength_ut,
            &TUNING,
        );
        self.publish(group.began_ns());
    }

    /// What the best hypothesis misses tells of the noise, where it is known well enough.
    fn learn_noise(&mut self, group: &Group, level: &Level, gate: &Gate) {
        let Some(best) = self.bank.best() else { return };
        let white = best.error / level.kappa;
        let count = group.samples().len() as f64;
        let surprised = best.judges(level, gate)
            && best.surprise(&group.mean(), count, level).is_some_and(|(_, z2)| 0.5 * z2 > gate.half_square * count);
        if best.age * self.noise.period_s() <= 0.5 || white.sqrt() >= 5.0_f64.to_radians() || surprised {
            self.noise.interrupt();
            self.vertical_noise.interrupt();
            return;
        }
        let known = best.known;
        if let Some(up) = group.up() {
            let (e, g) = vertical::miss(&known.mean, &group.mean(), &up);
            let rho = g.dot(&(known.covariance * g)).max(0.0) / level.kappa;
            for _ in 0..group.samples().len() {
                self.vertical_noise.miss(e, rho, self.noise.period_s());
            }
        }
        for u in group.samples() {
            if let Some((e, g)) = parameters::distance(&known.mean, u) {
                let rho = g.dot(&(known.covariance * g)).max(0.0) / level.kappa;
                self.noise.distance(e, rho, rho < 0.25 * level.white);
            }
        }
    }

    /// A device that stays sees one place of an uneven field again and again: whether it has told of it already.
    fn stays(&mut self, u: &Vector3<f64>, count: f64, level: &Level) -> bool {
        if (u - self.stay.at).norm() > TUNING.group_ut / self.unit_ut {
            self.stay = Stay { at: *u, samples: 0.0 };
        }
        self.stay.samples += count;
        let place = level.uneven.max((TUNING.uneven_ut / self.unit_ut).powi(2));
        let worth = if level.kappa > 2.0 { level.kappa * level.white / place } else { 1.0 / self.noise.period_s() };
        self.stay.samples > worth.max(count)
    }

    fn publish(&mut self, time_ns: i64) {
        let Some(mixture) = self.bank.mixture() else { return };
        let held = self.published.map(|published| {
            let off = mixture.known.mean - published.known.mean;
            let known =
                Gaussian { mean: published.known.mean, covariance: mixture.known.covariance + off * off.transpose() };
            Published { error: angle::expected(&known), known }
        });
        let narrow = TUNING.publish_deg.to_radians().powi(2);
        let better = held.is_some_and(|held| mixture.error < 0.25 * held.error);
        if is_bounded(&mixture.known.mean) && (mixture.error < narrow || better) {
            self.published = Some(Published { known: mixture.known, error: mixture.error });
            self.decide(time_ns);
        } else if let Some(held) = held {
            self.published = Some(held);
        }
        if self.count.is_multiple_of(16)
            && let Some(published) = &self.published
        {
            self.worst = published.known.covariance.symmetric_eigenvalues().max();
        }
    }

    /// A change is decided when the hypotheses that came with it have nearly all of the probability.
    fn decide(&mut self, time_ns: i64) {
        if self.place_ns.is_some_and(|since| time_ns.saturating_sub(since) as f64 > TUNING.new_place_s * 1e9) {
            self.place_ns = None;
        }
        let Some(best) = self.bank.best() else { return };
        let (id, kind, onset_ns) = (best.id, best.kind, best.onset_ns);
        let certain = || self.bank.probability(|h| h.onset_ns >= onset_ns && h.id != self.decided) > TUNING.certain;
        if id == self.decided || kind == Kind::Motion || !certain() {
            return;
        }
        let before = best.former.map_or(best.known, |former| former);
        let best_mean = best.known.mean;
        let off = best_mean - before.mean;
        let turned = angle::expected(&Gaussian { mean: before.mean, covariance: off * off.transpose() });
        self.decided = id;
        let was_elsewhere = self.place_ns.take().is_some();
        let kind = match kind {
            Kind::Cold | Kind::Motion => return,
            Kind::Place if self.is_same_place(&before.mean, &best_mean) => return,
            Kind::Place => {
                self.place_ns = Some(onset_ns);
                EventKind::PlaceChanged
            }
            Kind::Former if was_elsewhere => EventKind::PlaceChanged,
            _ if turned < TUNING.least_change_deg.to_radians().powi(2) => return,
            Kind::Former => {
                self.order = ModelOrder::Former;
                EventKind::DeviceStepBack
            }
            Kind::HardIron => {
                self.order = ModelOrder::HardIron;
                EventKind::DeviceStep
            }
            Kind::All => {
                self.order = ModelOrder::All;
                EventKind::DeviceStep
            }
        };
        // what is found out about a change that has been told already is no other change
        let told = self.event.is_some_and(|told| {
            onset_ns.saturating_sub(told.since_ns) as f64 <= TUNING.one_change_s * 1e9
                && (told.kind == EventKind::PlaceChanged) == (kind == EventKind::PlaceChanged)
        });
        if !told {
            self.event = Some(Event { kind, since_ns: onset_ns, decided_ns: time_ns });
        }
    }

    /// Whether the field is about as strong and as steep.
    fn is_same_place(&self, a: &parameters::Tau, b: &parameters::Tau) -> bool {
        let strength = |tau: &parameters::Tau| parameters::shape(tau).trace();
        (strength(a) / strength(b) - 1.0).abs() < TUNING.least_place && (a[9] - b[9]).abs() < TUNING.least_place
    }

    fn status(&self) -> Status {
        let Some(published) = &self.published else {
            return Status::Collecting(Missing::Directions);
        };
        let limit = TUNING.publish_deg.to_radians().powi(2);
        match self.bank.best() {
            Some(best) if best.id != self.decided && best.kind != Kind::Motion => {
                Status::Suspect { since_ns: best.onset_ns }
            }
            _ if self.place_ns.is_some() => Status::Disturbed { since_ns: self.place_ns.unwrap_or_default() },
            _ if published.error > limit => Status::Held(HoldReason::TooLittleRotation),
            _ => Status::Tracking,
        }
    }
}
