//! Symmetric 3 x 3 matrices as six numbers, in the order xx yy zz xy xz yz.

use nalgebra::{Matrix3, SVector};

/// Row and column of each.
pub(crate) const PLACES: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];

/// The six numbers of a matrix.
pub(crate) fn six(m: &Matrix3<f64>) -> SVector<f64, 6> {
    SVector::from(PLACES.map(|place| m[place]))
}

/// The matrix of the first six numbers.
pub(crate) fn symmetric<const N: usize>(x: &SVector<f64, N>) -> Matrix3<f64> {
    Matrix3::new(x[0], x[3], x[4], x[3], x[1], x[5], x[4], x[5], x[2])
}

/// The six elementary matrices.
pub(crate) fn basis() -> [Matrix3<f64>; 6] {
    std::array::from_fn(|k| symmetric(&SVector::<f64, 6>::ith(k, 1.0)))
}
