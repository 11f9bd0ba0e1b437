//! The latest samples, and the moments of a window of them: what (10) fits, for every length N at the same cost.

use crate::calibration::typical_field_ut;
use crate::ellipsoid::Moments;
use crate::room::Roomy;
use alloc::collections::VecDeque;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::Vector3;

/// Choice: the moments are taken about a new centre when the ellipsoid's is further away than this many field strengths, and when their scale is less than this
/// share of the field, or the reverse: moments keep 12 digits there (tests/host/direct.rs).
const RECENTRE: f64 = 0.5;

#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Window {
    /// N_max.
    longest: usize,
    strength_ut: Option<f64>,
    /// The latest N_max samples at the most, oldest first.
    kept: Roomy<VecDeque<Vector3<f64>>>,
    /// N: the latest so many are in the moments.
    pub length: usize,
    pub moments: Moments,
    since_recentred: usize,
}

/// (16) N = N_max - (N_max - N_min) sigma_T, kept in [N_min, N_max]: how many of the latest samples a fit uses, rounded to a whole
/// number. Even orientations need few samples, poor ones many.
#[must_use]
pub fn window_length(sigma_t: f64, n_min: usize, n_max: usize) -> usize {
    let n = n_max as f64 - (n_max as f64 - n_min as f64) * sigma_t;
    if n.is_nan() { n_max } else { (n.round() as usize).clamp(n_min, n_max.max(n_min)) }
}

impl Window {
    /// Of N_max samples at the most, in a field of this strength (uT) where it is known. All memory is taken here.
    pub fn new(longest: usize, strength_ut: Option<f64>) -> Self {
        Self {
            longest,
            strength_ut,
            kept: Roomy::<VecDeque<_>>::new(longest),
            length: 0,
            moments: Moments::new(Vector3::zeros(), typical_field_ut(strength_ut)),
            since_recentred: 0,
        }
    }

    /// As new, in the memory that is there.
    pub fn restart(&mut self) {
        self.kept.clear();
        self.length = 0;
        self.moments = Moments::new(Vector3::zeros(), typical_field_ut(self.strength_ut));
        self.since_recentred = 0;
    }

    /// Samples kept.
    pub fn kept(&self) -> usize {
        self.kept.len()
    }

    /// The latest so many, the very latest first.
    pub fn latest(&self, count: usize) -> impl Iterator<Item = &Vector3<f64>> {
        self.kept.iter().rev().take(count)
    }

    /// The moments are to be about this centre, uT, as long as there is no sample.
    pub fn begin_about(&mut self, centre_ut: &Vector3<f64>) {
        if self.kept.is_empty() {
            self.moments = Moments::new(*centre_ut, self.moments.scale_ut());
        }
    }

    /// The sample enters.
    pub fn enter(&mut self, raw_ut: &Vector3<f64>) {
        if self.length == self.longest {
            self.resize(self.length - 1);
        }
        self.kept.roll(*raw_ut, self.longest);
        self.moments.add(raw_ut);
        self.length += 1;
        self.since_recentred = self.since_recentred.saturating_add(1);
    }

    /// Samples enter or leave at the old end until the window has this length.
    pub fn resize(&mut self, length: usize) {
        let (length, kept) = (length.min(self.kept.len()), self.kept.len());
        while self.length > length {
            self.moments.remove(&self.kept[kept - self.length]);
            self.length -= 1;
        }
        while self.length < length {
            self.moments.add(&self.kept[kept - 1 - self.length]);
            self.length += 1;
        }
    }

    /// Moments about a far centre lose digits: they are taken about this one, where it is another, once in `n_min` samples at most.
    pub fn recentre(&mut self, centre_ut: &Vector3<f64>, field_ut: f64, n_min: usize) {
        let is_far = (centre_ut - self.moments.centre_ut()).norm() > RECENTRE * field_ut;
        let scales = RECENTRE..=RECENTRE.recip();
        let is_other = !scales.contains(&(field_ut / self.moments.scale_ut()));
        if (is_far || is_other) && self.since_recentred >= n_min {
            self.since_recentred = 0;
            let mut moments = Moments::new(*centre_ut, field_ut);
            self.latest(self.length).for_each(|raw_ut| moments.add(raw_ut));
            self.moments = moments;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(k: usize) -> Vector3<f64> {
        let k = k as f64;
        Vector3::new(600.0 + 48.0 * (0.7 * k).sin(), -200.0 + 47.0 * (1.1 * k).cos(), 50.0 * (0.3 * k).sin())
    }

    /// Whether the moments are those of the latest `length` of `count` samples, summed anew.
    fn holds_the_latest(window: &Window, count: usize, length: usize) -> bool {
        let mut anew = Moments::new(*window.moments.centre_ut(), window.moments.scale_ut());
        (count - length..count).for_each(|k| anew.add(&sample(k)));
        window.length == length && window.moments == anew
    }

    #[test]
    fn even_orientations_give_the_papers_window() {
        assert_eq!(window_length(0.7232, 100, 2000), 626);
    }

    #[test]
    fn stays_within_its_bounds() {
        assert_eq!(window_length(0.0, 100, 2000), 2000);
        assert_eq!(window_length(1.3, 100, 2000), 100);
        assert_eq!(window_length(f64::NAN, 100, 2000), 2000);
        assert_eq!(window_length(-1.0, 100, 2000), 2000);
    }

    #[test]
    fn the_moments_are_those_of_the_latest_samples_whatever_the_way() {
        let mut window = Window::new(40, None);
        (0..30).for_each(|k| window.enter(&sample(k)));
        assert!(holds_the_latest(&window, 30, 30));
        window.resize(12);
        assert!(holds_the_latest(&window, 30, 12));
        window.resize(25);
        assert!(holds_the_latest(&window, 30, 25));
        (30..100).for_each(|k| window.enter(&sample(k)));
        // it grew to N_max, and older samples left
        assert!(holds_the_latest(&window, 100, 40));
        window.resize(4000);
        assert!(holds_the_latest(&window, 100, 40));
        assert!(window.latest(3).eq([&sample(99), &sample(98), &sample(97)]));
    }

    #[test]
    fn a_far_centre_is_moved_and_a_near_one_is_not() {
        let centre = Vector3::new(600.0, -200.0, 0.0);
        let field_ut = typical_field_ut(None);
        for (share, moves) in [(0.49, false), (0.51, true)] {
            let mut window = Window::new(40, None);
            window.begin_about(&(centre + Vector3::x() * share * field_ut));
            (0..30).for_each(|k| window.enter(&sample(k)));
            window.recentre(&centre, field_ut, 31);
            assert_ne!(*window.moments.centre_ut(), centre, "too soon");
            window.recentre(&centre, field_ut, 30);
            assert_eq!(*window.moments.centre_ut() == centre, moves, "{share}");
            assert!(holds_the_latest(&window, 30, 30));
        }
    }

    #[test]
    fn after_a_restart_it_is_as_new() {
        let mut window = Window::new(40, Some(50.0));
        (0..100).for_each(|k| window.enter(&sample(k)));
        window.restart();
        assert_eq!(window, Window::new(40, Some(50.0)));
    }
}
