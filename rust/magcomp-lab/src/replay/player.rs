//! A compensator that is given the rows of a recording, in order.

use crate::error::LabError;
use magcomp::{
    Calibration, Compensator, Config, HeadedAxis, HeadingSample, KeptCalibration, MagneticSample, Method,
    NorthReference, Reading, RotationRateSample, Tunings, UpSample,
};
use magcomp_recordings::recording::{Course, Inertial, Recording, Row};
use std::time::Instant;

/// Sensors of the recording that are left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ignore {
    /// Without rotation rates.
    pub gyroscope: bool,
    /// Without up.
    pub accelerometer: bool,
}

/// The compensator's step for one row.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// The reading.
    pub reading: Reading,
    /// The calibration in force after the sample.
    pub calibration: Option<Calibration>,
    /// Its standard deviations in the order of `Compensator::covariance`: b (uT), M_xx M_yy M_zz M_xy M_xz M_yz.
    pub sigma: Option<[f64; 9]>,
    /// Time spent in `push`, nanoseconds; 0 where there is no clock, in a browser.
    pub push_ns: u64,
}

/// A compensator that is given the rows of a recording. Events of the other sensors that the core refuses (NaN, for instance)
/// are left out, as an app would.
#[derive(Debug)]
pub struct Player {
    compensator: Compensator,
    ignore: Ignore,
    course_of: Option<HeadedAxis>,
}

impl Player {
    /// Before the first row.
    pub fn new(config: &Config, ignore: Ignore) -> Result<Self, LabError> {
        Ok(Self { compensator: Compensator::new(config.clone())?, ignore, course_of: None })
    }

    /// One whose choices are not the usual ones.
    pub fn tuned(config: Config, method: Method, ignore: Ignore, tunings: Tunings) -> Result<Self, LabError> {
        let compensator = Compensator::tuned(Config { method, ..config }, tunings)?;
        Ok(Self { compensator, ignore, course_of: None })
    }

    /// The same, with the recording's courses as headings of `axis` from outside.
    pub fn aided_by_courses(self, axis: Option<HeadedAxis>) -> Self {
        Self { course_of: axis, ..self }
    }

    /// The same, with what an earlier launch kept in force; the time of this one in seconds since 1970.
    pub fn adopting(mut self, kept: Option<(KeptCalibration, i64)>) -> Self {
        if let Some((kept, unix_time_s)) = kept {
            self.compensator.adopt(&kept, Some(unix_time_s));
        }
        self
    }

    /// Plays the next row.
    pub fn play(&mut self, row: &Row) -> Step {
        for Inertial { time_ns, rate_rad_s, up_m_s2, course } in row.inertial() {
            if let Some(rate_rad_s) = rate_rad_s.filter(|_| !self.ignore.gyroscope) {
                let _ = self.compensator.push_rotation_rate(RotationRateSample { time_ns, rate_rad_s });
            }
            if let Some(up_m_s2) = up_m_s2.filter(|_| !self.ignore.accelerometer) {
                let _ = self.compensator.push_up(UpSample { time_ns, up_m_s2 });
            }
            if let (Some(axis), Some(Course { heading_deg, sigma_deg })) = (self.course_of, course) {
                let reference = NorthReference::True;
                let _ =
                    self.compensator.push_heading(HeadingSample { time_ns, heading_deg, sigma_deg, reference, axis });
            }
        }
        let (compensator, time_ns) = (&mut self.compensator, row.time_ns);
        let started = (!cfg!(target_family = "wasm")).then(Instant::now);
        let reading = compensator.push(MagneticSample { time_ns, field_ut: row.field_ut });
        let push_ns = started.map_or(0, |started| started.elapsed().as_nanos() as u64);
        let sigma =
            compensator.covariance().map(|covariance| std::array::from_fn(|i| covariance[(i, i)].max(0.0).sqrt()));
        Step { reading, calibration: compensator.calibration(), sigma, push_ns }
    }

    /// The compensator as it is after the latest row.
    pub fn compensator(&self) -> &Compensator {
        &self.compensator
    }
}

/// Plays a recording in memory, in order.
pub fn replay(recording: &Recording, config: &Config, ignore: Ignore) -> Result<Vec<Step>, LabError> {
    replay_with(recording, config, ignore, |_, _| ())
}

/// As [`replay`], with a look at the compensator after every row.
pub fn replay_with(
    recording: &Recording,
    config: &Config,
    ignore: Ignore,
    mut look: impl FnMut(usize, &Compensator),
) -> Result<Vec<Step>, LabError> {
    let mut player = Player::new(config, ignore)?;
    let steps = recording.rows.iter().enumerate().map(|(k, row)| {
        let step = player.play(row);
        look(k, &player.compensator);
        step
    });
    Ok(steps.collect())
}
