//! Every choice of the adaptive estimator. What can be learned from the stream is learned; what is physics stands where it is
//! used. "Families" are simulated scenarios of development: motion, places, drift, spikes; seeds 1 to 6.

use crate::tuning::choices;

choices! {
    /// The choices.
    Tuning {
        /// White noise before it is learned
        noise_ut: 0.5, "uT", "data sheets: a Nexus 5 has 0.48, iPhones 0.7 to 1.1";
        /// Unevenness of a place before it is learned
        uneven_ut: 0.5, "uT", "families";
        /// How long the same unevenness lasts before that is learned
        uneven_s: 0.1, "s", "families";
        /// Tilt of a hand that moves, before it is learned
        tilt_rad: 0.06, "rad", "hands";
        /// How long the same tilt lasts
        tilt_s: 0.5, "s", "a step of a pedestrian";
        /// Least tilt that is believed
        least_tilt_rad: 0.02, "rad", "bias of accelerometers: 0.1 to 0.2 m/s^2";
        /// Standard deviation of the logarithm of what is believed of unevenness and tilt
        believed_spread: 1.0, "", "an order of magnitude either way within two";
        /// Share of samples that are spikes, per uT of the range over which they spread
        spikes_per_ut: 2e-4, "1/uT", "one sample in fifty over 100 uT";
        /// Changes of the device's disturbance
        devices_per_h: 10.0, "1/h", "families";
        /// Changes of the place
        places_per_h: 60.0, "1/h", "families";
        /// A small change of b
        small_ut: 8.0, "uT", "a current, a cover";
        /// A large change of b
        large_ut: 20.0, "uT", "a magnet";
        /// How far M changes with b, relative, for each uT
        iron_per_ut: 0.003, "1/uT", "covers; a steel plate with a magnet";
        /// A small change of the strength and the vertical part of the place's field, relative to the
        /// strength; also of a strength that was given
        small_place: 0.05, "", "rooms";
        /// A large change of them
        large_place: 0.3, "", "next to steel";
        /// Random walk of b
        walk_ut: 0.003, "uT/s^0.5", "temperature";
        /// Rate of b that moves
        rate_ut_s: 0.4, "uT/s", "families";
        /// How long a rate lasts
        rate_s: 60.0, "s", "families";
        /// Log odds of a b that begins to move, or comes to rest, each time that is considered
        log_moves: -7.0, "", "families";
        /// What a b that begins to move leaves open of b
        moved_ut: 2.0, "uT", "families";
        /// How far M deviates from a multiple of I before anything is known, as standard deviations: little
        cold_little: 0.05, "", "phones";
        /// Much
        cold_much: 0.2, "", "phones with covers";
        /// By how much less the cross elements of M deviate than its diagonal
        cross: 0.7, "", "soft iron of phones";
        /// Field strength that coordinates count in over that of the place, before anything is known
        cold_scale: 1.05, "", "the Earth's field, 22 to 67 uT";
        /// Its standard deviation
        cold_scale_sd: 0.28, "", "the same";
        /// How far b is from the first sample before anything is known, in field strengths, per axis
        cold_centre: 0.75, "", "a field strength";
        /// Log probability that a calibration that was given does not hold at all
        log_cold: -6.0, "", "one launch in 400";
        /// Samples nearer than this to one another are averaged (4.5 standard deviations of noise on top)
        group_ut: 2.0, "uT", "2 degrees";
        /// For at most so long. Changes that no sample announces are looked for at every second group, and samples stay moments for
        /// eight groups before they may become prior
        group_s: 0.08, "s", "families";
        /// Expected direction error below which they may: the linearisation holds
        absorb_deg: 0.8, "deg", "families";
        /// The same where b moves
        absorb_moving_deg: 6.0, "deg", "families";
        /// Expected direction error above which a hypothesis does not judge samples
        unsure_deg: 8.0, "deg", "families";
        /// Expected direction error above which another lobe of the ellipsoid is looked for
        twin_deg: 3.0, "deg", "families";
        /// Expected direction error below which an estimate is published
        publish_deg: 10.0, "deg", "half a compass rose's sector of 22.5";
        /// Probability from which a change is decided
        certain: 0.99, "", "one false decision in a hundred";
        /// Least change of directions that is told
        least_change_deg: 1.5, "deg", "what a user notices";
        /// A change lasts for so long, or it was none; changes that begin within it of one another are one
        change_s: 2.0, "s", "a cover put on; a door passed";
        /// Time after which another place is what is usual
        new_place_s: 30.0, "s", "a room";
        /// Least log of the joint probability, relative to the best, of a hypothesis that is kept
        log_hopeless: -30.0, "", "families";
        /// A fit is worth while when the samples have become so many times more
        growth: 1.3, "", "families";
        /// A step that lowers F by less is the last of a fit
        settled: 0.2, "", "families";
        /// Two estimates nearer than this (field strengths) are one
        same_place: 0.1, "", "families";
        /// F of another lobe of the ellipsoid may exceed that of the first by so much
        twin_worse: 20.0, "", "families";
        /// Share of the noise's curvature that keeps an estimate finite where there are fewer samples than parameters
        softened: 0.5, "", "families";
        /// A prediction's variance may be so many times as large: it is linearised
        doubt: 4.0, "", "two standard deviations";
        /// The share of gravity by which a vertical may be accelerated to be one
        calm: 0.1, "", "families";
        /// Levenberg-Marquardt iterations that a sample may cost
        iterations: 12.0, "", "the longest push";
    }
}

impl Tuning {
    /// Changes of either.
    pub(super) fn changes_per_h(&self) -> f64 {
        self.devices_per_h + self.places_per_h
    }

    /// Time between looks for a change that no sample announces, s.
    pub(super) fn look_s(&self) -> f64 {
        2.0 * self.group_s
    }
}
