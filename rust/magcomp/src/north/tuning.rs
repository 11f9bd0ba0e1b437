//! Every choice of the headings from outside.

use crate::tuning::choices;

choices! {
    /// The choices.
    Tuning {
        /// Headings within this time have the same error: a course that multipath bends, a step to the side
        repeat_s: 10.0, "s", "rust/magcomp-lab/tests/north.rs";
        /// For so long another north must be told before it is believed instead of the magnetometer's, and twice as long instead of headings that
        /// have agreed for as long
        own_support_s: 60.0, "s", "twice as long as one walks backwards: rust/magcomp-lab/tests/north.rs";
        /// The magnetometer's error is another where the device points elsewhere by this
        apart_deg: 30.0, "deg", "a disturbance that goes with the vehicle has one or two periods in a circle";
        /// Size of a declination before anything is known
        declination_deg: 15.0, "deg", "where people live it is less than 20 deg nearly everywhere";
        /// An axis whose horizontal part is less has no heading
        least_horizontal: 0.5, "", "60 deg of elevation, as the judge of the recordings has it";
    }
}
