//! The scenarios methods are compared on: simulated streams, each with one kind of change, named on the command line.
//!
//! The table's own: 40 uT field, dip 60 deg, parameters `mid`, 30 dB, 100 Hz, the change after 25 s of 65. The phones': those
//! of `phone`, 40 dB.

use crate::motion::Motion;
use crate::parameters::{ParameterSet, Parameters};
use crate::phone::{Phone, PhoneChange};
use crate::random::{Purpose, Random};
use crate::schedule::Schedule;
use crate::simulate::{Noise, Scenario, Spikes, world_field_ut};
use clap::ValueEnum;
use magcomp::Calibration;
use magcomp::nalgebra::Vector3;

/// Field of the table's scenarios, uT.
const FIELD_UT: f64 = 40.0;
/// Its dip, degrees.
const DIP_DEG: f64 = 60.0;
/// Samples a second.
const RATE_HZ: f64 = 100.0;
/// Samples before the change, and after it.
const BEFORE: usize = 2500;
const AFTER: usize = 4000;
/// All nine parameters times this.
const FACTOR: f64 = 1.5;
/// Length of the ramp, s.
const RAMP_S: f64 = 50.0;
/// From one change to the next where there are many, s.
const PERIOD_S: f64 = 15.0;

/// A scenario by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Case {
    /// Even orientations; nothing changes
    Constant,
    /// Even orientations; all nine parameters step by 50 %
    Step,
    /// The same step, turned about in a hand
    StepHand,
    /// The same step while walking about, with a turn every 4.5 s
    StepWalk,
    /// Even orientations; b grows by 50 % over 50 s
    Ramp,
    /// Even orientations; each parameter drawn anew within 50 % every 15 s
    RandomSteps,
    /// The step, and 2 % of the samples hit by spikes of ten field strengths
    Spikes,
    /// Even orientations; b is off by (0.6, -0.4, 0.3) field strengths for 50 samples
    Pulse,
    /// Even orientations; all parameters between 1 and 1.5 times every 15 s
    Covers,
    /// Even orientations; b steps by a tenth of the field
    SmallStep,
    /// The small step in a hand
    SmallStepHand,
    /// A phone in a hand; all nine parameters step by 50 % of their deviation
    PhoneHand,
    /// A phone with its walker; b steps by (20, -15, 10) uT
    PhoneWalk,
    /// `PhoneWalk` with the calibration of an earlier session, right until the step
    PhoneWalkKnown,
    /// A phone in a hand; b drifts by 0.5 uT/s all the time
    PhoneDrift,
    /// A phone in a hand; nothing changes
    PhoneSteady,
    /// A phone with its walker; nothing changes
    PhoneWalkSteady,
    /// A phone turned about one axis; nothing changes
    PhonePlanar,
    /// A phone at rest; nothing changes
    PhoneStill,
    /// `PhoneHand` with 2 % spikes of 30 to 150 uT
    PhoneSpikes,
}

/// A stream of a scenario and when its change is.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The stream.
    pub scenario: Scenario,
    /// Samples before the change.
    pub before: usize,
}

impl Plan {
    /// Whether the parameters change at once before sample k.
    #[must_use]
    pub fn steps_at(&self, k: usize) -> bool {
        let sample = |at_s: f64| (at_s * self.scenario.rate_hz).round() as usize;
        self.scenario.parameters.changes.iter().any(|change| change.over_s == 0.0 && sample(change.at_s) == k)
    }
}

impl Case {
    /// Its name on the command line.
    #[must_use]
    pub fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }

    /// The calibration of an earlier session, where the scenario has one.
    #[must_use]
    pub fn initial(self, plan: &Plan) -> Option<Calibration> {
        let (start, field_ut) = (plan.scenario.parameters.start, plan.scenario.world_ut.start.norm());
        let known = self == Self::PhoneWalkKnown;
        known.then(|| Calibration::new(start.soft_iron, start.hard_iron * field_ut, field_ut).ok()).flatten()
    }

    /// The stream that a seed names.
    #[must_use]
    pub fn plan(self, seed: u64, snr_db: Option<f64>) -> Plan {
        match self {
            Self::PhoneHand
            | Self::PhoneWalk
            | Self::PhoneWalkKnown
            | Self::PhoneDrift
            | Self::PhoneSpikes
            | Self::PhoneSteady
            | Self::PhoneWalkSteady
            | Self::PhonePlanar
            | Self::PhoneStill => self.phone(seed, snr_db),
            _ => self.table(seed, snr_db),
        }
    }

    fn phone(self, seed: u64, snr_db: Option<f64>) -> Plan {
        let (motion, change) = match self {
            Self::PhoneWalk | Self::PhoneWalkKnown => (Motion::Pedestrian, PhoneChange::Offset),
            Self::PhoneSteady => (Motion::Tumble, PhoneChange::Nothing),
            Self::PhoneWalkSteady => (Motion::Pedestrian, PhoneChange::Nothing),
            Self::PhonePlanar => (Motion::Planar, PhoneChange::Nothing),
            Self::PhoneStill => (Motion::Still, PhoneChange::Nothing),
            Self::PhoneDrift => (Motion::Tumble, PhoneChange::Nothing),
            _ => (Motion::Tumble, PhoneChange::Parameters),
        };
        let spikes = if self == Self::PhoneSpikes { 0.02 } else { 0.0 };
        let phone = Phone { seed, motion, change, spikes, snr_db: snr_db.unwrap_or(40.0), ..Phone::default() };
        let mut scenario = phone.scenario();
        if self == Self::PhoneDrift {
            let start = scenario.parameters.start;
            let direction = Random::new(seed, Purpose::Bootstrap).direction();
            let gone = direction * (0.5 * phone.duration_s / crate::phone::FIELD_UT);
            let to = Parameters { hard_iron: start.hard_iron + gone, ..start };
            scenario.parameters = Schedule::ramp(start, 0.0, phone.duration_s, to);
        }
        Plan { scenario, before: (crate::phone::CHANGE_S * phone.rate_hz) as usize }
    }

    fn table(self, seed: u64, snr_db: Option<f64>) -> Plan {
        let start = ParameterSet::Mid.parameters();
        let at_s = BEFORE as f64 / RATE_HZ;
        let duration_s = (BEFORE + AFTER) as f64 / RATE_HZ;
        let offset = |by: [f64; 3]| Parameters { hard_iron: start.hard_iron + Vector3::from(by), ..start };
        let parameters = match self {
            Self::Constant => Schedule::constant(start),
            Self::Step | Self::StepHand | Self::StepWalk | Self::Spikes => {
                Schedule::step(start, at_s, start.times(FACTOR))
            }
            Self::Ramp => {
                let to = Parameters { hard_iron: start.hard_iron * FACTOR, ..start };
                Schedule::ramp(start, at_s, RAMP_S, to)
            }
            Self::RandomSteps => {
                let mut random = Random::new(seed, Purpose::Parameters);
                let mut draw = || Parameters::from_theta(start.theta().map(|v| v * (1.0 + random.uniform(-0.5, 0.5))));
                many(start, at_s, duration_s, |_| draw())
            }
            Self::Covers => many(start, at_s, duration_s, |k| if k % 2 == 0 { start.times(FACTOR) } else { start }),
            Self::Pulse => Schedule::pulse(start, at_s, 0.5, offset([0.6, -0.4, 0.3])),
            _ => Schedule::step(start, at_s, offset([0.06, -0.06, 0.05])),
        };
        let motion = match self {
            Self::StepHand | Self::SmallStepHand => Motion::Tumble,
            Self::StepWalk => Motion::Stroll,
            _ => Motion::Uniform,
        };
        let size_ut = (10.0 * FIELD_UT, 10.0 * FIELD_UT + 1e-6);
        let scenario = Scenario {
            seed,
            samples: BEFORE + AFTER,
            rate_hz: RATE_HZ,
            motion,
            world_ut: Schedule::constant(world_field_ut(FIELD_UT, DIP_DEG)),
            parameters,
            noise: Noise::SnrDb(snr_db.unwrap_or(30.0)),
            spikes: (self == Self::Spikes).then_some(Spikes { share: 0.02, size_ut }),
            gyroscope: None,
            accelerometer: None,
        };
        Plan { scenario, before: BEFORE }
    }
}

/// Steps from `at_s` on, one every period.
fn many(start: Parameters, at_s: f64, until_s: f64, mut to: impl FnMut(usize) -> Parameters) -> Schedule<Parameters> {
    let count = ((until_s - at_s) / PERIOD_S).ceil() as usize;
    let change = |k: usize| crate::schedule::Change { at_s: at_s + PERIOD_S * k as f64, over_s: 0.0, to: to(k) };
    Schedule { start, changes: (0..count).map(change).collect() }
}
