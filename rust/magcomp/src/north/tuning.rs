//! Every choice of the headings from outside.

use crate::priors::{OF_USE_DEG, ROOM_S, SETTLED_S};
use crate::tuning::choices;

choices! {
    Tuning {
        /// Headings within this time have the same error: a course that multipath bends, a step to the side
        repeat_s: 2.0 * SETTLED_S, "s", "rust/magcomp-lab/tests/north.rs";
        /// For so long another north must be told before it is believed instead of the magnetometer's, and twice as long instead of headings that
        /// have agreed for as long
        own_support_s: 2.0 * ROOM_S, "s", "twice as long as one walks backwards: rust/magcomp-lab/tests/north.rs";
        /// The magnetometer's error is another where the device points elsewhere by this
        apart_deg: 3.0 * OF_USE_DEG, "deg", "a disturbance that goes with the vehicle has one or two periods in a circle";
        /// Size of a declination before anything is known
        declination_deg: 15.0, "deg", "where people live it is less than 20 deg nearly everywhere";
        /// An axis whose horizontal part is less has no heading
        least_horizontal: 0.5, "", "60 deg of elevation, as the judge of the recordings has it";
    }
}
