//! The aided estimator: gyroscope and gravity beside the magnetometer.
//!
//! Between two samples the field in the device frame turns by the inverse of the device's own rotation, which the
//! gyroscope measures. So raw = M h + b is linear in (b, M) with a known h, and any rotation makes them observable.
//! One file an idea: `state` · `propagate` · `measure` · `adapt` (noise) · `motion` (rest, up) · `strength` (the magnitude
//! as a witness) · `watch` (what does not fit) · `events` (hypotheses) · `magnitude` (no gyroscope) · `start` · `learn` (one
//! sample) · `output`, `publish`. The derivation is in docs/METHOD.md.

mod adapt;
mod config;
mod events;
mod learn;
pub(crate) mod magnitude;
mod measure;
mod motion;
mod output;
mod propagate;
mod publish;
mod start;
mod state;
mod strength;
#[cfg(test)]
mod tests;
mod tuning;
mod watch;

use nalgebra::{SMatrix, Vector3};
use serde::{Deserialize, Serialize};

pub use config::AidedConfig;
pub(crate) use output::{AidedOutput, calibration_covariance};

use crate::calibration::Calibration;
use crate::pairing::PairedInertial;
use crate::reading::{Event, RejectReason, SensorMode, Status};
use adapt::Adaptation;
use events::Trial;
use magnitude::Magnitude;
use motion::Motion;
use start::Unproven;
use state::{BIAS, FIELD, Gaussian, OFFSET, SCALE};
use strength::Strength;
use watch::{Former, Watch};

const NANO: f64 = 1e-9;
/// Rates beyond any gyroscope's range are not believed, rad/s.
const LARGEST_RATE_RAD_S: f64 = 100.0;
/// Beyond the range of any phone's magnetometer, uT.
const LARGEST_RAW_UT: f64 = 5000.0;
/// More than any gyroscope can have gathered across a gap that it bridged, rad.
const LARGEST_INCREMENT_RAD: f64 = 1000.0;
/// Beyond any accelerometer's range, m/s^2.
const LARGEST_UP_M_S2: f64 = 1000.0;

/// The estimator. All state is plain numbers: it can be cloned, compared and serialized.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Aided {
    config: AidedConfig,
    last_ns: Option<i64>,
    filter: Option<Gaussian>,
    /// The filter has been started anew from its own first answer.
    restarted: bool,
    adopted: bool,
    /// Misfits still allowed: to the samples right after the first before that one is dropped (0: one has fitted), or to the
    /// strength of the field before an unproven calibration is.
    unconfirmed: u32,
    adaptation: Adaptation,
    motion: Motion,
    watch: Watch,
    trial: Option<Trial>,
    former: Option<Former>,
    magnitude: Magnitude,
    event: Option<Event>,
    strength: Strength,
    /// When the latest misfit passed by itself.
    passed_ns: Option<i64>,
    unproven: Unproven,
    /// What the field of a new place differs by from the one carried there, device frame, uT.
    displaced_ut: Vector3<f32>,
    /// How long it has been the place, s.
    displaced_s: f32,
    /// Seconds of motion for which the calibration still holds.
    hold_s: f64,
    /// Time since the prior on |m| was applied, s.
    prior_age_s: f64,
    /// |m| before the chain of rotations broke.
    lost_strength_ut: Option<f64>,
    mode: SensorMode,
}

impl Aided {
    /// A new estimator that knows nothing, for a validated config.
    pub fn new(config: AidedConfig) -> Self {
        Self {
            last_ns: None,
            filter: None,
            restarted: false,
            adopted: false,
            unconfirmed: 0,
            adaptation: Adaptation::new(&config),
            motion: Motion::new(),
            watch: Watch::new(),
            trial: None,
            former: None,
            magnitude: Magnitude::new(),
            event: None,
            strength: Strength::default(),
            passed_ns: None,
            unproven: Unproven::default(),
            displaced_ut: Vector3::zeros(),
            displaced_s: 0.0,
            hold_s: 0.0,
            prior_age_s: 0.0,
            lost_strength_ut: None,
            mode: SensorMode::default(),
            config,
        }
    }

    /// The calibration in force: M, b and |m|; `None` while collecting.
    pub fn calibration(&self) -> Option<Calibration> {
        if self.magnitude_is_better() {
            return Calibration::new(
                self.magnitude.soft_iron(),
                self.magnitude.offset_ut,
                self.magnitude.strength_ut.max(1.0),
            )
            .ok();
        }
        let filter = self.filter.as_ref().filter(|_| self.adopted)?;
        // where the field points is lost: m is but the latest sample
        let strength_ut = self.lost_strength_ut.unwrap_or_else(|| filter.vector(FIELD).norm());
        Calibration::new(filter.soft_iron(), filter.vector(OFFSET), strength_ut.max(1.0)).ok()
    }

    /// Bias (rad/s) and scale error of the gyroscope, 0 while nothing is known.
    pub fn gyroscope(&self) -> (Vector3<f64>, Vector3<f64>) {
        self.filter.as_ref().map_or_else(Default::default, |filter| (filter.vector(BIAS), filter.vector(SCALE)))
    }

    /// Covariance of the calibration, order b_x b_y b_z m_xx m_yy m_zz m_xy m_xz m_yz (uT and dimensionless).
    pub fn covariance(&self) -> Option<SMatrix<f64, 9, 9>> {
        if self.magnitude_is_better() {
            return Some(self.magnitude.covariance());
        }
        let filter = self.filter.as_ref().filter(|_| self.adopted)?;
        Some(publish::calibration_block(filter) * self.adaptation.believed())
    }

    /// One magnetometer sample (uT, device frame) with the inertial state paired to its time.
    ///
    /// Never panics; an unusable sample comes back as `Rejected` and changes nothing.
    pub fn push(&mut self, time_ns: i64, raw_ut: Vector3<f64>, inertial: &PairedInertial) -> AidedOutput {
        if let Some(reason) = self.rejection(time_ns, &raw_ut) {
            return self.blank(time_ns, Status::Rejected(reason));
        }
        let dt_s = self.last_ns.map(|last| time_ns.saturating_sub(last) as f64 * NANO);
        self.last_ns = Some(time_ns);
        let up = inertial.up_m_s2.filter(|up| up.amax() < LARGEST_UP_M_S2 && up.iter().all(|v| v.is_finite()));
        let rotation = inertial.rotation.filter(|r| {
            r.increment_rad.iter().chain(r.rate_rad_s.iter()).all(|v| v.is_finite())
                && r.rate_rad_s.amax() < LARGEST_RATE_RAD_S
                && r.increment_rad.amax() < LARGEST_INCREMENT_RAD
        });
        match (rotation, dt_s) {
            (Some(rotation), Some(dt_s)) => self.with_rotation(time_ns, &raw_ut, &rotation, up, dt_s),
            _ => {
                self.adaptation.forget_previous();
                self.without_rotation(time_ns, &raw_ut, up, dt_s)
            }
        }
    }

    fn rejection(&self, time_ns: i64, raw_ut: &Vector3<f64>) -> Option<RejectReason> {
        let value_ut = raw_ut.amax();
        match self.last_ns {
            _ if !raw_ut.iter().all(|v| v.is_finite()) => Some(RejectReason::NotFinite),
            _ if value_ut > LARGEST_RAW_UT => Some(RejectReason::OutOfRange { value_ut, limit_ut: LARGEST_RAW_UT }),
            Some(latest_ns) if time_ns <= latest_ns => Some(RejectReason::TimeNotAfter { time_ns, latest_ns }),
            _ => None,
        }
    }
}
