//! Every choice of the compensator: when a sample cannot be used, when the gyroscope is gone, and what is believed of a calibration from
//! elsewhere.

use crate::tuning::choices;

choices! {
    Tuning {
        /// So many samples in a row are no accident: where their times follow one another, but not that of the latest, they are from another
        /// clock; where they are equal, the device rests or the sensor hangs, as noise changes the last digit of most magnetometers sooner
        run_samples: 50.0, "samples", "half a second at 100 Hz: tests/host/repeats.rs; tests/recordings have at most 3 equal ones";
        /// Without a rotation for so long the magnetometer goes on alone; and a vertical that has not come by then is not waited for
        gone_s: 1.0, "s", "longer than a hiccup of the system: rust/magcomp-lab/tests/streams.rs";
        /// Time in which all but one device in e have changed: a cover, a charger, a car
        changes_s: 21_600.0, "s", "docs/dev/METHOD.md, a calibration from elsewhere";
        /// Share of launches before which the device was changed, however short the pause: it was laid down, a cover was put on
        changed_between: 0.1, "", "the same";
        /// Share of given calibrations that never held: taken beside a magnet, or of another phone
        never_held: 0.0025, "", "one in 400; tests/host/relaunch.rs";
    } mechanisms {
        /// A full scale that nobody told is found
        rails;
        /// A sensor that hangs is refused
        stuck;
        /// The turns of a camera's pose stand in for a gyroscope
        stand_in;
    }
}
