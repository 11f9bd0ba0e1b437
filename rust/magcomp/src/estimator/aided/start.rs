//! Starts: from one raw sample, a second time about the first answer, and after a gap.
//!
//! ```text
//! raw_0 = m + b is known, its split is not:  P_mm = s^2 I,  P_bb = (s^2 + 0.25) I,  P_mb = -s^2 I
//! 20 < |raw_0| < 75 uT ("near"): m = raw_0, b = 0, s = 25; else m = 0, b = raw_0, s = 30
//! ```
//! A prior that is wide and without that correlation would give the split wholly to b, and h would go to 0.
//! The second start frees m and e about the first answer; b follows from them and the latest sample, which fits already:
//! ```text
//! b = raw - M m:   db = -M dm - D(m) de + noise
//! ```
//! Nothing is published until sqrt(tr P_bb) < 6 uT (adoption). Source: docs/METHOD.md; the second start is new.

use nalgebra::{Matrix3, SMatrix, Vector3};

use super::adapt::Adaptation;
use super::state::{BIAS, DELAY, Dense, FIELD, Gaussian, IRON, LOCAL, OFFSET, SCALE, iron_rows};
use super::strength::Strength;
use super::watch::Watch;
use super::{Aided, AidedOutput};
use crate::calibration::Given;
use crate::reading::SensorMode;
use crate::snapshot::checked;
use serde::{Deserialize, Serialize};

/// A first raw sample of this size may be a field without an offset, uT.
const NEAR_UT: std::ops::Range<f64> = 20.0..75.0;
/// Strength of the earth's field and its spread over the land, uT (world magnetic model: 22 to 67).
const EARTH_UT: (f64, f64) = (45.0, 13.0);
/// Variance of the sum of m and b at the start, uT^2: half a microtesla of noise.
const SUM_VARIANCE_UT2: f64 = 0.25;

/// A calibration that was given, or is from before a pause: the device may have changed since.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(remote = "Self")]
pub(crate) struct Unproven {
    /// What still is to be turned without a misfit, rad; 0: a misfit is told from the calibration's own error.
    pub(super) rest_rad: f32,
    /// Seconds of motion in which b still may not be moved far; 0: it is proven.
    pub(super) rest_s: f32,
    /// Its b, uT, and the variance of b per axis, uT^2.
    offset_ut: Vector3<f32>,
    variance_ut2: f32,
}

checked!(Unproven, |it| [it.rest_rad, it.rest_s, it.variance_ut2].iter().all(|v| *v >= 0.0));

impl Aided {
    /// A filter that knows one raw sample.
    pub(super) fn start(&mut self, raw_ut: &Vector3<f64>) -> Gaussian {
        self.restarted = false;
        self.adopted = false;
        self.unconfirmed = self.tuning.confirming as u32;
        self.trial = None;
        self.displaced_ut = Vector3::zeros();
        let near = NEAR_UT.contains(&raw_ut.norm());
        let mut dense = self.fresh(self.tuning.far_sd_ut);
        dense.set_vector(if near { FIELD } else { OFFSET }, raw_ut);
        if near {
            let (strength_ut, sd_ut) = self.expected_ut();
            dense.update_strength(strength_ut, sd_ut * sd_ut);
        }
        let mut gaussian = Gaussian::zero();
        gaussian.keep(&dense);
        gaussian
    }

    /// Strength of the field and its standard deviation, before anything is learned, uT.
    pub(super) fn expected_ut(&self) -> (f64, f64) {
        self.known_ut.map_or(EARTH_UT, |known_ut| (known_ut, known_ut * self.tuning.iron_sd))
    }

    /// Takes over a calibration from elsewhere, as adopted; where the field points is not known.
    pub fn begin_from(&mut self, given: &Given) {
        let Given { calibration, sigma_ut } = given;
        // the filter's gauge is trace M = 3
        let trace = calibration.soft_iron().trace();
        let e = calibration.soft_iron() * (3.0 / trace) - Matrix3::identity();
        let mut dense = self.fresh(self.tuning.far_sd_ut);
        dense.x[IRON..IRON + 6].copy_from_slice(&[e.m11, e.m22, e.m33, e.m12, e.m13, e.m23]);
        dense.set_vector(OFFSET, calibration.hard_iron_ut());
        dense.isolate(OFFSET, sigma_ut * sigma_ut);
        dense.isolate(FIELD, self.tuning.far_sd_ut * self.tuning.far_sd_ut);
        dense.isolate(IRON, 0.0);
        dense.isolate(IRON + 3, 0.0);
        dense.add_iron_variance((sigma_ut / EARTH_UT.0).min(self.tuning.iron_sd).powi(2));
        let mut gaussian = Gaussian::zero();
        if gaussian.keep(&dense) {
            self.question(&dense);
            self.filter = Some(gaussian);
            self.lost_strength_ut = Some(calibration.field_strength_ut() * trace / 3.0);
            self.restarted = true;
            self.adopted = true;
            self.trial = None;
            self.displaced_ut = Vector3::zeros();
            self.watch = Watch::new();
            self.strength = Strength::default();
        }
    }

    /// Mean zero, and the covariance of a start with the split of m and b known to `sd_ut` per axis.
    fn fresh(&self, sd_ut: f64) -> Dense {
        let mut dense = Gaussian::zero().open();
        let variance = sd_ut * sd_ut;
        for k in 0..3 {
            dense.p[FIELD + k][FIELD + k] = variance;
            dense.p[OFFSET + k][OFFSET + k] = variance + SUM_VARIANCE_UT2;
            dense.p[FIELD + k][OFFSET + k] = -variance;
            dense.p[OFFSET + k][FIELD + k] = -variance;
        }
        dense.add_iron_variance(self.tuning.iron_sd.powi(2));
        dense.add_variance(BIAS, self.tuning.bias_sd_rad_s.powi(2));
        dense.add_variance(LOCAL, self.tuning.local_start_ut.powi(2));
        dense.p[DELAY][DELAY] = self.tuning.delay_sd_s.powi(2);
        let scale = self.tuning.scale_sd.powi(2);
        dense.add_variance(SCALE, (1.0 - self.tuning.scale_common) * scale);
        dense.add_block(SCALE, &Matrix3::repeat(self.tuning.scale_common * scale));
        dense
    }

    /// From here on the calibration must prove itself.
    fn question(&mut self, dense: &Dense) {
        self.unproven = Unproven {
            rest_rad: self.tuning.proving_rad as f32,
            rest_s: self.tuning.settled_s as f32,
            offset_ut: dense.vector(OFFSET).cast(),
            variance_ut2: (dense.block(OFFSET, OFFSET).trace() / 3.0) as f32,
        };
        self.unconfirmed = self.tuning.confirming as u32;
    }

    pub(super) fn is_unproven(&self) -> bool {
        self.adopted && self.unproven.rest_rad > 0.0
    }

    /// Whether an unproven calibration does not hold: its b has been moved further than it was known, or its field is of
    /// a wrong strength.
    pub(super) fn refuted(&mut self, raw_ut: &Vector3<f64>, dense: &Dense) -> bool {
        let moved_ut: Vector3<f64> = dense.vector(OFFSET) - self.unproven.offset_ut.cast();
        let limit_ut2 = 3.0 * self.tuning.gate * f64::from(self.unproven.variance_ut2);
        let moved = self.adopted && self.unproven.rest_s > 0.0 && moved_ut.norm_squared() > limit_ut2;
        moved || (self.is_unproven() && self.contradicted(raw_ut, dense))
    }

    /// Whether the samples since the field was lost give it a wrong strength.
    fn contradicted(&mut self, raw_ut: &Vector3<f64>, dense: &Dense) -> bool {
        let Some((strength_ut, w)) = self.lost_strength_ut.zip(dense.soft_iron().try_inverse()) else { return false };
        let size_ut = (w * (raw_ut - dense.vector(OFFSET))).norm();
        let off = (size_ut / strength_ut - 1.0).abs() > self.tuning.fit_share;
        self.unconfirmed = if off { self.unconfirmed.saturating_sub(1) } else { self.tuning.confirming as u32 };
        self.unconfirmed == 0
    }

    /// A filter that has forgotten a calibration which does not hold.
    pub(super) fn start_anew(&mut self, raw_ut: &Vector3<f64>) -> Dense {
        self.lost_strength_ut = None;
        self.unproven = Unproven::default();
        self.watch = Watch::new();
        self.adaptation = Adaptation::new(&self.tuning);
        self.start(raw_ut).open()
    }

    /// Until the first calibration: a second start, then adoption.
    ///
    /// The first answer comes from a filter linearised far from the truth (m from 0 to 50 uT), which trusts it too much.
    /// So once the offset is roughly known, all is freed again about the better point.
    pub(super) fn adopt(&mut self, dense: &mut Dense) {
        if self.adopted {
            return;
        }
        let trace: f64 = (OFFSET..OFFSET + 3).map(|i| dense.p[i][i]).sum();
        if !self.restarted {
            if trace < self.tuning.smallest_step_ut.powi(2) {
                self.restarted = true;
                let mut again = self.fresh(self.tuning.smallest_step_ut);
                again.x = dense.x;
                again.tie_offset();
                for k in BIAS..BIAS + 3 {
                    // the bias may be known from rest, where nothing was linearised
                    again.p[k][k] = again.p[k][k].min(4.0 * dense.p[k][k]);
                }
                *dense = again;
            }
        } else if trace < self.tuning.adopt_sd_ut.powi(2) {
            self.adopted = true;
            self.adaptation.restart_walk();
        }
    }

    /// No usable rotation for this sample: the first one, a gap, or no gyroscope.
    ///
    /// The direction of the field is lost; its strength and the calibration are not, and wait.
    pub(super) fn without_rotation(
        &mut self,
        time_ns: i64,
        raw_ut: &Vector3<f64>,
        up: Option<Vector3<f64>>,
        dt_s: Option<f64>,
    ) -> AidedOutput {
        self.adaptation.restart_walk();
        self.adaptation.lose();
        self.motion.without_rotation(up);
        self.trial = None;
        self.watch = Watch::new();
        self.mode = if up.is_some() { SensorMode::GravityOnly } else { SensorMode::MagnetometerOnly };
        let filter = match (self.filter.take(), dt_s) {
            (Some(mut filter), _) if self.adopted => {
                let dt_s = dt_s.unwrap_or(0.0);
                let mut dense = filter.open();
                self.lost_strength_ut.get_or_insert(dense.vector(FIELD).norm());
                self.drift(&mut dense, dt_s);
                if dt_s > self.tuning.gap_s {
                    self.question(&dense);
                }
                if self.is_unproven() {
                    self.contradicted(raw_ut, &dense);
                }
                if let Some(w) = dense.soft_iron().try_inverse() {
                    dense.set_vector(FIELD, &(w * (raw_ut - dense.vector(OFFSET))));
                }
                dense.set_vector(LOCAL, &Vector3::zeros());
                dense.isolate(FIELD, self.tuning.far_sd_ut * self.tuning.far_sd_ut);
                dense.isolate(LOCAL, self.adaptation.local_ut.powi(2));
                filter.keep(&dense);
                filter
            }
            _ => self.start(raw_ut),
        };
        self.filter = Some(filter);
        self.held(time_ns, raw_ut)
    }

    /// The hard iron drifts while nothing is seen of it, up to what a first sample says of it.
    pub(super) fn drift(&self, dense: &mut Dense, dt_s: f64) {
        let room_ut2 = self.tuning.far_sd_ut.powi(2) - dense.block(OFFSET, OFFSET).trace() / 3.0;
        let walk_ut2 = self.tuning.offset_walk_max_ut.powi(2) * dt_s;
        dense.add_variance(OFFSET, walk_ut2.min(0.25 * room_ut2).max(0.0));
    }
}

impl Dense {
    /// P_bm, P_be and P_bb for db = -M dm - D(m) de + noise, m and e being independent.
    fn tie_offset(&mut self) {
        let h = self.vector(FIELD) + self.vector(LOCAL);
        let d = SMatrix::<f64, 3, 6>::from_fn(|i, k| iron_rows(&h)[i][k]);
        let iron = SMatrix::<f64, 6, 6>::from_fn(|i, k| self.p[IRON + i][IRON + k]);
        let to_field = -self.soft_iron() * self.block(FIELD, FIELD);
        let to_iron = -d * iron;
        let own = -to_field * self.soft_iron() - to_iron * d.transpose() + Matrix3::identity() * SUM_VARIANCE_UT2;
        for i in 0..3 {
            for k in 0..3 {
                self.p[OFFSET + i][FIELD + k] = to_field[(i, k)];
                self.p[FIELD + k][OFFSET + i] = to_field[(i, k)];
                self.p[OFFSET + i][OFFSET + k] = own[(i, k)];
            }
            for k in 0..6 {
                self.p[OFFSET + i][IRON + k] = to_iron[(i, k)];
                self.p[IRON + k][OFFSET + i] = to_iron[(i, k)];
            }
        }
    }
}
