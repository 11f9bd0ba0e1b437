use super::*;
use crate::calibration::Calibration;
use nalgebra::{SMatrix, SVector, Vector3};

#[test]
fn the_dip_is_a_mean_over_five_seconds() {
    let mut belief = Belief::default();
    let dip = |dip_deg: f64| Heading {
        heading_deg: 0.0,
        heading_sigma_deg: None,
        true_heading_deg: None,
        inclination_deg: Some(dip_deg),
    };
    belief.see_dip(&dip(60.0), 0.1);
    assert_eq!(belief.inclination_deg, Some(60.0));
    belief.see_dip(&dip(70.0), 0.0);
    assert_eq!(belief.inclination_deg, Some(60.0));
    belief.see_dip(&dip(70.0), 1.0);
    assert!((belief.inclination_deg.unwrap() - 62.0).abs() < 1e-12);
    belief.see_dip(&dip(75.0), 100.0);
    assert_eq!(belief.inclination_deg, Some(75.0));
}

/// 2 uT usually, or less where what was adopted was known better; 0.3 % of M for each uT that is added, half of it in squares beside the diagonal.
#[test]
fn the_next_estimator_begins_no_surer_than_usual() {
    let of = |adopted_sigma_ut, known_ut2: f64| {
        let covariance = SMatrix::<f64, 9, 9>::from_diagonal_element(known_ut2);
        let given = Given { calibration: Calibration::about(Vector3::zeros(), 50.0), covariance };
        let belief = Belief { adopted_sigma_ut, ..Belief::default() };
        belief.no_surer_than_usual(given).covariance - covariance
    };
    let added = |ut2: f64| {
        let (iron, half) = (9e-6 * ut2, 4.5e-6 * ut2);
        SMatrix::from_diagonal(&SVector::<f64, 9>::from([ut2, ut2, ut2, iron, iron, iron, half, half, half]))
    };
    for (adopted_sigma_ut, known_ut2, lacks_ut2) in
        [(None, 0.5, 3.5), (None, 5.0, 0.0), (Some(1.5), 0.25, 2.0), (Some(3.0), 1.0, 3.0), (Some(0.1), 0.04, 0.0)]
    {
        let off = of(adopted_sigma_ut, known_ut2) - added(lacks_ut2);
        assert!(off.amax() < 1e-12, "{adopted_sigma_ut:?} {known_ut2}: {off}");
    }
}

#[test]
fn what_was_adopted_is_forgotten_once_something_is_learned() {
    let mut belief = Belief::default();
    let kept = crate::kept::KeptCalibration::given(Calibration::about(Vector3::zeros(), 50.0), 2.0).unwrap();
    belief.adopted = Some(Adopted::new(&kept, None));
    belief.learn();
    assert!(belief.has_learned && belief.adopted.is_none());
}
