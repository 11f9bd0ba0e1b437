//! The compensator as it crosses the border: one mutex around one core object, and what belongs to it.

use crate::config::Config;
use crate::error::MagcompError;
use crate::guarded::{Guarded, caught};
use crate::handles::Handles;
use crate::reading::Reading;
use crate::record::{Calibration, Coverage, Fit, HeadingFrame, MagneticSample, RotationRateSample, UpSample};
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

struct Running {
    core: magcomp::Compensator,
    /// The operating system's latest hard iron.
    reported_ut: Option<Vector3<f64>>,
    /// The core was told the system's hard iron. It listens to the first alone.
    has_told: bool,
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
    /// assumes another clock: it keeps the calibration and begins anew with everything else. At the sensor's full scale
    /// (`Saturated`) a gyroscope carries the field on: the reading has a carried field and a heading, and nothing is learned.
    pub fn push(&self, sample: MagneticSample) -> Result<Reading, MagcompError> {
        self.push_for(sample, |(reading, _), jump_ut| Reading {
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
        self.running.with(|running| {
            running.adopt(&magcomp::KeptCalibration::given(calibration.try_into()?, hard_iron_sigma_ut)?, None);
            Ok(())
        })
    }

    /// The calibration in force with what is known of it, as JSON, for `adopt_kept` at the next launch; `unix_time_s` is now, seconds
    /// since 1970. None while nothing was learned from live samples: what was adopted is kept where it came from.
    pub fn keep(&self, unix_time_s: i64) -> Result<Option<String>, MagcompError> {
        self.running.with(|running| Ok(running.core.keep(unix_time_s).map(|kept| kept.to_json())))
    }

    /// From now on the calibration of a text of `keep` is in force, until something better is learned. The stream, the config and the
    /// heading frame stay. It is as sure as it was, less what its age by `unix_time_s` costs: now, seconds since 1970, by the clock
    /// that `keep` was told. None: not known, so as good as nothing is believed beforehand of one that was learned. The first live samples
    /// are judged by: what disagrees widens or replaces it. Fails with `KeptDamaged` or `KeptNewer`; nothing has changed then.
    pub fn adopt_kept(&self, text: String, unix_time_s: Option<i64>) -> Result<(), MagcompError> {
        self.running.with(|running| {
            running.adopt(&magcomp::KeptCalibration::from_json(&text)?, unix_time_s);
            Ok(())
        })
    }

    /// Time passed that the clock of the samples does not show, about so many seconds (0 to 1e9): the device slept. The calibration is
    /// as unsure from here on as one that was kept for so long, and where the field points is found anew. The samples' time goes on.
    /// Fails with `Config` when `hidden_s` is out of range; nothing has changed then.
    pub fn push_gap(&self, hidden_s: f64) -> Result<(), MagcompError> {
        self.running.with(|running| Ok(running.core.push_gap(hidden_s)?))
    }

    /// Gaps so far: of the gyroscope while it was in use, of samples, and those told by `push_gap`.
    pub fn gaps(&self) -> Result<i64, MagcompError> {
        self.running.with(|running| Ok(i64::try_from(running.core.gaps()).unwrap_or(i64::MAX)))
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
    /// What `answer` makes of the core's reading, of what any heading is formed of, and of the jump of the operating system's hard iron, microtesla.
    pub(crate) fn push_for<R>(
        &self,
        sample: MagneticSample,
        answer: impl FnOnce(&(magcomp::Reading, Option<magcomp::Pointing>), Option<f64>) -> R,
    ) -> Result<R, MagcompError> {
        self.running.with(|running| {
            let jump_ut = running.note_reported(&sample, self.use_reported_hard_iron);
            Ok(answer(&running.core.push_pointing(sample.into()), jump_ut))
        })
    }

    /// What the core answers.
    pub(crate) fn with_core<R>(
        &self,
        answer: impl FnOnce(&mut magcomp::Compensator) -> Result<R, MagcompError>,
    ) -> Result<R, MagcompError> {
        self.running.with(|running| answer(&mut running.core))
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
        Ok(Self { core, reported_ut: None, has_told: false })
    }

    fn adopt(&mut self, kept: &magcomp::KeptCalibration, unix_time_s: Option<i64>) {
        self.core.adopt(kept, unix_time_s);
        self.has_told = false;
    }

    /// Looks at the operating system's hard iron before the sample itself: by how much it jumped, microtesla. The core hears the first one;
    /// once it has learned from live samples it does not listen.
    fn note_reported(&mut self, sample: &MagneticSample, use_reported: bool) -> Option<f64> {
        let now = sample.reported_hard_iron_ut.map(Vector3::from).filter(|b| b.iter().all(|v| v.is_finite()))?;
        // a sample that will be rejected changes nothing
        self.core.check(&(*sample).into()).ok()?;
        let before = self.reported_ut.replace(now);
        if use_reported && !self.has_told {
            match of_system(now, self.core.config()) {
                Ok(kept) => {
                    self.core.adopt(&kept, None);
                    self.has_told = true;
                }
                // once for each
                Err(error) if before != Some(now) => {
                    log::warn!("the operating system's hard iron was not taken over: {error}");
                }
                Err(_) => {}
            }
        }
        let before = before?;
        Some((now - before).norm()).filter(|jump| *jump > 0.0)
    }
}

/// What the operating system's hard iron tells.
fn of_system(hard_iron_ut: Vector3<f64>, config: &magcomp::Config) -> Result<magcomp::KeptCalibration, MagcompError> {
    let (value_ut, limit_ut) = (hard_iron_ut[hard_iron_ut.iamax()], config.range_ut);
    if value_ut.abs() > limit_ut {
        return Err(magcomp::RejectReason::OutOfRange { value_ut, limit_ut }.into());
    }
    let field_ut = config.field_strength_ut.unwrap_or(USUAL_FIELD_UT);
    let calibration = magcomp::Calibration::new(Matrix3::identity(), hard_iron_ut, field_ut)?;
    Ok(magcomp::KeptCalibration::system(calibration, REPORTED_SIGMA_UT)?)
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
            // of the strength that is assumed beside the system's hard iron
            field_ut: Vector3 { x, y: 27.0, z: -36.0 },
            reported_hard_iron_ut: Some(Vector3 { x: reported, y: 0.0, z: 0.0 }),
        };
        assert_eq!(compensator.push(sample(1, f64::NAN, 70.0)).unwrap().reported_hard_iron_jump_ut, None);
        assert_eq!(compensator.calibration().unwrap(), None);
        assert_eq!(compensator.push(sample(2, 100.0, 100.0)).unwrap().reported_hard_iron_jump_ut, None);
        assert!((compensator.calibration().unwrap().unwrap().hard_iron_ut.x - 100.0).abs() < 1e-9);
        let jump_ut =
            |time_ns, x, reported| compensator.push(sample(time_ns, x, reported)).unwrap().reported_hard_iron_jump_ut;
        assert_eq!((jump_ut(3, 1e9, 90.0), jump_ut(4, 4.0, 97.0)), (None, Some(3.0)));
    }

    fn sample(time_ns: i64, reported_x: f64) -> MagneticSample {
        MagneticSample {
            time_ns,
            field_ut: Vector3 { x: 100.0, y: 20.0 + time_ns as f64, z: -40.0 },
            reported_hard_iron_ut: Some(Vector3 { x: reported_x, y: 0.0, z: 0.0 }),
        }
    }

    #[test]
    fn the_first_hard_iron_of_the_system_alone_is_heard_also_beside_a_kept_calibration() {
        let compensator = Compensator::new(default_config()).unwrap();
        let x_ut = || compensator.calibration().unwrap().unwrap().hard_iron_ut.x;
        for (time_ns, reported_x) in [(1, 100.0), (2, 60.0)] {
            compensator.push(sample(time_ns, reported_x)).unwrap();
            assert!((x_ut() - 100.0).abs() < 1e-9, "the first: {}", x_ut());
        }
        let soft_iron = Matrix3::identity();
        let there = magcomp::Calibration::new(soft_iron, [110.0, 0.0, 0.0].into(), 45.0).unwrap();
        let text = magcomp::KeptCalibration::given(there, 13.0).unwrap().to_json();
        compensator.adopt_kept(text, None).unwrap();
        assert!((x_ut() - 110.0).abs() < 1e-9);
        compensator.push(sample(3, 90.0)).unwrap();
        let heard = x_ut();
        assert!((95.0..105.0).contains(&heard), "as sure as one another: {heard}");
        compensator.push(sample(4, 20.0)).unwrap();
        assert!((x_ut() - heard).abs() < 5.0, "the first alone: {heard}, then {}", x_ut());
        assert_eq!(compensator.keep(0).unwrap(), None, "nothing was learned");
    }

    #[test]
    fn a_text_that_is_refused_changes_nothing() {
        let compensator = Compensator::new(default_config()).unwrap();
        compensator.push(sample(1, 100.0)).unwrap();
        let before = compensator.calibration().unwrap();
        let found = |text: &str| compensator.adopt_kept(text.to_owned(), Some(1)).unwrap_err();
        assert!(matches!(found("nonsense"), MagcompError::KeptDamaged { why } if !why.is_empty()));
        assert_eq!(found("{\"magcomp_calibration\": 99}"), MagcompError::KeptNewer { found: 99 });
        assert!(
            matches!(compensator.push_gap(f64::NAN), Err(MagcompError::Config { field, .. }) if field == "hidden_s")
        );
        assert_eq!((compensator.calibration().unwrap(), compensator.gaps().unwrap()), (before, 0));
    }
}
