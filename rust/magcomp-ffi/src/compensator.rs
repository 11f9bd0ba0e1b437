//! The compensator as it crosses the border: one mutex around one core object, and what belongs to it.

use crate::config::Config;
use crate::error::MagcompError;
use crate::guarded::{Guarded, caught};
use crate::handles::Handles;
use crate::record::{Calibration, Coverage, Fit, HeadingFrame, MagneticSample, Reading, RotationRateSample, UpSample};
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
    /// The snapshot holds no more, or was made with another config or by another build of the library: its calibration was taken
    /// over, the rest starts anew.
    CalibrationOnly,
}

struct Running {
    core: magcomp::Compensator,
    reported_ut: Option<Vector3<f64>>,
}

static HANDLES: Handles<Compensator> = Handles::new();

/// The compensator of a fast handle, if it is still there.
pub(crate) fn find(handle: i64) -> Option<Arc<Compensator>> {
    HANDLES.find(handle)
}

/// Strength of the field of a first calibration from the operating system's estimate, microtesla, where the config has
/// none: the mean of the Earth's, 22 to 67.
const USUAL_FIELD_UT: f64 = 45.0;

/// How well that estimate is believed, microtesla per axis: a third of the worst that was seen. In seven recordings of three phones
/// it was off by 1 to 9 (median 8) of length in six, and by 39 in one, 38 of them along one axis: that phone had last calibrated
/// itself beside magnets.
const REPORTED_SIGMA_UT: f64 = 13.0;

#[uniffi::export]
impl Compensator {
    /// A compensator for a config. Fails with `Config` or `Calibration` when a field is out of range.
    #[uniffi::constructor]
    pub fn new(config: Config) -> Result<Arc<Self>, MagcompError> {
        let use_reported_hard_iron = config.use_reported_hard_iron.unwrap_or(true);
        let made = caught(|| -> Result<_, MagcompError> {
            let config: magcomp::Config = config.try_into()?;
            Ok((Running::new(&config)?, config))
        });
        let (running, config) = made.map_err(|what| MagcompError::Panicked { what })??;
        Ok(Arc::new(Self { config, use_reported_hard_iron, running: Guarded::new(running), handle: OnceLock::new() }))
    }

    /// A raw magnetometer event. A sample that cannot be used comes back with status `Rejected` and changes nothing.
    /// After 50 such samples in a row whose times follow one another but not the latest used sample, the compensator
    /// assumes another clock: it keeps the calibration and begins anew with everything else. A snapshot does not hold
    /// the number of such samples.
    pub fn push(&self, sample: MagneticSample) -> Result<Reading, MagcompError> {
        self.push_for(sample, |reading, jump_ut| Reading {
            reported_hard_iron_jump_ut: jump_ut,
            ..Reading::from(*reading)
        })
    }

    /// A gyroscope event. Fails with `EventRejected`, which says why it was not used.
    pub fn push_rotation_rate(&self, sample: RotationRateSample) -> Result<(), MagcompError> {
        self.running.with(|running| Ok(running.core.push_rotation_rate(sample.into())?))
    }

    /// An accelerometer or gravity event. Fails with `EventRejected`, which says why it was not used.
    pub fn push_up(&self, sample: UpSample) -> Result<(), MagcompError> {
        self.running.with(|running| Ok(running.core.push_up(sample.into())?))
    }

    /// From now on headings are those of this frame, for instance when the screen was turned. Nothing else changes.
    /// Fails with `Config` when the declination is out of range.
    pub fn set_heading_frame(&self, frame: HeadingFrame) -> Result<(), MagcompError> {
        self.running.with(|running| {
            let heading = magcomp::HeadingConfig {
                axis: frame.axis.into(),
                screen_rotation: frame.screen_rotation.into(),
                declination_deg: frame.declination_deg,
                ..running.core.config().heading
            };
            Ok(running.core.set_heading(heading)?)
        })
    }

    /// Hard iron, soft iron and field strength in force, if any.
    pub fn calibration(&self) -> Result<Option<Calibration>, MagcompError> {
        self.running.with(|running| Ok(running.core.calibration().map(Into::into)))
    }

    /// From now on this calibration is in force, until something better is learned. The stream goes on.
    /// `hard_iron_sigma_ut` is one standard deviation of each component of its hard iron, microtesla, 0.01 to 1000; the
    /// first readings are as unsure as that. Fails with `Calibration` when the numbers are no calibration and with
    /// `Config` when the standard deviation is out of range; nothing has changed then.
    pub fn adopt(&self, calibration: Calibration, hard_iron_sigma_ut: f64) -> Result<(), MagcompError> {
        self.running.with(|running| Ok(running.core.adopt(calibration.try_into()?, hard_iron_sigma_ut)?))
    }

    /// The latest ellipsoid fit that was accepted, with its covariance. None for the aided and the adaptive method, which make none.
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

    /// Forgets everything but the config it was made with, also a heading frame that was set since. Makes the
    /// compensator usable again after `Panicked`.
    pub fn reset(&self) -> Result<(), MagcompError> {
        self.running.replace(|| Running::new(&self.config))
    }

    /// The whole state as text with a version and a checksum, to be kept and restored.
    pub fn snapshot(&self) -> Result<String, MagcompError> {
        self.running.with(|running| Ok(running.core.snapshot()))
    }

    /// The calibration in force alone, as a text of a few hundred characters with a version and a checksum, for
    /// `restore_calibration`. None without a calibration.
    pub fn snapshot_calibration(&self) -> Result<Option<String>, MagcompError> {
        self.running.with(|running| Ok(running.core.snapshot_calibration()))
    }

    /// Takes over a snapshot: all of it when the same build of the library made it with the same config (the heading's
    /// frame may differ), else its calibration alone. Fails with `SnapshotDamaged` or `SnapshotNewer`; nothing has
    /// changed then.
    pub fn restore(&self, snapshot: String) -> Result<Restored, MagcompError> {
        let restored = self.running.with(|running| {
            let restored = running.core.restore(&snapshot)?;
            running.reported_ut = None;
            Ok(restored)
        })?;
        Ok(match restored {
            magcomp::Restored::Everything => Restored::Everything,
            magcomp::Restored::CalibrationOnly => Restored::CalibrationOnly,
        })
    }

    /// Takes over a snapshot's calibration, if it has one, and begins anew with everything else, the clock too. For the
    /// next launch of an app, or for a device that was restarted and whose sensor clock begins at 0 again. Fails with
    /// `SnapshotDamaged` or `SnapshotNewer`; nothing has changed then.
    pub fn restore_calibration(&self, snapshot: String) -> Result<(), MagcompError> {
        self.running.with(|running| {
            running.core.restore_calibration(&snapshot)?;
            running.reported_ut = None;
            Ok(())
        })
    }

    /// Frees the native state now; from then on every call fails with `Closed`. May be called twice.
    pub fn shut_down(&self) {
        self.running.shut_down();
    }

    /// A number for the fast paths, JNI and C, for the library's own wrapper.
    pub fn fast_handle(self: Arc<Self>) -> i64 {
        *self.handle.get_or_init(|| HANDLES.add(&self))
    }
}

impl Compensator {
    /// What `answer` makes of the core's reading and of the jump of the operating system's hard iron, microtesla.
    pub(crate) fn push_for<R>(
        &self,
        sample: MagneticSample,
        answer: impl FnOnce(&magcomp::Reading, Option<f64>) -> R,
    ) -> Result<R, MagcompError> {
        self.running.with(|running| {
            let jump_ut = running.note_reported(&sample, self.use_reported_hard_iron);
            Ok(answer(&running.core.push(sample.into()), jump_ut))
        })
    }

    /// Runs an action that panics, to show what happens then.
    #[cfg(feature = "test-hooks")]
    pub(crate) fn panic_on_purpose(&self) -> Result<(), MagcompError> {
        self.running.with(|_| panic!("on purpose"))
    }
}

impl Running {
    fn new(config: &magcomp::Config) -> Result<Self, MagcompError> {
        let core = magcomp::Compensator::new(config.clone())?;
        Ok(Self { core, reported_ut: None })
    }

    /// Looks at the operating system's hard iron before the sample itself: by how much it jumped, microtesla.
    fn note_reported(&mut self, sample: &MagneticSample, use_reported: bool) -> Option<f64> {
        let now = sample.reported_hard_iron_ut.map(Vector3::from).filter(|b| b.iter().all(|v| v.is_finite()))?;
        // a sample that will be rejected changes nothing
        self.core.check(&(*sample).into()).ok()?;
        let before = self.reported_ut.replace(now);
        if use_reported && before != Some(now) && self.core.calibration().is_none() {
            match prior(now, self.core.config()) {
                Ok(calibration) => {
                    // a constant within its range
                    let _ = self.core.adopt(calibration, REPORTED_SIGMA_UT);
                }
                Err(error) => log::warn!("the operating system's hard iron was not taken over: {error}"),
            }
        }
        let before = before?;
        Some((now - before).norm()).filter(|jump| *jump > 0.0)
    }
}

/// A first calibration from the operating system's hard iron.
fn prior(hard_iron_ut: Vector3<f64>, config: &magcomp::Config) -> Result<magcomp::Calibration, MagcompError> {
    let (value_ut, limit_ut) = (hard_iron_ut[hard_iron_ut.iamax()], config.range_ut);
    if value_ut.abs() > limit_ut {
        return Err(magcomp::RejectReason::OutOfRange { value_ut, limit_ut }.into());
    }
    let field_ut = config.field_strength_ut.unwrap_or(USUAL_FIELD_UT);
    Ok(magcomp::Calibration::new(Matrix3::identity(), hard_iron_ut, field_ut)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::default_config;
    use crate::record::Vector3;

    #[test]
    fn a_rejected_sample_brings_no_hard_iron() {
        let compensator = Compensator::new(default_config()).unwrap();
        let sample = |time_ns: i64, x: f64, reported: f64| MagneticSample {
            time_ns,
            field_ut: Vector3 { x, y: 1.0, z: 2.0 },
            reported_hard_iron_ut: Some(Vector3 { x: reported, y: 0.0, z: 0.0 }),
        };
        let before = compensator.snapshot().unwrap();
        assert_eq!(compensator.push(sample(1, f64::NAN, 70.0)).unwrap().reported_hard_iron_jump_ut, None);
        assert_eq!(compensator.snapshot().unwrap(), before);
        assert_eq!(compensator.push(sample(2, 3.0, 100.0)).unwrap().reported_hard_iron_jump_ut, None);
        assert!((compensator.calibration().unwrap().unwrap().hard_iron_ut.x - 100.0).abs() < 1e-9);
        let jump_ut =
            |time_ns, x, reported| compensator.push(sample(time_ns, x, reported)).unwrap().reported_hard_iron_jump_ut;
        assert_eq!((jump_ut(3, 1e9, 90.0), jump_ut(4, 4.0, 97.0)), (None, Some(3.0)));
    }
}
