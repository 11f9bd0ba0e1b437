//! Against the mixture of the module, conditioned by information matrices and derivatives by finite differences.

use super::*;
use nalgebra::DMatrix;

const SECOND: i64 = 1_000_000_000;
const HOUR: i64 = 3600;

fn calibration() -> Calibration {
    let soft_iron = Matrix3::new(1.1, 0.1, -0.05, 0.1, 0.9, 0.08, -0.05, 0.08, 1.05);
    Calibration::new(soft_iron, Vector3::new(30.0, -200.0, 80.0), 48.0).unwrap()
}

fn learned(inclination_deg: Option<f64>) -> KeptCalibration {
    KeptCalibration::learned(calibration(), independent(1.5, 4e-4), inclination_deg, 1000).unwrap()
}

/// What is known beforehand: for each size of a change its probability and the covariance of x.
fn prior(kept: &KeptCalibration, holds: f64, is_learned: bool) -> Vec<(f64, Matrix9)> {
    let of = |k: usize| {
        let size_ut = if k == 0 && !is_learned { 0.0 } else { 2.0_f64.powi(k as i32 + 1) };
        let iron = (0.003 * size_ut).min(0.08);
        let unit = |i: usize| if i < 3 { size_ut.powi(2) } else { iron.powi(2) * if i < 6 { 1.0 } else { 0.5 } };
        let weight = if k == 0 { holds } else { (1.0 - holds) / 8.0 };
        (weight, kept.covariance() + Matrix9::from_diagonal(&Vector9::from_fn(|i, _| unit(i))))
    };
    (0..=8).map(of).collect()
}

/// M and b that are off by x: what a raw sample is corrected to.
fn corrected(x: &Vector9, raw_ut: &Vector3<f64>) -> Vector3<f64> {
    let soft_iron = calibration().soft_iron() + symmetric(&x.fixed_rows::<6>(3).into_owned());
    soft_iron.try_inverse().unwrap() * (raw_ut - calibration().hard_iron_ut() - x.fixed_rows::<3>(0))
}

/// Probability, mean and covariance after what is expected differs by r from what a function of x gives at 0.
fn conditioned<const N: usize>(
    prior: Vec<(f64, Vector9, Matrix9)>,
    r: &SVector<f64, N>,
    found: impl Fn(&Vector9) -> SVector<f64, N>,
    noise: &SMatrix<f64, N, N>,
) -> Vec<(f64, Vector9, Matrix9)> {
    let step = 1e-5;
    let h = SMatrix::<f64, N, 9>::from_fn(|i, k| {
        let moved = |sign: f64| found(&Vector9::ith(k, sign * step))[i];
        (moved(1.0) - moved(-1.0)) / (2.0 * step)
    });
    let noise_inverse = noise.try_inverse().unwrap();
    let one = |(weight, mean, covariance): (f64, Vector9, Matrix9)| {
        let before = covariance.try_inverse().unwrap();
        let after = (before + h.transpose() * noise_inverse * h).try_inverse().unwrap();
        let off = r - h * mean;
        let spread = h * covariance * h.transpose() + noise;
        let log = -0.5
            * (off.dot(&(spread.try_inverse().unwrap() * off))
                + DMatrix::from_fn(N, N, |i, j| spread[(i, j)]).determinant().ln());
        (weight * log.exp(), after * (before * mean + h.transpose() * noise_inverse * r), after)
    };
    prior.into_iter().map(one).collect()
}

/// Mean and covariance of the mixture.
fn mixed(all: &[(f64, Vector9, Matrix9)]) -> (Vector9, Matrix9) {
    let sum: f64 = all.iter().map(|it| it.0).sum();
    let mean = all.iter().map(|it| it.1 * (it.0 / sum)).sum::<Vector9>();
    let second = all.iter().map(|it| (it.2 + it.1 * it.1.transpose()) * (it.0 / sum)).sum::<Matrix9>();
    (mean, second - mean * mean.transpose())
}

fn assert_believed(adopted: &Adopted, expected: &[(f64, Vector9, Matrix9)]) {
    let (mean, covariance) = mixed(expected);
    let believed = adopted.believed().unwrap();
    let hard_iron_ut = calibration().hard_iron_ut() + mean.fixed_rows::<3>(0);
    let soft_iron = calibration().soft_iron() + symmetric(&mean.fixed_rows::<6>(3).into_owned());
    assert!(
        (believed.calibration.hard_iron_ut() - hard_iron_ut).amax() < 1e-5,
        "{}",
        believed.calibration.hard_iron_ut()
    );
    assert!((believed.calibration.soft_iron() - soft_iron).amax() < 1e-8);
    assert_eq!(believed.calibration.field_strength_ut(), 48.0);
    let scale = Vector9::from_fn(|i, _| covariance[(i, i)].sqrt());
    let off = Matrix9::from_fn(|i, j| (believed.covariance[(i, j)] - covariance[(i, j)]) / (scale[i] * scale[j]));
    assert!(off.amax() < 1e-5, "{off}");
}

fn with_mean(prior: Vec<(f64, Matrix9)>) -> Vec<(f64, Vector9, Matrix9)> {
    prior.into_iter().map(|(weight, covariance)| (weight, Vector9::zeros(), covariance)).collect()
}

fn level(c: &Vector3<f64>, up: &Vector3<f64>) -> Vector2<f64> {
    Vector2::new(-c.dot(up), (c - up * c.dot(up)).norm())
}

#[test]
fn the_first_sample_with_a_vertical_tells_the_parts_down_and_level() {
    let up = Vector3::new(0.2, -0.3, 0.8).normalize();
    let kept = learned(Some(55.0));
    // a field of another dip, beside 6 uT of a change
    let raw_ut = calibration().distort(&(Vector3::new(10.0, 28.0, -39.0))) + Vector3::new(4.0, -3.0, 3.5);
    let expected = Vector2::new(55.0_f64.to_radians().sin(), 55.0_f64.to_radians().cos()) * 48.0;
    let r = expected - level(&corrected(&Vector9::zeros(), &raw_ut), &up);
    for (unix_time_s, holds) in
        [(Some(1000), 0.9), (Some(1000 + 3 * HOUR), 0.9 * (-0.5_f64).exp()), (Some(999), 0.0), (None, 0.0)]
    {
        let mut adopted = Adopted::new(&kept, unix_time_s);
        assert!(adopted.see(&MagneticSample { time_ns: 0, field_ut: raw_ut }, Some(&up)));
        let found = |x: &Vector9| level(&corrected(x, &raw_ut), &up);
        let after = conditioned(with_mean(prior(&kept, holds, true)), &r, found, &(Matrix2::identity() * 8.0));
        let (_, covariance) = mixed(&after);
        if covariance.fixed_view::<3, 3>(0, 0).trace() / 3.0 < 39.0 * 39.0 {
            assert_believed(&adopted, &after);
        } else {
            assert_eq!(adopted.believed(), None, "so little is known that a start from nothing is as good");
        }
        // one sample is all that is asked
        let before = adopted;
        assert!(!adopted.see(&MagneticSample { time_ns: SECOND, field_ut: raw_ut }, Some(&up)));
        assert_eq!(adopted, before);
    }
}

#[test]
fn without_a_dip_the_length_is_told_and_then_the_systems_hard_iron() {
    let kept = KeptCalibration::given(calibration(), 3.0).unwrap();
    let raw_ut = calibration().distort(&(Vector3::new(10.0, 28.0, -39.0))) + Vector3::new(4.0, -3.0, 3.5);
    let mut adopted = Adopted::new(&kept, None);
    assert!(adopted.see(&MagneticSample { time_ns: 0, field_ut: raw_ut }, None));
    let length = |x: &Vector9| SVector::<f64, 1>::new(corrected(x, &raw_ut).norm());
    let r = SVector::<f64, 1>::new(48.0) - length(&Vector9::zeros());
    // what was given says itself how well it holds; of 400 one never held
    let prior = prior(&kept, 0.9975, false);
    let after = conditioned(with_mean(prior), &r, length, &SMatrix::<f64, 1, 1>::new(8.0));
    assert_believed(&adopted, &after);

    let off = Vector3::new(3.0, -4.0, 2.0);
    let hard_iron_ut = calibration().hard_iron_ut() + off;
    let system = Calibration::new(*calibration().soft_iron(), hard_iron_ut, 48.0).unwrap();
    let system = KeptCalibration::system(system, 1.7).unwrap();
    assert!(adopted.hear(&system));
    let hard_iron = |x: &Vector9| x.fixed_rows::<3>(0).into_owned();
    let after = conditioned(after, &off, hard_iron, &(Matrix3::identity() * (1.7 * 1.7)));
    assert_believed(&adopted, &after);
    // the same system says the same again
    assert!(!adopted.hear(&system));
    assert!(!Adopted::new(&system, None).hear(&system));
}

#[test]
fn a_vertical_is_waited_for_for_a_second_where_there_is_a_dip() {
    let see = |adopted: &mut Adopted, time_ns| {
        adopted.see(&MagneticSample { time_ns, field_ut: calibration().distort(&(Vector3::x() * 48.0)) }, None)
    };
    let mut adopted = Adopted::new(&learned(Some(55.0)), Some(1000));
    assert!(!see(&mut adopted, 7) && !see(&mut adopted, 6 + SECOND) && see(&mut adopted, 7 + SECOND));
    assert!(see(&mut Adopted::new(&learned(None), Some(1000)), 7));
}

#[test]
fn what_was_kept_for_years_is_no_better_than_a_start_from_nothing() {
    assert_eq!(Adopted::new(&learned(None), Some(1_000_000_000)).believed(), None);
    let given = KeptCalibration::given(calibration(), 3.0).unwrap();
    assert_believed(&Adopted::new(&given, None), &with_mean(prior(&given, 0.9975, false)));
    // 20 uT, beside 10 uT of what changes: a variance of 22^2 is less than 39^2
    let unsure = KeptCalibration::given(calibration(), 20.0).unwrap();
    assert_believed(&Adopted::new(&unsure, None), &with_mean(prior(&unsure, 0.9975, false)));
}

#[test]
fn a_calibration_that_was_learned_at_an_unknown_time_is_of_any_age() {
    let text = learned(None).to_json().replace("1000", "null");
    let undated = KeptCalibration::from_json(&text).unwrap();
    assert_eq!((undated.unix_time_s(), age_s(&undated, Some(5))), (None, f64::INFINITY));
    assert_eq!(age_s(&KeptCalibration::given(calibration(), 3.0).unwrap(), Some(5)), 0.0);
    assert_eq!([age_s(&learned(None), Some(1007)), age_s(&learned(None), Some(999))], [7.0, f64::INFINITY]);
}

/// The sigma that the table of settings has where none is told is what b moves from day to day.
#[test]
fn what_is_given_without_a_sigma_is_as_sure_as_the_days_are() {
    assert_eq!(crate::config::Config::default().initial_sigma_ut, DAYS_UT);
}
