//! What samples miss their ellipsoid by: white noise of the sensor, and the unevenness of the place.
//!
//! White level v, per axis: half the mean square difference of neighbouring distances, or, where the motion is smooth, a
//! sixth of the mean square second difference of the raw samples, whichever is less. Clipped, so that spikes hardly count:
//!     v <- v + (min(x^2, 4 v) / 0.92 - v) / n
//! Unevenness is a first-order Markov process of variance s^2 that lasts for tau. Differences of neighbouring sums over
//! T = 2^j bins (Haar wavelets, nearly independent of one another) of n samples each then have the mean square, per sample,
//!     A_j = v + (n/2) s^2 f(tau/T),   f(x) = 4 x (1 - x e) - 2 x^2 e^2,   e = 1 - exp(-1/x)
//! and s and tau follow from all A_j on a grid, by their posterior probability:
//!     log P = -1/2 sum_j N_j (ln A_j(s, tau) + A_j / A_j(s, tau)) - (ln s/s0)^2 / 2 w^2 - (ln tau/tau0)^2 / 2 w^2
//! Of the samples
//!     kappa = 1 + 2 s^2 tau / (v dt)
//! are worth one: what lasts is not averaged away.

use super::tuning::Tuning;
use nalgebra::Vector3;

/// Times over which errors are summed: 0.02 s times 2^j, up to 5.12 s.
const LEVELS: usize = 9;
const BIN_S: f64 = 0.02;
/// Larger values count as this many standard deviations; the mean of min(z^2, CLIP^2) of a normal z.
const CLIP: f64 = 2.0;
const CLIPPED_MEAN: f64 = 0.9205;
/// Samples that the value at the start is worth, and the memory (3 % of scatter).
const START: f64 = 20.0;
const MEMORY: f64 = 1000.0;
/// Seconds of sums of one length that are remembered, and how many sums at most.
const SUMS_S: f64 = 120.0;
const MOST_SUMS: f64 = 100.0;
/// A mean square of any number of sums is believed as one of so many: no place is quite such a process.
const WORTH: f64 = 10.0;
/// The grid: each s and each tau is twice the one before.
const SIZES: usize = 10;
const LASTS: usize = 8;

/// What samples are believed to be like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Level {
    /// White variance of a sample, units^2.
    pub white: f64,
    /// Variance of the place's unevenness, units^2.
    pub uneven: f64,
    /// Samples that are worth one.
    pub kappa: f64,
    /// The same for the vertical part: white variance (field strengths squared) and samples that are worth one.
    pub vertical: (f64, f64),
}

/// A clipped running mean square.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Mean {
    value: f64,
    count: f64,
}

impl Mean {
    fn new(value: f64) -> Self {
        Self { value, count: START }
    }

    fn add(&mut self, square: f64, share: f64) {
        self.count = (self.count + share).min(MEMORY);
        let square = square.min(CLIP * CLIP * self.value) / CLIPPED_MEAN;
        self.value += share * (square - self.value) / self.count;
    }
}

/// What is believed of errors that last before any are seen, and the least that is believed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Believed {
    /// s0 and the least s.
    pub size: (f64, f64),
    /// tau0 and the least tau, s.
    pub lasts_s: (f64, f64),
    /// w: standard deviation of ln s and of ln tau.
    pub spread: f64,
}

/// Sums of errors over one length of time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Scale {
    /// The sum and its samples that wait for the next.
    pending: Option<(f64, f64)>,
    /// A_j, and from how many differences.
    allan: f64,
    count: f64,
}

/// Errors that last: s and tau.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Lasting {
    believed: Believed,
    bin: (f64, f64),
    scales: [Scale; LEVELS],
    /// s^2 and 2 s^2 tau (s).
    square: f64,
    worth_s: f64,
}

impl Lasting {
    fn new(believed: Believed) -> Self {
        let square = believed.size.0.powi(2);
        let worth_s = 2.0 * square * believed.lasts_s.0;
        Self { believed, bin: (0.0, 0.0), scales: [Scale::default(); LEVELS], square, worth_s }
    }

    /// The mean of so many errors.
    fn add(&mut self, e: f64, count: f64, white: f64, period_s: f64) {
        self.bin.0 += count * e;
        self.bin.1 += count;
        if self.bin.1 * period_s < 0.75 * BIN_S {
            return;
        }
        let bin = self.bin.1 * period_s;
        let mut sum = std::mem::take(&mut self.bin);
        for (j, scale) in self.scales.iter_mut().enumerate() {
            let Some(other) = scale.pending.take() else {
                scale.pending = Some(sum);
                if j > 3 {
                    self.judge(white, bin, period_s);
                }
                return;
            };
            let samples = sum.1 + other.1;
            let most = (SUMS_S / (BIN_S * f64::from(2u32 << j))).min(MOST_SUMS);
            scale.count = (scale.count + 1.0).min(most);
            scale.allan += ((sum.0 - other.0).powi(2) / samples - scale.allan) / scale.count;
            sum = (sum.0 + other.0, samples);
        }
    }

    /// s and tau by their posterior probability: logarithmic means.
    fn judge(&mut self, white: f64, bin_s: f64, period_s: f64) {
        let Believed { size, lasts_s, spread } = self.believed;
        let (mut top, mut sum, mut square, mut worth) = (f64::NEG_INFINITY, 0.0, 0.0, 0.0);
        for i in 0..LASTS {
            let tau = lasts_s.1 * f64::from(1u32 << i);
            let share: [f64; LEVELS] = std::array::from_fn(|j| {
                let t = bin_s * f64::from(1u32 << j);
                let x = tau / t;
                let e = 1.0 - (-1.0 / x).exp();
                0.5 * t / period_s * (4.0 * x * (1.0 - x * e) - 2.0 * x * x * e * e)
            });
            let prior = (tau / lasts_s.0).ln().powi(2);
            for k in 0..SIZES {
                let s = size.1 * f64::from(1u32 << k);
                let mut log = -0.5 * (prior + (s / size.0).ln().powi(2)) / (spread * spread);
                for (scale, share) in self.scales.iter().zip(share) {
                    if scale.count > 0.0 {
                        let expected = white + s * s * share;
                        let count = 1.0 / (1.0 / scale.count + 1.0 / WORTH);
                        log -= 0.5 * count * (expected.ln() + scale.allan / expected);
                    }
                }
                if log > top {
                    let less = (top - log).exp();
                    (top, sum, square, worth) = (log, sum * less, square * less, worth * less);
                }
                let weight = (log - top).exp();
                sum += weight;
                square += weight * (s * s).ln();
                worth += weight * (2.0 * s * s * tau).ln();
            }
        }
        (self.square, self.worth_s) = ((square / sum).exp(), (worth / sum).exp());
    }

    /// Sums that are not complete say nothing.
    fn interrupt(&mut self) {
        self.scales.iter_mut().for_each(|scale| scale.pending = None);
        self.bin = (0.0, 0.0);
    }
}

/// White and lasting errors of a prediction.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Errors {
    white: Mean,
    /// The latest mean, and of how many.
    latest: Option<(f64, f64)>,
    lasting: Lasting,
}

impl Errors {
    fn new(white: f64, believed: Believed) -> Self {
        Self { white: Mean::new(white), latest: None, lasting: Lasting::new(believed) }
    }

    /// What predictions of `count` neighbours miss in the mean, the variance of the predictions, the white variance; `lasting`
    /// where they are good enough to tell what lasts.
    fn add(&mut self, (e, count): (f64, f64), rho: f64, white: f64, period_s: f64, lasting: bool) {
        if let Some((latest, before)) = self.latest {
            let square = (e - latest).powi(2) / (1.0 / count + 1.0 / before);
            self.white.add(square, white / (white + rho));
        }
        self.latest = Some((e, count));
        if lasting {
            let most = 3.0 * (white + 4.0 * self.lasting.square).sqrt();
            self.lasting.add(e.clamp(-most, most), count, white, period_s);
        }
    }

    fn interrupt(&mut self) {
        self.lasting.interrupt();
        self.latest = None;
    }

    fn kappa(&self, white: f64, period_s: f64) -> f64 {
        1.0 + self.lasting.worth_s / (white * period_s)
    }
}

/// White noise that is believed, uT: no less than a step of 0.1 uT makes, no more than a loud sensor has.
const LEAST_NOISE_UT: f64 = 0.03;
const MOST_NOISE_UT: f64 = 4.0;
/// The grid's least unevenness, uT, and its least time, s: nobody could tell them from none, and from white noise.
const LEAST_UNEVEN_UT: f64 = 0.02;
const LEAST_UNEVEN_S: f64 = 0.05;
/// Least white noise of a vertical, radians.
const LEAST_TILT_RAD: f64 = 0.005;

/// The learned noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Noise {
    distance: Errors,
    vertical: Errors,
    second: Mean,
    raw: [Vector3<f64>; 2],
    seen: usize,
    least: f64,
    most: f64,
    period_s: f64,
}

impl Noise {
    pub fn new(tuning: &Tuning, unit_ut: f64) -> Self {
        let square = |ut: f64| (ut / unit_ut).powi(2);
        let v = square(tuning.noise_ut);
        let spread = tuning.believed_spread;
        let uneven = Believed {
            size: (tuning.uneven_ut / unit_ut, LEAST_UNEVEN_UT / unit_ut),
            lasts_s: (tuning.uneven_s, LEAST_UNEVEN_S),
            spread,
        };
        let tilt = Believed {
            size: (tuning.tilt_rad, tuning.least_tilt_rad),
            lasts_s: (tuning.tilt_s, tuning.tilt_s),
            spread,
        };
        Self {
            distance: Errors::new(v, uneven),
            vertical: Errors::new(LEAST_TILT_RAD.powi(2), tilt),
            second: Mean::new(v),
            raw: [Vector3::zeros(); 2],
            seen: 0,
            least: square(LEAST_NOISE_UT),
            most: square(MOST_NOISE_UT),
            period_s: 0.01,
        }
    }

    /// Every raw sample, units, and the time since the one before, s.
    pub fn raw(&mut self, u: &Vector3<f64>, seconds: Option<f64>) {
        if let Some(seconds) = seconds.filter(|seconds| *seconds < 1.0) {
            let gain = if self.seen < 2 { 1.0 } else { 0.02 };
            self.period_s += gain * (seconds - self.period_s);
        }
        if self.seen >= 2 {
            self.second.add((u - self.raw[1] * 2.0 + self.raw[0]).norm_squared() / 18.0, 1.0);
        }
        self.raw = [self.raw[1], *u];
        self.seen += 1;
    }

    /// Time between samples, s.
    pub fn period_s(&self) -> f64 {
        self.period_s
    }

    /// A sample's distance from the ellipsoid predicted, and the variance of that prediction; `lasting` where the prediction is
    /// good enough to tell what lasts.
    pub fn distance(&mut self, e: f64, rho: f64, lasting: bool) {
        self.distance.add((e, 1.0), rho, self.white(), self.period_s, lasting);
    }

    /// What the vertical part of so many neighbours misses in the mean, in field strengths, and the variance of its prediction.
    pub fn vertical(&mut self, e: (f64, f64), rho: f64, lasting: bool) {
        self.vertical.add(e, rho, self.white_vertical(), self.period_s, lasting);
    }

    /// Sums that a change or a spike interrupts say nothing.
    pub fn interrupt(&mut self) {
        self.distance.interrupt();
        self.vertical.interrupt();
    }

    /// v, units^2.
    pub fn white(&self) -> f64 {
        let (differing, smooth) = (self.distance.white, self.second.value);
        let v = if smooth >= self.most {
            differing.value
        } else if differing.count > 5.0 * START {
            differing.value.min(smooth)
        } else {
            smooth
        };
        v.max(self.least)
    }

    /// Variance of the vertical part, field strengths squared.
    pub fn tilt(&self) -> f64 {
        self.white_vertical() + self.vertical.lasting.square
    }

    fn white_vertical(&self) -> f64 {
        self.vertical.white.value.max(LEAST_TILT_RAD.powi(2))
    }

    pub fn level(&self) -> Level {
        let (white, vertical) = (self.white(), self.white_vertical());
        Level {
            white,
            uneven: self.distance.lasting.square,
            kappa: self.distance.kappa(white, self.period_s),
            vertical: (vertical, self.vertical.kappa(vertical, self.period_s)),
        }
    }
}
