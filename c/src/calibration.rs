//! `magcomp_calibration`.

use crate::error::Failure;
use crate::grows::Grows;
use magcomp_core::nalgebra::{Matrix3, Vector3};
use std::mem::offset_of;

/// h_m = M h + b: what a magnetometer reads, h_m, of the Earth's field h.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct Calibration {
    /// sizeof(magcomp_calibration).
    pub size: usize,
    /// Soft iron M, no unit, row by row: symmetric, positive definite, no element of it or of its inverse beyond +-1000.
    pub soft_iron: [f64; 9],
    /// Hard iron b, uT, -100000 to 100000.
    pub hard_iron_ut: [f64; 3],
    /// |h|, uT, 1 to 1000.
    pub field_strength_ut: f64,
}

// SAFETY: it is as the trait asks
unsafe impl Grows for Calibration {
    const NAME: &str = "magcomp_calibration";
    const FIRST: usize = offset_of!(Self, field_strength_ut) + size_of::<f64>();
}

impl Calibration {
    pub(crate) fn checked(&self) -> Result<magcomp_core::Calibration, Failure> {
        let Self { size: _, soft_iron, hard_iron_ut, field_strength_ut } = *self;
        let m = Matrix3::from_row_slice(&soft_iron);
        Ok(magcomp_core::Calibration::new(m, Vector3::from(hard_iron_ut), field_strength_ut)?)
    }
}

impl From<magcomp_core::Calibration> for Calibration {
    fn from(calibration: magcomp_core::Calibration) -> Self {
        let m = calibration.soft_iron();
        Self {
            size: size_of::<Self>(),
            soft_iron: std::array::from_fn(|k| m[(k / 3, k % 3)]),
            hard_iron_ut: (*calibration.hard_iron_ut()).into(),
            field_strength_ut: calibration.field_strength_ut(),
        }
    }
}
