//! Symmetric 3 x 3 matrices as six numbers, in the order xx yy zz xy xz yz.

use nalgebra::{Matrix3, SVector};

/// Mathematics: row and column of each.
pub(crate) const PLACES: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];

/// The six numbers of a matrix.
pub(crate) fn six(m: &Matrix3<f64>) -> SVector<f64, 6> {
    SVector::from(PLACES.map(|place| m[place]))
}

/// The matrix of the first six numbers.
pub(crate) fn symmetric<const N: usize>(x: &SVector<f64, N>) -> Matrix3<f64> {
    Matrix3::new(x[0], x[3], x[4], x[3], x[1], x[5], x[4], x[5], x[2])
}

/// The inverse of a symmetric matrix, whose lower triangle is read.
pub(crate) fn inverse(m: &Matrix3<f64>) -> Option<Matrix3<f64>> {
    let (xx, yx, zx) = (m.m22 * m.m33 - m.m32 * m.m32, m.m31 * m.m32 - m.m21 * m.m33, m.m21 * m.m32 - m.m31 * m.m22);
    let determinant = m.m11 * xx + m.m21 * yx + m.m31 * zx;
    let (yy, zz) = (m.m11 * m.m33 - m.m31 * m.m31, m.m11 * m.m22 - m.m21 * m.m21);
    let minors = SVector::from([xx, yy, zz, yx, zx, m.m21 * m.m31 - m.m32 * m.m11]);
    (determinant != 0.0).then(|| symmetric(&(minors / determinant)))
}

/// The six elementary matrices.
pub(crate) fn basis() -> [Matrix3<f64>; 6] {
    core::array::from_fn(|k| symmetric(&SVector::<f64, 6>::ith(k, 1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Matrix6;

    fn example() -> Matrix3<f64> {
        Matrix3::from_fn(|i, j| ((i + j) as f64 * 1.7).sin() + (i * j) as f64)
    }

    #[test]
    fn six_numbers_and_the_matrix_are_the_same() {
        let m = example();
        assert_eq!(symmetric(&six(&m)), m);
        assert_eq!(symmetric(&six(&m)), symmetric(&six(&m)).transpose());
        // further numbers do not count, and of a matrix only the upper triangle does
        assert_eq!(symmetric(&six(&m).push(f64::NAN)), m);
        let mut lopsided = m;
        lopsided[(2, 0)] = f64::NAN;
        assert_eq!(six(&lopsided), six(&m));
    }

    #[test]
    fn the_inverse_is_that_of_any_matrix() {
        for k in 0..20 {
            let m = example() + Matrix3::from_diagonal_element(f64::from(k) - 10.3);
            assert_eq!(inverse(&m), m.try_inverse());
        }
        assert_eq!(inverse(&Matrix3::repeat(2.0)), None);
    }

    #[test]
    fn the_elementary_matrices_span_all_symmetric_ones() {
        let (m, numbers) = (example(), six(&example()));
        let sum = basis().iter().zip(&numbers).fold(Matrix3::zeros(), |sum, (e, number)| sum + e * *number);
        assert_eq!(sum, m);
        // independent: their products by trace are diagonal, those beside the diagonal count twice
        let products = Matrix6::from_fn(|k, l| (basis()[k] * basis()[l]).trace());
        assert_eq!(products, Matrix6::from_diagonal(&SVector::from([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])));
    }

    #[test]
    fn each_number_stands_at_its_places_alone() {
        for (k, (i, j)) in PLACES.into_iter().enumerate() {
            let e = basis()[k];
            for row in 0..3 {
                for column in 0..3 {
                    let is_there = (row, column) == (i, j) || (row, column) == (j, i);
                    assert_eq!(e[(row, column)], f64::from(is_there));
                }
            }
        }
    }
}
