use super::*;
use nalgebra::{Matrix2, Matrix3, Vector1, Vector2, Vector3};

const PATIENT: Limits = Limits { iterations: 100, dampings: 16 };

/// Squares of residuals, by Gauss and Newton: f = |r(x)|^2.
struct Squares<const N: usize> {
    residual: fn(&SVector<f64, N>) -> SVector<f64, N>,
    jacobian: fn(&SVector<f64, N>) -> SMatrix<f64, N, N>,
    /// Beyond this there is no place.
    edge: f64,
}

impl<const N: usize> Cost<N> for Squares<N> {
    type Place = SVector<f64, N>;

    fn value(&self, at: &Self::Place) -> f64 {
        (self.residual)(at).norm_squared()
    }

    fn derivatives(&self, at: &Self::Place) -> Derivatives<N> {
        let j = (self.jacobian)(at);
        Derivatives { gradient: j.tr_mul(&(self.residual)(at)), hessian: j.tr_mul(&j) }
    }

    fn after(&self, from: &Self::Place, step: &SVector<f64, N>) -> Option<Self::Place> {
        let there = from + step;
        (there.amax() < self.edge).then_some(there)
    }
}

fn rosenbrock() -> Squares<2> {
    Squares {
        residual: |x| Vector2::new(10.0 * (x.y - x.x * x.x), 1.0 - x.x),
        jacobian: |x| Matrix2::new(-20.0 * x.x, 10.0, -1.0, 0.0),
        edge: f64::INFINITY,
    }
}

/// The undamped step from x leads beyond -x where |x| > 1.39: without damping it goes ever further.
fn arc_tangent() -> Squares<1> {
    Squares {
        residual: |x| Vector1::new(x.x.atan()),
        jacobian: |x| Vector1::new(1.0 / (1.0 + x.x * x.x)),
        edge: f64::INFINITY,
    }
}

/// Three numbers whose residual is linear: A x - b.
fn line() -> (Squares<3>, Vector3<f64>) {
    let a = || Matrix3::new(3.0, 1.0, 0.0, -1.0, 2.0, 0.5, 0.0, 4.0, -2.0);
    let cost = Squares {
        residual: |x| Matrix3::new(3.0, 1.0, 0.0, -1.0, 2.0, 0.5, 0.0, 4.0, -2.0) * x - Vector3::new(1.0, 2.0, 3.0),
        jacobian: |_| Matrix3::new(3.0, 1.0, 0.0, -1.0, 2.0, 0.5, 0.0, 4.0, -2.0),
        edge: f64::INFINITY,
    };
    (cost, a().lu().solve(&Vector3::new(1.0, 2.0, 3.0)).expect("regular"))
}

#[test]
fn derivatives_of_the_examples_are_those_of_finite_differences() {
    let (cost, x, h) = (rosenbrock(), Vector2::new(-1.2, 1.0), 1e-6);
    let gradient = cost.derivatives(&x).gradient;
    for i in 0..2 {
        let step = Vector2::ith(i, h);
        let slope = (cost.value(&(x + step)) - cost.value(&(x - step))) / (2.0 * h);
        assert!((2.0 * gradient[i] - slope).abs() < 1e-6 * slope.abs());
    }
}

#[test]
fn a_linear_problem_takes_one_step_to_what_a_solver_finds() {
    let (cost, expected) = line();
    let found = descend(&cost, Vector3::new(50.0, -70.0, 9.0), PATIENT, |_| true);
    assert!((found.place - expected).amax() < 1e-10);
    assert_eq!((found.iterations, found.termination), (1, Termination::Converged));
}

#[test]
fn a_curved_valley_is_followed_to_its_end() {
    let found = descend(&rosenbrock(), Vector2::new(-1.2, 1.0), PATIENT, |step| step.size < 1e-12);
    assert!((found.place - Vector2::new(1.0, 1.0)).amax() < 1e-12, "{found:?}");
    assert_eq!(found.termination, Termination::Converged);
}

#[test]
fn damping_holds_a_step_that_would_lead_away() {
    for (from, is_damped) in [(1.35, false), (1.45, true)] {
        let mut damped = false;
        let found = descend(&arc_tangent(), Vector1::new(from), PATIENT, |step| {
            damped |= step.damping > 0.0;
            step.size < 1e-9
        });
        assert_eq!(damped, is_damped, "from {from}");
        assert!(found.place.x.abs() < 1e-9, "{found:?}");
    }
}

#[test]
fn no_step_ever_raises_the_cost() {
    let cost = rosenbrock();
    let mut at = Vector2::new(-1.2, 1.0);
    for _ in 0..30 {
        let next = descend(&cost, at, Limits { iterations: 1, ..PATIENT }, |_| false).place;
        assert!(cost.value(&next) <= cost.value(&at) * (1.0 + 1e-11));
        at = next;
    }
}

#[test]
fn a_step_into_nowhere_is_shortened() {
    let (line, expected) = line();
    let edge = expected.amax();
    for (edge, is_reached) in [(edge * 1.001, true), (edge * 0.999, false)] {
        let cost = Squares { edge, ..line };
        let found = descend(&cost, Vector3::zeros(), PATIENT, |step| step.size < 1e-9);
        assert!(found.place.amax() < edge);
        assert_eq!((found.place - expected).amax() < 1e-6, is_reached, "{found:?}");
    }
}

#[test]
fn the_limits_are_kept() {
    let three = Limits { iterations: 3, ..PATIENT };
    let ended = descend(&rosenbrock(), Vector2::new(-1.2, 1.0), three, |_| false);
    assert_eq!((ended.iterations, ended.termination), (3, Termination::MaxIterations));
    // with one damping alone, which is none, there is no other step where the first overshoots
    let undamped = Limits { dampings: 1, ..PATIENT };
    for (from, ending) in [(1.35, Termination::Converged), (1.45, Termination::Stalled)] {
        let found = descend(&arc_tangent(), Vector1::new(from), undamped, |step| step.size < 1e-9);
        assert_eq!(found.termination, ending, "from {from}");
    }
    let nowhere = Squares { edge: 0.0, ..rosenbrock() };
    let at = Vector2::new(-1.2, 1.0);
    let found = descend(&nowhere, at, PATIENT, |_| false);
    assert_eq!((found.place, found.iterations, found.termination), (at, 1, Termination::Stalled));
}

#[test]
fn what_is_not_positive_definite_is_damped_until_it_is() {
    /// f = (x^2 - 1)^2 + y^2, by its own Hessian, which is indefinite near x = 0.
    struct Saddle;
    impl Cost<2> for Saddle {
        type Place = Vector2<f64>;
        fn value(&self, at: &Vector2<f64>) -> f64 {
            (at.x * at.x - 1.0).powi(2) + at.y * at.y
        }
        fn derivatives(&self, at: &Vector2<f64>) -> Derivatives<2> {
            let gradient = Vector2::new(2.0 * at.x * (at.x * at.x - 1.0), at.y);
            Derivatives { gradient, hessian: Matrix2::new(6.0 * at.x * at.x - 2.0, 0.0, 0.0, 1.0) }
        }
        fn scale(&self, _at: &Vector2<f64>, hessian: &Matrix2<f64>) -> Vector2<f64> {
            hessian.diagonal().abs()
        }
        fn after(&self, from: &Vector2<f64>, step: &Vector2<f64>) -> Option<Vector2<f64>> {
            Some(from + step)
        }
    }
    let found = descend(&Saddle, Vector2::new(0.1, 3.0), PATIENT, |step| step.size < 1e-10);
    assert!((found.place - Vector2::new(1.0, 0.0)).amax() < 1e-9, "{found:?}");
}

/// Every step taken from there, and where it led.
fn steps(from: f64) -> Vec<(Step, f64)> {
    let mut steps = Vec::new();
    descend(&arc_tangent(), Vector1::new(from), PATIENT, |step| {
        steps.push(*step);
        step.size < 1e-9
    });
    let after =
        |iterations| descend(&arc_tangent(), Vector1::new(from), Limits { iterations, ..PATIENT }, |_| false).place.x;
    let places: Vec<f64> = (1..=steps.len()).map(after).collect();
    steps.into_iter().zip(places).collect()
}

/// (H + mu D) dx = -g by hand: H = D = j^2, g = j r.
#[test]
fn a_damped_step_is_marquardts_and_the_damping_falls_by_tenths() {
    let (mut strong, mut weak) = (0, 0);
    for from in [1.391_76, 1.391_78, 1.3918, 1.392, 1.4, 1.45, 2.0, 6.0, 20.0] {
        let steps = steps(from);
        let mut x = from;
        for (step, to) in &steps {
            let j = 1.0 / (1.0 + x * x);
            let expected = x - x.atan() / (j * (1.0 + step.damping));
            assert!((to - expected).abs() < 1e-9 * x.abs().max(1.0), "from {x} to {to}, not {expected}");
            let gain = x.atan().powi(2) - to.atan().powi(2);
            assert!((step.gain - gain).abs() < 1e-12, "{} is not {gain}", step.gain);
            x = *to;
        }
        for pair in steps.windows(2) {
            let (before, after) = (pair[0].0.damping, pair[1].0.damping);
            // it starts a tenth lower, and at the least damping with none
            if before > 1.5 * FIRST_DAMPING {
                strong += 1;
                assert!(after > 0.09 * before, "{after:e} after {before:e}");
            } else if before > 0.0 && before <= FIRST_DAMPING {
                weak += 1;
                assert_eq!(after, 0.0);
            }
        }
    }
    assert!(strong > 3 && weak > 0, "{strong} {weak}");
}

/// f = 1 + (x - 1)^2 at its minimum: no step lowers it, and rounding may not ask for damping.
#[test]
fn at_the_minimum_a_step_of_nothing_is_taken_without_damping() {
    struct Bowl;
    impl Cost<1> for Bowl {
        type Place = Vector1<f64>;
        fn value(&self, at: &Vector1<f64>) -> f64 {
            1.0 + (at.x - 1.0).powi(2)
        }
        fn derivatives(&self, at: &Vector1<f64>) -> Derivatives<1> {
            Derivatives { gradient: Vector1::new(at.x - 1.0), hessian: SMatrix::from([[1.0]]) }
        }
        fn after(&self, from: &Vector1<f64>, step: &Vector1<f64>) -> Option<Vector1<f64>> {
            Some(from + step)
        }
    }
    let found = descend(&Bowl, Vector1::new(1.0), PATIENT, |step| {
        assert_eq!((step.damping, step.size, step.gain), (0.0, 0.0, 0.0));
        true
    });
    assert_eq!((found.place.x, found.termination), (1.0, Termination::Converged));
}
