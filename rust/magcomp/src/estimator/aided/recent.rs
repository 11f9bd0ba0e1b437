//! What the gyroscope read of late: the magnetometer saw the field as it was tau ago, and within tau the rate changes.

use nalgebra::Vector3;

/// Choice: steps that are kept: delays of up to 80 ms at 100 Hz.
const STEPS: usize = 16;

/// The latest steps of the gyroscope, in a ring.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Recent {
    steps: [Increment; STEPS],
    newest: usize,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Increment {
    /// Turn that the gyroscope read, rad, in so many seconds.
    rad: Vector3<f64>,
    over_s: f64,
}

impl Recent {
    /// A step.
    pub(super) fn add(&mut self, increment_rad: &Vector3<f64>, dt_s: f64) {
        self.newest = (self.newest + 1) % STEPS;
        self.steps[self.newest] = Increment { rad: *increment_rad, over_s: dt_s };
    }

    /// Mean reading over the latest `delay_s`, as far back as it is known, rad/s; `None` where the magnetometer is not late.
    pub(super) fn mean_rad_s(&self, delay_s: f64) -> Option<Vector3<f64>> {
        let (mut turned_rad, mut left_s) = (Vector3::zeros(), delay_s);
        let newest_first = (0..STEPS).map(|k| &self.steps[(self.newest + STEPS - k) % STEPS]);
        for step in newest_first.take_while(|step| step.over_s > 0.0) {
            if left_s <= 0.0 {
                break;
            }
            let share = (left_s / step.over_s).min(1.0);
            turned_rad += step.rad * share;
            left_s -= share * step.over_s;
        }
        let over_s = delay_s - left_s.max(0.0);
        (over_s > 0.0).then(|| turned_rad / over_s)
    }
}
