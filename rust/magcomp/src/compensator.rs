//! One `push`: a raw sample in, a [`Reading`] out. Checks the sample, pairs it with the other sensors' events, asks the one estimator, and
//! assembles the reading.

mod adopted;
mod assemble;
mod belief;
mod check;
mod keep;
mod outside;
mod presence;
mod rails;
mod repeats;
mod tuning;
mod tunings;

use crate::calibration::Calibration;
use crate::config::{Config, HeadingConfig, Method, WindowedConfig};
use crate::coverage::{Coverage, FEWEST_KEPT, Guidance};
use crate::ellipsoid::EllipsoidFit;
use crate::estimator::Estimator;
use crate::estimator::answer::{Answer, Counted};
use crate::explanation::Explanation;
use crate::north::North;
use crate::pointing::Pointing;
use crate::range::ConfigError;
use crate::reading::{Event, Reading, RejectReason, SensorMode, Status};
use crate::sample::{MagneticSample, RotationRateSample, UpSample, seconds};
use crate::sensing::pairing::{EventRejection, InertialPairing, PairedInertial};
use crate::sensing::stand_in::StandIn;
use crate::sensing::tilt::Tilt;
use crate::sensing::witnesses::{Testimony, Witnesses};
use belief::Belief;
use check::Stream;
use nalgebra::{SMatrix, Vector3};
use presence::Presence;
use tuning::Tuning;
pub use tunings::Tunings;

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
/// Two are equal when they will answer alike, but for samples of another clock that were refused so far.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Compensator {
    config: Config,
    tuning: Tuning,
    estimator: Estimator,
    guidance: Guidance,
    state: State,
}

/// What is carried from sample to sample, but for that which has memory of its own.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
struct State {
    stream: Stream,
    pairing: InertialPairing,
    presence: Presence,
    witnesses: Witnesses,
    tilt: Tilt,
    belief: Belief,
    north: North,
    stand_in: StandIn,
    mode: SensorMode,
    event: Option<Event>,
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
        let WindowedConfig { n_max, .. } = config.windowed;
        let kept = if config.method == Method::Aided { n_max.min(FEWEST_KEPT) } else { n_max };
        let mut it = Self {
            estimator: tunings.estimator(&config),
            tuning: tunings.compensator,
            guidance: Guidance::new(kept, config.field_strength_ut),
            state: State { witnesses: Witnesses::new(tunings.witnesses), ..State::default() },
            config,
        };
        it.adopt_initial();
        Ok(it)
    }

    /// Forgets everything but the config.
    pub fn reset(&mut self) {
        self.estimator.restart();
        self.guidance.restart();
        self.state = State { witnesses: self.state.witnesses.anew(), ..State::default() };
        self.adopt_initial();
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
        heading.validate()?;
        self.config.heading = heading;
        Ok(())
    }

    /// A gyroscope event, at its own rate: before the magnetometer sample that follows it in time, or a little late.
    ///
    /// # Errors
    /// [`EventRejection`] says why it was not taken; nothing has changed then.
    pub fn push_rotation_rate(&mut self, sample: RotationRateSample) -> Result<(), EventRejection> {
        self.state.pairing.push_rotation_rate(sample.time_ns, sample.rate_rad_s)?;
        self.state.stand_in.gyroscope_ns = Some(sample.time_ns);
        Ok(())
    }

    /// An accelerometer or gravity event, at its own rate: before the magnetometer sample that follows it in time.
    ///
    /// # Errors
    /// [`EventRejection`] says why it was not taken; nothing has changed then.
    pub fn push_up(&mut self, sample: UpSample) -> Result<(), EventRejection> {
        self.state.pairing.push_up(sample.time_ns, sample.up_m_s2)
    }

    /// A raw magnetometer event. A sample that can't be used comes back with `Status::Rejected` and changes nothing; but 50
    /// in a row whose time follows that of one another, and not that of the latest, are from another clock: the calibration
    /// stays then, and all else begins anew. At the sensor's full scale (`RejectReason::Saturated`) a gyroscope carries the field on:
    /// the reading has a carried field and a heading, and nothing is learned.
    pub fn push(&mut self, sample: MagneticSample) -> Reading {
        self.push_pointing(sample).0
    }

    /// The same as [`Self::push`], with what the heading of any axis is formed of; it is there where the reading has an attitude.
    pub fn push_pointing(&mut self, sample: MagneticSample) -> (Reading, Option<Pointing>) {
        match self.check(&sample) {
            Ok(()) => {}
            Err(reason @ (RejectReason::Saturated { .. } | RejectReason::NotFinite))
                if self.can_carry(sample.time_ns) =>
            {
                return self.carry(sample.time_ns, reason);
            }
            Err(reason) if self.state.stream.stray(sample.time_ns, reason) => self.begin_another_clock(),
            Err(reason) => return self.rejected(sample.time_ns, reason),
        }
        let previous_ns = self.state.stream.accept(sample);
        let (mut paired, testimony) = self.pair(sample.time_ns, previous_ns, Some(&sample.field_ut));
        if let Some(up) = paired.up_m_s2 {
            self.state.tilt.step(sample.time_ns, &up, &sample.field_ut);
        }
        if let Some([x, y, z]) = testimony.other_axes {
            return self.rejected(sample.time_ns, RejectReason::Axes { x, y, z });
        }
        self.judge_adopted(&sample, paired.up_m_s2);
        if self.hand_over(sample.time_ns, previous_ns, &testimony) || testimony.was_refused {
            // it does not know yet where the field points: this sample goes in as one after a pause
            paired.rotation = None;
        }
        let mut answer = Answer::default();
        let status = self.estimator.push(&sample, &paired, &mut answer);
        self.note(&sample, &answer);
        self.state.north.step(sample.time_ns, &mut answer, self.config.heading.declination_deg);
        let (reading, pointing) = self.assemble(sample.time_ns, status, &answer);
        if let (Status::Tracking, Some(heading)) = (status, &reading.heading) {
            let since_s = previous_ns.map_or(0.0, |previous_ns| seconds(previous_ns, sample.time_ns));
            self.state.belief.see_dip(heading, since_s);
        }
        (reading, pointing)
    }

    /// Whether [`Self::push`] would use this sample now, but for [`RejectReason::Axes`], which many samples tell together.
    ///
    /// # Errors
    /// [`RejectReason`] says why it would not.
    pub fn check(&self, sample: &MagneticSample) -> Result<(), RejectReason> {
        let is_told = || self.state.pairing.hears(sample.time_ns);
        self.state.stream.check(sample, self.config.range_ut, self.config.rail_ut, &self.tuning, is_told)
    }

    /// The estimator that the sensors allow takes over, from the calibration in force; whether the rotation is of no use to it.
    fn hand_over(&mut self, time_ns: i64, previous_ns: Option<i64>, testimony: &Testimony) -> bool {
        let State { presence, belief, .. } = &self.state;
        let (Some(is_there), Estimator::ByGyroscope(own)) =
            (presence.is_there(time_ns, previous_ns), &mut self.estimator)
        else {
            return false;
        };
        let is_there = is_there && !testimony.is_gyroscope_dead;
        let is_contradicted = testimony.is_gyroscope_contradicted;
        own.follow_gyroscope(is_there, is_contradicted, |given| belief.no_surer_than_usual(given))
    }

    /// What the other sensors say with a sample, and what the three say of each other.
    fn pair(
        &mut self,
        time_ns: i64,
        previous_ns: Option<i64>,
        field_ut: Option<&Vector3<f64>>,
    ) -> (PairedInertial, Testimony) {
        let mut paired = self.state.pairing.pair(time_ns);
        self.state.presence.see(time_ns, previous_ns, paired.rotation.is_some());
        let dt_s = previous_ns.map_or(0.0, |previous_ns| seconds(previous_ns, time_ns));
        let testimony = self.state.witnesses.hear(&mut paired, field_ut, dt_s);
        self.state.stream.repeats.see(&paired, dt_s);
        (paired, testimony)
    }

    /// What an answer tells the other parts.
    fn note(&mut self, sample: &MagneticSample, answer: &Answer) {
        let Counted { through, samples } = self.estimator.counted();
        self.guidance.see(&sample.field_ut, through, samples);
        self.note_gyroscope();
        self.state.mode = answer.mode;
        self.state.event = answer.event.or(self.state.event);
        if self.estimator.has_learned() {
            self.state.belief.learn();
        }
    }

    /// What the estimator knows of the gyroscope tells the pairing.
    fn note_gyroscope(&mut self) {
        if let Estimator::ByGyroscope(own) = &self.estimator
            && let Some((bias_rad_s, scale)) = own.gyroscope()
        {
            self.state.pairing.assume(bias_rad_s, scale.diagonal());
        }
    }

    /// Whether a gyroscope can carry on what is known to this time.
    fn can_carry(&self, time_ns: i64) -> bool {
        matches!(self.config.method, Method::Auto | Method::Aided)
            && (matches!(&self.estimator, Estimator::ByGyroscope(own) if own.carries()) || self.state.pairing.turns())
            && self.state.stream.check_time(time_ns).is_ok()
    }

    /// The field of a sample is of no use: the gyroscope carries on what is known.
    fn carry(&mut self, time_ns: i64, reason: RejectReason) -> (Reading, Option<Pointing>) {
        let previous_ns = self.state.stream.pass(time_ns);
        let (mut paired, testimony) = self.pair(time_ns, previous_ns, None);
        if self.hand_over(time_ns, previous_ns, &testimony) {
            paired.rotation = None;
        }
        let mut answer = self.estimator.carry(time_ns, &paired);
        self.note_gyroscope();
        answer.window = self.estimator.window();
        self.state.north.step(time_ns, &mut answer, self.config.heading.declination_deg);
        self.assemble(time_ns, Status::Rejected(reason), &answer)
    }

    fn rejected(&self, time_ns: i64, reason: RejectReason) -> (Reading, Option<Pointing>) {
        let answer = Answer { mode: self.state.mode, window: self.estimator.window(), ..Answer::default() };
        self.assemble(time_ns, Status::Rejected(reason), &answer)
    }

    /// Gaps so far: of the gyroscope while it was in use, of samples, and those that were told by [`Self::push_gap`].
    #[must_use]
    pub fn gaps(&self) -> u64 {
        self.state.presence.gaps
    }

    /// M, b and field strength in force, if any, in the magnetometer's axes. With a gyroscope the fields of a reading are turned to the device's besides: a
    /// magnetometer sits askew in a phone by a degree or two.
    #[must_use]
    pub fn calibration(&self) -> Option<Calibration> {
        self.estimator.known().calibration
    }

    /// Covariance of [b_x b_y b_z (uT), m_xx m_yy m_zz m_xy m_xz m_yz (dimensionless)] in force, if known.
    #[must_use]
    pub fn covariance(&self) -> Option<SMatrix<f64, 9, 9>> {
        self.estimator.known().covariance
    }

    /// The latest ellipsoid fit that was accepted. None for the aided and the adaptive method, which make none.
    #[must_use]
    pub fn fit(&self) -> Option<&EllipsoidFit> {
        self.estimator.fit()
    }

    /// Which directions the window has seen, for guidance.
    #[must_use]
    pub fn coverage(&self) -> &Coverage {
        &self.guidance.coverage
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
        let outside = self.state.stream.latest_ns().and_then(|latest_ns| self.state.north.explain(latest_ns));
        Explanation { outside, ..self.estimator.explain() }
    }
}
