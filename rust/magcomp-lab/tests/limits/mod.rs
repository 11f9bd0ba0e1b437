//! Runs of statistical tests: how many, and limits for their counts, derived from the share that is claimed.

/// A claim that holds fails its limit in one of so many tests.
const ONE_IN: f64 = 1e4;

/// How many: `all` at night (`tests/run.sh night` sets MAGCOMP_NIGHT), else few enough for every change.
pub fn runs(few: usize, all: usize) -> usize {
    if std::env::var_os("MAGCOMP_NIGHT").is_some() { all } else { few }
}

/// The fewest of `trials` independent trials that succeed, where each does with this chance: fewer happen once in ten thousand.
pub fn fewest(trials: usize, chance: f64) -> usize {
    // P(k) of k successes, from 0 on
    let mut at = (1.0 - chance).powi(trials as i32);
    let mut below = 0.0;
    for k in 0..=trials {
        below += at;
        if below > 1.0 / ONE_IN {
            return k;
        }
        at *= (trials - k) as f64 / (k + 1) as f64 * chance / (1.0 - chance);
    }
    trials
}
