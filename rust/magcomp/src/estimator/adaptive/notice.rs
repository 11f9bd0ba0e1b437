//! What is noticed: large changes, from samples that are gated, and small ones, from evidence over spans. Before a change is
//! called, whether the fit was wrong instead; afterwards, which samples of the segment are older than it.

use super::change;
use super::hypothesis::Gaussian;
use super::parameters::{Vector9, see};
use super::samples::{REVIEWED, SPANS, span_length};
use super::{Adaptive, BLOCK_SPAN, CLOSE_DEG, FORMER, GATE, MOST_TURNS, RECENT, SCANNED_FROM};
use nalgebra::Vector3;

/// log B of a small change: e^-14 is one in 1.2 million.
const SMALL_CHANGE: f64 = 14.0;
/// Log odds by which a prefix of the segment must be older than the change before it is dropped.
const OLDER: f64 = 3.0;
/// Hypotheses that look elsewhere before a change is called.
const RECONSIDERED: usize = 5;
/// Share of its samples that must fit for a segment to be one.
const FITTING_SHARE: f64 = 0.9;

impl Adaptive {
    /// Most of the latest samples are gated.
    pub(super) fn large_change(&mut self) {
        let late = self.late;
        let first = late.iter().flatten().position(|late| late.gated).unwrap_or(0);
        let Some(start) = late.iter().flatten().nth(first).copied() else { return };
        let base = match self.trial {
            // while it is open what is right, neither the fit nor the noise is known well enough to call it a change
            Some(trial) if self.is_open() => {
                if self.reconsider() {
                    return;
                }
                let begun = trial.released && self.noise.is_known();
                trial.base.or_else(|| self.rivals.best().filter(|_| begun).map(|best| best.posterior))
            }
            _ => self.rivals.best().map(|best| best.posterior),
        };
        if let Some(trial) = self.trial.filter(|trial| trial.released) {
            self.remember(trial.base);
        }
        if self.trial.is_none_or(|trial| trial.released) {
            self.remember(base);
        }
        let mut base = base;
        let by = (self.centre_ut - start.raw_ut) / self.unit_ut;
        self.move_centre(&start.raw_ut);
        if let Some(base) = &mut base {
            base.shift(&by);
        }
        let since_ns = self.trial.filter(|trial| !trial.released).map_or(start.time_ns, |trial| trial.since_ns);
        self.compete(since_ns, base);
        for late in late.iter().flatten().skip(first).filter(|late| !late.alone) {
            self.samples.add(&late.raw_ut);
        }
        // setting them up has cost enough: so few samples tell at most whether a former calibration is back
        self.rivals.turn_to_former();
        self.fit_some(FORMER);
    }

    /// Whether the hypotheses since the latest change still disagree, or the best of them is not sure.
    pub(super) fn is_open(&self) -> bool {
        self.trial.is_some_and(|trial| {
            !trial.released
                || (trial.base.is_none() && !self.noise.is_known())
                || self.direction_sigma_deg > CLOSE_DEG
                || !self.rivals.agree()
        })
    }

    /// A young segment that suddenly fits no more may have been fitted wrongly: with all its samples, once more. Whether that helped.
    fn reconsider(&mut self) -> bool {
        let late = self.late;
        for late in late.iter().flatten().filter(|late| late.gated) {
            self.samples.add(&late.raw_ut);
        }
        let likelihood = self.likelihood_of(self.samples.segment());
        for turn in 0..RECONSIDERED {
            self.rivals.look_elsewhere(&likelihood, self.samples.segment(), self.count as usize + turn);
        }
        self.rivals.refine(&likelihood, 0, MOST_TURNS);
        let fits = |raw_ut: &Vector3<f64>| self.rivals.fits(&self.unit(raw_ut), &self.noise) < GATE * GATE;
        let latest = late.iter().flatten().filter(|late| fits(&late.raw_ut)).count();
        let count = self.samples.age.min(64);
        let all = (0..count).filter(|back| fits(self.samples.latest(*back))).count();
        let good = latest + 2 > RECENT && all as f64 >= FITTING_SHARE * count as f64;
        if good {
            self.late.iter_mut().flatten().for_each(|late| late.gated = false);
        }
        good
    }

    /// A calibration that held for a while may come back.
    pub(super) fn remember(&mut self, known: Option<Gaussian>) {
        let Some(known) = known else { return };
        let near = |former: &Gaussian| (former.mean - known.mean).norm() < 0.02;
        let place = self.former.iter().position(|former| former.as_ref().is_some_and(near)).unwrap_or(FORMER - 1);
        self.former[..=place].rotate_right(1);
        self.former[0] = Some(known);
    }

    /// One span a time, each as often as it is renewed by a quarter.
    pub(super) fn look_for_small_change(&mut self, time_ns: i64) {
        let span = ((self.count / 2).trailing_zeros() as usize).min(SPANS - 1);
        let length = span_length(span);
        let age = self.samples.age;
        let too_young = age < SCANNED_FROM || age < 2 * length || !self.noise.is_known();
        if too_young || self.trial.is_some_and(|trial| !trial.released) || (self.drift.is_on() && span > BLOCK_SPAN) {
            return;
        }
        let Some(posterior) = self.rivals.best().map(|best| best.posterior) else { return };
        let likelihood = self.likelihood_of(self.samples.span(span));
        if change::log_evidence_of_jump(&likelihood, &posterior, SMALL_CHANGE) < SMALL_CHANGE {
            return;
        }
        let base = change::without(&posterior, &likelihood);
        self.remember(self.trial.and_then(|trial| trial.base));
        self.remember(Some(base));
        self.samples.cut(span);
        self.compete(time_ns, Some(base));
    }

    /// Spikes that came in before the fit was good enough to see them leave again, and so do samples that are older than
    /// the change.
    pub(super) fn review(&mut self) {
        let older = self.older_than_the_change();
        let (centre_ut, unit_ut) = (self.centre_ut, self.unit_ut);
        let (rivals, noise) = (&self.rivals, &self.noise);
        let mut index = 0;
        self.samples.review(|raw_ut| {
            index += 1;
            index > older && rivals.fits(&((raw_ut - centre_ut) / unit_ut), noise) < GATE * GATE
        });
    }

    /// How many samples at the segment's start fit what was in force before better than what is best now.
    fn older_than_the_change(&self) -> usize {
        let Some((base, best)) = self.trial.and_then(|trial| trial.base).zip(self.rivals.best()) else { return 0 };
        let distance = |tau: &Vector9, u: &Vector3<f64>| {
            see(tau, u).map_or(0.0, |seen| ((seen.radius - 1.0) / seen.slope).powi(2))
        };
        let (mut sum, mut largest, mut older) = (0.0, OLDER * 2.0 * self.noise.variance, 0);
        for back in (0..self.samples.age.min(REVIEWED)).rev() {
            let u = self.unit(self.samples.latest(back));
            sum += distance(&best.posterior.mean, &u) - distance(&base.mean, &u);
            if sum > largest {
                (largest, older) = (sum, self.samples.age - back);
            }
        }
        older
    }
}
