//! The aided estimator: gyroscope and gravity beside the magnetometer.
//!
//! Three owners. `sense`: what the sensors told of late (`motion` · `recent`: delay · `white`: noise), which makes a `step` of a sample. `phase`: the one filter
//! that follows, a start before it or hypotheses beside it. `changes`: what became of changes, which alone goes from one phase to another while samples
//! do not fit (`events`: hypotheses · `probation`: what has won, until it has held · `quarantine`, `bursts`: magnets that are passed).
//!
//! The filter: `running` · `state` · `propagate` · `measure` · `adapt` (noise, places) · `earth` (in a new place) · `watch` (samples that do not fit). A start:
//! `start` · `first_fit` · `batch` · `groups` · `turned` (over several samples). One sample: `learn`, then `publish`. `explain` is for people. The
//! derivation is in docs/dev/METHOD-AIDED.md.

mod adapt;
mod batch;
mod bursts;
mod changes;
mod earth;
mod events;
mod explain;
mod first_fit;
mod groups;
mod learn;
mod measure;
mod motion;
mod phase;
mod probation;
mod propagate;
mod publish;
mod quarantine;
mod recent;
mod running;
mod sense;
mod start;
mod state;
mod step;
#[cfg(test)]
mod tests;
mod tuning;
mod turned;
mod watch;
mod white;

#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::{Matrix3, SMatrix, Vector3};

use crate::calibration::{Calibration, Given};
use crate::estimator::answer::{Answer, Carry};
use crate::explanation::{InnovationTest, SampleUse};
use crate::math::elementary::hypot;
use crate::math::gaussian::Gaussian;
use crate::math::symmetric::six;
use crate::math::turn::Turn;
use crate::reading::{SensorMode, Status};
use crate::sensing::frame::Frame;
use crate::sensing::pairing::{PairedInertial, Rotation};
use adapt::Adaptation;
use changes::Changes;
use earth::Earth;
use first_fit::FirstFit;
use phase::Phase;
use propagate::ProcessNoise;
use sense::{Senses, Taken};
use state::{BIAS, CALIBRATION, FIELD, FIELD_AND_CALIBRATION, Filter, HARD_IRON};
pub(crate) use tuning::Tuning;

/// The estimator. All state is plain numbers: it can be cloned and compared.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Aided {
    tuning: Tuning,
    senses: Senses,
    phase: Phase,
    /// The strength of the field where it is known, uT.
    known_ut: Option<f64>,
    adaptation: Adaptation,
    frame: Frame,
    /// From the magnetometer's axes to the device's, which gyroscope and accelerometer have.
    to_device: Matrix3<f64>,
    /// Of what was published after the latest frame, c and f, uT^2.
    covariances: Option<[Matrix3<f64>; 2]>,
    changes: Changes,
    /// What became of the latest sample: only told.
    judged: Option<(SampleUse, Option<InnovationTest>)>,
}

impl Aided {
    /// A new estimator that knows nothing but, perhaps, the strength of the field, for a validated config.
    pub fn new(tuning: Tuning, known_ut: Option<f64>) -> Self {
        Self {
            senses: Senses::new(&tuning),
            phase: Phase::Starting(FirstFit::new(known_ut, &tuning)),
            known_ut,
            adaptation: Adaptation::new(&tuning),
            frame: Frame::default(),
            to_device: Matrix3::identity(),
            covariances: None,
            changes: Changes::default(),
            judged: None,
            tuning,
        }
    }

    /// As new, or begins with what is given.
    pub fn restart(&mut self, given: Option<Given>) {
        (self.senses, self.adaptation) = (Senses::new(&self.tuning), Adaptation::new(&self.tuning));
        (self.changes, self.judged) = (Changes::default(), None);
        match given {
            Some(given) => self.begin_from(&given),
            None => self.begin(None),
        }
    }

    /// No sample has come.
    pub fn is_untouched(&self) -> bool {
        self.senses.latest_ns.is_none()
    }

    /// Whether its calibration was found in live samples.
    pub fn has_learned(&self) -> bool {
        self.phase.running().is_some()
    }

    /// Whether the chain of rotations broke not long ago: it is younger than this.
    pub fn broke_within(&self, seconds: f64) -> bool {
        self.senses.broke_within(seconds)
    }

    /// The calibration in force: M, b and |m|; `None` while not even the field's direction is known.
    pub fn calibration(&self) -> Option<Calibration> {
        let filter = self.phase.known()?;
        let strength_ut = self.known_ut.unwrap_or_else(|| self.strength_of(filter));
        Calibration::new(filter.parts().soft_iron() * self.scale(filter), filter.part(HARD_IRON), strength_ut).ok()
    }

    /// Strength of the Earth's field in the filter's gauge, at least 1 uT; that from before, where the chain of rotations broke.
    fn strength_of(&self, filter: &Filter) -> f64 {
        // where the field points is lost: m is but the latest sample
        self.phase.lost_strength_ut().unwrap_or_else(|| self.earth_ut(filter).mean.norm()).max(1.0)
    }

    /// The Earth's field (device frame, uT), and what its covariance has beyond that of m.
    fn earth_ut(&self, filter: &Filter) -> Gaussian<3> {
        Earth::mixed(self.phase.running().and_then(|it| it.earth.as_ref()), &filter.part(FIELD))
    }

    /// From tr M = 3 to the known strength: the factor of M; what is corrected is divided by it. Without a known one the gauge stays.
    fn scale(&self, filter: &Filter) -> f64 {
        self.known_ut.map_or(1.0, |known_ut| self.strength_of(filter) / known_ut)
    }

    /// Bias (rad/s) and scale error of the gyroscope, 0 while nothing is known.
    pub fn gyroscope(&self) -> (Vector3<f64>, Matrix3<f64>) {
        match &self.phase {
            Phase::Starting(first) => first.gyroscope(),
            Phase::Running(it, _) | Phase::Undecided(it, _) => (it.filter.parts().bias, it.filter.parts().axes),
        }
    }

    /// Covariance of the calibration, order b_x b_y b_z m_xx m_yy m_zz m_xy m_xz m_yz (uT and dimensionless).
    pub fn covariance(&self) -> Option<SMatrix<f64, 9, 9>> {
        let filter = self.phase.known()?;
        let Some(known_ut) = self.known_ut else { return Some(filter.own(CALIBRATION)) };
        let mut p = filter.own(FIELD_AND_CALIBRATION);
        let mut along = filter.part(FIELD).cap_magnitude(1.0);
        if self.phase.lost_strength_ut().is_some() {
            // where the field points is not known; how strong it is stays known
            along = Vector3::x();
            FIELD.block_mut(&mut p).fill_diagonal(self.tuning.adopt_sd_ut.powi(2));
        }
        // d(M k) = k dM + M d|m| / known,   k = |m| / known
        let m = filter.parts().soft_iron() / known_ut;
        let mut j = SMatrix::<f64, 9, 12>::zeros();
        j.fixed_view_mut::<6, 3>(3, 0).copy_from(&(six(&m) * along.transpose()));
        j.fixed_view_mut::<3, 3>(0, 3).fill_with_identity();
        j.fixed_view_mut::<6, 6>(3, 6).fill_diagonal(self.scale(filter));
        Some(j * p * j.transpose())
    }

    /// One magnetometer sample (uT, device frame) with the inertial state paired to its time.
    ///
    /// The compensator has checked the sample: it is finite, and later than the one before. The pairing has checked the events: they are
    /// within the ranges of phones' sensors.
    pub fn push(
        &mut self,
        time_ns: i64,
        raw_ut: Vector3<f64>,
        inertial: &PairedInertial,
        answer: &mut Answer,
    ) -> Status {
        self.add(time_ns, raw_ut, inertial, false, answer)
    }

    /// A sample whose field is of no use: what is known of the field turns with the device.
    pub fn carry(&mut self, time_ns: i64, inertial: &PairedInertial) -> Answer {
        // where the chain of rotations breaks, nothing better is known than that the field was there
        let expected_ut = self.phase.known().map_or_else(Vector3::zeros, Filter::expected_ut);
        let mut answer = Answer::default();
        self.add(time_ns, expected_ut, inertial, true, &mut answer);
        // there is no sample that could be corrected
        (answer.field_ut, answer.field_covariance_ut2) = (None, None);
        answer
    }

    /// What may have changed since the sample before.
    fn process_noise(&self, rotation: &Rotation) -> ProcessNoise {
        let tuning = &self.tuning;
        ProcessNoise {
            bridged_rad2: rotation.variance_rad2,
            offset_ut: if tuning.hard_iron_walk { tuning.offset_walk_ut } else { 0.0 },
            local_ut: hypot(self.adaptation.local_ut, self.changes.left_ut2(tuning).sqrt()),
            local_time_s: tuning.place_correlation_s,
        }
    }

    /// A sample, or only its time where it is blank.
    fn add(
        &mut self,
        time_ns: i64,
        raw_ut: Vector3<f64>,
        paired: &PairedInertial,
        is_blank: bool,
        answer: &mut Answer,
    ) -> Status {
        let dt_s = self.senses.next(time_ns);
        // nothing is learned within a frame
        if self.frame.is_empty() {
            let misalignment = self.phase.known().map_or_else(Vector3::zeros, |filter| filter.parts().misalignment());
            self.to_device = Turn::by(&misalignment).rotation;
        }
        // the accelerometer has the gyroscope's axes
        let up = paired.up_m_s2.map(|up| self.to_device.tr_mul(&up));
        let status = if let (Some(rotation), Some(dt_s)) = (&paired.rotation, dt_s) {
            let (taken, noise) = (Taken { time_ns, dt_s, raw_ut, is_blank }, self.process_noise(rotation));
            let step = self.senses.step(&taken, rotation, up, &self.phase, noise, &self.tuning);
            let status = self.with_rotation(&step, answer);
            answer.mode = if up.is_some() { SensorMode::GyroscopeAndGravity } else { SensorMode::GyroscopeOnly };
            let bias_rad2_s2 = self.phase.known().map_or(step.bias_sd_rad_s.powi(2), |filter| {
                // where m follows the place more than the filter expects, the gyroscope's bias is as much less certain
                let published_ut2 =
                    answer.filtered_covariance_ut2.map_or(0.0, |p| p.trace() * self.scale(filter).powi(2));
                filter.variances(BIAS).max() * (published_ut2 / filter.variances(FIELD).sum()).max(1.0)
            });
            let without_field = || {
                self.senses.motion.tilt_rad2(self.senses.motion.common_rad2(f64::INFINITY, &self.tuning), &self.tuning)
            };
            answer.carry = Some(Carry {
                turn: step.turn,
                up: self.senses.motion.up,
                tilt_rad2: answer.tilt_rad2.unwrap_or_else(without_field),
                bias_rad2_s2,
                is_bias_told: self.phase.known().is_some(),
                span_s: dt_s,
                noise_rad2: step.noise.turn_rad2(dt_s),
            });
            status
        } else {
            self.without_rotation(&raw_ut, up, dt_s.unwrap_or(0.0));
            let (status, held) = self.held(&raw_ut);
            *answer = held.without_gyroscope(up);
            status
        };
        (answer.up, answer.event) = (self.senses.motion.up, self.changes.event);
        answer.turn(&self.to_device);
        status
    }
}
