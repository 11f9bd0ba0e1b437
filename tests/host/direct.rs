//! Moments against a fit sample by sample: the same minimum to 1e-9, however the window came about.

use magcomp::nalgebra::Vector3;
use magcomp::{Calibration, FitOptions, Moments, Residual, fit_ellipsoid};
use magcomp_tests::{REF, Random, calibration, difference, direct_fit};

const BOTH: [Residual; 2] = [Residual::Algebraic, Residual::Corrected];

fn options(residual: Residual, field_ut: f64) -> FitOptions {
    FitOptions {
        residual,
        field_strength_ut: Some(field_ut),
        noise_floor_ut: 0.0,
        max_direction_sigma_deg: 60.0,
        field_range_ut: (1.0, 1000.0),
        ..FitOptions::default()
    }
}

fn at_600_ut(field_ut: f64) -> Calibration {
    let mut parameters = REF;
    parameters[..3].copy_from_slice(&[600.0 / field_ut, -600.0 / field_ut, 590.0 / field_ut]);
    calibration(&parameters, field_ut)
}

#[test]
fn moments_and_direct_fit_agree() {
    let mut random = Random::new(50);
    for field_ut in [25.0, 50.0, 65.0] {
        for truth in [calibration(&REF, field_ut), at_600_ut(field_ut)] {
            for (count, snr_db) in [(60, 30.0), (100, 40.0), (626, 35.0), (2000, 30.0)] {
                let raw = random.raw(&truth, field_ut * 10.0_f64.powf(-snr_db / 20.0), count);
                for residual in BOTH {
                    let fit = fit_ellipsoid(&raw, &options(residual, field_ut)).expect("an ellipsoid").calibration;
                    let off = difference(&fit, &direct_fit(&raw, residual, &truth));
                    assert!(off < 1e-9, "N {count}, {field_ut} uT, {snr_db} dB, {residual:?}: {off:.1e}");
                }
            }
        }
    }
}

#[test]
fn they_agree_on_a_cap_of_the_sphere() {
    let mut random = Random::new(51);
    let truth = at_600_ut(50.0);
    for (angle_deg, noise_ut) in [(90.0, 0.5), (75.0, 0.2)] {
        for _ in 0..10 {
            let axis = random.direction();
            let one = |random: &mut Random| {
                truth.distort(&(random.on_cap(&axis, angle_deg) * 50.0)) + random.normal3() * noise_ut
            };
            let raw: Vec<_> = (0..500).map(|_| one(&mut random)).collect();
            for residual in BOTH {
                let fit = fit_ellipsoid(&raw, &options(residual, 50.0)).expect("an ellipsoid").calibration;
                let off = difference(&fit, &direct_fit(&raw, residual, &truth));
                assert!(off < 1e-9, "cap of {angle_deg} deg, {residual:?}: {off:.1e}");
            }
        }
    }
}

/// A window of 2000 slides over 10^6 samples, at night 10^7, 600 uT from the origin.
#[test]
fn they_agree_after_many_samples_came_and_went() {
    const WINDOW: usize = 2000;
    let mut random = Random::new(52);
    let truth = at_600_ut(50.0);
    // the stream repeats after a prime number of samples, so that the window never meets the same place twice in step
    let stream = random.raw(&truth, 1.58, 10_007);
    let near = truth.hard_iron_ut() + Vector3::new(7.0, -5.0, 4.0);
    let mut moments = Moments::new(near, 50.0);
    let samples = if std::env::var_os("MAGCOMP_NIGHT").is_some() { 10_000_000 } else { 1_000_000 };
    for k in 0..samples {
        moments.add(&stream[k % stream.len()]);
        if k >= WINDOW {
            moments.remove(&stream[(k - WINDOW) % stream.len()]);
        }
    }
    assert_eq!(moments.count(), WINDOW);
    let window: Vec<_> = (samples - WINDOW..samples).map(|k| stream[k % stream.len()]).collect();
    // the same bits as if the rest had never been
    let mut fresh = Moments::new(near, 50.0);
    window.iter().for_each(|sample| fresh.add(sample));
    assert_eq!(moments, fresh);
    for residual in BOTH {
        let fit = moments.fit(&options(residual, 50.0)).expect("an ellipsoid").calibration;
        let off = difference(&fit, &direct_fit(&window, residual, &truth));
        assert!(off < 1e-9, "{residual:?}: {off:.1e}");
    }
}

/// The direct fit itself: at its minimum the cost rises in every direction, so that it can't agree by mistake.
#[test]
fn the_direct_fit_is_a_minimum() {
    let mut random = Random::new(53);
    let truth = calibration(&REF, 50.0);
    let raw = random.raw(&truth, 1.0, 300);
    let cost = |m6: &[f64], b: Vector3<f64>, residual| {
        let t = magcomp_tests::symmetric(m6).try_inverse().expect("invertible") / 50.0;
        let (mut c, mut d) = (0.0, 0.0);
        for h in &raw {
            let q = t * (h - b);
            let r = q.norm_squared() - 1.0;
            c += r * r;
            d += 4.0 * (t * q).norm_squared() + 2.0 * r * t.norm_squared();
        }
        if residual == Residual::Algebraic { c } else { c / d }
    };
    for residual in BOTH {
        let found = magcomp_tests::nine(&direct_fit(&raw, residual, &truth));
        let at = |p: &magcomp_tests::Nine| {
            cost(&p.as_slice()[3..], Vector3::from_column_slice(&p.as_slice()[..3]), residual)
        };
        let lowest = at(&found);
        for i in 0..9 {
            for step in [1e-3, -1e-3] {
                let mut moved = found;
                moved[i] += if i < 3 { step * 50.0 } else { step };
                assert!(at(&moved) > lowest, "{residual:?}: parameter {i} by {step}");
            }
        }
    }
}
