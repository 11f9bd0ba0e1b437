//! How many of the latest samples a fit uses: (16) N = N_max - (N_max - N_min) sigma_T, kept in [N_min, N_max].

#[cfg(test)]
mod tests;

/// (16), rounded to a whole number of samples. Even orientations need few samples, poor ones many.
#[must_use]
pub fn window_length(sigma_t: f64, n_min: usize, n_max: usize) -> usize {
    let n = n_max as f64 - (n_max as f64 - n_min as f64) * sigma_t;
    if n.is_nan() { n_max } else { (n.round() as usize).clamp(n_min, n_max.max(n_min)) }
}
