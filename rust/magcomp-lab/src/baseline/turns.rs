//! What a good engineer writes in an afternoon: M and b by least squares, with the gyroscope's turns in place of a model of the field.
//!     h = (I + S) (h_m - first) - c,  S symmetric, tr S = 0      the field stands still while the device turns by R:
//!     h_now = R h_then,  then = 0.5 s before                     linear in S and c: eight numbers; `first`: the first sample
//! Normal equations, forgotten over 60 s; weak priors keep what was not seen small.

use super::method::Baseline;
use magcomp::nalgebra::{Matrix3, SMatrix, SVector, UnitQuaternion, Vector3};
use magcomp::{MagneticSample, RotationRateSample};
use std::collections::VecDeque;

/// From then to now, s.
const LAG_S: f64 = 0.5;
const MEMORY_S: f64 = 60.0;
/// A longer pause of the gyroscope starts anew, s.
const PAUSE_S: f64 = 0.5;
/// Error of a pair, an axis, uT; standard deviations before any pair: of S, and of c, uT.
const PAIR_UT: f64 = 1.0;
const SOFT: f64 = 0.03;
const HARD_UT: f64 = 1000.0;
/// No answer while a component of c is known worse than this, uT.
const KNOWN_UT: f64 = 5.0;

/// A sample and the device's attitude then, as the gyroscope has it.
type Pose = (i64, Vector3<f64>, UnitQuaternion<f64>);

/// The fit's state.
#[derive(Clone, Debug, Default)]
pub struct Turns {
    rate: Option<RotationRateSample>,
    first_ut: Option<Vector3<f64>>,
    attitude: UnitQuaternion<f64>,
    poses: VecDeque<Pose>,
    information: SMatrix<f64, 8, 8>,
    right: SVector<f64, 8>,
    /// I + S, and c.
    found: Option<(Matrix3<f64>, Vector3<f64>)>,
}

/// S m as a matrix times (S_11, S_22, S_12, S_13, S_23); S_33 = -S_11 - S_22.
fn of_soft(m: &Vector3<f64>) -> SMatrix<f64, 3, 5> {
    SMatrix::from_row_slice(&[m.x, 0.0, m.y, m.z, 0.0, 0.0, m.y, m.x, 0.0, m.z, -m.z, -m.z, 0.0, m.x, m.y])
}

impl Turns {
    fn add(&mut self, (then_ns, then_ut, before): &Pose, now_ns: i64, now_ut: &Vector3<f64>, step_s: f64) {
        let turn = (self.attitude.inverse() * before).to_rotation_matrix();
        let mut rows = SMatrix::<f64, 3, 8>::zeros();
        rows.fixed_columns_mut::<5>(0).copy_from(&(of_soft(now_ut) - turn.matrix() * of_soft(then_ut)));
        rows.fixed_columns_mut::<3>(5).copy_from(&(turn.matrix() - Matrix3::identity()));
        // pairs overlap: all of one lag together tell as much as one
        let weight = step_s / ((now_ns - then_ns) as f64 / 1e9) / (PAIR_UT * PAIR_UT);
        let kept = (-step_s / MEMORY_S).exp();
        self.information = self.information * kept + rows.transpose() * rows * weight;
        self.right = self.right * kept + rows.transpose() * (turn * then_ut - now_ut) * weight;
        self.solve();
    }

    fn solve(&mut self) {
        let prior = |k: usize| if k < 5 { SOFT } else { HARD_UT };
        let whole = self.information + SMatrix::from_diagonal(&SVector::from_fn(|k, _| prior(k).powi(-2)));
        let Some(whole) = whole.cholesky() else { return };
        let covariance = whole.inverse();
        if (5..8).all(|k| covariance[(k, k)] < KNOWN_UT * KNOWN_UT) {
            let x = whole.solve(&self.right);
            let soft = Matrix3::new(x[0], x[2], x[3], x[2], x[1], x[4], x[3], x[4], -x[0] - x[1]);
            self.found = Some((Matrix3::identity() + soft, x.fixed_rows::<3>(5).into_owned()));
        }
    }
}

impl Baseline for Turns {
    fn push_rate(&mut self, sample: &RotationRateSample) {
        let Some(last) = self.rate.replace(*sample) else { return };
        let step_s = (sample.time_ns - last.time_ns) as f64 / 1e9;
        if step_s > PAUSE_S {
            self.poses.clear();
        } else {
            self.attitude *= UnitQuaternion::new((last.rate_rad_s + sample.rate_rad_s) * (0.5 * step_s));
        }
    }

    fn push(&mut self, sample: &MagneticSample) {
        let now_ns = sample.time_ns;
        let now_ut = sample.field_ut - *self.first_ut.get_or_insert(sample.field_ut);
        let step_s = self.poses.back().map_or(0.0, |(last_ns, ..)| (now_ns - last_ns) as f64 / 1e9);
        let is_old = |pose: &Pose| (now_ns - pose.0) as f64 / 1e9 >= LAG_S;
        // the youngest pose that is old enough
        while self.poses.get(1).is_some_and(is_old) {
            self.poses.pop_front();
        }
        if let Some(then) = self.poses.front().filter(|pose| is_old(pose)).copied() {
            self.add(&then, now_ns, &now_ut, step_s);
        }
        if self.rate.is_some() {
            self.poses.push_back((now_ns, now_ut, self.attitude));
        }
    }

    fn correct(&self, raw_ut: &Vector3<f64>) -> Option<Vector3<f64>> {
        self.found.zip(self.first_ut).map(|((soft, hard_ut), first_ut)| soft * (raw_ut - first_ut) - hard_ut)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A turning device in an even field, without noise: what it corrects is the field, but for a factor that no turn can tell.
    #[test]
    fn turns_tell_m_and_b() {
        let soft = Matrix3::new(1.1, 0.05, -0.02, 0.05, 0.95, 0.03, -0.02, 0.03, 1.0);
        let hard_ut = Vector3::new(80.0, -50.0, 370.0);
        let rate_rad_s = Vector3::new(0.7, -0.4, 1.1);
        let mut turns = Turns::default();
        let (mut attitude, mut raw_ut, mut field_ut) = (UnitQuaternion::identity(), Vector3::zeros(), Vector3::zeros());
        for k in 0..3000_i64 {
            let time_ns = k * 20_000_000;
            // about another axis each two seconds
            let rate_rad_s = if (k / 100) % 2 == 0 { rate_rad_s } else { rate_rad_s.yzx() };
            turns.push_rate(&RotationRateSample { time_ns, rate_rad_s });
            attitude = turns.attitude;
            field_ut = attitude.inverse() * Vector3::new(0.0, 20.0, -45.0);
            raw_ut = soft * field_ut + hard_ut;
            turns.push(&MagneticSample { time_ns, field_ut: raw_ut });
        }
        assert!(attitude.angle() > 0.1);
        let off = turns.correct(&raw_ut).unwrap().angle(&field_ut).to_degrees();
        assert!(off < 0.5, "{off}");
        assert!(turns.latest(&raw_ut).is_some() && Turns::default().correct(&raw_ut).is_none());
    }
}
