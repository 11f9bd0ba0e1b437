use super::super::parameters::TauMatrix;
use super::*;
use nalgebra::{SMatrix, SVector};

const STILL: Way = Way { walk: 0.0, rates: None, rough_until_ns: i64::MIN, done_ns: i64::MIN };

const TRUE: [f64; 10] = [1.1, 0.9, 1.05, 0.07, -0.04, 0.06, 0.3, -0.5, 0.8, 0.2];

fn prior() -> Gaussian {
    let mut mean = Tau::from_column_slice(&TRUE);
    mean[7] += 0.01;
    let spread = [0.05, 0.05, 0.05, 0.03, 0.03, 0.03, 0.3, 0.3, 0.3, 1.0];
    Gaussian { mean, covariance: TauMatrix::from_diagonal(&Tau::from_iterator(spread.map(|s: f64| s * s))) }
}

/// Frames on the true ellipsoid, from all sides, and off it by a known miss.
fn frames() -> Vec<Frame> {
    let tau = Tau::from_column_slice(&TRUE);
    let inverse = super::super::parameters::shape(&tau).try_inverse().unwrap();
    let frame = |k: u64| {
        let (a, b) = (k as f64 * 0.7, (k as f64 * 0.37).sin());
        let n = Vector3::new((1.0 - b * b).sqrt() * a.cos(), (1.0 - b * b).sqrt() * a.sin(), b);
        let u = super::super::parameters::centre(&tau) + inverse * n * (1.0 + 0.01 * (k as f64 * 1.3).cos());
        Frame {
            time_ns: k as i64 * 80_000_000,
            u,
            count: 8.0,
            seconds: 0.08,
            moved_s: 0.08,
            white: 1e-4,
            ..Frame::default()
        }
    };
    (0..40).map(frame).collect()
}

/// The filter over frames without a place's own error is the least-squares fit of all of them at once, about the same point.
#[test]
fn the_filter_is_the_least_squares_fit_of_all_frames_at_once() {
    let (prior, tuning) = (prior(), Tuning::USED);
    let lin = Tau::from_column_slice(&TRUE);
    let mut state = State::new(&prior, 0.0, 0.0);
    [LEVEL, TILTED].iter().for_each(|at| state.p[(COUNT + at, COUNT + at)] = 0.0);
    let mut information = prior.covariance.try_inverse().unwrap();
    let mut score = information * (prior.mean - lin);
    for frame in frames() {
        state.step(&lin, &frame, STILL, &tuning);
        let miss = |tau: &Tau, u: &Vector3<f64>| {
            let seen = see(tau, u).unwrap();
            (seen.radius - 1.0) / seen.slope
        };
        // the derivative where the frame's line of sight meets the ellipsoid, by finite differences
        let seen = see(&lin, &frame.u).unwrap();
        let foot = super::super::parameters::centre(&lin) + seen.offset / seen.radius;
        let g = Tau::from_fn(|k, _| {
            let by = Tau::ith(k, 1e-6);
            (miss(&(lin + by), &foot) - miss(&(lin - by), &foot)) / 2e-6
        });
        information += g * g.transpose() / frame.white;
        score -= g * (miss(&lin, &frame.u) / frame.white);
    }
    let covariance = information.try_inverse().unwrap();
    let mean = lin + covariance * score;
    let own: Tau = state.x.fixed_rows::<10>(0).into();
    assert!((own - mean).amax() < 1e-6, "{:e}", (own - mean).amax());
    let difference: TauMatrix = state.p.fixed_view::<10, 10>(0, 0) - covariance;
    assert!(difference.amax() < 1e-6, "{:e}", difference.amax());
}

/// A second look at the same place of a device that does not move says less and less: what is uneven there stays.
#[test]
fn a_rest_tells_no_more_than_its_place() {
    let tuning = Tuning::USED;
    let uneven = Lasting { phi: 1.0, variance: 4e-4 };
    let frame = Frame { uneven, moved_s: 0.0, ..frames()[3] };
    let lin = Tau::from_column_slice(&TRUE);
    let mut state = State::new(&prior(), uneven.variance, 0.0);
    for _ in 0..200 {
        state.step(&lin, &frame, STILL, &tuning);
    }
    let seen = see(&lin, &frame.u).unwrap();
    let g = gradient(&lin, &seen.direction, &(seen.offset / seen.radius), 0.0) / seen.slope;
    let left = state.known().variance(&g);
    assert!(left > 0.8 * uneven.variance / (seen.slope * seen.slope), "{left:e}");
}

/// The rate stands beside the state; one Kalman filter over both, of twenty numbers in dense matrices, says the same.
#[test]
fn a_rate_beside_the_state_is_one_filter_of_both() {
    type Dense = SMatrix<f64, 20, 20>;
    let rates = Process { size: 0.3, lasts_s: 4.0 };
    let way = Way { rates: Some(rates), ..STILL };
    let mut state = State::new(&prior(), 0.01, 0.02);
    state.rate = Rate::new(rates);
    let mut x = SVector::<f64, 20>::zeros();
    x.fixed_rows_mut::<STATES>(0).copy_from(&state.x);
    let mut p = Dense::zeros();
    p.fixed_view_mut::<STATES, STATES>(0, 0).copy_from(&state.p);
    p.fixed_view_mut::<3, 3>(17, 17).copy_from(&Matrix3::from_diagonal_element(0.09));
    for k in 0..30 {
        let seconds = 0.05 + 0.02 * f64::from(k % 4);
        let Over { phi, by, own, with, walked } = Over::new(rates, seconds);
        let (mut f, mut q) = (Dense::identity(), Dense::zeros());
        for i in 0..3 {
            (f[(6 + i, 17 + i)], f[(17 + i, 17 + i)]) = (by, phi);
            (q[(6 + i, 6 + i)], q[(17 + i, 17 + i)]) = (walked, own);
            (q[(6 + i, 17 + i)], q[(17 + i, 6 + i)]) = (with, with);
        }
        (x, p) = (f * x, f * p * f.transpose() + q);
        state.moves(rates, seconds);

        let g = Numbers::from_fn(|i, _| (f64::from(k) * 0.9 + i as f64 * 1.7).sin());
        let (miss, noise) = (0.1 * f64::from(k).cos(), 0.02);
        let (nu, s, pg) = state.innovation(&Tau::zeros(), miss, &g, noise);
        state.learn(nu, s, &g, &pg, &way);
        let mut by_all = SVector::<f64, 20>::zeros();
        by_all.fixed_rows_mut::<STATES>(0).copy_from(&g);
        let gain = p * by_all / (by_all.dot(&(p * by_all)) + noise);
        (x, p) = (x - gain * (miss + by_all.dot(&x)), p - gain * (by_all.transpose() * p));
    }
    assert!((state.x - x.fixed_rows::<STATES>(0)).amax() < 1e-10);
    assert!((state.p - p.fixed_view::<STATES, STATES>(0, 0)).amax() < 1e-10);
    assert!((state.rate.mean - x.fixed_rows::<3>(17)).amax() < 1e-10);
    assert!((state.rate.with - p.fixed_view::<STATES, 3>(0, 17)).amax() < 1e-10);
    assert!((state.rate.own - p.fixed_view::<3, 3>(17, 17)).amax() < 1e-10);
    assert!(state.rate.mean.norm() > 1e-3);
}

/// A miss of 2 with a variance of 9: ln of its normal density, by hand.
#[test]
fn the_evidence_is_the_density_of_the_miss() {
    let mut state = State::new(&prior(), 0.0, 0.0);
    state.update(2.0, 9.0, &Numbers::zeros());
    assert!((state.log - (-2.0 / 9.0 - 3.0_f64.ln() - 0.918_938_533_204_672_8)).abs() < 1e-12, "{}", state.log);
}
