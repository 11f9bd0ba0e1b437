//! Every number by hand.

use super::*;
use nalgebra::Rotation3;

fn level() -> Level {
    Level::of(&Vector3::y(), &Vector3::z()).unwrap()
}

fn own(variance_rad2: f64) -> Own {
    Own { level: level(), variance_rad2 }
}

fn carried(own_rad2: f64, common_rad2: f64) -> Carried {
    Carried { common_rad2, ..Carried::of(&own(own_rad2)) }
}

#[test]
fn a_field_is_level_by_its_angle_to_the_vertical_whatever_its_length() {
    for length in [1e-3, 1.0, 50.0] {
        let is_level = |sine: f64| Level::of(&(Vector3::new(0.0, sine, -1.0) * length), &Vector3::z()).is_some();
        assert!(is_level(1.1e-6) && !is_level(0.9e-6), "{length}");
    }
}

#[test]
fn an_axis_has_a_bearing_below_an_elevation_of_60_degrees_whatever_its_length() {
    for length in [0.2, 1.0, 3.0] {
        let bearing = |horizontal: f64| {
            let up = (1.0 - horizontal * horizontal).sqrt();
            level().told_bearing(&(Vector3::new(-horizontal, 0.0, up) * length))
        };
        assert_eq!(bearing(0.49), None);
        assert!((bearing(0.51).unwrap() + 90.0_f64.to_radians()).abs() < 1e-12);
    }
}

#[test]
fn a_turn_takes_north_along_and_adds_drift_to_its_sigma_and_noise_to_its_variance() {
    let mut north = carried(0.04, 0.01);
    let turn = Rotation3::new(Vector3::z() * 0.3).into_inner();
    let carry =
        Carry { turn, up: None, tilt_rad2: 0.0, bias_rad2_s2: 0.01, is_bias_told: true, span_s: 1.0, noise_rad2: 0.02 };
    north.step(&carry, None);
    // 0.04 + 0.1^2 + 0.02, and what is common stays
    assert!((north.variance_rad2() - 0.08).abs() < 1e-12);
    let expected = Vector3::new(-0.3_f64.sin(), 0.3_f64.cos(), 0.0);
    assert!((north.level(&Vector3::z()).north - expected).norm() < 1e-12);
}

#[test]
fn a_heading_agrees_within_three_standard_deviations() {
    let north = carried(0.5, 0.25);
    assert!(north.agrees(2.99, 0.25) && north.agrees(-2.99, 0.25));
    assert!(!north.agrees(3.0, 0.25) && !north.agrees(-3.0, 0.25));
}

#[test]
fn a_rival_loses_once_as_much_speaks_against_it_as_for_it() {
    let mut rival = Carried { support_s: 5.0, ..carried(0.04, 0.0) };
    assert!(!rival.loses(3.0) && !rival.loses(1.5));
    assert!(rival.loses(0.5));
}

#[test]
fn north_leads_where_it_is_surer_than_the_magnetometer_or_excluded_by_it() {
    assert!(carried(0.04, 0.0).is_no_better_than(&own(0.04)));
    assert!(!carried(0.03, 0.0).is_no_better_than(&own(0.04)));
    assert!(carried(0.03, 0.02).is_no_better_than(&own(0.04)));
    // 90 degrees off, and both know it to 12 degrees
    let off = |own_rad2| Carried { level: level().turned(1.57), ..carried(own_rad2, 0.0) };
    assert!(!off(0.05).is_no_better_than(&own(0.04)) && off(0.3).is_no_better_than(&own(0.04)));
}

#[test]
fn the_published_one_lies_between_both_as_their_variances_ask_for() {
    // 0.3 rad clockwise; variances 0.04 and 0.16: a fifth of the way to the magnetometer's
    let north = Carried { level: level().turned(0.3), ..carried(0.03, 0.01) };
    let (towards, variance_rad2) = north.published(&own(0.16));
    assert!((level().told_bearing(&towards.north).unwrap() - 0.8 * 0.3).abs() < 1e-12);
    assert!((variance_rad2.sqrt() - (0.2 * 0.8 + 0.4 * 0.2)).abs() < 1e-12);
}

#[test]
fn what_begins_anew_at_the_magnetometer_keeps_what_speaks_for_it() {
    let mut north = Carried { support_s: 100.0, level: level().turned(0.3), ..carried(0.05, 0.01) };
    north.begin_at(&own(0.04));
    assert_eq!(north, Carried { support_s: 100.0, ..Carried::of(&own(0.04)) });
}

/// What headings have shown of a bias that the turn did not have off says nothing once the turn has it off.
#[test]
fn what_is_left_of_the_bias_begins_anew_when_samples_tell_it() {
    for (is_bias_told, expected_rad_s) in [(false, 0.05), (true, 0.0)] {
        let mut north = carried(0.04, 0.01);
        (north.drift_rad_s, north.drift_rad2_s2) = (0.05, 1e-6);
        let turn = Matrix3::identity();
        north.step(
            &Carry { turn, up: None, tilt_rad2: 0.0, bias_rad2_s2: 1e-4, is_bias_told, span_s: 0.01, noise_rad2: 0.0 },
            None,
        );
        assert_eq!(north.drift_rad_s, expected_rad_s, "{is_bias_told}");
    }
}
