//! How well any causal carrier could do on a recording, from its reference alone: the yardstick of a heading.
//!
//! A heading that a gyroscope carries walks off with the density Q of its error about the vertical (deg^2/s), and is measured by a field whose direction
//! errs with the density D of the place's unevenness (deg^2 s). The variance of the best one settles where what comes in is what is taken out,
//! P^2 = D Q (the steady state of a scalar Kalman filter without a memory of D or Q): its standard deviation is (D Q)^(1/4). The same carrier holds the
//! vertical against accelerations of the density A (deg^2 s); a vertical off by (A Q)^(1/4) turns the heading by tan(dip) of it. Together:
//!
//!   bound = ((D Q)^(1/2) + (A Q)^(1/2) tan^2(dip))^(1/2)
//!
//! A density is the variance of means over T times T. D is that of the corrected field's part square to north, over the horizontal field, where b, M and the
//! field of the place are fitted to the whole recording by the reference: min sum |W raw - c - R^T E|^2, robust, W symmetric with the trace 3. Gates, or a
//! filter that knows what D and A have in common, may do better; the bound of one that believes a place otherwise is another.

use crate::inertial::GRAVITY_M_S2;
use magcomp::nalgebra::{Matrix3, SMatrix, SVector, UnitQuaternion, Vector3};
use magcomp_recordings::recording::Row;
use magcomp_replay::statistics::median;

/// T, s: longer than what is taken for noise, and many of them in a minute.
const MEAN_S: f64 = 8.0;
/// Means that a density is formed from, at least, and values that a mean is.
const FEWEST_MEANS: usize = 4;
const FEWEST: usize = 6;
/// A reference that pauses for longer, s, or that turns otherwise than the gyroscope by more, rad/s, tells nothing of it.
const PAUSE_S: f64 = 0.12;
const LOST_RAD_S: f64 = 1.5;
/// Beyond this, uT, a deviation counts by its size, not by its square; how often that is reckoned anew.
const ROBUST_UT: f64 = 2.0;
const ROUNDS: usize = 8;
/// How far each element of W is from that of 1: standard deviation, for a deviation of 1 uT.
const IRON: f64 = 0.05;
/// c (3), E (3), and W without its last diagonal element, which makes the trace 3 (5).
type Unknowns = SVector<f64, 11>;

/// Sums up rows.
#[derive(Default)]
pub(super) struct Bounding {
    moments: Vec<Moment>,
    /// The rates since the row before, each with its time, s.
    rates: Vec<(f64, Vector3<f64>)>,
}

struct Moment {
    time_s: f64,
    raw_ut: Vector3<f64>,
    attitude: UnitQuaternion<f64>,
    /// Error of the gyroscope since the row before, device frame, rad/s.
    rate_rad_s: Option<Vector3<f64>>,
    /// East-north-up, m/s^2.
    up_m_s2: Option<Vector3<f64>>,
}

impl Bounding {
    /// The next row.
    pub fn add(&mut self, row: &Row) {
        let rates = row.inertial().filter_map(|event| Some((event.time_ns as f64 / 1e9, event.rate_rad_s?)));
        self.rates.extend(rates);
        let Some(attitude) = row.attitude else { return };
        let time_s = row.time_ns as f64 / 1e9;
        let up = row.inertial().filter_map(|event| event.up_m_s2).last();
        let rate_rad_s = self.moments.last().and_then(|before| {
            let span_s = time_s - before.time_s;
            let turned = (before.attitude.inverse() * attitude).scaled_axis() / span_s;
            let read = mean_between(&self.rates, before.time_s, time_s)?;
            Some(turned - read).filter(|_| span_s > 0.0 && span_s < PAUSE_S)
        });
        // the last of them holds until the next
        self.rates.drain(..self.rates.len().saturating_sub(1));
        let up_m_s2 = up.map(|up| attitude * up);
        self.moments.push(Moment { time_s, raw_ut: row.field_ut, attitude, rate_rad_s, up_m_s2 });
    }

    /// Degrees; none where there is no gyroscope, no accelerometer, or less than half a minute of a reference.
    pub fn finish(&self) -> Option<f64> {
        let (fit, field) = self.fit()?;
        let north = Vector3::new(field.x, field.y, 0.0);
        let level_ut = north.norm();
        let side = Vector3::new(-north.y, north.x, 0.0) / level_ut;
        let uneven = self.density(|moment| Some((fit(moment) - field).dot(&side) / level_ut))?;
        let errors = || self.moments.iter().filter_map(|moment| moment.rate_rad_s);
        let bias = Vector3::from_fn(|axis, _| median(errors().map(|error| error[axis]).collect()).unwrap_or(0.0));
        let drift = self.density(|moment| {
            let error = moment.rate_rad_s? - bias;
            Some((moment.attitude * error).z).filter(|_| error.norm() < LOST_RAD_S)
        })?;
        let moved = [0, 1].map(|axis| self.density(move |moment| Some(moment.up_m_s2?[axis] / GRAVITY_M_S2)));
        let moved = (moved[0]? + moved[1]?) / 2.0;
        let slope = field.z / level_ut;
        let square = (uneven * drift).sqrt() + (moved * drift).sqrt() * slope * slope;
        Some(square.sqrt().to_degrees()).filter(|bound| bound.is_finite() && *bound > 0.0)
    }

    /// The variance of means over T, times T.
    fn density(&self, value: impl Fn(&Moment) -> Option<f64>) -> Option<f64> {
        let start_s = self.moments.first()?.time_s;
        let mut sums: Vec<(f64, usize)> = Vec::new();
        for moment in &self.moments {
            let Some(value) = value(moment) else { continue };
            let at = ((moment.time_s - start_s) / MEAN_S) as usize;
            sums.resize(sums.len().max(at + 1), (0.0, 0));
            sums[at] = (sums[at].0 + value, sums[at].1 + 1);
        }
        let means = sums.iter().filter(|(_, count)| *count >= FEWEST).map(|(sum, count)| sum / *count as f64);
        let means: Vec<f64> = means.collect();
        let mean = means.iter().sum::<f64>() / means.len() as f64;
        let variance = means.iter().map(|it| (it - mean).powi(2)).sum::<f64>() / means.len() as f64;
        (means.len() >= FEWEST_MEANS).then_some(variance * MEAN_S)
    }

    /// What makes the corrected field of a moment, turned to the world, and the field of the place, uT.
    fn fit(&self) -> Option<(impl Fn(&Moment) -> Vector3<f64>, Vector3<f64>)> {
        let mut found = Unknowns::zeros();
        for _ in 0..ROUNDS {
            let (mut normal, mut right) = (SMatrix::<f64, 11, 11>::zeros(), Unknowns::zeros());
            (6..11).for_each(|k| normal[(k, k)] = IRON.powi(-2));
            for moment in &self.moments {
                let (rows, known) = equation(moment);
                let left = (known + rows * found).norm();
                let weight = if found == Unknowns::zeros() { 1.0 } else { 1.0 / (left / ROBUST_UT).max(1.0) };
                normal += rows.transpose() * rows * weight;
                right -= rows.transpose() * known * weight;
            }
            found = normal.cholesky()?.solve(&right);
        }
        let field = found.fixed_rows::<3>(3).into_owned();
        let fit = move |moment: &Moment| {
            let (rows, known) = equation(moment);
            // W raw - c - R^T E, and E again
            moment.attitude * (known + rows * found) + field
        };
        Some((fit, field))
    }
}

/// W raw - c - R^T E as rows of the unknowns, W - 1 among them, and what is known.
fn equation(moment: &Moment) -> (SMatrix<f64, 3, 11>, Vector3<f64>) {
    let raw = &moment.raw_ut;
    let mut rows = SMatrix::<f64, 3, 11>::zeros();
    rows.fixed_view_mut::<3, 3>(0, 0).copy_from(&-Matrix3::identity());
    rows.fixed_view_mut::<3, 3>(0, 3).copy_from(&-moment.attitude.inverse().to_rotation_matrix().into_inner());
    for (k, (i, j)) in [(0, 0), (1, 1), (0, 1), (0, 2), (1, 2)].into_iter().enumerate() {
        rows[(i, 6 + k)] += raw[j];
        if i == j {
            rows[(2, 6 + k)] -= raw.z;
        } else {
            rows[(j, 6 + k)] += raw[i];
        }
    }
    (rows, *raw)
}

/// The mean of what is read between two times, linear from one reading to the next.
fn mean_between(rates: &[(f64, Vector3<f64>)], from_s: f64, to_s: f64) -> Option<Vector3<f64>> {
    let first = rates.first()?;
    let (mut sum, mut latest) = (Vector3::zeros(), (from_s, first.1));
    for (at_s, rate) in rates.iter().filter(|(at_s, _)| (from_s..=to_s).contains(at_s)) {
        sum += (latest.1 + rate) * (0.5 * (at_s - latest.0));
        latest = (*at_s, *rate);
    }
    sum += latest.1 * (to_s - latest.0);
    Some(sum / (to_s - from_s)).filter(|_| to_s > from_s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, Random};

    /// A device that turns about the vertical and tumbles, in a field with white deviations, with a gyroscope whose rate has white errors and a bias, and
    /// a raw field with hard and soft iron: the bound is that of the densities that were put in.
    #[test]
    fn the_bound_is_that_of_the_densities_that_were_put_in() {
        const HZ: f64 = 50.0;
        for (side_ut, drift_deg, moved_g) in
            [(1.0_f64, 0.5_f64, 0.0_f64), (4.0, 0.5, 0.0), (1.0, 2.0, 0.0), (1.0, 0.5, 0.3)]
        {
            let random = &mut Random::new(3, Purpose::Motion);
            let mut bounding = Bounding::default();
            let attitude = |time_s: f64| {
                UnitQuaternion::from_euler_angles(0.6 * (0.9 * time_s).sin(), 0.5 * (0.7 * time_s).sin(), 0.4 * time_s)
            };
            let soft = Matrix3::new(1.03, 0.02, 0.0, 0.02, 0.98, 0.01, 0.0, 0.01, 0.99);
            for k in 0..30_000 {
                let time_s = f64::from(k) / HZ;
                let (now, before) = (attitude(time_s), attitude(time_s - 1.0 / HZ));
                let field_ut = Vector3::new(0.0, 20.0, -40.0) + random.normal3() * side_ut;
                let noise = random.normal3() * (drift_deg.to_radians() * HZ.sqrt());
                let turned = (before.inverse() * now).scaled_axis() * HZ;
                let level = Vector3::new(random.normal(), random.normal(), 0.0) * moved_g;
                let row = Row {
                    time_s,
                    time_ns: (time_s * 1e9).round() as i64,
                    field_ut: soft * (now.inverse() * field_ut) + Vector3::new(100.0, -30.0, 20.0),
                    attitude: Some(now),
                    rate_rad_s: Some(turned + noise + Vector3::new(0.02, -0.01, 0.03)),
                    up_m_s2: Some(now.inverse() * (Vector3::z() + level) * GRAVITY_M_S2),
                    ..Row::default()
                };
                bounding.add(&row);
            }
            let found = bounding.finish().unwrap();
            // densities of white noise: variance over rate
            let uneven = (side_ut / 20.0_f64).to_degrees().powi(2) / HZ;
            let moved = moved_g.to_degrees().powi(2) / HZ;
            let expected = ((uneven * drift_deg.powi(2)).sqrt() + (moved * drift_deg.powi(2)).sqrt() * 4.0).sqrt();
            // of 75 means; the root of the root of each
            assert!((found / expected - 1.0).abs() < 0.12, "{side_ut} {drift_deg} {moved_g}: {found}, not {expected}");
        }
        assert_eq!(Bounding::default().finish(), None);
    }

    #[test]
    fn a_mean_of_readings_is_that_of_the_lines_between_them() {
        let rates = [(0.9, 1.0), (1.0, 2.0), (1.1, 4.0), (1.3, 9.0)].map(|(at_s, x)| (at_s, Vector3::x() * x));
        let mean = |from_s, to_s| mean_between(&rates, from_s, to_s).map(|mean| mean.x);
        assert!((mean(1.0, 1.1).unwrap() - 3.0).abs() < 1e-9);
        assert!((mean(1.0, 1.2).unwrap() - 3.5).abs() < 1e-9);
        assert_eq!((mean(1.0, 1.0), mean_between(&[], 0.0, 1.0)), (None, None));
    }
}
