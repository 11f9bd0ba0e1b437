//! One `push`: a raw sample in, a [`Reading`] out. Checks the sample, gives it to the estimator, corrects it, and
//! forms the heading from the corrected field and the latest `up`. One file each: `check` (what a sample may be), `keep` (snapshots).

mod check;
mod keep;

use crate::answer::Answer;
use crate::calibration::Calibration;
use crate::config::{Config, ConfigError, Method, validate_heading};
use crate::coverage::Coverage;
use crate::estimator::adaptive::Adaptive;
use crate::estimator::aided::{Aided, AidedConfig, calibration_covariance};
use crate::estimator::paper::Windowed;
use crate::heading::{Heading, HeadingConfig, heading, heading_sigma_deg, true_heading_deg};
use crate::quadric::EllipsoidFit;
use crate::reading::{Event, Reading, SensorMode, Status};
use crate::sample::{MagneticSample, RotationRateSample, UpSample};
use crate::sensing::pairing::{EventRejection, InertialPairing, PairedInertial};
use crate::sensing::tilt::Tilt;
use crate::snapshot::{LARGEST_COUNT, checked};
use nalgebra::{Matrix3, SMatrix, Vector3};
use serde::{Deserialize, Serialize};

/// Without a rotation for so long the magnetometer goes on alone, ns: long enough for a hiccup of the system.
const GYROSCOPE_GONE_NS: i64 = 1_000_000_000;
/// What no calibration knows, uT per axis: the field of rooms is not uniform. Measured against optical orientation references
/// in two laboratories.
const UNEVEN_UT: f64 = 1.3;

/// Frees a magnetometer from the disturbance its phone carries, sample by sample.
///
/// No clock, no thread, no allocation in `push`. It never panics and never returns NaN.
///
/// ```
/// use magcomp::nalgebra::Vector3;
/// use magcomp::{Compensator, Config, MagneticSample, Status, UpSample};
///
/// let mut compensator = Compensator::new(Config::default())?;
/// for k in 0..500_i64 {
///     let time_ns = k * 10_000_000;
///     // a device turned about, 50 uT around an offset of (120, -80, 300) uT
///     let (a, b) = (k as f64 * 0.11, k as f64 * 0.031);
///     let field = Vector3::new(a.cos() * b.cos(), a.sin() * b.cos(), b.sin()) * 50.0;
///     compensator.push_up(UpSample { time_ns, up_m_s2: Vector3::new(0.0, 0.0, 9.81) })?;
///     let reading = compensator.push(MagneticSample { time_ns, field_ut: field + Vector3::new(120.0, -80.0, 300.0) });
///     if let (Status::Tracking, Some(corrected)) = (reading.status, reading.field_ut) {
///         // first answers allow for an uneven room
///         assert!((corrected - field).norm() < 5.0);
///     }
/// }
/// assert!(compensator.calibration().is_some());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Compensator {
    config: Config,
    pairing: InertialPairing,
    aided: Aided,
    adaptive: Box<Adaptive>,
    windowed: Windowed,
    inputs: Inputs,
}

/// What the checks of the next sample look at, and which estimator answers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(remote = "Self")]
struct Inputs {
    latest: Option<MagneticSample>,
    /// How many equal samples came in a row before the latest.
    repeats: usize,
    /// Samples in a row that were rejected for their time but follow one another, and the time of the latest, ns. They are no
    /// part of a snapshot: what is rejected changes nothing else.
    #[serde(skip)]
    astray: u32,
    #[serde(skip)]
    astray_ns: i64,
    /// Time of the latest sample with a rotation, ns: the gyroscope is there.
    rotated_ns: Option<i64>,
    /// The aided estimator answered the latest sample, not one with the magnetometer alone.
    aided: bool,
    mode: SensorMode,
    event: Option<Event>,
    tilt: Tilt,
}

/// Covariance of what no calibration knows, uT^2.
fn uneven_ut2() -> Matrix3<f64> {
    Matrix3::identity() * UNEVEN_UT.powi(2)
}

checked!(Inputs, |it| it.repeats as u64 <= LARGEST_COUNT);

impl Compensator {
    /// A compensator for a config. Everything it will ever need is allocated here.
    ///
    /// # Errors
    /// [`ConfigError`] names the field that is out of range.
    pub fn new(config: Config) -> Result<Self, ConfigError> {
        config.validate()?;
        Ok(Self {
            pairing: InertialPairing::new(),
            aided: Aided::new(AidedConfig::default(), config.field_strength_ut),
            adaptive: Box::new(Adaptive::new(config.field_strength_ut, config.initial)),
            windowed: Self::windowed(&config),
            inputs: Inputs::default(),
            config,
        })
    }

    /// The paper's estimator for a config.
    fn windowed(config: &Config) -> Windowed {
        Windowed::new(config.windowed, config.method == Method::Constant, config.field_strength_ut, config.initial)
    }

    /// The config it was made with, and the heading settings that were set since.
    #[must_use]
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// From now on headings are reported like this, for instance when the screen was turned. Nothing else changes.
    ///
    /// # Errors
    /// [`ConfigError`] names the field that is out of range; nothing has changed then.
    pub fn set_heading(&mut self, heading: HeadingConfig) -> Result<(), ConfigError> {
        validate_heading(&heading)?;
        self.config.heading = heading;
        Ok(())
    }

    /// From now on this calibration is in force, until something better is learned: for instance one the operating
    /// system reports. The stream goes on. Every [`Calibration`] can be adopted: its ranges were checked when it was made.
    pub fn adopt(&mut self, calibration: Calibration) {
        self.windowed.adopt(calibration);
        self.aided.begin_from(&calibration);
        *self.adaptive = Adaptive::new(self.config.field_strength_ut, Some(calibration));
        // it does not know yet where the field points: the next sample goes in as one after a pause
        self.inputs.aided = false;
    }

    /// A gyroscope event, at its own rate: before the magnetometer sample that follows it in time, or a little late.
    ///
    /// # Errors
    /// [`EventRejection`] says why it was not taken; nothing has changed then.
    pub fn push_rotation_rate(&mut self, sample: RotationRateSample) -> Result<(), EventRejection> {
        self.pairing.push_rotation_rate(sample.time_ns, sample.rate_rad_s)
    }

    /// An accelerometer or gravity event, at its own rate: before the magnetometer sample that follows it in time.
    ///
    /// # Errors
    /// [`EventRejection`] says why it was not taken; nothing has changed then.
    pub fn push_up(&mut self, sample: UpSample) -> Result<(), EventRejection> {
        self.pairing.push_up(sample.time_ns, sample.up_m_s2)
    }

    /// A raw magnetometer event. A sample that can't be used comes back with `Status::Rejected` and changes nothing; but 50
    /// in a row whose time follows that of one another, and not that of the latest, are from another clock: the calibration
    /// stays then, and all else begins anew. How many of them there have been is no part of a snapshot.
    pub fn push(&mut self, sample: MagneticSample) -> Reading {
        if let Err(reason) = self.check(&sample)
            && !self.begins_another_clock(sample.time_ns, reason)
        {
            return self.reading(sample.time_ns, Answer::none(self.inputs.mode, Status::Rejected(reason)));
        }
        (self.inputs.astray, self.inputs.astray_ns) = (0, 0);
        let same = self.inputs.latest.is_some_and(|latest| latest.field_ut == sample.field_ut);
        let previous_ns = self.inputs.latest.map(|latest| latest.time_ns);
        self.inputs.repeats = if same { self.inputs.repeats + 1 } else { 0 };
        self.inputs.latest = Some(sample);
        let paired = self.pairing.pair(sample.time_ns);
        if paired.rotation.is_some() {
            self.inputs.rotated_ns = Some(sample.time_ns);
        }
        if let Some(up) = paired.up_m_s2 {
            self.inputs.tilt.step(sample.time_ns, up.norm());
        }
        let aided = match self.config.method {
            Method::Aided => true,
            // a pause of all sensors is no loss of the gyroscope
            Method::Auto => self
                .inputs
                .rotated_ns
                .is_some_and(|at| sample.time_ns.saturating_sub(at) <= GYROSCOPE_GONE_NS || Some(at) == previous_ns),
            Method::Adaptive | Method::Windowed | Method::Constant => false,
        };
        let answer = match self.config.method {
            _ if aided => self.aided_answer(&sample, &paired),
            Method::Windowed | Method::Constant => self.windowed_answer(&sample, &paired),
            _ => self.adaptive_answer(&sample, &paired),
        };
        self.inputs.mode = answer.mode;
        self.inputs.event = answer.event.or(self.inputs.event);
        self.reading(sample.time_ns, answer)
    }

    fn aided_answer(&mut self, sample: &MagneticSample, paired: &PairedInertial) -> Answer {
        let output = if self.inputs.aided {
            self.aided.push(sample.time_ns, sample.field_ut, paired)
        } else {
            self.inputs.aided = true;
            let found = self.adaptive.calibration().or(self.windowed.fit().map(|fit| fit.calibration));
            if let Some(calibration) =
                found.or(self.windowed.calibration().filter(|_| self.aided.calibration().is_none()))
            {
                self.aided.begin_from(&calibration);
            }
            // how the device turned while the magnetometer was alone is not known
            let unknown = PairedInertial { rotation: None, ..*paired };
            self.aided.push(sample.time_ns, sample.field_ut, &unknown)
        };
        let (bias_rad_s, scale) = self.aided.gyroscope();
        self.pairing.assume(bias_rad_s, scale);
        let known = if self.windowed.wants_calibration() { self.aided.calibration() } else { None };
        self.windowed.note(&sample.field_ut, known);
        Answer {
            field_ut: output.corrected_ut,
            field_covariance_ut2: output.corrected_ut.map(|_| output.corrected_covariance_ut2),
            filtered_field_ut: output.filtered_ut,
            filtered_covariance_ut2: output.filtered_ut.map(|_| output.filtered_covariance_ut2),
            up: output.up,
            tilt_rad2: output.tilt_rad2,
            sigma_t: None,
            direction_sigma_deg: None,
            worst_sigma_deg: None,
            model_order: None,
            mode: output.mode,
            event: output.event,
            status: output.status,
        }
    }

    fn adaptive_answer(&mut self, sample: &MagneticSample, paired: &PairedInertial) -> Answer {
        if self.inputs.aided {
            self.inputs.aided = false;
            *self.adaptive = Adaptive::new(self.config.field_strength_ut, self.aided.calibration());
        }
        self.adaptive.level(paired.up_m_s2);
        let output = self.adaptive.push(sample.time_ns, &sample.field_ut);
        let wanted = self.windowed.wants_calibration();
        self.windowed.note(&sample.field_ut, if wanted { self.adaptive.calibration() } else { None });
        if wanted {
            self.windowed.measure();
        }
        Answer {
            field_ut: output.corrected_ut.map(|(field, _)| field),
            field_covariance_ut2: output.corrected_ut.map(|(_, covariance)| covariance + uneven_ut2()),
            up: paired.up_m_s2,
            sigma_t: self.windowed.sigma_t(),
            direction_sigma_deg: output.direction_sigma_deg,
            worst_sigma_deg: output.worst_sigma_deg,
            model_order: output.corrected_ut.map(|_| output.order),
            event: output.event,
            ..Answer::none(
                if paired.up_m_s2.is_some() { SensorMode::GravityOnly } else { SensorMode::MagnetometerOnly },
                output.status,
            )
        }
    }

    fn windowed_answer(&mut self, sample: &MagneticSample, paired: &PairedInertial) -> Answer {
        if self.inputs.aided {
            self.inputs.aided = false;
            if let Some(calibration) = self.aided.calibration() {
                self.windowed.adopt(calibration);
            }
        }
        let step = self.windowed.push(sample.time_ns, &sample.field_ut);
        let field_ut = self.windowed.calibration().map(|calibration| calibration.correct(&sample.field_ut));
        let field_ut = field_ut.filter(|field| field.norm().is_finite());
        let covariance = self.windowed.fit().zip(field_ut).map(|(fit, field)| {
            let w = fit.calibration.soft_iron_inverse();
            let noise = w * w.transpose() * fit.residual_rms_ut.powi(2);
            calibration_covariance(&fit.covariance, w, &field) + noise
        });
        Answer {
            field_ut,
            field_covariance_ut2: covariance.map(|covariance| covariance + uneven_ut2()),
            up: paired.up_m_s2,
            sigma_t: step.sigma_t,
            direction_sigma_deg: self.windowed.fit().map(|fit| fit.direction_sigma_deg),
            ..Answer::none(
                if paired.up_m_s2.is_some() { SensorMode::GravityOnly } else { SensorMode::MagnetometerOnly },
                step.status,
            )
        }
    }

    fn reading(&self, time_ns: i64, answer: Answer) -> Reading {
        let pointing = answer.filtered_field_ut.or(answer.field_ut);
        let covariance = answer.filtered_covariance_ut2.or(answer.field_covariance_ut2);
        Reading {
            time_ns,
            field_ut: answer.field_ut,
            field_sigma_ut: answer.field_covariance_ut2.map(|covariance| (covariance.trace().max(0.0) / 3.0).sqrt()),
            filtered_field_ut: answer.filtered_field_ut,
            total_field_ut: answer.field_ut.map(|field| field.norm()),
            heading: (pointing.zip(answer.up))
                .and_then(|(field, up)| self.heading(&field, &up, covariance.as_ref(), answer.tilt_rad2)),
            sigma_t: answer.sigma_t,
            direction_sigma_deg: answer.direction_sigma_deg,
            worst_sigma_deg: answer.worst_sigma_deg,
            model_order: answer.model_order,
            window: if self.is_adaptive() { self.adaptive.window() } else { self.windowed.window() },
            coverage: self.windowed.coverage().share(),
            mode: answer.mode,
            event: self.inputs.event,
            status: answer.status,
        }
    }

    fn heading(
        &self,
        field: &Vector3<f64>,
        up: &Vector3<f64>,
        covariance: Option<&Matrix3<f64>>,
        tilt_rad2: Option<f64>,
    ) -> Option<Heading> {
        let config = &self.config.heading;
        let found = heading(field, up, config.axis, config.screen_rotation)?;
        let tilt_sigma_deg = match tilt_rad2 {
            Some(variance) => config.tilt_sigma_deg.hypot(variance.sqrt().to_degrees()),
            None => self.inputs.tilt.sigma_deg(config.tilt_sigma_deg),
        };
        Some(Heading {
            heading_sigma_deg: covariance.and_then(|covariance| {
                heading_sigma_deg(field, up, config.axis, config.screen_rotation, covariance, tilt_sigma_deg)
            }),
            true_heading_deg: config.declination_deg.map(|d| true_heading_deg(found.heading_deg, d)),
            ..found
        })
    }

    /// M, b and field strength in force, if any.
    #[must_use]
    pub fn calibration(&self) -> Option<Calibration> {
        match self.is_adaptive() {
            true => self.adaptive.calibration(),
            false if self.inputs.aided => self.aided.calibration(),
            false => self.windowed.calibration(),
        }
    }

    /// Whether the adaptive estimator answers.
    fn is_adaptive(&self) -> bool {
        !self.inputs.aided && matches!(self.config.method, Method::Adaptive | Method::Auto)
    }

    /// Covariance of [b_x b_y b_z (uT), m_xx m_yy m_zz m_xy m_xz m_yz (dimensionless)] in force, if known.
    #[must_use]
    pub fn covariance(&self) -> Option<SMatrix<f64, 9, 9>> {
        match self.is_adaptive() {
            true => self.adaptive.covariance(),
            false if self.inputs.aided => self.aided.covariance(),
            false => self.windowed.fit().map(|fit| fit.covariance),
        }
    }

    /// The latest ellipsoid fit that was accepted. None for the aided and the adaptive method, which make none.
    #[must_use]
    pub fn fit(&self) -> Option<&EllipsoidFit> {
        self.windowed.fit()
    }

    /// Which directions the window has seen, for guidance.
    #[must_use]
    pub fn coverage(&self) -> &Coverage {
        self.windowed.coverage()
    }

    /// Forgets everything but the config.
    pub fn reset(&mut self) {
        let Config { field_strength_ut, initial, .. } = self.config;
        self.pairing = InertialPairing::new();
        self.aided = Aided::new(AidedConfig::default(), field_strength_ut);
        *self.adaptive = Adaptive::new(field_strength_ut, initial);
        self.windowed.restart(initial);
        self.inputs = Inputs::default();
    }
}
