//! Samples and the direct fit that both the benchmark and the instruction count use.

#![allow(clippy::disallowed_methods, reason = "no reading is compared to the bit here")]

use magcomp::nalgebra::{Matrix3, Rotation3, SMatrix, SVector, Vector3};
use magcomp::{
    Compensator, Config, FitOptions, MagneticSample, Method, Moments, Residual, RotationRateSample, UpSample,
};

/// Centre and field strength of the samples, uT.
pub const OFFSET_UT: Vector3<f64> = Vector3::new(60.0, -75.0, 410.0);
/// Field strength, uT.
pub const FIELD_UT: f64 = 50.0;

/// Evenly spread raw samples with 1.58 uT of noise (30 dB), from a fixed congruential sequence.
pub fn samples(count: usize) -> Vec<Vector3<f64>> {
    let mut normal = normal();
    (0..count)
        .map(|_| {
            let u = Vector3::new(normal(), normal(), normal()).normalize();
            SOFT_IRON * u * FIELD_UT + OFFSET_UT + Vector3::new(normal(), normal(), normal()) * 1.58
        })
        .collect()
}

const SOFT_IRON: Matrix3<f64> = Matrix3::new(1.05, 0.06, -0.05, 0.06, 0.95, 0.08, -0.05, 0.08, 1.0);

/// Normal deviates from a fixed congruential sequence.
pub fn normal() -> impl FnMut() -> f64 {
    let mut state = 7_u64;
    let mut uniform = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    move || (-2.0 * (1.0 - uniform()).ln()).sqrt() * (std::f64::consts::TAU * uniform()).cos()
}

/// A phone turned over in the hand, `rate_hz` samples a second: gyroscope, gravity and magnetometer (0.5 uT of noise), hard iron stepping
/// by 50 % every 10 s, so that a tenth of the samples or so run the hypotheses too.
pub fn turning(rate_hz: usize, count: usize) -> Vec<(RotationRateSample, UpSample, MagneticSample)> {
    let dt_s = 1.0 / rate_hz as f64;
    let mut normal = normal();
    let mut noise = move |sd: f64| Vector3::new(normal(), normal(), normal()) * sd;
    let field_ut = Vector3::new(0.0, 25.0, -43.3);
    let mut attitude = Rotation3::identity();
    (0..count)
        .map(|k| {
            let time_s = k as f64 * dt_s;
            let rate = Vector3::new((1.1 * time_s).sin(), (0.7 * time_s).cos(), (0.5 * time_s + 1.0).sin());
            attitude *= Rotation3::new(rate * dt_s);
            let offset_ut = OFFSET_UT * if (k / (10 * rate_hz)).is_multiple_of(2) { 1.0 } else { 1.5 };
            let time_ns = (k as i64 + 1) * 1_000_000_000 / rate_hz as i64;
            (
                RotationRateSample { time_ns, rate_rad_s: rate + noise(0.003) },
                UpSample { time_ns, up_m_s2: attitude.inverse() * Vector3::new(0.0, 0.0, 9.81) + noise(0.05) },
                MagneticSample {
                    time_ns,
                    field_ut: SOFT_IRON * (attitude.inverse() * field_ut) + offset_ut + noise(0.5),
                },
            )
        })
        .collect()
}

/// Eq. (10) sample by sample: Gauss-Newton over T = M^-1 (six numbers) and b, to a step of 1e-10 field strengths.
pub fn direct_fit(points: &[Vector3<f64>], start: (Matrix3<f64>, Vector3<f64>)) -> (Matrix3<f64>, Vector3<f64>, usize) {
    let (mut t, mut b) = start;
    for iteration in 1..=50 {
        let mut hessian = SMatrix::<f64, 9, 9>::zeros();
        let mut gradient = SVector::<f64, 9>::zeros();
        for point in points {
            let v = point - b;
            let u = t * v;
            let residual = u.norm_squared() - 1.0;
            let tu = t * u;
            let row = SVector::<f64, 9>::from_column_slice(&[
                2.0 * u.x * v.x,
                2.0 * u.y * v.y,
                2.0 * u.z * v.z,
                2.0 * (u.x * v.y + u.y * v.x),
                2.0 * (u.x * v.z + u.z * v.x),
                2.0 * (u.y * v.z + u.z * v.y),
                -2.0 * tu.x,
                -2.0 * tu.y,
                -2.0 * tu.z,
            ]);
            hessian.ger(1.0, &row, &row, 1.0);
            gradient.axpy(residual, &row, 1.0);
        }
        let Some(cholesky) = hessian.cholesky() else { return (t, b, iteration) };
        let step = -cholesky.solve(&gradient);
        t += Matrix3::new(step[0], step[3], step[4], step[3], step[1], step[5], step[4], step[5], step[2]);
        b += step.fixed_rows::<3>(6);
        let size = (step.fixed_rows::<6>(0).amax() * FIELD_UT).max(step.fixed_rows::<3>(6).amax() / FIELD_UT);
        if size <= 1e-10 {
            return (t, b, iteration);
        }
    }
    (t, b, 50)
}

/// A compensator whose window is held at `window` samples of even orientations (their sigma_T is 0.72).
pub fn compensator(window: usize) -> Compensator {
    let n_max = if window <= 100 { 100 } else { (100.0 + (window as f64 - 100.0) / (1.0 - 0.7232)) as usize };
    let mut config = Config::default();
    (config.method, config.windowed.n_min, config.windowed.n_max) = (Method::Windowed, 100, n_max);
    Compensator::new(config).expect("a valid config")
}

/// Options of a fit in a stream.
pub fn stream_options(residual: Residual) -> FitOptions {
    let mut options = FitOptions::default();
    (options.residual, options.tolerance) = (residual, 1e-6);
    options
}

/// The start a warm direct fit of `points` has: the fit of the window one sample earlier.
pub fn warm_start(points: &[Vector3<f64>]) -> (Matrix3<f64>, Vector3<f64>) {
    let mut moments = Moments::new(OFFSET_UT, FIELD_UT);
    points[1..].iter().for_each(|point| moments.add(point));
    let warm = moments.fit(&stream_options(Residual::Algebraic)).expect("an even window fits").calibration;
    (warm.soft_iron_inverse() / warm.field_strength_ut(), *warm.hard_iron_ut())
}
