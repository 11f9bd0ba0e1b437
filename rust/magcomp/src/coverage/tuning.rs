//! Every choice of the coverage.

use crate::tuning::choices;

choices! {
    Tuning {
        /// Samples from one look for what is too dear for every sample to the next. Of the latest ten times as many the directions are found anew
        /// when the calibration they are seen through is no longer right: no sample may cost much
        anew_samples: 25.0, "samples", "0.25 s at 100 Hz, which nobody sees on a screen: tests/instructions.sh";
        /// It is no longer right when the centre has moved by this many field strengths: less than the width of a cell
        anew_shift: 0.2, "", "a cell is 0.5 wide: CELLS";
    }
}
