//! A field that is carried beside that of the place, and was led astray, is given up for one that is as strong and as deep.

use nalgebra::{Rotation3, Unit};

use super::super::earth::Earth;
use super::super::phase::Phase;
use super::super::state::FIELD;
use super::super::{Aided, Tuning};
use super::simulator::World;

/// Whether the Earth's field is still carried `seconds` after it was turned by 1 rad about the vertical and made longer by `factor`, known
/// to `sd_ut` an axis.
fn is_carried_after(seconds: f64, factor: f64, sd_ut: f64) -> bool {
    let (mut world, mut aided) = (World::new(61), Aided::new(Tuning::default(), None));
    let mut run = |aided: &mut Aided, seconds: f64| {
        for _ in 0..(seconds * 100.0) as usize {
            let sample = world.sample(0.01);
            aided.push(sample.time_ns, sample.raw_ut, &sample.inertial);
        }
    };
    run(&mut aided, 20.0);
    let up = Unit::new_normalize(aided.motion.up.expect("an accelerometer"));
    let Phase::Running(running) = &mut aided.phase else { panic!("not settled") };
    let mut carried = running.filter.clone();
    let turned = Rotation3::from_axis_angle(&up, 1.0) * carried.part(FIELD);
    carried.set_part(FIELD, &(turned * factor));
    carried.add_variance(FIELD, sd_ut * sd_ut);
    running.earth = Some(Earth::of(&carried, None, 0));
    run(&mut aided, seconds);
    aided.phase.running().expect("settled").earth.is_some()
}

#[test]
fn a_field_as_strong_and_as_deep_is_the_earths_after_five_seconds() {
    assert!(is_carried_after(4.0, 1.0, 15.0));
    assert!(!is_carried_after(7.0, 1.0, 15.0));
}

#[test]
fn a_field_that_is_weaker_by_a_sixth_is_not() {
    assert!(is_carried_after(7.0, 1.2, 15.0));
}

/// Another room whose field points elsewhere, and is by chance as strong and as deep.
#[test]
fn a_field_that_has_not_drifted_so_far_is_not() {
    assert!(is_carried_after(7.0, 1.0, 1.0));
}
