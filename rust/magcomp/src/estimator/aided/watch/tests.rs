//! The low-passes against their sums, and the limits from both sides.

use super::*;
use nalgebra::Matrix3;

const DT_S: f64 = 0.02;

/// A frame `k` intervals after the first; what a watch does not look at is zero.
fn step(k: i64) -> FrameStep {
    FrameStep { time_ns: 1_000_000_000 + 20_000_000 * k, ..FrameStep::of_nothing(DT_S) }
}

/// Of values, oldest first, that a low-pass of `time_s` has taken after `first`.
fn low_passed(first: f64, values: &[f64], time_s: f64) -> f64 {
    let keep = 1.0 - DT_S / time_s;
    let n = values.len() as i32;
    let sum: f64 = values.iter().zip(1..).map(|(value, k)| (1.0 - keep) * keep.powi(n - k) * value).sum();
    first * keep.powi(n) + sum
}

#[test]
fn share_misfit_and_residual_are_low_passes_over_gated_samples() {
    let tuning = Tuning::default();
    let mut watch = Watch::default();
    let (mut gated, mut misfits, mut residuals) = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..40 {
        let size = 3.0 + k as f64;
        // every third one fits, but the first four
        let is_gated = k < 4 || k % 3 > 0;
        let (v, former) = (Vector3::new(0.6, 0.0, 0.8) * size, Vector3::new(size, 1.0, -2.0));
        watch.step(&step(k), is_gated.then_some(&v), Some(former), false, &tuning);
        gated.push(f64::from(is_gated));
        if is_gated {
            misfits.push(size);
            residuals.push(former);
        }
    }
    let close = |found: f64, expected: f64| (found - expected).abs() < 1e-12 * expected.abs().max(1.0);
    assert!(close(watch.share, low_passed(0.0, &gated, tuning.memory_s)), "{}", watch.share);
    // the run began with the first two: until a tenth of the share is full, each gated sample begins it anew
    let begin =
        gated.iter().enumerate().take_while(|(k, _)| low_passed(0.0, &gated[..*k], tuning.memory_s) < 0.1).count() - 1;
    assert_eq!(begin, 2);
    assert_eq!(watch.since_ns, step(2).time_ns);
    let short_s = 0.5 * tuning.quick_s;
    assert!(close(watch.misfit_ut, low_passed(misfits[begin], &misfits[begin..], short_s)), "{}", watch.misfit_ut);
    for axis in 0..3 {
        let own: Vec<f64> = residuals[begin..].iter().map(|it| it[axis]).collect();
        assert!(close(watch.former_ut[axis], low_passed(own[0], &own, short_s)), "{axis}: {}", watch.former_ut);
    }
}

#[test]
fn what_fits_is_believed_sooner_while_hypotheses_run() {
    let tuning = Tuning::default();
    let v = Vector3::x();
    for (clearing, is_gated, time_s) in [
        (false, false, tuning.memory_s),
        (true, false, tuning.quick_s),
        (false, true, tuning.memory_s),
        (true, true, tuning.memory_s),
    ] {
        let mut watch = Watch { share: 0.5, ..Watch::default() };
        watch.step(&step(0), is_gated.then_some(&v), None, clearing, &tuning);
        let expected = low_passed(0.5, &[f64::from(is_gated)], time_s);
        assert!((watch.share - expected).abs() < 1e-15, "{clearing}, {is_gated}: {}", watch.share);
    }
}

#[test]
fn a_run_of_misfits_goes_on_while_a_tenth_of_the_samples_are_gated() {
    let tuning = Tuning::default();
    let v = Vector3::new(0.0, 9.0, 0.0);
    for (share, since_ns) in [(0.51, 7), (0.49, step(0).time_ns)] {
        let mut watch = Watch { share: share * tuning.suspect_share, former_ut: Vector3::x(), ..Watch::default() };
        watch.begin(7, 4.0);
        assert_eq!((watch.since_ns, watch.misfit_ut), (7, 4.0));
        watch.step(&step(0), Some(&v), None, false, &tuning);
        let before_ut = if since_ns == 7 { 4.0 } else { 9.0 };
        assert_eq!(watch.since_ns, since_ns);
        assert!((watch.misfit_ut - low_passed(before_ut, &[9.0], 0.5 * tuning.quick_s)).abs() < 1e-12);
        // without a former calibration what a former one left is forgotten where the run begins
        assert_eq!(watch.former_ut, if since_ns == 7 { Vector3::x() } else { Vector3::zeros() });
    }
}

#[test]
fn a_former_calibration_fits_within_half_of_the_least_step() {
    let tuning = Tuning::default();
    for (share, fits) in [(0.499, true), (0.501, false)] {
        let former_ut = Vector3::new(2.0, -2.0, 1.0) / 3.0 * (share * tuning.smallest_step_ut);
        assert_eq!(Watch { former_ut, ..Watch::default() }.fits_former(&tuning), fits);
    }
}

#[test]
fn what_a_former_calibration_leaves_is_the_sample_without_all_that_it_says() {
    // M - I: xx, yy, zz, xy, xz, yz
    let iron = [0.1, -0.2, 0.05, 0.02, -0.03, 0.04];
    let mut filter = Filter::default();
    filter.set_part(HARD_IRON, &Vector3::new(100.0, -50.0, 20.0));
    filter.set_part(CALIBRATION, &{
        let mut all = filter.part(CALIBRATION);
        all.fixed_rows_mut::<6>(3).copy_from_slice(&iron);
        all
    });
    let (h, raw_ut) = (Vector3::new(30.0, -10.0, 40.0), Vector3::new(7.0, 8.0, 9.0));
    let [xx, yy, zz, xy, xz, yz] = iron;
    let m = Matrix3::new(1.0 + xx, xy, xz, xy, 1.0 + yy, yz, xz, yz, 1.0 + zz);
    let expected = raw_ut - m * h - Vector3::new(100.0, -50.0, 20.0);
    let found = filter.marginal(CALIBRATION).residual(&raw_ut, &h);
    assert!((found - expected).norm() < 1e-12, "{found}");
}
