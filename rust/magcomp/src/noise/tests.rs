use super::*;
use nalgebra::{DMatrix, DVector};

/// A repeatable standard normal sequence: sums of twelve numbers of a linear congruence.
struct Normal(u64);

impl Normal {
    fn next(&mut self) -> f64 {
        let mut uniform = || {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }
}

/// Misses of a process of this size that lasts so long, under white noise.
fn misses(size: f64, lasts_s: f64, white: f64, seconds: f64, count: usize) -> Vec<f64> {
    let (mut normal, mut x) = (Normal(7), 0.0);
    let phi = (-seconds / lasts_s).exp();
    let next = |_| {
        x = phi * x + (1.0 - phi * phi).sqrt() * size * normal.next();
        x + white * normal.next()
    };
    (0..count).map(next).collect()
}

#[test]
fn a_lasting_error_is_learned_and_a_clock_that_stands_still_says_nothing_of_how_long() {
    let mut learned = Markov::new(0.5, 0.2);
    misses(2.0, 0.6, 0.1, 0.1, 1500).into_iter().for_each(|miss| learned.add(miss, 0.01, 0.1));
    assert!((1.4..2.8).contains(&learned.process().size), "{}", learned.process().size);
    let tau = -0.1 / learned.process().over(0.1).phi.ln();
    assert!((0.3..1.3).contains(&tau), "{tau}");
    assert_eq!(learned.process().over(0.0).phi, 1.0);

    let mut still = Markov::new(0.5, 0.2);
    let before = -1.0 / still.process().over(1.0).phi.ln();
    misses(0.0, 1.0, 0.1, 1.0, 200).into_iter().for_each(|miss| still.add(miss, 0.01, 0.0));
    assert!((-1.0 / still.process().over(1.0).phi.ln() / before - 1.0).abs() < 1e-9);
}

/// The grid's posterior mean against the likelihood of all misses by their dense covariance: its Cholesky factor whitens them, and what is left of each is
/// its surprise. One in 300 of what was known is forgotten at each miss, and none surprises by more than three standard deviations.
#[test]
fn the_grid_agrees_with_the_likelihood_of_all_misses_at_once() {
    let (white, dt, count) = (0.8_f64, 0.1, 80);
    let mut misses = misses(0.8, 0.4, white, dt, count);
    misses[30] += 20.0;
    let mut grid = Markov::new(0.5, 0.2);
    misses.iter().for_each(|miss| grid.add(*miss, white * white, dt));
    let cell = |s: f64, tau: f64| {
        let c = DMatrix::from_fn(count, count, |a, b| {
            s * s * (-(a.abs_diff(b) as f64) * dt / tau).exp() + if a == b { white * white } else { 0.0 }
        });
        let factor = c.cholesky().unwrap().unpack();
        let left = factor.solve_lower_triangular(&DVector::from_column_slice(&misses)).unwrap();
        let told = |k: usize| -0.5 * left[k].powi(2).min(9.0) - factor[(k, k)].ln();
        (0..count).map(|k| (299.0_f64 / 300.0).powi((count - 1 - k) as i32) * told(k)).sum::<f64>()
    };
    let mut cells = Vec::new();
    for i in -2..=2_i32 {
        for k in -3..=3_i32 {
            let (s, tau) = (0.5 * 3.0_f64.powi(k), 0.2 * 3.0_f64.powi(i));
            cells.push((cell(s, tau) - 0.5 * f64::from(i * i + k * k), (s / 0.5).ln(), (tau / 0.2).ln()));
        }
    }
    let top = cells.iter().fold(f64::NEG_INFINITY, |top, cell| top.max(cell.0));
    let sum: f64 = cells.iter().map(|cell| (cell.0 - top).exp()).sum();
    let mean =
        |of: fn(&(f64, f64, f64)) -> f64| cells.iter().map(|cell| (cell.0 - top).exp() * of(cell)).sum::<f64>() / sum;
    let (size, lasts_s) = (0.5 * mean(|cell| cell.1).exp(), 0.2 * mean(|cell| cell.2).exp());
    let Process { size: got, lasts_s: got_s } = grid.process();
    assert!((got / size - 1.0).abs() < 1e-9, "{got} against {size}");
    assert!((got_s / lasts_s - 1.0).abs() < 1e-9, "{got_s} s against {lasts_s}");
}

#[test]
fn a_stay_tells_more_and_more_under_white_noise_and_no_more_where_the_sensor_wanders() {
    let mut normal = Normal(3);
    let (mut white, mut wandering) = (Stays::new(1.0), Stays::new(1.0));
    let mut x = 0.0;
    for _ in 0..6000 {
        white.add(normal.next());
        x += 0.5 * normal.next();
        wandering.add(x + 0.3 * normal.next());
    }
    assert!((0.8..1.2).contains(&white.variance(0).unwrap()));
    let long = white.variance(4).expect("a longer mean is better");
    assert!((0.03..0.12).contains(&long), "{long}");
    assert!((1..5).all(|j| wandering.variance(j).is_none()));
}

#[test]
fn an_end_of_a_stay_separates_what_comes_after_it() {
    let mut stays = Stays::new(1.0);
    let before = stays.variance(0);
    stays.add(0.0);
    stays.end();
    stays.add(1000.0);
    assert_eq!(stays.variance(0), before);
}

#[test]
fn outliers_hardly_move_a_mean_square() {
    let (mut normal, mut clean, mut spoilt) = (Normal(5), MeanSquare::new(1.0), MeanSquare::new(1.0));
    for k in 0..5000 {
        let square = 4.0 * normal.next().powi(2);
        clean.add(square);
        spoilt.add(if k % 50 == 0 { 1e6 } else { square });
    }
    assert!((clean.value() / 4.0 - 1.0).abs() < 0.15, "{}", clean.value());
    assert!(spoilt.value() < 1.35 * clean.value(), "{}", spoilt.value());
}

/// v <- v + (min(x^2, 9 v) / 0.995 - v) / n by hand, n = 11 and 12.
#[test]
fn a_mean_square_counts_from_ten_on() {
    let mut mean = MeanSquare::new(1.0);
    mean.add(2.0);
    let first = 1.0 + (2.0 / 0.995 - 1.0) / 11.0;
    assert!((mean.value() - first).abs() < 1e-12);
    mean.add(50.0);
    assert!((mean.value() - (first + (9.0 * first / 0.995 - first) / 12.0)).abs() < 1e-12);
}

#[test]
fn what_lasts_decays_by_its_time_and_has_the_square_of_its_size() {
    let lasting = Process { size: 3.0, lasts_s: 0.6 }.over(0.3);
    assert!((lasting.phi - (-0.5_f64).exp()).abs() < 1e-15 && lasting.variance == 9.0);
}

/// By hand: the half squared difference of 0 and 10 is 50, which counts as nine times what was believed, 2, in a mean of eleven.
#[test]
fn a_jump_within_a_stay_counts_as_three_standard_deviations() {
    let mut stays = Stays::new(2.0);
    stays.add(0.0);
    stays.add(10.0);
    assert!((stays.variance(0).unwrap() - (2.0 + (18.0 - 2.0) / 11.0)).abs() < 1e-12);
}
