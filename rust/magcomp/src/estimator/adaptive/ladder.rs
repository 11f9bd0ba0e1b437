//! What may have happened, as priors: the hypotheses that compete after a start and after a change.
//!
//! Soft iron: M = I + e with a deviation of e of 6 to 15 % in phones' raw sensors. The field strength is known to be 22 to
//! 67 uT (the Earth's), or as given. beta: a sample lies within about one field strength of b, whatever b is; so before
//! anything is known b is normal about the first sample.
//! After a change the parameters are what they were, plus a jump. How large and in which of them is for the evidence
//! to say: b alone, b and the diagonal, all nine, or back to a former calibration.

use super::hypothesis::Gaussian;
use super::parameters::{Matrix9, Vector9};
use crate::reading::ModelOrder;
use nalgebra::Vector3;

/// A jump: standard deviations of T's scale as a whole, its diagonal, its off-diagonal, beta (units); log prior, and the same
/// for what is told.
pub(super) struct Jump {
    pub order: ModelOrder,
    pub scale: f64,
    pub diagonal: f64,
    pub off_diagonal: f64,
    pub centre: f64,
    pub log_prior: f64,
    pub log_told: f64,
}

const fn jump(
    order: ModelOrder,
    [scale, diagonal, off_diagonal, centre]: [f64; 4],
    [log_prior, log_told]: [f64; 2],
) -> Jump {
    Jump { order, scale, diagonal, off_diagonal, centre, log_prior, log_told }
}

/// The jumps that compete. b rarely moves by more than a field strength: of two places on either side of an arc the near one
/// is the likelier. The largest are the paper's steps of all nine parameters by 50 %, which no phone's soft iron does.
/// The first samples after a change show one component in three of it. Where that is small, the change is either small or lies
/// across; what is released takes the one to be as likely as the other. But what is noticed in a phone (a cover, a charger) is
/// mostly tens of uT: how sure a heading is goes by that, the second column.
pub(super) const JUMPS: [Jump; 12] = [
    jump(ModelOrder::Nothing, [0.0, 1e-4, 1e-4, 1e-4], [0.0, 0.0]),
    jump(ModelOrder::HardIron, [0.0, 1e-3, 1e-3, 0.03], [-2.0, -8.0]),
    jump(ModelOrder::HardIron, [0.0, 1e-3, 1e-3, 0.1], [-2.0, -6.0]),
    jump(ModelOrder::HardIron, [0.0, 1e-3, 1e-3, 0.35], [-2.0, -2.0]),
    jump(ModelOrder::HardIron, [0.0, 1e-3, 1e-3, 1.2], [-4.0, -1.0]),
    jump(ModelOrder::Diagonal, [0.0, 0.08, 5e-3, 0.1], [-3.0, -7.0]),
    jump(ModelOrder::Diagonal, [0.0, 0.08, 5e-3, 0.5], [-3.0, -3.0]),
    jump(ModelOrder::All, [0.0, 0.03, 0.02, 0.1], [-3.0, -7.0]),
    jump(ModelOrder::All, [0.0, 0.08, 0.05, 0.4], [-3.0, -3.0]),
    jump(ModelOrder::All, [0.35, 0.03, 0.02, 0.5], [-5.0, -5.0]),
    jump(ModelOrder::All, [0.0, 0.4, 0.15, 0.6], [-7.0, -7.0]),
    jump(ModelOrder::All, [0.0, 0.4, 0.15, 3.0], [-9.0, -9.0]),
];
/// Those of them that are wide enough for a flat arc of samples to leave two places for b.
pub(super) const TWINNED: [usize; 4] = [3, 4, 6, 8];
/// The same of the hypotheses before anything is known.
pub(super) const TWINNED_COLD: [usize; 3] = [1, 2, 3];
/// Log prior of the return of a former calibration.
pub(super) const LOG_PRIOR_FORMER: f64 = -1.0;
/// Standard deviations of the deviation of M from a multiple of I before anything is known, and their log priors.
const COLD: [(f64, f64); 3] = [(0.03, -1.0), (0.1, -1.0), (0.3, -3.0)];
/// A sensor that is already calibrated: how far M is from I and b from 0 (uT) then.
const CALIBRATED: (f64, f64) = (0.01, 1.0);
const LOG_PRIOR_CALIBRATED: f64 = -1.0;
/// Standard deviation of the logarithm of the field strength: two of them from 38 uT reach 22 and 67.
const LOG_STRENGTH: f64 = 0.28;
/// The same where the strength is given: the model's error indoors.
const LOG_KNOWN_STRENGTH: f64 = 0.05;
/// How far a calibration given at the start is trusted: T, b (uT).
const GIVEN: (f64, f64) = (0.005, 2.0);
/// Log prior of the hypotheses that ignore a given calibration.
pub(super) const LOG_PRIOR_IGNORED: f64 = -8.0;

impl Jump {
    /// What was known, after this jump.
    pub fn after(&self, known: &Gaussian) -> Gaussian {
        let mut covariance = known.covariance;
        for i in 0..6 {
            for j in 0..6 {
                covariance[(i, j)] += self.scale * self.scale * known.mean[i] * known.mean[j];
            }
        }
        for (i, sd) in [(0, self.diagonal), (3, self.off_diagonal), (6, self.centre)] {
            (i..i + 3).for_each(|k| covariance[(k, k)] += sd * sd);
        }
        Gaussian { mean: known.mean, covariance }
    }
}

/// N(T = k I, ...): a common scale and a deviation from it that looks the same in every frame (Frobenius norm).
fn near_identity(scale: f64, scale_sd: f64, deviation: f64, centre: Vector3<f64>, centre_sd: f64) -> Gaussian {
    let mut mean = Vector9::zeros();
    let mut covariance = Matrix9::zeros();
    for i in 0..3 {
        mean[i] = scale;
        mean[6 + i] = centre[i];
        for j in 0..3 {
            let share = if i == j { 2.0 / 3.0 } else { -1.0 / 3.0 };
            covariance[(i, j)] = (scale * scale_sd).powi(2) + (scale * deviation).powi(2) * share;
        }
        covariance[(i, i)] += 1e-8;
        covariance[(3 + i, 3 + i)] = 0.5 * (scale * deviation).powi(2) + 1e-8;
        covariance[(6 + i, 6 + i)] = centre_sd * centre_sd;
    }
    Gaussian { mean, covariance }
}

/// What a first sample at `first_ut` allows, in units about it: order, prior, log prior.
pub(super) fn cold(
    first_ut: &Vector3<f64>,
    unit_ut: f64,
    strength_known: bool,
) -> [(ModelOrder, Gaussian, f64); 1 + COLD.len()] {
    let scale_sd = if strength_known { LOG_KNOWN_STRENGTH } else { LOG_STRENGTH };
    let [a, b, c] = COLD.map(|(deviation, log_prior)| {
        (ModelOrder::All, near_identity(1.0, scale_sd, deviation, Vector3::zeros(), 1.0), log_prior)
    });
    let (deviation, offset_ut) = CALIBRATED;
    let calibrated = near_identity(1.0, scale_sd, deviation, -first_ut / unit_ut, offset_ut / unit_ut);
    [(ModelOrder::Nothing, calibrated, LOG_PRIOR_CALIBRATED), a, b, c]
}

/// A calibration to begin with, in these coordinates.
pub(super) fn given(tau: &Vector9, unit_ut: f64) -> Gaussian {
    let known = near_identity(1.0, GIVEN.0, GIVEN.0, Vector3::zeros(), GIVEN.1 / unit_ut);
    Gaussian { mean: *tau, covariance: known.covariance }
}
