//! A trajectory: attitude and body rate at any time, laid out on a grid with the rate constant in between.

use magcomp::nalgebra::{UnitQuaternion, Vector3};

/// Grid of the smooth motions, s.
pub(super) const GRID_S: f64 = 1e-3;

/// Attitude and body rate over time, and for people and cars the acceleration and the way.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trajectory {
    pub(super) step_s: f64,
    pub(super) attitudes: Vec<UnitQuaternion<f64>>,
    pub(super) rates_rad_s: Vec<Vector3<f64>>,
    /// Besides gravity, east-north-up; empty where the device only turns.
    pub(super) acceleration_m_s2: Vec<Vector3<f64>>,
    /// East-north-up; empty where the device stays in its place.
    pub(super) positions_m: Vec<Vector3<f64>>,
    /// Yaw of the vehicle, rad, counter-clockwise from north; empty without one.
    pub(super) vehicle_yaw: Vec<f64>,
    /// When it is picked up from a table, and laid down again, s.
    pub picked_up_s: Vec<(f64, f64)>,
}

impl Trajectory {
    /// Attitude (device to east-north-up) and body rate (rad/s, device frame) at a time, s; held beyond both ends.
    pub fn at(&self, time_s: f64) -> (UnitQuaternion<f64>, Vector3<f64>) {
        let (k, share) = self.point(time_s);
        let rate = self.rates_rad_s[k];
        (self.attitudes[k] * UnitQuaternion::from_scaled_axis(rate * (share * self.step_s)), rate)
    }

    /// The body rate that a gyroscope reads, rad/s. For people: the mean over one step of the grid, since their grid is coarse.
    pub fn rate_read(&self, time_s: f64) -> Vector3<f64> {
        if self.acceleration_m_s2.is_empty() {
            return self.at(time_s).1;
        }
        let [before, after] = [-0.5, 0.5].map(|steps| self.at(time_s + steps * self.step_s).0);
        (before.inverse() * after).scaled_axis() / self.step_s
    }

    /// Acceleration besides gravity, east-north-up, m/s^2.
    pub fn acceleration(&self, time_s: f64) -> Vector3<f64> {
        self.between(&self.acceleration_m_s2, time_s, |from, to, share| from.lerp(&to, share))
    }

    /// Where the device is, east-north-up, m.
    pub fn position(&self, time_s: f64) -> Vector3<f64> {
        self.between(&self.positions_m, time_s, |from, to, share| from.lerp(&to, share))
    }

    /// Yaw of the vehicle, rad; 0 without one.
    pub fn vehicle_yaw(&self, time_s: f64) -> f64 {
        self.between(&self.vehicle_yaw, time_s, |from, to, share| from + (to - from) * share)
    }

    /// The point of the grid at or before a time, and the share of the step that has gone by since.
    fn point(&self, time_s: f64) -> (usize, f64) {
        // a millionth of a step forward, so that times on the grid are not rounded down to the step before
        let k = ((time_s / self.step_s + 1e-6).max(0.0) as usize).min(self.attitudes.len() - 1);
        (k, ((time_s - k as f64 * self.step_s) / self.step_s).clamp(0.0, 1.0))
    }

    fn between<T: Copy + Default>(&self, values: &[T], time_s: f64, mix: impl Fn(T, T, f64) -> T) -> T {
        let (k, share) = self.point(time_s);
        let Some(value) = values.get(k) else { return T::default() };
        values.get(k + 1).map_or(*value, |next| mix(*value, *next, share))
    }

    pub(super) fn at_positions(self, positions_m: Vec<Vector3<f64>>) -> Self {
        Self { positions_m, ..self }
    }

    pub(super) fn from_rates(start: UnitQuaternion<f64>, rates_rad_s: Vec<Vector3<f64>>) -> Self {
        let mut attitude = start;
        let attitudes = rates_rad_s
            .iter()
            .map(|rate| {
                let now = attitude;
                attitude *= UnitQuaternion::from_scaled_axis(rate * GRID_S);
                attitude.renormalize_fast();
                now
            })
            .collect();
        Self { step_s: GRID_S, attitudes, rates_rad_s, ..Self::default() }
    }

    pub(super) fn from_attitudes(attitudes: Vec<UnitQuaternion<f64>>, step_s: f64) -> Self {
        let mut rates: Vec<_> =
            attitudes.windows(2).map(|pair| (pair[0].inverse() * pair[1]).scaled_axis() / step_s).collect();
        rates.push(Vector3::zeros());
        Self { step_s, attitudes, rates_rad_s: rates, ..Self::default() }
    }
}
