//! Student's t by its expansion about the normal distribution (Fisher).

/// As rare as `normal` standard deviations where the noise is known from so many degrees of freedom.
pub(crate) fn student(normal: f64, freedom: f64) -> f64 {
    let z = normal;
    let first = (z.powi(3) + z) / 4.0;
    let second = (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / 96.0;
    z + first / freedom + second / (freedom * freedom)
}

#[cfg(test)]
mod tests {
    use super::student;

    /// By a numerical integral of the density; 3.167e-5 beyond.
    #[test]
    fn the_fewer_pairs_the_more_sigmas() {
        for (freedom, exact) in [(9.0, 7.00), (21.0, 4.98), (60.0, 4.30), (1e9, 4.0)] {
            assert!((student(4.0, freedom) / exact - 1.0).abs() < 0.06, "{freedom}: {}", student(4.0, freedom));
        }
        // by hand: 4 + (64 + 4) / 4 / 10 + (5 * 1024 + 16 * 64 + 3 * 4) / 96 / 100
        assert!((student(4.0, 10.0) - 6.341_25).abs() < 1e-12, "{}", student(4.0, 10.0));
    }
}
