//! VQF, an orientation filter (D. Laidig, T. Seel, Information Fusion 91, 2023), by the crate `vqf-rs`: gyroscope, accelerometer
//! and magnetometer to an attitude, with a gyroscope bias and a rejection of disturbed fields of its own. It takes the field for
//! calibrated, so it is given either the raw field or what another method makes of it.

use super::method::Baseline;
use magcomp::nalgebra::{Quaternion, UnitQuaternion, Vector3};
use magcomp::{MagneticSample, RotationRateSample, UpSample};
use vqf_rs::{Params, VQF};

/// Events of each sensor that tell its rate before the filter starts.
pub(super) const TIMED: usize = 21;

/// The filter, and the method whose corrected samples it is given.
pub struct Vqf {
    /// Time constant of the magnetometer's correction, s; the filter's own default is 9.
    tau_mag_s: f64,
    /// Corrects the field before the filter sees it; none where it gets the raw one.
    before: Option<Box<dyn Baseline>>,
    /// First times of gyroscope, accelerometer and magnetometer, ns.
    times_ns: [Vec<i64>; 3],
    filter: Option<VQF>,
    rate_ns: i64,
    /// Whether it has had a field.
    pointed: bool,
}

impl Vqf {
    /// With a time constant, s; fed with the raw field, or with the corrected samples of `before`.
    pub fn new(tau_mag_s: f64, before: Option<Box<dyn Baseline>>) -> Self {
        Self { tau_mag_s, before, times_ns: Default::default(), filter: None, rate_ns: 0, pointed: false }
    }

    /// Counts an event while the rates are unknown; then starts the filter.
    fn time(&mut self, sensor: usize, time_ns: i64) {
        if self.times_ns[sensor].len() < TIMED {
            self.times_ns[sensor].push(time_ns);
        }
        if self.times_ns.iter().all(|times| times.len() == TIMED) {
            let [gyroscope, accelerometer, magnetometer] = std::array::from_fn(|k| usual_step_s(&self.times_ns[k]));
            let params = Params { tau_mag: self.tau_mag_s, ..Params::default() };
            self.filter = Some(VQF::new(gyroscope, Some(accelerometer), Some(magnetometer), Some(params)));
        }
    }
}

pub(super) fn usual_step_s(times_ns: &[i64]) -> f64 {
    let mut steps: Vec<i64> = times_ns.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_unstable();
    steps[steps.len() / 2] as f64 / 1e9
}

impl Baseline for Vqf {
    fn push_rate(&mut self, sample: &RotationRateSample) {
        if let Some(before) = &mut self.before {
            before.push_rate(sample);
        }
        let step_s = (sample.time_ns - self.rate_ns) as f64 / 1e9;
        self.rate_ns = sample.time_ns;
        match &mut self.filter {
            Some(filter) if step_s > 0.0 => filter.update_gyr_with_ts(sample.rate_rad_s.into(), step_s),
            Some(_) => {}
            None => self.time(0, sample.time_ns),
        }
    }

    fn push_up(&mut self, sample: &UpSample) {
        if let Some(before) = &mut self.before {
            before.push_up(sample);
        }
        match &mut self.filter {
            Some(filter) => filter.update_acc(sample.up_m_s2.into()),
            None => self.time(1, sample.time_ns),
        }
    }

    fn push(&mut self, sample: &MagneticSample) {
        let field_ut = match &mut self.before {
            Some(before) => {
                before.push(sample);
                before.latest(&sample.field_ut)
            }
            None => Some(sample.field_ut),
        };
        let Some(filter) = &mut self.filter else { return self.time(2, sample.time_ns) };
        if let Some(field_ut) = field_ut {
            filter.update_mag(field_ut.into());
            self.pointed = true;
        }
    }

    fn correct(&self, _: &Vector3<f64>) -> Option<Vector3<f64>> {
        let q = self.filter.as_ref().filter(|_| self.pointed)?.quat_9d();
        let to_world = UnitQuaternion::new_normalize(Quaternion::new(q.0, q.1, q.2, q.3));
        Some(to_world.inverse() * Vector3::y())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use magcomp_recordings::recording;
    use std::path::Path;

    /// Its authors' own program (vqf 2.1.2 from PyPI, `VQF(0.0175)`, all rows from the 22nd on) gives these norths in the device.
    #[test]
    fn the_crate_agrees_with_its_authors_program() {
        let path =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/recordings/broad_34_attached_magnet_3cm.csv.gz");
        let expected = [
            (1000, [-0.073_780_106, 0.997_169_815, -0.014_451_822]),
            (4000, [0.886_887_131, -0.305_952_646, -0.346_156_317]),
            (6500, [0.978_851_541, 0.057_439_924, -0.196_342_345]),
            (9660, [-0.081_843_585, 0.996_560_424, -0.012_998_013]),
        ];
        let mut filter = Vqf::new(9.0, None);
        let mut compared = 0;
        for (k, row) in recording::read(&path).unwrap().rows.iter().enumerate() {
            let time_ns = row.time_ns;
            filter.push_rate(&RotationRateSample { time_ns, rate_rad_s: row.rate_rad_s.unwrap() });
            filter.push_up(&UpSample { time_ns, up_m_s2: row.up_m_s2.unwrap() });
            filter.push(&MagneticSample { time_ns, field_ut: row.field_ut });
            if let Some((_, north)) = expected.iter().find(|(at, _)| *at == k) {
                let off = filter.correct(&row.field_ut).unwrap() - Vector3::from(*north);
                assert!(off.norm() < 1e-6, "row {k}: {off:?}");
                compared += 1;
            }
        }
        assert_eq!(compared, expected.len());
    }
}
