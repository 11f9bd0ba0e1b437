//! The correction against textbooks' dense forms, with inverses; and its limits.

use super::{Gaussian, Part};
use nalgebra::{Matrix2, SMatrix, SVector, Vector2};

const N: usize = 7;
const A: Part<2> = Part::first(1e-9);
const B: Part<4> = A.then(1e-6);
const C: Part<1> = B.then(1e-3);

/// Numbers that look like chance, of a linear congruence.
fn chance(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// A state, two numbers that are linear in it, and their noise.
struct Case {
    prior: Gaussian<N>,
    h: SMatrix<f64, 2, N>,
    noise: Matrix2<f64>,
    off: Vector2<f64>,
}

impl Case {
    fn new(seed: u64) -> Self {
        let mut next = chance(seed);
        let root = SMatrix::<f64, N, N>::from_fn(|_, _| next());
        let covariance = root * root.transpose();
        let root = Matrix2::from_fn(|_, _| next());
        Self {
            prior: Gaussian { mean: SVector::from_fn(|_, _| next()), covariance },
            h: SMatrix::from_fn(|_, _| next()),
            noise: root * root.transpose() + Matrix2::identity() * 0.01,
            off: Vector2::new(next(), next()),
        }
    }

    /// P_v.
    fn expected(&self) -> Matrix2<f64> {
        self.h * self.prior.covariance * self.h.transpose() + self.noise
    }

    /// By the code under test.
    fn corrected(&self, held: super::Held<'_>) -> Gaussian<N> {
        let root = self.expected().cholesky().unwrap().unpack();
        let inverse = root.try_inverse().unwrap();
        let mut it = self.prior.clone();
        it.correct(&(it.covariance * self.h.transpose() * inverse.transpose()), &(inverse * self.off), held);
        it
    }
}

fn assert_near(found: &Gaussian<N>, mean: &SVector<f64, N>, covariance: &SMatrix<f64, N, N>, tolerance: f64) {
    let off = (found.mean - mean).norm().max((found.covariance - covariance).norm());
    assert!(off < tolerance, "off by {off:e}");
    assert_eq!(found.covariance, found.covariance.transpose());
}

/// P <- (I - K H) P (I - K H)^T + K noise K^T holds for any gain K, also for one with rows of zeros (Schmidt).
#[test]
fn a_correction_is_josephs_with_and_without_states_that_are_held() {
    for seed in 0..50 {
        let case = Case::new(seed);
        for held in [&[][..], &[B.range()], &[A.range(), C.range()], &[A.range(), B.until(C), C.range()]] {
            let inverse = case.expected().try_inverse().unwrap();
            let mut k = case.prior.covariance * case.h.transpose() * inverse;
            held.iter().cloned().flatten().for_each(|row| k.row_mut(row).fill(0.0));
            let left = SMatrix::<f64, N, N>::identity() - k * case.h;
            let covariance = left * case.prior.covariance * left.transpose() + k * case.noise * k.transpose();
            assert_near(&case.corrected(held), &(case.prior.mean + k * case.off), &covariance, 1e-10);
        }
    }
}

/// Information form: P^-1 <- P^-1 + H^T noise^-1 H.
#[test]
fn a_correction_adds_information() {
    for seed in 50..100 {
        let case = Case::new(seed);
        let information = case.h.transpose() * case.noise.try_inverse().unwrap();
        let covariance = (case.prior.covariance.try_inverse().unwrap() + information * case.h).try_inverse().unwrap();
        let mean = case.prior.mean + covariance * information * case.off;
        // as far as the inverse of a prior by chance is exact
        assert_near(&case.corrected(&[]), &mean, &covariance, 1e-6);
    }
}

/// x and y together are a Gaussian; given y, that of x is the Schur complement.
#[test]
fn a_correction_is_the_conditional_of_the_joint_gaussian() {
    for seed in 100..150 {
        let case = Case::new(seed);
        let mut joint = SMatrix::<f64, 9, 9>::zeros();
        let cross = case.prior.covariance * case.h.transpose();
        joint.fixed_view_mut::<N, N>(0, 0).copy_from(&case.prior.covariance);
        joint.fixed_view_mut::<N, 2>(0, N).copy_from(&cross);
        joint.fixed_view_mut::<2, N>(N, 0).copy_from(&cross.transpose());
        joint.fixed_view_mut::<2, 2>(N, N).copy_from(&case.expected());
        let by = joint.lu().solve(&SMatrix::<f64, 9, 9>::identity()).unwrap();
        // the inverse of a block of the joint precision
        let covariance = by.fixed_view::<N, N>(0, 0).into_owned().try_inverse().unwrap();
        let mean = case.prior.mean - covariance * by.fixed_view::<N, 2>(0, N) * case.off;
        assert_near(&case.corrected(&[]), &mean, &covariance, 1e-6);
    }
}

#[test]
fn noise_without_end_teaches_nothing_and_noise_of_nothing_all() {
    let mut case = Case::new(7);
    case.noise = Matrix2::identity() * 1e15;
    assert_near(&case.corrected(&[]), &case.prior.mean, &case.prior.covariance, 1e-12);
    case.noise = Matrix2::identity() * 1e-12;
    let exact = case.corrected(&[]);
    // what was measured is known, and is as measured
    assert!((case.h * exact.covariance * case.h.transpose()).norm() < 1e-10);
    assert!((case.h * (exact.mean - case.prior.mean) - case.off).norm() < 1e-10);
}

#[test]
fn parts_follow_one_another_and_change_alone() {
    assert_eq!([A.range(), B.range(), C.range()], [0..2, 2..6, 6..7]);
    assert_eq!(A.with_next::<6>().range(), 0..6);
    assert_eq!((B.start(), B.least_variance(), C.least_variance()), (2, 1e-6, 1e-3));
    let before = Case::new(3).prior;
    let mut after = before.clone();
    after.set_part(C, &SVector::from([5.0]));
    after.isolate(B, &SMatrix::from_diagonal_element(2.0));
    after.add_variance(B, 1.0);
    after.add(A, &Matrix2::new(1.0, 0.5, 0.5, 1.0));
    for (i, j) in (0..N).flat_map(|i| (0..N).map(move |j| (i, j))) {
        let expected = match (B.range().contains(&i), B.range().contains(&j)) {
            (true, true) => f64::from(u8::from(i == j)) * 3.0,
            (false, false) if i < 2 && j < 2 => before.covariance[(i, j)] + if i == j { 1.0 } else { 0.5 },
            (false, false) => before.covariance[(i, j)],
            _ => 0.0,
        };
        assert_eq!(after.covariance[(i, j)], expected, "{i} {j}");
    }
    assert_eq!((after.part(A), after.part(B)), (before.part(A), before.part(B)));
    assert_eq!(after.mean[6], 5.0);
    assert_eq!(after.marginal(B).covariance, after.own(B));
    assert_eq!(after.variances(B), after.own(B).diagonal());
    assert_eq!(after.columns(A), after.covariance.fixed_columns::<2>(0));
    after.covariance.fill_diagonal(0.0);
    after.raise(B);
    assert_eq!(after.covariance.diagonal().as_slice(), [0.0, 0.0, 1e-6, 1e-6, 1e-6, 1e-6, 0.0]);
}

#[test]
fn what_is_not_finite_is_found() {
    let good = Case::new(9).prior;
    assert!(good.is_finite());
    let (mut mean, mut variance) = (good.clone(), good);
    mean.mean[3] = f64::NAN;
    variance.covariance[(4, 4)] = f64::INFINITY;
    assert!(!mean.is_finite() && !variance.is_finite());
}
