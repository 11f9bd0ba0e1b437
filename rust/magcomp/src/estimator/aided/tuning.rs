//! Every choice of the aided estimator. What can be learned from the stream is learned; what is physics stands where it is used.
//! "Phones" are the recordings, "families" the simulated scenarios of development.

use crate::tuning::choices;

choices! {
    /// The choices. One set serves every device and motion.
    Tuning {
        /// Standard deviation of an element of M - I before anything is known; also of the scale of a sensor where the strength is known
        iron_sd: 0.08, "", "phones have up to 10 %";
        /// Bias of the gyroscope before anything is known
        bias_sd_rad_s: 0.05, "rad/s", "phones were found with up to 0.095";
        /// Delay of the magnetometer against the gyroscope before anything is known
        delay_sd_s: 0.010, "s", "from -7 to 27 ms were found";
        /// Scale error of a gyroscope's axis before anything is known
        scale_sd: 0.008, "", "data sheets: 1 to 3 % at the most";
        /// Share of its variance that the three axes have in common
        scale_common: 0.8, "", "one drive, one temperature";
        /// Angle random walk of the gyroscope
        angle_walk_rad: 3e-4, "rad/s^0.5", "data sheets: 1e-4 to 3e-4";
        /// Noise in proportion to the rate, for what is left of the scale error (cross axis, timing)
        scale_walk: 0.001, "s^0.5", "families";
        /// Random walk of the gyroscope's bias
        bias_walk_rad_s: 5e-5, "rad/s^1.5", "warming";
        /// Random walk of the field of the place in the device frame beyond gyroscope noise
        field_walk_ut: 0.015, "uT/s^0.5", "families";
        /// Random walk of the soft iron
        iron_walk: 1e-4, "1/s^0.5", "families";
        /// Random walk of the hard iron at the start
        offset_walk_ut: 0.25, "uT/s^0.5", "families";
        /// Least random walk of the hard iron
        offset_walk_min_ut: 0.03, "uT/s^0.5", "0.25 uT in a minute";
        /// Largest random walk of the hard iron
        offset_walk_max_ut: 1.2, "uT/s^0.5", "follows 1 uT/s";
        /// Time over which corrections of the hard iron are gathered to judge its random walk
        offset_walk_time_s: 2.0, "s", "families";
        /// A larger walk than this is a drift: corrections are gathered for longer
        drift_walk_ut: 0.4, "uT/s^0.5", "families";
        /// They are gathered no longer than this
        longest_walk_s: 6.0, "s", "families";
        /// How fast a window of them changes the walk
        walk_gain: 0.3, "", "families";
        /// A walk is never believed to be more than this many times what the filter allows for
        largest_walk_share: 3.0, "", "families";
        /// Share of the walk that could be seen below which the ratio says nothing
        least_given: 0.05, "", "families";
        /// Magnetometer noise at the start, per axis
        noise_start_ut: 0.5, "uT", "a Nexus 5 has 0.48, iPhones 0.7 to 1.1";
        /// Least magnetometer noise, per axis
        noise_min_ut: 0.2, "uT", "phones";
        /// Memory of the noise estimate
        noise_time_s: 0.5, "s", "families";
        /// Correlation time of the local field: the time it takes to walk through an unevenness
        local_time_s: 1.0, "s", "a step or two";
        /// Standard deviation of the local field at the start
        local_start_ut: 1.0, "uT", "rooms";
        /// Least standard deviation of the local field: from less it rises too slowly where an uneven place is entered
        local_min_ut: 0.03, "uT", "families";
        /// Largest: above it an anomaly would be swallowed instead of declared
        local_max_ut: 2.0, "uT", "rooms";
        /// Time constant of the slow difference between c and f, and of the slow innovation
        slow_time_s: 0.25, "s", "a hand covers an unevenness in a second or more";
        /// Weight of the slow innovation against NIS: it has a fiftieth of the independent samples, but is where s_d shows
        slow_weight: 0.15, "", "families";
        /// NIS beyond which a sample is a spike and says nothing about the local field
        spike_nis: 200.0, "", "families";
        /// Unevenness of the field that the covariance cannot know, per uT of slow difference between c and f
        uneven_gain: 2.15, "", "the undisturbed recordings";
        /// Most of that difference that counts; also its value at the start
        uneven_max_ut: 0.58, "uT", "recordings";
        /// Memory of its power
        uneven_time_s: 5.0, "s", "recordings";
        /// Gate on v^T S^-1 v (three degrees of freedom): a sample above it is not used
        gate: 16.0, "", "one good sample in 900";
        /// NIS from which a sample is used with a noise as large as what it does not explain
        doubt_nis: 9.0, "", "one good sample in 30";
        /// Time constant of the share of gated samples
        gated_time_s: 0.6, "s", "families";
        /// The same as it falls while hypotheses run
        clear_time_s: 0.25, "s", "families";
        /// Share of gated samples from which the status is suspect and the hypotheses start
        suspect_share: 0.14, "", "0.09 s of nothing but gated samples";
        /// Share below which the hypothesis "nothing happened" has won
        clear_share: 0.08, "", "families";
        /// A gated sample after a share below this begins a new run
        new_run: 0.05, "", "families";
        /// Share of gated samples at which the offset is freed before a calibration was found
        unadopted_share: 0.451, "", "families";
        /// Gain of the size of what does not fit
        misfit_gain: 0.1, "", "ten samples";
        /// Least size of a step
        smallest_step_ut: 8.0, "uT", "a cover";
        /// Step of the soft iron that goes with one of 20 uT, up to half as much more
        iron_step: 0.05, "", "a cover with steel";
        /// A change takes up to this long: meanwhile the hypotheses let their unknown walk and are not compared
        ramp_s: 0.4, "s", "a cover put on";
        /// That walk
        ramp_walk_ut: 4.0, "uT/s^0.5", "families";
        /// Log likelihood ratio at which a hypothesis wins
        decide_log_ratio: 6.0, "", "families";
        /// Rotation since the onset before a hypothesis may win
        decide_rotation_rad: 0.5, "rad", "only rotation tells device from place";
        /// Weight of a 10 ms sample's log likelihood: residuals of a real field are not white
        likelihood_weight: 0.2, "", "recordings";
        /// Time constant of the share of samples that a hypothesis does not explain
        fit_time_s: 0.25, "s", "families";
        /// That share from which it has failed
        fit_share: 0.5, "", "families";
        /// Least residual at which a former calibration does not fit again
        recall_limit_ut: 4.0, "uT", "families";
        /// What is added to its standard deviation: b
        recall_sd_ut: 1.0, "uT", "a cover put on again";
        /// Both hypotheses failing for this long since the onset is erratic
        erratic_time_s: 1.0, "s", "families";
        /// Rotation without which a device step is not believed within an erratic field
        erratic_rotation_rad: 1.5, "rad", "families";
        /// Time for which a hypothesis must hold to win within an erratic field
        erratic_settle_s: 3.0, "s", "families";
        /// Share of misfits allowed to it
        strict_misfit: 0.15, "", "families";
        /// Standard deviation given to the gyroscope's bias when the field turns erratic
        erratic_bias_rad_s: 0.03, "rad/s", "families";
        /// Standard deviation of an erratic field about the earth's
        erratic_sd_ut: 10.0, "uT", "families";
        /// Correlation time of an erratic field
        erratic_correlation_s: 2.0, "s", "families";
        /// A misfit within this time of one that passed by itself is likelier the place's again than the device's
        unrest_s: 120.0, "s", "a walk through a building";
        /// Motion for which the calibration still holds after a disturbance: what bends a field bends it around too
        hold_s: 3.0, "s", "a room";
        /// Time a changed place is held before it is taken as the new place
        place_time_s: 30.0, "s", "a room";
        /// Time in which a new place is believed to be the earth's field
        new_place_time_s: 300.0, "s", "a building";
        /// The field is what it was before a new place when it differs from that by less than this share
        back_share: 0.3, "", "rooms";
        /// Deviation of |c| from its running median, as a share, from which the field counts as disturbed
        strength_share: 0.15, "", "rooms";
        /// Time constant of that deviation
        strength_time_s: 0.05, "s", "spikes";
        /// Pace of the running median
        strength_pace_ut_s: 0.2, "uT/s", "families";
        /// The running median is faster before this age, in inverse proportion to it
        learned_s: 30.0, "s", "families";
        /// Motion after the first calibration until the median, and the calibration itself, count as known
        young_s: 5.0, "s", "families";
        /// Only deviations beyond so many sigmas of |c| count
        strength_sigmas: 3.0, "", "one in 400";
        /// Split of a first sample that may be a field without an offset
        near_sd_ut: 25.0, "uT", "the field of the earth";
        /// Split of any other
        far_sd_ut: 30.0, "uT", "the field of the earth";
        /// A first sample that so many after it do not fit was a spike
        confirming: 3.0, "", "spikes";
        /// Standard deviation of the hard iron (root of the trace) at which the filter starts anew about its own first answer
        restart_sd_ut: 8.0, "uT", "families";
        /// Added to what the bias is known to then
        restart_bias_rad_s: 0.002, "rad/s", "families";
        /// Standard deviation of the hard iron (root of the trace) up to which a calibration counts as found
        adopt_sd_ut: 6.0, "uT", "7 degrees in a weak field";
        /// How well a calibration that was given is believed: b, per axis
        given_offset_sd_ut: 2.0, "uT", "a day's drift of a phone";
        /// An element of M - I
        given_iron_sd: 0.02, "", "a day's drift of a phone";
        /// Turn in which such a calibration must prove itself
        proving_rad: 0.8, "rad", "a b wrong by 20 uT leaves a misfit of 16 uT";
        /// Motion in which its b may not be moved far
        proving_s: 5.0, "s", "families";
        /// That is, by more than so many sigmas
        refuting_sigmas: 6.0, "", "families";
        /// Share by which the magnitude may be off the one that goes with it
        contradiction_share: 0.5, "", "more than a building bends a field";
        /// Samples further apart than this break the chain of rotations
        gap_s: 0.5, "s", "phones";
        /// A gap longer than this many times that still lets the offset drift, even if the gyroscope bridged it
        long_gap: 5.0, "", "families";
        /// Drift of the hard iron allowed for in a gap
        gap_offset_walk_ut: 1.0, "uT/s^0.5", "phones";
        /// Drift in a gap is not counted beyond this: the drift of a phone is bounded
        longest_drift_s: 225.0, "s", "15 uT";
        /// What is known about |h| across a gap
        gap_strength_sd_ut: 5.0, "uT", "rooms";
        /// Rate of turn below which the device rests: slower turns cannot be told from bias
        rest_rate_rad_s: 0.06, "rad/s", "phones";
        /// Share of it by which the rate may scatter at rest while the bias is not known yet
        rest_scatter: 0.35, "", "phones";
        /// Uncertainty of the bias above which a steady small rate may be bias
        unknown_bias_rad_s: 0.02, "rad/s", "phones";
        /// Largest bias a phone was found with, with room
        largest_bias_rad_s: 0.15, "rad/s", "phones";
        /// Rest before the rate measures the bias; also the memory of the rate
        rate_time_s: 0.5, "s", "families";
        /// Noise of that measurement for a sample of 10 ms
        rest_rate_sd_rad_s: 0.03, "rad/s", "phones";
        /// Rate from which motion is full: all of the process noise and of the learning applies
        full_motion_rad_s: 0.3, "rad/s", "families";
        /// Least share of it
        least_motion: 0.02, "", "families";
        /// Time over which it counts how much was turned of late
        turned_time_s: 5.0, "s", "families";
        /// Rate lately below which nothing is being learned
        too_little_rad_s: 0.04, "rad/s", "families";
        /// Time constant with which up follows the accelerometer
        up_time_s: 5.0, "s", "recordings";
        /// Time over which the accelerometer is averaged, as the world sees it, before anything is cut off
        felt_time_s: 1.0, "s", "a step or two";
        /// What is left of it beside gravity counts as no more than this, in g
        largest_off: 0.2, "", "recordings";
        /// Tilt that a gyroscope feigns which is late
        feigned_rad2: 3.05e-4, "rad^2", "one degree, 10 ms";
        /// What is not known about the gyroscope's own time
        clock_s: 5e-4, "s", "phones";
        /// The same as a share of the delay found, where the magnetometer is late
        clock_share_late_magnetometer: 0.35, "", "phones";
        /// Where the gyroscope is
        clock_share_late_gyroscope: 0.15, "", "phones";
        /// One step beyond which a gyroscope does not explain what the field does
        useless_step_ut: 17.0, "uT", "families";
        /// The same per turn
        useless_lever_ut: 150.0, "uT/rad", "the largest offset";
        /// Gain of the share of such steps
        useless_gain: 0.05, "", "twenty samples";
        /// Share from which the gyroscope is useless
        useless_on: 0.6, "", "families";
        /// Share below which it is useful again
        useless_off: 0.3, "", "families";
    }
}
