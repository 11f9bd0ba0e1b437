//! What samples miss their ellipsoid by: white noise of the sensor, and the unevenness of the place.
//!
//! White level v, per axis: half the mean square difference of neighbouring distances, or, where the motion is smooth, a
//! sixth of the mean square second difference of the raw samples, whichever is less. Clipped, so that spikes hardly count:
//!     v <- v + (min(x^2, 4 v) / 0.92 - v) / n
//! Unevenness lasts: distances summed over T = 2^j bins differ from one T to the next by more than white noise does
//! (Allan variance A_j, per sample). Of the largest,
//!     kappa = 1 + 2 max(0, max_j A_j / v - 2)
//! samples are worth one, blended with what is believed of places before anything was seen.

use super::tuning::Tuning;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Times over which distances are summed: 0.02 s times 2^j, up to 5.12 s.
const LEVELS: usize = 9;
const BIN_S: f64 = 0.02;
/// Larger values count as this many standard deviations; the mean of min(z^2, CLIP^2) of a normal z.
const CLIP: f64 = 2.0;
const CLIPPED_MEAN: f64 = 0.9205;
/// Samples that the value at the start is worth, and the memory (3 % of scatter).
const START: f64 = 20.0;
const MEMORY: f64 = 1000.0;
/// Seconds of sums of one length that are remembered.
const SUMS_S: f64 = 120.0;
const MOST_SUMS: f64 = 100.0;
/// Sums before they are believed rather than what places are like.
const KNOWN: f64 = 3.0;
/// The largest of seven mean squares exceeds the white level by chance up to this; unevenness lasts for longer than the sums.
const BY_CHANCE: f64 = 2.0;
const LASTS: f64 = 2.0;

/// What samples are believed to be like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Level {
    /// White variance of a sample, units^2.
    pub white: f64,
    /// Variance of the place's unevenness, units^2.
    pub uneven: f64,
    /// Samples that are worth one.
    pub kappa: f64,
    /// The same for the vertical part: variance (field strengths squared) and samples that are worth one.
    pub vertical: (f64, f64),
}

/// A clipped running mean square.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Mean {
    value: f64,
    count: f64,
}

impl Mean {
    fn add(&mut self, square: f64, share: f64) {
        self.count = (self.count + share).min(MEMORY);
        let square = square.min(CLIP * CLIP * self.value) / CLIPPED_MEAN;
        self.value += share * (square - self.value) / self.count;
    }
}

/// Sums of distances over one length of time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Scale {
    /// The sum and its samples that wait for the next.
    pending: Option<(f64, f64)>,
    /// Mean of half the squared difference of neighbouring sums, per sample.
    allan: f64,
    count: f64,
}

/// Sums of errors over dyadic lengths of time: what lasts differs from one sum to the next by more than white noise does.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Lasting {
    bin: (f64, f64),
    scales: [Scale; LEVELS],
}

impl Lasting {
    /// White noise of a variance, until told otherwise.
    fn new(variance: f64) -> Self {
        Self { bin: (0.0, 0.0), scales: [Scale { allan: variance, count: 1.0, pending: None }; LEVELS] }
    }

    fn add(&mut self, e: f64, period_s: f64) {
        self.bin.0 += e;
        self.bin.1 += 1.0;
        if self.bin.1 * period_s < 0.75 * BIN_S {
            return;
        }
        let mut sum = std::mem::take(&mut self.bin);
        for (j, scale) in self.scales.iter_mut().enumerate() {
            let Some(other) = scale.pending.take() else {
                scale.pending = Some(sum);
                break;
            };
            let samples = sum.1 + other.1;
            let most = (SUMS_S / (BIN_S * f64::from(2u32 << j))).min(MOST_SUMS);
            scale.count = (scale.count + 1.0).min(most);
            scale.allan += ((sum.0 - other.0).powi(2) / samples - scale.allan) / scale.count;
            sum = (sum.0 + other.0, samples);
        }
    }

    /// Sums that are not complete say nothing.
    fn interrupt(&mut self) {
        self.scales.iter_mut().for_each(|scale| scale.pending = None);
        self.bin = (0.0, 0.0);
    }

    /// Samples worth one: the most that any length of time shows, each as learned and, while it was seen too rarely, as
    /// `believed` before. What is learned of short times says nothing of long ones.
    fn kappa(&self, white: f64, believed: f64) -> f64 {
        let start = KNOWN * KNOWN;
        let of = |scale: &Scale| {
            let told = 1.0 + LASTS * (scale.allan / white - BY_CHANCE).max(0.0);
            let known = (scale.count - 1.0).powi(2);
            (start * believed.ln() + known * told.ln()) / (start + known)
        };
        self.scales.iter().map(of).fold(0.0, f64::max).exp()
    }
}

/// What the vertical is wrong by: accelerations of a hand, which last as long as a step. Learned as the rest is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct VerticalNoise {
    total: Mean,
    lasting: Lasting,
}

/// Tilt of a hand that moves before it is learned, radians, and how long it lasts, s; the least that is believed.
const TILT_RAD: f64 = 0.06;
const TILT_S: f64 = 1.0;
const LEAST_TILT_RAD: f64 = 0.02;

impl VerticalNoise {
    pub fn new() -> Self {
        let v = TILT_RAD * TILT_RAD;
        Self { total: Mean { value: v, count: START }, lasting: Lasting::new(v) }
    }

    /// What a sample's vertical part misses, in field strengths, and the variance of its prediction.
    pub fn miss(&mut self, e: f64, rho: f64, period_s: f64) {
        let v = self.total.value;
        self.total.add((e * e - rho).max(0.0), v / (v + rho));
        let most = 3.0 * v.sqrt();
        self.lasting.add(e.clamp(-most, most), period_s);
    }

    pub fn interrupt(&mut self) {
        self.lasting.interrupt();
    }

    /// Variance, and samples worth one.
    pub fn level(&self, period_s: f64) -> (f64, f64) {
        let v = self.total.value.max(LEAST_TILT_RAD * LEAST_TILT_RAD);
        let lasts = 1.0 + TILT_S / period_s;
        (v, self.lasting.kappa(v, lasts).max(lasts))
    }
}

/// The learned noise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Noise {
    innovation: Mean,
    second: Mean,
    total: Mean,
    latest: Option<f64>,
    raw: [Vector3<f64>; 2],
    seen: usize,
    lasting: Lasting,
    least: f64,
    most: f64,
    /// Unevenness before it is learned, units^2, times how long it lasts, s.
    uneven_s: f64,
    period_s: f64,
}

impl Noise {
    pub fn new(tuning: &Tuning, unit_ut: f64) -> Self {
        let square = |ut: f64| (ut / unit_ut).powi(2);
        let (v, uneven) = (square(tuning.noise_ut), square(tuning.uneven_ut));
        let mean = |value: f64| Mean { value, count: START };
        Self {
            innovation: mean(v),
            second: mean(v),
            total: mean(v + uneven),
            latest: None,
            raw: [Vector3::zeros(); 2],
            seen: 0,
            lasting: Lasting::new(v),
            least: square(tuning.noise_range_ut.0),
            most: square(tuning.noise_range_ut.1),
            uneven_s: uneven * tuning.uneven_s,
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
        let v = self.white();
        let share = v / (v + rho);
        self.total.add((e * e - rho).max(0.0), share);
        if let Some(latest) = self.latest {
            self.innovation.add(0.5 * (e - latest).powi(2), share);
        }
        self.latest = Some(e);
        if !lasting {
            return;
        }
        let most = 3.0 * self.total.value.sqrt();
        self.lasting.add(e.clamp(-most, most), self.period_s);
    }

    /// Sums that a change or a spike interrupts say nothing.
    pub fn interrupt(&mut self) {
        self.lasting.interrupt();
        self.latest = None;
    }

    /// v, units^2.
    pub fn white(&self) -> f64 {
        let (differing, smooth) = (self.innovation, self.second.value);
        let v = if smooth >= self.most {
            differing.value
        } else if differing.count > 5.0 * START {
            differing.value.min(smooth)
        } else {
            smooth
        };
        v.max(self.least)
    }

    pub fn level(&self, vertical: &VerticalNoise) -> Level {
        let white = self.white();
        let kappa = self.lasting.kappa(white, 1.0 + self.uneven_s / (white * self.period_s));
        Level {
            white,
            uneven: (self.total.value - 1.1 * white).max(0.0),
            kappa,
            vertical: vertical.level(self.period_s),
        }
    }
}
