//! Linear least squares of a sphere (I. Kasa, 1976) and of an ellipsoid (trace A = 3), both about the samples' mean.
//!     |x|^2 = 2 b.x + k        x^T A x - 2 g.x + k = 0, b = A^-1 g
//! Answers are (A, b) of (h - b)^T A (h - b) = 1.

use magcomp::nalgebra::{Matrix3, Matrix4, SMatrix, SVector, Vector3, Vector4};

fn mean(points: &[Vector3<f64>]) -> Vector3<f64> {
    points.iter().sum::<Vector3<f64>>() / points.len() as f64
}

/// The sphere.
pub(super) fn sphere(points: &[Vector3<f64>]) -> Option<(Matrix3<f64>, Vector3<f64>)> {
    let centre = mean(points);
    let (mut normal, mut right) = (Matrix4::zeros(), Vector4::zeros());
    for point in points {
        let x = point - centre;
        let row = Vector4::new(2.0 * x.x, 2.0 * x.y, 2.0 * x.z, 1.0);
        normal += row * row.transpose();
        right += row * x.norm_squared();
    }
    let solution = normal.cholesky()?.solve(&right);
    let b = solution.fixed_rows::<3>(0).into_owned();
    let radius_squared = solution[3] + b.norm_squared();
    (radius_squared > 0.0).then(|| (Matrix3::from_diagonal_element(1.0 / radius_squared), centre + b))
}

/// The ellipsoid; None when the best quadric is no ellipsoid.
pub(super) fn ellipsoid(points: &[Vector3<f64>]) -> Option<(Matrix3<f64>, Vector3<f64>)> {
    let centre = mean(points);
    let scale = (points.iter().map(|p| (p - centre).norm_squared()).sum::<f64>() / points.len() as f64).sqrt();
    let (mut normal, mut right) = (SMatrix::<f64, 9, 9>::zeros(), SVector::<f64, 9>::zeros());
    for point in points {
        let u = (point - centre) / scale;
        let (x, y, z) = (u.x, u.y, u.z);
        // A11 = 1 + p, A22 = 1 + q, A33 = 1 - p - q
        let row =
            [x * x - z * z, y * y - z * z, 2.0 * x * y, 2.0 * x * z, 2.0 * y * z, -2.0 * x, -2.0 * y, -2.0 * z, 1.0];
        let row = SVector::from(row);
        normal += row * row.transpose();
        right -= row * u.norm_squared();
    }
    let s = normal.cholesky()?.solve(&right);
    let a = Matrix3::new(1.0 + s[0], s[2], s[3], s[2], 1.0 + s[1], s[4], s[3], s[4], 1.0 - s[0] - s[1]);
    let g = Vector3::new(s[5], s[6], s[7]);
    let b = a.cholesky()?.solve(&g);
    let k = b.dot(&g) - s[8];
    (k > 0.0).then(|| (a / (k * scale * scale), centre + b * scale))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_points_give_the_ellipsoid_back() {
        let m = Matrix3::new(52.0, 3.0, -2.0, 3.0, 47.0, 4.0, -2.0, 4.0, 50.0);
        let b = Vector3::new(120.0, -40.0, 300.0);
        let points: Vec<_> = (0..60)
            .map(|k| {
                let (p, q) = (f64::from(k) * 1.7, f64::from(k) * 0.6);
                m * Vector3::new(p.cos() * q.sin(), p.sin() * q.sin(), q.cos()) + b
            })
            .collect();
        let (a, found) = ellipsoid(&points).unwrap();
        assert!((found - b).norm() < 1e-8);
        assert!((a * (m * m) - Matrix3::identity()).amax() < 1e-8);
        let round: Vec<_> = points.iter().map(|p| (p - b).normalize() * 50.0 + b).collect();
        assert!((sphere(&round).unwrap().1 - b).norm() < 1e-8);
    }
}
