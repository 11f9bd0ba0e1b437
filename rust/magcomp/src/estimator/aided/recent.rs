//! What the sensors read of late. The magnetometer saw the field as it was tau ago, and within tau the rate changes. Where tau is below zero, the
//! gyroscope has yet to tell of the turn that a sample has seen: the sample waits for it.

use nalgebra::Vector3;

/// Choice: steps that are kept: delays of up to 80 ms at 100 Hz.
const STEPS: usize = 16;

/// The latest steps of the gyroscope, each with the sample at its end, in a ring.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Recent {
    steps: [Entry; STEPS],
    newest: usize,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Entry {
    /// Turn that the gyroscope read, rad, in so many seconds.
    rad: Vector3<f64>,
    over_s: f64,
    pub(super) raw_ut: Vector3<f64>,
    /// The sensor was at its full scale, or told nothing: `raw_ut` says nothing.
    pub(super) is_blank: bool,
}

impl Recent {
    /// A step, and the sample at its end.
    pub(super) fn add(&mut self, increment_rad: &Vector3<f64>, dt_s: f64, raw_ut: &Vector3<f64>, is_blank: bool) {
        self.newest = (self.newest + 1) % STEPS;
        self.steps[self.newest] = Entry { rad: *increment_rad, over_s: dt_s, raw_ut: *raw_ut, is_blank };
    }

    fn newest_first(&self) -> impl Iterator<Item = &Entry> {
        (0..STEPS).map(|k| &self.steps[(self.newest + STEPS - k) % STEPS]).take_while(|step| step.over_s > 0.0)
    }

    /// The sample that comes nearest to one of `wait_s` ago, as far back as they are kept, and how long it has waited, s.
    pub(super) fn waited(&self, wait_s: f64) -> (Entry, f64) {
        let mut nearest = (&self.steps[self.newest], 0.0);
        let mut next_s = 0.0;
        for before in self.newest_first().skip(1) {
            let over_s = nearest.0.over_s;
            next_s += over_s;
            if wait_s < next_s - 0.5 * over_s {
                break;
            }
            nearest = (before, next_s);
        }
        (*nearest.0, nearest.1)
    }

    /// Mean reading over the latest `delay_s`, as far back as it is known, rad/s; `None` where the sample is not late.
    pub(super) fn mean_rad_s(&self, delay_s: f64) -> Option<Vector3<f64>> {
        let (mut turned_rad, mut left_s) = (Vector3::zeros(), delay_s);
        for step in self.newest_first() {
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
