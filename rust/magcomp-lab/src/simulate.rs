//! The simulator: h_m = M h + b + w (eq. 8 with white noise), the truth kept beside every sample.
//!
//! A scenario and its seed name a stream bit for bit. M, b, the place's field and the motion change on courses of their own, so that the
//! truth shows whether the device or the place has changed.

use crate::course::{Course, DevicePart};
use crate::inertial::InertialSensor;
pub use crate::magnetometer::{Filled, Magnetometer, Noise, Spikes};
use crate::motion::Trajectory;
use crate::parameters::Parameters;
use crate::random::{Purpose, Random};
use crate::surroundings::Surrounding;
use magcomp::nalgebra::{Matrix3, UnitQuaternion, Vector3};
use magcomp::{MagneticSample, RotationRateSample, UpSample};
use magcomp_recordings::recording::{Inertial, Recording, Row};
use magcomp_recordings::time::time_ns;
use std::path::PathBuf;

/// Samples whose stamps are nearer than this are one, s.
const APART_S: f64 = 1e-4;

/// Everything that makes a stream.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// Names the random numbers of the sensors' noise.
    pub seed: u64,
    /// Length, s.
    pub duration_s: f64,
    /// How the device turns and moves.
    pub trajectory: Trajectory,
    /// The Earth's field, uT, east-north-up. Its strength is the unit of `device`.
    pub earth_ut: Vector3<f64>,
    /// Fields besides it.
    pub surroundings: Vec<Surrounding>,
    /// M and b at the start.
    pub device: Parameters,
    /// What comes and goes.
    pub device_parts: Vec<DevicePart>,
    /// Changes that `device_parts` do not tell.
    pub other_changes: Vec<Change>,
    /// The magnetometer.
    pub magnetometer: Magnetometer,
    /// The gyroscope, if there is one.
    pub gyroscope: Option<InertialSensor>,
    /// The accelerometer, if there is one.
    pub accelerometer: Option<InertialSensor>,
    /// No sensor delivers anything from then on, until then, s.
    pub pause_s: Option<(f64, f64)>,
}

/// A field of this strength (uT) and dip (degrees, positive down) towards magnetic north, east-north-up.
pub fn world_field_ut(strength_ut: f64, dip_deg: f64) -> Vector3<f64> {
    let (down, north) = dip_deg.to_radians().sin_cos();
    Vector3::new(0.0, north, -down) * strength_ut
}

/// The truth at the time of a magnetometer sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truth {
    /// The field in the device frame at the time of the stamp, h, uT.
    pub field_ut: Vector3<f64>,
    /// The same when it was measured: `clean_ut` is of this one.
    pub measured_ut: Vector3<f64>,
    /// M.
    pub soft_iron: Matrix3<f64>,
    /// b, uT.
    pub hard_iron_ut: Vector3<f64>,
    /// M h + b, uT: the raw sample without noise and spikes.
    pub clean_ut: Vector3<f64>,
    /// Device to east-north-up at the time of the stamp.
    pub attitude: UnitQuaternion<f64>,
    /// Whether a spike hit.
    pub spike: bool,
}

/// A change, as the truth tells it.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Change {
    /// s.
    pub begins_s: f64,
    /// s.
    pub ends_s: f64,
    /// Of b, uT.
    pub size_ut: f64,
    /// What changed.
    pub kind: ChangeKind,
}

/// What changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub enum ChangeKind {
    /// The device.
    Device,
    /// The device, while no sensor saw it: a step may be declared, and need not be.
    Unseen,
    /// A vehicle closed around it: no step of the device.
    Vehicle,
}

/// A stream and its truth.
#[derive(Clone, Debug, PartialEq)]
pub struct Simulation {
    /// Samples of the magnetometer.
    pub magnetic: Vec<MagneticSample>,
    /// The truth behind each of them.
    pub truth: Vec<Truth>,
    /// Events of the gyroscope; empty without one.
    pub rotation_rates: Vec<RotationRateSample>,
    /// Events of the accelerometer; empty without one.
    pub ups: Vec<UpSample>,
    /// The Earth's field, east-north-up, uT.
    pub earth_ut: Vector3<f64>,
    /// Samples of the magnetometer a second.
    pub rate_hz: f64,
    /// Changes, in order.
    pub changes: Vec<Change>,
}

impl Scenario {
    /// M and b at a time, s: b in uT.
    pub fn device_at(&self, time_s: f64) -> (Matrix3<f64>, Vector3<f64>) {
        let start = (self.device.soft_iron, self.device.hard_iron * self.earth_ut.norm());
        self.device_parts.iter().map(|part| part.at(time_s)).fold(start, |(m, b), (dm, db)| (m + dm, b + db))
    }

    /// The field at a time, s, east-north-up, uT.
    pub fn world_at(&self, time_s: f64) -> Vector3<f64> {
        let besides = self.surroundings.iter().map(|it| it.at(time_s, &self.trajectory, &self.earth_ut));
        self.earth_ut + besides.sum::<Vector3<f64>>()
    }

    /// The stream this scenario names.
    pub fn run(&self) -> Simulation {
        let random = |purpose| Random::new(self.seed, purpose);
        let (magnetic, truth) = self.magnetic();
        let (trajectory, duration_s) = (&self.trajectory, self.duration_s);
        let rotation_rates = self.gyroscope.map_or_else(Vec::new, |sensor| {
            sensor.rotation_rates(trajectory, duration_s, &mut random(Purpose::GyroscopeNoise))
        });
        let ups = self.accelerometer.map_or_else(Vec::new, |sensor| {
            sensor.ups(trajectory, duration_s, &mut random(Purpose::AccelerometerNoise))
        });
        let mut simulation = Simulation {
            magnetic,
            truth,
            rotation_rates,
            ups,
            earth_ut: self.earth_ut,
            rate_hz: self.magnetometer.rate_hz,
            changes: self.changes(),
        };
        if let Some((from_s, until_s)) = self.pause_s {
            simulation.pause(from_s, until_s);
        }
        simulation
    }

    /// Every magnetometer sample and its truth.
    fn magnetic(&self) -> (Vec<MagneticSample>, Vec<Truth>) {
        let random = |purpose| Random::new(self.seed, purpose);
        let (mut noise, mut spikes, mut timing) =
            (random(Purpose::MagnetometerNoise), random(Purpose::Spikes), random(Purpose::Timing));
        let sensor = &self.magnetometer;
        let sigma_ut = sensor.noise.sigma_ut(self.earth_ut.norm());
        let count = (self.duration_s * sensor.rate_hz).round() as usize;
        let (mut magnetic, mut truth) = (Vec::with_capacity(count), Vec::with_capacity(count));
        let mut latest_s = f64::NEG_INFINITY;
        for k in 0..count {
            let measured_s = k as f64 / sensor.rate_hz;
            let (missed, jitter) = (timing.uniform(0.0, 1.0), timing.uniform(0.0, 1.0));
            let stamped_s = measured_s + sensor.late_s + jitter * sensor.jitter_s;
            let is_inside = (0.0..self.duration_s).contains(&stamped_s);
            if missed < sensor.missing || stamped_s - latest_s <= APART_S || !is_inside {
                continue;
            }
            latest_s = stamped_s;
            let attitude = self.trajectory.at(stamped_s).0;
            let field = |time_s: f64| self.trajectory.at(time_s).0.inverse() * self.world_at(time_s);
            let (field_ut, measured_ut) = (field(stamped_s), field(measured_s));
            let (soft_iron, hard_iron_ut) = self.device_at(measured_s);
            let soft_iron = sensor.axes * soft_iron;
            let mut clean_ut = soft_iron * measured_ut + hard_iron_ut;
            if let Some(limits) = sensor.soft_limits_ut {
                clean_ut = clean_ut.zip_map(&limits, |v, limit| limit * (v / limit).tanh());
            }
            let mut raw_ut = clean_ut + noise.normal3() * sigma_ut;
            let mut spike = false;
            if let Some(Spikes { share, size_ut: (low, high) }) = sensor.spikes {
                // always three draws, so that the share does not change where the others fall
                let (hit, size, direction) = (spikes.uniform(0.0, 1.0), spikes.uniform(low, high), spikes.direction());
                spike = hit < share;
                raw_ut += direction * if spike { size } else { 0.0 };
            }
            if sensor.quantum_ut > 0.0 {
                raw_ut = raw_ut.map(|v| (v / sensor.quantum_ut).round() * sensor.quantum_ut);
            }
            if let Some(limit) = sensor.full_scale_ut {
                raw_ut = raw_ut.map(|v| v.clamp(-limit, limit));
            }
            if sensor.is_mixed && k % 2 == 1 {
                (raw_ut, clean_ut) = (raw_ut - hard_iron_ut, clean_ut - hard_iron_ut);
            }
            let read = |v: Vector3<f64>| sensor.read_as * v;
            let (raw_ut, clean_ut) = (read(raw_ut), read(clean_ut));
            let (soft_iron, hard_iron_ut) = (sensor.read_as * soft_iron, read(hard_iron_ut));
            magnetic.push(MagneticSample { time_ns: time_ns(stamped_s), field_ut: raw_ut });
            truth.push(Truth { field_ut, measured_ut, soft_iron, hard_iron_ut, clean_ut, attitude, spike });
        }
        if let Some(filled) = sensor.filled {
            filled.fill(&mut magnetic);
        }
        (magnetic, truth)
    }

    /// What the parts of the device do, and the others, in order.
    fn changes(&self) -> Vec<Change> {
        let mut changes = self.other_changes.clone();
        for part in &self.device_parts {
            if let Course::Held { at_s, over_s, until_s } = part.course {
                let size_ut = part.hard_iron_ut.norm();
                let change =
                    |begins_s| Change { begins_s, ends_s: begins_s + over_s, size_ut, kind: ChangeKind::Device };
                changes.extend([Some(at_s), until_s].into_iter().flatten().map(change));
            }
        }
        // a change beyond the full scale is not seen whole
        let full_scale_ut = self.magnetometer.full_scale_ut.unwrap_or(f64::INFINITY);
        let unseen =
            |change: &Change| self.pause_s.is_some_and(|(from_s, to_s)| (from_s..to_s).contains(&change.begins_s));
        changes
            .iter_mut()
            .filter(|change| unseen(change) || change.size_ut >= full_scale_ut)
            .for_each(|change| change.kind = ChangeKind::Unseen);
        changes.sort_by(|a, b| a.begins_s.total_cmp(&b.begins_s));
        changes
    }
}

impl Simulation {
    /// It as a recording, with the truth that a reference would give: each sensor's events at their own times. Events behind the
    /// last sample are left out.
    pub fn recording(&self, name: &str) -> Recording {
        let (mut rates, mut ups) = (self.rotation_rates.iter().peekable(), self.ups.iter().peekable());
        let samples = self.magnetic.iter().zip(&self.truth);
        let rows = samples.map(|(sample, truth)| {
            let mut events = Vec::new();
            loop {
                let next_ns = [rates.peek().map(|event| event.time_ns), ups.peek().map(|event| event.time_ns)];
                let Some(time_ns) = next_ns.into_iter().flatten().min().filter(|time| *time <= sample.time_ns) else {
                    break;
                };
                events.push(Inertial {
                    time_ns,
                    rate_rad_s: rates.next_if(|event| event.time_ns == time_ns).map(|event| event.rate_rad_s),
                    up_m_s2: ups.next_if(|event| event.time_ns == time_ns).map(|event| event.up_m_s2),
                    course: None,
                });
            }
            let now = events.pop_if(|event| event.time_ns == sample.time_ns);
            Row {
                time_s: sample.time_ns as f64 / 1e9,
                time_ns: sample.time_ns,
                field_ut: sample.field_ut,
                before: events,
                up_m_s2: now.and_then(|event| event.up_m_s2),
                rate_rad_s: now.and_then(|event| event.rate_rad_s),
                attitude: Some(truth.attitude),
                hard_iron_ut: Some(truth.hard_iron_ut),
                ..Row::default()
            }
        });
        Recording { path: PathBuf::from(name), rows: rows.collect() }
    }

    /// Removes the events of every sensor between two times, s.
    fn pause(&mut self, from_s: f64, until_s: f64) {
        let is_gone = |at_ns: i64| (time_ns(from_s)..time_ns(until_s)).contains(&at_ns);
        let mut times = self.magnetic.iter().map(|sample| sample.time_ns);
        self.truth.retain(|_| times.next().is_some_and(|at_ns| !is_gone(at_ns)));
        drop(times);
        self.magnetic.retain(|sample| !is_gone(sample.time_ns));
        self.rotation_rates.retain(|event| !is_gone(event.time_ns));
        self.ups.retain(|event| !is_gone(event.time_ns));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::Motion;

    fn scenario() -> Scenario {
        let mut random = Random::new(7, Purpose::Motion);
        let other_place = world_field_ut(45.0, 50.0) - world_field_ut(50.0, 60.0);
        let stronger = DevicePart {
            soft_iron: Matrix3::identity() * 0.5,
            ..DevicePart::offset(Course::step(5.0), Vector3::zeros())
        };
        Scenario {
            seed: 7,
            duration_s: 20.0,
            trajectory: Motion::Tumble.trajectory(20.0, 0.01, &mut random),
            earth_ut: world_field_ut(50.0, 60.0),
            surroundings: vec![Surrounding::Shift {
                course: Course::Even { from_s: 10.0, over_s: 2.0 },
                field_ut: other_place,
            }],
            device: Parameters::none(),
            device_parts: vec![stronger],
            other_changes: Vec::new(),
            magnetometer: Magnetometer {
                spikes: Some(Spikes { share: 0.02, size_ut: (30.0, 150.0) }),
                ..Magnetometer::plain(100.0, Noise::SnrDb(40.0))
            },
            gyroscope: Some(InertialSensor { rate_hz: 200.0, ..InertialSensor::gyroscope() }),
            accelerometer: Some(InertialSensor::accelerometer()),
            pause_s: None,
        }
    }

    fn with(change: impl Fn(&mut Magnetometer)) -> Simulation {
        let mut scenario = scenario();
        change(&mut scenario.magnetometer);
        scenario.run()
    }

    #[test]
    fn the_same_seed_gives_the_same_bits() {
        assert_eq!(scenario().run(), scenario().run());
        assert_ne!(Scenario { seed: 8, ..scenario() }.run().magnetic, scenario().run().magnetic);
    }

    #[test]
    fn noise_and_spikes_are_as_asked() {
        let stream = scenario().run();
        let (mut squares, mut spikes) = (0.0, 0);
        for (sample, truth) in stream.magnetic.iter().zip(&stream.truth) {
            let off = (sample.field_ut - truth.clean_ut).norm();
            if truth.spike {
                spikes += 1;
                assert!((25.0..155.0).contains(&off));
            } else {
                squares += off * off / 3.0;
            }
        }
        assert!((20..=60).contains(&spikes), "{spikes} spikes");
        let sigma = (squares / f64::from(2000 - spikes)).sqrt();
        assert!((sigma / 0.5 - 1.0).abs() < 0.05, "noise {sigma} uT");
    }

    #[test]
    fn the_place_changes_without_the_device() {
        let stream = scenario().run();
        let truth = &stream.truth;
        assert!((truth[999].field_ut.norm() - 50.0).abs() < 1e-9);
        assert!((truth[1300].field_ut.norm() - 45.0).abs() < 1e-9);
        assert_eq!(truth[999].soft_iron, truth[1300].soft_iron);
        assert!(truth[499].soft_iron == Matrix3::identity() && truth[500].soft_iron == Matrix3::identity() * 1.5);
        assert_eq!(stream.changes.len(), 1);
    }

    #[test]
    fn a_delayed_gyroscope_reports_the_past() {
        let late = InertialSensor { delay_s: 0.05, noise: 0.0, ..InertialSensor::gyroscope() };
        let prompt = InertialSensor { delay_s: 0.0, ..late };
        let run = |sensor| Scenario { gyroscope: Some(sensor), ..scenario() }.run().rotation_rates;
        let (late, prompt) = (run(late), run(prompt));
        assert!((late[105].rate_rad_s - prompt[100].rate_rad_s).norm() < 1e-2);
        assert_eq!(late[105].time_ns, 1_050_000_000);
    }

    #[test]
    fn a_late_sample_tells_of_the_field_before_its_stamp() {
        let stream = with(|sensor| sensor.late_s = 0.02);
        let plain = scenario().run();
        // the same measurements, two samples later
        assert_eq!(stream.magnetic[100].time_ns, 1_020_000_000);
        assert!((stream.truth[100].measured_ut - plain.truth[100].field_ut).norm() < 1e-9);
        assert!((stream.truth[100].field_ut - plain.truth[102].field_ut).norm() < 1e-9);
    }

    #[test]
    fn samples_go_missing_come_in_steps_and_are_cut_off() {
        let count = with(|sensor| sensor.missing = 0.1).magnetic.len() as f64;
        // binomial: 1800 +- 13
        assert!((count - 1800.0).abs() < 50.0, "{count}");
        let stream = with(|sensor| sensor.quantum_ut = 0.6);
        let off = |v: &f64| (v / 0.6 - (v / 0.6).round()).abs();
        assert!(stream.magnetic.iter().all(|sample| sample.field_ut.iter().all(|v| off(v) < 1e-9)));
        let cut = with(|sensor| sensor.full_scale_ut = Some(30.0));
        assert!(cut.magnetic.iter().all(|sample| sample.field_ut.amax() <= 30.0));
        let stamps = with(|sensor| sensor.jitter_s = 0.005).magnetic;
        assert!(stamps.windows(2).all(|pair| pair[1].time_ns - pair[0].time_ns > 100_000));
    }

    #[test]
    fn no_sensor_speaks_in_a_pause_and_the_truth_stays_with_its_sample() {
        let offset = DevicePart::offset(Course::step(9.0), Vector3::x() * 20.0);
        let stream = Scenario { pause_s: Some((8.0, 10.0)), device_parts: vec![offset], ..scenario() }.run();
        let gap_s = |times: Vec<i64>| times.windows(2).map(|pair| (pair[1] - pair[0]) as f64 / 1e9).fold(0.0, f64::max);
        for times in [
            stream.magnetic.iter().map(|sample| sample.time_ns).collect(),
            stream.rotation_rates.iter().map(|event| event.time_ns).collect(),
            stream.ups.iter().map(|event| event.time_ns).collect::<Vec<_>>(),
        ] {
            assert!((gap_s(times) - 2.0).abs() < 0.02);
        }
        assert_eq!(stream.magnetic.len(), stream.truth.len());
        let off = stream.magnetic.iter().zip(&stream.truth).filter(|(_, truth)| !truth.spike);
        assert!(off.map(|(raw, truth)| (raw.field_ut - truth.clean_ut).norm()).fold(0.0, f64::max) < 4.0);
        assert_eq!(stream.changes[0].kind, ChangeKind::Unseen);
    }
}
