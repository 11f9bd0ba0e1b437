//! The paper's real-time method (section IV, fig. 3). For each new sample, with the M_k, b_k of the step before:
//! 1. sigma_T over the latest N_min samples, (11) to (15);
//! 2. below sigma_th nothing is updated;
//! 3. (16) the window N;
//! 4. (10) on the latest N samples gives M_k+1, b_k+1.
//!
//! What is ours: the cost of a window is kept as its moments, so a fit costs the same for every N; each fit starts from
//! the previous parameters or from a closed form, whichever fits better; a fit that the samples don't support is refused
//! with its reason and the parameters stay; and when the window holds samples that lie on no one ellipsoid, it is cut to
//! the latest N_min and grows from there.

use super::config::WindowedConfig;
use super::uniformity::uniformity;
use super::window::window_length;
use crate::calibration::{Calibration, FIELD_STRENGTHS_UT, LARGEST_RAW_UT, typical_field_ut};
use crate::coverage::Coverage;
use crate::quadric::{EllipsoidFit, FitError, FitOptions, Moments};
use crate::reading::{HoldReason, Missing, Status};
use crate::snapshot::{LARGEST_COUNT, is_covariance};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// The moments are taken about a new centre when the ellipsoid's is further away than this many field strengths.
const RECENTRE: f64 = 0.5;
/// The constant method keeps its first fit that predicts direction errors below this, degrees: an even sphere of 100
/// samples at 30 dB reaches 0.7.
const CONSTANT_SIGMA_DEG: f64 = 1.0;
/// Rms deviation of |h| over the latest N_min samples, as a share of the field strength, that is suspect: rooms stay
/// below 5 %, a magnet of 13 uT on the phone gives 20 %.
const SUSPECT_SPREAD: f64 = 0.1;

/// While collecting, directions are counted anew about a provisional centre after so many samples.
const RECOUNT_SAMPLES: usize = 25;
/// ... the latest so many of them, so that no sample costs much.
const RECOUNT_SPAN: usize = 250;
/// ... and while tracking when the centre has moved by this many field strengths, less than the width of a cell.
const RECOUNT_SHIFT: f64 = 0.2;

/// Samples from a refused fit to the next try.
const RETRY_SAMPLES: usize = 10;

/// The paper's estimator.
#[derive(Clone, Debug)]
pub(crate) struct Windowed {
    config: WindowedConfig,
    options: FitOptions,
    constant: bool,
    ring: Ring,
    /// The latest `window` samples of the ring are in the moments and in the cells.
    window: usize,
    moments: Moments,
    cells: Coverage,
    kept: Kept,
}

/// What is carried from sample to sample besides the samples themselves.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Kept {
    calibration: Option<Calibration>,
    fit: Option<EllipsoidFit>,
    /// Directions are counted as seen through this.
    seen_through: Option<Calibration>,
    since_fit: usize,
    since_recentred: usize,
    /// Samples since the last change that was noticed: older ones are not used.
    since_change: usize,
    refused: Option<FitError>,
    suspect_since_ns: Option<i64>,
    /// (15) as it was when another estimator's calibration was noted.
    sigma_t: Option<f64>,
}

/// The state as a snapshot holds it: moments and counts follow from the samples, exactly.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct WindowedState {
    /// Oldest first.
    slots: Vec<Slot>,
    window: usize,
    centre_ut: Vector3<f64>,
    scale_ut: f64,
    kept: Kept,
}

/// What one sample led to.
pub(crate) struct WindowedStep {
    pub sigma_t: Option<f64>,
    pub status: Status,
}

impl Windowed {
    /// For a validated config, a field strength (uT) where it is known, and a calibration to begin with. `constant`: the first
    /// good fit is kept. All memory is taken here.
    pub fn new(
        config: WindowedConfig,
        constant: bool,
        field_strength_ut: Option<f64>,
        initial: Option<Calibration>,
    ) -> Self {
        Self {
            config,
            options: config.fit_options(field_strength_ut),
            constant,
            ring: Ring::new(config.n_max),
            window: 0,
            moments: Moments::new(Vector3::zeros(), typical_field_ut(field_strength_ut)),
            cells: Coverage::default(),
            kept: Kept { calibration: initial, seen_through: initial, ..Kept::default() },
        }
    }

    /// As new, in the memory that is there.
    pub fn restart(&mut self, initial: Option<Calibration>) {
        self.ring.clear();
        self.cells.clear();
        self.window = 0;
        self.moments = Moments::new(Vector3::zeros(), typical_field_ut(self.options.field_strength_ut));
        self.kept = Kept { calibration: initial, seen_through: initial, ..Kept::default() };
    }

    pub fn calibration(&self) -> Option<Calibration> {
        self.kept.calibration
    }

    /// The latest fit that was accepted.
    pub fn fit(&self) -> Option<&EllipsoidFit> {
        self.kept.fit.as_ref()
    }

    pub fn window(&self) -> usize {
        self.window
    }

    pub fn coverage(&self) -> &Coverage {
        &self.cells
    }

    /// (15) over the latest N_min samples, as they were at [`Windowed::measure`].
    pub fn sigma_t(&self) -> Option<f64> {
        self.kept.sigma_t
    }

    /// Forms (15), seen through the calibration noted last.
    pub fn measure(&mut self) {
        self.kept.sigma_t = self.variability().0;
    }

    /// One step of fig. 3.
    pub fn push(&mut self, time_ns: i64, raw_ut: &Vector3<f64>) -> WindowedStep {
        self.enter(raw_ut);
        self.kept.since_fit += 1;
        let (sigma_t, spread) = self.variability();
        let status = match sigma_t {
            _ if self.constant && self.kept.calibration.is_some() => {
                self.resize(self.window.min(self.config.n_min));
                Status::Held(HoldReason::Constant)
            }
            Some(sigma_t) if sigma_t < self.config.sigma_th => {
                self.resize(self.window - 1);
                Status::Held(HoldReason::LowUniformity)
            }
            Some(sigma_t) => {
                let length = window_length(sigma_t, self.config.n_min, self.config.n_max);
                self.resize(length.min(self.kept.since_change));
                self.refit()
            }
            None if self.ring.len() >= self.config.n_min => self.refit(),
            None => self.collecting(),
        };
        self.recount();
        if spread <= SUSPECT_SPREAD {
            self.kept.suspect_since_ns = None;
            return WindowedStep { sigma_t, status };
        }
        let since_ns = *self.kept.suspect_since_ns.get_or_insert(time_ns);
        WindowedStep { sigma_t, status: Status::Suspect { since_ns } }
    }

    /// 1. (15) over the latest N_min samples, with the parameters of the step before; and the rms deviation of |h| there.
    fn variability(&self) -> (Option<f64>, f64) {
        let n = self.config.n_min;
        let Some(calibration) = self.kept.calibration.filter(|_| self.ring.len() >= n) else {
            return (None, 0.0);
        };
        let mut squares = 0.0;
        let corrected = (0..n).map(|age| {
            let h = calibration.correct(self.ring.latest(age));
            squares += (h.norm() / calibration.field_strength_ut() - 1.0).powi(2);
            h
        });
        let sigma_t = uniformity(corrected, self.config.normalisation);
        (Some(sigma_t), (squares / n as f64).sqrt())
    }

    /// 4. (10) on the window.
    fn refit(&mut self) -> Status {
        // a window that does not fit now will hardly fit one sample later
        let wait = if self.kept.refused.is_some() { RETRY_SAMPLES } else { 1 };
        if self.kept.since_fit < wait {
            return match (self.kept.calibration, self.kept.refused) {
                (None, _) => self.collecting(),
                (_, None) => Status::Tracking,
                (_, Some(error)) => Status::Held(HoldReason::FitRefused(error)),
            };
        }
        self.kept.since_fit = 0;
        match self.moments.fit_from(self.kept.calibration.as_ref(), &self.options) {
            Ok(fit) if !self.constant || self.settled(&fit) => {
                self.kept.calibration = Some(fit.calibration);
                self.kept.fit = Some(fit);
                self.kept.refused = None;
                self.recentre(fit.calibration.hard_iron_ut(), fit.calibration.field_strength_ut());
                Status::Tracking
            }
            Ok(_) => self.collecting(),
            Err(error) => {
                self.kept.refused = Some(error);
                if matches!(error, FitError::Inconsistent { .. }) {
                    // something changed inside the window: only its latest samples may still agree
                    self.kept.since_change = self.config.n_min;
                    self.resize(self.config.n_min);
                }
                match self.kept.calibration {
                    Some(_) => Status::Held(HoldReason::FitRefused(error)),
                    None => self.collecting(),
                }
            }
        }
    }

    /// Whether the constant method keeps this fit.
    fn settled(&self, fit: &EllipsoidFit) -> bool {
        fit.direction_sigma_deg <= CONSTANT_SIGMA_DEG || self.window == self.config.n_max
    }

    fn collecting(&self) -> Status {
        Status::Collecting(match self.kept.refused {
            Some(error) => Missing::Fit(error),
            None => Missing::Samples { have: self.ring.len(), need: self.config.n_min },
        })
    }

    /// A sample that another estimator has answered, and now and then what it has found: kept, so that this one can take
    /// over at any time, and directions are counted.
    pub fn note(&mut self, raw_ut: &Vector3<f64>, calibration: Option<Calibration>) {
        self.enter(raw_ut);
        if calibration.is_some() {
            self.kept.calibration = calibration;
        }
        self.recount();
    }

    /// Whether the next `note` should bring a calibration: often enough for counting directions.
    pub fn wants_calibration(&self) -> bool {
        self.kept.since_recentred.is_multiple_of(RECOUNT_SAMPLES)
    }

    /// What another estimator has found.
    pub fn adopt(&mut self, calibration: Calibration) {
        self.kept.calibration = Some(calibration);
        self.kept.fit = None;
        self.recount();
    }

    /// The sample enters ring and window.
    fn enter(&mut self, raw_ut: &Vector3<f64>) {
        if self.ring.len() == 0 && self.kept.calibration.is_none() {
            self.moments = Moments::new(*raw_ut, self.moments.scale_ut());
        }
        if self.window == self.config.n_max {
            self.resize(self.window - 1);
        }
        let cell = self.kept.seen_through.map(|through| Coverage::cell(&through.correct(raw_ut)) as u8);
        self.ring.push(Slot { raw_ut: *raw_ut, cell });
        self.moments.add(raw_ut);
        self.cells.add(cell);
        self.window += 1;
        self.kept.since_recentred += 1;
        self.kept.since_change += 1;
    }

    /// Samples enter or leave the window at its old end until it has this length.
    fn resize(&mut self, length: usize) {
        let length = length.min(self.ring.len());
        while self.window > length {
            let oldest = self.ring.slot(self.window - 1);
            self.moments.remove(&oldest.raw_ut);
            self.cells.remove(oldest.cell);
            self.window -= 1;
        }
        while self.window < length {
            let next = self.ring.slot(self.window);
            self.moments.add(&next.raw_ut);
            self.cells.add(next.cell);
            self.window += 1;
        }
    }

    /// Directions are counted anew when the calibration they are seen through is no longer right.
    fn recount(&mut self) {
        let through = match (&self.kept.calibration, &self.kept.seen_through) {
            (Some(now), Some(then)) => {
                let shift = (now.hard_iron_ut() - then.hard_iron_ut()).norm();
                if shift <= RECOUNT_SHIFT * then.field_strength_ut() {
                    return;
                }
                *now
            }
            (Some(now), None) => *now,
            (None, _) if self.wants_calibration() => self.provisional(),
            (None, _) => return,
        };
        self.kept.seen_through = Some(through);
        self.cells.clear();
        for age in 0..self.ring.len() {
            let place = self.ring.place(age);
            let slot = &mut self.ring.slots[place];
            let counted = age < self.window.min(RECOUNT_SPAN);
            slot.cell = counted.then(|| Coverage::cell(&through.correct(&slot.raw_ut)) as u8);
            self.cells.add(slot.cell);
        }
    }

    /// Where the centre seems to be before any fit is good enough to report.
    fn provisional(&self) -> Calibration {
        let centre = self.moments.provisional_centre_ut();
        Calibration::about(centre, typical_field_ut(self.options.field_strength_ut))
    }

    /// Moments about a far centre lose digits: take them about the new one, at most once in N_min samples.
    fn recentre(&mut self, centre_ut: &Vector3<f64>, field_ut: f64) {
        let scale = self.moments.scale_ut();
        let far = (centre_ut - self.moments.centre_ut()).norm() > RECENTRE * field_ut;
        let other = !(0.5..=2.0).contains(&(field_ut / scale));
        if (far || other) && self.kept.since_recentred >= self.config.n_min {
            self.kept.since_recentred = 0;
            self.moments = Moments::new(*centre_ut, field_ut);
            for age in 0..self.window {
                self.moments.add(self.ring.latest(age));
            }
        }
    }

    pub fn state(&self) -> WindowedState {
        WindowedState {
            slots: (0..self.ring.len()).rev().map(|age| self.ring.slot(age)).collect(),
            window: self.window,
            centre_ut: *self.moments.centre_ut(),
            scale_ut: self.moments.scale_ut(),
            kept: self.kept.clone(),
        }
    }

    /// As new, then in a state of raw samples up to `range_ut`; None when the state does not belong to its config.
    pub fn resume(mut self, state: WindowedState, range_ut: f64) -> Option<Self> {
        let kept = &state.kept;
        let counts = [kept.since_fit, kept.since_recentred, kept.since_change];
        let fits = state.slots.len() <= self.config.n_max
            && state.window <= state.slots.len()
            && state.slots.iter().all(|slot| slot.raw_ut.amax() <= range_ut)
            && state.centre_ut.amax() <= LARGEST_RAW_UT
            && (FIELD_STRENGTHS_UT.0..=FIELD_STRENGTHS_UT.1).contains(&state.scale_ut)
            && counts.into_iter().all(|count| count as u64 <= LARGEST_COUNT)
            && kept.sigma_t.is_none_or(|sigma_t| sigma_t >= 0.0)
            && kept.fit.is_none_or(|fit| is_covariance(&fit.covariance) && fit.residual_rms_ut >= 0.0);
        if !fits {
            return None;
        }
        self.kept = state.kept;
        self.moments = Moments::new(state.centre_ut, state.scale_ut);
        state.slots.into_iter().for_each(|slot| self.ring.push(slot));
        self.resize(state.window);
        Some(self)
    }
}

/// A sample and the cell of the sphere its direction was counted in.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Slot {
    raw_ut: Vector3<f64>,
    cell: Option<u8>,
}

/// The latest samples in a buffer of fixed size.
#[derive(Clone, Debug)]
struct Ring {
    slots: Vec<Slot>,
    capacity: usize,
    next: usize,
}

impl Ring {
    fn new(capacity: usize) -> Self {
        Self { slots: Vec::with_capacity(capacity), capacity, next: 0 }
    }

    fn clear(&mut self) {
        self.slots.clear();
        self.next = 0;
    }

    fn push(&mut self, slot: Slot) {
        if self.slots.len() < self.capacity {
            self.slots.push(slot);
        } else {
            self.slots[self.next] = slot;
        }
        self.next = (self.next + 1) % self.capacity;
    }

    fn len(&self) -> usize {
        self.slots.len()
    }

    fn place(&self, age: usize) -> usize {
        let len = self.slots.len();
        (self.next + 2 * len - 1 - age) % len
    }

    /// The slot `age` steps back: 0 is the latest.
    fn slot(&self, age: usize) -> Slot {
        self.slots[self.place(age)]
    }

    /// The sample `age` steps back: 0 is the latest.
    fn latest(&self, age: usize) -> &Vector3<f64> {
        &self.slots[self.place(age)].raw_ut
    }
}
