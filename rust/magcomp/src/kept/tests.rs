use super::*;
use nalgebra::{Matrix3, Vector3};

fn kept() -> KeptCalibration {
    let m = Matrix3::new(1.02, 0.03, -0.01, 0.03, 0.97, 0.02, -0.01, 0.02, 1.01);
    let calibration = Calibration::new(m, Vector3::new(120.0, -80.1, 1.0 / 3.0), 48.2).unwrap();
    let root =
        SMatrix::<f64, 9, 9>::from_fn(
            |i, j| if i == j { 0.3 + 0.1 * i as f64 } else { 0.01 * (i as f64 - j as f64 / 3.0) },
        );
    KeptCalibration::learned(calibration, root * root.transpose(), Some(64.8), 1_795_560_000).unwrap()
}

#[test]
fn a_text_brings_back_every_bit() {
    let system = KeptCalibration::system(*kept().calibration(), 13.0).unwrap();
    for it in [kept(), system, KeptCalibration::given(*kept().calibration(), 0.5).unwrap()] {
        assert_eq!(KeptCalibration::from_json(&it.to_json()), Ok(it));
    }
}

/// The form is documented and read by others, so it is held word by word.
#[test]
fn the_text_has_the_documented_form() {
    let it = KeptCalibration::system(Calibration::identity(48.0).unwrap(), 2.0).unwrap();
    let row = |at: usize, value: &str| {
        let row: Vec<&str> = (0..9).map(|k| if k == at { value } else { "0.0" }).collect();
        format!("[{}]", row.join(","))
    };
    let variance = |k: usize| ["4.0", "0.0064", "0.0032"][k / 3];
    let rows: Vec<String> = (0..9).map(|k| row(k, variance(k))).collect();
    let head = r#"{"magcomp_calibration":1,"source":"system","unix_time_s":null,"inclination_deg":null,"#;
    let numbers =
        r#""soft_iron":[1.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0,1.0],"hard_iron_ut":[0.0,0.0,0.0],"field_strength_ut":48.0,"#;
    assert_eq!(it.to_json(), format!(r#"{head}{numbers}"covariance":[{}]}}"#, rows.join(",")));
}

#[test]
fn what_may_be_missing_and_what_is_unknown_does_no_harm() {
    let text = kept().to_json();
    let without = text.replace(r#""unix_time_s":1795560000,"inclination_deg":64.8,"#, r#""recording":"a walk","#);
    let read = KeptCalibration::from_json(&without).unwrap();
    assert_eq!((read.unix_time_s(), read.inclination_deg()), (None, None));
    assert_eq!(read.calibration(), kept().calibration());
}

#[test]
fn a_damaged_text_is_refused_and_says_why() {
    let text = kept().to_json();
    for end in 0..text.len() {
        assert!(matches!(KeptCalibration::from_json(&text[..end]), Err(KeptError::Damaged { .. })), "cut at {end}");
    }
    let first = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        KeptCalibration::from_json(&text.replacen(from, to, 1))
    };
    for (from, to, why) in [
        ("\"magcomp_calibration\":1", "\"magcomp_calibration\":0", "there is no version 0"),
        ("\"magcomp_calibration\":1", "\"magcomp_calibration\":\"1\"", "invalid type"),
        ("\"magcomp_calibration\":1", "\"magcomp_calibration\":-1", "invalid value"),
        ("\"learned\"", "\"dreamt\"", "unknown variant"),
        ("1.02", "-1.02", "not symmetric positive definite"),
        ("1.02", "\"NaN\"", "invalid type"),
        ("120.0", "1e300", "hard iron component"),
        ("48.2", "0.0", "field strength is 0 uT"),
        ("64.8", "91.0", "inclination_deg is not -90 to 90"),
        ("\"covariance\":[[", "\"covariance\":[[-", "covariance is not symmetric and positive semi-definite"),
        ("\"covariance\":[[", "\"covariance\":[[0.0,", "trailing characters"),
    ] {
        let Err(KeptError::Damaged { why: found }) = first(from, to) else { panic!("{to}: taken") };
        assert!(found.contains(why), "{to}: {found}");
    }
    let error = KeptCalibration::from_json("").unwrap_err().to_string();
    assert!(error.starts_with("kept calibration is damaged (EOF") && error.ends_with("start without it"), "{error}");
}

#[test]
fn a_newer_text_is_refused_by_its_number_alone() {
    let newer = r#"{"magcomp_calibration":2,"everything":"else"}"#;
    assert_eq!(KeptCalibration::from_json(newer), Err(KeptError::Newer { found: 2 }));
}

#[test]
fn a_covariance_that_is_none_is_not_kept() {
    let (calibration, covariance) = (*kept().calibration(), *kept().covariance());
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        let mut covariance = covariance;
        covariance[(4, 4)] = bad;
        assert_eq!(KeptCalibration::learned(calibration, covariance, None, 0), None, "{bad}");
    }
}

/// By hand: 0.3 % of M for each uT, 8 % at most; half of that beside the diagonal (a variance, so a half).
#[test]
fn how_sure_a_given_calibration_is() {
    let calibration = *kept().calibration();
    for (sigma_ut, iron) in [(2.0, 0.006), (10.0, 0.03), (900.0, 0.08)] {
        let given = KeptCalibration::given(calibration, sigma_ut).unwrap();
        let of = |k: usize| given.covariance()[(k, k)];
        for (found, expected) in [(of(1), sigma_ut * sigma_ut), (of(4), iron * iron), (of(8), iron * iron / 2.0)] {
            assert!((found / expected - 1.0).abs() < 1e-12, "{sigma_ut} uT: {found:e} is not {expected:e}");
        }
    }
    assert_eq!((kept().inclination_deg(), kept().unix_time_s()), (Some(64.8), Some(1_795_560_000)));
}

/// Correlations of 0.9, 0.9 and -0.9: each pair could be, the three together can't.
#[test]
fn a_hard_iron_that_is_exactly_known_is_neither_read_nor_kept() {
    let system = KeptCalibration::system(Calibration::identity(48.0).unwrap(), 2.0).unwrap();
    let text = system.to_json().replacen("\"covariance\":[[4.0", "\"covariance\":[[0.0", 1);
    let Err(KeptError::Damaged { why }) = KeptCalibration::from_json(&text) else { panic!("taken") };
    assert!(why.contains("exactly known"), "{why}");
    let mut covariance = *system.covariance();
    covariance[(2, 2)] = 0.0;
    assert_eq!(KeptCalibration::learned(*system.calibration(), covariance, None, 0), None);
}

#[test]
fn a_covariance_is_positive_as_a_whole() {
    let three = |c: f64| Matrix3::new(4.0, 5.4, 1.8, 5.4, 9.0, c * 3.0, 1.8, c * 3.0, 1.0);
    assert!(crate::calibration::is_covariance(&three(0.9)) && !crate::calibration::is_covariance(&three(-0.9)));
    // what is known has no variance, and correlates with nothing
    assert!(crate::calibration::is_covariance(&Matrix3::from_diagonal(&Vector3::new(1.0, 0.0, 2.0))));
    let mut covariance = SMatrix::<f64, 9, 9>::identity() * 0.01;
    covariance.fixed_view_mut::<3, 3>(0, 0).copy_from(&three(0.9));
    let given = crate::calibration::Given { calibration: *kept().calibration(), covariance };
    assert!((given.hard_iron_ut2() - 14.0 / 3.0).abs() < 1e-12);
}

#[test]
fn a_soft_iron_that_is_nearly_flat_is_refused() {
    let flat = |least: f64| {
        Calibration::from_any(Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, least)), Vector3::zeros(), 48.0)
    };
    assert!(
        matches!(flat(1e-9), Err(crate::CalibrationError::Singular { ratio }) if (ratio / 1e-9 - 1.0).abs() < 1e-3)
    );
    assert!(flat(0.5).is_ok());
}
