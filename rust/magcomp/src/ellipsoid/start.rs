//! Where the descent of eq. (10) starts: a closed form that always gives an ellipsoid.
//!
//! First the linear least squares: minimise sum (z.p)^2 over quadrics with trace A = 3, which every ellipsoid can be
//! scaled to, wherever its centre lies. With good coverage it is an excellent start.
//! When it is not (few or badly spread samples), the ellipsoid-specific fit of Q. Li and J. G. Griffiths, "Least
//! squares ellipsoid specific fitting", Geometric Modeling and Processing 2004: minimise p^T S p subject to
//! 4 J - I^2 = 1, with I = a + b + c and J = ab + bc + ca - f^2 - g^2 - h^2, which only ellipsoids satisfy.
//! A wrong previous calibration plays no part in either, so it cannot send the descent away.

#[cfg(test)]
mod tests;

use crate::math::ldl;
use crate::math::symmetric::{six, symmetric};
use nalgebra::{Matrix3, Matrix4, Matrix6, SMatrix, SVector, Vector3, Vector6};

/// An ellipsoid (u - beta)^T A (u - beta) = 1 in centred and scaled coordinates, as (A, a = A beta).
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Shape {
    pub a: Matrix3<f64>,
    /// a = A beta.
    pub offset: Vector3<f64>,
}

impl Shape {
    /// From y = [A11, A22, A33, A12, A13, A23, a1, a2, a3].
    pub fn of_unknowns(y: &SVector<f64, 9>) -> Self {
        Self { a: symmetric(y), offset: Vector3::new(y[6], y[7], y[8]) }
    }

    /// y, the nine numbers.
    pub fn unknowns(&self) -> SVector<f64, 9> {
        let (a, offset) = (six(&self.a), &self.offset);
        SVector::from([a[0], a[1], a[2], a[3], a[4], a[5], offset.x, offset.y, offset.z])
    }

    /// beta = A^-1 a, the centre; None unless A is positive definite.
    pub fn centre(&self) -> Option<Vector3<f64>> {
        ldl::solve(&self.a, &self.offset)
    }

    /// The shape of a quadric p with z.p = 0, None when it is no ellipsoid.
    fn from_quadric(p: &SVector<f64, 10>) -> Option<Self> {
        let sign = if p[0] + p[1] + p[2] < 0.0 { -1.0 } else { 1.0 };
        let a = symmetric(p) * sign;
        let offset = Vector3::new(p[6], p[7], p[8]) * (-0.5 * sign);
        let beta = ldl::solve(&a, &offset)?;
        let radius_squared = beta.dot(&offset) - p[9] * sign;
        let shape = Self { a: a / radius_squared, offset: offset / radius_squared };
        let is_finite = radius_squared.is_finite() && shape.unknowns().iter().all(|v| v.is_finite());
        (radius_squared > 0.0 && is_finite).then_some(shape)
    }
}

/// The start for a scatter matrix S; None when the samples span no quadric at all (all in one plane).
pub(crate) fn closed_form(s: &SMatrix<f64, 10, 10>) -> Option<Shape> {
    linear(s).or_else(|| ellipsoid_specific(s))
}

/// Linear least squares with trace A = 3, if it is an ellipsoid: p = p0 + B q, (B^T S B) q = -B^T S p0, where
/// p0 = [1, 1, 1, 0, ...] and B takes q1, q2 to A11 - A33, A22 - A33 and the other seven to themselves.
fn linear(s: &SMatrix<f64, 10, 10>) -> Option<Shape> {
    let half = constrained(s);
    let normal = constrained(&half.transpose()).transpose();
    let q = ldl::solve(&normal, &-(half.column(0) + half.column(1) + half.column(2)))?;
    let p = [1.0 + q[0], 1.0 + q[1], 1.0 - q[0] - q[1], q[2], q[3], q[4], q[5], q[6], q[7], q[8]];
    Shape::from_quadric(&SVector::from(p))
}

/// B^T M.
fn constrained<const C: usize>(m: &SMatrix<f64, 10, C>) -> SMatrix<f64, 9, C> {
    SMatrix::from_fn(|i, j| if i < 2 { m[(i, j)] - m[(2, j)] } else { m[(i + 1, j)] })
}

/// Mathematics: exact points leave S_r singular; this share of its trace, far below any real noise, keeps the factorisation going.
const LEAST_NOISE: f64 = 1e-14;

/// Li and Griffiths with k = 4: the largest eigenvalue of C v = mu S_r v, S_r the scatter of the second-degree
/// part after the rest has been eliminated.
fn ellipsoid_specific(s: &SMatrix<f64, 10, 10>) -> Option<Shape> {
    let s11 = s.fixed_view::<6, 6>(0, 0).into_owned();
    let s12 = s.fixed_view::<6, 4>(0, 6).into_owned();
    let s22: Matrix4<f64> = s.fixed_view::<4, 4>(6, 6).into_owned();
    let back = s22.cholesky()?.solve(&s12.transpose());
    let reduced = (s11 - s12 * back).symmetric_part();
    let lower = (reduced + Matrix6::identity() * (LEAST_NOISE * reduced.trace())).cholesky()?.l();
    let mut constraint = Matrix6::from_diagonal(&Vector6::new(-2.0, -2.0, -2.0, -4.0, -4.0, -4.0));
    constraint.fixed_view_mut::<3, 3>(0, 0).add_scalar_mut(1.0);
    let left = lower.solve_lower_triangular(&constraint)?;
    let both = lower.solve_lower_triangular(&left.transpose())?;
    let eigen = both.symmetric_part().symmetric_eigen();
    let best = eigen.eigenvalues.imax();
    let v1: Vector6<f64> = lower.transpose().solve_upper_triangular(&eigen.eigenvectors.column(best).into_owned())?;
    let v2 = -(back * v1);
    let mut p = SVector::<f64, 10>::zeros();
    p.fixed_rows_mut::<6>(0).copy_from(&v1);
    p.fixed_rows_mut::<4>(6).copy_from(&v2);
    Shape::from_quadric(&p)
}
