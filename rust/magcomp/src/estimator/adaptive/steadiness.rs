//! A hand moves smoothly: a sample that leaps away from the latest good one, much further than samples usually differ, is a
//! spike, or the first after a change. Where every sample points elsewhere the usual step is large and nothing leaps.
//!     usual <- usual + (min(step, 3 usual) - usual) / 20
//! Of a smooth motion the second differences of the samples are noise, of six times its variance:
//!     v <- v + (min(|second difference|^2 / 18, 9 v) - v) / 1000        5 / n instead for the first samples
//! A device that does not turn does not move either: what the field of the place adds is one and the same error all the time.

use crate::snapshot::checked;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Samples from which the usual step is known well enough.
const KNOWN_FROM: u32 = 8;
/// Memory of the usual step, samples.
const MEMORY: f64 = 20.0;
/// Memory of the noise, samples.
const NOISE_MEMORY: f64 = 1000.0;
/// Until then the gain is so many times 1 / n: a spike among the first samples, where there is nothing to clip it by, is
/// forgotten as n^-5.
const FORGETTING: f64 = 5.0;
/// Memory of the mean that tells rest, samples.
const REST_MEMORY: f64 = 8.0;
/// A leap exceeds so many usual steps ...
const LEAP: f64 = 8.0;
/// ... and this, in field strengths: no hand turns a phone by 17 deg between two samples.
const LEAST_LEAP: f64 = 0.3;

/// How far apart samples usually are.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(remote = "Self")]
pub(super) struct Steadiness {
    previous: Option<Vector3<f64>>,
    /// The latest step, and the noise that steps differ by, units^2 per axis.
    step: Vector3<f64>,
    variance: f64,
    good: Option<Vector3<f64>>,
    usual: f64,
    count: u32,
    misses: u32,
    alone: bool,
    /// Mean of the latest good samples, where it was when the device came to rest, and samples since.
    mean: Vector3<f64>,
    place: Option<Vector3<f64>>,
    resting: u32,
}

checked!(Steadiness, |it| it.variance >= 0.0 && it.usual >= 0.0 && it.count <= 10_000 && it.misses <= 100);

impl Steadiness {
    pub fn new() -> Self {
        Self {
            previous: None,
            step: Vector3::zeros(),
            variance: 0.0,
            good: None,
            usual: 0.0,
            count: 0,
            misses: 0,
            alone: false,
            mean: Vector3::zeros(),
            place: None,
            resting: 0,
        }
    }

    /// Whether enough has been seen to tell a leap.
    pub fn is_known(&self) -> bool {
        self.count >= KNOWN_FROM
    }

    /// Noise as neighbours differ, units^2 per axis.
    pub fn variance(&self) -> f64 {
        self.variance
    }

    /// Whether the latest sample leapt away from the one before it: of a change only the first does, of spikes every one.
    pub fn is_alone(&self) -> bool {
        self.alone
    }

    /// Whether a sample (field strengths) leaps.
    pub fn leaps(&mut self, sample: &Vector3<f64>) -> bool {
        if let Some(previous) = self.previous.replace(*sample) {
            let bend = (sample - previous - self.step).norm_squared() / 18.0;
            self.step = sample - previous;
            let step = self.step.norm();
            self.count = (self.count + 1).min(10_000);
            let clipped = if self.count > 2 { step.min(3.0 * self.usual) } else { step };
            let clipped_bend = if self.count > 2 { bend.min(9.0 * self.variance) } else { bend };
            self.variance +=
                (clipped_bend - self.variance) / (f64::from(self.count) / FORGETTING).clamp(1.0, NOISE_MEMORY);
            self.alone = self.is_known() && step > (LEAP * self.usual).max(LEAST_LEAP);
            self.usual += (clipped - self.usual) / f64::from(self.count).min(MEMORY);
        }
        let reach = (LEAP * self.usual).max(LEAST_LEAP) * f64::from(1 + self.misses);
        let leaps = self.is_known() && self.good.is_some_and(|good| (sample - good).norm() > reach);
        if leaps {
            self.misses = (self.misses + 1).min(100);
        } else {
            self.good = Some(*sample);
            self.misses = 0;
        }
        leaps
    }

    /// Whether the device has rested for longer than `samples`: a good sample, on average, within this of where it was.
    pub fn rests(&mut self, sample: &Vector3<f64>, within: f64, samples: f64) -> bool {
        self.mean = self.place.map_or(*sample, |_| self.mean + (sample - self.mean) / REST_MEMORY);
        if self.place.is_none_or(|place| (self.mean - place).norm() > within) {
            (self.place, self.resting) = (Some(self.mean), 0);
        }
        self.resting = self.resting.saturating_add(1);
        self.is_resting(samples)
    }

    /// The same as of the latest good sample.
    pub fn is_resting(&self, samples: f64) -> bool {
        f64::from(self.resting) > samples
    }

    /// After a change the latest sample is a good one.
    pub fn accept(&mut self) {
        self.good = self.previous;
        self.misses = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spike_leaps_and_random_orientations_do_not() {
        let mut smooth = Steadiness::new();
        let at = |k: i32| Vector3::new((f64::from(k) * 0.01).sin(), (f64::from(k) * 0.01).cos(), 0.0);
        let leaps: Vec<i32> = (0..200)
            .filter(|k| smooth.leaps(&(at(*k) + if k % 50 == 30 { Vector3::z() } else { Vector3::zeros() })))
            .collect();
        assert_eq!(leaps, [30, 80, 130, 180]);
        let mut random = Steadiness::new();
        assert!((0..500).all(|k| !random.leaps(&Vector3::new(f64::from(k).sin(), f64::from(k * 7).cos(), 0.3))));
    }

    #[test]
    fn a_spike_at_the_start_is_no_noise() {
        let noise = |spike: f64| {
            let mut smooth = Steadiness::new();
            for k in 0..100 {
                let noise = 0.01 * f64::from(k % 3 - 1) + if k == 1 { spike } else { 0.0 };
                smooth.leaps(&Vector3::new((f64::from(k) * 0.01).sin(), (f64::from(k) * 0.01).cos(), noise));
            }
            smooth.variance()
        };
        assert!(noise(2.0) < 1.1 * noise(0.0), "{} against {}", noise(2.0), noise(0.0));
    }

    #[test]
    fn rest_begins_again_with_every_turn() {
        let mut steadiness = Steadiness::new();
        // at rest but for noise of 0.01 a sample, turned between 150 and 160
        let at = |k: i32| Vector3::new(0.1 * f64::from((k - 150).clamp(0, 10)), 0.01 * f64::from(k % 3 - 1), 1.0);
        let resting: Vec<bool> = (0..300).map(|k| steadiness.rests(&at(k), 0.03, 50.0)).collect();
        assert!(!resting[..50].contains(&true) && !resting[50..150].contains(&false), "{resting:?}");
        assert!(!resting[152..210].contains(&true) && !resting[250..].contains(&false), "{resting:?}");
    }
}
