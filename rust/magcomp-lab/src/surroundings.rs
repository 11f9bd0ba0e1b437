//! Fields besides that of the Earth: of a place, of a door that is passed, of the body of a vehicle.

use crate::course::Course;
use crate::motion::{Trajectory, noise::ease};
use crate::random::Random;
use magcomp::nalgebra::{Rotation3, Vector3};
use std::f64::consts::TAU;

/// Waves of an uneven place, and their lengths, m: the correlation length is a fifth to a quarter of them.
const WAVES: usize = 40;
const LENGTHS_M: (f64, f64) = (4.0, 14.0);
/// Those of a room ([`Surrounding::room`]).
const ROOM_WAVES: usize = 60;
const ROOM_LENGTHS_M: (f64, f64) = (0.6, 14.0);
/// Unevenness comes over this long, s, a vehicle's body over this long.
const COMES_S: f64 = 3.0;
const CLOSES_S: f64 = 2.0;
/// The mean square of an uneven place is taken at points so far apart, s.
const LOOKED_AT_S: f64 = 0.1;

/// A field besides that of the Earth.
#[derive(Clone, Debug, PartialEq)]
pub enum Surrounding {
    /// Another place, or something large that is brought near.
    Shift {
        /// When.
        course: Course,
        /// East-north-up, uT.
        field_ut: Vector3<f64>,
    },
    /// A curl-free random field of the position.
    Uneven {
        /// Waves: wave vector, 1/m, phase, size.
        waves: Vec<(Vector3<f64>, f64, f64)>,
        from_s: f64,
        /// What is taken off everywhere, east-north-up, uT.
        less_ut: Vector3<f64>,
    },
    /// It swings while the device goes on as before: an alternating current nearby.
    Wave {
        /// From when until when, s.
        from_until_s: (f64, f64),
        /// Per second, and phase, rad.
        hz_phase: (f64, f64),
        /// Its amplitude, east-north-up, uT.
        field_ut: Vector3<f64>,
    },
    /// It is another one again and again: girders that are passed.
    Noise {
        /// From when until when, s.
        from_until_s: (f64, f64),
        /// Values a second.
        hz: f64,
        /// Each with its time in the middle, east-north-up, uT.
        fields_ut: Vec<Vector3<f64>>,
    },
    /// Steel that is passed: a dipole that comes, turns and goes.
    Door {
        /// When it is nearest, s.
        at_s: f64,
        /// Half of the time for which it matters, s.
        half_s: f64,
        /// Its moment, so scaled that its largest field is the one asked for.
        moment: Vector3<f64>,
    },
    /// The body of a vehicle around the device: a field that turns with it, less a part of the Earth's that it keeps out.
    Vehicle {
        at_s: f64,
        /// In the vehicle's frame, uT.
        field_ut: Vector3<f64>,
        /// Share of the Earth's field that is kept out.
        shield: f64,
    },
}

impl Surrounding {
    /// A place that is uneven by `rms_ut` along the way of this trajectory, a vector's root mean square.
    pub fn uneven(rms_ut: f64, from_s: f64, duration_s: f64, trajectory: &Trajectory, random: &mut Random) -> Self {
        let mut waves: Vec<_> = (0..WAVES)
            .map(|_| {
                let wave = random.direction() * (TAU / random.uniform(LENGTHS_M.0, LENGTHS_M.1));
                (wave, random.uniform(0.0, TAU), random.normal())
            })
            .collect();
        let points = (duration_s / LOOKED_AT_S) as usize;
        let square = |k: usize| sum(&waves, &trajectory.position(k as f64 * LOOKED_AT_S)).norm_squared();
        let rms = ((0..points).map(square).sum::<f64>() / points.max(1) as f64).sqrt();
        waves.iter_mut().for_each(|(_, _, size)| *size *= rms_ut / rms);
        Self::Uneven { waves, from_s, less_ut: Vector3::zeros() }
    }

    /// What a room has beside the Earth's field: each component has a root mean square of `side_ut` over the whole room, less its mean along the
    /// way of this trajectory, so that north stays. Lengths of its waves are those of a walker's room times `longer`.
    ///
    /// Measured on the 20 quiet walks of the phones of COMPARISON.md (Michel et al.): b, M and a constant field of the place were fitted to a
    /// whole walk by the cameras' attitudes (least squares, robust), the corrected samples turned to the world, their mean taken off, means of
    /// 0.1 s formed. Square to north and level they have 1.39 uT (median; four of five walks 1.03 to 1.97), the sensor's noise included. Variance
    /// between 0.008, 0.03, 0.06, 0.12, 0.25, 0.5, 1 and 2 Hz (medians): 0.12, 0.17, 0.39, 0.37, 0.07, 0.09, 0.07 uT^2; correlation after 0.5, 1, 2 and
    /// 3 s: 0.58, 0.46, 0.18, 0.05. Waves of 0.6 to 14 m, even in the logarithm of the length, their field as its root, crossed at 1.3 m/s, have in
    /// the same way 0.15, 0.25, 0.45, 0.39, 0.21, 0.10, 0.04 and 0.78, 0.52, 0.20, 0.02, with 1.3 uT sideways.
    pub fn room(side_ut: f64, longer: f64, duration_s: f64, trajectory: &Trajectory, random: &mut Random) -> Self {
        let mut waves: Vec<_> = (0..ROOM_WAVES)
            .map(|_| {
                let (least_m, most_m) = ROOM_LENGTHS_M;
                let long_m = least_m * (most_m / least_m).powf(random.uniform(0.0, 1.0));
                let wave = random.direction() * (TAU / (long_m * longer));
                (wave, random.uniform(0.0, TAU), random.normal() * long_m.powf(1.5))
            })
            .collect();
        let square = waves.iter().map(|(wave, _, size)| wave.norm_squared() * size * size / 2.0).sum::<f64>();
        waves.iter_mut().for_each(|(_, _, size)| *size *= side_ut * (3.0 / square).sqrt());
        let points = (duration_s / LOOKED_AT_S) as usize;
        let along = |k: usize| sum(&waves, &trajectory.position(k as f64 * LOOKED_AT_S));
        let less_ut = (0..points).map(along).sum::<Vector3<f64>>() / points.max(1) as f64;
        Self::Uneven { waves, from_s: f64::NEG_INFINITY, less_ut }
    }

    /// A door that is passed at `at_s`, its largest field `size_ut`.
    pub fn door(at_s: f64, size_ut: f64, for_s: f64, random: &mut Random) -> Self {
        let moment = random.direction();
        let largest = along().map(|along| door(&moment, along).norm()).fold(0.0, f64::max);
        Self::Door { at_s, half_s: for_s / 2.0, moment: moment * (size_ut / largest) }
    }

    /// A board with magnets that is passed at `at_s`: its field is beyond half of its largest, `size_ut`, for `wide_s`.
    pub fn board(at_s: f64, size_ut: f64, wide_s: f64, random: &mut Random) -> Self {
        let moment = random.direction();
        let sizes = || along().map(|along| (along, door(&moment, along).norm()));
        let largest = sizes().map(|(_, size)| size).fold(0.0, f64::max);
        let beyond = || sizes().filter(|(_, size)| *size > largest / 2.0).map(|(along, _)| along);
        let wide = beyond().fold(f64::MIN, f64::max) - beyond().fold(f64::MAX, f64::min);
        Self::Door { at_s, half_s: wide_s / wide, moment: moment * (size_ut / largest) }
    }

    /// `hz` values a second, each component of this root mean square, from when until when, s.
    pub fn noise(rms_ut: f64, hz: f64, from_until_s: (f64, f64), random: &mut Random) -> Self {
        let count = ((from_until_s.1 - from_until_s.0) * hz).ceil() as usize + 1;
        Self::Noise { from_until_s, hz, fields_ut: (0..count).map(|_| random.normal3() * rms_ut).collect() }
    }

    /// What it adds at a time, s, east-north-up, uT.
    pub fn at(&self, time_s: f64, trajectory: &Trajectory, earth_ut: &Vector3<f64>) -> Vector3<f64> {
        match self {
            Self::Shift { course, field_ut } => field_ut * course.at(time_s),
            Self::Uneven { waves, from_s, less_ut } => {
                let share = ease((time_s - from_s) / COMES_S);
                let field_ut = || sum(waves, &trajectory.position(time_s)) - less_ut;
                if share > 0.0 { field_ut() * share } else { Vector3::zeros() }
            }
            Self::Wave { from_until_s: (from_s, until_s), hz_phase: (hz, phase), field_ut } => {
                let is_there = (*from_s..*until_s).contains(&time_s);
                if is_there { field_ut * (TAU * hz * time_s + phase).sin() } else { Vector3::zeros() }
            }
            Self::Noise { from_until_s: (from_s, until_s), hz, fields_ut } => {
                let is_there = (*from_s..*until_s).contains(&time_s);
                let at = ((time_s - from_s) * hz).round().max(0.0) as usize;
                fields_ut.get(at).copied().filter(|_| is_there).unwrap_or_default()
            }
            Self::Door { at_s, half_s, moment } => door(moment, (time_s - at_s) / half_s),
            Self::Vehicle { at_s, field_ut, shield } => {
                let turned = Rotation3::from_axis_angle(&Vector3::z_axis(), trajectory.vehicle_yaw(time_s)) * field_ut;
                (turned - earth_ut * *shield) * ease((time_s - at_s) / CLOSES_S)
            }
        }
    }
}

fn sum(waves: &[(Vector3<f64>, f64, f64)], position: &Vector3<f64>) -> Vector3<f64> {
    waves.iter().map(|(wave, phase, size)| wave * (size * (wave.dot(position) + phase).cos())).sum()
}

/// The way past a door, half of the time for which it matters being 1.
fn along() -> impl Iterator<Item = f64> {
    (-400..=400).map(|k| f64::from(k) * 0.01)
}

/// Field of a door's moment, `along` from where it is nearest.
fn door(moment: &Vector3<f64>, along: f64) -> Vector3<f64> {
    let r = Vector3::new(along, 0.8, 0.3);
    let distance = r.norm();
    r * (3.0 * r.dot(moment) / distance.powi(5)) - moment / distance.powi(3)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::Motion;
    use crate::random::Purpose;

    /// Along 20 walks of two minutes: the variance in octaves and what is correlated after seconds, as it was measured (medians).
    #[test]
    fn a_room_has_the_spectrum_along_a_walk_that_was_measured() {
        const HZ: f64 = 10.0;
        const COUNT: usize = 1200;
        let (mut bands, mut correlations, mut sizes): (Vec<[f64; 6]>, Vec<[f64; 4]>, Vec<f64>) = Default::default();
        for seed in 0..20 {
            let random = &mut Random::new(seed, Purpose::Room);
            let walk = Motion::Text.trajectory(120.0, 0.01, random);
            let room = Surrounding::room(1.3, 1.0, 120.0, &walk, random);
            let side = |k: usize| room.at(k as f64 / HZ, &walk, &Vector3::zeros()).x;
            let side: Vec<f64> = (0..COUNT).map(side).collect();
            let square = side.iter().map(|v| v * v).sum::<f64>() / COUNT as f64;
            sizes.push(square.sqrt());
            let power = |k: usize| {
                let phase = |n: usize| TAU * (k * n % COUNT) as f64 / COUNT as f64;
                let part = |of: fn(f64) -> f64| side.iter().enumerate().map(|(n, v)| v * of(phase(n))).sum::<f64>();
                2.0 * (part(f64::sin).powi(2) + part(f64::cos).powi(2)) / (COUNT * COUNT) as f64
            };
            let limits_hz = [0.008, 0.06, 0.12, 0.25, 0.5, 1.0, 2.0];
            bands.push(std::array::from_fn(|band| {
                let at = |hz: f64| (hz * COUNT as f64 / HZ).ceil() as usize;
                (at(limits_hz[band])..at(limits_hz[band + 1])).map(power).sum::<f64>()
            }));
            correlations.push([5, 10, 20, 30].map(|lag| {
                side[lag..].iter().zip(&side).map(|(a, b)| a * b).sum::<f64>() / square / (COUNT - lag) as f64
            }));
        }
        let middle = |values: Vec<f64>| magcomp_replay::statistics::median(values).unwrap();
        let is_within = |what: &str, found: f64, least: f64, most: f64| {
            assert!((least..=most).contains(&found), "{what}: {found}, not {least} to {most}");
        };
        is_within("uT", middle(sizes), 1.1, 1.5);
        // measured: 0.29, 0.39, 0.37, 0.07, 0.09, 0.07 uT^2, the last two with the sensor's noise
        for (k, (least, most)) in
            [(0.2, 0.6), (0.25, 0.65), (0.25, 0.55), (0.1, 0.35), (0.04, 0.2), (0.01, 0.1)].into_iter().enumerate()
        {
            is_within("band", middle(bands.iter().map(|it| it[k]).collect()), least, most);
        }
        // measured: 0.58, 0.46, 0.18, 0.05
        for (k, (least, most)) in [(0.55, 0.85), (0.35, 0.65), (0.05, 0.35), (-0.15, 0.2)].into_iter().enumerate() {
            is_within("correlation", middle(correlations.iter().map(|it| it[k]).collect()), least, most);
        }
    }

    #[test]
    fn fields_come_after_their_start_and_are_as_large_as_they_say() {
        let earth = Vector3::new(0.0, 25.0, -43.0);
        for seed in 0..3 {
            let random = &mut Random::new(seed, Purpose::Motion);
            let walk = Motion::Text.trajectory(60.0, 0.01, random);
            let sizes = |what: &Surrounding, from: u32, to: u32| {
                (from..to).map(|k| what.at(f64::from(k) * 0.1, &walk, &earth).norm()).collect::<Vec<_>>()
            };
            let largest = |sizes: &[f64]| sizes.iter().copied().fold(0.0, f64::max);
            let door = Surrounding::door(30.0, 25.0, 2.0, random);
            assert!((largest(&sizes(&door, 290, 310)) - 25.0).abs() < 0.5);
            assert!(largest(&sizes(&door, 0, 250)) < 1.0);
            let board = Surrounding::board(30.0, 120.0, 0.8, random);
            let sizes_ut: Vec<f64> = (0..60_000).map(|k| board.at(f64::from(k) * 1e-3, &walk, &earth).norm()).collect();
            assert!((largest(&sizes_ut) - 120.0).abs() < 0.5);
            let beyond = |k: &usize| sizes_ut[*k] > 60.0;
            let (first, last) = ((0..60_000).find(beyond).unwrap(), (0..60_000).rfind(beyond).unwrap());
            assert!((790..=810).contains(&(last - first)), "{} ms", last - first);
            let uneven = Surrounding::uneven(5.0, 20.0, 60.0, &walk, random);
            assert_eq!(largest(&sizes(&uneven, 0, 200)), 0.0);
            let square = sizes(&uneven, 230, 600).iter().map(|size| size * size).sum::<f64>() / 370.0;
            assert!((3.5..6.5).contains(&square.sqrt()), "{square}");
            // curl-free: a closed way has no work, which for a sum of waves along their own direction is exact; here by its slopes
            let Surrounding::Uneven { waves, .. } = &uneven else { panic!("uneven") };
            let at = |x, y| sum(waves, &Vector3::new(x, y, 1.0));
            let curl = (at(1.0001, 1.0).y - at(1.0, 1.0).y) - (at(1.0, 1.0001).x - at(1.0, 1.0).x);
            assert!(curl.abs() < 1e-6, "{curl}");
            let car = Motion::Drive.trajectory(60.0, 0.01, random);
            let body = Surrounding::Vehicle { at_s: 30.0, field_ut: Vector3::x() * 30.0, shield: 0.0 };
            let field = |time_s| body.at(time_s, &car, &earth);
            assert!(field(29.0).norm() == 0.0 && (field(40.0).norm() - 30.0).abs() < 1e-9);
            let turned = field(58.0).angle(&field(40.0));
            let yaw = (car.vehicle_yaw(58.0) - car.vehicle_yaw(40.0))
                .sin()
                .atan2((car.vehicle_yaw(58.0) - car.vehicle_yaw(40.0)).cos());
            assert!((turned - yaw.abs()).abs() < 1e-6, "{turned} {yaw}");
        }
    }
}
