//! What is stored of the stream: frames. A frame is the mean of neighbouring samples, with the noise that was believed of it.
//! Hypotheses are judged on the same stored frames, so that any of them can be worked out again from its beginning.

use crate::math::elementary::ln;
use crate::noise::{Lasting, Process};
use crate::room::Roomy;
use alloc::vec::Vec;
use core::f64::consts::LN_2;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::Vector3;

/// See the module.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Frame {
    pub time_ns: i64,
    /// Mean of the samples, units.
    pub u: Vector3<f64>,
    /// The vertical, a unit vector, where gravity is known.
    pub up: Option<Vector3<f64>>,
    pub count: f64,
    /// Time since the frame before, and how much of it the device moved, s.
    pub seconds: f64,
    pub moved_s: f64,
    /// Least variance of the mean: what a stay of its length tells, units^2.
    pub stay: f64,
    /// Variance of the mean, units^2.
    pub white: f64,
    /// What lasts since the frame before of the place's unevenness.
    pub uneven: Lasting,
    /// White variance of the vertical part; what lasts of it.
    pub tilt_white: f64,
    pub tilt: Lasting,
}

/// What is believed of the noise, in units and radians.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Noise {
    /// White variance of a sample, units^2.
    pub white: f64,
    /// Unevenness of the place: standard deviation, and how long of motion it lasts, s.
    pub uneven: Process,
    /// White variance of the vertical part.
    pub tilt_white: f64,
    /// Tilt that lasts: standard deviation, and how long, s.
    pub tilt: Process,
}

impl Noise {
    /// Whether the frames would be judged otherwise with another.
    pub fn differs(&self, other: &Self) -> bool {
        let far = |a: f64, b: f64| ln(a / b).abs() > MOVED;
        far(self.white.sqrt(), other.white.sqrt())
            || far(self.uneven.size, other.uneven.size)
            || far(self.tilt_white.sqrt(), other.tilt_white.sqrt())
            || far(self.tilt.size, other.tilt.size)
    }
}

impl Frame {
    pub fn believe(&mut self, noise: &Noise) {
        self.white = (noise.white / self.count).max(self.stay);
        self.uneven = noise.uneven.over(self.moved_s);
        self.tilt_white = noise.tilt_white;
        self.tilt = noise.tilt.over(self.seconds);
    }
}

/// Choice: logarithm by which a standard deviation of the noise may differ from the believed one: a variance by a factor of 2.
const MOVED: f64 = 0.5 * LN_2;

/// Choice: frames that are kept, some 20 s of motion.
pub(super) const FRAMES: u64 = 256;

/// The latest frames by their number.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Frames {
    pub ring: Roomy<Vec<Frame>>,
    pub next: u64,
}

impl Frames {
    /// Takes all memory.
    pub fn new() -> Self {
        Self { ring: Roomy::<Vec<_>>::new(FRAMES as usize), next: 0 }
    }

    pub fn clear(&mut self) {
        self.ring.clear();
        self.next = 0;
    }

    pub fn push(&mut self, frame: Frame) {
        if self.next < FRAMES {
            self.ring.push(frame);
        } else {
            self.ring[(self.next % FRAMES) as usize] = frame;
        }
        self.next += 1;
    }

    pub fn at(&self, number: u64) -> &Frame {
        &self.ring[(number % FRAMES) as usize]
    }
}
