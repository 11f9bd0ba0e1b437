//! The latest samples, and what is counted over them for every method: which directions were seen, and (15) sigma_T.
//!
//! The paper's estimator chooses the window itself and fits its moments. For the others it is the latest N_max samples.

use super::config::WindowedConfig;
use super::uniformity::uniformity;
use crate::calibration::{Calibration, typical_field_ut};
use crate::coverage::Coverage;
use crate::ellipsoid::Moments;
use nalgebra::Vector3;
use std::collections::VecDeque;

/// The moments are taken about a new centre when the ellipsoid's is further away than this many field strengths.
const RECENTRE: f64 = 0.5;
/// After so many samples a calibration is asked for; while there is none, directions are counted anew about a provisional centre.
const RECOUNT_SAMPLES: usize = 25;
/// ... the latest so many of them, so that no sample costs much.
const RECOUNT_SPAN: usize = 250;
/// ... and while tracking when the centre has moved by this many field strengths, less than the width of a cell.
const RECOUNT_SHIFT: f64 = 0.2;

/// Keeps the latest samples and counts.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Clerk {
    pub(super) config: WindowedConfig,
    pub(super) field_strength_ut: Option<f64>,
    /// The latest N_max samples at the most, oldest first.
    kept: VecDeque<Slot>,
    /// The latest `window` of them are in the moments and in the coverage.
    pub window: usize,
    pub(super) moments: Moments,
    /// Nobody needs the moments any more: a method that has no window looks at them until it has a calibration.
    without_moments: bool,
    pub coverage: Coverage,
    pub noted: Noted,
}

/// What is carried from sample to sample besides the samples themselves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Noted {
    /// In force; of an estimator without a window as of the last time it was asked.
    pub calibration: Option<Calibration>,
    /// Directions are counted as seen through this.
    seen_through: Option<Calibration>,
    since_recentred: usize,
    /// (15) over the latest N_min samples, as they were at [`Clerk::measure`].
    pub sigma_t: Option<f64>,
    /// Predicted rms error of a direction corrected by that calibration, degrees.
    pub direction_sigma_deg: Option<f64>,
}

impl Clerk {
    /// For a validated config and a field strength (uT) where it is known. All memory is taken here.
    pub fn new(config: WindowedConfig, field_strength_ut: Option<f64>) -> Self {
        let moments = Moments::new(Vector3::zeros(), typical_field_ut(field_strength_ut));
        let noted = Noted::default();
        let (kept, coverage) = (VecDeque::with_capacity(config.n_max), Coverage::default());
        Self { config, field_strength_ut, kept, window: 0, moments, without_moments: false, coverage, noted }
    }

    /// As new, in the memory that is there.
    pub fn restart(&mut self) {
        self.kept.clear();
        self.coverage = Coverage::default();
        self.window = 0;
        self.moments = Moments::new(Vector3::zeros(), typical_field_ut(self.field_strength_ut));
        self.without_moments = false;
        self.noted = Noted::default();
    }

    /// A sample that an estimator without a window has answered. Now and then it is asked for its calibration: whether it was.
    pub fn note(&mut self, raw_ut: &Vector3<f64>, calibration: impl FnOnce() -> Option<Calibration>) -> bool {
        let asks = self.is_due();
        self.enter(raw_ut);
        self.look_through(if asks { calibration() } else { None });
        self.without_moments = self.noted.calibration.is_some();
        asks
    }

    /// From now on samples are seen through this, where there is one.
    pub fn look_through(&mut self, calibration: Option<Calibration>) {
        self.noted.calibration = calibration.or(self.noted.calibration);
        self.recount();
    }

    fn is_due(&self) -> bool {
        self.noted.since_recentred.is_multiple_of(RECOUNT_SAMPLES)
    }

    /// Samples kept.
    pub(super) fn len(&self) -> usize {
        self.kept.len()
    }

    /// The latest so many, the very latest first.
    fn latest(&self, count: usize) -> impl Iterator<Item = &Slot> {
        self.kept.iter().rev().take(count)
    }

    /// Forms (15), seen through the calibration noted last; returns the rms deviation of |h| from its strength there, relative.
    pub fn measure(&mut self) -> f64 {
        let n = self.config.n_min;
        let Some(calibration) = self.noted.calibration.filter(|_| self.len() >= n) else {
            self.noted.sigma_t = None;
            return 0.0;
        };
        let mut squares = 0.0;
        let corrected = self.latest(n).map(|slot| {
            let h = calibration.correct(&slot.raw_ut);
            squares += (h.norm() / calibration.field_strength_ut() - 1.0).powi(2);
            h
        });
        self.noted.sigma_t = Some(uniformity(corrected, self.config.normalisation));
        (squares / n as f64).sqrt()
    }

    /// The sample enters, in the window too.
    pub(super) fn enter(&mut self, raw_ut: &Vector3<f64>) {
        if self.kept.is_empty() && self.noted.calibration.is_none() {
            self.moments = Moments::new(*raw_ut, self.moments.scale_ut());
        }
        if self.window == self.config.n_max {
            self.resize(self.window - 1);
        }
        let cell = self.noted.seen_through.map(|through| Coverage::cell(&through.correct(raw_ut)) as u8);
        if self.kept.len() == self.config.n_max {
            self.kept.pop_front();
        }
        self.kept.push_back(Slot { raw_ut: *raw_ut, cell });
        if !self.without_moments {
            self.moments.add(raw_ut);
        }
        self.coverage.add(cell, 1);
        self.window += 1;
        self.noted.since_recentred = self.noted.since_recentred.saturating_add(1);
    }

    /// Samples enter or leave the window at its old end until it has this length.
    pub(super) fn resize(&mut self, length: usize) {
        let (length, kept) = (length.min(self.len()), self.len());
        while self.window > length {
            let oldest = self.kept[kept - self.window];
            if !self.without_moments {
                self.moments.remove(&oldest.raw_ut);
            }
            self.coverage.add(oldest.cell, -1);
            self.window -= 1;
        }
        while self.window < length {
            let next = self.kept[kept - 1 - self.window];
            self.moments.add(&next.raw_ut);
            self.coverage.add(next.cell, 1);
            self.window += 1;
        }
    }

    /// Directions are counted anew when the calibration they are seen through is no longer right.
    pub(super) fn recount(&mut self) {
        let is_near = |now: &Calibration, then: &Calibration| {
            (now.hard_iron_ut() - then.hard_iron_ut()).norm() <= RECOUNT_SHIFT * then.field_strength_ut()
        };
        let through = match (&self.noted.calibration, &self.noted.seen_through) {
            (Some(now), Some(then)) if is_near(now, then) => return,
            (Some(now), _) => *now,
            // where the centre seems to be before any fit is good enough to report
            (None, _) if self.is_due() => {
                Calibration::about(self.moments.provisional_centre_ut(), typical_field_ut(self.field_strength_ut))
            }
            (None, _) => return,
        };
        self.noted.seen_through = Some(through);
        self.coverage = Coverage::default();
        for (age, slot) in self.kept.iter_mut().rev().enumerate() {
            let counted = age < self.window.min(RECOUNT_SPAN);
            slot.cell = counted.then(|| Coverage::cell(&through.correct(&slot.raw_ut)) as u8);
            self.coverage.add(slot.cell, 1);
        }
    }

    /// Moments about a far centre lose digits: take them about the new one, at most once in N_min samples.
    pub(super) fn recentre(&mut self, centre_ut: &Vector3<f64>, field_ut: f64) {
        let scale = self.moments.scale_ut();
        let far = (centre_ut - self.moments.centre_ut()).norm() > RECENTRE * field_ut;
        let other = !(0.5..=2.0).contains(&(field_ut / scale));
        if (far || other) && self.noted.since_recentred >= self.config.n_min {
            self.noted.since_recentred = 0;
            let mut moments = Moments::new(*centre_ut, field_ut);
            self.latest(self.window).for_each(|slot| moments.add(&slot.raw_ut));
            self.moments = moments;
        }
    }
}

/// A sample and the cell of the sphere its direction was counted in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Slot {
    raw_ut: Vector3<f64>,
    cell: Option<u8>,
}
