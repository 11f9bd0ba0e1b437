//! The nine parameters of h_m = M h + b (eq. 8) in the paper's units, |h| = 1, and the named sets of the experiments.

use clap::ValueEnum;
use magcomp::Calibration;
use magcomp::nalgebra::{Matrix3, Vector3};

/// Names of the parameters, in the order of [`Parameters::theta`].
pub const NAMES: [&str; 9] = ["M_xx", "M_yy", "M_zz", "M_xy", "M_xz", "M_yz", "b_x", "b_y", "b_z"];

/// The groups in which errors are reported, as ranges of [`NAMES`].
pub const GROUPS: [(&str, std::ops::Range<usize>); 3] = [("M diagonal", 0..3), ("M off-diagonal", 3..6), ("b", 6..9)];

/// M (symmetric) and b, both in units of the field strength: |h| = 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// M, dimensionless, symmetric.
    pub soft_iron: Matrix3<f64>,
    /// b, field strengths.
    pub hard_iron: Vector3<f64>,
}

impl Parameters {
    /// No disturbance: M = I, b = 0.
    #[must_use]
    pub fn none() -> Self {
        Self { soft_iron: Matrix3::identity(), hard_iron: Vector3::zeros() }
    }

    /// From theta = [Mxx, Myy, Mzz, Mxy, Mxz, Myz, bx, by, bz].
    #[must_use]
    pub fn from_theta(t: [f64; 9]) -> Self {
        Self {
            soft_iron: Matrix3::new(t[0], t[3], t[4], t[3], t[1], t[5], t[4], t[5], t[2]),
            hard_iron: Vector3::new(t[6], t[7], t[8]),
        }
    }

    /// theta = [Mxx, Myy, Mzz, Mxy, Mxz, Myz, bx, by, bz].
    #[must_use]
    pub fn theta(&self) -> [f64; 9] {
        let (m, b) = (&self.soft_iron, &self.hard_iron);
        [m.m11, m.m22, m.m33, m.m12, m.m13, m.m23, b.x, b.y, b.z]
    }

    /// The parameters of a calibration.
    #[must_use]
    pub fn of(calibration: &Calibration) -> Self {
        Self {
            soft_iron: *calibration.soft_iron(),
            hard_iron: calibration.hard_iron_ut() / calibration.field_strength_ut(),
        }
    }

    /// All nine times `factor`: the paper's step is 1.5.
    #[must_use]
    pub fn times(&self, factor: f64) -> Self {
        Self { soft_iron: self.soft_iron * factor, hard_iron: self.hard_iron * factor }
    }
}

/// The sets of parameters the experiments start from; the paper does not print its own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum ParameterSet {
    /// The reference: |b| = 1.4, which gives the paper's peaks of 23 and 33 deg when the old parameters are kept
    #[default]
    Ref,
    /// |b| = 0.6
    Mid,
    /// Off-diagonals and b of 0.02, where the paper's 20 % error is just noise
    Small,
}

impl ParameterSet {
    /// The parameters before the step.
    #[must_use]
    pub fn parameters(self) -> Parameters {
        Parameters::from_theta(match self {
            Self::Ref => [1.05, 0.95, 1.00, 0.06, -0.05, 0.08, 0.30, -0.20, 1.32],
            Self::Mid => [1.05, 0.95, 1.00, 0.06, -0.05, 0.08, 0.30, -0.30, 0.40],
            Self::Small => [1.05, 0.95, 1.00, 0.02, -0.02, 0.02, 0.02, -0.02, 0.02],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn theta_goes_there_and_back() {
        let theta = [1.0, 2.0, 3.0, 0.4, 0.5, 0.6, 7.0, 8.0, 9.0];
        assert_eq!(Parameters::from_theta(theta).theta(), theta);
    }

    #[test]
    fn every_set_is_a_calibration() {
        for set in [ParameterSet::Ref, ParameterSet::Mid, ParameterSet::Small] {
            let p = set.parameters();
            let calibration = Calibration::new(p.soft_iron, p.hard_iron * 40.0, 40.0).unwrap();
            for (a, b) in Parameters::of(&calibration).theta().iter().zip(p.theta()) {
                assert!((a - b).abs() < 1e-15);
            }
        }
    }
}
