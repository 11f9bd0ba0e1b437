//! Whether the sigma of f covers what the filter does not model.

use nalgebra::{Matrix3, Vector3};

use super::super::Aided;
use super::super::tuning::Tuning;
use super::simulator::World;
use crate::estimator::answer::Answer;

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
            if let (true, Some((error, told))) = (k > 2_000, direction(&output, &(world.attitude.inverse() * earth_ut)))
            {
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
    // sigma allows for frames of magnetometer and accelerometer that differ; here they do not
    assert!(
        rms_deg < 0.3 && (1.0..10.0).contains(&ratio) && within > 0.95,
        "{rms_deg:.2} deg, {ratio:.1}, {within:.3}"
    );
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
