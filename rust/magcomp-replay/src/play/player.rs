//! A compensator that is given the rows of a recording, in order.

use crate::error::RunError;
use magcomp::{
    Calibration, Compensator, Config, HeadedAxis, HeadingAid, HeadingSample, KeptCalibration, MagneticSample, Method,
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
    courses: Courses,
}

/// What became of a recording's headings from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Courses {
    /// Of what they are headings; none where they were not asked for.
    of: Option<HeadedAxis>,
    /// How many the recording has.
    pub all: usize,
    /// How many the compensator took.
    pub used: usize,
    /// Why it refused the latest.
    refused: Option<String>,
}

impl Courses {
    /// Those that were not used, and why, in a sentence.
    pub fn told(&self) -> Option<String> {
        let unused = self.all - self.used;
        if unused == 0 {
            return None;
        }
        let (all, it) = (self.all, "the headings from outside");
        Some(match (&self.of, &self.refused) {
            (None, _) => format!(
                "{it} ({all} in the recording) were not used: --course top, camera or vehicle says of what they are"
            ),
            (Some(HeadedAxis::Vehicle), None) => format!(
                "{unused} of {all} of {it} were not used: a vehicle's needs a calibration first, and how the device lies in the vehicle; --course camera \
                 if the camera looks ahead, or --course top"
            ),
            (Some(_), None) => format!(
                "{unused} of {all} of {it} were not used: they contradict what was known, or there was no gravity yet"
            ),
            (Some(_), Some(why)) => format!("{unused} of {all} of {it} were not used, the latest because {why}"),
        })
    }
}

impl Player {
    /// Before the first row.
    pub fn new(config: &Config, ignore: Ignore) -> Result<Self, RunError> {
        Ok(Self {
            compensator: Compensator::new(config.clone())?,
            ignore,
            course_of: None,
            courses: Courses::default(),
        })
    }

    /// One whose choices are not the usual ones.
    pub fn tuned(config: Config, method: Method, ignore: Ignore, tunings: Tunings) -> Result<Self, RunError> {
        let compensator = Compensator::tuned(Config { method, ..config }, tunings)?;
        Ok(Self { compensator, ignore, course_of: None, courses: Courses::default() })
    }

    /// The same, with the recording's courses as headings of `axis` from outside.
    pub fn aided_by_courses(self, axis: Option<HeadedAxis>) -> Self {
        let courses = Courses { of: axis, ..Courses::default() };
        Self { course_of: axis, courses, ..self }
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
        let mut waiting = 0;
        for Inertial { time_ns, rate_rad_s, up_m_s2, course } in row.inertial() {
            if let Some(rate_rad_s) = rate_rad_s.filter(|_| !self.ignore.gyroscope) {
                let _ = self.compensator.push_rotation_rate(RotationRateSample { time_ns, rate_rad_s });
            }
            if let Some(up_m_s2) = up_m_s2.filter(|_| !self.ignore.accelerometer) {
                let _ = self.compensator.push_up(UpSample { time_ns, up_m_s2 });
            }
            let Some(Course { heading_deg, sigma_deg }) = course else { continue };
            self.courses.all += 1;
            if let Some(axis) = self.course_of {
                let reference = NorthReference::True;
                let pushed =
                    self.compensator.push_heading(HeadingSample { time_ns, heading_deg, sigma_deg, reference, axis });
                waiting += usize::from(pushed.is_ok());
                self.courses.refused = pushed.err().map(|why| why.to_string()).or(self.courses.refused.take());
            }
        }
        let (compensator, time_ns) = (&mut self.compensator, row.time_ns);
        let started = (!cfg!(target_family = "wasm")).then(Instant::now);
        let reading = compensator.push(MagneticSample { time_ns, field_ut: row.field_ut });
        let push_ns = started.map_or(0, |started| started.elapsed().as_nanos() as u64);
        if waiting > 0 && matches!(compensator.heading_aid(), Some(HeadingAid::Used | HeadingAid::Leads)) {
            self.courses.used += waiting;
        }
        let sigma =
            compensator.covariance().map(|covariance| std::array::from_fn(|i| covariance[(i, i)].max(0.0).sqrt()));
        Step { reading, calibration: compensator.calibration(), sigma, push_ns }
    }

    /// What became of the headings from outside so far.
    pub fn courses(&self) -> &Courses {
        &self.courses
    }

    /// The compensator as it is after the latest row.
    pub fn compensator(&self) -> &Compensator {
        &self.compensator
    }
}

/// Plays a recording in memory, in order.
pub fn replay(recording: &Recording, config: &Config, ignore: Ignore) -> Result<Vec<Step>, RunError> {
    replay_with(recording, config, ignore, |_, _| ())
}

/// As [`replay`], with a look at the compensator after every row.
pub fn replay_with(
    recording: &Recording,
    config: &Config,
    ignore: Ignore,
    mut look: impl FnMut(usize, &Compensator),
) -> Result<Vec<Step>, RunError> {
    let mut player = Player::new(config, ignore)?;
    let steps = recording.rows.iter().enumerate().map(|(k, row)| {
        let step = player.play(row);
        look(k, &player.compensator);
        step
    });
    Ok(steps.collect())
}
