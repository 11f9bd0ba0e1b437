//! How sure the adaptive method says it is, against the truth: the error of all parameters in their covariance (NEES), and
//! the share of heading errors within one and two of their sigmas, in every scenario, before and after its change.

mod limits;

use limits::{fewest, runs};
use magcomp::{Compensator, Config, Method};
use magcomp_lab::catalogue::{COMPARED, find};
use magcomp_lab::experiment::answers;
use magcomp_lab::experiment::nees::Nees;
use magcomp_lab::parallel::{cores, map};
use magcomp_lab::score::samples;
use magcomp_replay::Ignore;

/// Samples at which the NEES is looked at: coverage is there, and they lie far enough apart to differ.
const AT: [usize; 4] = [1000, 2000, 4000, 5900];
/// Normal quantile of two-sided 95 %.
const BAND: f64 = 1.96;

/// Mean NEES over its number of parameters at [`AT`], and one standard deviation of it where the covariance is right: chi-squared
/// with that many degrees of freedom a run.
fn nees(name: &str, first: u64) -> [(f64, f64); 4] {
    let mut found: [Vec<Nees>; 4] = Default::default();
    for seed in first..first + runs(10, 40) as u64 {
        let stream = find(name).unwrap().in_an_even_place().stream(seed);
        let config = Config { method: Method::Adaptive, ..Config::default() };
        let mut compensator = Compensator::new(config).expect("a valid config");
        for (k, (sample, truth)) in stream.magnetic.iter().zip(&stream.truth).enumerate() {
            compensator.push(*sample);
            if let Some(at) = AT.iter().position(|at| *at == k + 1) {
                found[at].extend(Nees::of(&compensator, truth));
            }
        }
    }
    found.map(|all| {
        let freedom: usize = all.iter().map(|nees| nees.parameters).sum();
        let mean = all.iter().map(|nees| nees.mean_square).sum::<f64>() / all.len() as f64;
        (mean, (2.0 / freedom as f64).sqrt())
    })
}

/// With random directions, all is known of the noise and nothing else plays a part; a phone in a hand may be told a change at any
/// moment, and its covariance counts that.
#[test]
fn the_covariance_of_all_parameters_is_no_smaller_than_the_errors_and_not_much_larger() {
    for (name, least) in [("constant", 0.5), ("phone-steady", 0.15)] {
        let at = nees(name, 70_000);
        let mean = at.iter().map(|(mean, _)| mean).sum::<f64>() / at.len() as f64;
        let sd = at[0].1;
        println!("{name}: NEES {:.2?} at {AT:?}, mean {mean:.2}; 1 +- {sd:.2}", at.map(|at| at.0));
        assert!(mean > least && mean < 1.0 + BAND * sd, "{name}: {mean}");
    }
}

/// When a heading of each run is looked at, s from the change on: one a run, so that they are independent.
const LOOKED_AT_S: [f64; 4] = [-1.0, 0.5, 5.0, 20.0];
/// Shares of a normal distribution within one and two sigmas. Sigma may be too wide, but not too narrow.
const SHARES: [f64; 2] = [0.683, 0.954];
#[test]
fn shares_of_errors_within_their_sigmas_are_right() {
    let each = runs(6, 16);
    let jobs: Vec<usize> = (0..COMPARED.len() * each).collect();
    let looks = map(&jobs, cores(), |k| {
        let mut variant = find(COMPARED[k / each]).unwrap().in_an_even_place();
        variant.sensors.has_accelerometer = true;
        variant.duration_s = variant.change_s + LOOKED_AT_S[3] + 1.0;
        let seed = 71_000 + (k % each) as u64;
        let (simulation, _, steps) = answers(&variant, seed, Method::Adaptive, Ignore::default()).unwrap();
        let samples = samples(&simulation, &steps);
        LOOKED_AT_S.map(|after_s| {
            let from = samples.partition_point(|sample| sample.time_s < variant.change_s + after_s);
            // the next one that has a heading, within half a second
            samples[from..].iter().take(50).find_map(|sample| sample.sigmas())
        })
    });
    let mut wrong = Vec::new();
    for (name, looks) in COMPARED.iter().zip(looks.chunks(each)) {
        for (at, after_s) in LOOKED_AT_S.iter().enumerate() {
            let sigmas: Vec<f64> = looks.iter().filter_map(|look| look[at]).collect();
            let within = [1.0, 2.0].map(|limit| sigmas.iter().filter(|sigmas| **sigmas < limit).count());
            let least = SHARES.map(|share| fewest(sigmas.len(), share));
            let is_right = within[0] >= least[0] && within[1] >= least[1];
            let mark = if is_right { "" } else { " WRONG" };
            println!("{name:18} {after_s:5} s: {within:?} of {}, at least {least:?}{mark}", sigmas.len());
            if !is_right {
                wrong.push(format!("{name}, {after_s} s: {within:?} of {}", sigmas.len()));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
