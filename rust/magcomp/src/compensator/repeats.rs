//! A magnetometer that repeats its reading, to the last bit: it hangs where the device turns meanwhile, by the gyroscope (`sensing/hang.rs`) or by gravity,
//! whose means over runs of equal samples are compared with the first. Where neither speaks nobody knows: noise changes the last digit of most sensors, so it
//! is a hang. Another reading ends it.

use super::tuning::Tuning;
use crate::math::elementary::atan2;
use crate::sensing::hang::{Turned, hangs};
use crate::sensing::pairing::PairedInertial;
use nalgebra::Vector3;

#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Repeats {
    /// How many equal samples came in a row before the latest.
    samples: usize,
    turned: Turned,
    /// Sum of gravity over the run so far, how many samples it has, and its direction in the first run.
    up_sum: Vector3<f64>,
    up_samples: usize,
    first_up: Option<Vector3<f64>>,
    has_turned: bool,
}

impl Repeats {
    /// A sample was used, which repeats the one before or does not.
    pub fn count(&mut self, is_same: bool) {
        *self = if is_same { Self { samples: self.samples.saturating_add(1), ..*self } } else { Self::default() };
    }

    /// What the other sensors say with the latest sample, and the time since the one before, s.
    pub fn see(&mut self, paired: &PairedInertial, span_s: f64) {
        if self.samples == 0 {
            return;
        }
        if let Some(rotation) = &paired.rotation {
            self.turned.add(rotation, span_s);
            self.has_turned |= hangs(self.turned.angle_rad());
        }
        if let Some(up_m_s2) = &paired.up_m_s2 {
            self.up_sum += up_m_s2;
            self.up_samples += 1;
            if is_run(self.up_samples) {
                let first_up = self.first_up.get_or_insert(self.up_sum);
                self.has_turned |= hangs(atan2(first_up.cross(&self.up_sum).norm(), first_up.dot(&self.up_sum)));
                (self.up_sum, self.up_samples) = (Vector3::zeros(), 0);
            }
        }
    }

    /// How often the reading came, where one more of the same is no reading; `is_told`: gyroscope or gravity speaks.
    pub fn hang(&self, is_told: bool) -> Option<usize> {
        let samples = self.samples.saturating_add(1);
        (is_run(samples) && (self.has_turned || !is_told)).then_some(samples)
    }
}

/// Whether so many equal samples in a row are no accident.
fn is_run(samples: usize) -> bool {
    samples as f64 >= Tuning::USED.run_samples
}
