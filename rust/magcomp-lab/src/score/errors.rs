//! The errors of every sample of a run.

use crate::simulate::{Simulation, Truth};
use magcomp::Status;
use magcomp::nalgebra::Vector3;
use magcomp_replay::{Step, off_deg};

/// Beyond so many sigmas a heading that is `Tracking` is a lie.
const LIE_SIGMAS: f64 = 3.0;

/// Sine of the x axis' elevation above which a heading means little.
const STEEP: f64 = 0.65;

/// What a status comes to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// `Tracking`.
    Tracking,
    /// `Held`.
    Held,
    /// `Suspect` or `Disturbed`.
    Alarm,
    /// Any other.
    #[default]
    Other,
}

impl Mode {
    /// Of a status.
    pub(crate) fn of(status: &Status) -> Self {
        match status {
            Status::Tracking => Self::Tracking,
            Status::Held(_) => Self::Held,
            Status::Suspect { .. } | Status::Disturbed { .. } => Self::Alarm,
            _ => Self::Other,
        }
    }
}

/// A sample's errors; none where there is no answer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// s.
    pub time_s: f64,
    /// The status.
    pub mode: Mode,
    /// A heading is judged.
    pub is_level: bool,
    /// Of the heading, degrees, with its sign.
    pub heading_deg: Option<f64>,
    /// The sigma published with it, degrees; where the device is too steep too.
    pub sigma_deg: Option<f64>,
    /// Of f, degrees.
    pub carried_deg: Option<f64>,
    /// Of c, degrees.
    pub corrected_deg: Option<f64>,
    /// Of the calibration, degrees.
    pub calibration_deg: Option<f64>,
    /// Of b, uT.
    pub hard_iron_ut: Option<f64>,
}

impl Sample {
    fn of(truth: &Truth, step: &Step, earth_ut: &Vector3<f64>, has_up: bool) -> Self {
        let (reading, to_device) = (&step.reading, truth.attitude.inverse());
        let angle = |found: Vector3<f64>, field: &Vector3<f64>| found.angle(field).to_degrees();
        let up = to_device * Vector3::z();
        let is_level = has_up && up.x.abs() < STEEP;
        // the horizontal direction between top edge and camera
        let ahead = truth.attitude * up.cross(&Vector3::x());
        let true_deg = ahead.x.atan2(ahead.y).to_degrees();
        let heading_deg = reading.heading.map(|found| off_deg(found.heading_deg, true_deg));
        Self {
            time_s: reading.time_ns as f64 / 1e9,
            mode: Mode::of(&reading.status),
            is_level,
            heading_deg: heading_deg.filter(|_| is_level),
            sigma_deg: reading.heading.and_then(|found| found.heading_sigma_deg).filter(|sigma| *sigma > 0.0),
            carried_deg: reading.filtered_field_ut.map(|f| angle(f, &(to_device * earth_ut))),
            corrected_deg: reading.field_ut.map(|c| angle(c, &truth.field_ut)),
            calibration_deg: step
                .calibration
                .filter(|_| reading.field_ut.is_some())
                .map(|known| angle(known.correct(&truth.clean_ut), &truth.measured_ut)),
            hard_iron_ut: step.calibration.map(|known| (known.hard_iron_ut() - truth.hard_iron_ut).norm()),
        }
    }

    /// Size of the heading's error over its sigma.
    pub fn sigmas(&self) -> Option<f64> {
        self.heading_deg.zip(self.sigma_deg).map(|(error, sigma)| error.abs() / sigma)
    }

    /// The size of the heading's error where the sample is a lie.
    pub(super) fn lie_deg(&self) -> Option<f64> {
        let is_lie = self.mode == Mode::Tracking && self.sigmas().is_some_and(|sigmas| sigmas > LIE_SIGMAS);
        self.heading_deg.filter(|_| is_lie).map(f64::abs)
    }

    /// The error of f, or of the calibration in a run without f.
    pub(super) fn main(&self, is_carried: bool) -> Option<f64> {
        if is_carried { self.carried_deg } else { self.calibration_deg }
    }
}

/// The errors of a run; `steps` are those of the simulation's samples.
pub fn samples(simulation: &Simulation, steps: &[Step]) -> Vec<Sample> {
    let pairs = simulation.truth.iter().zip(steps);
    let has_up = !simulation.ups.is_empty();
    pairs.map(|(truth, step)| Sample::of(truth, step, &simulation.earth_ut, has_up)).collect()
}
