//! Every choice of the sensors' events.

use crate::priors::{HAND_RAD, STEP_S};
use crate::tuning::choices;

choices! {
    Tuning {
        /// A sensor whose newest event is older than this counts as absent, and a longer silence of all of them as a pause. Smaller: a hiccup of
        /// the system turns the gyroscope off. Larger: a stopped gyroscope is taken for stillness
        stale_s: 0.25, "s", "two and a half periods of 10 Hz, the slowest rate supported: rust/magcomp/src/sensing/pairing/tests.rs";
        /// Memory of how the rate wanders between its events
        wander_s: STEP_S, "s", "a hand changes its motion about as fast: rust/magcomp-lab/tests/streams.rs";
        /// Memory of what motion adds to gravity; and for how long a device turns about the same axis
        tilt_s: 2.0 * STEP_S, "s", "two steps: rust/magcomp/src/sensing/tilt/tests.rs";
        /// How far a hand turns the vertical, a random walk
        hand_rad: HAND_RAD, "rad/s^0.5", "priors";
        /// For how long the same motion is added to gravity, and half of it how long the raw field is averaged, one and a half times how long
        /// its turn is
        motion_s: 0.5 * STEP_S, "s", "half a step of a pedestrian: walks with motion capture, docs/dev/METHOD.md";
        /// How much more of it, in squares, lies along a horizontal axis than along gravity
        across: 2.0, "", "walks with motion capture, docs/dev/METHOD.md";
    }
}
