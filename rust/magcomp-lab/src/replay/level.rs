//! The device's attitude without a magnetometer, for a judgement of the field that the field itself cannot flatter: gyroscope and
//! gravity through VQF, whose yaw is free and drifts slowly; without a gyroscope the averaged accelerometer's `up` alone.

use crate::recording::Row;
use magcomp::nalgebra::{Quaternion, UnitQuaternion, Vector3};
use vqf_rs::VQF;

/// Events of each sensor that tell its rate before the filter starts.
const TIMED: usize = 21;
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

    /// Device to a frame whose z is up and whose yaw is free; none without a gyroscope and an accelerometer.
    pub fn attitude(&self) -> Option<UnitQuaternion<f64>> {
        let (w, x, y, z) = {
            let q = self.filter.as_ref()?.quat_6d();
            (q.0, q.1, q.2, q.3)
        };
        Some(UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z)))
    }

    /// `up` in the device, any length; none without an accelerometer.
    pub fn up(&self) -> Option<Vector3<f64>> {
        self.attitude().map(|attitude| attitude.inverse() * Vector3::z()).or(self.up)
    }
}
