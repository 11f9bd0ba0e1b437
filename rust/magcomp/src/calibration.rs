//! The error model: h_m = S C (A h + b_m) + b_0 = M h + b (eq. 1 to 8), and its inverse h = M^-1 (h_m - b) (eq. 11).
//!
//! The gauge: raw samples determine M only up to a rotation, since M and M R map the same sphere to the same
//! ellipsoid. A [`Calibration`] holds the symmetric positive definite M; [`Calibration::from_any`] brings any
//! invertible M there by the polar decomposition M = P R and hands back the rotation R it dropped.

use core::ops::Index;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::{Matrix3, Rotation3, SMatrix, Vector3};

/// Why a pair (M, b) is no calibration.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub enum CalibrationError {
    /// A value is NaN or infinite.
    #[error("calibration holds a value that is not finite; check the numbers it was built from")]
    NotFinite,
    /// M has no inverse, or one too large to use.
    #[error(
        "soft iron matrix is singular (smallest over largest singular value {ratio:.1e}); no field can be recovered through it"
    )]
    Singular {
        /// Smallest over largest singular value of M.
        ratio: f64,
    },
    /// M is not symmetric positive definite.
    #[error("soft iron matrix is not symmetric positive definite; bring it to the gauge with Calibration::from_any")]
    NotSymmetricPositiveDefinite,
    /// det M < 0: the raw axes are left-handed.
    #[error("soft iron matrix mirrors the field (negative determinant); flip the sign of one raw axis first")]
    Mirrored,
    /// An element of M or of its inverse is larger than any sensor's: the error model does not hold, or the unit is wrong.
    #[error(
        "an element of the soft iron matrix or of its inverse is {value}, outside +-{LARGEST_ELEMENT}; is the field in microtesla?"
    )]
    SoftIron {
        /// The element, dimensionless.
        value: f64,
    },
    /// A component of b is larger than any sensor reads.
    #[error("hard iron component {value_ut} uT is outside +-{LARGEST_RAW_UT} uT; is the unit microtesla?")]
    HardIron {
        /// The component, microtesla.
        value_ut: f64,
    },
    /// The field strength is none that a device is used in.
    #[error("field strength is {field_strength_ut} uT, expected {} to {} uT", FIELD_STRENGTHS_UT.0, FIELD_STRENGTHS_UT.1)]
    FieldStrength {
        /// The value given, microtesla.
        field_strength_ut: f64,
    },
}

/// Limit: smallest ratio of singular values of M that is still taken as invertible; phones stay above 0.3.
const SMALLEST_RATIO: f64 = 1e-6;
/// Limit: largest element of M and of its inverse. Phones stay within 0.5 to 2; a sensor that counts in units of its own may have a
/// scale of hundreds.
const LARGEST_ELEMENT: f64 = 1000.0;
/// Limit: largest component of a raw sample and of b, uT: 0.1 T. Phones' magnetometers read up to 5 000 uT, some Hall sensors up to
/// 36 000 uT.
pub(crate) const LARGEST_RAW_UT: f64 = 100_000.0;
/// Limit: field strengths, uT: the Earth's field is 22 to 67, laboratories' coils reach a few hundred.
pub(crate) const FIELD_STRENGTHS_UT: (f64, f64) = (1.0, 1000.0);

/// Physics: what the Earth's field spans at its surface, uT (world magnetic model).
pub(crate) const EARTH_FIELD_UT: (f64, f64) = (22.0, 67.0);

/// Choice: what no calibration knows, uT per axis: the field of rooms is not uniform. Measured against optical orientation references
/// in two laboratories.
pub(crate) const UNEVEN_UT: f64 = 1.3;

/// The field strength to count in before one is found, uT: that which is known, else the middle of the Earth's.
pub(crate) fn typical_field_ut(known_ut: Option<f64>) -> f64 {
    known_ut.unwrap_or((EARTH_FIELD_UT.0 * EARTH_FIELD_UT.1).sqrt())
}

/// M, b and the strength of the field they were found in: h_m = M h + b.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(try_from = "CalibrationParts")]
pub struct Calibration {
    soft_iron: Matrix3<f64>,
    #[serde(skip_serializing)]
    soft_iron_inverse: Matrix3<f64>,
    hard_iron_ut: Vector3<f64>,
    field_strength_ut: f64,
}

/// What is stored of a calibration.
#[derive(serde::Deserialize)]
struct CalibrationParts {
    soft_iron: Matrix3<f64>,
    hard_iron_ut: Vector3<f64>,
    field_strength_ut: f64,
}

impl TryFrom<CalibrationParts> for Calibration {
    type Error = CalibrationError;
    fn try_from(parts: CalibrationParts) -> Result<Self, CalibrationError> {
        Self::new(parts.soft_iron, parts.hard_iron_ut, parts.field_strength_ut)
    }
}

/// A calibration from elsewhere, and how well it is believed.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Given {
    pub calibration: Calibration,
    /// In the order b_x b_y b_z (uT) m_xx m_yy m_zz m_xy m_xz m_yz.
    pub covariance: SMatrix<f64, 9, 9>,
}

impl Given {
    /// Variance of a component of b, their mean, uT^2.
    pub fn hard_iron_ut2(&self) -> f64 {
        self.covariance.fixed_view::<3, 3>(0, 0).trace() / 3.0
    }
}

/// Covariance of independent errors: of each component of b (uT^2), and of each element of M - I on the diagonal; half of that beside it.
pub(crate) fn independent(hard_iron_ut2: f64, iron: f64) -> SMatrix<f64, 9, 9> {
    let mut covariance = SMatrix::<f64, 9, 9>::zeros();
    for (first, variance) in [(0, hard_iron_ut2), (3, iron), (6, 0.5 * iron)] {
        covariance.fixed_view_mut::<3, 3>(first, first).fill_diagonal(variance);
    }
    covariance
}

/// D(h) e = E h: the 3x6 matrix that makes M h linear in e.
#[rustfmt::skip]
pub(crate) fn iron_rows(h: &Vector3<f64>) -> SMatrix<f64, 3, 6> {
    SMatrix::from_row_slice(&[
        h.x, 0.0, 0.0, h.y, h.z, 0.0,
        0.0, h.y, 0.0, h.x, 0.0, h.z,
        0.0, 0.0, h.z, 0.0, h.x, h.y,
    ])
}

/// [I D(h)] x for nine numbers x, without the zeros of D.
#[inline(always)]
fn moved(h: &Vector3<f64>, x: impl Fn(usize) -> f64) -> Vector3<f64> {
    Vector3::new(
        x(0) + (x(3) * h.x + x(6) * h.y + x(7) * h.z),
        x(1) + (x(4) * h.y + x(6) * h.x + x(8) * h.z),
        x(2) + (x(5) * h.z + x(7) * h.x + x(8) * h.y),
    )
}

/// W [I D(h)] P [I D(h)]^T W^T for the 9x9 covariance of (b, e).
pub(crate) fn calibration_covariance(
    p: &impl Index<(usize, usize), Output = f64>,
    w: &Matrix3<f64>,
    h: &Vector3<f64>,
) -> Matrix3<f64> {
    let rows: [Vector3<f64>; 9] = core::array::from_fn(|k| moved(h, |i| p[(k, i)]));
    let both = Matrix3::from_columns(&[0, 1, 2].map(|k| moved(h, |i| rows[i][k])));
    w * both * w.transpose()
}

/// Mathematics: what rounding may have taken off a correlation matrix.
const ROUNDING: f64 = 1e-4;

/// Whether a matrix is finite, symmetric and positive semi-definite, within rounding.
pub(crate) fn is_covariance<const N: usize>(p: &SMatrix<f64, N, N>) -> bool {
    let sd = p.diagonal().map(f64::sqrt);
    let near = |i: usize, j: usize| {
        let both = sd[i] * sd[j];
        p[(i, j)].abs() <= both * (1.0 + ROUNDING) && (p[(i, j)] - p[(j, i)]).abs() <= both * ROUNDING
    };
    let mut correlation = p.zip_map(&(sd * sd.transpose()), |p, both| if both == 0.0 { 0.0 } else { p / both });
    correlation.fill_diagonal(1.0 + ROUNDING);
    sd.iter().all(|sd| (0.0..1e9).contains(sd))
        && (0..N).all(|i| (0..i).all(|j| near(i, j)))
        && correlation.cholesky().is_some()
}

impl Calibration {
    /// A calibration from a symmetric positive definite M (dimensionless; no element of it or of its inverse beyond +-1000),
    /// b (uT, each component within +-100 000) and the field strength |h| (1 to 1000 uT).
    ///
    /// # Errors
    /// [`CalibrationError`] when a value is not finite, M is not symmetric positive definite (to a relative 1e-9)
    /// or is singular, or a value is outside its range.
    pub fn new(
        soft_iron: Matrix3<f64>,
        hard_iron_ut: Vector3<f64>,
        field_strength_ut: f64,
    ) -> Result<Self, CalibrationError> {
        check_finite(&soft_iron, &hard_iron_ut)?;
        let asymmetry = (soft_iron - soft_iron.transpose()).abs().max();
        let symmetric = soft_iron.symmetric_part();
        if asymmetry > 1e-9 * soft_iron.abs().max() || symmetric.cholesky().is_none() {
            return Err(CalibrationError::NotSymmetricPositiveDefinite);
        }
        let values = symmetric.symmetric_eigenvalues();
        let ratio = values.min() / values.max();
        if ratio.is_nan() || ratio < SMALLEST_RATIO {
            return Err(CalibrationError::Singular { ratio });
        }
        Self::from_symmetric(symmetric, hard_iron_ut, field_strength_ut)
    }

    /// For callers that know M to be exactly symmetric and positive definite: same numbers, and their ranges are checked.
    pub(crate) fn from_symmetric(
        soft_iron: Matrix3<f64>,
        hard_iron_ut: Vector3<f64>,
        field_strength_ut: f64,
    ) -> Result<Self, CalibrationError> {
        if !(FIELD_STRENGTHS_UT.0..=FIELD_STRENGTHS_UT.1).contains(&field_strength_ut) {
            return Err(CalibrationError::FieldStrength { field_strength_ut });
        }
        // no comparison with NaN holds
        if let Some(&value_ut) = hard_iron_ut.iter().find(|b| !(-LARGEST_RAW_UT..=LARGEST_RAW_UT).contains(*b)) {
            return Err(CalibrationError::HardIron { value_ut });
        }
        let bounded = |m: &Matrix3<f64>| {
            let beyond = m.iter().find(|element| !(-LARGEST_ELEMENT..=LARGEST_ELEMENT).contains(*element));
            beyond.map_or(Ok(()), |&value| Err(CalibrationError::SoftIron { value }))
        };
        // first M: of huge numbers the determinant overflows
        bounded(&soft_iron)?;
        let inverse = soft_iron.try_inverse().ok_or(CalibrationError::Singular { ratio: 0.0 })?;
        let soft_iron_inverse = inverse.symmetric_part();
        bounded(&soft_iron_inverse)?;
        Ok(Self { soft_iron, soft_iron_inverse, hard_iron_ut, field_strength_ut })
    }

    /// A calibration from any invertible M, brought to the gauge: M = P R with P symmetric positive definite.
    ///
    /// Returns the calibration with soft iron P, and R: since M h = P (R h), the field corrected with P is R h. The ranges
    /// are those of [`Calibration::new`].
    ///
    /// # Errors
    /// [`CalibrationError`] when a value is not finite, M is singular or mirrors, or a value is outside its range.
    pub fn from_any(
        m: Matrix3<f64>,
        hard_iron_ut: Vector3<f64>,
        field_strength_ut: f64,
    ) -> Result<(Self, Rotation3<f64>), CalibrationError> {
        check_finite(&m, &hard_iron_ut)?;
        let squared = (m * m.transpose()).symmetric_eigen();
        let (low, high) = (squared.eigenvalues.min().max(0.0), squared.eigenvalues.max());
        let ratio = if high > 0.0 { (low / high).sqrt() } else { 0.0 };
        if ratio.is_nan() || ratio < SMALLEST_RATIO {
            return Err(CalibrationError::Singular { ratio });
        }
        if m.determinant() < 0.0 {
            return Err(CalibrationError::Mirrored);
        }
        let root = Matrix3::from_diagonal(&squared.eigenvalues.map(f64::sqrt));
        let p = squared.eigenvectors * root * squared.eigenvectors.transpose();
        let calibration = Self::from_symmetric(p.symmetric_part(), hard_iron_ut, field_strength_ut)?;
        let rotation = Rotation3::from_matrix_unchecked(calibration.soft_iron_inverse * m);
        Ok((calibration, rotation))
    }

    /// No disturbance: M = I, b = 0.
    ///
    /// # Errors
    /// [`CalibrationError::FieldStrength`] when the field strength is not 1 to 1000 uT.
    pub fn identity(field_strength_ut: f64) -> Result<Self, CalibrationError> {
        Self::from_symmetric(Matrix3::identity(), Vector3::zeros(), field_strength_ut)
    }

    /// M = I about a centre, for looking at directions from there.
    pub(crate) fn about(hard_iron_ut: Vector3<f64>, field_strength_ut: f64) -> Self {
        let soft_iron = Matrix3::identity();
        Self { soft_iron, soft_iron_inverse: soft_iron, hard_iron_ut, field_strength_ut }
    }

    /// M, dimensionless, symmetric positive definite.
    #[must_use]
    pub fn soft_iron(&self) -> &Matrix3<f64> {
        &self.soft_iron
    }

    /// M^-1, dimensionless.
    #[must_use]
    pub fn soft_iron_inverse(&self) -> &Matrix3<f64> {
        &self.soft_iron_inverse
    }

    /// b, microtesla: subtracted from the raw field.
    #[must_use]
    pub fn hard_iron_ut(&self) -> &Vector3<f64> {
        &self.hard_iron_ut
    }

    /// |h|, microtesla.
    #[must_use]
    pub fn field_strength_ut(&self) -> f64 {
        self.field_strength_ut
    }

    /// (11) h = M^-1 (h_m - b), uT, device frame.
    #[must_use]
    pub fn correct(&self, raw_ut: &Vector3<f64>) -> Vector3<f64> {
        self.soft_iron_inverse * (raw_ut - self.hard_iron_ut)
    }

    /// (8) h_m = M h + b, uT, device frame.
    #[must_use]
    pub fn distort(&self, field_ut: &Vector3<f64>) -> Vector3<f64> {
        self.soft_iron * field_ut + self.hard_iron_ut
    }
}

/// The factory errors of the sensor itself (eq. 1 to 4): h_m = S C h + b_0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FactoryErrors {
    /// Diagonal of S: scale factors, dimensionless.
    pub scale: Vector3<f64>,
    /// (e_x e_y e_z): its columns are the attitudes of the three sensing axes; C is its inverse (non-orthogonality).
    pub axes: Matrix3<f64>,
    /// b_0: offsets of the bridges, uT.
    pub offset_ut: Vector3<f64>,
}

/// The disturbance the phone carries (eq. 5, 6).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disturbance {
    /// A: soft iron, dimensionless, symmetric.
    pub soft_iron: Matrix3<f64>,
    /// b_m: hard iron, uT.
    pub hard_iron_ut: Vector3<f64>,
}

impl FactoryErrors {
    /// (7) and (8): M = S C A and b = S C b_m + b_0. Bring M to the gauge with [`Calibration::from_any`].
    ///
    /// # Errors
    /// [`CalibrationError::Singular`] when the sensing axes lie in one plane, so that C does not exist;
    /// [`CalibrationError::NotFinite`] when a value is not finite or the product overflows.
    pub fn compose(&self, disturbance: &Disturbance) -> Result<(Matrix3<f64>, Vector3<f64>), CalibrationError> {
        // the rest shows in the products
        check_finite(&self.axes, &self.offset_ut)?;
        let c = self.axes.try_inverse().ok_or(CalibrationError::Singular { ratio: 0.0 })?;
        let sc = Matrix3::from_diagonal(&self.scale) * c;
        let (m, b) = (sc * disturbance.soft_iron, sc * disturbance.hard_iron_ut + self.offset_ut);
        check_finite(&m, &b)?;
        Ok((m, b))
    }
}

fn check_finite(m: &Matrix3<f64>, b: &Vector3<f64>) -> Result<(), CalibrationError> {
    let finite = m.iter().chain(b.iter()).all(|v| v.is_finite());
    if finite { Ok(()) } else { Err(CalibrationError::NotFinite) }
}
