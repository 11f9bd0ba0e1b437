//! What a restored state must hold. A right checksum makes no state a good one, so types that promise more than their fields
//! can't be deserialised without it.
//! Counts of samples need no check where they saturate.

use nalgebra::SMatrix;

/// Makes a type that derives serde's traits with `serde(remote = "Self")` one that can't be deserialised unless it holds
/// what it promises.
macro_rules! checked {
    ($type:ident $(<$(const $parameter:ident),+>)?, |$it:ident| $holds:expr) => {
        impl $(<$(const $parameter: usize),+>)? $type $(<$($parameter),+>)? {
            fn is_sound(&self) -> bool {
                let $it = self;
                $holds
            }
        }

        #[cfg(feature = "serde")]
        impl $(<$(const $parameter: usize),+>)? serde::Serialize for $type $(<$($parameter),+>)? {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                Self::serialize(self, serializer)
            }
        }

        #[cfg(feature = "serde")]
        impl<'de $($(, const $parameter: usize)+)?> serde::Deserialize<'de> for $type $(<$($parameter),+>)? {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let it = Self::deserialize(deserializer)?;
                if it.is_sound() { Ok(it) } else { Err(serde::de::Error::custom(concat!("no sound ", stringify!($type)))) }
            }
        }
    };
}
pub(crate) use checked;

/// What rounding may have taken off a correlation matrix.
const ROUNDING: f64 = 1e-4;

/// Whether a matrix is symmetric and positive semi-definite, within rounding.
pub(crate) fn is_covariance<const N: usize>(p: &SMatrix<f64, N, N>) -> bool {
    let sd = p.diagonal().map(f64::sqrt);
    let near = |i: usize, j: usize| {
        let both = sd[i] * sd[j];
        p[(i, j)].abs() <= both * (1.0 + ROUNDING) && (p[(i, j)] - p[(j, i)]).abs() <= both * ROUNDING
    };
    let mut correlation = p.zip_map(&(sd * sd.transpose()), |p, both| if both == 0.0 { 0.0 } else { p / both });
    correlation.fill_diagonal(1.0 + ROUNDING);
    sd.iter().all(|sd| *sd >= 0.0) && (0..N).all(|i| (0..i).all(|j| near(i, j))) && correlation.cholesky().is_some()
}
