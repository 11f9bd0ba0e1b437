//! Azimuths of any number of rows in bounded memory: counts on a circle of 360 000 bins. Their median, root mean square,
//! percentile and shares within sigma are right to a bin, 0.001 degrees.
//!
//! Share within sigma: |a - centre| <= s sigma holds where the arc from a - s sigma to a + s sigma covers the centre. So only the
//! beginnings and ends of arcs are counted, and the centre may become known afterwards.

use crate::statistics::FEWEST;
use serde::Serialize;

/// Bins of a degree.
const BINS_PER_DEG: f64 = 1000.0;
/// Bins of the circle.
const BINS: usize = 360_000;
/// Multiples of sigma whose shares are formed.
const SIGMAS: [f64; 2] = [1.0, 2.0];

/// Error of the heading against the reference, up to one constant, degrees.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HeadingError {
    /// The constant that was taken out: the circular median of heading less reference, -180 to 180, positive clockwise.
    pub constant_deg: f64,
    /// Root mean square.
    pub rms_deg: f64,
    /// Root mean square without taking the constant out.
    pub absolute_rms_deg: f64,
    /// 95th percentile of its size.
    pub p95_deg: f64,
    /// Share of the errors within one and within two of their sigmas; none where no sigma was given.
    pub within_sigma: Option<[f64; 2]>,
}

/// Counted azimuths.
#[derive(Clone, Debug)]
pub(crate) struct Circle {
    /// Azimuths that the figures and the centre are formed from.
    counted: Bins,
    /// Azimuths that the centre alone is formed from.
    uncounted: Bins,
    /// Counted azimuths that came with a usable sigma.
    with_sigma: u64,
    arcs: [Arcs; SIGMAS.len()],
}

/// For each bin the number of its azimuths and the sum of their distances from its beginning, degrees. So an azimuth that is alone in
/// its bin is known exactly. Each has a vector of its own, because a page of zeros costs no memory until it is written.
#[derive(Clone, Debug)]
struct Bins {
    counts: Vec<u32>,
    excess: Vec<f32>,
}

/// Arcs on the circle: how many begin less how many ended in each bin, and how many cover bin 0 without beginning there.
#[derive(Clone, Debug)]
struct Arcs {
    change: Vec<i32>,
    over_start: u64,
}

impl Default for Circle {
    fn default() -> Self {
        let arcs = || Arcs { change: vec![0; BINS + 1], over_start: 0 };
        let bins = || Bins { counts: vec![0; BINS], excess: vec![0.0; BINS] };
        Self { counted: bins(), uncounted: bins(), with_sigma: 0, arcs: [arcs(), arcs()] }
    }
}

impl Circle {
    /// One azimuth, degrees, with its sigma; `counted`: it is part of the figures, not of the centre alone.
    pub fn add(&mut self, azimuth_deg: f64, sigma_deg: Option<f64>, counted: bool) {
        let bins = if counted { &mut self.counted } else { &mut self.uncounted };
        bins.add(azimuth_deg);
        if let Some(sigma_deg) = sigma_deg.filter(|sigma| counted && *sigma > 0.0) {
            self.with_sigma += 1;
            for (arcs, sigmas) in self.arcs.iter_mut().zip(SIGMAS) {
                arcs.add(azimuth_deg, sigmas * sigma_deg);
            }
        }
    }

    /// The circular median, degrees; 0 without azimuths.
    pub fn centre_deg(&self) -> f64 {
        let median = |part: fn(f64) -> f64| {
            let values = self.counted.values().chain(self.uncounted.values());
            let values = values.map(|(azimuth_deg, count)| (part(azimuth_deg.to_radians()), count));
            let sorted = Sorted::of(values);
            sorted.at(sorted.count() / 2).unwrap_or(0.0)
        };
        median(f64::sin).atan2(median(f64::cos)).to_degrees()
    }

    /// The errors of the counted azimuths about the centre; none of fewer than 50. `north_deg` is the azimuth that would be right.
    pub fn heading_error(&self, north_deg: f64) -> Option<HeadingError> {
        let centre_deg = self.centre_deg();
        let about = |from_deg: f64| {
            let azimuths = self.counted.values();
            Sorted::of(azimuths.map(|(azimuth_deg, count)| (off_deg(azimuth_deg, from_deg).abs(), count)))
        };
        let errors = about(centre_deg);
        let count = errors.count();
        let share = |arcs: &Arcs| arcs.over(centre_deg) as f64 / self.with_sigma as f64;
        (count >= FEWEST as u64).then(|| HeadingError {
            // where north seems to lie too far clockwise, headings are too small
            constant_deg: off_deg(north_deg, centre_deg),
            rms_deg: errors.rms(),
            absolute_rms_deg: about(north_deg).rms(),
            p95_deg: errors.at((count * 95 / 100).min(count - 1)).unwrap_or(0.0),
            within_sigma: (self.with_sigma >= FEWEST as u64).then(|| self.arcs.each_ref().map(share)),
        })
    }
}

impl Bins {
    fn add(&mut self, azimuth_deg: f64) {
        let bin = bin(azimuth_deg);
        self.counts[bin] += 1;
        self.excess[bin] += (azimuth_deg.rem_euclid(360.0) - bin as f64 / BINS_PER_DEG) as f32;
    }

    /// The mean azimuth in each bin that has any, degrees, and how many they are.
    fn values(&self) -> impl Iterator<Item = (f64, u32)> {
        let bins = self.counts.iter().zip(&self.excess).enumerate().filter(|(_, (count, _))| **count > 0);
        bins.map(|(bin, (count, excess))| (bin as f64 / BINS_PER_DEG + f64::from(excess / *count as f32), *count))
    }
}

impl Arcs {
    fn add(&mut self, azimuth_deg: f64, half_deg: f64) {
        if half_deg >= 180.0 {
            self.over_start += 1;
            return;
        }
        let (from, to) = (bin(azimuth_deg - half_deg), bin(azimuth_deg + half_deg));
        self.change[from] += 1;
        self.change[to + 1] -= 1;
        self.over_start += u64::from(from > to);
    }

    /// How many cover this azimuth.
    fn over(&self, azimuth_deg: f64) -> i64 {
        let change: i64 = self.change[..=bin(azimuth_deg)].iter().map(|change| i64::from(*change)).sum();
        self.over_start as i64 + change
    }
}

/// Values, each with how often it came, in order.
struct Sorted(Vec<(f64, u32)>);

impl Sorted {
    fn of(values: impl Iterator<Item = (f64, u32)>) -> Self {
        let mut values: Vec<_> = values.collect();
        values.sort_by(|a, b| a.0.total_cmp(&b.0));
        Self(values)
    }

    fn count(&self) -> u64 {
        self.0.iter().map(|(_, count)| u64::from(*count)).sum()
    }

    fn rms(&self) -> f64 {
        let squares: f64 = self.0.iter().map(|(value, count)| value * value * f64::from(*count)).sum();
        (squares / self.count() as f64).sqrt()
    }

    /// The value with so many before it.
    fn at(&self, mut before: u64) -> Option<f64> {
        let found = self.0.iter().find(|(_, count)| {
            let here = before < u64::from(*count);
            before = before.saturating_sub(u64::from(*count));
            here
        });
        found.map(|(value, _)| *value)
    }
}

fn bin(azimuth_deg: f64) -> usize {
    ((azimuth_deg.rem_euclid(360.0) * BINS_PER_DEG) as usize).min(BINS - 1)
}

/// An azimuth less another, -180 to 180.
pub fn off_deg(azimuth_deg: f64, from_deg: f64) -> f64 {
    (azimuth_deg - from_deg + 540.0).rem_euclid(360.0) - 180.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    /// The definition, from all azimuths at once: median, rms, 95th percentile, shares.
    fn all_at_once(azimuths: &[(f64, f64, bool)]) -> [f64; 5] {
        let median = |part: fn(f64) -> f64| {
            let mut values: Vec<f64> = azimuths.iter().map(|(a, ..)| part(a.to_radians())).collect();
            values.sort_by(f64::total_cmp);
            values[values.len() / 2]
        };
        let centre = median(f64::sin).atan2(median(f64::cos)).to_degrees();
        let counted = azimuths.iter().filter(|(.., counted)| *counted);
        let errors: Vec<(f64, f64)> = counted.map(|(a, sigma, _)| (off_deg(*a, centre).abs(), *sigma)).collect();
        let mut sizes: Vec<f64> = errors.iter().map(|(error, _)| *error).collect();
        sizes.sort_by(f64::total_cmp);
        let count = errors.len() as f64;
        let rms = (sizes.iter().map(|error| error * error).sum::<f64>() / count).sqrt();
        let within = |s: f64| errors.iter().filter(|(error, sigma)| *error <= s * sigma).count() as f64 / count;
        [centre, rms, sizes[errors.len() * 95 / 100], within(1.0), within(2.0)]
    }

    #[test]
    fn figures_agree_with_those_of_all_azimuths_at_once() {
        for (seed, about, spread) in [(1, 10.0, 3.0), (2, 179.9, 20.0), (3, 0.0, 1.0), (4, -90.0, 80.0)] {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            // six even numbers are near enough to a normal one
            let mut normal = || (0..6).map(|_| random.random_range(-0.7..0.7)).sum::<f64>();
            let mut one = |k| (about + spread * normal(), 30.0 * normal().abs(), k % 4 > 0);
            let mut azimuths: Vec<(f64, f64, bool)> = (0..20_000).map(&mut one).collect();
            azimuths[5].1 = 500.0;
            let mut circle = Circle::default();
            azimuths.iter().for_each(|(azimuth, sigma, counted)| circle.add(*azimuth, Some(*sigma), *counted));
            let found = circle.heading_error(0.0).unwrap();
            let [one, two] = found.within_sigma.unwrap();
            let expected = all_at_once(&azimuths);
            let found = [circle.centre_deg(), found.rms_deg, found.p95_deg, one, two];
            for (found, expected) in found.iter().zip(&expected) {
                assert!((found - expected).abs() < 0.002, "seed {seed}: {found} against {expected}");
            }
        }
    }

    #[test]
    fn a_constant_azimuth_is_no_error_and_wraps() {
        let mut circle = Circle::default();
        for azimuth in [179.0, -179.0, 178.0, -178.0, 180.0].iter().cycle().take(100) {
            circle.add(*azimuth, None, true);
        }
        let found = circle.heading_error(0.0).unwrap();
        assert!(found.p95_deg < 2.1 && found.within_sigma.is_none(), "{found:?}");
        assert_eq!(Circle::default().heading_error(0.0), None);
    }

    #[test]
    fn azimuths_without_a_usable_sigma_have_no_share() {
        let mut circle = Circle::default();
        (0..60).for_each(|_| circle.add(1.0, Some(0.0), true));
        (0..60).for_each(|_| circle.add(1.0, Some(f64::NAN), true));
        assert_eq!(circle.heading_error(0.0).unwrap().within_sigma, None);
        (0..50).for_each(|_| circle.add(1.0, Some(f64::INFINITY), true));
        assert_eq!(circle.heading_error(0.0).unwrap().within_sigma, Some([1.0, 1.0]));
    }
}
