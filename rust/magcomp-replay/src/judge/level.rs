//! The device's attitude without a magnetometer, for a judgement of the field that the field itself cannot flatter: gyroscope and
//! gravity through VQF, whose yaw is free and drifts slowly; without a gyroscope the averaged accelerometer's `up` alone.

use magcomp::nalgebra::{Quaternion, UnitQuaternion, Vector3};
use magcomp_recordings::recording::Row;
use vqf_rs::VQF;

/// Events of each sensor that tell its rate before the filter starts.
const TIMED: usize = 21;
/// Without a rotation rate for this long the yaw is lost, ns.
const STALE_NS: i64 = 200_000_000;
/// The accelerometer is averaged over this time, s.
const UP_TIME_S: f64 = 1.0;

/// `up` in the device: the accelerometer averaged over a second.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct AveragedUp {
    up: Option<Vector3<f64>>,
    before_s: Option<f64>,
}

impl AveragedUp {
    /// After the next row; m/s^2, none before the first acceleration.
    pub fn after(&mut self, row: &Row) -> Option<Vector3<f64>> {
        let gain = self.before_s.map_or(1.0, |before_s| ((row.time_s - before_s) / UP_TIME_S).min(1.0));
        self.before_s = Some(row.time_s);
        if let Some(measured) = row.latest_up() {
            let up = self.up.get_or_insert(measured);
            *up += (measured - *up) * gain;
        }
        self.up
    }
}

/// The attitude by gyroscope and gravity.
#[derive(Default)]
pub(super) struct Level {
    averaged: AveragedUp,
    up: Option<Vector3<f64>>,
    filter: Option<VQF>,
    /// First times of gyroscope and accelerometer, ns.
    times_ns: [Vec<i64>; 2],
    rate_ns: Option<i64>,
    now_ns: i64,
}

impl std::fmt::Debug for Level {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Level").field("up", &self.up).finish_non_exhaustive()
    }
}

impl Level {
    /// The next row.
    pub fn add(&mut self, row: &Row) {
        for event in row.inertial() {
            let finite = |v: &Vector3<f64>| v.iter().all(|value| value.is_finite());
            if let Some(rate) = event.rate_rad_s.filter(finite) {
                let step_s = self.rate_ns.map_or(0.0, |before_ns| (event.time_ns - before_ns) as f64 / 1e9);
                self.rate_ns = Some(event.time_ns);
                match &mut self.filter {
                    Some(filter) if step_s > 0.0 => filter.update_gyr_with_ts(rate.into(), step_s),
                    Some(_) => {}
                    None => self.time(0, event.time_ns),
                }
            }
            if let Some(up) = event.up_m_s2.filter(finite) {
                match &mut self.filter {
                    Some(filter) => filter.update_acc(up.into()),
                    None => self.time(1, event.time_ns),
                }
            }
        }
        self.now_ns = row.time_ns;
        self.up = self.averaged.after(row);
    }

    /// Counts an event while the rates are unknown; then starts the filter.
    fn time(&mut self, sensor: usize, time_ns: i64) {
        if self.times_ns[sensor].len() < TIMED {
            self.times_ns[sensor].push(time_ns);
        }
        if self.times_ns.iter().all(|times| times.len() == TIMED) {
            let step_s = |times: &[i64]| (times[TIMED - 1] - times[0]) as f64 / 1e9 / (TIMED - 1) as f64;
            let [gyroscope_s, accelerometer_s] = [step_s(&self.times_ns[0]), step_s(&self.times_ns[1])];
            self.filter = Some(VQF::new(gyroscope_s, Some(accelerometer_s), None, None));
        }
    }

    /// Device to a frame whose z is up and whose yaw is free; none without a gyroscope and an accelerometer, and while the gyroscope
    /// pauses.
    pub fn attitude(&self) -> Option<UnitQuaternion<f64>> {
        let filter = self.filter.as_ref().filter(|_| self.rate_ns.is_some_and(|at| self.now_ns - at <= STALE_NS))?;
        let q = filter.quat_6d();
        Some(UnitQuaternion::new_normalize(Quaternion::new(q.0, q.1, q.2, q.3)))
    }

    /// `up` in the device, any length; none without an accelerometer.
    pub fn up(&self) -> Option<Vector3<f64>> {
        self.attitude().map(|attitude| attitude.inverse() * Vector3::z()).or(self.up)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At 50 Hz for 20 s, a turn in 10 s about the vertical, tilted by 30 deg; the gyroscope is silent from 15 s to 18 s.
    #[test]
    fn it_follows_a_turn_and_knows_when_the_gyroscope_pauses() {
        let mut level = Level::default();
        let mut first = None;
        for k in 0..1000_u32 {
            let time_s = f64::from(k) * 0.02;
            let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), std::f64::consts::TAU * time_s / 10.0);
            let attitude = turn * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 30_f64.to_radians());
            let to_device = attitude.inverse();
            let is_silent = (15.0..18.0).contains(&time_s);
            level.add(&Row {
                time_s,
                time_ns: i64::from(k) * 20_000_000,
                field_ut: Vector3::zeros(),
                up_m_s2: Some(to_device * Vector3::z() * 9.8),
                rate_rad_s: (!is_silent).then_some(to_device * Vector3::z() * std::f64::consts::TAU / 10.0),
                ..Row::default()
            });
            assert!(level.up().is_some(), "{time_s}");
            if (15.3..17.9).contains(&time_s) {
                assert_eq!(level.attitude(), None, "{time_s}");
            }
            if (5.0..15.0).contains(&time_s) {
                // the yaw is free, but for the first
                let off = level.attitude().unwrap() * to_device;
                let first = first.get_or_insert(off);
                assert!(off.angle_to(first).to_degrees() < 0.5, "{time_s}: {off} against {first}");
            }
        }
    }
}
