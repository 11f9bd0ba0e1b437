//! Every choice of the sensors' events.

use crate::tuning::choices;

choices! {
    /// The choices.
    Tuning {
        /// A sensor whose newest event is older than this counts as absent, and a longer silence of all of them as a pause. Smaller: a hiccup of
        /// the system turns the gyroscope off. Larger: a stopped gyroscope is taken for stillness
        stale_s: 0.25, "s", "two and a half periods of 10 Hz, the slowest rate supported: rust/magcomp/src/sensing/pairing/tests.rs";
        /// An event further ahead of the newest magnetometer sample than this is from another clock
        most_lead_s: 10.0, "s", "longer than a system holds a sensor back while it delivers another: tests/host/event_order.rs";
        /// Memory of how the rate wanders between its events
        wander_s: 0.5, "s", "a hand changes its motion about as fast: rust/magcomp-lab/tests/streams.rs";
        /// Memory of what motion adds to gravity
        tilt_s: 1.0, "s", "two steps of a pedestrian: rust/magcomp/src/sensing/tilt/tests.rs";
    }
}
