//! What the host tests share: seeded data, a fit sample by sample, vectors read from `tests/vectors`.

pub mod fuzz;
mod phone;

pub use phone::{PERIOD_NS, Phone};

use magcomp::nalgebra::{Matrix3, SMatrix, SVector, UnitQuaternion, Vector3, Vector4};
use magcomp::{Calibration, MagneticSample, Method, Residual};
use rand::SeedableRng;
use rand::rngs::ChaCha12Rng;
use rand_distr::{Distribution, StandardNormal, UnitSphere};
use serde::de::DeserializeOwned;

/// Every way to choose.
pub const METHODS: [Method; 5] = [Method::Auto, Method::Aided, Method::Adaptive, Method::Windowed, Method::Constant];

/// Nine parameters, in the order b_x b_y b_z m_xx m_yy m_zz m_xy m_xz m_yz.
pub type Nine = SVector<f64, 9>;

/// The reference set REF: b in field strengths, then M.
pub const REF: [f64; 9] = [0.30, -0.20, 1.32, 1.05, 0.95, 1.00, 0.06, -0.05, 0.08];

/// A file of `tests/vectors`.
///
/// # Panics
/// When it is missing or not of this form.
pub fn vectors<T: DeserializeOwned>(name: &str) -> T {
    let path = format!("{}/vectors/{name}", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"));
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// A symmetric matrix from [xx, yy, zz, xy, xz, yz].
pub fn symmetric(m: &[f64]) -> Matrix3<f64> {
    Matrix3::new(m[0], m[3], m[4], m[3], m[1], m[5], m[4], m[5], m[2])
}

/// A matrix from its rows.
pub fn matrix(rows: &[[f64; 3]; 3]) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| rows[i][j])
}

/// The nine parameters of a calibration.
pub fn nine(c: &Calibration) -> Nine {
    let (b, m) = (c.hard_iron_ut(), c.soft_iron());
    Nine::from_column_slice(&[b.x, b.y, b.z, m.m11, m.m22, m.m33, m.m12, m.m13, m.m23])
}

/// Nine parameters as a calibration: b in field strengths.
///
/// # Panics
/// When M is not positive definite.
pub fn calibration(parameters: &[f64; 9], field_ut: f64) -> Calibration {
    let b = Vector3::from_column_slice(&parameters[..3]) * field_ut;
    Calibration::new(symmetric(&parameters[3..]), b, field_ut).expect("a calibration")
}

/// Largest difference of two calibrations seen through the field: of M, and of b in field strengths.
pub fn difference(a: &Calibration, b: &Calibration) -> f64 {
    let m = (a.soft_iron() - b.soft_iron()).abs().max();
    m.max((a.hard_iron_ut() - b.hard_iron_ut()).abs().max() / b.field_strength_ut())
}

/// Largest angle, degrees, between true directions and those corrected by `found`, over an even set.
pub fn worst_direction_deg(found: &Calibration, truth: &Calibration) -> f64 {
    let mut random = Random::new(1);
    let field = truth.field_strength_ut();
    let angles = (0..500).map(|_| {
        let h = random.direction() * field;
        found.correct(&truth.distort(&h)).angle(&h).to_degrees()
    });
    angles.fold(0.0, f64::max)
}

/// Seeded data, the same on every machine.
pub struct Random(ChaCha12Rng);

impl Random {
    /// A stream of its own for each seed.
    pub fn new(seed: u64) -> Self {
        Self(ChaCha12Rng::seed_from_u64(seed))
    }

    /// Even on the sphere.
    pub fn direction(&mut self) -> Vector3<f64> {
        Vector3::from(UnitSphere.sample(&mut self.0))
    }

    /// Even on the part of the sphere within `angle_deg` of `axis` (a unit vector).
    pub fn on_cap(&mut self, axis: &Vector3<f64>, angle_deg: f64) -> Vector3<f64> {
        loop {
            let u = self.direction();
            if u.dot(axis) >= angle_deg.to_radians().cos() {
                return u;
            }
        }
    }

    /// Standard normal.
    pub fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    /// Three standard normals.
    pub fn normal3(&mut self) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.normal())
    }

    /// Even in [low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        rand::RngExt::random_range(&mut self.0, low..high)
    }

    /// Any attitude, evenly.
    pub fn attitude(&mut self) -> UnitQuaternion<f64> {
        UnitQuaternion::new_normalize(Vector4::from_fn(|_, _| self.normal()).into())
    }

    /// Raw samples of even directions through a calibration, with noise in uT.
    pub fn raw(&mut self, through: &Calibration, noise_ut: f64, count: usize) -> Vec<Vector3<f64>> {
        (0..count).map(|_| self.raw_one(through, noise_ut)).collect()
    }

    /// One raw sample of an even direction.
    pub fn raw_one(&mut self, through: &Calibration, noise_ut: f64) -> Vector3<f64> {
        let h = self.direction() * through.field_strength_ut();
        through.distort(&h) + self.normal3() * noise_ut
    }
}

/// A sample at 100 Hz.
pub fn sample(k: usize, field_ut: Vector3<f64>) -> MagneticSample {
    MagneticSample { time_ns: 1_000_000_000 + k as i64 * 10_000_000, field_ut }
}

/// What the rounding of a cost may add to it: closer to the minimum the gradient alone says where it is.
const ROUNDING: f64 = 1.0 + 1e-11;

/// Eq. (10) minimised sample by sample, written from the paper: r = |T (h_m - b)|^2 - 1, T = M^-1 / |h| symmetric.
/// `Corrected` minimises C / D, C = sum r^2, D = sum |grad r|^2 + 2 r |T|^2 (half the Laplacian of r is |T|^2).
///
/// `start` is where it begins, and its field strength is that of the result.
///
/// # Panics
/// When the iteration does not converge.
pub fn direct_fit(raw_ut: &[Vector3<f64>], residual: Residual, start: &Calibration) -> Calibration {
    let (field, origin) = (start.field_strength_ut(), *start.hard_iron_ut());
    let points: Vec<_> = raw_ut.iter().map(|p| (p - origin) / field).collect();
    let mut theta = SVector::<f64, 9>::zeros();
    let t = start.soft_iron_inverse();
    theta.fixed_rows_mut::<6>(0).copy_from_slice(&[t.m11, t.m22, t.m33, t.m12, t.m13, t.m23]);
    let mut now = Sums::of(&points, &theta);
    let (mut damping, mut latest) = (0.0, f64::INFINITY);
    for _ in 0..2000 {
        let (lambda, trial_gradient) = match residual {
            Residual::Algebraic => (0.0, now.c_gradient),
            Residual::Corrected => (now.c / now.d, now.c_gradient - now.d_gradient * (now.c / now.d)),
        };
        let damped = now.normal + SMatrix::<f64, 9, 9>::from_diagonal(&(now.normal.diagonal() * damping));
        let step = -damped.cholesky().expect("samples determine the ellipsoid").solve(&trial_gradient);
        let next = Sums::of(&points, &(theta + step));
        let lower = match residual {
            Residual::Algebraic => next.c <= now.c * ROUNDING,
            Residual::Corrected => next.c <= lambda * next.d * ROUNDING,
        };
        let size = step.amax();
        // steps shrink from one to the next until rounding stops them
        if damping == 0.0 && (size < 1e-14 || (size < 1e-12 && size >= latest)) {
            let t = symmetric(&theta.as_slice()[..6]);
            let b = origin + theta.fixed_rows::<3>(6) * field;
            let inverse = t.try_inverse().expect("T is invertible");
            return Calibration::new((inverse + inverse.transpose()) * 0.5, b, field).expect("an ellipsoid");
        }
        if lower {
            latest = size;
            (theta, now) = (theta + step, next);
            damping = if damping > 1e-6 { damping * 0.1 } else { 0.0 };
        } else {
            damping = f64::max(damping * 10.0, 1e-4);
        }
    }
    panic!("the direct fit does not converge");
}

/// C, D, half their gradients and the normal matrix at theta = [T_xx T_yy T_zz T_xy T_xz T_yz beta].
struct Sums {
    c: f64,
    d: f64,
    c_gradient: Nine,
    d_gradient: Nine,
    normal: SMatrix<f64, 9, 9>,
}

impl Sums {
    fn of(points: &[Vector3<f64>], theta: &Nine) -> Self {
        const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
        let t = symmetric(&theta.as_slice()[..6]);
        let beta = theta.fixed_rows::<3>(6).into_owned();
        let size = t.norm_squared();
        let mut sums = Self {
            c: 0.0,
            d: 0.0,
            c_gradient: Nine::zeros(),
            d_gradient: Nine::zeros(),
            normal: SMatrix::<f64, 9, 9>::zeros(),
        };
        for u in points {
            let v = u - beta;
            let q = t * v;
            let w = t * q; // half the gradient of r
            let r = q.norm_squared() - 1.0;
            let mut jacobian = Nine::zeros();
            let mut slope = Nine::zeros(); // half the gradient of 4 |w|^2 + 2 r |T|^2
            for (k, (i, j)) in PAIRS.into_iter().enumerate() {
                // E v and E q for the elementary symmetric matrix E_ij
                let (mut ev, mut eq) = (Vector3::zeros(), Vector3::zeros());
                (ev[i], eq[i]) = (v[j], q[j]);
                (ev[j], eq[j]) = (v[i], q[i]);
                jacobian[k] = 2.0 * q.dot(&ev);
                let of_size = if i == j { 2.0 * t[(i, j)] } else { 4.0 * t[(i, j)] };
                slope[k] = 4.0 * w.dot(&(eq + t * ev)) + size * jacobian[k] + r * of_size;
            }
            let across = w * -2.0;
            jacobian.fixed_rows_mut::<3>(6).copy_from(&across);
            slope.fixed_rows_mut::<3>(6).copy_from(&(t * t * w * -4.0 + across * size));
            sums.c += r * r;
            sums.d += 4.0 * w.norm_squared() + 2.0 * r * size;
            sums.c_gradient += jacobian * r;
            sums.d_gradient += slope;
            sums.normal += jacobian * jacobian.transpose();
        }
        sums
    }
}
