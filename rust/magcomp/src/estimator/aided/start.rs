//! Starts: from nothing (`first_fit`), from a calibration that was given, and after a gap.
//!
//! A given calibration is what the first fit knows before any sample; it is dropped when the samples make it unlikely.
//! Without rotations the direction of the field is lost; its strength and the calibration are not, and wait.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use super::Aided;
use super::first_fit::Before;
use super::phase::Phase;
use super::state::{CALIBRATION, FIELD, HARD_IRON_ALONE, SOFT_IRON_ALONE};
use super::watch::Watch;
use crate::calibration::Given;
use crate::explanation::SampleUse;
use crate::math::gaussian::Gaussian;
use crate::math::symmetric::six;
use crate::sensing::frame::Frame;

impl Aided {
    /// Forgets the calibration, but for what is `given`; what is learned of the noise stays.
    pub(super) fn begin(&mut self, given: Option<Before>) {
        self.changes.start();
        (self.frame, self.covariances) = (Frame::default(), None);
        self.phase.start(self.known_ut, &self.tuning);
        if let (Phase::Starting(first), Some(given)) = (&mut self.phase, given) {
            first.begin_from(given, &self.tuning);
        }
    }

    /// Begins with a calibration from elsewhere.
    pub(super) fn begin_from(&mut self, given: &Given) {
        self.changes.break_chain(&self.phase, self.senses.latest_ns, &self.tuning);
        // the gauge here is trace M = 3: e = 3 M / tr M - I
        let m = given.calibration.soft_iron();
        let (trace, b) = (m.trace(), given.calibration.hard_iron_ut());
        let e = six(&(m * (3.0 / trace) - Matrix3::identity()));
        let by_trace = SVector::from([1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
        let of_identity = e + by_trace;
        let mut by = SMatrix::<f64, 9, 9>::identity();
        SOFT_IRON_ALONE.block_mut(&mut by).copy_from(
            &((SMatrix::<f64, 6, 6>::identity() - of_identity * by_trace.transpose() / 3.0) * (3.0 / trace)),
        );
        let mut mean = SVector::<f64, 9>::zeros();
        HARD_IRON_ALONE.set(&mut mean, b);
        SOFT_IRON_ALONE.set(&mut mean, &e);
        self.begin(Some(Before {
            calibration: Gaussian { mean, covariance: by * given.covariance * by.transpose() },
            strength_ut: given.calibration.field_strength_ut() * trace / 3.0,
        }));
    }

    /// No usable rotation for this sample: the first one, a gap, or no gyroscope.
    #[inline(never)]
    pub(super) fn without_rotation(&mut self, raw_ut: &Vector3<f64>, up: Option<Vector3<f64>>, dt_s: f64) {
        self.changes.break_chain(&self.phase, self.senses.latest_ns, &self.tuning);
        self.judged = Some((SampleUse::NoRotation, None));
        self.senses.without_rotation(up);
        self.adaptation.mean.previous = None;
        self.frame = Frame::default();
        match &mut self.phase {
            // the chain of rotations is broken; a calibration that was given may still hold
            Phase::Starting(first) => {
                let given = first.given.take();
                self.begin(given);
            }
            Phase::Running(running, _) | Phase::Undecided(running, _) => {
                running.drift(dt_s, &self.tuning);
                if dt_s > self.tuning.gap_s {
                    // the filter's calibration, which may have changed in a pause
                    let field_ut = || running.filter.part(FIELD).norm();
                    let strength_ut = running.lost_strength_ut.unwrap_or_else(field_ut);
                    let calibration = running.filter.marginal(CALIBRATION);
                    self.begin(Some(Before { calibration, strength_ut }));
                } else {
                    running.lose_field(raw_ut, self.adaptation.local_ut);
                    running.watch = Watch::default();
                    self.phase.run();
                }
            }
        }
    }
}
