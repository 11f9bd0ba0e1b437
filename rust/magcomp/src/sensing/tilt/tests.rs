use super::*;

const PERIOD_NS: i64 = 10_000_000;
const FIELD: Vector3<f64> = Vector3::new(0.0, 20.0, -40.0);

fn sigma_deg(tilt: &Tilt) -> f64 {
    tilt.variance_rad2().sqrt().to_degrees()
}

#[test]
fn motion_is_averaged_and_shows_in_sigma() {
    let mut tilt = Tilt::default();
    // steps, twice a second: 1.5 m/s^2 rms along gravity, 2 m/s^2 across it
    let reading = |k: i64| {
        let phase = k as f64 * 0.01 * 2.0 * std::f64::consts::TAU;
        Vector3::new(2.0 * 2f64.sqrt() * phase.sin(), 0.0, GRAVITY_M_S2 + 1.5 * 2f64.sqrt() * phase.cos())
    };
    let (mut raw, mut kept, mut sigma) = (0.0, 0.0, 0.0);
    for k in 0..1000 {
        tilt.step(k * PERIOD_NS, &reading(k), &FIELD);
        if k >= 200 {
            raw += reading(k).angle(&Vector3::z()).powi(2) / 800.0;
            kept += tilt.up().unwrap().angle(&Vector3::z()).powi(2) / 800.0;
            sigma += tilt.variance_rad2() / 800.0;
        }
    }
    let [raw, kept, sigma] = [raw, kept, sigma].map(|it: f64| it.sqrt().to_degrees());
    assert!((raw - 11.7).abs() < 0.7, "{raw} deg without a filter");
    assert!(kept < 0.4 * raw, "{kept} deg");
    // the error is all along one of two axes
    assert!((0.15..1.0).contains(&(kept / 2f64.sqrt() / sigma)), "{kept} deg, sigma {sigma}");
    for k in 1000..2000 {
        tilt.step(k * PERIOD_NS, &Vector3::new(0.0, 0.0, GRAVITY_M_S2), &FIELD);
    }
    assert!(sigma_deg(&tilt) < 0.1 && tilt.up().unwrap().angle(&Vector3::z()).to_degrees() < 0.01);
}

#[test]
fn a_turn_is_followed_and_its_lag_is_in_sigma() {
    let mut tilt = Tilt::default();
    let mut last = 0.0;
    for k in 0..500 {
        // at rest, then 2 rad/s
        let angle = (k - 200).max(0) as f64 * 0.02;
        let truth = Vector3::new(angle.sin(), 0.0, angle.cos());
        tilt.step(k * PERIOD_NS, &(truth * GRAVITY_M_S2), &FIELD);
        let off = tilt.up().unwrap().angle(&truth);
        if k < 200 {
            assert!(off < 1e-9 && sigma_deg(&tilt) < 0.01, "at rest");
        } else {
            last = off / tilt.variance_rad2().sqrt();
        }
        assert!(off.to_degrees() < 5.0, "{} deg late at {k}", off.to_degrees());
    }
    // the first samples of a turn surprise; then sigma knows
    assert!((0.2..2.5).contains(&sigma_deg(&tilt)), "{} deg", sigma_deg(&tilt));
    assert!((0.5..3.5).contains(&last), "{last} sigmas");
}

/// On the end of an arm: what presses it outwards is no smaller than what a walk does, and only the field tells that it turns.
#[test]
fn a_device_that_turns_fast_is_followed_though_it_is_shaken() {
    let lag_deg = |field_turns: bool| {
        let mut tilt = Tilt::default();
        let mut worst = 0.0_f64;
        for k in 0..600 {
            let angle = f64::from(k) * 0.04;
            let turned = |it: Vector3<f64>| nalgebra::Rotation3::from_axis_angle(&Vector3::y_axis(), angle) * it;
            let truth = turned(Vector3::z());
            let shaken = truth * GRAVITY_M_S2 * (1.0 + 0.3 * (f64::from(k) * 0.13).sin());
            tilt.step(i64::from(k) * PERIOD_NS, &shaken, &if field_turns { turned(FIELD) } else { FIELD });
            if k > 200 {
                worst = worst.max(tilt.up().unwrap().angle(&truth).to_degrees());
            }
        }
        worst
    };
    let (alone, with_field) = (lag_deg(false), lag_deg(true));
    assert!(with_field < 30.0 && with_field < 0.6 * alone, "{with_field} deg with the field's turn, {alone} without");
}

#[test]
fn a_pause_begins_anew_and_free_fall_has_no_direction() {
    let mut tilt = Tilt::default();
    assert_eq!(tilt.up(), None);
    tilt.step(0, &Vector3::new(0.0, 0.0, GRAVITY_M_S2), &FIELD);
    tilt.step(60_000_000_000, &Vector3::new(GRAVITY_M_S2, 0.0, 0.0), &FIELD);
    assert_eq!(tilt.up(), Some(Vector3::x()));
    let mut falling = Tilt::default();
    falling.step(0, &Vector3::zeros(), &FIELD);
    assert_eq!(falling.up(), None);
}

/// The module's equations, step by step with another program: up, and its variance. Samples in seconds, m/s^2 and uT.
#[test]
fn steps_are_those_of_the_equations() {
    type Step = (f64, [f64; 3], [f64; 3], [f64; 3], f64);
    // moved and turned; a second later, and 3 g; turned fast, where the innovations say more than the motion; free fall
    let runs: [&[Step]; 4] = [
        &[
            (
                0.0,
                [1.0, 2.0, 9.5],
                [0.0, 20.0, -40.0],
                [0.101971621298, 0.203943242596, 0.968730402329],
                4.601625868803e-5,
            ),
            (
                0.05,
                [-2.0, 4.0, 12.0],
                [3.0, 22.0, -41.0],
                [0.064439515043, 0.228964646765, 1.00000715754],
                4.699800461257e-3,
            ),
            (
                0.3,
                [3.0, -1.0, 7.0],
                [6.0, 18.0, -44.0],
                [0.228062669984, 0.00472297355684, 0.806074743467],
                1.794503369361e-2,
            ),
        ],
        &[
            (0.0, [0.0, 0.0, 9.9], [0.0, 20.0, -40.0], [0.0, 0.0, 1.00951905085], 1.812246580993e-4),
            (1.0, [0.0, 30.0, 9.0], [10.0, 20.0, -40.0], [0.0, 0.172221545355, 1.00435240449], 1.0),
        ],
        &[
            (0.0, [0.0, 0.0, 9.9], [0.0, 20.0, -40.0], [0.0, 0.0, 1.00951905085], 1.812246580993e-4),
            (0.04, [0.0, 4.0, 8.9], [1.0, 20.0, -40.0], [0.0, 0.298226782024, 0.934962355342], 8.558007927778e-4),
            (0.08, [0.0, 8.0, 5.6], [2.0, 20.0, -40.0], [0.0, 0.698329665267, 0.653623307531], 2.271993935325e-3),
            (0.12, [0.0, 9.7, 1.0], [3.0, 20.0, -40.0], [0.0, 0.927585564371, 0.218714259404], 3.566994966959e-3),
        ],
        &[
            (0.0, [0.0; 3], [0.0, 20.0, -40.0], [0.0; 3], 2.0),
            (0.1, [0.0, 1.0, 9.0], [0.0, 20.0, -40.0], [0.0, 0.000212406306622, 0.0019116567596], 1.999319990171),
        ],
    ];
    for run in runs {
        let mut tilt = Tilt::default();
        for (time_s, up, raw_ut, expected, variance) in run {
            tilt.step((time_s * 1e9_f64).round() as i64, &Vector3::from(*up), &Vector3::from(*raw_ut));
            let found = tilt.filter.unwrap().up;
            assert!((found - Vector3::from(*expected)).amax() < 1e-10, "{time_s} s: {found}");
            assert!((tilt.variance_rad2() / variance - 1.0).abs() < 1e-9, "{time_s} s: {}", tilt.variance_rad2());
        }
    }
}

#[test]
fn a_vertical_is_calm_within_ten_percent_of_gravity() {
    let along = Vector3::new(0.6, 0.0, -0.8);
    for (size, is_calm) in [(1.0, true), (1.09, true), (0.91, true), (1.11, false), (0.89, false), (0.0, false)] {
        let up = calm(&(along * (size * GRAVITY_M_S2)));
        assert_eq!(up.is_some(), is_calm, "{size}");
        assert!(up.is_none_or(|up| (up - along).norm() < 1e-12), "{size}");
    }
}
