use super::*;

/// The field of 45 uT in a device that turns about z, tilted, at 1 rad/s and 50 Hz; each axis is cut off there, and read in steps.
fn turned(samples: u32, full_scale_ut: f64, last_bit_ut: f64) -> impl Iterator<Item = Vector3<f64>> {
    (0..samples).map(move |k| {
        let t = f64::from(k) * 0.02;
        let noise = Vector3::new(f64::from(k % 7), f64::from(k % 5), f64::from(k % 3)) * 0.1;
        let field_ut = Vector3::new(40.0 * t.cos(), 40.0 * t.sin(), 20.0 + 3.0 * (0.7 * t).sin()) + noise;
        ((field_ut / last_bit_ut).map(f64::round) * last_bit_ut).map(|v| v.clamp(-full_scale_ut, full_scale_ut))
    })
}

fn after(samples: impl Iterator<Item = Vector3<f64>>) -> Rails {
    let mut rails = Rails::default();
    samples.for_each(|field_ut| rails.see(&field_ut));
    rails
}

fn is_saturated(rails: &Rails, field_ut: Vector3<f64>) -> bool {
    rails.check(&field_ut).is_err()
}

#[test]
fn the_full_scale_of_an_axis_is_found_at_both_ends() {
    let rails = after(turned(700, 30.0, 0.1));
    let error = rails.check(&Vector3::new(30.0, 0.0, 20.0)).unwrap_err();
    assert_eq!(error, RejectReason::Saturated { axis: Axis::X, value_ut: 30.0, rail_ut: 30.0 });
    assert!(is_saturated(&rails, Vector3::new(0.0, -30.0, 20.0)));
    assert!(!is_saturated(&rails, Vector3::new(29.9, -29.9, 20.0)));
    // z was not cut off
    assert!(!is_saturated(&rails, Vector3::new(0.0, 0.0, 30.0)));
}

#[test]
fn what_is_exceeded_was_no_full_scale() {
    let mut rails = after(turned(700, 30.0, 0.1));
    rails.see(&Vector3::new(31.0, 0.0, 20.0));
    assert!(!is_saturated(&rails, Vector3::new(30.0, 0.0, 20.0)));
    assert!(is_saturated(&rails, Vector3::new(-30.0, 0.0, 20.0)));
}

/// A coarse last bit, of which neighbours read the same: an extreme of a slow turn is no full scale, and one that is cut off is.
#[test]
fn an_extreme_of_a_coarse_sensor_is_no_full_scale() {
    for last_bit_ut in [0.5, 1.0, 3.0] {
        let extreme =
            turned(6000, 1000.0, last_bit_ut).fold(Vector3::repeat(f64::MIN), |most, field_ut| most.sup(&field_ut));
        let rails = after(turned(6000, 1000.0, last_bit_ut));
        assert!(!is_saturated(&rails, extreme), "{last_bit_ut}");
    }
    for last_bit_ut in [0.5, 1.0] {
        let rails = after(turned(6000, 25.0, last_bit_ut));
        assert!(is_saturated(&rails, Vector3::new(25.0, 0.0, 0.0)), "{last_bit_ut}");
    }
}

/// A device that rests after it was turned, with an axis at the largest value that was seen.
#[test]
fn a_rest_tells_nothing() {
    let mut rails = after(turned(700, 1000.0, 0.1));
    for k in 0..1000 {
        rails.see(&Vector3::new(45.0, f64::from(k % 4) * 0.1, 20.0));
    }
    assert!(!is_saturated(&rails, Vector3::new(45.0, 0.0, 20.0)));
}

/// A stream without noise about one axis: what never moved was not cut off.
#[test]
fn a_turn_about_an_axis_tells_nothing_of_it() {
    let rails = after((0..1000).map(|k| {
        let t = f64::from(k) * 0.02;
        Vector3::new(40.0 * t.cos(), 40.0 * t.sin(), 20.0)
    }));
    assert!(!is_saturated(&rails, Vector3::new(0.0, 0.0, 20.0)));
}
