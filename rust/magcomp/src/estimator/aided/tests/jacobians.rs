//! Every Jacobian against central finite differences.

// index arithmetic is the mathematics here
#![allow(clippy::needless_range_loop)]

use nalgebra::{SMatrix, SVector};

use super::super::measure::Model;
use super::super::propagate::ProcessNoise;
use super::super::state::{Filter, STATES, covariance};
use super::simulator::Random;

const QUIET: ProcessNoise = ProcessNoise { bridged_rad2: 0.0, offset_ut: 0.0, local_ut: 0.0, local_time_s: 1.0 };

/// Sizes of the states, for steps and tolerances.
fn scale(i: usize) -> f64 {
    match i {
        0..=5 | 25..=27 => 10.0,
        6..=11 => 0.05,
        12..=14 | 16..=24 => 0.02,
        _ => 0.01,
    }
}

fn random_state(random: &mut Random) -> Filter {
    let mut state = Filter::default();
    for i in 0..STATES {
        state.mean[i] = scale(i) * random.normal();
    }
    let a = SMatrix::<f64, STATES, STATES>::from_fn(|i, _| scale(i) * random.normal());
    state.covariance = a * a.transpose();
    state
}

#[test]
fn propagation_of_the_covariance_is_f_p_f_transposed() {
    let mut random = Random(1);
    for _ in 0..50 {
        let state = random_state(&mut random);
        let increment = random.vector(0.3);
        let dt_s = 0.01 + 0.2 * random.uniform();
        let run = |x: SVector<f64, STATES>| {
            let mut moved = state.clone();
            moved.mean = x;
            moved.propagate(&increment, dt_s, &QUIET);
            moved.mean
        };
        let mut f = SMatrix::<f64, STATES, STATES>::zeros();
        for j in 0..STATES {
            let step = 1e-5 * scale(j);
            let (mut low, mut high) = (state.mean, state.mean);
            low[j] -= step;
            high[j] += step;
            let (low, high) = (run(low), run(high));
            for i in 0..STATES {
                f[(i, j)] = (high[i] - low[i]) / (2.0 * step);
            }
        }
        let expected = f * state.covariance * f.transpose();
        let mut moved = state.clone();
        moved.propagate(&increment, dt_s, &QUIET);
        for i in 0..STATES {
            for j in 0..STATES {
                let size = (expected[(i, i)] * expected[(j, j)]).sqrt();
                let error = (moved.covariance[(i, j)] - expected[(i, j)]).abs();
                assert!(error < 1e-7 * size, "({i}, {j}): {error:e} against {size:e}");
            }
        }
    }
}

#[test]
fn measurement_jacobian_is_the_derivative() {
    let mut random = Random(2);
    for _ in 0..100 {
        let state = random_state(&mut random);
        let rate = random.vector(3.0);
        let h = Model::of(&state.parts(), &rate, 0.02);
        let h = covariance::<STATES, 3>(|k, i| f64::from(k == i), |dx| h.times(dx));
        for j in 0..STATES {
            let step = 1e-5 * scale(j);
            let (mut low, mut high) = (state.clone(), state.clone());
            low.mean[j] -= step;
            high.mean[j] += step;
            let slope = (Model::of(&high.parts(), &rate, 0.02).raw_ut - Model::of(&low.parts(), &rate, 0.02).raw_ut)
                / (2.0 * step);
            for i in 0..3 {
                let error = (h[(j, i)] - slope[i]).abs() * scale(j);
                assert!(error < 1e-7, "({i}, {j}): {} against {}", h[(j, i)], slope[i]);
            }
        }
    }
}
