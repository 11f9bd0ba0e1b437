//! One scenario of the catalogue, and the stream that a seed makes of it.

use super::group::Group;
use super::happening::{Drawn, Happening, Setting};
use super::sensors::Sensors;
use crate::motion::{Motion, Shake, Trajectory};
use crate::parameters::{ParameterSet, Parameters};
use crate::random::{Purpose, Random};
use crate::simulate::{Noise, Scenario, Simulation, world_field_ut};
use crate::surroundings::Surrounding;
use magcomp::nalgebra::Matrix3;
use magcomp::{Calibration, CalibrationSource, Config, HeadingConfig, KEPT_VERSION, KeptCalibration, ReferenceAxis};

/// What an earlier launch has learned errs by this: each component of b, uT, and each element of M.
const LEARNED_UT: f64 = 0.5;
const LEARNED_IRON: f64 = 0.005;

/// A scenario: what is drawn anew for every seed, and what is not.
#[derive(Clone, Debug, PartialEq)]
pub struct Variant {
    /// On the command line; unique.
    pub name: String,
    /// In a few words, for tables.
    pub about: String,
    /// Its table.
    pub group: Group,
    /// Length, s.
    pub duration_s: f64,
    /// How the device turns and moves.
    pub motion: Motion,
    /// About the vertical or a random axis alone, and how far the axis wobbles, degrees; instead of `motion`.
    pub one_axis: Option<(bool, f64)>,
    /// Shaken; instead of `motion`.
    pub shaken: Option<Shake>,
    /// Strength, uT, and dip, degrees, of the Earth's field.
    pub earth: (f64, f64),
    /// What the place has beside it.
    pub place: Place,
    /// How M and b are drawn.
    pub device: DeviceKind,
    /// When it changes, s: methods are compared from here on.
    pub change_s: f64,
    /// What happens to device and place.
    pub happens: Vec<Happening>,
    /// No sensor delivers anything from `change_s` on for so long, s.
    pub pause_s: Option<f64>,
    /// The sensors and their oddities.
    pub sensors: Sensors,
    /// The calibration of an earlier session is known, right until the device changes.
    pub is_known: bool,
    /// What an earlier launch kept.
    pub kept: Option<Kept>,
    /// `Config::rail_ut`.
    pub rail_ut: Option<f64>,
}

/// What a place has beside the Earth's field while nothing happens, drawn by itself: all else of a stream stays when it changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Nothing: as no real place, or what is told is its unevenness.
    Even,
    /// What rooms have (`Surrounding::room`), between these sideways, uT: [`ROOM_UT`].
    Room,
    /// What is driven past: as large, and as slow for a car as a room for a walker. A guess, not measured.
    Street,
}

impl Place {
    /// Where somebody is who moves like this.
    pub(super) fn of(motion: Motion) -> Self {
        match motion {
            Motion::Drive | Motion::DriveHand => Self::Street,
            _ => Self::Room,
        }
    }
}

/// Sideways, root mean square over a whole room, uT: measured in rooms with cameras was 1.39, the sensor's noise included.
pub const ROOM_UT: (f64, f64) = (1.0, 1.5);
/// A car goes so many times as fast as a walker.
const CAR: f64 = 8.0;

/// A calibration that an earlier launch learned, and what happened since.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kept {
    /// b has changed by so much, in a random direction, uT.
    pub off_ut: f64,
    /// Time since, s.
    pub age_s: u32,
}

/// How M and b are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DeviceKind {
    /// M within 3 to 10 % of 1 on the diagonal and 2 to 7 % beside it; b 20 to 40 uT on each axis.
    Phone,
    /// M within 8 and 5 %; the length of b between these, evenly in its logarithm, uT. Streams of one seed share nothing.
    Carried(f64, f64),
    /// A set of the paper's.
    Set(ParameterSet),
}

impl Variant {
    /// The config with which it is judged: the default with headings of the automatic axis, and what the data say.
    pub fn config(&self) -> Config {
        let heading = HeadingConfig { axis: ReferenceAxis::Auto, ..HeadingConfig::default() };
        Config { heading, rail_ut: self.rail_ut, ..Config::default() }
    }

    /// The same in an even place: what is left there is the estimator's own, not the room's.
    pub fn in_an_even_place(self) -> Self {
        Self { place: Place::Even, ..self }
    }

    /// The stream of a seed.
    pub fn stream(&self, seed: u64) -> Simulation {
        self.scenario(seed).run()
    }

    /// The calibration of an earlier session, where there is one.
    pub fn initial(&self, scenario: &Scenario) -> Option<Calibration> {
        let (start, field_ut) = (scenario.device, scenario.earth_ut.norm());
        let known = || Calibration::new(start.soft_iron, start.hard_iron * field_ut, field_ut).ok();
        self.is_known.then(known).flatten()
    }

    /// What the earlier launch kept, where there was one, and the time of this one, seconds since 1970.
    pub fn kept(&self, scenario: &Scenario) -> Option<(KeptCalibration, i64)> {
        let Kept { off_ut, age_s } = self.kept?;
        let (strength_ut, dip_deg) = self.earth;
        let off_ut = Random::new(scenario.seed, Purpose::EarlierLaunch).direction() * off_ut;
        let hard_iron_ut = scenario.device.hard_iron * strength_ut - off_ut;
        let variance = |k: usize| if k < 3 { LEARNED_UT.powi(2) } else { LEARNED_IRON.powi(2) };
        let covariance: Vec<Vec<f64>> =
            (0..9).map(|i| (0..9).map(|j| if i == j { variance(i) } else { 0.0 }).collect()).collect();
        let text = serde_json::json!({
            "magcomp_calibration": KEPT_VERSION,
            "source": CalibrationSource::Learned,
            "unix_time_s": 0,
            "inclination_deg": dip_deg,
            "soft_iron": scenario.device.soft_iron.as_slice(),
            "hard_iron_ut": hard_iron_ut.as_slice(),
            "field_strength_ut": strength_ut,
            "covariance": covariance,
        });
        KeptCalibration::from_json(&text.to_string()).ok().map(|kept| (kept, i64::from(age_s)))
    }

    /// Everything that makes the stream of a seed.
    pub fn scenario(&self, seed: u64) -> Scenario {
        let seed = if matches!(self.device, DeviceKind::Carried(..)) { seed ^ hash(&self.name) } else { seed };
        let mut random = Random::new(seed, Purpose::Motion);
        let trajectory = match (self.one_axis, self.shaken) {
            (Some((vertical, wobble_deg)), _) => {
                Trajectory::about_one_axis(self.duration_s, vertical, wobble_deg, &mut random)
            }
            (_, Some(shake)) => shake.trajectory(self.duration_s, &mut random),
            _ => self.motion.trajectory(self.duration_s, 1.0 / self.sensors.magnetometer.rate_hz, &mut random),
        };
        let (strength_ut, dip_deg) = self.earth;
        let earth_ut = world_field_ut(strength_ut, dip_deg);
        let mut random = Random::new(seed, Purpose::Parameters);
        let device = self.device.draw(strength_ut, &mut random);
        let mut drawn = Drawn::default();
        let setting = Setting { strength_ut, duration_s: self.duration_s, change_s: self.change_s };
        for happening in &self.happens {
            happening.draw(&setting, &device, &trajectory, &mut random, &mut drawn);
        }
        let longer = match self.place {
            Place::Even => None,
            Place::Room => Some(1.0),
            Place::Street => Some(CAR),
        };
        drawn.surroundings.extend(longer.map(|longer| {
            let mut random = Random::new(seed, Purpose::Room);
            let side_ut = random.uniform(ROOM_UT.0, ROOM_UT.1);
            Surrounding::room(side_ut, longer, self.duration_s, &trajectory, &mut random)
        }));
        let (magnetometer, gyroscope, accelerometer) = self.sensors.draw(&mut Random::new(seed, Purpose::Sensors));
        Scenario {
            seed,
            duration_s: self.duration_s,
            trajectory,
            earth_ut,
            surroundings: drawn.surroundings,
            device,
            device_parts: drawn.device,
            other_changes: drawn.changes,
            magnetometer,
            gyroscope,
            accelerometer,
            pause_s: self.pause_s.map(|for_s| (self.change_s, self.change_s + for_s)),
        }
    }

    /// The same with this noise of the magnetometer.
    pub fn with_noise(mut self, noise: Option<Noise>) -> Self {
        self.sensors.magnetometer.noise = noise.unwrap_or(self.sensors.magnetometer.noise);
        self
    }
}

impl DeviceKind {
    /// M and b, |h| = 1.
    fn draw(self, strength_ut: f64, random: &mut Random) -> Parameters {
        match self {
            Self::Phone => {
                let mut signed = |low, high| random.uniform(low, high) * random.sign();
                let diagonal = [(); 3].map(|()| 1.0 + signed(0.03, 0.10));
                let cross = [(); 3].map(|()| signed(0.02, 0.07));
                let offset = [(); 3].map(|()| signed(20.0, 40.0) / strength_ut);
                let theta = [diagonal, cross, offset].concat();
                Parameters::from_theta(std::array::from_fn(|i| theta[i]))
            }
            Self::Carried(low_ut, high_ut) => {
                let [xx, yy, zz] = [(); 3].map(|()| 1.0 + random.uniform(-0.08, 0.08));
                let [xy, xz, yz] = [(); 3].map(|()| random.uniform(-0.05, 0.05));
                let length_ut = random.uniform(low_ut.ln(), high_ut.ln()).exp();
                Parameters {
                    soft_iron: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
                    hard_iron: random.direction() * (length_ut / strength_ut),
                }
            }
            Self::Set(set) => set.parameters(),
        }
    }
}

/// FNV-1a, so that streams of one seed share nothing between variants.
pub(crate) fn hash(name: &str) -> u64 {
    name.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}
