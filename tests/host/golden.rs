//! The core against vectors written by the numpy references in `tests/reference`.

use magcomp::nalgebra::{SMatrix, Vector3};
use magcomp::{
    Calibration, Disturbance, EllipsoidFit, FactoryErrors, FitOptions, Normalisation, Residual, fit_ellipsoid,
    uniformity, window_length,
};
use magcomp_tests::{Random, calibration, difference, direct_fit, matrix, vectors};
use serde::Deserialize;

type Rows = [[f64; 3]; 3];

#[derive(Deserialize)]
struct Ellipsoids {
    cases: Vec<EllipsoidCase>,
}

#[derive(Deserialize)]
struct EllipsoidCase {
    name: String,
    known_field_ut: f64,
    true_soft_iron: Rows,
    true_hard_iron_ut: Vector3<f64>,
    noise_ut: f64,
    points_ut: Vec<Vector3<f64>>,
    algebraic: BothGauges,
    corrected: BothGauges,
}

#[derive(Deserialize)]
struct BothGauges {
    known_field: Answer,
    unit_determinant: Answer,
}

#[derive(Deserialize)]
struct Answer {
    field_strength_ut: f64,
    soft_iron: Rows,
    hard_iron_ut: Vector3<f64>,
    noise_ut: Option<f64>,
    covariance: Option<Vec<Vec<f64>>>,
}

impl Answer {
    fn calibration(&self) -> Calibration {
        Calibration::new(matrix(&self.soft_iron), self.hard_iron_ut, self.field_strength_ut).expect("a calibration")
    }
}

impl EllipsoidCase {
    /// Every residual and gauge: what it is called, the options, the reference.
    fn answers(&self) -> [(&'static str, FitOptions, &Answer); 4] {
        let options = |residual, field_strength_ut| FitOptions {
            residual,
            field_strength_ut,
            noise_floor_ut: 0.0,
            ..FitOptions::default()
        };
        let known = Some(self.known_field_ut);
        [
            ("algebraic, known field", options(Residual::Algebraic, known), &self.algebraic.known_field),
            ("algebraic, det M = 1", options(Residual::Algebraic, None), &self.algebraic.unit_determinant),
            ("corrected, known field", options(Residual::Corrected, known), &self.corrected.known_field),
            ("corrected, det M = 1", options(Residual::Corrected, None), &self.corrected.unit_determinant),
        ]
    }

    fn fit(&self, options: &FitOptions) -> EllipsoidFit {
        fit_ellipsoid(&self.points_ut, options).unwrap_or_else(|error| panic!("{}: {error}", self.name))
    }
}

#[test]
fn ellipsoids_agree_to_1e_9() {
    for case in vectors::<Ellipsoids>("ellipsoid.json").cases {
        for (what, options, answer) in case.answers() {
            let fit = case.fit(&options);
            let off = difference(&fit.calibration, &answer.calibration());
            let field = (fit.calibration.field_strength_ut() / answer.field_strength_ut - 1.0).abs();
            assert!(off < 1e-9 && field < 1e-9, "{}, {what}: off by {off:.1e}, field by {field:.1e}", case.name);
            assert_eq!(fit.samples, case.points_ut.len());
        }
    }
}

#[test]
fn the_direct_fit_of_this_crate_agrees_with_numpy() {
    for case in vectors::<Ellipsoids>("ellipsoid.json").cases {
        let truth = Calibration::new(matrix(&case.true_soft_iron), case.true_hard_iron_ut, case.known_field_ut);
        let truth = truth.expect("a calibration");
        for (residual, answer) in [(Residual::Algebraic, &case.algebraic), (Residual::Corrected, &case.corrected)] {
            // nine exact points leave nothing to correct, and no C / D to speak of
            if case.noise_ut == 0.0 && residual == Residual::Corrected {
                continue;
            }
            let off = difference(&direct_fit(&case.points_ut, residual, &truth), &answer.known_field.calibration());
            assert!(off < 1e-10, "{}, {residual:?}: off by {off:.1e}", case.name);
        }
    }
}

#[test]
fn noise_and_covariance_agree_with_numerical_jacobians() {
    for case in vectors::<Ellipsoids>("ellipsoid.json").cases {
        for (what, options, answer) in case.answers() {
            let (Some(noise_ut), Some(rows)) = (answer.noise_ut, &answer.covariance) else { continue };
            let fit = case.fit(&options);
            let expected = SMatrix::<f64, 9, 9>::from_fn(|i, j| rows[i][j]);
            let ratio = fit.residual_rms_ut / noise_ut;
            assert!((ratio - 1.0).abs() < 0.05, "{}, {what}: noise {ratio:.4} of the reference's", case.name);
            let diagonal = expected.diagonal().map(f64::sqrt);
            let off = (fit.covariance - expected).component_div(&(diagonal * diagonal.transpose()));
            let worst = off.abs().max();
            // both are estimates: the core takes one gradient for all samples and the noise's own share off its
            // information, the reference each sample's own gradient and its foot point
            let share = match options.residual {
                _ if fit.axis_ratio > 1.5 => 0.35,
                Residual::Algebraic => 0.17,
                Residual::Corrected => 0.10,
            };
            assert!(worst < share, "{}, {what}: covariance off by {:.1} %", case.name, worst * 100.0);
        }
    }
}

#[derive(Deserialize)]
struct Model {
    compose: Vec<Composed>,
    polar: Vec<Polar>,
    correct: Vec<Corrected>,
    sigma_t: Vec<SigmaT>,
}

#[derive(Deserialize)]
struct Composed {
    scale: Vector3<f64>,
    axes: Rows,
    offset_ut: Vector3<f64>,
    disturbance_soft_iron: Rows,
    disturbance_hard_iron_ut: Vector3<f64>,
    m: Rows,
    b_ut: Vector3<f64>,
    field_ut: Vector3<f64>,
    raw_ut: Vector3<f64>,
}

#[derive(Deserialize)]
struct Polar {
    m: Rows,
    p: Rows,
    r: Rows,
}

#[derive(Deserialize)]
struct Corrected {
    m: Rows,
    b_ut: Vector3<f64>,
    field_ut: Vector3<f64>,
    raw_ut: Vector3<f64>,
}

#[derive(Deserialize)]
struct SigmaT {
    name: String,
    field_ut: Vec<Vector3<f64>>,
    half_range: f64,
    even_sphere: f64,
    window: Windows,
}

#[derive(Deserialize)]
struct Windows {
    half_range: usize,
    even_sphere: usize,
}

#[test]
fn factory_errors_and_disturbance_compose() {
    for case in vectors::<Model>("model.json").compose {
        let factory = FactoryErrors { scale: case.scale, axes: matrix(&case.axes), offset_ut: case.offset_ut };
        let disturbance =
            Disturbance { soft_iron: matrix(&case.disturbance_soft_iron), hard_iron_ut: case.disturbance_hard_iron_ut };
        let (m, b) = factory.compose(&disturbance).expect("the axes are independent");
        assert!((m - matrix(&case.m)).abs().max() < 1e-14);
        assert!((b - case.b_ut).abs().max() < 1e-11);
        assert!((m * case.field_ut + b - case.raw_ut).abs().max() < 1e-11);
        // what the gauge drops is a rotation of the corrected field
        let (calibration, dropped) = Calibration::from_any(m, b, 50.0).expect("invertible");
        assert!((calibration.correct(&case.raw_ut) - dropped * case.field_ut).abs().max() < 1e-10);
    }
}

#[test]
fn the_gauge_is_the_polar_decomposition() {
    for case in vectors::<Model>("model.json").polar {
        let (found, rotation) = Calibration::from_any(matrix(&case.m), Vector3::zeros(), 50.0).expect("invertible");
        assert!((found.soft_iron() - matrix(&case.p)).abs().max() < 1e-12);
        assert!((rotation.matrix() - matrix(&case.r)).abs().max() < 1e-12);
    }
}

#[test]
fn correcting_and_distorting() {
    for case in vectors::<Model>("model.json").correct {
        let calibration = Calibration::new(matrix(&case.m), case.b_ut, 50.0).expect("a calibration");
        assert!((calibration.correct(&case.raw_ut) - case.field_ut).abs().max() < 1e-11);
        assert!((calibration.distort(&case.field_ut) - case.raw_ut).abs().max() < 1e-11);
    }
}

#[test]
fn sigma_t_and_the_window() {
    for case in vectors::<Model>("model.json").sigma_t {
        for (normalisation, expected, window) in [
            (Normalisation::HalfRange, case.half_range, case.window.half_range),
            (Normalisation::EvenSphere, case.even_sphere, case.window.even_sphere),
        ] {
            let found = uniformity(case.field_ut.iter().copied(), normalisation);
            assert!((found - expected).abs() < 1e-12, "{}, {normalisation:?}: {found} {expected}", case.name);
            assert_eq!(window_length(found, 100, 2000), window, "{}, {normalisation:?}", case.name);
        }
    }
}

#[test]
fn even_orientations_give_the_papers_figures() {
    let mut random = Random::new(20);
    let even: Vec<_> = (0..200_000).map(|_| random.direction()).collect();
    let half = uniformity(even.iter().copied(), Normalisation::HalfRange);
    assert!((half - 0.723).abs() < 0.002, "{half}");
    assert!(window_length(half, 100, 2000).abs_diff(626) <= 4);
    let sphere = uniformity(even, Normalisation::EvenSphere);
    assert!((sphere - 1.0).abs() < 0.003, "{sphere}");
}

#[derive(Deserialize)]
struct Bounds {
    parameters: [f64; 9],
    cases: Vec<Bound>,
}

#[derive(Deserialize)]
struct Bound {
    samples: usize,
    snr_db: f64,
    sigma: [f64; 9],
}

/// Even directions by the rule of `common.py`.
fn fibonacci(count: usize) -> Vec<Vector3<f64>> {
    let turn = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let at = |k: usize| {
        let z = 1.0 - (2 * k + 1) as f64 / count as f64;
        let flat = (1.0 - z * z).sqrt();
        let phi = k as f64 * turn;
        Vector3::new(flat * phi.cos(), flat * phi.sin(), z)
    };
    (0..count).map(at).collect()
}

#[test]
fn the_reported_covariance_is_the_cramer_rao_bound() {
    let bounds: Bounds = vectors("crb.json");
    let field = 40.0;
    let truth = calibration(&bounds.parameters, field);
    let options = FitOptions { field_strength_ut: Some(field), ..FitOptions::default() };
    let runs = 100;
    for case in bounds.cases.iter().filter(|case| case.samples >= 100) {
        let noise_ut = field * 10.0_f64.powf(-case.snr_db / 20.0);
        let mut random = Random::new(30 + case.samples as u64);
        let mut ratios = [0.0; 9];
        for _ in 0..runs {
            let raw = fibonacci(case.samples).into_iter().map(|u| truth.distort(&(u * field)));
            let raw: Vec<_> = raw.map(|h| h + random.normal3() * noise_ut).collect();
            let fit = fit_ellipsoid(&raw, &options).expect("an ellipsoid");
            for (i, ratio) in ratios.iter_mut().enumerate() {
                let unit = if i < 3 { field } else { 1.0 };
                *ratio += fit.covariance[(i, i)].sqrt() / unit / case.sigma[i] / f64::from(runs);
            }
        }
        for (i, ratio) in ratios.into_iter().enumerate() {
            // all samples weigh alike, whatever their direction: worth 4.5 % of sigma at the most for this M
            assert!((ratio - 1.0).abs() < 0.055, "N {}, SNR {}: parameter {i}: {ratio}", case.samples, case.snr_db);
        }
    }
}

/// The estimates themselves reach the bound: mean square error over it, and so does their reported covariance.
#[test]
fn the_corrected_fit_reaches_the_cramer_rao_bound() {
    let bounds: Bounds = vectors("crb.json");
    let field = 40.0;
    let truth = calibration(&bounds.parameters, field);
    let options = FitOptions { field_strength_ut: Some(field), ..FitOptions::default() };
    let runs = 400;
    for case in bounds.cases.iter().filter(|case| case.samples == 1000) {
        let noise_ut = field * 10.0_f64.powf(-case.snr_db / 20.0);
        let mut random = Random::new(40 + case.snr_db as u64);
        let mut squares = [0.0; 3];
        for _ in 0..runs {
            let raw = fibonacci(case.samples).into_iter().map(|u| truth.distort(&(u * field)));
            let raw: Vec<_> = raw.map(|h| h + random.normal3() * noise_ut).collect();
            let fit = fit_ellipsoid(&raw, &options).expect("an ellipsoid");
            let off = magcomp_tests::nine(&fit.calibration) - magcomp_tests::nine(&truth);
            for i in 0..9 {
                let unit = if i < 3 { field } else { 1.0 };
                squares[i / 3] += (off[i] / unit / case.sigma[i]).powi(2) / 3.0 / f64::from(runs);
            }
        }
        // 400 runs of 3 parameters: 2 % of chance at one standard deviation
        for (group, square) in ["b", "M diagonal", "M off-diagonal"].into_iter().zip(squares) {
            let ratio = square.sqrt();
            assert!((0.93..1.07).contains(&ratio), "SNR {}: {group} {ratio:.3} of the bound", case.snr_db);
        }
    }
}
