//! The aided estimator: gyroscope and gravity beside the magnetometer.
//!
//! Between two samples the field in the device frame turns by the inverse of the device's own rotation, which the
//! gyroscope measures. So raw = M h + b is linear in (b, M) with a known h, and any rotation makes them observable.
//! One file an idea: `state` · `propagate` · `measure` · `adapt` (noise) · `motion` (rest, up) · `strength` · `earth` (in a new place) · `watch` (samples
//! that do not fit) · `events` (hypotheses) · `start`, `first_fit`, `batch`, `groups` · `step`, `learn` (one sample) ·
//! `output`, `publish`. The derivation is in docs/METHOD-AIDED.md.

mod adapt;
mod batch;
mod earth;
mod events;
mod first_fit;
mod groups;
mod learn;
mod measure;
mod motion;
mod output;
mod propagate;
mod publish;
mod start;
mod state;
mod step;
mod strength;
#[cfg(test)]
mod tests;
mod tuning;
mod watch;

use crate::sound::checked;
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

pub(crate) use output::{AidedOutput, calibration_covariance};

use crate::calibration::Calibration;
use crate::reading::{Event, SensorMode};
use crate::sensing::pairing::PairedInertial;
use adapt::Adaptation;
use earth::Earth;
use events::Trial;
use first_fit::FirstFit;
use motion::Motion;
use state::{BIAS, FIELD, Gaussian, OFFSET};
/// What an aided estimator is made with.
pub(crate) use tuning::Tuning;
use watch::{Former, Watch};

const NANO: f64 = 1e-9;
/// Rates beyond any gyroscope's range are not believed, rad/s.
const LARGEST_RATE_RAD_S: f64 = 100.0;
/// More than any gyroscope can have gathered across a gap that it bridged, rad.
const LARGEST_INCREMENT_RAD: f64 = 1000.0;
/// Beyond any accelerometer's range, m/s^2.
const LARGEST_UP_M_S2: f64 = 1000.0;

/// The estimator. All state is plain numbers: it can be cloned, compared and serialized.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(remote = "Self"))]
pub(crate) struct Aided {
    #[cfg_attr(feature = "serde", serde(skip))]
    tuning: Tuning,
    last_ns: Option<i64>,
    /// None until a first calibration is found.
    filter: Option<Gaussian>,
    first: FirstFit,
    /// The strength of the field where it is known, uT.
    known_ut: Option<f64>,
    adaptation: Adaptation,
    motion: Motion,
    watch: Watch,
    trial: Option<Trial>,
    former: Option<Former>,
    event: Option<Event>,
    /// Seconds of motion since the first calibration: what does not fit at first is likelier that one's own error than a change.
    moved_s: f64,
    /// The Earth's field, while that of the place is another.
    earth: Option<Earth>,
    /// |m| before the chain of rotations broke.
    lost_strength_ut: Option<f64>,
    mode: SensorMode,
}

checked!(Aided, |it| it.moved_s >= 0.0 && it.lost_strength_ut.is_none_or(|strength_ut| strength_ut > 0.0));

impl Aided {
    /// A new estimator that knows nothing but, perhaps, the strength of the field, for a validated config.
    pub fn new(tuning: Tuning, known_ut: Option<f64>) -> Self {
        Self {
            known_ut,
            last_ns: None,
            filter: None,
            first: FirstFit::new(None, known_ut, &tuning),
            adaptation: Adaptation::new(&tuning),
            motion: Motion::new(),
            watch: Watch::new(),
            trial: None,
            former: None,
            event: None,
            moved_s: 0.0,
            earth: None,
            lost_strength_ut: None,
            mode: SensorMode::default(),
            tuning,
        }
    }

    /// Whether the same field strength was known to it.
    pub fn belongs_to(&self, known_ut: Option<f64>) -> bool {
        self.known_ut == known_ut
    }

    /// The calibration in force: M, b and |m|; `None` while not even the field's direction is known.
    pub fn calibration(&self) -> Option<Calibration> {
        let filter = self.known()?;
        let (strength_ut, scale) = self.gauge(self.strength_of(filter));
        Calibration::new(filter.soft_iron() * scale, filter.vector(OFFSET), strength_ut).ok()
    }

    /// The filter, or what a start knows so far.
    fn known(&self) -> Option<&Gaussian> {
        self.filter.as_ref().or(self.first.answer.as_ref())
    }

    /// |m|, uT.
    fn strength_of(&self, filter: &Gaussian) -> f64 {
        // where the field points is lost: m is but the latest sample
        self.lost_strength_ut.unwrap_or_else(|| self.earth_ut(filter).0.norm())
    }

    /// The Earth's field (device frame, uT), and what its covariance has beyond that of m.
    fn earth_ut(&self, filter: &Gaussian) -> (Vector3<f64>, Matrix3<f64>) {
        let m = filter.vector(FIELD);
        self.earth.as_ref().map_or_else(|| (m, Matrix3::zeros()), |earth| earth.mixed(&m))
    }

    /// From tr M = 3, where the field is `strength_ut`, to the known strength: that, and the factor of M; what is corrected is
    /// divided by it. Without a known one the gauge stays.
    fn gauge(&self, strength_ut: f64) -> (f64, f64) {
        let strength_ut = strength_ut.max(1.0);
        self.known_ut.map_or((strength_ut, 1.0), |known_ut| (known_ut, strength_ut / known_ut))
    }

    /// Bias (rad/s) and scale error of the gyroscope, 0 while nothing is known.
    pub fn gyroscope(&self) -> (Vector3<f64>, Matrix3<f64>) {
        self.filter.as_ref().map_or_else(|| self.first.gyroscope(), |it| (it.vector(BIAS), it.parts().scale))
    }

    /// Whether what the gyroscope reads explains nothing.
    pub fn is_gyroscope_useless(&self) -> bool {
        self.adaptation.useless
    }

    /// Covariance of the calibration, order b_x b_y b_z m_xx m_yy m_zz m_xy m_xz m_yz (uT and dimensionless).
    pub fn covariance(&self) -> Option<SMatrix<f64, 9, 9>> {
        let filter = self.known()?;
        let p = filter.calibration_block();
        let s = strength::strength_covariance(filter, self.lost_strength_ut.is_some(), self.tuning.adopt_sd_ut);
        Some(self.regauged(p, s, &filter.soft_iron(), self.strength_of(filter)))
    }

    /// The covariance `p` of (b, e) as that of (b, M k), k = |m| / known: d(M k) = k dM + M d|m| / known. `s` has the covariance
    /// of (b, e) with |m|, and the variance of |m|.
    fn regauged(
        &self,
        p: SMatrix<f64, 9, 9>,
        s: (SVector<f64, 9>, f64),
        soft_iron: &Matrix3<f64>,
        strength_ut: f64,
    ) -> SMatrix<f64, 9, 9> {
        let Some(known_ut) = self.known_ut else { return p };
        let (_, scale) = self.gauge(strength_ut);
        let m = soft_iron / known_ut;
        let g = SVector::from([0.0, 0.0, 0.0, m.m11, m.m22, m.m33, m.m12, m.m13, m.m23]);
        let d = SVector::<f64, 9>::from_fn(|i, _| if i < 3 { 1.0 } else { scale });
        let cross = d.component_mul(&s.0) * g.transpose();
        p.component_mul(&(d * d.transpose())) + cross + cross.transpose() + g * g.transpose() * s.1
    }

    /// One magnetometer sample (uT, device frame) with the inertial state paired to its time.
    ///
    /// The compensator has checked the sample: it is finite, and later than the one before.
    pub fn push(&mut self, time_ns: i64, raw_ut: Vector3<f64>, inertial: &PairedInertial) -> AidedOutput {
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
}
