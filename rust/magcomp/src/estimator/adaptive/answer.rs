//! What is answered: whether the samples lie on any ellipsoid, what is in force, how sure it is and the status.

use super::hypothesis::{Gaussian, NO_EVIDENCE};
use super::notice::ROUGH_DEG;
use super::parameters::Vector9;
use super::publish::{Published, compare, directions, may_compare};
use super::{Adaptive, CLOSE_DEG, RECENT, Trial, angle, spread};
use crate::reading::{Event, EventKind, HoldReason, Missing, ModelOrder, Status};

/// Samples before a first answer is tried.
const JUDGED_FROM: usize = 16;
/// Age of a segment up to which a prior that is strained counts as misfit too.
const UNSURE: usize = 24;
/// Standard deviations of chi-squared above which the samples fit no ellipsoid.
const UNLIKELY: f64 = 3.0;
/// Samples after which hypotheses that fit none of them begin anew, and at which of them: no review falls there.
const RENEWED: usize = 64;
const RENEWED_AT: usize = 55;
/// Where new parameters and those in force before the change contradict each other, how much better (in squares) the new ones
/// must be ...
const MARGIN: f64 = 2.0;
/// ... and by how much to replace what has been released since: of two estimates from the same short arc the later is not the
/// better.
const MARGIN_AGAIN: f64 = 4.0;
/// Expected mean square error, over that at the latest release, from which nothing is released for the time being.
const DOUBT: f64 = 2.0;

impl Adaptive {
    /// Whether the samples of the segment lie on any ellipsoid.
    pub(super) fn judge(&mut self) {
        let Some(best) = self.rivals.best() else { return };
        if best.log_evidence <= NO_EVIDENCE {
            // no hypothesis is near these samples: as at the start
            let Some(latest) = self.late[RECENT - 1] else { return };
            self.move_centre(&latest.raw_ut);
            self.compete(latest.time_ns, None);
            return;
        }
        if !best.is_fitted() {
            return;
        }
        // L is about chi-squared, n +- sqrt(2 n); with the prior's share, of n + 9 degrees of freedom
        let unlikely =
            |value: f64, freedom: f64| value > freedom + UNLIKELY * (2.0 * freedom).sqrt() + 0.5 * UNLIKELY * UNLIKELY;
        let each = || self.samples.segment().count() as f64 / self.noise.correlation();
        let count = self.neighbours().map_or_else(each, |neighbours| neighbours.means() as f64);
        let misfit =
            unlikely(best.samples_cost, count) || (self.samples.age < UNSURE && unlikely(best.cost, count + 9.0));
        if let Some(trial) = &mut self.trial {
            trial.misfit = misfit;
        }
        if let Some(trial) = self.trial.filter(|_| misfit && self.samples.age % RENEWED == RENEWED_AT) {
            if let Some(base) = trial.base {
                let place = best.posterior.mean;
                self.compete(trial.since_ns, trial.base);
                self.trial = Some(trial);
                // too far from the samples to move
                if self.likelihood().at(&base.mean).is_none() {
                    self.rivals.place(&place);
                }
            } else if self.noise.is_known()
                && let Some(latest) = self.late[RECENT - 1]
            {
                // of two ellipsoids, perhaps: as at the start
                self.move_centre(&latest.raw_ut);
                self.compete(latest.time_ns, None);
            }
        }
    }

    /// The gate.
    pub(super) fn publish(&mut self, time_ns: i64) {
        let Some(best) = self.rivals.best().copied() else { return };
        match self.trial {
            None => {
                // from the middle of the samples to now
                let seconds = 0.5 * self.noise.period_s() * self.samples.segment().count() as f64;
                let course = self.motion.course();
                let Gaussian { mean, covariance } =
                    course.map_or(best.posterior, |course| course.ahead(&best.posterior, seconds));
                self.published = Some(Published { tau: mean, covariance, expected: 0.0 });
            }
            Some(trial) => {
                // at the start places are still being sought, and their mean is none of them
                let mean = if trial.base.is_some() { self.rivals.mean() } else { Some(best.posterior.mean) };
                let Some(tau) = mean.filter(|_| may_compare(&self.samples, best.order)) else { return };
                let weight = directions(&self.samples, &self.centre_ut, self.unit_ut, &tau);
                let compared = compare(&self.rivals, &tau, self.published.as_ref(), &self.likelihood(), &weight);
                let limit = self.release_below_deg.to_radians();
                let close = compared.new < CLOSE_DEG.to_radians().powi(2);
                let better = match &self.published {
                    // once released, it may become better, not worse: a doubt that comes up later is waited for
                    // (and what is hardly known replaces nothing, however much better it is predicted to be)
                    Some(published) if trial.released => {
                        let rough = ROUGH_DEG.to_radians().powi(2);
                        let instead = (compared.held_by_mixture / MARGIN_AGAIN).min(rough);
                        compared.new < (DOUBT * published.expected).max(instead)
                    }
                    // nothing has changed: what is in force is what is best, once the others are no longer likely
                    Some(_) if best.order == ModelOrder::Nothing => close && compared.new <= compared.held_by_mixture,
                    Some(_) if !close && compared.contradicts_itself() => compared.new < compared.held / MARGIN,
                    Some(_) => compared.new < compared.held,
                    None => {
                        compared.new < limit * limit && {
                            spread::fills_space(&self.samples, self.noise.variance, self.steadiness.variance())
                        }
                    }
                };
                if !trial.misfit && better && !self.witness.holds(best.order) {
                    self.release(time_ns, trial, &tau, best.order, compared.new);
                } else if let Some(published) = &mut self.published {
                    published.covariance = self.rivals.spread_about(&published.tau);
                    // released too soon: what was held before is predicted to be better
                    if let Some(mut held) = trial.held.filter(|_| trial.released) {
                        held.covariance = self.rivals.spread_about(&held.tau);
                        if weight.expected(&held.covariance) < weight.expected(&published.covariance) {
                            *published = held;
                        }
                    }
                }
            }
        }
        if self.count.is_multiple_of(16) || self.trial.is_some() {
            self.summarise();
        }
    }

    fn release(&mut self, time_ns: i64, trial: Trial, tau: &Vector9, order: ModelOrder, expected: f64) {
        self.published = Some(Published { tau: *tau, covariance: self.rivals.spread_about(tau), expected });
        self.order = order;
        if !trial.released {
            let kind = if order == ModelOrder::Former { EventKind::DeviceStepBack } else { EventKind::DeviceStep };
            if trial.base.is_some() && order != ModelOrder::Nothing {
                self.event = Some(Event { kind, since_ns: trial.since_ns, decided_ns: time_ns });
            }
            self.trial = Some(Trial { released: true, ..trial });
        }
    }

    /// Expected errors over the sphere, degrees.
    fn summarise(&mut self) {
        let Some(published) = &self.published else { return };
        let expected = angle::AngularWeight::sphere(&published.tau).expected(&published.covariance);
        self.direction_sigma_deg = expected.sqrt().to_degrees().min(180.0);
        if self.count.is_multiple_of(16) {
            let largest = published.covariance.symmetric_eigenvalues().max();
            self.worst_sigma_deg = largest.max(0.0).sqrt().to_degrees().min(180.0);
        }
    }

    pub(super) fn status(&self) -> Status {
        match (self.trial, self.published, self.witness.disturbed()) {
            (_, None, _) => Status::Collecting(if self.samples.age < JUDGED_FROM {
                Missing::Samples { have: self.samples.age, need: JUDGED_FROM }
            } else {
                Missing::Directions
            }),
            (_, _, Some(since_ns)) => Status::Disturbed { since_ns },
            // from a cold start, what does not fit tells of the noise at first
            (Some(trial), ..) if trial.misfit && (trial.base.is_some() || self.noise.is_known()) => {
                Status::Disturbed { since_ns: trial.since_ns }
            }
            (Some(trial), ..) if !trial.released && trial.base.is_some() => {
                Status::Suspect { since_ns: trial.since_ns }
            }
            _ if self.direction_sigma_deg > self.release_below_deg => Status::Held(HoldReason::TooLittleRotation),
            _ => Status::Tracking,
        }
    }
}
