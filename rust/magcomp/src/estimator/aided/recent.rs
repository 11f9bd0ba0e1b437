//! What the gyroscope read of late: the magnetometer saw the field as it was tau ago, and within tau the rate changes.

use nalgebra::Vector3;

/// Steps that are kept: delays of up to 80 ms at 100 Hz.
const STEPS: usize = 8;

/// The latest steps of the gyroscope, the newest first.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Recent {
    steps: [Increment; STEPS],
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
        self.steps.rotate_right(1);
        self.steps[0] = Increment { rad: *increment_rad, over_s: dt_s };
    }

    /// Mean reading over the latest `delay_s`, as far back as it is known, rad/s; `None` where the magnetometer is not late.
    pub(super) fn mean_rad_s(&self, delay_s: f64) -> Option<Vector3<f64>> {
        let (mut turned_rad, mut left_s) = (Vector3::zeros(), delay_s);
        for step in self.steps.iter().take_while(|step| step.over_s > 0.0) {
            let share = (left_s / step.over_s).clamp(0.0, 1.0);
            turned_rad += step.rad * share;
            left_s -= share * step.over_s;
        }
        let over_s = delay_s - left_s.max(0.0);
        (over_s > 0.0).then(|| turned_rad / over_s)
    }
}
