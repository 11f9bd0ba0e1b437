//! The directions of a stream of samples, as the calibration in force shows them; before there is one, as seen from where the centre of the
//! samples seems to be.

use super::cells::Coverage;
use crate::calibration::{Calibration, typical_field_ut};
use crate::ellipsoid::Moments;
use crate::room::Roomy;
use alloc::collections::VecDeque;
use nalgebra::Vector3;

/// Choice: interval, in samples, of work that is too costly for each of them: 0.25 s at 100 Hz, which nobody sees on a screen. The directions of the latest
/// ten times as many are found anew when the calibration they are seen through is no longer right (tests/instructions.sh).
const ANEW_SAMPLES: usize = 25;
/// The least that are kept.
pub(crate) const FEWEST_KEPT: usize = 10 * ANEW_SAMPLES;
/// Choice: it is no longer right when the centre has moved by this many field strengths: less than the width of a cell, 0.5.
const ANEW_SHIFT: f64 = 0.2;

#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Guidance {
    /// Which directions were seen.
    pub coverage: Coverage,
    /// Directions are counted as seen through this.
    through: Option<Calibration>,
    /// The latest samples, oldest first, in half the memory.
    latest: Roomy<VecDeque<Vector3<f32>>>,
    samples: usize,
    longest: usize,
    /// Of the latest samples that count, while there is no calibration; where fewer are kept, of at least those.
    moments: Moments,
}

impl Guidance {
    /// Keeps so many samples, in a field of this strength (uT) where it is known. All memory is taken here.
    pub fn new(longest: usize, strength_ut: Option<f64>) -> Self {
        Self {
            coverage: Coverage::default(),
            through: None,
            latest: Roomy::<VecDeque<_>>::new(longest),
            samples: 0,
            longest,
            moments: Moments::new(Vector3::zeros(), typical_field_ut(strength_ut)),
        }
    }

    /// As new, in the memory that is there.
    pub fn restart(&mut self) {
        self.coverage = Coverage::default();
        self.through = None;
        self.latest.clear();
        self.samples = 0;
        self.moments = Moments::new(Vector3::zeros(), self.moments.scale_ut());
    }

    /// A sample; the calibration that is in force now, and how many of the latest samples count.
    pub fn see(&mut self, raw_ut: &Vector3<f64>, calibration: Option<&Calibration>, window: usize) {
        // as it is kept, so that it leaves as it came
        let kept: Vector3<f32> = raw_ut.cast();
        let raw_ut = &kept.cast();
        let direction = self.through.map(|through| through.correct(raw_ut));
        self.coverage.see(direction.as_ref());
        self.samples = self.samples.saturating_add(1);
        if calibration.is_none() {
            // the sample enters the moments, and those that count no longer leave
            if self.latest.is_empty() {
                self.moments = Moments::new(*raw_ut, self.moments.scale_ut());
            } else if self.moments.count() >= window && self.moments.count() > self.latest.len() {
                self.moments = Moments::new(*self.moments.centre_ut(), self.moments.scale_ut());
                self.latest.iter().for_each(|raw_ut| self.moments.add(&raw_ut.cast()));
            }
            while self.moments.count() >= window.max(1) {
                self.moments.remove(&self.latest[self.latest.len() - self.moments.count()].cast());
            }
            self.moments.add(raw_ut);
        }
        self.latest.roll(kept, self.longest);
        self.look_through(calibration, window);
    }

    /// Directions are found anew where the calibration they are seen through is no longer right.
    pub fn look_through(&mut self, calibration: Option<&Calibration>, window: usize) {
        self.coverage.count_latest(window);
        let is_near = |now: &Calibration, then: &Calibration| {
            let shift = (now.hard_iron_ut() - then.hard_iron_ut()).norm();
            shift <= ANEW_SHIFT * then.field_strength_ut()
        };
        let through = match (calibration, &self.through) {
            (Some(now), Some(then)) if is_near(now, then) => return,
            (Some(now), _) => *now,
            (None, _) if self.samples.is_multiple_of(ANEW_SAMPLES) => {
                Calibration::about(self.moments.provisional_centre_ut(), self.moments.scale_ut())
            }
            (None, _) => return,
        };
        self.through = Some(through);
        self.coverage = Coverage::default();
        let old = self.latest.len() - self.latest.len().min(window).min(FEWEST_KEPT);
        for raw_ut in self.latest.iter().skip(old) {
            self.coverage.see(Some(&through.correct(&raw_ut.cast())));
        }
        self.coverage.count_latest(window);
    }
}
