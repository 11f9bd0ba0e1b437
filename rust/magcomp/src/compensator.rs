//! One `push`: a raw sample in, a [`Reading`] out. Checks the sample, gives it to the estimator, corrects it, and
//! forms the heading from the corrected field and the latest `up`. One file each:
//! `active` (the estimators), `adopted` (a calibration from elsewhere), `check` (what a sample may be).

mod active;
mod adopted;
mod check;

use crate::attitude::{Attitude, attitude, attitude_sigma_deg};
use crate::calibration::{Calibration, Given, independent};
use crate::config::{Config, Method, validate_heading};
use crate::coverage::Coverage;
use crate::ellipsoid::EllipsoidFit;
use crate::estimator::Tunings;
use crate::estimator::answer::Answer;
use crate::estimator::paper::Clerk;
use crate::explanation::Explanation;
use crate::heading::{Heading, HeadingConfig, heading, heading_sigma_deg, true_heading_deg};
use crate::kept::{CalibrationSource, IRON_PER_UT, KeptCalibration, USUAL_SIGMA_UT};
use crate::range::{ConfigError, in_range};
use crate::reading::{Event, Reading, SensorMode, Status};
use crate::sample::{MagneticSample, RotationRateSample, UpSample};
use crate::sensing::pairing::{EventRejection, InertialPairing};
use crate::sensing::tilt::{GRAVITY_M_S2, Tilt};
use active::Active;
use adopted::Adopted;
use nalgebra::{SMatrix, Vector3};

/// Without a rotation for so long the magnetometer goes on alone, ns: long enough for a hiccup of the system.
const GYROSCOPE_GONE_NS: i64 = 1_000_000_000;

/// The share of gravity by which a vertical may be accelerated to judge an adopted calibration by.
const CALM: f64 = 0.05;
/// The dip that is kept is a mean over this time, s: a walk's accelerations pass.
const DIP_S: f64 = 5.0;

/// Frees a magnetometer from the disturbance its phone carries, sample by sample.
///
/// No clock, no thread, no allocation in `push`. It never panics and never returns NaN.
///
/// ```
/// use magcomp::nalgebra::{Rotation3, Vector3};
/// use magcomp::{Compensator, Config, MagneticSample, Status, UpSample};
///
/// let mut config = Config::default();
/// config.heading.declination_deg = Some(2.5);
/// let mut compensator = Compensator::new(config)?;
/// for k in 0..1000_i64 {
///     let time_ns = k * 10_000_000;
///     // a device turned about in a field of 50 uT, with an offset of (120, -80, 300) uT
///     let attitude = Rotation3::from_euler_angles(k as f64 * 0.031, k as f64 * 0.023, k as f64 * 0.011);
///     let field = attitude.inverse() * Vector3::new(0.0, 30.0, -40.0);
///     let up_m_s2 = attitude.inverse() * Vector3::new(0.0, 0.0, 9.81);
///     compensator.push_up(UpSample { time_ns, up_m_s2 })?;
///     let reading = compensator.push(MagneticSample { time_ns, field_ut: field + Vector3::new(120.0, -80.0, 300.0) });
///     if let (Status::Tracking, Some(corrected), Some(sigma)) = (reading.status, reading.field_ut, reading.field_sigma_ut) {
///         // the length of three components is beyond four standard deviations once in a thousand
///         assert!((corrected - field).norm() < 4.0 * sigma);
///     }
/// }
/// assert!(compensator.calibration().is_some());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Compensator {
    config: Config,
    tunings: Tunings,
    pairing: InertialPairing,
    active: Box<Active>,
    clerk: Clerk,
    inputs: Inputs,
}

/// Whether two will answer alike, but for samples of another clock that were refused so far.
impl PartialEq for Compensator {
    fn eq(&self, other: &Self) -> bool {
        let inputs = |it: &Self| Inputs { astray: 0, astray_ns: 0, ..it.inputs };
        (&self.config, &self.tunings, &self.pairing) == (&other.config, &other.tunings, &other.pairing)
            && (&self.active, &self.clerk) == (&other.active, &other.clerk)
            && inputs(self) == inputs(other)
    }
}

/// What the checks of the next sample look at, and which estimator is to answer it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Inputs {
    latest: Option<MagneticSample>,
    /// How many equal samples came in a row before the latest.
    repeats: usize,
    /// Samples in a row that were rejected for their time but follow one another, and the time of the latest, ns.
    astray: u32,
    astray_ns: i64,
    /// Time of the latest sample with a rotation, ns: the gyroscope is there.
    rotated_ns: Option<i64>,
    /// The gyroscope was found to read nonsense. It is tried again once it has been gone.
    is_gyroscope_useless: bool,
    mode: SensorMode,
    gaps: u64,
    event: Option<Event>,
    tilt: Tilt,
    /// What was adopted, until something is learned from live samples.
    adopted: Option<Adopted>,
    /// The calibration in force was learned from live samples.
    has_learned: bool,
    /// Dip of the field when it was last known, deg.
    inclination_deg: Option<f64>,
    /// How well the calibration was believed that was adopted last, uT.
    adopted_sigma_ut: Option<f64>,
}

impl Inputs {
    /// What the next estimator begins from: the calibration in force, no surer than usual unless one was given that is.
    fn no_surer_than_usual(&self, mut given: Given) -> Given {
        let least_ut = self.adopted_sigma_ut.map_or(USUAL_SIGMA_UT, |sigma_ut| sigma_ut.min(USUAL_SIGMA_UT));
        let lacks_ut2 = (least_ut * least_ut - given.hard_iron_ut2()).max(0.0);
        given.covariance += independent(lacks_ut2, IRON_PER_UT * IRON_PER_UT * lacks_ut2);
        given
    }
}

impl Compensator {
    /// A compensator for a config. Everything it will ever need is allocated here.
    ///
    /// # Errors
    /// [`ConfigError`] names the field that is out of range.
    pub fn new(config: Config) -> Result<Self, ConfigError> {
        Self::tuned(config, Tunings::default())
    }

    /// With other choices than phones get: for `magcomp sensitivity`.
    ///
    /// # Errors
    /// As [`Self::new`].
    #[doc(hidden)]
    pub fn tuned(config: Config, tunings: Tunings) -> Result<Self, ConfigError> {
        config.validate()?;
        let mut it = Self {
            pairing: InertialPairing::default(),
            active: Box::new(Active::new(&config, &tunings, None)),
            clerk: Clerk::new(config.windowed, config.field_strength_ut),
            inputs: Inputs::default(),
            tunings,
            config,
        };
        it.adopt_initial();
        Ok(it)
    }

    fn adopt_initial(&mut self) {
        let Config { initial: Some(calibration), initial_sigma_ut, .. } = self.config else { return };
        // its sigma is that of a validated config
        if let Ok(kept) = KeptCalibration::given(calibration, initial_sigma_ut) {
            self.adopt(&kept, None);
        }
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

    /// From now on this calibration is in force, until something better is learned. The stream goes on.
    ///
    /// One that was kept has aged by `unix_time_s` (seconds since 1970, by the clock that [`Self::keep`] was told), less the time it was kept
    /// at: the older, the likelier the device has changed since. `None`: not known, so of one that was learned as good as nothing is
    /// believed beforehand. The first sample that comes with a vertical is judged by: a total field or a dip that is not as it was widens the
    /// hard iron's uncertainty or moves it, up to a start from nothing. The status is never `Tracking` before live samples of a turned
    /// device agree. The windowed methods have no prior: their readings have no sigma before their own fit.
    ///
    /// A calibration of the operating system replaces nothing that was learned. Beside one of another source that no live sample has confirmed
    /// the first such is one more measurement of the hard iron.
    pub fn adopt(&mut self, kept: &KeptCalibration, unix_time_s: Option<i64>) {
        let inputs = &mut self.inputs;
        if kept.source() == CalibrationSource::System {
            if inputs.has_learned {
                return;
            }
            if let Some(adopted) = &mut inputs.adopted {
                if adopted.hear(kept) {
                    self.begin_as_believed();
                }
                return;
            }
        }
        (inputs.adopted, inputs.has_learned) = (Some(Adopted::new(kept, unix_time_s)), false);
        inputs.adopted_sigma_ut = Some((kept.covariance().fixed_view::<3, 3>(0, 0).trace() / 3.0).sqrt());
        self.begin_from(Some(Given { calibration: *kept.calibration(), covariance: *kept.covariance() }));
    }

    /// The calibration in force with what is known of it, to be kept for the next launch; `unix_time_s` is now, seconds since 1970. `None`
    /// while nothing was learned from live samples: what was adopted is kept where it came from.
    #[must_use]
    pub fn keep(&self, unix_time_s: i64) -> Option<KeptCalibration> {
        let Given { calibration, covariance } =
            self.active.in_force(&self.clerk).filter(|_| self.inputs.has_learned)?;
        KeptCalibration::learned(calibration, covariance, self.inputs.inclination_deg, unix_time_s)
    }

    /// Time passed that the clock of the samples does not show, about so many seconds: the system slept. The device may have been turned,
    /// carried off or changed: the calibration is as unsure from here on as one that was kept for so long, and where the field points is
    /// found anew. The samples' time goes on.
    ///
    /// # Errors
    /// [`ConfigError`] when `hidden_s` is not a time of up to 1e9 s; nothing has changed then.
    pub fn push_gap(&mut self, hidden_s: f64) -> Result<(), ConfigError> {
        in_range("hidden_s", hidden_s, 0.0..=1e9, "s")?;
        self.inputs.gaps = self.inputs.gaps.saturating_add(1);
        self.pairing.pause();
        self.inputs.rotated_ns = None;
        let Some(given) = self.active.in_force(&self.clerk) else { return Ok(()) };
        let Inputs { has_learned, inclination_deg, .. } = self.inputs;
        let kept = KeptCalibration::learned(given.calibration, given.covariance, inclination_deg, 0);
        if let Some(kept) = kept.filter(|_| has_learned) {
            self.inputs.adopted = Some(Adopted::new(&kept, Some(hidden_s as i64)));
            self.begin_from(Some(given));
        }
        Ok(())
    }

    /// Gaps so far: of the gyroscope while it was in use, of samples, and those that were told by [`Self::push_gap`].
    #[must_use]
    pub fn gaps(&self) -> u64 {
        self.inputs.gaps
    }

    /// What live samples say of an adopted calibration, before anything is learned.
    fn judge_adopted(&mut self, sample: &MagneticSample, up: Option<Vector3<f64>>) {
        let Some(adopted) = &mut self.inputs.adopted else { return };
        let calm = |up: &Vector3<f64>| (up.norm() / GRAVITY_M_S2 - 1.0).abs() < CALM;
        if adopted.see(sample, up.filter(calm).map(|up| up.normalize()).as_ref()) {
            self.begin_as_believed();
        }
    }

    fn begin_as_believed(&mut self) {
        let believed = self.inputs.adopted.as_ref().and_then(Adopted::believed);
        self.begin_from(believed);
    }

    fn begin_from(&mut self, given: Option<Given>) {
        match &mut *self.active {
            Active::Windowed(windowed) => windowed.fit = None,
            // the aided one takes over with the next rotation
            other => *other = Active::new(&self.config, &self.tunings, given),
        }
        self.clerk.look_through(given.map(|given| given.calibration));
    }

    /// Another clock: all begins anew, but for the calibration in force.
    fn begin_another_clock(&mut self) {
        let inputs = self.inputs;
        let given = self.active.in_force(&self.clerk).map(|given| inputs.no_surer_than_usual(given));
        self.reset();
        let Inputs { adopted, has_learned, inclination_deg, adopted_sigma_ut, .. } = inputs;
        self.inputs = Inputs { adopted, has_learned, inclination_deg, adopted_sigma_ut, ..self.inputs };
        self.begin_from(given);
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
    /// stays then, and all else begins anew.
    pub fn push(&mut self, sample: MagneticSample) -> Reading {
        if let Err(reason) = self.check(&sample)
            && !self.begins_another_clock(sample.time_ns, reason)
        {
            let answer = Answer { mode: self.inputs.mode, ..Answer::default() };
            return self.reading(sample.time_ns, Status::Rejected(reason), answer);
        }
        (self.inputs.astray, self.inputs.astray_ns) = (0, 0);
        let previous = self.inputs.latest.replace(sample);
        let same = previous.is_some_and(|previous| previous.field_ut == sample.field_ut);
        self.inputs.repeats = if same { self.inputs.repeats.saturating_add(1) } else { 0 };
        let mut paired = self.pairing.pair(sample.time_ns);
        if paired.rotation.is_some() {
            self.inputs.rotated_ns = Some(sample.time_ns);
        } else if previous.is_some() && previous.map(|it| it.time_ns) == self.inputs.rotated_ns {
            // the chain of rotations breaks here, by the gyroscope's silence or that of all sensors
            self.inputs.gaps = self.inputs.gaps.saturating_add(1);
        }
        if let Some(up) = paired.up_m_s2 {
            self.inputs.tilt.step(sample.time_ns, up.norm());
        }
        self.judge_adopted(&sample, paired.up_m_s2);
        if self.hand_over(sample.time_ns, previous.map(|previous| previous.time_ns)) {
            // it does not know yet where the field points: this sample goes in as one after a pause
            paired.rotation = None;
        }
        let (status, answer) = self.active.push(&sample, &paired, &mut self.clerk);
        if let Some(aided) = self.active.aided() {
            let (bias_rad_s, scale) = aided.gyroscope();
            self.pairing.assume(bias_rad_s, scale.diagonal());
            self.inputs.is_gyroscope_useless = aided.is_gyroscope_useless();
        }
        self.inputs.mode = answer.mode;
        self.inputs.event = answer.event.or(self.inputs.event);
        if self.active.has_learned() {
            (self.inputs.has_learned, self.inputs.adopted) = (true, None);
        }
        let reading = self.reading(sample.time_ns, status, answer);
        if let (Status::Tracking, Some(heading)) = (status, reading.heading) {
            let seconds = previous.map_or(0.0, |previous| (sample.time_ns - previous.time_ns) as f64 * 1e-9);
            let dip_deg = self.inputs.inclination_deg.get_or_insert(heading.inclination_deg);
            *dip_deg += (heading.inclination_deg - *dip_deg) * (1.0 - (-seconds / DIP_S).exp());
        }
        reading
    }

    /// The estimator that the sensors allow takes over, from the calibration in force; whether that is the aided one.
    fn hand_over(&mut self, time_ns: i64, previous_ns: Option<i64>) -> bool {
        let (Method::Auto | Method::Aided, Some(rotated_ns)) = (self.config.method, self.inputs.rotated_ns) else {
            return false;
        };
        let is_gone = time_ns.saturating_sub(rotated_ns) > GYROSCOPE_GONE_NS;
        if is_gone {
            self.inputs.is_gyroscope_useless = false;
        }
        // a pause of all sensors is no loss of the gyroscope
        let is_usable = !self.inputs.is_gyroscope_useless && (!is_gone || Some(rotated_ns) == previous_ns);
        let (clerk, inputs) = (&self.clerk, &self.inputs);
        let others = self.active.follow_gyroscope(is_usable, &self.config, &self.tunings, |active| {
            inputs.no_surer_than_usual(active.in_force(clerk)?).into()
        });
        others && is_usable
    }

    fn reading(&self, time_ns: i64, status: Status, answer: Answer) -> Reading {
        let pointing = answer.filtered_field_ut.or(answer.field_ut).zip(answer.up);
        let covariance = answer.filtered_covariance_ut2.or(answer.field_covariance_ut2);
        let HeadingConfig { axis, screen_rotation, declination_deg, tilt_sigma_deg: at_rest_deg } = self.config.heading;
        let motion_rad2 = answer.tilt_rad2.unwrap_or(self.inputs.tilt.variance_rad2);
        let tilt_sigma_deg = at_rest_deg.hypot(motion_rad2.sqrt().to_degrees());
        Reading {
            time_ns,
            field_ut: answer.field_ut,
            field_sigma_ut: answer.field_covariance_ut2.map(|covariance| (covariance.trace().max(0.0) / 3.0).sqrt()),
            filtered_field_ut: answer.filtered_field_ut,
            total_field_ut: answer.field_ut.map(|field| field.norm()),
            heading: pointing.and_then(|(field, up)| {
                let found = heading(&field, &up, axis, screen_rotation)?;
                let sigma = |p| heading_sigma_deg(&field, &up, axis, screen_rotation, &p, tilt_sigma_deg);
                Some(Heading {
                    heading_sigma_deg: covariance.and_then(sigma),
                    true_heading_deg: declination_deg.map(|d| true_heading_deg(found.heading_deg, d)),
                    ..found
                })
            }),
            attitude: pointing.and_then(|(field, up)| {
                let sigma_deg = covariance.and_then(|p| attitude_sigma_deg(&field, &up, &p, tilt_sigma_deg));
                Some(Attitude { sigma_deg, ..attitude(&field, &up)? })
            }),
            sigma_t: answer.sigma_t,
            direction_sigma_deg: answer.direction_sigma_deg,
            worst_sigma_deg: answer.worst_sigma_deg,
            model_order: answer.model_order,
            window: self.active.window(&self.clerk),
            coverage: self.clerk.coverage.share(),
            mode: answer.mode,
            event: self.inputs.event,
            status,
        }
    }

    /// M, b and field strength in force, if any.
    #[must_use]
    pub fn calibration(&self) -> Option<Calibration> {
        self.active.calibration(&self.clerk)
    }

    /// Covariance of [b_x b_y b_z (uT), m_xx m_yy m_zz m_xy m_xz m_yz (dimensionless)] in force, if known.
    #[must_use]
    pub fn covariance(&self) -> Option<SMatrix<f64, 9, 9>> {
        self.active.covariance()
    }

    /// The latest ellipsoid fit that was accepted. None for the aided and the adaptive method, which make none.
    #[must_use]
    pub fn fit(&self) -> Option<&EllipsoidFit> {
        if let Active::Windowed(windowed) = &*self.active { windowed.fit.as_ref() } else { None }
    }

    /// Why the latest reading says what it says: innovation, hypotheses and noise levels after the latest sample that was not rejected. It only looks:
    /// no allocation, and whether it is asked changes no reading. For a log of a whole recording: `magcomp replay --explain`.
    ///
    /// ```
    /// # use magcomp::{Compensator, Config, EstimatorPhase};
    /// let explanation = Compensator::new(Config::default())?.explain();
    /// assert_eq!((explanation.phase, explanation.sample), (EstimatorPhase::Starting, None));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn explain(&self) -> Explanation {
        self.active.explain(&self.clerk)
    }

    /// Which directions the window has seen, for guidance.
    #[must_use]
    pub fn coverage(&self) -> &Coverage {
        &self.clerk.coverage
    }

    /// Forgets everything but the config.
    pub fn reset(&mut self) {
        self.pairing = InertialPairing::default();
        *self.active = Active::new(&self.config, &self.tunings, None);
        self.clerk.restart();
        self.inputs = Inputs::default();
        self.adopt_initial();
    }
}
