//! Every choice of the paper's estimator that the paper leaves open. Its own numbers are settings: `config`.

use crate::tuning::choices;

choices! {
    Tuning {
        /// The constant method keeps its first fit that predicts direction errors below this
        constant_sigma_deg: 1.0, "deg", "an even sphere of 100 samples at 30 dB reaches 0.7: tests/host/steps.rs";
        /// Rms deviation of |h| over the latest N_min samples, as a share of the field strength, that is suspect
        suspect_spread: 0.1, "", "rooms stay below 5 %, a magnet of 13 uT makes 20 %: tests/recordings, broad_34";
        /// Samples from a refused fit to the next try: a window that does not fit now will hardly fit one sample later
        retry_samples: 10.0, "samples", "a tenth of the shortest window; rust/magcomp/benches/push.rs";
        /// Parameters converge to this, in field strengths: two iterations from the fit before
        tolerance: 1e-6, "", "a hundredth of what noise at 40 dB leaves in a window of 2000: tests/host/steps.rs";
        /// The moments are taken about a new centre when the ellipsoid's is further away than this many field strengths, and when their scale
        /// is less than this share of the field, or the reverse
        recentre: 0.5, "", "moments keep 12 digits there: tests/host/direct.rs";
    }
}
