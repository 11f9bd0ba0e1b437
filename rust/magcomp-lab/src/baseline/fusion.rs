//! A fusion of little cost, after the idea of the paper's [4]: the gyroscope bridges the errors of the magnetometer. The text of
//! [4] was not at hand, so the equations are ours:
//!     u, m <- dR u, dR m                          the gyroscope turns up and field, dR = exp(-w dt)
//!     u <- u + (a - u) dt / 1 s                   the accelerometer levels
//!     m <- m + (h_m - b - m) dt / 2 s             the magnetometer points
//!     b <- b + mu A^T e / (4 sin^2(angle/2))      after each turn by 20 degrees; A = I - dR, e = h_m - dR h_m' - A b
//! The last line is normalised least mean squares on b alone: (h_m - b) is fixed in the world. M is taken for I.

use super::method::Baseline;
use magcomp::nalgebra::{Matrix3, Rotation3, Vector3};
use magcomp::{MagneticSample, RotationRateSample, UpSample};

const LEVEL_S: f64 = 1.0;
const POINT_S: f64 = 2.0;
const TURN_RAD: f64 = 20.0 * std::f64::consts::PI / 180.0;
/// A longer pause of the gyroscope starts anew, s.
const PAUSE_S: f64 = 0.5;

/// The fusion's state.
#[derive(Clone, Debug, Default)]
pub struct Fusion {
    rate: f64,
    up: Option<Vector3<f64>>,
    field_ut: Option<Vector3<f64>>,
    hard_iron_ut: Vector3<f64>,
    /// The raw sample before the turn, and the turn since then.
    before: Option<(Vector3<f64>, Rotation3<f64>)>,
    /// Times of the latest events of gyroscope, accelerometer and magnetometer, ns.
    latest_ns: [Option<i64>; 3],
    stepped: bool,
}

impl Fusion {
    /// With mu, 0 to 1.
    pub fn new(rate: f64) -> Self {
        Self { rate, ..Self::default() }
    }

    /// Seconds since the event of this sensor before.
    fn since_s(&mut self, sensor: usize, time_ns: i64) -> Option<f64> {
        self.latest_ns[sensor].replace(time_ns).map(|before| (time_ns - before) as f64 / 1e9).filter(|s| *s > 0.0)
    }
}

/// Draws `state` towards `value`; the first value is taken as it is.
fn follow(state: &mut Option<Vector3<f64>>, value: Vector3<f64>, share: f64) {
    *state = Some(state.map_or(value, |state| state + (value - state) * share.min(1.0)));
}

impl Baseline for Fusion {
    fn push_rate(&mut self, sample: &RotationRateSample) {
        let Some(dt_s) = self.since_s(0, sample.time_ns) else { return };
        if dt_s > PAUSE_S {
            (self.up, self.field_ut, self.before) = (None, None, None);
            return;
        }
        let turn = Rotation3::new(-sample.rate_rad_s * dt_s);
        self.up = self.up.map(|up| turn * up);
        self.field_ut = self.field_ut.map(|field| turn * field);
        self.before = self.before.map(|(raw, since)| (raw, turn * since));
    }

    fn push_up(&mut self, sample: &UpSample) {
        let dt_s = self.since_s(1, sample.time_ns).unwrap_or(0.0);
        follow(&mut self.up, sample.up_m_s2, dt_s / LEVEL_S);
    }

    fn push(&mut self, sample: &MagneticSample) {
        let dt_s = self.since_s(2, sample.time_ns).unwrap_or(0.0);
        let raw_ut = sample.field_ut;
        let (before_ut, turn) = *self.before.get_or_insert((raw_ut, Rotation3::identity()));
        if turn.angle() > TURN_RAD {
            let lever = Matrix3::identity() - turn.matrix();
            let error_ut = raw_ut - turn * before_ut - lever * self.hard_iron_ut;
            let size = 4.0 * (turn.angle() / 2.0).sin().powi(2);
            self.hard_iron_ut += lever.transpose() * error_ut * (self.rate / size);
            self.before = Some((raw_ut, Rotation3::identity()));
            self.stepped = true;
        }
        follow(&mut self.field_ut, raw_ut - self.hard_iron_ut, dt_s / POINT_S);
    }

    fn correct(&self, _: &Vector3<f64>) -> Option<Vector3<f64>> {
        let up = self.up.filter(|_| self.stepped)?.try_normalize(1e-6)?;
        let field = self.field_ut?;
        (field - up * field.dot(&up)).try_normalize(1e-6)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalogue::find;

    #[test]
    fn it_finds_the_hard_iron_of_a_turning_device_and_its_north() {
        let mut scenario = find("phone-steady").unwrap().in_an_even_place().scenario(1);
        scenario.device.soft_iron = Matrix3::identity();
        let stream = scenario.run();
        let mut fusion = Fusion::new(0.3);
        for k in 0..stream.magnetic.len() {
            fusion.push_rate(&stream.rotation_rates[k]);
            fusion.push_up(&stream.ups[k]);
            fusion.push(&stream.magnetic[k]);
        }
        let truth = stream.truth.last().unwrap();
        let off_ut = (fusion.hard_iron_ut - truth.hard_iron_ut).norm();
        assert!(off_ut < 3.0, "{off_ut}");
        let north = truth.attitude * fusion.correct(&truth.clean_ut).unwrap();
        assert!(north.y > 0.99, "{north:?}");
    }
}
