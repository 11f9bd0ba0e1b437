//! Every choice of the ellipsoid that is no setting (`options`).

use crate::priors::BEYOND_CHANCE;
use crate::tuning::choices;

choices! {
    Tuning {
        /// Samples thinner than this share of their width lie in a plane
        planar_ratio: 0.01, "", "0.5 uT in 50: tests/host/laws.rs";
        /// ... and so do those thinner than this many times the noise
        planar_noises: BEYOND_CHANCE, "", "tests/host/laws.rs";
    }
}
