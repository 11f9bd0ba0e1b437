//! Moments of a window of raw samples: everything eq. (10) needs, in constant time per sample.
//!
//! In centred and scaled coordinates u = (h_m - centre) / scale the residual of (10) is linear in the ten monomials
//!     z = [x^2, y^2, z^2, 2xy, 2xz, 2yz, x, y, z, 1],
//! so its sum of squares over a window is p^T S p with S = sum z z^T. The 55 entries of S are only 35 distinct
//! monomials of degree 0 to 4. White noise of standard deviation nu on u adds nu^2 B to S on average, up to nu^4,
//! with
//!     B = sum (grad z)(grad z)^T + z k^T + k z^T,  k = [1, 1, 1, 0, ...]: half the Laplacian of z,
//! of degree 0 to 2 (K. Kanatani and P. Rangarajan, "Hyper least squares fitting of circles and ellipses", 2011).
//!
//! The sums are kept in fixed point, so that they are exact: adding a sample and removing it again leaves every
//! bit as it was, and the moments of a window depend on its content alone, not on how it came about.

#[cfg(test)]
mod tests;

use super::exact::ExactSums;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::{Matrix3, SMatrix, Vector3};

/// Mathematics: exponents of x, y, z for each entry of z.
const EXPONENTS: [[usize; 3]; 10] =
    [[2, 0, 0], [0, 2, 0], [0, 0, 2], [1, 1, 0], [1, 0, 1], [0, 1, 1], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 0]];
/// Mathematics: factor of each entry of z.
const FACTORS: [f64; 10] = [1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 1.0, 1.0, 1.0, 1.0];
/// Mathematics: monomials x^i y^j z^k with 1 <= i + j + k <= 4.
const MONOMIALS: usize = 34;

/// Place of x^i y^j z^k in the list of monomials, which runs by degree, then falling power of x, then of y.
const fn place([i, j, k]: [usize; 3]) -> usize {
    let degree = i + j + k;
    let below = [0, 1, 4, 10, 20][degree]; // monomials of lower degree, the constant included
    let rest = degree - i;
    below + rest * (rest + 1) / 2 + k
}

/// Mathematics: dz/dx, dz/dy, dz/dz: of which entry of z each entry is, times a factor.
const DERIVED: [[(f64, usize); 10]; 3] = {
    let (none, one, x, y, z) = ((0.0, 9), (1.0, 9), (2.0, 6), (2.0, 7), (2.0, 8));
    [
        [x, none, none, y, z, none, one, none, none, none],
        [none, y, none, x, none, z, none, one, none, none],
        [none, none, z, none, x, y, none, none, one, none],
    ]
};

/// Mathematics: where each entry of S is found among the monomials; 0 is the constant.
const PLACES: [[usize; 10]; 10] = {
    let (mut places, mut entry) = ([[0; 10]; 10], 0);
    while entry < 100 {
        let (a, b) = (EXPONENTS[entry / 10], EXPONENTS[entry % 10]);
        places[entry / 10][entry % 10] = place([a[0] + b[0], a[1] + b[1], a[2] + b[2]]);
        entry += 1;
    }
    places
};

/// Exact sums of the monomials of a set of raw samples.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Moments {
    centre_ut: Vector3<f64>,
    scale_ut: f64,
    count: usize,
    /// Samples among them with a NaN or infinite component: while there are any, nothing can be fitted.
    not_finite: usize,
    sums: ExactSums<MONOMIALS>,
}

impl Moments {
    /// No samples yet. `centre_ut` should lie within a field strength of the ellipsoid's centre and `scale_ut` near
    /// the field strength: moments about a far centre are badly conditioned (at 500 uT off by 1e5).
    #[must_use]
    pub fn new(centre_ut: Vector3<f64>, scale_ut: f64) -> Self {
        Self { centre_ut, scale_ut, count: 0, not_finite: 0, sums: ExactSums::ZERO }
    }

    /// Moments of a slice, centred on its mean and scaled by its spread.
    #[must_use]
    pub fn of(points_ut: &[Vector3<f64>]) -> Self {
        let n = points_ut.len().max(1) as f64;
        let centre = points_ut.iter().sum::<Vector3<f64>>() / n;
        let spread = (points_ut.iter().map(|p| (p - centre).norm_squared()).sum::<f64>() / n).sqrt();
        let mut moments = Self::new(centre, if spread > 0.0 { spread } else { 1.0 });
        points_ut.iter().for_each(|point| moments.add(point));
        moments
    }

    /// Whether every sample in the set is finite.
    pub(super) fn is_finite(&self) -> bool {
        self.not_finite == 0
    }

    /// Samples in the set.
    #[must_use]
    pub fn count(&self) -> usize {
        self.count
    }

    /// Centre of the coordinates, uT.
    #[must_use]
    pub fn centre_ut(&self) -> &Vector3<f64> {
        &self.centre_ut
    }

    /// Scale of the coordinates, uT.
    #[must_use]
    pub fn scale_ut(&self) -> f64 {
        self.scale_ut
    }

    /// A sample enters the set: constant time.
    #[inline]
    pub fn add(&mut self, raw_ut: &Vector3<f64>) {
        self.count = self.count.saturating_add(1);
        self.not_finite = self.not_finite.saturating_add(usize::from(!is_finite(raw_ut)));
        self.sums.add_times(self.monomials(raw_ut), 1);
    }

    /// A sample that was added leaves the set: constant time, and exactly undoes [`Moments::add`].
    #[inline]
    pub fn remove(&mut self, raw_ut: &Vector3<f64>) {
        self.count = self.count.saturating_sub(1);
        self.not_finite = self.not_finite.saturating_sub(usize::from(!is_finite(raw_ut)));
        self.sums.add_times(self.monomials(raw_ut), -1);
    }

    /// The monomials of one sample, in the order of [`place`].
    #[inline]
    fn monomials(&self, raw_ut: &Vector3<f64>) -> [f64; MONOMIALS] {
        let u = (raw_ut - self.centre_ut) / self.scale_ut;
        let (x, y, z) = (u.x, u.y, u.z);
        let (xx, xy, xz, yy, yz, zz) = (x * x, x * y, x * z, y * y, y * z, z * z);
        let (xxx, xxy, xxz, xyy, xyz, xzz) = (xx * x, xx * y, xx * z, x * yy, xy * z, x * zz);
        let (yyy, yyz, yzz, zzz) = (yy * y, yy * z, y * zz, zz * z);
        let (xxxx, xxxy, xxxz, xxyy, xxyz, xxzz) = (xx * xx, xxx * y, xxx * z, xx * yy, xx * yz, xx * zz);
        let (xyyy, xyyz, xyzz, xzzz) = (x * yyy, x * yyz, x * yzz, x * zzz);
        let (yyyy, yyyz, yyzz, yzzz, zzzz) = (yy * yy, yyy * z, yy * zz, y * zzz, zz * zz);
        [
            x, y, z, xx, xy, xz, yy, yz, zz, xxx, xxy, xxz, xyy, xyz, xzz, yyy, yyz, yzz, zzz, xxxx, xxxy, xxxz, xxyy,
            xxyz, xxzz, xyyy, xyyz, xyzz, xzzz, yyyy, yyyz, yyzz, yzzz, zzzz,
        ]
    }

    /// Means of the monomials, the constant 1 in front.
    fn means(&self) -> [f64; MONOMIALS + 1] {
        let n = self.count.max(1) as f64;
        let mut means = [1.0; MONOMIALS + 1];
        means[1..].copy_from_slice(&self.sums.values().map(|sum| sum / n));
        means
    }

    /// S / n and B / n, in centred and scaled coordinates.
    #[must_use]
    pub fn scatter(&self) -> (SMatrix<f64, 10, 10>, SMatrix<f64, 10, 10>) {
        let means = self.means();
        let s = SMatrix::<f64, 10, 10>::from_fn(|i, j| means[PLACES[i][j]] * (FACTORS[i] * FACTORS[j]));
        // the Laplacian of z is 2 in the squares
        let square = |i: usize, j: usize| if i < 3 { s[(j, 9)] } else { 0.0 };
        let mut b = SMatrix::<f64, 10, 10>::zeros();
        for i in 0..10 {
            for j in i..10 {
                let [x, y, z] = DERIVED.map(|by| by[i].0 * by[j].0 * s[(by[i].1, by[j].1)]);
                b[(i, j)] = x + y + z + square(i, j) + square(j, i);
            }
        }
        b.fill_lower_triangle_with_upper_triangle();
        (s, b)
    }

    /// Covariance of the samples, uT^2: how thick the cloud is in each direction.
    #[must_use]
    pub fn cloud_covariance_ut2(&self) -> Matrix3<f64> {
        let [_, x, y, z, xx, xy, xz, yy, yz, zz] = *self.means().first_chunk::<10>().expect("35 means");
        let mean = Vector3::new(x, y, z);
        (Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz) - mean * mean.transpose()) * (self.scale_ut * self.scale_ut)
    }
}

fn is_finite(v: &Vector3<f64>) -> bool {
    v.iter().all(|component| component.is_finite())
}
