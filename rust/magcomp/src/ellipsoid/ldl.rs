//! Solves H x = g for a symmetric positive definite H by H = L D L^T, in place: on the path of every sample, where a
//! general factorisation of so small a matrix costs several times as much.

use nalgebra::{SMatrix, SVector};

/// x with H x = g. Only the lower triangle of `h` is read. None unless H is positive definite.
#[inline]
pub(crate) fn solve<const N: usize>(h: &SMatrix<f64, N, N>, g: &SVector<f64, N>) -> Option<SVector<f64, N>> {
    let mut l = [[0.0; N]; N];
    let mut inverse = [0.0; N];
    let mut x = [0.0; N];
    for i in 0..N {
        let mut scaled = [0.0; N]; // L D of this row
        let mut value = g[i];
        let mut pivot = h[(i, i)];
        for j in 0..i {
            let mut sum = h[(i, j)];
            for k in 0..j {
                sum -= scaled[k] * l[j][k];
            }
            scaled[j] = sum;
            l[i][j] = sum * inverse[j];
            pivot -= sum * l[i][j];
            value -= l[i][j] * x[j];
        }
        // also false for NaN
        if !(pivot > 0.0 && pivot < f64::INFINITY) {
            return None;
        }
        inverse[i] = 1.0 / pivot;
        x[i] = value;
    }
    for i in (0..N).rev() {
        let mut value = x[i] * inverse[i];
        for k in i + 1..N {
            value -= l[k][i] * x[k];
        }
        x[i] = value;
    }
    Some(SVector::from(x))
}

#[cfg(test)]
mod tests {
    use super::solve;
    use nalgebra::{SMatrix, SVector};

    #[test]
    fn agrees_with_a_general_factorisation() {
        let a = SMatrix::<f64, 9, 9>::from_fn(|i, j| ((i * 7 + j * 3) as f64 * 0.7).sin());
        let h = a * a.transpose() + SMatrix::identity() * 0.1;
        let g = SVector::<f64, 9>::from_fn(|i, _| i as f64 - 3.0);
        let expected = h.cholesky().expect("positive definite").solve(&g);
        assert!((solve(&h, &g).expect("positive definite") - expected).amax() < 1e-10);
    }

    #[test]
    fn refuses_what_is_not_positive_definite() {
        let mut h = SMatrix::<f64, 3, 3>::identity();
        h[(2, 2)] = -1.0;
        assert_eq!(solve(&h, &SVector::repeat(1.0)), None);
        h[(2, 2)] = f64::NAN;
        assert_eq!(solve(&h, &SVector::repeat(1.0)), None);
    }
}
