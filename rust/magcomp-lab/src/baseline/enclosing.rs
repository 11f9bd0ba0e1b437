//! The ellipsoid of least volume around the samples (the paper's "MVEE"), by Khachiyan's algorithm: weights u on the
//! lifted samples q = (x, 1), X = sum u q q^T; the sample with the largest q^T X^-1 q gains weight, until that is 4 within
//! a tolerance. b = sum u x, A = (sum u x x^T - b b^T)^-1 / 3.

use magcomp::nalgebra::{Matrix3, Matrix4, Vector3, Vector4};

/// Rounds at the most; each costs a pass over the samples.
const ROUNDS: usize = 200;
/// q^T X^-1 q above 4 that is good enough.
const TOLERANCE: f64 = 0.02;

/// (A, b) of (h - b)^T A (h - b) = 1.
pub(super) fn ellipsoid(points: &[Vector3<f64>]) -> Option<(Matrix3<f64>, Vector3<f64>)> {
    let count = points.len();
    let centre = points.iter().sum::<Vector3<f64>>() / count as f64;
    let lifted: Vec<Vector4<f64>> = points.iter().map(|p| (p - centre).push(1.0)).collect();
    let mut weights = vec![1.0 / count as f64; count];
    for _ in 0..ROUNDS {
        let mut x = Matrix4::zeros();
        lifted.iter().zip(&weights).for_each(|(q, weight)| x += q * q.transpose() * *weight);
        let inverse = x.try_inverse()?;
        let reach = lifted.iter().map(|q| q.dot(&(inverse * q)));
        let (far, largest) = reach.enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
        if largest < 4.0 + TOLERANCE {
            break;
        }
        let step = (largest - 4.0) / (4.0 * (largest - 1.0));
        weights.iter_mut().for_each(|weight| *weight *= 1.0 - step);
        weights[far] += step;
    }
    let b: Vector3<f64> = lifted.iter().zip(&weights).map(|(q, weight)| q.xyz() * *weight).sum();
    let mut second = Matrix3::zeros();
    lifted.iter().zip(&weights).for_each(|(q, weight)| second += q.xyz() * q.xyz().transpose() * *weight);
    let a = (second - b * b.transpose()).try_inverse()? / 3.0;
    Some(((a + a.transpose()) * 0.5, b + centre))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_lies_far_outside() {
        let points: Vec<_> = (0..80)
            .map(|k| {
                let (p, q) = (f64::from(k) * 1.7, f64::from(k) * 0.6);
                Vector3::new(50.0 * p.cos() * q.sin(), 45.0 * p.sin() * q.sin(), 40.0 * q.cos()) + Vector3::repeat(90.0)
            })
            .collect();
        let (a, b) = ellipsoid(&points).unwrap();
        assert!(points.iter().all(|p| (p - b).dot(&(a * (p - b))) < 1.02));
        assert!((b - Vector3::repeat(90.0)).norm() < 1.0);
    }
}
