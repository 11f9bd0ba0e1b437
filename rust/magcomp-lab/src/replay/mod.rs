//! A recording through the compensator, row by row.

mod figures;
mod judge;
mod legs;
mod output;
mod view;

pub use figures::figures;
pub use judge::{
    Declared, Disturbance, HeadingError, Judgement, Vectors, heading_course, judge, judge_vectors, usual_part,
};
pub use legs::{LegJudgement, Waypoint, judge_legs, read_waypoints};
pub use output::write;
pub use view::table;

use crate::error::LabError;
use crate::progress;
use crate::recording::Recording;
use magcomp::{Calibration, Compensator, Config, MagneticSample, Reading, RotationRateSample, UpSample};
use std::time::Instant;

/// Rows from one look at the progress bar to the next.
const BAR_STRIDE: usize = 500;

/// Sensors of the recording that are left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ignore {
    /// Without rotation rates.
    pub gyroscope: bool,
    /// Without up.
    pub accelerometer: bool,
}

/// What came out for one row.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// The reading.
    pub reading: Reading,
    /// The calibration in force after the sample.
    pub calibration: Option<Calibration>,
    /// Time spent in `push`, nanoseconds.
    pub push_ns: u64,
}

/// Plays every row of a recording, in order. Events of the other sensors that the core refuses (NaN, for instance) are
/// left out, as an app would.
///
/// # Errors
/// [`LabError::Config`] when the config is refused.
pub fn replay(recording: &Recording, config: &Config, ignore: Ignore) -> Result<Vec<Step>, LabError> {
    let bar = progress::bar(recording.rows.len(), "replay");
    let steps = replay_with(recording, config, ignore, |k, _| {
        if k % BAR_STRIDE == 0 {
            bar.set_position(k as u64);
        }
    });
    bar.finish_and_clear();
    steps
}

/// As [`replay`], with a look at the compensator after every row instead of a progress bar.
///
/// # Errors
/// [`LabError::Config`] when the config is refused.
pub fn replay_with(
    recording: &Recording,
    config: &Config,
    ignore: Ignore,
    mut look: impl FnMut(usize, &Compensator),
) -> Result<Vec<Step>, LabError> {
    let mut compensator = Compensator::new(config.clone())?;
    let steps = recording.rows.iter().enumerate().map(|(k, row)| {
        let time_ns = row.time_ns;
        if let Some(rate_rad_s) = row.rate_rad_s.filter(|_| !ignore.gyroscope) {
            let _ = compensator.push_rotation_rate(RotationRateSample { time_ns, rate_rad_s });
        }
        if let Some(up_m_s2) = row.up_m_s2.filter(|_| !ignore.accelerometer) {
            let _ = compensator.push_up(UpSample { time_ns, up_m_s2 });
        }
        let started = Instant::now();
        let reading = compensator.push(MagneticSample { time_ns, field_ut: row.field_ut });
        let push_ns = started.elapsed().as_nanos() as u64;
        look(k, &compensator);
        Step { reading, calibration: compensator.calibration(), push_ns }
    });
    Ok(steps.collect())
}
