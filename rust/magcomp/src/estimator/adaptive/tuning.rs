//! Every choice of the estimator: what is believed of phones, hands and places before a stream is seen.

use crate::priors::{
    DEVICES_PER_H, LARGEST_UT, NOISE_UT, OF_USE_DEG, RAMP_S, ROOM_S, ROOM_UT, SETTLED_S, SHOWN_RAD2, TILT_RAD,
};
use crate::tuning::choices;

choices! {
    /// The choices.
    Tuning {
        /// White noise before it is learned
        noise_ut: NOISE_UT, "uT", "priors";
        /// Share of it that the mean of a group has, before that is learned
        grouped: 0.25, "", "four samples: 50 Hz";
        /// The least noise: what a calibrated sensor still misses a sphere by from one direction to the next
        floor_ut: 0.05, "uT", "quantisation and non-linearity in data sheets";
        /// Unevenness of a place before it is learned
        uneven_ut: 0.8, "uT", "quiet rooms of real recordings";
        /// For how long of motion the same unevenness lasts before that is learned
        uneven_s: 0.5, "s", "a step of a pedestrian";
        /// Tilt of a hand that moves, before it is learned, and the least
        tilt_rad: TILT_RAD, "rad", "priors";
        /// How long the same tilt lasts
        tilt_s: 0.5, "s", "a step of a pedestrian";
        /// White noise of the vertical before it is learned, and the least
        tilt_white_rad: 0.005, "rad", "data sheets of accelerometers";
        /// Changes of the device's disturbance
        devices_per_h: DEVICES_PER_H, "1/h", "priors";
        /// Changes of the place
        places_per_h: 0.5 * 3600.0 / ROOM_S, "1/h", "rooms, doors: each lasts twice as long as makes it usual";
        /// Change of b, standard deviation per axis, the middle of three kinds; the least is what is told, the largest that of a magnet
        step_ut: 20.0, "uT", "a cover, a magnet";
        /// Strength and vertical part of another place's field, relative to the strength, standard deviation; half of it is told
        place: 0.2, "", "rooms, beside steel";
        /// Random walk of b
        walk_ut: 0.01, "uT/s^0.5", "temperature";
        /// How fast b drifts where it does, standard deviation per axis
        drift_ut_s: 0.5, "uT/s", "a battery that charges";
        /// How fast it moves while a magnet slides on
        slide_ut_s: LARGEST_UT / (2.0 * SETTLED_S), "uT/s", "the largest within ten seconds: priors";
        /// How far M deviates from a multiple of I before anything is known
        soft_iron: 0.05, "", "phones";
        /// Samples nearer than this to one another are one group
        frame_ut: ROOM_UT, "uT", "priors";
        /// For at most so long
        frame_s: 0.08, "s", "families";
        /// Expected direction error below which misses tell of the noise
        learn_deg: 12.0, "deg", "half of a sector of eight";
        /// Mean square turn of the directions seen from which a cold start is believed, and a change of the device told
        shown_rad2: SHOWN_RAD2, "rad^2", "priors";
        /// Expected direction error below which an estimate is published
        publish_deg: OF_USE_DEG, "deg", "priors";
        /// A change lasts for so long, or it was none
        change_s: 2.0, "s", "a cover put on; a door passed";
        /// A change of the device that takes time takes so long
        ramp_s: RAMP_S, "s", "priors";
        /// Time after which another place is what is usual
        new_place_s: ROOM_S, "s", "priors";
    } mechanisms {
        /// Cold starts again while nothing is known well
        cold_again;
        /// Looks for a change that nothing announces
        looks;
        /// The first frame after a large change tells b
        leap;
        /// Starts on the other side of the samples
        twins;
        /// What only noise tells is not believed
        spread;
        /// A b that moves
        moves;
        /// Longer and longer means of a stay
        stays;
        /// Bias of the accelerometer
        accelerometer_bias;
        /// Changes of the device that take time
        gradual;
        /// Recall of the calibration from before the last step
        recall;
        /// A rough way to another place
        rough;
        /// Learning of a place's unevenness
        unevenness;
        /// Learning of a hand's tilt
        tilting;
    }
}
