//! The noise of the samples, learned from the innovations: how far a sample lies off the ellipsoid predicted for it.
//!
//! Level: v <- v + g w (min(e^2, 4 V) / 0.92 - V), V = v + rho, e the innovation as a distance, rho the variance that the
//! parameters' own uncertainty gives it, w = v / V the share that is noise. Clipped, so that spikes hardly count; 0.92 is
//! what the clipped square of a normal comes to on average.
//!
//! Colour: the field of a room is uneven over some tens of centimetres, so that residuals of neighbouring samples agree.
//! kappa = mean of (sum of z over a block)^2 / length is 1 for white noise; n correlated samples are worth n / kappa.
//! What a fit absorbs does not show in its innovations; so a room's own unevenness s_u (config) comes on top, as errors
//! that last for a second, m samples: the samples inform as white noise of V = kappa v + m s_u^2 would.

use crate::snapshot::checked;
use serde::{Deserialize, Serialize};

/// Samples that the sensor's own figure is worth at the start.
const START_SAMPLES: f64 = 20.0;
/// Samples after which the start no longer matters much.
const KNOWN_FROM: f64 = 100.0;
/// Parameters of a fit.
const PARAMETERS: f64 = 9.0;
/// Memory of the level, samples: 3 % of scatter.
const MEMORY: f64 = 1000.0;
/// Larger innovations count as this many standard deviations.
const CLIP: f64 = 2.0;
/// Mean of min(z^2, CLIP^2) for a standard normal z.
const CLIPPED_MEAN: f64 = 0.9205;
/// Length of a block, samples: the unevenness of rooms lasts about half a second while walking.
const BLOCK: u32 = 32;
/// Memory of kappa, blocks, and blocks that the start value 1 is worth.
const BLOCKS: f64 = 30.0;
const START_BLOCKS: f64 = 4.0;
/// How long a room's unevenness lasts, s: the aided method's local field has about as much.
const UNEVEN_S: f64 = 1.0;
/// Largest contribution of a block.
const LARGEST_BLOCK: f64 = 32.0;
/// White noise stays below this with the memory above (4 sigma): up to here kappa counts as 1.
const WHITE: f64 = 2.0;

/// Level and colour of the noise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(remote = "Self")]
pub(super) struct Noise {
    /// v, units^2 per axis.
    pub variance: f64,
    least: f64,
    start: f64,
    samples: f64,
    sum: f64,
    in_block: u32,
    blocks: f64,
    mean_block: f64,
    /// s_u^2, units^2.
    uneven: f64,
    /// Time between samples, s.
    period_s: f64,
}

checked!(Noise, |it| {
    [it.variance, it.least, it.start, it.samples, it.blocks].iter().all(|v| *v > 0.0)
        && [it.mean_block, it.uneven, it.period_s].iter().all(|v| *v >= 0.0)
        && it.in_block < BLOCK
});

impl Noise {
    /// From a standard deviation in units, the least that is believed, and the unevenness of rooms.
    pub fn new(sigma: f64, least: f64, uneven: f64) -> Self {
        Self {
            variance: sigma * sigma,
            least: least * least,
            start: sigma * sigma,
            samples: START_SAMPLES,
            sum: 0.0,
            in_block: 0,
            blocks: START_BLOCKS,
            mean_block: 1.0,
            uneven: uneven * uneven,
            period_s: 0.0,
        }
    }

    /// Whether enough has been seen for the level to be trusted.
    pub fn is_known(&self) -> bool {
        self.samples > START_SAMPLES + KNOWN_FROM
    }

    /// The time between two samples, s.
    pub fn learn_period(&mut self, seconds: f64) {
        if seconds > 0.0 && seconds < 1.0 {
            let known = if self.period_s > 0.0 { 0.02 } else { 1.0 };
            self.period_s += known * (seconds - self.period_s);
        }
    }

    /// Time between samples, s; 0 while unknown.
    pub fn period_s(&self) -> f64 {
        self.period_s
    }

    /// V / v: so many samples are worth one of white noise.
    pub fn correlation(&self) -> f64 {
        let kappa = if self.mean_block < WHITE { 1.0 } else { self.mean_block };
        kappa + self.uneven_samples() * self.uneven / self.variance
    }

    /// Samples for which the unevenness of a room stays the same error.
    pub fn uneven_samples(&self) -> f64 {
        if self.period_s > 0.0 { (UNEVEN_S / self.period_s).max(1.0) } else { 1.0 }
    }

    /// s_u, units.
    pub fn unevenness(&self) -> f64 {
        self.uneven.sqrt()
    }

    /// Variance of one sample about its prediction, the parameters' own share aside.
    pub fn total(&self) -> f64 {
        self.variance + self.uneven
    }

    /// An innovation (distance, units), the variance rho of its prediction, and the most that v may be.
    pub fn learn(&mut self, innovation: f64, rho: f64, most: f64) {
        let expected = self.variance + rho;
        let share = self.variance / expected;
        let square = (innovation * innovation).min(CLIP * CLIP * expected) / CLIPPED_MEAN;
        self.samples = (self.samples + share).min(MEMORY);
        let variance = self.variance + share * (square - expected) / self.samples;
        self.variance = variance.min(most).max(self.least);
    }

    /// Before anything is known innovations tell little: the mean square distance of `count` samples from their own fit.
    pub fn learn_from_fit(&mut self, distance_squared: f64, count: f64) {
        let free = count - PARAMETERS;
        if free > 0.0 {
            let samples = START_SAMPLES + free;
            self.variance = (START_SAMPLES * self.start + distance_squared * count) / samples;
            self.variance = self.variance.max(self.least);
            self.samples = samples.min(MEMORY);
        }
    }

    /// A normalised innovation of the calibration in force.
    pub fn learn_colour(&mut self, z: f64) {
        self.sum += z.clamp(-4.0, 4.0);
        self.in_block += 1;
        if self.in_block == BLOCK {
            let square = (self.sum * self.sum / f64::from(BLOCK)).min(LARGEST_BLOCK);
            self.blocks = (self.blocks + 1.0).min(BLOCKS);
            self.mean_block += (square - self.mean_block) / self.blocks;
            (self.sum, self.in_block) = (0.0, 0);
        }
    }

    /// A block that spans a change says nothing.
    pub fn forget_block(&mut self) {
        (self.sum, self.in_block) = (0.0, 0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Neighbours tell how large white noise is; what an ellipsoid that moves away is missed by besides is none.
    #[test]
    fn what_neighbours_do_not_show_is_no_noise() {
        let after = |most: f64| {
            let mut noise = Noise::new(0.01, 1e-4, 0.0);
            (0..4000).for_each(|k| noise.learn(1e-4 * f64::from(k), 0.0, most));
            noise.variance.sqrt()
        };
        assert!((after(9e-4) - 0.03).abs() < 1e-12);
        assert!(after(f64::INFINITY) > 0.1, "{}", after(f64::INFINITY));
    }
}
