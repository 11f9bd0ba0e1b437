//! One `push`: a raw sample in, a [`Reading`] out. Checks the sample, gives it to the estimator, corrects it, and
//! forms the heading from the corrected field and the latest `up`.

use crate::calibration::Calibration;
use crate::config::{Config, ConfigError};
use crate::coverage::Coverage;
use crate::ellipsoid::EllipsoidFit;
use crate::estimator::windowed::{Windowed, WindowedState};
use crate::heading::{Heading, heading, heading_sigma_deg, true_heading_deg};
use crate::reading::{Reading, RejectReason, Status};
use crate::sample::{MagneticSample, RotationRateSample, UpSample};
use crate::snapshot::{Restored, SnapshotError, open, seal};
use nalgebra::{Matrix3, SVector, Vector3};
use serde::{Deserialize, Serialize};

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
///         assert!((corrected - field).norm() < 0.1);
///     }
/// }
/// assert!(compensator.calibration().is_some());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Compensator {
    config: Config,
    estimator: Windowed,
    inputs: Inputs,
}

/// The latest accepted event of each kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Inputs {
    magnetic: Option<MagneticSample>,
    /// How many equal magnetic samples came in a row before the latest.
    repeats: usize,
    rotation_rate: Option<RotationRateSample>,
    up: Option<UpSample>,
}

/// Everything a snapshot holds.
#[derive(Debug, Serialize, Deserialize)]
struct State {
    config: Config,
    inputs: Inputs,
    calibration: Option<Calibration>,
    windowed: WindowedState,
}

impl Compensator {
    /// A compensator for a config. Everything it will ever need is allocated here.
    ///
    /// # Errors
    /// [`ConfigError`] names the field that is out of range.
    pub fn new(config: Config) -> Result<Self, ConfigError> {
        config.validate()?;
        let estimator = Windowed::new(&config);
        Ok(Self { config, estimator, inputs: Inputs::default() })
    }

    /// The config it was made with.
    #[must_use]
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// A gyroscope event. Times must increase; other sensors' times do not matter.
    ///
    /// # Errors
    /// [`RejectReason`] when the event is not finite or not after the one before; nothing has changed then.
    pub fn push_rotation_rate(&mut self, sample: RotationRateSample) -> Result<(), RejectReason> {
        check_event(&sample.rate_rad_s, sample.time_ns, self.inputs.rotation_rate.map(|latest| latest.time_ns))?;
        self.inputs.rotation_rate = Some(sample);
        Ok(())
    }

    /// An accelerometer or gravity event. Times must increase; other sensors' times do not matter.
    ///
    /// # Errors
    /// [`RejectReason`] when the event is not finite or not after the one before; nothing has changed then.
    pub fn push_up(&mut self, sample: UpSample) -> Result<(), RejectReason> {
        check_event(&sample.up_m_s2, sample.time_ns, self.inputs.up.map(|latest| latest.time_ns))?;
        self.inputs.up = Some(sample);
        Ok(())
    }

    /// A raw magnetometer event. A sample that can't be used comes back with `Status::Rejected` and changes nothing.
    pub fn push(&mut self, sample: MagneticSample) -> Reading {
        if let Err(reason) = self.check(&sample) {
            return Reading {
                time_ns: sample.time_ns,
                field_ut: None,
                filtered_field_ut: None,
                total_field_ut: None,
                heading: None,
                sigma_t: None,
                window: self.estimator.window(),
                coverage: self.estimator.coverage().share(),
                status: Status::Rejected(reason),
            };
        }
        let same = self.inputs.magnetic.is_some_and(|latest| latest.field_ut == sample.field_ut);
        self.inputs.repeats = if same { self.inputs.repeats + 1 } else { 0 };
        self.inputs.magnetic = Some(sample);

        let step = self.estimator.push(&sample.field_ut);
        let field_ut = self.estimator.calibration().map(|calibration| calibration.correct(&sample.field_ut));
        let field_ut = field_ut.filter(|field| field.norm().is_finite());
        Reading {
            time_ns: sample.time_ns,
            field_ut,
            filtered_field_ut: None,
            total_field_ut: field_ut.map(|field| field.norm()),
            heading: field_ut.and_then(|field| self.heading(&field, sample.time_ns)),
            sigma_t: step.sigma_t,
            window: self.estimator.window(),
            coverage: self.estimator.coverage().share(),
            status: step.status,
        }
    }

    /// M, b and field strength in force, if any.
    #[must_use]
    pub fn calibration(&self) -> Option<&Calibration> {
        self.estimator.calibration()
    }

    /// The latest ellipsoid fit that was accepted, with its covariance.
    #[must_use]
    pub fn fit(&self) -> Option<&EllipsoidFit> {
        self.estimator.fit()
    }

    /// Which directions the window has seen, for guidance.
    #[must_use]
    pub fn coverage(&self) -> &Coverage {
        self.estimator.coverage()
    }

    /// Forgets everything but the config.
    pub fn reset(&mut self) {
        self.estimator = Windowed::new(&self.config);
        self.inputs = Inputs::default();
    }

    /// The whole state as JSON with a version and a checksum. A compensator with the same config that restores it
    /// gives bit-identical readings from there on.
    #[must_use]
    pub fn snapshot(&self) -> String {
        seal(&State {
            config: self.config.clone(),
            inputs: self.inputs,
            calibration: self.estimator.calibration().copied(),
            windowed: self.estimator.state(),
        })
    }

    /// Takes over a snapshot: everything when it was made with the same config, else its calibration alone, and the
    /// clock starts anew.
    ///
    /// # Errors
    /// [`SnapshotError`] when it is damaged or from a newer version; nothing has changed then.
    pub fn restore(&mut self, snapshot: &str) -> Result<Restored, SnapshotError> {
        let state: State = open(snapshot)?;
        if state.config == self.config {
            self.estimator = Windowed::from_state(&self.config, state.windowed).ok_or(SnapshotError::Damaged)?;
            self.inputs = state.inputs;
            return Ok(Restored::Everything);
        }
        let with_calibration = Config { initial: state.calibration.or(self.config.initial), ..self.config.clone() };
        self.estimator = Windowed::new(&with_calibration);
        self.inputs = Inputs::default();
        Ok(Restored::CalibrationOnly)
    }

    fn check(&self, sample: &MagneticSample) -> Result<(), RejectReason> {
        let limits = &self.config.sensor;
        let field = &sample.field_ut;
        if !field.iter().all(|v| v.is_finite()) {
            return Err(RejectReason::NotFinite);
        }
        let value_ut = field[field.iamax()];
        if let Some(rail_ut) = limits.rail_ut.filter(|rail| value_ut.abs() >= *rail) {
            return Err(RejectReason::Saturated { value_ut, rail_ut });
        }
        if value_ut.abs() > limits.range_ut {
            return Err(RejectReason::OutOfRange { value_ut, limit_ut: limits.range_ut });
        }
        let Some(latest) = self.inputs.magnetic else { return Ok(()) };
        if sample.time_ns <= latest.time_ns {
            return Err(RejectReason::TimeNotAfter { time_ns: sample.time_ns, latest_ns: latest.time_ns });
        }
        let gap_s = (i128::from(sample.time_ns) - i128::from(latest.time_ns)) as f64 * 1e-9;
        if gap_s > limits.max_gap_s {
            return Err(RejectReason::TimeJump { gap_s, limit_s: limits.max_gap_s });
        }
        let repeats = self.inputs.repeats + 1;
        if limits.stuck_samples > 0 && latest.field_ut == *field && repeats >= limits.stuck_samples {
            return Err(RejectReason::Stuck { repeats });
        }
        Ok(())
    }

    fn heading(&self, field: &Vector3<f64>, time_ns: i64) -> Option<Heading> {
        let config = &self.config.heading;
        let up = self.inputs.up.filter(|up| {
            let age_s = (i128::from(time_ns) - i128::from(up.time_ns)) as f64 * 1e-9;
            age_s.abs() <= config.max_up_age_s
        })?;
        let found = heading(field, &up.up_m_s2, config.axis, config.screen_rotation)?;
        let sigma = self.estimator.fit().and_then(|fit| {
            let covariance = corrected_covariance_ut2(fit, field, config.field_sigma_ut);
            heading_sigma_deg(field, &up.up_m_s2, &covariance, config.tilt_sigma_deg)
        });
        Some(Heading {
            heading_sigma_deg: sigma,
            true_heading_deg: config.declination_deg.map(|d| true_heading_deg(found.heading_deg, d)),
            ..found
        })
    }
}

/// Covariance of the corrected sample c = W (h_m - b), uT^2: of the parameters, dc = -W (dM c + db), of the noise
/// through W, and of what no calibration knows.
fn corrected_covariance_ut2(fit: &EllipsoidFit, c: &Vector3<f64>, field_sigma_ut: f64) -> Matrix3<f64> {
    let w = fit.calibration.soft_iron_inverse();
    let mut gradient = nalgebra::SMatrix::<f64, 3, 9>::zeros();
    for (row, other) in [(0, [0, 3, 4]), (1, [3, 1, 5]), (2, [4, 5, 2])] {
        gradient[(row, row)] = 1.0;
        for (column, place) in other.into_iter().enumerate() {
            gradient[(row, 3 + place)] = c[column];
        }
    }
    let gradient = w * gradient;
    let parameters = gradient * fit.covariance * gradient.transpose();
    parameters + w * w.transpose() * fit.residual_rms_ut.powi(2) + Matrix3::identity() * field_sigma_ut.powi(2)
}

fn check_event(value: &SVector<f64, 3>, time_ns: i64, latest_ns: Option<i64>) -> Result<(), RejectReason> {
    if !value.iter().all(|v| v.is_finite()) {
        return Err(RejectReason::NotFinite);
    }
    match latest_ns {
        Some(latest_ns) if time_ns <= latest_ns => Err(RejectReason::TimeNotAfter { time_ns, latest_ns }),
        _ => Ok(()),
    }
}
