//! What is published after a sample: c, f, their uncertainties (equations in `output`), and the status.

use nalgebra::{Matrix3, Vector3};

use super::events::Phase;
use super::output::calibration_covariance;
use super::state::{DELAY, FIELD, Gaussian, OFFSET};
use super::step::Step;
use super::strength::impossible_field;
use super::{Aided, AidedOutput};
use crate::reading::{HoldReason, Missing, Status};

/// Magnetometer noise assumed at most without a rotation: one-step increments mean nothing then, uT.
const HELD_NOISE_UT: f64 = 2.0;

impl Aided {
    /// An answer that says nothing but its status.
    pub(super) fn blank(&self, time_ns: i64, status: Status) -> AidedOutput {
        AidedOutput {
            time_ns,
            corrected_ut: None,
            corrected_covariance_ut2: Matrix3::zeros(),
            filtered_ut: None,
            filtered_covariance_ut2: Matrix3::zeros(),
            up: None,
            tilt_rad2: None,
            status,
            event: self.event,
            mode: self.mode,
        }
    }

    pub(super) fn published(&self, step: &Step<'_>, filter: &Gaussian) -> AidedOutput {
        let mut output = self.blank(step.time_ns, self.status(filter));
        output.up = self.motion.up;
        output.tilt_rad2 = Some(self.motion.tilt_rad2(&self.tuning));
        let Some(w) = filter.soft_iron().try_inverse() else { return output };
        let rate = filter.true_rate(step.rate_rad_s);
        let still = w * (step.raw_ut - filter.vector(OFFSET));
        let delay_s = filter.x[DELAY];
        let c = still - rate.cross(&still) * delay_s.max(0.0);
        let (m, elsewhere) = self.earth_ut(filter);
        let f = m + rate.cross(&m) * delay_s.min(0.0);
        let swing = rate.cross(&f);
        let timing = swing * swing.transpose() * filter.p[(DELAY, DELAY)];
        let floor = self.adaptation.floor_ut2(&self.tuning);
        let noise = w * w.transpose() * self.adaptation.sigma_ut().powi(2);
        let mut unseen = self.adaptation.local_ut2(noise.trace() / 3.0) + floor;
        if self.trial.is_some() {
            // undecided: c is wrong by the step if it is the device's
            unseen += self.watch.misfit_ut.powi(2) / 3.0;
        }
        let p_c =
            calibration_covariance(&filter.calibration_block(), &w, &f) + noise + Matrix3::identity() * unseen + timing;
        // the accelerometer and the body of the phone may be off the magnetometer's axes as the gyroscope's are
        let frames = (Matrix3::identity() * f.norm_squared() - f * f.transpose()) * self.tuning.axes_sd.powi(2);
        let p_f = filter.block(FIELD, FIELD) + elsewhere + Matrix3::identity() * floor + frames + timing;
        if !c.iter().chain(f.iter()).chain(p_c.iter()).chain(p_f.iter()).all(|v| v.is_finite()) {
            return output;
        }
        let (_, scale) = self.gauge(m.norm());
        output.corrected_ut = Some(c / scale);
        output.filtered_ut = Some(f / scale);
        output.corrected_covariance_ut2 = p_c / (scale * scale);
        output.filtered_covariance_ut2 = p_f / (scale * scale);
        output
    }

    fn status(&self, filter: &Gaussian) -> Status {
        let impossible = impossible_field(filter);
        if self.filter.is_none() && self.first.answer.is_some() {
            return Status::Collecting(self.first.missing());
        }
        if let Some(trial) = &self.trial {
            let since_ns = trial.onset_ns;
            return match trial.phase {
                Phase::Place => Status::Disturbed { since_ns },
                Phase::Undecided => Status::Suspect { since_ns },
            };
        }
        if let Some(earth) = self.earth.as_ref().filter(|earth| earth.is_elsewhere()) {
            return Status::Disturbed { since_ns: earth.since_ns };
        }
        if let Some(error) = impossible {
            Status::Held(HoldReason::FitRefused(error))
        } else if self.motion.at_rest() {
            Status::Held(HoldReason::AtRest)
        } else if self.motion.lately_rad_s < self.tuning.rest_rate_rad_s {
            Status::Held(HoldReason::TooLittleRotation)
        } else {
            Status::Tracking
        }
    }

    /// What is published without a usable rotation: the sample, corrected by the calibration that is kept.
    pub(super) fn held(&self, time_ns: i64, raw_ut: &Vector3<f64>) -> AidedOutput {
        let kept = self.known();
        let status = kept.map_or(Status::Collecting(Missing::Directions), |_| Status::Held(HoldReason::NoGyroscope));
        let mut output = self.blank(time_ns, status);
        output.up = self.motion.up;
        let Some((filter, w)) = kept.and_then(|filter| Some((filter, filter.soft_iron().try_inverse()?))) else {
            return output;
        };
        let c = w * (raw_ut - filter.vector(OFFSET));
        let noise = w * w.transpose() * self.adaptation.sigma_ut().min(HELD_NOISE_UT).powi(2);
        let floor = Matrix3::identity() * self.adaptation.floor_ut2(&self.tuning);
        let p_c = calibration_covariance(&filter.calibration_block(), &w, &c) + noise + floor;
        if c.iter().chain(p_c.iter()).all(|v| v.is_finite()) {
            let (_, scale) = self.gauge(self.strength_of(filter));
            output.corrected_ut = Some(c / scale);
            output.corrected_covariance_ut2 = p_c / (scale * scale);
        }
        output
    }
}
