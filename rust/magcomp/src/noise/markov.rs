//! An error that lasts: a first-order Markov process x of standard deviation s and correlation time tau, under white noise.
//!
//! ```text
//! x <- phi x + (1 - phi^2)^1/2 s n,   phi = exp(-dt / tau);      miss = x + white
//! ```
//! s and tau stand on a grid. Each cell is a scalar Kalman filter over the misses, and its innovations are the likelihood of its s and tau:
//!
//! ```text
//! log P <- (1 - 1/N) log P - (min(nu^2 / S, 9) + ln S) / 2,     prior: ln s and ln tau normal
//! ```
//! The clock is the caller's: that of a place's unevenness runs while the device moves, so that a rest says nothing of it.

use super::memory::MEMORY;
use crate::math::elementary::{exp, ln};
use crate::priors::BEYOND_CHANCE;

/// Choice: cells of s.
const SIZES: usize = 7;
/// Choice: cells of tau.
const LASTS: usize = 5;
/// Choice: each s, and each tau, is so many times the one before.
const RATIO: f64 = 3.0;
/// Choice: standard deviation of ln s and ln tau before anything is seen, an order of magnitude either way within two.
const SPREAD: f64 = 1.0;

/// What lasts until the next miss: the correlation with it, and the variance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Lasting {
    pub phi: f64,
    pub variance: f64,
}

/// Standard deviation of a process, and its correlation time, s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Cell {
    mean: f64,
    variance: f64,
    log: f64,
}

/// See the module.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Markov {
    believed: (f64, f64),
    cells: [[Cell; SIZES]; LASTS],
    size: f64,
    lasts_s: f64,
}

/// A value of a grid about `middle`.
fn on_grid(middle: f64, k: usize, cells: usize) -> f64 {
    middle * RATIO.powi(k as i32 - (cells / 2) as i32)
}

impl Markov {
    /// Believed to be of this size, and to last so long, before a miss is seen.
    pub fn new(size: f64, lasts_s: f64) -> Self {
        let cell = |k| Cell { variance: on_grid(size, k, SIZES).powi(2), ..Cell::default() };
        Self { believed: (size, lasts_s), cells: [std::array::from_fn(cell); LASTS], size, lasts_s }
    }

    /// s and tau as learned so far.
    pub fn process(&self) -> Process {
        Process { size: self.size, lasts_s: self.lasts_s }
    }

    /// A miss whose white variance is known, that of the prediction included, so many seconds after the one before.
    pub fn add(&mut self, miss: f64, white: f64, seconds: f64) {
        let (mut top, mut sum, mut size, mut lasts) = (f64::NEG_INFINITY, 0.0, 0.0, 0.0);
        for i in 0..LASTS {
            let tau = on_grid(self.believed.1, i, LASTS);
            let phi = exp(-seconds / tau);
            let by_tau = ln(tau / self.believed.1);
            for k in 0..SIZES {
                let s = on_grid(self.believed.0, k, SIZES);
                let by_size = ln(s / self.believed.0);
                let cell = &mut self.cells[i][k];
                cell.add(miss, white, phi, s * s);
                let log = cell.log - 0.5 * (by_size * by_size + by_tau * by_tau) / (SPREAD * SPREAD);
                if log > top {
                    let less = exp(top - log);
                    (top, sum, size, lasts) = (log, sum * less, size * less, lasts * less);
                }
                let weight = exp(log - top);
                sum += weight;
                size += weight * by_size;
                lasts += weight * by_tau;
            }
        }
        self.size = self.believed.0 * exp(size / sum);
        self.lasts_s = self.believed.1 * exp(lasts / sum);
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
