//! Fusion, the orientation filter of x-io Technologies (S. Madgwick's thesis, 2014, revised), by the crate `fusion-ahrs`, which ports their C.
//! The settings are those of their own examples: gain 0.5, accelerations and fields off by more than 10 degrees rejected for 5 s.

use super::method::Baseline;
use super::vqf::{TIMED, usual_step_s};
use fusion_ahrs::{Ahrs, AhrsSettings, Convention};
use magcomp::nalgebra::{Quaternion, UnitQuaternion, Vector3};
use magcomp::{MagneticSample, RotationRateSample, UpSample};

const G_M_S2: f64 = 9.806_65;

/// The filter, and what it was given last.
#[derive(Clone, Debug, Default)]
pub struct Xio {
    /// First times of the gyroscope, ns, which tell its rate.
    times_ns: Vec<i64>,
    filter: Option<Ahrs>,
    /// A rate that waits for the field of its time.
    rate: Option<RotationRateSample>,
    last_ns: i64,
    up_m_s2: Option<Vector3<f64>>,
    /// Whether it has had a field.
    pointed: bool,
}

fn single(v: Vector3<f64>) -> [f32; 3] {
    v.map(|value| value as f32).into()
}

impl Xio {
    /// Gives the filter the rate that waits, with the field where there is one.
    fn step(&mut self, field_ut: Option<Vector3<f64>>) {
        let (Some(rate), Some(up_m_s2)) = (self.rate.take(), self.up_m_s2) else { return };
        let Some(filter) = &mut self.filter else { return };
        let step_s = (rate.time_ns - self.last_ns) as f64 / 1e9;
        self.last_ns = rate.time_ns;
        filter.set_sample_period(step_s as f32);
        let (rate_deg_s, up_g) = (single(rate.rate_rad_s.map(f64::to_degrees)), single(up_m_s2 / G_M_S2));
        match field_ut {
            Some(field_ut) => {
                filter.update(rate_deg_s, up_g, single(field_ut));
                self.pointed = true;
            }
            None => filter.update_no_magnetometer(rate_deg_s, up_g),
        }
    }
}

impl Baseline for Xio {
    fn push_rate(&mut self, sample: &RotationRateSample) {
        if self.filter.is_none() {
            self.times_ns.push(sample.time_ns);
            if self.times_ns.len() == TIMED {
                let settings = AhrsSettings {
                    sample_rate: (1.0 / usual_step_s(&self.times_ns)) as f32,
                    convention: Convention::Enu,
                    gain: 0.5,
                    gyroscope_range: 2000.0,
                    acceleration_rejection: 10.0,
                    magnetic_rejection: 10.0,
                    rejection_timeout: 5.0,
                };
                self.filter = Some(Ahrs::with_settings(settings));
                self.last_ns = sample.time_ns;
            }
            return;
        }
        self.step(None);
        self.rate = Some(*sample).filter(|sample| sample.time_ns > self.last_ns);
    }

    fn push_up(&mut self, sample: &UpSample) {
        self.up_m_s2 = Some(sample.up_m_s2);
    }

    fn push(&mut self, sample: &MagneticSample) {
        self.step(Some(sample.field_ut));
    }

    fn correct(&self, _: &Vector3<f64>) -> Option<Vector3<f64>> {
        let q = self.filter.as_ref().filter(|_| self.pointed)?.quaternion();
        let [w, x, y, z] = [q.w, q.x, q.y, q.z].map(f64::from);
        Some(UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z)).inverse() * Vector3::y())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A device that turns evenly about the vertical in an even field: north stays where it is.
    #[test]
    fn a_level_turn_is_followed() {
        let mut filter = Xio::default();
        let rate_rad_s = Vector3::new(0.0, 0.0, 0.5);
        for k in 0..3000_i64 {
            let time_ns = k * 20_000_000;
            let to_world = UnitQuaternion::from_scaled_axis(rate_rad_s * (time_ns as f64 / 1e9));
            let field_ut = to_world.inverse() * Vector3::new(0.0, 20.0, -45.0);
            filter.push_rate(&RotationRateSample { time_ns, rate_rad_s });
            filter.push_up(&UpSample { time_ns, up_m_s2: Vector3::z() * G_M_S2 });
            filter.push(&MagneticSample { time_ns, field_ut });
            if k > 1500 {
                let off = (to_world * filter.correct(&field_ut).unwrap()).angle(&Vector3::y()).to_degrees();
                assert!(off < 1.0, "{off} at {k}");
            }
        }
    }
}
