//! What is known of a sample before any hypothesis sees it: the sample itself, and by what it is judged.

use super::noise::Level;
use super::tuning::Tuning;
use nalgebra::Vector3;

/// A mean of neighbouring samples, as hypotheses take it.
pub(super) struct Sample {
    pub u: Vector3<f64>,
    pub raw_ut: Vector3<f64>,
    /// The vertical, a unit vector, where gravity is known.
    pub up: Option<Vector3<f64>>,
    pub count: usize,
    /// It tells nothing that the device has not been told at this place already.
    pub stale: bool,
}

/// What samples are judged by.
pub(super) struct Setting<'a> {
    pub tuning: &'a Tuning,
    /// uT that coordinates count in.
    pub unit_ut: f64,
    /// |h|, uT, where it was given.
    pub strength_ut: Option<f64>,
    /// Time between samples, s.
    pub period_s: f64,
    pub level: Level,
    /// Half the square of standard deviations from which a sample is left out, and what that costs.
    pub half_square: f64,
    pub price: f64,
}

impl<'a> Setting<'a> {
    /// A sample is left out where a spike is likelier: half z^2 > -ln(density of spikes / density of noise at 0).
    pub fn new(tuning: &'a Tuning, unit_ut: f64, strength_ut: Option<f64>, period_s: f64, level: Level) -> Self {
        let noise_ut = (level.white * std::f64::consts::TAU).sqrt() * unit_ut;
        let half_square = -(tuning.spikes_per_ut * noise_ut).ln();
        let price = half_square / level.kappa.sqrt();
        Self { tuning, unit_ut, strength_ut, period_s, level, half_square, price }
    }
}
