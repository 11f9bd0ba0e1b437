//! The compensator as it crosses the border: one mutex around one core object, and what belongs to this platform
//! rather than to the method: the operating system's own hard-iron estimate, and a heading frame that may change.

use crate::config::Config;
use crate::error::MagcompError;
use crate::guarded::{Guarded, caught};
use crate::record::{
    Calibration, Coverage, Fit, HeadingFrame, MagneticSample, Reading, RotationRateSample, UpSample, heading_in,
};
use magcomp::nalgebra::{Matrix3, Vector3};
use std::sync::{Arc, OnceLock};

/// Frees a magnetometer from the disturbance its phone carries, sample by sample. Any thread may call it.
#[derive(uniffi::Object)]
pub struct Compensator {
    config: magcomp::Config,
    use_reported_hard_iron: bool,
    running: Guarded<Running>,
    handle: OnceLock<i64>,
}

/// What was taken over from a snapshot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
pub enum Restored {
    /// Everything: readings go on as if nothing had happened.
    Everything,
    /// The snapshot was made with another config: its calibration was taken over, the rest starts anew.
    CalibrationOnly,
}

struct Running {
    core: magcomp::Compensator,
    /// None: the config's.
    frame: Option<HeadingFrame>,
    up: Option<Vector3<f64>>,
    reported_ut: Option<Vector3<f64>>,
}

/// Strength of the field of a first calibration from the operating system's estimate, microtesla, where the config has
/// none: the mean of the Earth's, 22 to 67.
const USUAL_FIELD_UT: f64 = 45.0;

#[uniffi::export]
impl Compensator {
    /// A compensator for a config. Fails with `Config` or `Calibration` when a field is out of range.
    #[uniffi::constructor]
    pub fn new(config: Config) -> Result<Arc<Self>, MagcompError> {
        let use_reported_hard_iron = config.use_reported_hard_iron.unwrap_or(false);
        let made = caught(|| -> Result<_, MagcompError> {
            let config: magcomp::Config = config.try_into()?;
            Ok((Running::new(&config)?, config))
        });
        let (running, config) = made.map_err(|what| MagcompError::Panicked { what })??;
        Ok(Arc::new(Self { config, use_reported_hard_iron, running: Guarded::new(running), handle: OnceLock::new() }))
    }

    /// A raw magnetometer event. A sample that can't be used comes back with status `Rejected` and changes nothing.
    pub fn push(&self, sample: MagneticSample) -> Result<Reading, MagcompError> {
        self.running.with(|running| Ok(running.push(sample, self.use_reported_hard_iron)))
    }

    /// A gyroscope event. Fails with `EventRejected`, which says why it was not used.
    pub fn push_rotation_rate(&self, sample: RotationRateSample) -> Result<(), MagcompError> {
        self.running.with(|running| Ok(running.core.push_rotation_rate(sample.into())?))
    }

    /// An accelerometer or gravity event. Fails with `EventRejected`, which says why it was not used.
    pub fn push_up(&self, sample: UpSample) -> Result<(), MagcompError> {
        self.running.with(|running| {
            running.core.push_up(sample.into())?;
            running.up = Some(sample.up_m_s2.into());
            Ok(())
        })
    }

    /// From now on headings are those of this frame, for instance when the screen was turned. Nothing else changes.
    /// Fails with `Config` when the declination is out of range.
    pub fn set_heading_frame(&self, frame: HeadingFrame) -> Result<(), MagcompError> {
        let heading = magcomp::HeadingConfig { declination_deg: frame.declination_deg, ..self.config.heading };
        magcomp::Config { heading, ..self.config.clone() }.validate()?;
        self.running.with(|running| {
            running.frame = Some(frame);
            Ok(())
        })
    }

    /// Hard iron, soft iron and field strength in force, if any.
    pub fn calibration(&self) -> Result<Option<Calibration>, MagcompError> {
        self.running.with(|running| Ok(running.core.calibration().map(Into::into)))
    }

    /// The latest ellipsoid fit that was accepted, with its covariance. None for the aided method, which makes none.
    pub fn fit(&self) -> Result<Option<Fit>, MagcompError> {
        self.running.with(|running| Ok(running.core.fit().map(Into::into)))
    }

    /// Covariance of b_x b_y b_z (microtesla) m_xx m_yy m_zz m_xy m_xz m_yz (dimensionless) in force, 9 x 9, row by row;
    /// none when it is not known.
    pub fn covariance(&self) -> Result<Option<Vec<f64>>, MagcompError> {
        self.running.with(|running| Ok(running.core.covariance().map(|c| c.transpose().iter().copied().collect())))
    }

    /// Which directions were seen, for guidance.
    pub fn coverage(&self) -> Result<Coverage, MagcompError> {
        self.running.with(|running| Ok(running.core.coverage().into()))
    }

    /// Forgets everything but the config, and makes it usable again after `Panicked`.
    pub fn reset(&self) -> Result<(), MagcompError> {
        self.running.replace(|| Running::new(&self.config))
    }

    /// The whole state as text with a version and a checksum, to be kept and restored.
    pub fn snapshot(&self) -> Result<String, MagcompError> {
        self.running.with(|running| Ok(running.core.snapshot()))
    }

    /// Takes over a snapshot: everything when it was made with the same config, else its calibration alone. Fails with
    /// `SnapshotDamaged` or `SnapshotNewer`; nothing has changed then.
    pub fn restore(&self, snapshot: String) -> Result<Restored, MagcompError> {
        let restored = self.running.with(|running| {
            let restored = running.core.restore(&snapshot)?;
            (running.up, running.reported_ut) = (None, None);
            Ok(restored)
        })?;
        Ok(match restored {
            magcomp::Restored::Everything => Restored::Everything,
            magcomp::Restored::CalibrationOnly => Restored::CalibrationOnly,
        })
    }

    /// Takes over a snapshot's calibration alone, and the clock starts anew: for the next launch of an app, or of the
    /// device, whose sensor clock begins at 0 again. Fails with `SnapshotDamaged` or `SnapshotNewer`; nothing has
    /// changed then.
    pub fn restore_calibration(&self, snapshot: String) -> Result<(), MagcompError> {
        let kept = caught(|| {
            let mut other = magcomp::Compensator::new(self.config.clone())?;
            other.restore(&snapshot)?;
            Ok::<_, MagcompError>(other.calibration())
        });
        let kept = kept.map_err(|what| MagcompError::Panicked { what })??;
        self.running.with(|running| kept.map_or(Ok(()), |calibration| running.begin_with(calibration)))
    }

    /// Frees the native state now; from then on every call fails with `Closed`. May be called twice.
    pub fn shut_down(&self) {
        self.running.shut_down();
    }

    /// A number for the fast paths, JNI and C, for the library's own wrapper.
    pub fn fast_handle(self: Arc<Self>) -> i64 {
        *self.handle.get_or_init(|| crate::handles::add(&self))
    }
}

impl Compensator {
    /// Runs an action that panics, to show what happens then.
    #[cfg(feature = "test-hooks")]
    pub(crate) fn panic_on_purpose(&self) -> Result<(), MagcompError> {
        self.running.with(|_| panic!("on purpose"))
    }
}

impl Running {
    fn new(config: &magcomp::Config) -> Result<Self, MagcompError> {
        let core = magcomp::Compensator::new(config.clone())?;
        Ok(Self { core, frame: None, up: None, reported_ut: None })
    }

    fn push(&mut self, sample: MagneticSample, use_reported: bool) -> Reading {
        let reported = sample.reported_hard_iron_ut.map(Vector3::from).filter(|b| b.iter().all(|v| v.is_finite()));
        if let Some(hard_iron_ut) = reported.filter(|_| use_reported && self.core.calibration().is_none()) {
            let begun = prior(hard_iron_ut, self.core.config()).and_then(|calibration| self.begin_with(calibration));
            if let Err(error) = begun {
                log::warn!("the operating system's hard iron was not taken over: {error}");
            }
        }
        let answer = self.core.push(sample.into());
        let mut reading = Reading::from(answer);
        if let (Some(frame), Some(up), Some(found)) = (&self.frame, &self.up, &mut reading.heading) {
            let field_ut = answer.filtered_field_ut.or(answer.field_ut);
            // sigma and inclination are the same in every frame
            let sigma = found.heading_sigma_deg;
            reading.heading = field_ut.and_then(|field_ut| heading_in(&field_ut, up, frame));
            if let Some(heading) = &mut reading.heading {
                heading.heading_sigma_deg = sigma;
            }
        }
        if let (Some(now), Some(before)) = (reported, self.reported_ut) {
            reading.reported_hard_iron_jump_ut = Some((now - before).norm()).filter(|jump| *jump > 0.0);
        }
        self.reported_ut = reported.or(self.reported_ut);
        reading
    }

    /// A calibration to begin with. The core takes one over from a snapshot made with another config.
    fn begin_with(&mut self, calibration: magcomp::Calibration) -> Result<(), MagcompError> {
        let config = magcomp::Config { initial: Some(calibration), ..self.core.config().clone() };
        self.core.restore(&magcomp::Compensator::new(config)?.snapshot())?;
        (self.up, self.reported_ut) = (None, None);
        Ok(())
    }
}

/// A first calibration from the operating system's hard iron.
fn prior(hard_iron_ut: Vector3<f64>, config: &magcomp::Config) -> Result<magcomp::Calibration, MagcompError> {
    let field_ut = config.fit.field_strength_ut.unwrap_or(USUAL_FIELD_UT);
    Ok(magcomp::Calibration::new(Matrix3::identity(), hard_iron_ut, field_ut)?)
}
