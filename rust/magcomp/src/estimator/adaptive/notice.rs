//! What is noticed: large changes, from samples that are gated, and small ones, from evidence over spans. Before a change is
//! called, whether the fit was wrong instead; afterwards, which samples of the segment are older than it.

use super::change;
use super::hypothesis::Gaussian;
use super::parameters::{Vector9, see};
use super::samples::{REVIEWED, SPANS, span_length};
use super::{Adaptive, BLOCK_SPAN, CLOSE_DEG, FORMER, GATE, MOST_TURNS, RECENT, SCANNED_FROM};
use nalgebra::Vector3;

/// Log odds of a gated sample: 2 in 5 are after a change, 1 in 50 where there are spikes. And of one that is not.
const GATED: f64 = 3.0;
const NOT_GATED: f64 = -0.5;
/// Log odds of a large change: three of five.
pub(super) const LARGE_CHANGE: f64 = 8.0;
/// So many gated samples in a row are a change already where they fit a former calibration to so many standard deviations.
pub(super) const RETURNED: usize = 2;
const AS_BEFORE: f64 = 2.5;
/// log B of a small change: e^-10 is one in 22 thousand at most, and far less of what is looked at.
const SMALL_CHANGE: f64 = 10.0;
/// The same while b may drift: a part of what a span misses by is the drift's.
pub(super) const SMALL_CHANGE_ADRIFT: f64 = 14.0;
/// Expected error (degrees) above which evidence that is linearised about the estimate means nothing.
pub(super) const ROUGH_DEG: f64 = 20.0;
/// Log odds by which a prefix of the segment must be older than the change before it is dropped.
const OLDER: f64 = 3.0;
/// Fewest samples that a small change leaves to the segment.
const FEWEST_NEW: usize = 3;
/// Hypotheses that look elsewhere before a change is called.
const RECONSIDERED: usize = 5;
/// Share of its samples that must fit for a segment to be one.
const FITTING_SHARE: f64 = 0.9;

/// Where a large change would have begun among the latest samples, and its log odds.
pub(super) struct Onset {
    pub first: usize,
    pub odds: f64,
}

impl Adaptive {
    /// The log odds of a change summed up from where they are largest. Of the samples that leapt only a first one counts, and
    /// not where the next one is in place again: that was a spike.
    pub(super) fn onset(&self) -> Onset {
        let mut onset = Onset { first: 0, odds: 0.0 };
        for (k, late) in self.late.iter().enumerate() {
            let Some(late) = late else { continue };
            if onset.odds <= 0.0 {
                onset = Onset { first: k, odds: 0.0 };
            }
            let next = self.late.get(k + 1).copied().flatten();
            if late.alone && next.is_some_and(|next| !next.gated) {
                continue;
            }
            if !late.gated {
                onset.odds += NOT_GATED;
            } else if !late.alone || k == onset.first {
                onset.odds += GATED;
            }
        }
        onset
    }

    /// Whether the latest samples, which were gated, fit a former calibration. Of spikes the last one leaps, too.
    pub(super) fn former_is_back(&self) -> bool {
        let latest = &self.late[RECENT - RETURNED..];
        let spikes = latest[RETURNED - 1].is_none_or(|late| late.alone);
        if spikes || !latest.iter().all(|late| late.is_some_and(|late| late.gated)) {
            return false;
        }
        let fits = |former: &Gaussian, raw_ut: &Vector3<f64>| {
            let z = see(&former.mean, &self.unit(raw_ut)).map(|seen| (seen.radius - 1.0) / seen.slope);
            z.is_some_and(|z| z * z < AS_BEFORE * AS_BEFORE * self.noise.total())
        };
        let all_fit = |former: &Gaussian| latest.iter().flatten().all(|late| fits(former, &late.raw_ut));
        self.former.iter().flatten().any(all_fit)
    }

    /// The latest samples from `first` on do not fit.
    pub(super) fn large_change(&mut self, first: usize) {
        let late = self.late;
        let Some(start) = late[first] else { return };
        let base = match self.trial {
            // while it is open what is right, neither the fit nor the noise is known well enough to call it a change
            Some(trial) if self.called || self.is_open() => {
                if !self.called {
                    self.called = !self.reconsider(first);
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
        for late in late[first..].iter().flatten().filter(|late| !late.alone) {
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

    /// A young segment that suddenly fits no more, from `first` on, may have been fitted wrongly: with all its samples, once
    /// more. Whether that helped.
    fn reconsider(&mut self, first: usize) -> bool {
        let late = self.late;
        for late in late[first..].iter().flatten().filter(|late| late.gated) {
            self.samples.add(&late.raw_ut);
        }
        let likelihood = self.likelihood();
        for turn in 0..RECONSIDERED {
            self.rivals.look_elsewhere(&likelihood, self.samples.segment(), self.count as usize + turn);
        }
        self.rivals.refine(&likelihood, 0, MOST_TURNS, 1);
        let fits = |raw_ut: &Vector3<f64>| self.rivals.fits(&self.unit(raw_ut), &self.noise) < GATE * GATE;
        let latest = late[first..].iter().flatten().filter(|late| fits(&late.raw_ut)).count();
        let count = self.samples.age.min(64);
        let all = (0..count).filter(|back| fits(self.samples.latest(*back))).count();
        let good = 5 * latest >= 4 * (RECENT - first) && all as f64 >= FITTING_SHARE * count as f64;
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
        if too_young
            || self.direction_sigma_deg > ROUGH_DEG
            || self.trial.is_some_and(|trial| !trial.released)
            || (self.drift.is_on() && span > BLOCK_SPAN)
        {
            return;
        }
        let Some(posterior) = self.rivals.best().map(|best| best.posterior) else { return };
        let likelihood = self.likelihood_of(self.samples.span(span));
        let enough = if self.drift.is_on() { SMALL_CHANGE_ADRIFT } else { SMALL_CHANGE };
        if change::log_evidence_of_jump(&likelihood, &posterior, enough) < enough {
            return;
        }
        // where samples of late were gated, it began with them; what was not gated before is older
        let onset = self.onset();
        if onset.odds > 0.0 {
            self.large_change(onset.first);
            return;
        }
        let base = change::without(&posterior, &likelihood);
        self.remember(self.trial.and_then(|trial| trial.base));
        self.remember(Some(base));
        self.samples.cut(span);
        self.drop_older(&posterior.mean);
        self.compete(time_ns, Some(base));
    }

    /// Of a span that does not fit tau, the samples before it ceased to fit leave: from the latest backwards, where the sum of
    /// z^2, less what is halfway between its mean and 1, is largest.
    fn drop_older(&mut self, tau: &Vector9) {
        let count = self.samples.age;
        if count > REVIEWED {
            return;
        }
        let variance = self.noise.total();
        let square = |back: usize| {
            let u = self.unit(self.samples.latest(back));
            see(tau, &u).map_or(0.0, |seen| ((seen.radius - 1.0) / seen.slope).powi(2) / variance)
        };
        let usual = 0.5 * (1.0 + (0..count).map(square).sum::<f64>() / count as f64);
        let (mut sum, mut largest, mut kept) = (0.0, f64::NEG_INFINITY, count);
        for back in 0..count {
            sum += square(back) - usual;
            if sum > largest && back + 1 >= FEWEST_NEW {
                (largest, kept) = (sum, back + 1);
            }
        }
        let mut index = 0;
        self.samples.review(|_| {
            index += 1;
            index > count - kept
        });
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
