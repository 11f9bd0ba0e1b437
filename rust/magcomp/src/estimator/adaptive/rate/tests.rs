use super::*;

const RATES: Process = Process { size: 0.4, lasts_s: 7.0 };

/// The process in small steps: r' = -r / T + noise of density 2 s^2 / T, b' = r, their moments by Euler's method.
#[test]
fn what_a_time_makes_of_a_rate_is_what_small_steps_make() {
    let (seconds, steps) = (3.0, 300_000);
    let dt = seconds / f64::from(steps);
    let (mut left, mut by, mut own, mut with, mut walked) = (1.0, 0.0, 0.0, 0.0, 0.0);
    for _ in 0..steps {
        by += left * dt;
        left -= left / 7.0 * dt;
        walked += 2.0 * with * dt;
        with += (own - with / 7.0) * dt;
        own += (2.0 * 0.16 / 7.0 - 2.0 * own / 7.0) * dt;
    }
    let found = Over::new(RATES, seconds);
    for (found, expected) in
        [(found.phi, left), (found.by, by), (found.own, own), (found.with, with), (found.walked, walked)]
    {
        assert!((found / expected - 1.0).abs() < 1e-4, "{found} against {expected}");
    }
}
