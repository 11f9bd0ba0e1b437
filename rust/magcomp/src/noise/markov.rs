//! An error that lasts: a first-order Markov process x of standard deviation s and correlation time tau, under white noise.
//!
//! ```text
//! x <- phi x + (1 - phi^2)^1/2 s n,   phi = exp(-dt / tau);      miss = x + white
//! ```
//! s and tau stand on a grid. Each cell is a scalar Kalman filter over the misses, and its innovations are the likelihood of its s and tau:
//!
//! ```text
//! log P <- (1 - 1/N) log P - (min(nu^2 / S, 9) + ln S) / 2,     prior: ln s and ln tau normal, by one cell
//! ```
//! The clock is the caller's: that of a place's unevenness runs while the device moves, so that a rest says nothing of it.

use super::memory::MEMORY;
use crate::math::elementary::{exp, ln};
use crate::priors::BEYOND_CHANCE;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;

/// Choice: cells of s.
const SIZES: usize = 7;
/// Choice: cells of tau.
const LASTS: usize = 5;
/// Choice: each s, and each tau, is so many times the one before: one standard deviation of what is believed of them before anything is seen.
const RATIO: f64 = 3.0;

/// What lasts until the next miss: the correlation with it, and the variance.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Lasting {
    pub phi: f64,
    pub variance: f64,
}

/// Standard deviation of a process, and its correlation time, s.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Process {
    pub size: f64,
    pub lasts_s: f64,
}

impl Process {
    /// What lasts over so many seconds.
    pub fn over(&self, seconds: f64) -> Lasting {
        Lasting { phi: exp(-seconds / self.lasts_s), variance: self.size * self.size }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
struct Cell {
    mean: f64,
    variance: f64,
    log: f64,
}

#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Markov {
    believed: Process,
    cells: [[Cell; SIZES]; LASTS],
    learned: Process,
}

/// How far a cell is from the middle one.
fn steps(k: usize, cells: usize) -> i32 {
    k as i32 - (cells / 2) as i32
}

/// So many steps are this factor.
fn factor(steps: i32) -> f64 {
    let factor = RATIO.powi(steps.abs());
    if steps < 0 { 1.0 / factor } else { factor }
}

impl Markov {
    /// Believed to be of this size, and to last so long, before a miss is seen.
    pub fn new(size: f64, lasts_s: f64) -> Self {
        let cell = |k| Cell { variance: (size * factor(steps(k, SIZES))).powi(2), ..Cell::default() };
        let believed = Process { size, lasts_s };
        Self { believed, cells: [core::array::from_fn(cell); LASTS], learned: believed }
    }

    /// s and tau as learned so far.
    pub fn process(&self) -> Process {
        self.learned
    }

    /// A miss whose white variance is known, that of the prediction included, so many seconds after the one before.
    pub fn add(&mut self, miss: f64, white: f64, seconds: f64) {
        let (mut top, mut sum, mut size, mut lasts) = (f64::NEG_INFINITY, 0.0, 0.0, 0.0);
        for i in 0..LASTS {
            let lasts_by = steps(i, LASTS);
            let phi = exp(-seconds / (self.believed.lasts_s * factor(lasts_by)));
            for k in 0..SIZES {
                let size_by = steps(k, SIZES);
                let cell = &mut self.cells[i][k];
                cell.add(miss, white, phi, (self.believed.size * factor(size_by)).powi(2));
                let log = cell.log - 0.5 * f64::from(size_by * size_by + lasts_by * lasts_by);
                if log > top {
                    let less = exp(top - log);
                    (top, sum, size, lasts) = (log, sum * less, size * less, lasts * less);
                }
                let weight = exp(log - top);
                sum += weight;
                size += weight * f64::from(size_by);
                lasts += weight * f64::from(lasts_by);
            }
        }
        self.learned.size = self.believed.size * exp(size / sum * ln(RATIO));
        self.learned.lasts_s = self.believed.lasts_s * exp(lasts / sum * ln(RATIO));
    }
}

impl Cell {
    fn add(&mut self, miss: f64, white: f64, phi: f64, variance: f64) {
        self.mean *= phi;
        self.variance = phi * phi * self.variance + (1.0 - phi * phi) * variance;
        let total = self.variance + white;
        let nu = miss - self.mean;
        self.log += -self.log / MEMORY - 0.5 * ((nu * nu / total).min(BEYOND_CHANCE * BEYOND_CHANCE) + ln(total));
        let gain = self.variance / total;
        self.mean += gain * nu;
        self.variance *= 1.0 - gain;
    }
}
