//! Every choice of the aided estimator. What can be learned from the stream is learned; what is physics stands where it is used.
//! "Phones" are the recordings, "families" the simulated scenarios of development.

use crate::calibration::UNEVEN_UT;
use crate::estimator::answer::LEAST_TOLD_UT;
use crate::priors::{
    BEYOND_CHANCE, DAYS_UT, DEVICES_PER_H, HAND_RAD, HOPELESS, NOISE_UT, OF_USE_DEG, OUTLYING, RAMP_S, ROOM_S, ROOM_UT,
    SETTLED_S, STEP_S, UNSEEN_IRON,
};
use crate::tuning::choices;

choices! {
    /// The choices. One set serves every device and motion.
    Tuning {
        /// Standard deviation of an element of M - I before anything is known; also of the scale of a sensor where the strength is known
        iron_sd: UNSEEN_IRON, "", "priors";
        /// Bias of the gyroscope before anything is known; a device that turns no faster rests, and shows it to a third of it
        bias_sd_rad_s: 0.05, "rad/s", "phones were found with up to 0.095";
        /// Scale error of a gyroscope's axis, and how far it is off, before anything is known
        axes_sd: 0.01, "", "data sheets: 1 to 2 % of scale and across axes";
        /// How far the magnetometer is turned against gyroscope and accelerometer about each axis, before anything is known
        misalignment_sd_rad: 0.02, "rad", "three phones with motion capture have 1.0 deg (root mean square), a laboratory sensor 0.7";
        /// Random walk of the hard iron, at rest and in motion
        offset_walk_ut: 0.08, "uT/s^0.5", "0.6 uT in a minute; families";
        /// A gap between samples that is longer lets the hard iron drift, and breaks off the first fit
        gap_s: 0.5 * SETTLED_S, "s", "families";
        /// Random walk of the hard iron in a gap
        gap_walk_ut: 1.2, "uT/s^0.5", "5 uT in 20 s: a cover, an app that ends";
        /// Magnetometer noise at the start, per axis
        noise_start_ut: NOISE_UT, "uT", "data sheets";
        /// Correlation time of the local field along a walk. Longer: slow changes of the hard iron are taken for the place's
        place_correlation_s: 3.0 * STEP_S, "s", "quiet walks with motion capture: 0.46 after 1 s, 0.18 after 2 s";
        /// Correlation time of the place from one group of a start to the next
        group_s: 2.0 * STEP_S, "s", "two steps";
        /// For so long, or up to twice, what was learned before a misfit is taken back, as a magnet's field grows while it is neared
        quarantine_s: 2.0 * STEP_S, "s", "two steps";
        /// The accelerometer's average, as the world sees it, that `up` is drawn to
        felt_s: 2.0 * STEP_S, "s", "two steps";
        /// Standard deviation of the field of a place during a start, correlated over a second; what a fit leaves adds to it
        place_ut: 0.3, "uT", "between the quiet recordings (0.15) and rooms with motion capture (2.1): what a fit leaves adds to it";
        /// Standard deviation of the local field, and of the slow difference between c and f, at the start; and the largest: above it an anomaly
        /// would be swallowed instead of declared
        local_most_ut: ROOM_UT, "uT", "priors";
        /// Least standard deviation of the local field: no room is even. Smaller: the heading follows the room; larger: a slow change of the hard
        /// iron is taken for it
        local_least_ut: 0.8, "uT", "four of five quiet walks with motion capture have 1.0 or more sideways";
        /// Time over which the slow difference between c and f is averaged to see what lasts
        lasting_s: 0.5 * SETTLED_S, "s", "families";
        /// Weight of the slow innovation against NIS: it has a fiftieth of the independent samples, but is where s_d shows
        slow_weight: 0.15, "", "families";
        /// Unevenness up to which the field of a place averages out along a walk
        even_ut: UNEVEN_UT, "uT", "calibration";
        /// Memory of how often samples misfit
        burst_memory_s: ROOM_S, "s", "priors";
        /// How often the device changes, against which the rate of misfits is held
        device_rate_h: DEVICES_PER_H, "1/h", "priors";
        /// How long a change must hold, per unit of the log of these odds: a field that is passed fits for less
        hold_s: RAMP_S, "s", "priors";
        /// Memory of what must be seen at once: whether samples fit, how c and f differ
        quick_s: 0.5 * STEP_S, "s", "a hand covers an unevenness in a second or more";
        /// Memory of noise, rate and rest
        memory_s: STEP_S, "s", "priors";
        /// Memory of what changes slowly: up, unevenness, how much was turned of late; motion after which a calibration is proven
        settled_s: SETTLED_S, "s", "families";
        /// Gate on v^T S^-1 v (three degrees of freedom): a sample above it is not used
        gate: OUTLYING * OUTLYING, "", "one good sample in 900";
        /// Share of gated samples from which the status is suspect and the hypotheses start
        suspect_share: 0.2, "", "0.11 s of nothing but gated samples";
        /// A change of the device that has won is told, and kept, once samples have fitted it for so long in motion. Shorter: a magnet that is passed is
        /// told; longer: a change is told later
        probation_s: 3.0 * STEP_S, "s", "boards with motion capture: false changes stop fitting within a second";
        /// Share of the error that field and vertical have in common by the gyroscope, of what they would have were all of both its doing
        common_share: 0.5, "", "quiet phones with motion capture: within two sigmas .77 at least; with 1 .65";
        /// Least size of a step; less than half of it is no misfit of a former calibration, nor of a start, nor an event
        smallest_step_ut: 2.0 * LEAST_TOLD_UT, "uT", "a cover";
        /// A change takes up to this long: meanwhile the hypotheses let their unknown walk by the least size of a step and are not compared
        ramp_s: RAMP_S, "s", "priors";
        /// Log likelihood ratio, per sample of 10 ms, at which a hypothesis wins: residuals of a real field are not white
        decide_log_ratio: HOPELESS, "", "recordings";
        /// Rotation since the onset before a hypothesis may win
        decide_rotation_rad: 0.5, "rad", "only rotation tells device from place";
        /// Time a changed place is held before it is taken as the new place
        place_time_s: ROOM_S, "s", "priors";
        /// Time in which a new place is believed to be the earth's field
        new_place_time_s: 300.0, "s", "a building";
        /// Standard deviation of the hard iron (root of the trace) up to which the first fit goes on as a filter
        adopt_sd_ut: BEYOND_CHANCE * DAYS_UT, "uT", "a filter that begins less sure trusts its first turns too much";
        /// Standard deviation of the field's direction, about the vertical where it is known, up to which a start is told
        publish_deg: OF_USE_DEG, "deg", "priors";
        /// Rate from which motion is full: all of the process noise and of the learning applies
        full_motion_rad_s: HAND_RAD, "rad/s", "priors";
    } mechanisms {
        /// Unevenness of the place: d, and what c and f differ by
        unevenness;
        /// Walk of the hard iron, at rest and in motion
        hard_iron_walk;
        /// Scale and axes of the gyroscope: S
        gyroscope_axes;
        /// Delay of the magnetometer: tau
        delay;
        /// Recall of the calibration from before the last step
        recall;
        /// The Earth's field, carried beside that of a new place
        new_place;
        /// What was learned just before a misfit is taken back
        quarantine;
        /// How long a change must hold in a place whose field bursts
        hold;
        /// What bursts leave in samples that fit
        left;
        /// Learning of the magnetometer's noise: sigma
        noise_learning;
        /// Learning of the local field's size: s_d
        local_learning;
        /// What sigma has for a field that the filter follows: rho and G
        followed;
        /// A change of the device is told once it has held
        probation;
        /// `up` follows what the field teaches of the gyroscope
        follow;
        /// A local field beyond what is left to a place is a misfit
        local_gate;
        /// The second-order term of the innovation's covariance
        second_order;
        /// The mean rate since the delay, in place of the latest
        recent;
        /// A change takes a while: the hypotheses' unknown walks meanwhile
        ramp;
        /// A step of the device is sought from a place that held
        place_holds;
        /// The accelerometer is averaged for longer where motion lasts
        long_up;
        /// First fit: what a place leaves widens it
        misfit;
        /// First fit: information that a bias of the gyroscope would feign
        feigned;
        /// First fit: what is unlikely beforehand is none
        plausible;
        /// First fit: the oldest groups go where a device may have changed
        forget;
    }
}

impl Tuning {
    /// Standard deviation of the gyroscope's bias above which a steady small rate may be bias, rad/s.
    pub(super) fn unknown_bias_rad_s(&self) -> f64 {
        self.bias_sd_rad_s / 3.0
    }
}
