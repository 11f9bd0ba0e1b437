//! The samples of a segment, neighbours averaged. White noise makes the samples of a short arc a cloud, and on which side of
//! it b lies is for sums of squares to say that differ by the square root of 4 n by chance. Of means over m neighbours there
//! are n / m, of variance s^2 / m: the arc says as much, the noise less. Where every sample points elsewhere nothing is
//! averaged.

use crate::ellipsoid::Moments;
use crate::snapshot::checked;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Most samples in a mean.
const MOST: u32 = 8;
/// How far from the mean a sample still belongs to it: units, so that the arc bends by 1e-4, and standard deviations of noise.
const NEAR: f64 = 0.05;
const NOISES: f64 = 4.0;

/// See the module.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(remote = "Self")]
pub(super) struct Neighbours {
    /// Each mean as often as it has samples.
    whole: Moments,
    means: usize,
    /// The latest samples, whose mean may still grow.
    sum_ut: Vector3<f64>,
    members: u32,
}

checked!(Neighbours, |it| it.members <= MOST && it.means <= it.whole.count());

impl Neighbours {
    /// None yet, in the coordinates of `none`.
    pub fn new(none: Moments) -> Self {
        Self { whole: none, means: 0, sum_ut: Vector3::zeros(), members: 0 }
    }

    /// The next sample; standard deviation of the noise in units.
    pub fn add(&mut self, raw_ut: &Vector3<f64>, noise: f64) {
        let near_ut = (NEAR + NOISES * noise) * self.whole.scale_ut();
        let belongs = || (raw_ut - self.sum_ut / f64::from(self.members)).norm() < near_ut;
        if self.members > 0 && (self.members == MOST || !belongs()) {
            (self.whole, self.means) = (self.all(), self.means());
            (self.sum_ut, self.members) = (Vector3::zeros(), 0);
        }
        self.sum_ut += raw_ut;
        self.members += 1;
    }

    /// How many samples there are.
    pub fn count(&self) -> usize {
        self.whole.count() + self.members as usize
    }

    /// How many means there are.
    pub fn means(&self) -> usize {
        self.means + usize::from(self.members > 0)
    }

    /// Moments of all of them.
    pub fn all(&self) -> Moments {
        let mut all = self.whole.clone();
        let terms = all.terms(&(self.sum_ut / f64::from(self.members.max(1))));
        (0..self.members).for_each(|_| all.add_terms(&terms));
        all
    }
}

#[cfg(test)]
mod tests {
    use super::super::likelihood::Likelihood;
    use super::super::parameters::tau_of;
    use super::*;
    use nalgebra::Matrix3;

    const NOISE: f64 = 0.03;

    /// Noise of variance 1: twelve uniform numbers.
    fn normal(state: &mut u64) -> f64 {
        let uniform = |state: &mut u64| {
            *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (*state >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..12).map(|_| uniform(state)).sum::<f64>() - 6.0
    }

    /// 96 samples of the unit sphere, `step` radians apart.
    fn arc(seed: u64, step: f64) -> (Moments, Neighbours) {
        let mut state = seed;
        let none = Moments::new(Vector3::zeros(), 1.0);
        let (mut each, mut neighbours) = (none.clone(), Neighbours::new(none));
        for k in 0..96 {
            let a = f64::from(k) * step;
            let noise = Vector3::from_fn(|_, _| normal(&mut state)) * NOISE;
            let sample = Vector3::new(a.cos(), a.sin(), 0.0) + noise;
            each.add(&sample);
            neighbours.add(&sample, NOISE);
        }
        (each, neighbours)
    }

    #[test]
    fn only_neighbours_are_averaged() {
        assert_eq!(arc(1, 0.005).1.means(), 12);
        assert_eq!(arc(1, 1.9).1.means(), 96);
        assert_eq!(arc(1, 0.005).1.all().count(), 96);
    }

    /// L at the truth is chi-squared with as many degrees of freedom as there are means, and what noise makes of the
    /// difference between two sides of an arc is less than without averaging.
    #[test]
    fn the_noise_is_less_and_known() {
        let at = |centre| tau_of(&Matrix3::identity(), &centre);
        let (truth, aside) = (at(Vector3::zeros()), at(Vector3::new(0.995, 0.095, 1.0)));
        let (mut cost, mut squares) = (0.0, [0.0; 2]);
        let runs = 400;
        for seed in 0..runs {
            let (each, neighbours) = arc(seed * 7 + 3, 0.002);
            let means = neighbours.means() as f64;
            let averaged = Likelihood::new(&neighbours.all(), NOISE * NOISE * means / 96.0, means);
            let each = Likelihood::new(&each, NOISE * NOISE, 96.0);
            cost += averaged.at(&truth).unwrap().cost / means;
            for (square, likelihood) in squares.iter_mut().zip([&each, &averaged]) {
                *square += (likelihood.at(&aside).unwrap().cost - likelihood.at(&truth).unwrap().cost).powi(2);
            }
        }
        let cost = cost / runs as f64;
        assert!((cost - 1.0).abs() < 0.05, "{cost}");
        assert!(squares[1] < 0.3 * squares[0], "{squares:?}");
    }
}
