//! What is published after a sample: the corrected sample c, the carried field f, how sure they are, and the status.
//!
//! ```text
//! c = exp(-[(tau + age) w]x) W (raw - b),  W = M^-1,   f = m          at the gyroscope's time
//! P_c = W [I D(h)] P_(b,e) [I D(h)]^T W^T + sigma^2 W W^T + (L^2 + F^2) I + A P_kk A^T + timing      (+ |v|^2/3 I while undecided)
//! P_f = rho P_mm + G^2 I + A P_kk A^T + A P_km + P_mk A^T + timing + w s^2 I + w (1 - w) (h - m)(h - m)^T
//! timing = P_tau (w x h)(w x h)^T,   A = -[f]x
//! ```
//! k: the misalignment, by which all of them are turned to the device's axes. L, F, rho and G: `adapt`. w, h and s belong to a new place (`earth`);
//! elsewhere f is m; age is how long the sample has waited for the gyroscope.

#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::{Matrix3, Vector3};

use super::Aided;
use super::phase::Phase;
use super::state::{CALIBRATION, DELAY, FIELD, Filter};
use super::step::Step;
use crate::calibration::calibration_covariance;
use crate::estimator::answer::Answer;
use crate::math::gaussian::Gaussian;
use crate::math::turn::Turn;
use crate::reading::{HoldReason, Missing, Status};
use crate::strength::EARTH_UT;

impl Aided {
    /// What is published after a sample with a rotation, nothing where c or f has no value. Their covariances are those of the latest frame.
    #[inline(always)]
    pub(super) fn publish(&mut self, step: &Step, answer: &mut Answer) {
        let Some(filter) = self.phase.known() else { return };
        let x = filter.parts();
        let Some((w, still)) = x.corrected(&step.raw_ut) else { return };
        let late_rad = x.true_rate(&step.delayed_rad_s) * (x.delay + step.late_s);
        let c = Turn::by(&-late_rad).rotation * still;
        let f = self.earth_ut(filter);
        if self.frame.is_empty() || self.covariances.is_none() {
            self.covariances = Some(self.covariance_ut2(step, filter, &w, &f));
        }
        let Some([p_c, p_f]) = self.covariances else { return };
        let (c, f) = (Gaussian { mean: c, covariance: p_c }, Gaussian { covariance: p_f, ..f });
        if !self.answer(filter, c, Some(f), answer) {
            return;
        }
        let field_rad2 = p_f.trace() / 3.0 / filter.part(FIELD).norm_squared();
        answer.common_rad2 = self.senses.motion.common_rad2(field_rad2, &self.tuning);
        answer.tilt_rad2 = Some(self.senses.motion.tilt_rad2(answer.common_rad2, &self.tuning));
    }

    /// P_c and P_f, uT^2.
    fn covariance_ut2(&self, step: &Step, filter: &Filter, w: &Matrix3<f64>, f: &Gaussian<3>) -> [Matrix3<f64>; 2] {
        let Gaussian { mean: f, covariance: elsewhere } = f;
        let swing = filter.parts().true_rate(&step.rate_rad_s).cross(f);
        let timing = swing * swing.transpose() * filter.own(DELAY).x;
        let floor = self.adaptation.floor_ut2(&self.tuning);
        let noise = w * w.transpose() * self.senses.white.sigma_ut().powi(2);
        // what c and f differ by is learned from frames
        let of_means_ut2 = (w * w.transpose()).trace() / 3.0 * self.adaptation.mean.sigma_ut().powi(2);
        let mut unseen = self.adaptation.local_ut2(of_means_ut2, &self.tuning) + floor;
        if let Phase::Undecided(running, _) = &self.phase {
            // c is wrong by the step if it is the device's
            unseen += running.watch.misfit_ut.powi(2) / 3.0;
        }
        let p_c = calibration_covariance(&CALIBRATION.view(&filter.covariance), w, f)
            + noise
            + Matrix3::identity() * unseen
            + timing;
        // an error k of the misalignment turns c and f by k x f
        let (turned, with_field) = filter.misalignment_covariance();
        let across = -f.cross_matrix();
        let misaligned = across * turned * across.transpose();
        let with_field = across * with_field;
        // f is a long average: what the place does beyond the model widens P_mm by as much as its density is larger
        let known = filter.own(FIELD) * self.adaptation.factor(&step.noise, step.dt_s, &self.tuning);
        let followed = Matrix3::identity() * self.adaptation.unaveraged_ut2(&self.tuning);
        let p_f = known + elsewhere + followed + misaligned + with_field + with_field.transpose() + timing;
        [p_c + misaligned, p_f].map(|p| self.to_device * p * self.to_device.transpose())
    }

    /// What is published without a usable rotation: the sample, corrected by the calibration that is kept.
    pub(super) fn held(&self, raw_ut: &Vector3<f64>) -> (Status, Answer) {
        let Some(filter) = self.phase.known() else {
            return (Status::Collecting(Missing::Directions), Answer::default());
        };
        let mut answer = Answer::default();
        if let Some((w, c)) = filter.parts().corrected(raw_ut) {
            // one-step increments mean nothing without a rotation: no more noise than at the start
            let sigma_ut = self.senses.white.sigma_ut().min(self.tuning.noise_start_ut);
            let noise = w * w.transpose() * sigma_ut.powi(2);
            let floor = Matrix3::identity() * self.adaptation.floor_ut2(&self.tuning);
            let p_c = calibration_covariance(&CALIBRATION.view(&filter.covariance), &w, &c) + noise + floor;
            let p_c = self.to_device * p_c * self.to_device.transpose();
            self.answer(filter, Gaussian { mean: c, covariance: p_c }, None, &mut answer);
        }
        (Status::Held(HoldReason::NoGyroscope), answer)
    }

    /// c, and f if it is known (uT), in the gauge of the known strength; whether they are finite: else nothing is answered.
    #[inline(always)]
    fn answer(&self, filter: &Filter, c: Gaussian<3>, f: Option<Gaussian<3>>, answer: &mut Answer) -> bool {
        if !c.is_finite() || !f.iter().all(Gaussian::is_finite) {
            return false;
        }
        let scale = self.scale(filter);
        let gauged = |it: Gaussian<3>| match self.known_ut {
            Some(_) => (it.mean / scale, it.covariance / (scale * scale)),
            None => (it.mean, it.covariance),
        };
        (answer.field_ut, answer.field_covariance_ut2) = Some(gauged(c)).unzip();
        (answer.filtered_field_ut, answer.filtered_covariance_ut2) = f.map(gauged).unzip();
        true
    }

    /// The status after a sample with a rotation.
    pub(super) fn status(&self) -> Status {
        let at_rest = self.senses.motion.at_rest();
        match &self.phase {
            // what was given is in force until the samples of a start know more
            Phase::Starting(first) if first.given.is_none() => Status::Collecting(first.missing()),
            Phase::Starting(_) if at_rest => Status::Held(HoldReason::AtRest),
            Phase::Starting(_) => Status::Held(HoldReason::TooLittleRotation),
            Phase::Undecided(_, trial) if trial.is_place() => Status::Disturbed { since_ns: trial.onset_ns },
            Phase::Undecided(_, trial) => Status::Suspect { since_ns: trial.onset_ns },
            Phase::Running(running, _) => {
                if let Some(earth) = running.earth.as_ref().filter(|earth| earth.probability > 0.5) {
                    Status::Disturbed { since_ns: earth.since_ns }
                } else if let Some(error) = running.filter.impossible_field(&EARTH_UT) {
                    Status::Held(HoldReason::FitRefused(error))
                } else if at_rest {
                    Status::Held(HoldReason::AtRest)
                } else if self.senses.motion.lately_rad_s < self.tuning.bias_sd_rad_s {
                    Status::Held(HoldReason::TooLittleRotation)
                } else {
                    Status::Tracking
                }
            }
        }
    }
}
