use super::super::parameters::TauMatrix;
use super::*;

const STILL: Way =
    Way { walk: 0.0, rough_until_ns: i64::MIN, done_ns: i64::MIN, heeds_vertical: true, is_fixed: false };

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
    (state.p[(LEVEL, LEVEL)], state.p[(TILTED, TILTED)]) = (0.0, 0.0);
    let mut information = prior.covariance.try_inverse().unwrap();
    let mut score = information * (prior.mean - lin);
    for frame in frames() {
        assert!(state.step(&lin, &frame, STILL, &tuning));
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
