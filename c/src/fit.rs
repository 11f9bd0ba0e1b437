//! One ellipsoid fit, and covariances as numbers.

use crate::calibration::Calibration;
use crate::compensator::{Compensator, TURN, code, with};
use crate::error::{Error, Failure, caught};
use crate::grows::{Grows, fill, room};
use crate::status::FitProblem;
use magcomp_core::nalgebra::{SMatrix, Vector3};
use magcomp_core::{EllipsoidFit, FitOptions};
use std::mem::offset_of;

/// How sure a fit is.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct Fit {
    /// sizeof(magcomp_fit).
    pub size: usize,
    /// Of b_x b_y b_z (uT), m_xx m_yy m_zz m_xy m_xz m_yz (no unit), row by row.
    pub covariance: [f64; 81],
    /// Root mean square distance of the samples from the ellipsoid, uT.
    pub residual_rms_ut: f64,
    /// Expected direction error over all directions, deg.
    pub direction_sigma_deg: f64,
    /// Why there is no fit. None where there is one.
    pub problem: FitProblem,
}

// SAFETY: it is as the trait asks
unsafe impl Grows for Fit {
    const NAME: &str = "magcomp_fit";
    const FIRST: usize = offset_of!(Self, problem) + size_of::<FitProblem>();
}

fn row_by_row(covariance: &SMatrix<f64, 9, 9>) -> [f64; 81] {
    std::array::from_fn(|k| covariance[(k / 9, k % 9)])
}

impl Fit {
    fn of(fit: &EllipsoidFit) -> Self {
        let EllipsoidFit { covariance, residual_rms_ut, direction_sigma_deg, .. } = *fit;
        Self {
            size: size_of::<Self>(),
            covariance: row_by_row(&covariance),
            residual_rms_ut,
            direction_sigma_deg,
            problem: FitProblem::None,
        }
    }

    fn none(problem: FitProblem) -> Self {
        let (covariance, nan) = ([f64::NAN; 81], f64::NAN);
        Self { size: size_of::<Self>(), covariance, residual_rms_ut: nan, direction_sigma_deg: nan, problem }
    }
}

/// One fit of raw samples of a turned device, as a compensator's first: `points_ut` are `count` times three numbers, uT, in any order. `field_strength_ut` is
/// |h| where it is known, 1 to 1000, else NaN. Fills `calibration` and, where it is not null, `fit`, whose sizes are set.
///
/// Errors: NULL_POINTER (`points_ut`, `calibration`); SIZE; CONFIG (`field_strength_ut`); FIT: `fit` says which problem, `calibration` is as it was. The message is this thread's:
/// magcomp_compensator_last_error(NULL).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn magcomp_fit_ellipsoid(
    points_ut: *const f64,
    count: usize,
    field_strength_ut: f64,
    calibration: *mut Calibration,
    fit: *mut Fit,
) -> Error {
    let action = || {
        if points_ut.is_null() {
            return Err(Failure::null("points_ut"));
        }
        // SAFETY: null, or the caller's
        let for_calibration = unsafe { room(calibration) }?;
        // SAFETY: null, or the caller's
        let for_fit = (!fit.is_null()).then(|| unsafe { room(fit) }).transpose()?;
        let tell = |answer: Fit| {
            if let Some(for_fit) = for_fit {
                // SAFETY: there is as much room
                unsafe { fill(fit, for_fit, answer) };
            }
        };
        if !(field_strength_ut.is_nan() || (1.0..=1000.0).contains(&field_strength_ut)) {
            return Err(Failure::config(format!(
                "field_strength_ut is {field_strength_ut:?}, expected 1 to 1000 uT, or NaN"
            )));
        }
        // SAFETY: the caller's, and not null
        let points = unsafe { std::slice::from_raw_parts(points_ut.cast::<[f64; 3]>(), count) };
        let points: Vec<Vector3<f64>> = points.iter().map(|point| Vector3::from(*point)).collect();
        let field_strength_ut = Some(field_strength_ut).filter(|it| !it.is_nan());
        match magcomp_core::fit_ellipsoid(&points, &FitOptions { field_strength_ut, ..FitOptions::default() }) {
            Ok(found) => {
                tell(Fit::of(&found));
                // SAFETY: there is as much room
                unsafe { fill(calibration, for_calibration, Calibration::from(found.calibration)) };
                Ok(())
            }
            Err(error) => {
                tell(Fit::none(FitProblem::from(error)));
                Err(Failure { code: Error::Fit, why: error.to_string() })
            }
        }
    };
    code(None, caught(action))
}

/// How sure M and b in force are: the covariance of b_x b_y b_z (uT), m_xx m_yy m_zz m_xy m_xz m_yz (no unit), 9 rows of 9 numbers, into `covariance`, which
/// has room for 81.
///
/// Errors: NULL_POINTER (both); NOTHING_YET.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn magcomp_compensator_covariance(
    compensator: *const Compensator,
    covariance: *mut f64,
) -> Error {
    let action = |core: &mut crate::compensator::Core| {
        if covariance.is_null() {
            return Err(Failure::null("covariance"));
        }
        let own = core.compensator.covariance().ok_or_else(|| Failure::nothing_yet("calibration", TURN))?;
        // SAFETY: the caller's room for 81 numbers
        unsafe { covariance.cast::<[f64; 81]>().write(row_by_row(&own)) };
        Ok(())
    };
    // SAFETY: null, or made by create and not freed
    unsafe { with(compensator, action) }
}
