//! Change or disturbance: hypotheses that run side by side from the onset of a misfit, compared by their likelihoods.
//!
//! ```text
//! nothing   the filter as it was, predicted only; has won when its samples fit again
//! device    P_bb += s^2 I, P_ee += T, |m| freed with the trace: the device's disturbance stepped, m holds
//! place     P_mm += s^2 I, updates correct m and d only: the field of the place stepped, the calibration holds
//! s = max(mean |v| of the gated samples, 8 uT),   l = -(min(NIS, gate) + ln det S) / 2,   L += dt / 10 ms (l_device - l_place)
//! ```
//! Source: docs/dev/METHOD-AIDED.md; starting at the onset instead of at the declaration, holding the calibration while undecided and
//! the recall of a former calibration are new.

use super::measure::{ALL_BUT_FIELD, Innovation, NONE};
use super::running::Running;
use super::state::{FIELD, Filter, HARD_IRON};
use super::step::{FrameStep, SAMPLE_S};
use super::tuning::Tuning;
use super::watch::Former;
use crate::estimator::answer::LEAST_TOLD_UT;
use crate::explanation::{ChangeHypothesis, ChangeKind};
use crate::math::elementary::gain;
use crate::reading::EventKind;
use crate::strength::STRONGEST_AXIS_UT;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;

/// Choice: a hypothesis has failed when most samples of late were a misfit to it; so has the filter as it was.
const MOST: f64 = 0.5;

/// What just happened in a trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// Goes on.
    Open,
    /// Neither fits: they began anew.
    Neither,
    /// After a pause: only the device's turn was unknown.
    Unchanged,
    /// The device's disturbance stepped.
    Device,
    /// The place's field stepped (told once, when found).
    Place,
    /// The changed place has lasted: take it as the new one.
    NewPlace,
}

/// What a trial began with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub(crate) enum Began {
    /// Samples that do not fit.
    #[default]
    Misfit,
    /// A pause, in which the turn was guessed: `place` is then that nothing but it changed.
    Pause,
    /// Samples that fit a changed place no longer: the hypotheses started anew.
    ChangedPlace,
}

/// How far a trial has come.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) enum Stage {
    /// The hypotheses are compared.
    #[default]
    Comparing,
    /// The field of the place was found to have changed.
    Place {
        /// For how long it has held.
        held_s: f64,
        /// When it was found, or later, when nearly all samples of late fitted it.
        fitted_ns: i64,
    },
}

/// The hypotheses `device` and `place`, running.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Trial {
    pub(super) began: Began,
    stage: Stage,
    pub(super) onset_ns: i64,
    pub(super) device: Filter,
    pub(super) place: Filter,
    /// `device` is a former calibration.
    recalled: bool,
    /// How long a change must hold, s.
    pub(super) hold_s: f64,
    log_ratio: f64,
    device_misfit: f64,
    place_misfit: f64,
    /// How far the device was turned while they were compared.
    pub(super) rotation_rad: f64,
    /// Seconds since the hypotheses were started (last).
    age_s: f64,
}

impl Trial {
    /// Starts `place` from the filter as it is, and `device` from the field of the place `there`.
    pub(super) fn start(running: &Running, there: &Filter, former: Option<&Former>, tuning: &Tuning) -> Self {
        let Running { filter, watch, .. } = running;
        let step_ut = watch.misfit_ut.max(tuning.smallest_step_ut);
        let (mut device, mut place) = (there.clone(), filter.clone());
        let recall = former.filter(|_| watch.fits_former(tuning));
        if let Some(former) = recall {
            former.put_into(&mut device, tuning);
        } else {
            device.add_variance(HARD_IRON, step_ut * step_ut);
            let iron = (tuning.iron_sd * (step_ut / STRONGEST_AXIS_UT).min(1.0)).powi(2);
            device.add_soft_iron_variance(iron);
            // the trace of M may have stepped too: in the gauge of the filter that is a step of |m|
            let m = device.part(FIELD);
            device.add(FIELD, &(m * m.transpose() * (iron / 3.0)));
        }
        place.add_variance(FIELD, step_ut * step_ut);
        Self { onset_ns: watch.since_ns, device, place, recalled: recall.is_some(), ..Self::default() }
    }

    /// Whether the field of the place was found to have changed.
    pub(super) fn is_place(&self) -> bool {
        self.stage != Stage::Comparing
    }

    /// What is told once `device` has won over `filter`, which is as it was before; None if it is but relearned.
    pub(crate) fn device_event(&self, filter: &Filter, tuning: &Tuning) -> Option<EventKind> {
        let moved_ut = (self.device.part(HARD_IRON) - filter.part(HARD_IRON)).norm();
        // after a pause b may have walked
        let least_ut = if self.began == Began::Pause { tuning.smallest_step_ut } else { LEAST_TOLD_UT };
        let kind = if self.recalled { EventKind::DeviceStepBack } else { EventKind::DeviceStep };
        (moved_ut > least_ut).then_some(kind)
    }

    /// The device turns.
    pub(crate) fn turn(&mut self, step: &FrameStep) {
        self.device.propagate(&step.increment_rad, step.dt_s, &step.noise);
        self.place.propagate(&step.increment_rad, step.dt_s, &step.noise);
    }

    /// One sample; the filter is as it was, predicted to now.
    pub(super) fn step(
        &mut self,
        step: &FrameStep,
        running: &Running,
        former: Option<&Former>,
        tuning: &Tuning,
    ) -> Verdict {
        let Running { filter, watch, .. } = running;
        self.turn(step);
        self.walk_in_a_ramp(step.dt_s, tuning);
        self.update(step, tuning);
        // a cover comes off in a while: what it leaves shows later than the onset
        if let Some(former) = former.filter(|_| !self.recalled && !self.is_place() && watch.fits_former(tuning)) {
            self.recall(filter, former, tuning);
        }
        // while the filter as it was explains the samples, nothing else wins
        let unchanged = self.began != Began::Pause && !self.is_place() && watch.share < MOST;
        if step.resting || unchanged {
            return Verdict::Open;
        }
        self.decide(step.time_ns, step.dt_s, tuning).unwrap_or_else(|| {
            *self = self.anew(running, former, tuning);
            Verdict::Neither
        })
    }

    /// While a change takes place, what it changes is unknown.
    fn walk_in_a_ramp(&mut self, dt_s: f64, tuning: &Tuning) {
        if tuning.ramp && self.age_s < tuning.ramp_s {
            let variance = tuning.smallest_step_ut.powi(2) * dt_s / tuning.ramp_s;
            self.device.add_variance(HARD_IRON, variance);
            self.place.add_variance(FIELD, variance);
        }
    }

    /// Both hypotheses are tested by a sample, and learn from it where it fits them.
    fn update(&mut self, step: &FrameStep, tuning: &Tuning) {
        if let Some(variance) = step.bias_variance {
            // whatever has changed, at rest the rate is the bias
            self.device.update_bias(&step.rate_rad_s, variance);
            self.place.update_bias(&step.rate_rad_s, variance);
        }
        if step.resting {
            return;
        }
        let innovation = |it: &Filter| it.innovation(step, tuning);
        if let (Some(device), Some(place)) = (innovation(&self.device), innovation(&self.place)) {
            self.compare(&device, &place, step, tuning);
            if device.nis < tuning.gate {
                self.device.update(&device, NONE);
            }
            if place.nis < tuning.gate {
                self.place.update(&place, ALL_BUT_FIELD);
            }
        }
    }

    /// `device` becomes the filter as it was, with a former calibration.
    fn recall(&mut self, filter: &Filter, former: &Former, tuning: &Tuning) {
        self.device = filter.clone();
        former.put_into(&mut self.device, tuning);
        self.recalled = true;
        self.log_ratio = 0.0;
        self.device_misfit = 0.0;
    }

    /// The hypotheses start anew: a ramp, or a field that keeps changing. In a place that held, the device may have stepped.
    fn anew(&self, running: &Running, former: Option<&Former>, tuning: &Tuning) -> Self {
        let (onset_ns, there) = match self.stage {
            Stage::Place { held_s, fitted_ns } if tuning.place_holds && held_s > tuning.settled_s => {
                (fitted_ns, &self.place)
            }
            _ => (self.onset_ns, &running.filter),
        };
        let began = if self.is_place() { Began::ChangedPlace } else { self.began };
        Self { onset_ns, began, hold_s: self.hold_s, ..Self::start(running, there, former, tuning) }
    }

    /// The hypotheses, the likelier first.
    pub(crate) fn explain(&self) -> [ChangeHypothesis; 2] {
        let of = |kind, log_odds: f64, gated_share| {
            let gated_share = Some(gated_share);
            ChangeHypothesis { kind, onset_ns: self.onset_ns, log_odds: log_odds.min(0.0), gated_share }
        };
        let device = if self.recalled { ChangeKind::DeviceBack } else { ChangeKind::Device };
        let place = if self.began == Began::Pause { ChangeKind::Unchanged } else { ChangeKind::Place };
        let device = of(device, self.log_ratio, self.device_misfit);
        let place = of(place, -self.log_ratio, self.place_misfit);
        if self.log_ratio < 0.0 { [place, device] } else { [device, place] }
    }

    fn compare(&mut self, device: &Innovation, place: &Innovation, step: &FrameStep, tuning: &Tuning) {
        let log = |i: &Innovation| -0.5 * (i.nis.min(tuning.gate) + i.ln_det);
        let weight = (step.dt_s / SAMPLE_S) * f64::from(self.age_s >= tuning.ramp_s);
        self.log_ratio += weight * (log(device) - log(place));
        let gain = gain(step.dt_s, tuning.quick_s);
        self.device_misfit += gain * (f64::from(device.nis > tuning.gate) - self.device_misfit);
        self.place_misfit += gain * (f64::from(place.nis > tuning.gate) - self.place_misfit);
        self.rotation_rad += step.angle_rad;
        self.age_s += step.dt_s;
    }

    /// `None` when what was believed has stopped fitting: the hypotheses start anew.
    fn decide(&mut self, time_ns: i64, dt_s: f64, tuning: &Tuning) -> Option<Verdict> {
        let (device_fits, place_fits) = (self.device_misfit < MOST, self.place_misfit < MOST);
        if let Stage::Place { held_s, fitted_ns } = &mut self.stage {
            if self.place_misfit < 0.5 * tuning.suspect_share {
                *fitted_ns = time_ns;
            }
            *held_s += dt_s;
            let is_new = *held_s > tuning.place_time_s;
            return place_fits.then_some(if is_new { Verdict::NewPlace } else { Verdict::Open });
        }
        if !device_fits && !place_fits {
            return None;
        }
        // a former calibration that fits again needs less
        let (share, hold_s) = if self.recalled { (0.5, 0.0) } else { (1.0, self.hold_s) };
        let rotation_rad = tuning.decide_rotation_rad * (share + hold_s / tuning.quick_s);
        let device_holds = self.device_misfit < tuning.suspect_share;
        Some(if self.rotation_rad < rotation_rad || self.age_s < tuning.ramp_s + hold_s {
            Verdict::Open
        } else if self.log_ratio > tuning.decide_log_ratio && device_holds {
            Verdict::Device
        } else if self.began == Began::Pause && place_fits {
            Verdict::Unchanged
        } else if self.log_ratio < -tuning.decide_log_ratio && place_fits {
            self.stage = Stage::Place { held_s: 0.0, fitted_ns: time_ns };
            Verdict::Place
        } else {
            Verdict::Open
        })
    }
}

#[cfg(test)]
mod tests;
