//! The nine parameters of h_m = M h + b (eq. 8) in the paper's units, |h| = 1, and the named sets of the experiments.

use clap::{Args, ValueEnum};
use magcomp::nalgebra::{Matrix3, Vector3};
use magcomp::{Calibration, Disturbance, FactoryErrors};
use magcomp_replay::command::as_typed;
use magcomp_replay::error::RunError;
use std::str::FromStr;

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
    pub fn none() -> Self {
        Self { soft_iron: Matrix3::identity(), hard_iron: Vector3::zeros() }
    }

    /// From theta = [Mxx, Myy, Mzz, Mxy, Mxz, Myz, bx, by, bz].
    pub fn from_theta(t: [f64; 9]) -> Self {
        Self {
            soft_iron: Matrix3::new(t[0], t[3], t[4], t[3], t[1], t[5], t[4], t[5], t[2]),
            hard_iron: Vector3::new(t[6], t[7], t[8]),
        }
    }

    /// theta = [Mxx, Myy, Mzz, Mxy, Mxz, Myz, bx, by, bz].
    pub fn theta(&self) -> [f64; 9] {
        let (m, b) = (&self.soft_iron, &self.hard_iron);
        [m.m11, m.m22, m.m33, m.m12, m.m13, m.m23, b.x, b.y, b.z]
    }

    /// The parameters of a calibration.
    pub fn of(calibration: &Calibration) -> Self {
        Self {
            soft_iron: *calibration.soft_iron(),
            hard_iron: calibration.hard_iron_ut() / calibration.field_strength_ut(),
        }
    }

    /// All nine times `factor`: the paper's step is 1.5.
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
    pub fn parameters(self) -> Parameters {
        Parameters::from_theta(match self {
            Self::Ref => [1.05, 0.95, 1.00, 0.06, -0.05, 0.08, 0.30, -0.20, 1.32],
            Self::Mid => [1.05, 0.95, 1.00, 0.06, -0.05, 0.08, 0.30, -0.30, 0.40],
            Self::Small => [1.05, 0.95, 1.00, 0.02, -0.02, 0.02, 0.02, -0.02, 0.02],
        })
    }
}

/// The true parameters of a simulation: a named set, or own ones, where |h| = 1. With S, C and b_0 the sensor itself errs too:
/// M = S C A and b = S C b_m + b_0, brought to the symmetric M of the same ellipsoid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Args)]
pub struct TrueParameters {
    /// True parameters: a named set
    #[arg(long, value_enum)]
    pub set: Option<ParameterSet>,
    /// Own soft iron instead of the set's: M, or A where --scale or --axes is given
    #[arg(long, value_name = "XX,YY,ZZ,XY,XZ,YZ", allow_hyphen_values = true)]
    pub soft_iron: Option<Numbers<6>>,
    /// Own hard iron instead of the set's, field strengths: b, or b_m where --scale, --axes or --offset is given
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub hard_iron: Option<Numbers<3>>,
    /// Scale factors S of the sensor
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub scale: Option<Numbers<3>>,
    /// Attitudes e_x, e_y, e_z of the sensing axes; C is the inverse of the matrix whose columns they are
    #[arg(long, value_name = "EX,EX,EX,EY,...", allow_hyphen_values = true)]
    pub axes: Option<Numbers<9>>,
    /// Offsets b_0 of the bridges, field strengths
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub offset: Option<Numbers<3>>,
}

impl TrueParameters {
    /// Whether some are the user's own numbers.
    pub fn are_own(&self) -> bool {
        self.soft_iron.is_some() || self.hard_iron.is_some() || self.has_factory_errors()
    }

    fn has_factory_errors(&self) -> bool {
        self.scale.is_some() || self.axes.is_some() || self.offset.is_some()
    }

    /// Their name, for titles.
    pub fn name(&self, usual: ParameterSet) -> String {
        let set = as_typed(&self.set.unwrap_or(usual)).to_uppercase();
        if self.are_own() { "own parameters".to_owned() } else { format!("set {set}") }
    }

    /// The parameters; of `usual` where none are given.
    pub fn parameters(&self, usual: ParameterSet) -> Result<Parameters, RunError> {
        let Parameters { mut soft_iron, mut hard_iron } = self.set.unwrap_or(usual).parameters();
        if !self.are_own() {
            return Ok(Parameters { soft_iron, hard_iron });
        }
        if let Some(Numbers([xx, yy, zz, xy, xz, yz])) = self.soft_iron {
            soft_iron = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        }
        if let Some(b) = self.hard_iron {
            hard_iron = b.vector();
        }
        let composed = || {
            let factory = FactoryErrors {
                scale: self.scale.map_or(Vector3::repeat(1.0), |scale| scale.vector()),
                axes: self.axes.map_or(Matrix3::identity(), |axes| Matrix3::from_column_slice(&axes.0)),
                offset_ut: self.offset.map_or(Vector3::zeros(), |offset| offset.vector()),
            };
            let (m, b) = factory.compose(&Disturbance { soft_iron, hard_iron_ut: hard_iron })?;
            // the strength of the field is the unit here
            Calibration::from_any(m, b, 1.0)
        };
        let (calibration, _) = composed().map_err(|why| RunError::Usage(format!("the true parameters: {why}")))?;
        Ok(Parameters::of(&calibration))
    }
}

/// Numbers separated by commas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Numbers<const N: usize>(pub [f64; N]);

impl Numbers<3> {
    /// As a vector.
    pub fn vector(self) -> Vector3<f64> {
        Vector3::from(self.0)
    }
}

impl<const N: usize> FromStr for Numbers<N> {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let values: Option<Vec<f64>> =
            text.split(',').map(|v| v.trim().parse().ok().filter(|v: &f64| v.is_finite())).collect();
        let values = values.and_then(|values| values.try_into().ok());
        values.map(Self).ok_or_else(|| format!("expected {N} numbers separated by commas"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn own_parameters_are_composed_as_the_paper_says() {
        let usual = |own: TrueParameters| own.parameters(ParameterSet::Ref);
        assert_eq!(usual(TrueParameters::default()).unwrap(), ParameterSet::Ref.parameters());
        let own = TrueParameters {
            soft_iron: Some("1.2,0.9,1,0.1,0,0".parse().unwrap()),
            hard_iron: Some("1,2,3".parse().unwrap()),
            ..TrueParameters::default()
        };
        let found = usual(own).unwrap().theta();
        for (found, expected) in found.iter().zip([1.2, 0.9, 1.0, 0.1, 0.0, 0.0, 1.0, 2.0, 3.0]) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
        // S = 2 I and axes turned by 90 degrees about z: C turns b_m back, b = 2 C b_m + b_0, and M is 2 I
        let factory = TrueParameters {
            soft_iron: Some("1,1,1,0,0,0".parse().unwrap()),
            scale: Some("2,2,2".parse().unwrap()),
            axes: Some("0,1,0,-1,0,0,0,0,1".parse().unwrap()),
            offset: Some("0,0,0.5".parse().unwrap()),
            ..own
        };
        let found = usual(factory).unwrap().theta();
        for (found, expected) in found.iter().zip([2.0, 2.0, 2.0, 0.0, 0.0, 0.0, 4.0, -2.0, 6.5]) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
        let flat = TrueParameters { axes: Some("1,0,0,0,1,0,1,1,0".parse().unwrap()), ..factory };
        assert!(matches!(usual(flat), Err(RunError::Usage(_))));
        assert!("1,2".parse::<Numbers<3>>().is_err() && "1,2,nan".parse::<Numbers<3>>().is_err());
    }

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
