//! The ten parameters tau = [T_xx T_yy T_zz T_xy T_xz T_yz beta_x beta_y beta_z s] in coordinates u = h_m / unit:
//!     r = |T (u - beta)| = 1,   T = M^-1 unit / |h|, symmetric: an ellipsoid, and with gravity
//!     up.T (u - beta) = s,      s = -sin(dip): what the field has along the vertical.

#[cfg(test)]
mod tests;

use crate::ellipsoid::mean_square_angle;
/// T of tau.
pub(super) use crate::math::symmetric::symmetric as shape;
use crate::math::symmetric::{PLACES, basis, six};
use crate::strength::EARTH_UT;
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

/// Format: parameters of a hypothesis.
pub(super) const COUNT: usize = 10;
pub(super) type Tau = SVector<f64, COUNT>;
pub(super) type TauMatrix = SMatrix<f64, COUNT, COUNT>;

/// Format: numbers of a state beside tau.
pub(super) const BESIDE: usize = 7;
/// Format: numbers of a state, tau among them.
pub(super) const STATES: usize = COUNT + BESIDE;
pub(super) type Numbers<const N: usize = STATES> = SVector<f64, N>;
/// Choice: half axes (in units) and their inverses that any phone stays within. Without bounds a fit can stick in a cylinder,
/// where T is singular and the cost stationary.
const BOUNDS: (f64, f64) = (0.25, 3.5);

/// Mathematics: a length, in units, or a share that is as good as none.
pub(super) const NOTHING: f64 = 1e-6;
/// Mathematics: variance below which no element is believed to be known.
pub(super) const LEAST_VARIANCE: f64 = 1e-8;

/// A Gaussian over tau.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Gaussian {
    pub mean: Tau,
    pub covariance: TauMatrix,
}

impl Gaussian {
    /// Variance of what has this derivative by tau.
    pub fn variance(&self, by_tau: &Tau) -> f64 {
        by_tau.dot(&(self.covariance * by_tau)).max(0.0)
    }

    /// The same, without what noise tells of b along an axis, where it can't be known better than with a variance.
    pub fn without(mut self, noise: Option<(Vector3<f64>, f64)>) -> Self {
        if let Some((axis, least)) = noise {
            let by_axis = self.covariance.fixed_columns::<3>(6) * axis;
            let variance = by_axis.fixed_rows::<3>(6).dot(&axis);
            if variance < least {
                self.covariance += by_axis * by_axis.transpose() * ((least - variance) / (variance * variance));
            }
        }
        self
    }

    /// Expected mean square angle, over all directions, between those corrected by tau and by its mean, rad^2: an error dtau
    /// turns the unit vector n by the part of dT T^-1 n - T dbeta across n.
    pub fn error(&self) -> f64 {
        let t = shape(&self.mean);
        let Some(inverse) = t.try_inverse() else { return f64::MAX };
        let (of_t, of_beta) = (self.covariance.fixed_view::<6, 6>(0, 0), self.covariance.fixed_view::<3, 3>(6, 6));
        mean_square_angle(&basis().map(|dt| dt * inverse), &of_t.into(), &t, &of_beta.into())
    }
}

/// beta.
pub(super) fn centre(tau: &Tau) -> Vector3<f64> {
    Vector3::new(tau[6], tau[7], tau[8])
}

/// Ten numbers in the order of tau.
pub(super) fn ten(six: &SVector<f64, 6>, three: &Vector3<f64>, last: f64) -> Tau {
    let [xx, yy, zz, xy, xz, yz] = six.data.0[0];
    Tau::from_column_slice(&[xx, yy, zz, xy, xz, yz, three.x, three.y, three.z, last])
}

/// tau of T and beta, without a vertical part.
pub(super) fn tau_of(t: &Matrix3<f64>, beta: &Vector3<f64>) -> Tau {
    ten(&six(t), beta, 0.0)
}

/// Whether T is positive definite with eigenvalues inside [`BOUNDS`].
pub(super) fn is_bounded(tau: &Tau) -> bool {
    let positive = |m: Matrix3<f64>| m.m11 > 0.0 && m.m11 * m.m22 > m.m12 * m.m12 && m.determinant() > 0.0;
    let t = shape(tau);
    positive(t - Matrix3::from_diagonal_element(BOUNDS.0)) && positive(Matrix3::from_diagonal_element(BOUNDS.1) - t)
}

/// One sample seen through tau.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    /// u - beta.
    pub offset: Vector3<f64>,
    /// T (u - beta) / r, the corrected unit vector.
    pub direction: Vector3<f64>,
    /// r.
    pub radius: f64,
    /// |dr/du| = |T direction|.
    pub slope: f64,
}

/// By which share of its strength the field of tau is stronger, or weaker, than any of the Earth.
pub(super) fn beyond_earth(tau: &Tau, unit_ut: f64) -> f64 {
    let strength_ut = 3.0 * unit_ut / shape(tau).trace();
    (1.0 - EARTH_UT.end / strength_ut).max(1.0 - strength_ut / EARTH_UT.start).max(0.0)
}

/// A sample seen through tau; None at the centre itself.
pub(super) fn see(tau: &Tau, u: &Vector3<f64>) -> Option<Seen> {
    let t = shape(tau);
    let offset = u - centre(tau);
    let v = t * offset;
    let radius = v.norm();
    if !(radius > NOTHING && radius < 1.0 / NOTHING) {
        return None;
    }
    let direction = v / radius;
    Some(Seen { offset, direction, radius, slope: (t * direction).norm() })
}

/// d(along.T (u - beta) - last s)/dtau at a sample.
pub(super) fn gradient(tau: &Tau, along: &Vector3<f64>, offset: &Vector3<f64>, last: f64) -> Tau {
    let by_shape =
        PLACES.map(|(i, j)| if i == j { along[i] * offset[i] } else { along[i] * offset[j] + along[j] * offset[i] });
    ten(&SVector::from(by_shape), &-(shape(tau) * along), -last)
}
