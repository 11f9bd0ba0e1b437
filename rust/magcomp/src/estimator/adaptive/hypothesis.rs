//! A hypothesis: since its onset all samples share one tau, and what was known before is a Gaussian N(tau_0, Lambda^-1).
//! The estimate is the minimum of
//!     F(tau) = L(tau) + (tau - tau_0)^T Lambda (tau - tau_0)                  by Levenberg-Marquardt,
//! and from there one step by the sandwich of Godambe (1960). Noise makes half the score g of L have the variance
//! R = w/D J^T S J, but part of the curvature, V = w/D v J^T G J, is noise too, along what the motion does not show:
//!     Y = (R + V/2)^-1 (R - V),   information R Y^2,   score (Y^2)^T g:   nothing where all curvature is noise
//!     log evidence = -F/2 + (log det Lambda - log det (information + Lambda)) / 2             (Laplace)
//! Between fits each sample adds its predictive probability, so that hypotheses are comparable at every sample and need no
//! common schedule:  log joint = base + evidence of the moments + predictive terms since the latest fit - price of samples left out.
//!
//! When tau is known well the moments are absorbed into the Gaussian, and b goes on (`motion`).

use super::likelihood::{Expansion, Likelihood, Point};
use super::motion::Motion;
use super::noise::Level;
use super::parameters::{COUNT, Gaussian, Tau, TauMatrix, distance, is_bounded};
use super::setting::{Sample, Setting};
use super::vertical::{VerticalLikelihood, VerticalMoments, miss};
use crate::ellipsoid::Moments;
use crate::math::ldl::{self, Ldl};
use nalgebra::Vector3;

/// What a hypothesis says has changed at its onset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Nothing was known before.
    Cold,
    HardIron,
    All,
    /// The strength and the dip of the field of the place.
    Place,
    /// Back to a former calibration.
    Former,
}

/// See the module.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Hypothesis {
    pub kind: Kind,
    /// The change before this one.
    pub parent: u32,
    /// Which of the sizes of its kind, or which former calibration.
    pub size: u8,
    /// Names the change: twins, which explain the samples from two places, share it.
    pub id: u32,
    pub onset_ns: i64,
    pub motion: Motion,
    prior: Tau,
    information: TauMatrix,
    log_det: f64,
    centre: Vector3<f64>,
    moments: Moments,
    vertical: VerticalMoments,
    /// Means of neighbours among the moments.
    groups: f64,
    pub known: Gaussian,
    base: f64,
    fitted: f64,
    pending: f64,
    /// Price of the samples that were left out since the moments began.
    paid: f64,
    next_fit: f64,
    /// Samples since the onset.
    pub age: f64,
    damping: f64,
    /// What was known before the change, until the change is certain.
    pub former: Option<Gaussian>,
    /// Log joint probability of a change that began then and is in progress still, as long as `former` is there: by how much
    /// samples miss what was known before differs from one group to the next by about a small change.
    pub in_progress: f64,
    pub missed_before: f64,
    /// Expected direction error all around, rad^2.
    pub error: f64,
    next_twin: f64,
}

/// Reference for the level of the noise, units^2: only keeps numbers small.
const LEVEL: f64 = 1e-4;
/// Parameters of a fit: that many samples are not judged by it.
pub(super) const PARAMETERS: f64 = 9.0;
/// Iterations of a fit with few samples (the minimum moves far), with some, and later.
const ITERATIONS: [(f64, usize); 3] = [(32.0, 15), (128.0, 6), (f64::INFINITY, 3)];
const DAMPINGS: usize = 6;
const NO_EVIDENCE: f64 = -1e3;

/// L + L_v.
struct Both {
    strength: Likelihood,
    vertical: VerticalLikelihood,
}

impl Both {
    fn at(&self, tau: &Tau) -> Option<(f64, Point)> {
        let point = self.strength.at(tau)?;
        Some((point.cost + self.vertical.cost(tau), point))
    }

    fn derivatives(&self, tau: &Tau, point: &Point) -> (Tau, TauMatrix) {
        let ((a, b), (c, d)) = (self.strength.derivatives(tau, point), self.vertical.derivatives(tau));
        (a + c, b + d)
    }

    fn expansion(&self, tau: &Tau, point: &Point) -> Expansion {
        let (Expansion { gradient, hessian, noise }, (g, h)) =
            (self.strength.expansion(tau, point), self.vertical.derivatives(tau));
        Expansion { gradient: gradient + g, hessian: hessian + h, noise }
    }
}

impl Hypothesis {
    /// At rest, with the prior's Gaussian; coordinates about `centre`.
    pub fn new(kind: Kind, prior: &Gaussian, centre: &Vector3<f64>, base: f64, at: &Setting) -> Option<Self> {
        let factors = Ldl::new(&prior.covariance)?;
        Some(Self {
            kind,
            parent: 0,
            size: 0,
            id: 0,
            onset_ns: 0,
            motion: Motion::new(false, Vector3::zeros(), at),
            prior: prior.mean,
            information: factors.inverse(),
            log_det: -factors.log_det,
            centre: *centre,
            moments: Moments::new(centre * at.unit_ut, at.unit_ut),
            vertical: VerticalMoments::new(),
            groups: 0.0,
            known: *prior,
            base,
            fitted: 0.0,
            pending: 0.0,
            paid: 0.0,
            next_fit: 1.0,
            age: 0.0,
            damping: 0.0,
            former: None,
            in_progress: base,
            missed_before: 0.0,
            error: f64::MAX,
            next_twin: 8.0,
        })
    }

    /// Log of the joint probability of the hypothesis and all samples.
    pub fn log_joint(&self) -> f64 {
        self.base + self.fitted + self.pending
    }

    pub fn centre(&self) -> &Vector3<f64> {
        &self.centre
    }

    pub fn samples(&self) -> f64 {
        self.moments.count() as f64
    }

    pub fn has_news(&self) -> bool {
        self.pending != 0.0
    }

    /// What sets a fork from this hypothesis apart is only how b moves: it tells the same change, and is as old.
    pub fn continues(&mut self, other: &Self) {
        (self.id, self.size, self.parent) = (other.id, other.size, other.parent);
        (self.age, self.former, self.error, self.onset_ns) = (other.age, other.former, other.error, other.onset_ns);
        (self.in_progress, self.missed_before) = (other.in_progress, other.missed_before);
        self.next_fit = 8.0;
    }

    /// Whether it knows enough to tell that a sample is wrong.
    pub fn judges(&self, at: &Setting) -> bool {
        self.age > PARAMETERS && self.error < at.tuning.unsure_deg.to_radians().powi(2) * at.level.kappa
    }

    /// Whether a miss of a mean of so many samples, which its prediction knows within rho, is likelier a disturbance.
    fn is_off(e: f64, rho: f64, count: f64, at: &Setting) -> bool {
        let variance = at.level.white / count + at.level.uneven + at.tuning.doubt * rho / at.level.kappa;
        0.5 * e * e / variance > at.half_square * count
    }

    /// A mean's distance from what is predicted, units, where that is a surprise.
    pub fn surprise(&self, u: &Vector3<f64>, count: f64, at: &Setting) -> Option<f64> {
        let (e, g) = distance(&self.known.mean, u)?;
        let rho = g.dot(&(self.known.covariance * g)).max(0.0);
        Self::is_off(e, rho, count, at).then_some(e)
    }

    /// A mean of samples enters, or pays the price of a disturbed one.
    pub fn add(&mut self, sample: &Sample, at: &Setting) {
        let level = &at.level;
        let n = sample.count as f64;
        let Some((e, g)) = distance(&self.known.mean, &sample.u) else { return };
        let rho = g.dot(&(self.known.covariance * g)).max(0.0);
        let per_sample = |variance: f64, kappa: f64| (0.5 - 0.5 * (variance / LEVEL).ln()) / kappa;
        let vertical = sample.up.map_or(0.0, |_| n * per_sample(level.vertical.0, level.vertical.1));
        let baseline = per_sample(level.white, level.kappa) + vertical;
        self.age += n;
        if sample.stale {
            return;
        }
        if let Some((miss, _)) = self.former.and_then(|former| distance(&former.mean, &sample.u)) {
            let small = at.tuning.small_ut / at.unit_ut;
            let step = (miss - self.missed_before) / small;
            self.in_progress -= (small / level.white.sqrt()).ln() + 0.5 * step * step;
            self.missed_before = miss;
        }
        if self.judges(at) && Self::is_off(e, rho, n, at) {
            let cost = at.price * n - baseline;
            self.pending -= cost;
            self.paid += cost;
            return;
        }
        let own = level.kappa * level.white / n;
        self.pending += baseline;
        self.moments.add_mean(&sample.raw_ut, sample.count);
        self.groups += 1.0;
        let Some(up) = sample.up else {
            self.pending -= 0.5 * (e * e / (own + rho)).min(2.0 * at.half_square * n) + 0.5 * (1.0 + rho / own).ln();
            return;
        };
        // both constraints at once: what is not known moves them together
        let (v, by_v) = miss(&self.known.mean, &sample.u, &up);
        let p = self.known.covariance * by_v;
        let own_v = level.vertical.0 * level.vertical.1 / n;
        let (cross, rho_v) = (g.dot(&p), by_v.dot(&p).max(0.0));
        let (a, d) = (own + rho, own_v + rho_v);
        let determinant = (a * d - cross * cross).max(own * own_v);
        let square = (e * e * d - 2.0 * e * v * cross + v * v * a) / determinant;
        self.pending -= 0.5 * square.min(2.0 * at.half_square * n) + 0.5 * (determinant / (own * own_v)).ln();
        self.vertical.add(&(sample.u - self.centre), &up, sample.count);
    }

    fn likelihood(&self, level: &Level) -> Both {
        let count = self.moments.count() as f64;
        let variance = level.white * self.groups / count;
        Both {
            strength: Likelihood::new(&self.moments, self.centre, level.white, variance, level.kappa),
            vertical: self.vertical.likelihood(&self.centre, level.vertical.0, level.vertical.1),
        }
    }

    /// F.
    fn total(&self, likelihood: &Both, tau: &Tau) -> Option<f64> {
        let d = tau - self.prior;
        Some(likelihood.at(tau)?.0 + d.dot(&(self.information * d)))
    }

    /// At most so many iterations towards the minimum of F, until one lowers it by less than `settled`; where to, F there, and how many it took.
    fn descend(
        &self,
        likelihood: &Both,
        from: &Tau,
        most: usize,
        damping: &mut f64,
        settled: f64,
    ) -> Option<(Tau, f64, usize)> {
        let mut tau = *from;
        let mut f = self.total(likelihood, &tau)?;
        let mut done = 0;
        while done < most {
            done += 1;
            let (_, point) = likelihood.at(&tau)?;
            let (gradient, hessian) = likelihood.derivatives(&tau, &point);
            let gradient = gradient + self.information * (tau - self.prior);
            let hessian = hessian + self.information;
            let mut better = None;
            for _ in 0..DAMPINGS {
                let mut damped = hessian;
                (0..COUNT).for_each(|i| damped[(i, i)] *= 1.0 + *damping);
                let next = ldl::solve(&damped, &-gradient).map(|step| tau + step);
                if let Some(next) = next
                    && let Some(lower) = self.total(likelihood, &next).filter(|lower| *lower <= f)
                {
                    better = Some((next, lower));
                    *damping = if *damping < 1e-3 { 0.0 } else { *damping * 0.1 };
                    break;
                }
                *damping = (*damping * 30.0).max(1e-3);
            }
            let Some((next, lower)) = better else { break };
            let gain = f - lower;
            (tau, f) = (next, lower);
            if gain < settled {
                break;
            }
        }
        *damping = damping.min(1.0);
        Some((tau, f, done))
    }

    /// Whether the samples have become more by enough for another fit.
    pub fn wants_fit(&self) -> bool {
        self.samples() >= self.next_fit
    }

    /// The estimate, its covariance and the evidence of the samples so far. Returns the iterations that it took.
    pub fn fit(&mut self, at: &Setting) -> usize {
        let (count, level) = (self.samples(), &at.level);
        self.next_fit = count * at.tuning.growth + 0.5;
        if count <= 0.0 {
            return 0;
        }
        let likelihood = self.likelihood(level);
        let most = ITERATIONS.iter().find(|(below, _)| count < *below).map_or(3, |(_, most)| *most);
        let mut damping = self.damping;
        let settled = at.tuning.settled;
        let mut best = self.descend(&likelihood, &self.known.mean, most, &mut damping, settled);
        let mut iterations = best.map_or(1, |(.., done)| done);
        if best.is_none_or(|(_, f, _)| f > 2.0 * (self.groups - at.tuning.log_hopeless)) {
            let again = self.descend(&likelihood, &self.prior, ITERATIONS[0].1, &mut 1e-2, settled);
            iterations += again.map_or(1, |(.., done)| done);
            if again.is_some_and(|(_, lower, _)| best.is_none_or(|(_, f, _)| lower < f)) {
                best = again;
            }
        }
        self.damping = damping;
        match best {
            Some((tau, f, _)) => self.settle(&likelihood, &tau, f, at),
            None => self.fitted = NO_EVIDENCE,
        }
        iterations
    }

    /// From the minimum to the estimate: see the module.
    fn settle(&mut self, likelihood: &Both, tau: &Tau, f: f64, setting: &Setting) {
        let level = &setting.level;
        let Some((cost, point)) = likelihood.at(tau) else { return };
        let at = likelihood.expansion(tau, &point);
        let softened = at.hessian + at.noise * setting.tuning.softened + TauMatrix::identity() * 1e-9;
        let Some(factors) = Ldl::new(&softened) else { return };
        let y = factors.solve_matrix(&(at.hessian - at.noise));
        let told = y * y;
        let information = at.hessian * told;
        let score = told.tr_mul(&at.gradient);
        let posterior = (information + information.transpose()) * 0.5 + self.information;
        let Some(factors) = Ldl::new(&posterior) else { return };
        let towards = -factors.solve(&(score + self.information * (tau - self.prior)));
        let curvature = at.hessian - at.noise;
        let (mut mean, mut total, mut part) = (*tau, f, 1.0);
        for _ in 0..3 {
            let step = towards * part;
            let rise = 2.0 * at.gradient.dot(&step) + step.dot(&(curvature * step));
            if let Some((there, _)) = likelihood.at(&(tau + step))
                && let Some(higher) = self.total(likelihood, &(tau + step))
                && (there - cost - rise).abs() < 1.0 + 0.5 * rise.abs()
                && higher < f + 9.0
            {
                (mean, total) = (tau + step, higher);
                break;
            }
            part *= 0.3;
        }
        self.known = Gaussian { mean, covariance: factors.inverse() };
        // relative to what samples of this level cost, so that the level itself does not matter to first order
        let (groups, verticals) = (self.groups / level.kappa, self.vertical.count() / level.vertical.1);
        self.fitted = -self.paid
            - 0.5 * (total - groups - verticals)
            - 0.5 * groups * (level.white / LEVEL).ln()
            - 0.5 * verticals * (level.vertical.0 / LEVEL).ln()
            + 0.5 * (self.log_det - factors.log_det);
        if !self.fitted.is_finite() {
            self.fitted = NO_EVIDENCE;
        }
        self.pending = 0.0;
        self.error = self.known.error();
    }

    /// Whether another place may explain the same samples: asked ever more rarely.
    pub fn looks_for_twin(&mut self, wider_than: f64) -> bool {
        let looks =
            self.samples() >= self.next_twin && self.error > wider_than && (self.kind == Kind::Cold || self.size == 1);
        if looks {
            self.next_twin = self.samples() * 1.5;
        }
        looks
    }

    /// The same samples explained nearly as well from `start`.
    pub fn twin(&self, at: &Setting, start: &Tau) -> Option<Self> {
        let likelihood = self.likelihood(&at.level);
        let (tau, f, _) = self.descend(&likelihood, start, 12, &mut 1e-2, at.tuning.settled)?;
        let own = self.total(&likelihood, &self.known.mean)?;
        if (tau - self.known.mean).norm() < at.tuning.same_place || f > own + at.tuning.twin_worse {
            return None;
        }
        let mut twin = self.clone();
        twin.known.mean = tau;
        twin.fit(at);
        ((twin.known.mean - self.known.mean).norm() > at.tuning.same_place).then_some(twin)
    }

    /// b on the other side of the samples' plane.
    pub fn mirrored(&self) -> Tau {
        let (mean, covariance) = self.moments.cloud();
        let mean = mean + self.centre;
        let eigen = covariance.symmetric_eigen();
        let normal: Vector3<f64> = eigen.eigenvectors.column(eigen.eigenvalues.imin()).into();
        let mut tau = self.known.mean;
        let off = normal * (2.0 * normal.dot(&(super::parameters::centre(&tau) - mean)));
        (0..3).for_each(|i| tau[6 + i] -= off[i]);
        tau
    }

    /// A start along one of the axes from the samples' mean, before much is known.
    pub fn beside(&self, axis: usize, sign: f64) -> Tau {
        let (mean, _) = self.moments.cloud();
        let mean = mean + self.centre;
        let mut tau = self.prior;
        (0..3).for_each(|i| tau[6 + i] = mean[i]);
        tau[6 + axis] += sign;
        tau
    }

    /// Whether both are of the same change and in the same place, no further apart than `same_place`.
    pub fn is_twin(&self, other: &Self, same_place: f64) -> bool {
        self.id == other.id
            && self.motion.moves == other.motion.moves
            && (self.known.mean - other.known.mean).norm() < same_place
    }

    /// Whether both say the same of nearly the same time: onsets are kept on a grid that doubles with their age.
    pub fn is_neighbour(&self, other: &Self, time_ns: i64) -> bool {
        let age = |h: &Self| time_ns.saturating_sub(h.onset_ns) as f64;
        let says = |h: &Self| (h.kind, h.size, h.motion.moves, h.parent);
        let same = says(self) == says(other) && self.id != other.id;
        same && self.kind != Kind::Cold && age(self).max(age(other)) < 2.0 * age(self).min(age(other))
    }

    /// Moments become prior where that is near enough to Gaussian, and b walks on.
    pub fn absorb_if_known(&mut self, at: &Setting) {
        let (seconds, tuning) = (self.samples() * at.period_s, at.tuning);
        let below = if self.motion.moves { tuning.absorb_moving_deg } else { tuning.absorb_deg };
        if seconds >= 8.0 * tuning.group_s && self.samples() >= PARAMETERS && self.error.sqrt() < below.to_radians() {
            self.absorb(seconds, at);
        }
    }

    fn absorb(&mut self, seconds: f64, at: &Setting) {
        let Some((known, factors, motion)) = self.motion.carry(&self.known, &self.prior, seconds, at) else { return };
        if !is_bounded(&known.mean) {
            return;
        }
        self.base += self.fitted;
        (self.fitted, self.paid) = (0.0, 0.0);
        (self.known, self.prior, self.motion) = (known, known.mean, motion);
        (self.information, self.log_det) = (factors.inverse(), -factors.log_det);
        self.moments.clear();
        self.vertical.clear();
        self.groups = 0.0;
        self.next_fit = 32.0;
    }
}
