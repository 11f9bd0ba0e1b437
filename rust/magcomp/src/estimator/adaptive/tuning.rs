//! Every choice of the estimator: what is believed of phones, hands and places before a stream is seen.

use crate::tuning::choices;

choices! {
    /// The choices.
    Tuning {
        /// White noise before it is learned
        noise_ut: 0.5, "uT", "data sheets: a Nexus 5 has 0.48, iPhones 0.7 to 1.1";
        /// What a calibrated sensor still misses a sphere by from one direction to the next
        floor_ut: 0.05, "uT", "quantisation and non-linearity in data sheets";
        /// Unevenness of a place before it is learned
        uneven_ut: 0.8, "uT", "quiet rooms of real recordings";
        /// For how long of motion the same unevenness lasts before that is learned
        uneven_s: 0.2, "s", "half a metre walked";
        /// Tilt of a hand that moves, before it is learned
        tilt_rad: 0.06, "rad", "hands";
        /// How long the same tilt lasts
        tilt_s: 0.5, "s", "a step of a pedestrian";
        /// Share of samples that are spikes
        spikes: 0.01, "", "one in a hundred";
        /// Changes of the device's disturbance
        devices_per_h: 10.0, "1/h", "covers, chargers";
        /// Changes of the place
        places_per_h: 60.0, "1/h", "rooms, doors";
        /// Change of b, standard deviation per axis, the larger of two kinds; the smaller is a quarter of it
        step_ut: 20.0, "uT", "a cover, a magnet";
        /// How far M changes with b, relative, for each uT
        iron_per_ut: 0.003, "1/uT", "covers";
        /// Strength and vertical part of another place's field, relative to the strength, standard deviation
        place: 0.2, "", "rooms, beside steel";
        /// Random walk of b
        walk_ut: 0.01, "uT/s^0.5", "temperature";
        /// The same where b moves
        moving_ut: 0.3, "uT/s^0.5", "a battery that charges";
        /// How far M deviates from a multiple of I before anything is known
        soft_iron: 0.05, "", "phones";
        /// How far b is from the first sample before anything is known, in field strengths, per axis
        cold_centre: 0.75, "", "a field strength";
        /// Samples nearer than this to one another are one group
        frame_ut: 2.0, "uT", "2 degrees";
        /// Expected direction error below which misses tell of the noise
        learn_deg: 12.0, "deg", "half of a sector of eight";
        /// Mean square turn of the directions seen from which a cold start is believed, and a change of the device told
        shown_rad2: 0.01, "rad^2", "6 degrees about their mean";
        /// Least tilt that lasts
        least_tilt_rad: 0.04, "rad", "hands";
        /// For at most so long
        frame_s: 0.08, "s", "families";
        /// Expected direction error below which an estimate is published
        publish_deg: 10.0, "deg", "half a compass rose's sector of 22.5";
        /// Probability from which a change is decided
        certain: 0.99, "", "one false decision in a hundred";
        /// A change lasts for so long, or it was none
        change_s: 2.0, "s", "a cover put on; a door passed";
        /// A change of the device that takes time takes so long
        ramp_s: 0.3, "s", "a cover put on";
        /// Time after which another place is what is usual
        new_place_s: 30.0, "s", "a room";
    }
}
