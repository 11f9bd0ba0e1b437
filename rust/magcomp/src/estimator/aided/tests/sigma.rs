//! Whether the sigma of f covers what the filter does not model.

use nalgebra::{Matrix3, Vector3};

use super::super::Aided;
use super::super::state::SKEW;
use super::super::tuning::Tuning;
use super::simulator::World;
use crate::estimator::answer::Answer;
use crate::math::turn::Turn;
use crate::sensing::pairing::PairedInertial;

/// Squared error of f's direction and the variance told for it, rad^2.
fn direction(output: &Answer, field_ut: &Vector3<f64>) -> Option<(f64, f64)> {
    let f = output.filtered_field_ut?;
    let across = output.filtered_covariance_ut2.unwrap().trace()
        - f.dot(&(output.filtered_covariance_ut2.unwrap() * f)) / f.norm_squared();
    Some((f.angle(field_ut).powi(2), across / f.norm_squared()))
}

/// Root mean square of the error of f's direction, degrees, and of its sigma over that error, all worlds together; and the share
/// of errors within two sigmas.
fn judge(change: impl Fn(&mut World), each: impl Fn(&mut World)) -> [f64; 3] {
    let (mut square, mut variance, mut within, mut count) = (0.0, 0.0, 0, 0);
    for seed in 0..12 {
        let mut world = World::new(300 + seed);
        change(&mut world);
        let earth_ut = world.field_ut;
        let mut aided = Aided::new(Tuning::default(), None);
        for k in 0..6_000 {
            each(&mut world);
            let sample = world.sample(0.01);
            let (_, output) = aided.told(sample.time_ns, sample.raw_ut, &sample.inertial);
            // the device's axes are the gyroscope's
            let axes = &world.gyro_axes;
            let skew = Vector3::from(SKEW.map(|(a, b)| 0.5 * (axes[a] - axes[b])));
            let truth_ut = Turn::by(&skew).rotation * (world.attitude.inverse() * earth_ut);
            if let (true, Some((error, told))) = (k > 2_000, direction(&output, &truth_ut)) {
                square += error;
                variance += told;
                within += usize::from(error < 4.0 * 0.5 * told);
                count += 1;
            }
        }
    }
    [(square / f64::from(count)).sqrt().to_degrees(), (variance / square).sqrt(), within as f64 / f64::from(count)]
}

#[test]
fn axes_of_the_gyroscope_that_are_off_are_learned() {
    let skew = |world: &mut World| {
        let off = Matrix3::from_fn(|i, k| if i == k { 0.0 } else { 2.0 * world.random.uniform() - 1.0 });
        world.gyro_axes += off * f64::to_radians(1.0);
    };
    let [rms_deg, ratio, within] = judge(skew, |_| ());
    assert!(
        rms_deg < 0.3 && (1.0..10.0).contains(&ratio) && within > 0.95,
        "{rms_deg:.2} deg, {ratio:.1}, {within:.3}"
    );
}

/// The magnetometer sits askew in the device: field and vertical are told in the axes that gyroscope and accelerometer have, as surely as they are known.
#[test]
fn a_magnetometer_that_sits_askew_is_told_by_the_motion() {
    for (seed, askew_deg, most_deg) in
        [(320, 1.0, [1.0, 1.5]), (321, -3.0, [1.0, 1.5]), (322, 12.0, [2.0, 3.0]), (323, -12.0, [2.0, 3.0])]
    {
        let mut world = World::new(seed);
        let to_device = Turn::by(&(Vector3::new(0.3, 0.4, 0.866) * f64::to_radians(askew_deg))).rotation;
        world.gyro_axes = to_device;
        let mut aided = Aided::new(Tuning::default(), None);
        let (mut worst_deg, mut worst_z) = ([0.0_f64; 2], 0.0_f64);
        for k in 0..4_000 {
            let mut sample = world.sample(0.01);
            sample.inertial.up_m_s2 = sample.inertial.up_m_s2.map(|up| to_device * up);
            let (_, output) = aided.told(sample.time_ns, sample.raw_ut, &sample.inertial);
            if k < 2_000 {
                continue;
            }
            let truth = |of_world: Vector3<f64>| to_device * (world.attitude.inverse() * of_world);
            let off_deg = [
                output.filtered_field_ut.unwrap().angle(&truth(world.field_ut)).to_degrees(),
                output.up.unwrap().angle(&truth(Vector3::z())).to_degrees(),
            ];
            worst_deg = [0, 1].map(|i| worst_deg[i].max(off_deg[i]));
            let (error, told) = direction(&output, &truth(world.field_ut)).unwrap();
            worst_z = worst_z.max((2.0 * error / told).sqrt());
            let carry = output.carry.unwrap();
            assert!((carry.up.unwrap() - output.up.unwrap()).norm() < 1e-12);
        }
        let is_near = worst_deg[0] < most_deg[0] && worst_deg[1] < most_deg[1];
        assert!(is_near && worst_z < 3.5, "{askew_deg}: {worst_deg:.2?} deg, {worst_z:.1} sigmas");

        // a sample without a gyroscope is told in the same axes, and one after a restart in the magnetometer's, as nothing is known of another device
        for is_new in [false, true] {
            let mut sample = world.sample(0.01);
            let up = to_device * sample.inertial.up_m_s2.unwrap();
            sample.inertial = PairedInertial { rotation: None, up_m_s2: Some(up) };
            if is_new {
                aided.restart(None);
            }
            let (_, output) = aided.told(sample.time_ns, sample.raw_ut, &sample.inertial);
            let off_deg = output.field_ut.map(|it| it.angle(&(to_device * sample.field_ut)).to_degrees());
            let off_up_deg = output.up.unwrap().angle(&up).to_degrees();
            assert!(
                off_deg.is_none_or(|it| it < most_deg[1]) && off_deg.is_none() == is_new && off_up_deg < 1e-4,
                "{off_deg:?} {off_up_deg}"
            );
        }
    }
}

#[test]
fn a_very_uneven_field_counts_in_sigma() {
    // 4 uT an axis, correlated over a second: a steel hall
    let (earth, fade) = (Vector3::new(0.0, 25.0, -43.3), (-0.01_f64).exp());
    let walk = |world: &mut World| {
        let kept = (world.field_ut - earth) * fade;
        world.field_ut = earth + kept + world.random.vector(4.0 * (1.0 - fade * fade).sqrt());
    };
    let [rms_deg, ratio, within] = judge(|_| (), walk);
    assert!((0.8..3.0).contains(&ratio) && within > 0.85, "{rms_deg:.2} deg, {ratio:.1}, {within:.3}");
}
