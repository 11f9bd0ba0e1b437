//! The bank: hypotheses of when the device changed last, weighed by their joint probability with all frames.
//!     log joint of a child = log joint of its parent at the onset + log(hazard dt) + its own evidence
//! What is published is the mean and the second moment of the mixture.

#[cfg(test)]
mod tests;

use super::filter::{Filter, HardIron, Kind, Leap, Size};
use super::frame::{FRAMES, Frame, Frames, Noise};
use super::parameters::{COUNT, Gaussian, LEAST_VARIANCE, NOTHING, Tau, TauMatrix, centre, shape, tau_of};
use super::state::State;
use super::tuning::Tuning;
use crate::calibration::Given;
use crate::estimator::answer::LEAST_TOLD_UT;
use crate::math::elementary::{exp, ln};
use crate::math::symmetric::{basis, six};
use crate::priors::{HOPELESS, IRON_PER_UT, LARGEST_UT, RARE, ROOM_UT};
use crate::room::Roomy;
use crate::strength::EARTH_SD;
use alloc::vec::Vec;
use arrayvec::ArrayVec;
use core::f64::consts::{FRAC_1_SQRT_2, LN_2};
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::{Matrix3, SMatrix, Vector3};

/// Choice: hypotheses that are kept.
const KEPT: usize = 18;
/// Mathematics: places for those that one frame brings: six cold ones, eight changes, a former one, two forks and a twin.
const BROUGHT: usize = 18;
/// Places of hypotheses, which are large and stay where they are.
type Places = ArrayVec<usize, { KEPT + BROUGHT }>;
/// Choice: frames that hypotheses may run through again with one frame: three of the longest.
const BUDGET: i64 = 3 * FRAMES as i64;
/// Choice: frames between looks for a change that nothing announces.
const LOOK: u64 = 3;
/// Choice: expected direction error, deg, beyond which nothing is known of which a change could be seen.
const UNKNOWN_DEG: f64 = 8.0;
/// Choice: frames that tell how fast the device turns, to a fifth: 1 / sqrt(3 axes of 8).
pub(super) const LATELY: u64 = 8;
/// Choice: a window of so many frames that is known is cut to half.
const KNOWN_FRAMES: u64 = 96;
/// Choice: frames that a hypothesis needs to get to where it belongs: till then it runs again twice as often. While nothing is known well, as many lie
/// between cold starts.
const YOUNG_FRAMES: u64 = KNOWN_FRAMES / 2;

/// The hypothesis that changes begin from.
struct Parent {
    id: u32,
    known: Gaussian,
    state: State,
}

#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Bank {
    pub all: Roomy<Vec<Filter>>,
    pub frames: Frames,
    pub noise: Noise,
    former: Option<Gaussian>,
    next_id: u32,
    unit_ut: f64,
    looked: u64,
    mirrored: u64,
}

impl Bank {
    /// Takes all memory.
    pub fn new(unit_ut: f64) -> Self {
        Self { all: Roomy::<Vec<_>>::new(KEPT + BROUGHT), frames: Frames::new(), unit_ut, ..Self::default() }
    }

    /// Forgets everything, in the memory that is there.
    pub fn clear(&mut self) {
        self.all.clear();
        self.frames.clear();
        self.former = None;
        (self.next_id, self.looked, self.mirrored) = (0, 0, 0);
    }

    /// Other noise is believed, and the frames are judged again with it.
    pub fn believe(&mut self, noise: &Noise, tuning: &Tuning) {
        self.noise = *noise;
        self.frames.ring.iter_mut().for_each(|frame| frame.believe(noise));
        for filter in self.all.iter_mut() {
            filter.again(&self.frames, tuning, self.unit_ut);
        }
    }

    fn best_place(&self) -> Option<usize> {
        (0..self.all.len()).max_by(|a, b| self.all[*a].log_joint().total_cmp(&self.all[*b].log_joint()))
    }

    pub fn best(&self) -> Option<&Filter> {
        self.best_place().map(|k| &self.all[k])
    }

    /// The likeliest first.
    fn order(&self) -> Places {
        let mut order: Places = (0..self.all.len()).collect();
        order.sort_unstable_by(|a, b| self.all[*b].log_joint().total_cmp(&self.all[*a].log_joint()));
        order
    }

    /// Those of which this does not hold go.
    fn keep(&mut self, is_kept: impl Fn(usize, &Filter) -> bool) {
        for k in (0..self.all.len()).rev() {
            if !is_kept(k, &self.all[k]) {
                self.all.swap_remove(k);
            }
        }
    }

    fn new_id(&mut self) -> u32 {
        self.next_id += 1;
        self.next_id
    }

    /// Starts on all sides of a sample: the same belief, linear about different points.
    pub fn begin_cold(&mut self, frame: &Frame, log: f64, strength_known: bool, tuning: &Tuning) {
        let prior = cold(&frame.u, tuning);
        let id = self.new_id();
        for side in 0..6 {
            let mut base = State::new(&prior, frame.uneven.variance, frame.tilt.variance);
            base.log = log;
            let mut lin = prior.mean;
            lin[6 + side / 2] += if side % 2 == 0 { -1.0 } else { 1.0 };
            let mut filter = Filter::new(Kind::Cold, base, lin, self.frames.next, frame.time_ns);
            filter.id = id;
            filter.scale_sd = Some(if strength_known { tuning.soft_iron } else { EARTH_SD });
            // linear about its side
            filter.now = filter.start();
            self.all.push(filter);
        }
    }

    pub fn begin_given(&mut self, frame: &Frame, given: &Gaussian) {
        let base = State::new(given, frame.uneven.variance, frame.tilt.variance);
        let mut filter = Filter::new(Kind::Former, base, given.mean, self.frames.next, frame.time_ns);
        filter.id = self.new_id();
        self.all.push(filter);
    }

    /// A frame; whether it surprised the best hypothesis.
    pub fn push(&mut self, frame: Frame, strength_known: bool, tuning: &Tuning) {
        if let Some(place) = self.best_place() {
            let best = &self.all[place];
            let unknown = best.error > UNKNOWN_DEG.to_radians().powi(2);
            let doubtful = !best.is_known() && best.length(&self.frames) > LATELY;
            let surprised = best.is_surprised(&frame, tuning, self.unit_ut);
            let looks = tuning.looks && self.frames.next - self.looked >= LOOK;
            // a cold start is always in the race
            if tuning.cold_again && unknown && self.frames.next - self.looked >= YOUNG_FRAMES {
                self.looked = self.frames.next;
                self.begin_cold(&frame, best.log_joint() + ln(RARE), strength_known, tuning);
            }
            if surprised || looks && !unknown {
                let seconds = frame.seconds * (self.frames.next - self.looked).max(1) as f64;
                self.looked = self.frames.next;
                self.spawn(place, &frame, surprised, seconds.min(1.0), tuning);
            }
            if tuning.twins && doubtful && self.frames.next - self.mirrored >= LATELY {
                self.mirrored = self.frames.next;
                self.twins(tuning);
            }
        }
        self.frames.push(frame);
        for filter in self.all.iter_mut() {
            filter.add(&frame, tuning, self.unit_ut);
        }
        self.settle(tuning);
        self.prune(tuning);
    }

    /// A change of this kind begins with this frame, known as `base`.
    #[inline(never)]
    fn begin(&mut self, parent: &Parent, kind: Kind, id: u32, base: State, frame: &Frame) -> Option<&mut Filter> {
        let lin = base.tau();
        let mut child = Filter::new(kind, base, lin, self.frames.next, frame.time_ns);
        (child.id, child.parent, child.former) = (id, parent.id, (kind != Kind::Place).then_some(parent.known));
        self.all.push(child);
        self.all.last_mut()
    }

    /// Changes that begin with this frame. One that surprises may be of any kind; without surprise a change is a small one, and sudden.
    #[inline(never)]
    fn spawn(&mut self, place: usize, frame: &Frame, surprised: bool, seconds: f64, tuning: &Tuning) {
        let parent = &self.all[place];
        let likely = parent.log_joint();
        let log = |per_h: f64| likely + ln(per_h * seconds / 3600.0);
        let mut parent = Parent { id: parent.id, known: parent.now.known(), state: parent.now.clone() };
        parent.state.odd = 0;
        let (of_device, of_place) = (self.new_id(), self.new_id());
        let log_device = log(tuning.devices_per_h) - LN_2;
        self.spawn_device_steps(&parent, frame, of_device, log_device, surprised, tuning);
        for (size, differs) in [(Size::Least, ROOM_UT / self.unit_ut), (Size::Usual, tuning.place)] {
            let mut base = parent.state.clone();
            base.moves_to(differs, frame.time_ns);
            base.log = log(tuning.places_per_h) - LN_2;
            self.begin(&parent, Kind::Place, of_place, base, frame).into_iter().for_each(|it| it.size = size);
        }
        if let Some(former) = self.former.filter(|_| surprised && tuning.recall) {
            let mut base = parent.state.with(&former);
            base.log = log_device;
            self.begin(&parent, Kind::Former, of_device, base, frame);
        }
        self.spawn_moving(place, &parent, frame, of_device, log_device + LN_2, tuning);
    }

    /// b that rests may drift or slide from here on, where that is not tried already. A slide is a change of its own.
    #[inline(never)]
    fn spawn_moving(&mut self, place: usize, parent: &Parent, frame: &Frame, id: u32, log: f64, tuning: &Tuning) {
        let best = &self.all[place];
        // where nothing is known, b cannot be seen to move
        let unknown = best.error > UNKNOWN_DEG.to_radians().powi(2);
        if !tuning.moves || unknown || best.hard_iron != HardIron::Rests {
            return;
        }
        let (number, unit_ut, likely) = (self.frames.next, self.unit_ut, best.log_joint());
        let is_tried =
            |all: &[Filter], hard_iron| all.iter().any(|it| it.hard_iron == hard_iron && it.log_joint() > likely - 9.0);
        if !is_tried(&self.all, HardIron::Drifts) {
            let fork = best.fork(HardIron::Drifts, number, log, tuning, unit_ut);
            self.keep(|_, it| it.hard_iron != HardIron::Drifts);
            self.all.push(fork);
        }
        if !is_tried(&self.all, HardIron::Slides) {
            self.keep(|_, it| it.hard_iron != HardIron::Slides);
            if let Some(child) = self.begin(parent, Kind::Device, id, parent.state.clone(), frame) {
                *child = child.fork(HardIron::Slides, number, log, tuning, unit_ut);
            }
        }
    }

    /// Steps of b and M of each size, sudden ones and such as take a while.
    #[inline(never)]
    fn spawn_device_steps(
        &mut self,
        parent: &Parent,
        frame: &Frame,
        id: u32,
        log: f64,
        surprised: bool,
        tuning: &Tuning,
    ) {
        let number = self.frames.next;
        let honest = parent.state.honest();
        let scale = shape(&parent.known.mean).trace() / 3.0;
        let sizes = [(Size::Least, LEAST_TOLD_UT), (Size::Usual, tuning.step_ut), (Size::Magnet, LARGEST_UT)];
        let sizes = sizes.into_iter().take(if surprised { 3 } else { 2 });
        let ways: &[bool] = if surprised && tuning.gradual { &[false, true] } else { &[false] };
        for ((size, step), takes_time) in sizes.flat_map(|size| ways.iter().map(move |way| (size, *way))) {
            let mut base = parent.state.clone();
            base.p.fixed_view_mut::<COUNT, COUNT>(0, 0).copy_from(&honest.covariance);
            base.widen(step / self.unit_ut, IRON_PER_UT * step * scale);
            base.begin_spread();
            base.log = log;
            let leap = (tuning.leap && size == Size::Magnet && number > LATELY).then(|| Leap {
                noise: parent.state.noise(),
                from: self.frames.at(number - 1).u,
                from_ns: self.frames.at(number - 1).time_ns,
                turning: self.turning(),
                step: step / self.unit_ut,
            });
            if let Some(child) = self.begin(parent, Kind::Device, id, base, frame) {
                (child.size, child.takes_time, child.leap) = (size, takes_time, leap);
            }
        }
    }

    /// How fast the field turned of late, root mean square, units a second.
    fn turning(&self) -> f64 {
        let squares = |number: u64| {
            let (before, now) = (self.frames.at(number - 1), self.frames.at(number));
            (now.u - before.u).norm_squared() / (now.seconds * now.seconds).max(1e-6)
        };
        let numbers = self.frames.next - LATELY..self.frames.next;
        (numbers.map(squares).sum::<f64>() / LATELY as f64).sqrt()
    }

    /// Starts on the other side of the best hypothesis' samples.
    #[inline(never)]
    fn twins(&mut self, tuning: &Tuning) {
        let Some(mut twin) = self.best().cloned() else { return };
        let n = twin.length(&self.frames).max(1) as f64;
        let numbers = twin.first..self.frames.next;
        let mean = numbers.clone().map(|k| self.frames.at(k).u).sum::<Vector3<f64>>() / n;
        let spread = numbers.map(|k| self.frames.at(k).u - mean).map(|d| d * d.transpose()).sum::<Matrix3<f64>>();
        let eigen = spread.symmetric_eigen();
        let normal: Vector3<f64> = eigen.eigenvectors.column(eigen.eigenvalues.imin()).into();
        let known = twin.now.tau();
        let off = normal * (2.0 * normal.dot(&(centre(&known) - mean)));
        twin.lin = known;
        (0..3).for_each(|i| twin.lin[6 + i] -= off[i]);
        twin.again(&self.frames, tuning, self.unit_ut);
        self.all.push(twin);
    }

    /// The best first, the others in turn: those that have moved run again, within a budget.
    fn settle(&mut self, tuning: &Tuning) {
        let mut left = BUDGET;
        let order = self.order();
        let n = self.all.len();
        for place in 0..n {
            let k = order[if place == 0 { 0 } else { 1 + (place + self.frames.next as usize) % (n - 1).max(1) }];
            let filter = &mut self.all[k];
            let length = filter.length(&self.frames);
            let is_settled = length >= KNOWN_FRAMES && filter.is_known() && !filter.wants_run();
            let left_over = if length + 2 >= FRAMES { FRAMES / 2 } else { KNOWN_FRAMES / 2 };
            if length + 2 >= FRAMES || is_settled {
                filter.forget(self.frames.next - left_over, &self.frames, tuning, self.unit_ut);
            }
            let mut tries = if length < YOUNG_FRAMES { 4 } else { 2 };
            while left > 0 && tries > 0 && filter.wants_run() {
                left -= filter.run(&self.frames, tuning, self.unit_ut) as i64;
                tries -= 1;
            }
            if length + 1 >= KNOWN_FRAMES {
                filter.estimate_error();
            }
            filter.penalize(tuning, self.unit_ut);
        }
    }

    fn prune(&mut self, tuning: &Tuning) {
        let order = self.order();
        let Some(top) = order.first().map(|k| self.all[*k].log_joint()) else { return };
        let latest = self.frames.next;
        let mut kept = Places::new();
        for k in order {
            let filter = &self.all[k];
            let is_young = filter.kind == Kind::Cold && latest - filter.first < LATELY;
            let is_likely = filter.log_joint().is_finite() && (filter.log_joint() > top - HOPELESS || is_young);
            if kept.len() < KEPT
                && is_likely
                && !kept.iter().any(|better| self.all[*better].makes_needless(filter, latest))
            {
                kept.push(k);
            }
        }
        self.keep(|k, _| kept.contains(&k));
        let Some(place) = self.best_place() else { return };
        let best = &mut self.all[place];
        best.estimate_error();
        if best.error < tuning.publish_deg.to_radians().powi(2)
            && best.hard_iron != HardIron::Slides
            && let Some(former) = best.former.take()
        {
            self.former = Some(former);
        }
    }

    /// Mean and second moment of all hypotheses by their probability.
    pub fn mixture(&self) -> Option<Gaussian> {
        let top = self.best()?.log_joint();
        let weight = |it: &Filter| exp(it.log_joint() - top);
        let sum: f64 = self.all.iter().map(weight).sum();
        let parts = || self.all.iter().map(|it| (&it.now, weight(it) / sum)).filter(|(_, share)| *share > NOTHING);
        let mean: Tau = parts().map(|(it, share)| it.tau() * share).sum();
        let mut covariance = TauMatrix::zeros();
        for (it, share) in parts() {
            let known = it.honest();
            let off = known.mean - mean;
            covariance += (known.covariance + off * off.transpose()) * share;
        }
        Some(Gaussian { mean, covariance })
    }

    /// Probability of all hypotheses for which `is` holds.
    pub fn probability(&self, is: impl Fn(&Filter) -> bool) -> f64 {
        let Some(top) = self.best().map(Filter::log_joint) else { return 0.0 };
        let of = |it: &Filter| exp(it.log_joint() - top);
        let all: f64 = self.all.iter().map(of).sum();
        self.all.iter().filter(|it| is(it)).map(of).sum::<f64>() / all
    }
}

/// T = k (I + deviation), b a field strength from the first sample, where the field points unknown; k is left wide open here (`Filter::scale_sd`).
fn cold(u: &Vector3<f64>, tuning: &Tuning) -> Gaussian {
    let mut covariance = TauMatrix::zeros();
    covariance[(9, 9)] = 1.0;
    covariance.fixed_view_mut::<3, 3>(0, 0).fill(1.0);
    for i in 0..3 {
        covariance[(i, i)] += tuning.soft_iron.powi(2);
        covariance[(3 + i, 3 + i)] = (FRAC_1_SQRT_2 * tuning.soft_iron).powi(2);
        covariance[(6 + i, 6 + i)] = 1.0 / 3.0;
    }
    Gaussian { mean: tau_of(&Matrix3::identity(), u), covariance }
}

/// A calibration that was given; how much the strength of a place differs from that of another.
pub(super) fn given(given: &Given, unit_ut: f64, place: f64) -> Gaussian {
    let per_unit = unit_ut / given.calibration.field_strength_ut();
    let t = given.calibration.soft_iron_inverse() * per_unit;
    let mean = tau_of(&t, &(given.calibration.hard_iron_ut() / unit_ut));
    // T = k M^-1: dT = -T dM T / k
    let mut by = SMatrix::<f64, 9, 9>::zeros();
    for (k, dm) in basis().into_iter().enumerate() {
        by.fixed_view_mut::<6, 1>(0, 3 + k).copy_from(&six(&(t * dm * t / -per_unit)));
    }
    by.fixed_view_mut::<3, 3>(6, 0).fill_diagonal(1.0 / unit_ut);
    let mut covariance = TauMatrix::zeros();
    covariance.fixed_view_mut::<9, 9>(0, 0).copy_from(&(by * given.covariance * by.transpose()));
    // what was measured best is not known better than this
    (0..9).for_each(|k| covariance[(k, k)] += LEAST_VARIANCE);
    for i in 0..6 {
        for j in 0..6 {
            covariance[(i, j)] += place * place * mean[i] * mean[j];
        }
    }
    covariance[(9, 9)] = 1.0;
    Gaussian { mean, covariance }
}
