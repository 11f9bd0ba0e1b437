//! Whatever comes in, the state stays sound; degraded sensors are reported.

use nalgebra::Vector3;

use super::super::{Aided, Tuning};
use super::simulator::{Random, World};
use crate::calibration::{Calibration, Given, LARGEST_RAW_UT, independent};
use crate::reading::{HoldReason, SensorMode, Status};
use crate::sensing::pairing::{InertialPairing, PairedInertial, Rotation};

#[test]
fn garbage_never_panics_and_never_comes_out() {
    let mut random = Random(8);
    let mut aided = Aided::new(Tuning::default(), None);
    let mut time_ns = i64::MIN / 4;
    for k in 0..200_000 {
        let wild = |random: &mut Random| match (random.uniform() * 12.0) as u32 {
            0 => f64::NAN,
            1 => f64::INFINITY,
            2 => -1e300,
            3 => 0.0,
            4 => 1e-300,
            _ => 60.0 * random.normal(),
        };
        let mut vector = || Vector3::new(wild(&mut random), wild(&mut random), wild(&mut random));
        let raw = vector();
        // as the pairing has checked them
        let [increment, rate, up] = [(); 3].map(|()| vector().map(|v| if v.abs() <= 60.0 { v } else { 30.0 }));
        // as the compensator has checked it
        let raw = if raw.iter().all(|v| v.abs() <= LARGEST_RAW_UT) { raw } else { Vector3::new(30.0, 20.0, -40.0) };
        let pick = random.uniform();
        time_ns = time_ns.saturating_add(if pick < 0.01 { i64::MAX / 2_000_000 } else { (pick * 3e7) as i64 + 1 });
        let rotation =
            (pick > 0.1).then_some(Rotation { increment_rad: increment, rate_rad_s: rate, variance_rad2: 0.0 });
        let (_, output) = aided.told(time_ns, raw, &PairedInertial { rotation, up_m_s2: Some(up) });
        for v in [output.field_ut, output.filtered_field_ut, output.up].into_iter().flatten() {
            assert!(v.iter().all(|v| v.is_finite()), "sample {k}");
        }
    }
}

#[test]
fn the_gyroscope_comes_and_goes() {
    let mut world = World::new(9);
    let mut aided = Aided::new(Tuning::default(), None);
    let mut last = None;
    for k in 0..6_000 {
        let sample = world.sample(0.01);
        let gone = (2_500..3_000).contains(&k);
        let inertial = PairedInertial { rotation: sample.inertial.rotation.filter(|_| !gone), ..sample.inertial };
        let (status, output) = aided.told(sample.time_ns, sample.raw_ut, &inertial);
        if gone && k > 2_510 {
            assert_eq!(output.mode, SensorMode::GravityOnly);
            assert_eq!(output.filtered_field_ut, None);
            assert_eq!(status, Status::Held(HoldReason::NoGyroscope));
            let error = output.field_ut.unwrap().angle(&sample.field_ut).to_degrees();
            assert!(error < 6.0, "without gyroscope: {error} deg at {k}");
        }
        if k > 3_100 {
            let error = output.filtered_field_ut.unwrap().angle(&sample.field_ut).to_degrees();
            assert!(error < 4.0, "after it came back: {error} deg at {k}");
        }
        last = Some((status, output));
    }
    let (status, last) = last.unwrap();
    assert_eq!((status, last.mode, last.event), (Status::Tracking, SensorMode::GyroscopeAndGravity, None));
}

#[test]
fn a_charger_put_on_slowly_is_learned() {
    let mut world = World::new(11);
    let mut aided = Aided::new(Tuning::default(), None);
    let before = world.hard_iron_ut;
    for k in 0..3_500 {
        let put_on = (f64::from(k - 2_000) / 40.0).clamp(0.0, 1.0);
        world.hard_iron_ut = before + Vector3::new(500.0, -300.0, 200.0) * put_on;
        let sample = world.sample(0.01);
        let (_, output) = aided.told(sample.time_ns, sample.raw_ut, &sample.inertial);
        if k >= 2_500 {
            let error = output.filtered_field_ut.unwrap().angle(&sample.field_ut).to_degrees();
            assert!(error < 5.0, "after the charger: {error} deg at {k}");
        }
    }
}

#[test]
fn state_fits_in_48_kilobytes() {
    let bytes = size_of::<Aided>() + size_of::<InertialPairing>();
    assert!(bytes <= 49_152, "{bytes} bytes");
}

#[test]
fn a_spike_as_the_first_sample_does_no_harm() {
    let mut world = World::new(9);
    let mut aided = Aided::new(Tuning::default(), None);
    for k in 0..1_000 {
        let sample = world.sample(0.01);
        let spike = if k == 0 { Vector3::new(80.0, -60.0, 50.0) } else { Vector3::zeros() };
        aided.told(sample.time_ns, sample.raw_ut + spike, &sample.inertial);
    }
    let error = (aided.calibration().unwrap().hard_iron_ut() - world.hard_iron_ut).norm();
    assert!(error < 2.0 && aided.changes.event.is_none(), "offset wrong by {error} uT, {:?}", aided.changes.event);
}

#[test]
fn a_calibration_from_before_the_device_changed_does_not_last() {
    for (step_ut, seed) in [(30.0, 60), (100.0, 61), (300.0, 62), (100.0, 63)] {
        // given at the start, or the device's own from before a pause
        for given in [true, false] {
            let mut world = World::new(seed);
            let mut aided = Aided::new(Tuning::default(), None);
            if given {
                let strength_ut = world.field_ut.norm();
                let calibration = Calibration::new(world.soft_iron, world.hard_iron_ut, strength_ut).unwrap();
                aided.begin_from(&Given { calibration, covariance: independent(4.0, 0.05 * 0.05) });
            } else {
                for _ in 0..2_000 {
                    let sample = world.sample(0.01);
                    aided.told(sample.time_ns, sample.raw_ut, &sample.inertial);
                }
                world.time_ns += 60_000_000_000;
            }
            world.hard_iron_ut += Vector3::new(0.6, -0.64, 0.48) * step_ut;
            let mut worst_deg: f64 = 0.0;
            for k in 0..2_000 {
                let sample = world.sample(0.01);
                let unknown = PairedInertial { rotation: None, ..sample.inertial };
                let (_, output) =
                    aided.told(sample.time_ns, sample.raw_ut, if k == 0 { &unknown } else { &sample.inertial });
                if let Some(f) = output.filtered_field_ut.filter(|_| k >= 700) {
                    worst_deg = worst_deg.max(f.angle(&sample.field_ut).to_degrees());
                }
            }
            assert!(aided.calibration().is_some(), "{step_ut} uT, given {given}");
            assert!(worst_deg < 3.0, "{step_ut} uT, given {given}: {worst_deg} deg from 7 s on");
        }
    }
}

#[test]
fn a_field_that_no_place_has_is_told() {
    // Gauss, a tenth, milligauss; and what is found indoors, which is not to be told
    for (factor, possible) in [(0.01, false), (0.1, false), (10.0, false), (0.5, true), (1.0, true), (2.0, true)] {
        let mut world = World::new(9);
        let mut aided = Aided::new(Tuning::default(), None);
        let mut told = 0;
        for k in 0..3_000 {
            let sample = world.sample(0.01);
            let status = aided.told(sample.time_ns, sample.raw_ut * factor, &sample.inertial).0;
            told += usize::from(k >= 1_000 && status.to_string().contains("unit is not microtesla"));
        }
        // a field ten times as strong also looks as if the gyroscope explained nothing, and the start begins anew
        assert!(if possible { told == 0 } else { told > 1_000 }, "{factor}: told {told} times in 2000");
    }
}

/// A logger writes a row for each event of any sensor: each second one has no sample of the magnetometer.
#[test]
fn rows_without_a_sample_between_those_that_have_one_cost_nothing() {
    let [all, half] = [false, true].map(|has_gaps| {
        let (mut world, mut aided) = (World::new(71), Aided::new(Tuning::default(), None));
        let mut run = |world: &mut World, samples: usize| {
            for k in 0..samples {
                let sample = world.sample(0.005);
                if has_gaps && k % 2 == 1 {
                    aided.carry(sample.time_ns, &sample.inertial);
                } else {
                    aided.told(sample.time_ns, sample.raw_ut, &sample.inertial);
                }
            }
            let off_ut = (aided.calibration().unwrap().hard_iron_ut() - world.hard_iron_ut).norm();
            (off_ut, aided.senses.white.sigma_ut(), aided.changes.event.is_some())
        };
        let before = run(&mut world, 4_000);
        world.hard_iron_ut.x += 20.0;
        (before, run(&mut world, 3_000))
    });
    for ((before_ut, sigma_ut, is_early), (after_ut, _, is_told)) in [all, half] {
        assert!(before_ut < 1.0 && after_ut < 1.0, "b off by {before_ut}, then by {after_ut} uT");
        assert!((0.3..0.7).contains(&sigma_ut), "{sigma_ut} uT");
        assert!(!is_early && is_told);
    }
}
