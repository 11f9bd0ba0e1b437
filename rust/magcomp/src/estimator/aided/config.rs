//! The numbers of the aided estimator: unit, effect, default, and where the default comes from.

use crate::config::ConfigError;
use serde::{Deserialize, Serialize};

macro_rules! config {
    ($($(#[$doc:meta])* $name:ident = $default:expr, $low:expr, $high:expr;)*) => {
        /// The numbers of the aided estimator. One set serves every device and motion: change one only with a reason.
        #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(default, deny_unknown_fields)]
        pub struct AidedConfig {
            $($(#[$doc])* pub $name: f64,)*
        }

        impl Default for AidedConfig {
            fn default() -> Self {
                Self { $($name: $default,)* }
            }
        }

        impl AidedConfig {
            /// Every number with its name.
            pub fn settings(&self) -> impl Iterator<Item = (&'static str, f64)> {
                [$((stringify!($name), self.$name),)*].into_iter()
            }

            /// Sets the number of that name. False when there is none; the range is checked with the whole config.
            #[must_use]
            pub fn set(&mut self, name: &str, value: f64) -> bool {
                match name {
                    $(stringify!($name) => self.$name = value,)*
                    _ => return false,
                }
                true
            }

            /// Checks every field against its range.
            pub(crate) fn validate(&self) -> Result<(), ConfigError> {
                $(
                    if !($low..=$high).contains(&self.$name) {
                        return Err(ConfigError {
                            field: concat!("aided.", stringify!($name)),
                            value: self.$name.to_string(),
                            expected: concat!($low, " to ", $high),
                        });
                    }
                )*
                Ok(())
            }
        }
    };
}

config! {
    /// Middle of the field strengths expected, uT. Default 45: the earth's field is 22 to 67 (world magnetic model).
    strength_ut = 45.0, 10.0, 100.0;
    /// Standard deviation of the field strength about it, uT. Small: biased at the ends of the range. Large: the start
    /// takes longer. Default 13, the spread of the field over the land of the earth.
    strength_sd_ut = 13.0, 0.1, 100.0;
    /// Standard deviation of an element of M - I before anything is known. Small: strong soft iron is put into b.
    /// Large: slow start. Default 0.08: phones have up to 10 % (the prototype: 0.06).
    iron_sd = 0.08, 0.001, 0.5;
    /// Largest standard deviation to which steps may raise an element of M - I. Small: slow after
    /// a soft iron step. Large: flexible hypotheses. Default 0.12 (the prototype: 0.10).
    iron_sd_max = 0.12, 0.001, 1.0;
    /// Standard deviation of the gyroscope's bias before anything is known, rad/s. Small: a poor gyroscope is believed.
    /// Large: the start takes longer. Default 0.05: phones were found with up to 0.095 (5.4 deg/s, iPhone 5).
    bias_sd_rad_s = 0.05, 1e-5, 1.0;
    /// Standard deviation of the magnetometer's delay against the gyroscope before anything is known, s.
    /// Small: a late magnetometer is put into
    /// d. Large: slow start. Default 0.010: from -7 to 27 ms were found (measured with a prototype).
    delay_sd_s = 0.010, 0.0, 0.2;
    /// Random walk of the delay, s per square root of a second. Default 2e-5: constant for a device, but not exactly.
    delay_walk = 2e-5, 0.0, 0.01;
    /// Random walk of the field of the place in the device frame beyond gyroscope noise, uT per square root of a second.
    /// Large: the carried field follows the place sooner, is noisier. Default 0.015 (the prototype: 0.05).
    field_walk_ut = 0.015, 1e-4, 10.0;
    /// Angle random walk of the gyroscope, rad per square root of a second. Default 3e-4: phones have 1e-4 to 3e-4
    /// (data sheets).
    angle_walk_rad = 3e-4, 1e-6, 0.1;
    /// Standard deviation of the scale error of a gyroscope's axis before anything is known. Small: a poor gyroscope is
    /// believed. Large: slow start. Default 0.008: data sheets of phones' gyroscopes say 1 to 3 % at the most.
    scale_sd = 0.008, 0.0, 0.2;
    /// What is left of the gyroscope's scale error once it is estimated (cross axis, timing), as noise in proportion to
    /// the rate, square root of a second. Large: f is noisier. Default 0.001.
    scale_walk = 0.001, 0.0, 0.5;
    /// Random walk of the gyroscope's bias, rad/s per square root of a second. Small: a
    /// warming gyroscope is followed late. Large: the heading wanders. Default 5e-5 (the prototype: 2e-4).
    bias_walk_rad_s = 5e-5, 1e-8, 0.1;
    /// Random walk of the soft iron, per square root of a second. Small: never relearned without a step.
    /// Large: noisier. Default 1e-4 (the prototype: 5e-4).
    iron_walk = 1e-4, 0.0, 0.1;
    /// Least random walk of the hard iron, uT per square root of a second: what it falls to while nothing drifts.
    /// Default 0.03: 0.25 uT in a minute.
    offset_walk_min_ut = 0.03, 1e-4, 10.0;
    /// Random walk of the hard iron at the start, uT per square root of a second. Small: drift is noticed late.
    /// Large: a noisy first minute. Default 0.3 (the prototype: 0.4, always).
    offset_walk_ut = 0.3, 1e-4, 10.0;
    /// Largest random walk of the hard iron. Default 1.2: follows 1 uT/s.
    offset_walk_max_ut = 1.2, 1e-4, 50.0;
    /// Time over which corrections of the hard iron are gathered to judge its random walk, s. Small: noise is taken for
    /// drift. Large: drift is noticed late. Default 2.
    offset_walk_time_s = 2.0, 0.1, 60.0;
    /// Magnetometer noise at the start, uT per axis. Default 0.5 (BROAD, Nexus 5: 0.48; iPhones 0.7 to 1.1).
    noise_start_ut = 0.5, 0.01, 20.0;
    /// Least magnetometer noise, uT per axis. Default 0.2.
    noise_min_ut = 0.2, 0.001, 20.0;
    /// Memory of the noise estimate, s. Small: it scatters. Large: a change is noticed late. Default 0.5 (a gain of 0.02 at 100 Hz).
    noise_time_s = 0.5, 0.05, 60.0;
    /// Correlation time of the local field, s: the time it takes to walk through an unevenness. Small: the
    /// unevenness goes into m and b. Large: steps are swallowed for longer. Default 1 (the prototype).
    local_time_s = 1.0, 0.05, 60.0;
    /// Standard deviation of the local field at the start, uT. Small: an uneven room spoils the
    /// first calibration. Large: it takes longer. Default 1.
    local_start_ut = 1.0, 0.01, 20.0;
    /// Least standard deviation of the local field, uT. Default 0.01.
    local_min_ut = 0.01, 1e-3, 20.0;
    /// Largest: above it an anomaly would be swallowed instead of declared. Default 2 (the prototype: 3).
    local_max_ut = 2.0, 0.1, 50.0;
    /// Jitter of the sample times, s: adds noise in proportion to the rate of turn. Default 0.001.
    jitter_s = 0.001, 0.0, 0.05;
    /// Gate on v^T S^-1 v (three degrees of freedom): a sample above it is not used. Small: good samples
    /// lost, false suspicion. Large: spikes get in, steps are noticed late. Default 16 (1 in 900).
    gate = 16.0, 8.0, 1000.0;
    /// Time constant of the share of gated samples, s. Small: a few spikes raise suspicion. Large: late. Default 0.6.
    gated_time_s = 0.6, 0.05, 10.0;
    /// Time constant with which that share falls while hypotheses run, s: how soon a disturbance is over.
    /// Small: a chance fit ends it. Large: it is told for too long. Default 0.25.
    clear_time_s = 0.25, 0.02, 10.0;
    /// Share of gated samples from which the status is `Suspect` and the hypotheses start. Default 0.14: 0.09 s of
    /// nothing but gated samples. Small: spikes start hypotheses.
    suspect_share = 0.14, 0.02, 0.9;
    /// Share of gated samples below which the hypothesis "nothing happened" has won. Default 0.08.
    clear_share = 0.08, 0.001, 0.5;
    /// Rotation since the onset before a hypothesis may win, rad. Small: eager, false steps in real rooms. Large: late.
    /// Default 0.5 (measured with a prototype).
    decide_rotation_rad = 0.5, 0.05, 6.3;
    /// Time since the onset before a hypothesis may win, s. Default 0.4.
    decide_time_s = 0.4, 0.0, 10.0;
    /// Log likelihood ratio at which a hypothesis wins. Small: eager. Large: late. Default 6.
    decide_log_ratio = 6.0, 0.5, 30.0;
    /// Weight of a 10 ms sample's log likelihood: residuals of a real field are not white. Default 0.2 (the prototype).
    likelihood_weight = 0.2, 0.01, 1.0;
    /// A hypothesis that explains less than this share of the recent samples (0.25 s) has failed. Default 0.5.
    fit_share = 0.5, 0.05, 1.0;
    /// Both hypotheses failing for this long since the onset is `erratic`, s. Default 1.
    erratic_time_s = 1.0, 0.1, 20.0;
    /// Rotation without which a device step is not believed within an erratic field, rad. Default 1.5.
    erratic_rotation_rad = 1.5, 0.1, 20.0;
    /// Standard deviation given to the gyroscope's bias when the field turns erratic, rad/s. Default 0.03.
    erratic_bias_rad_s = 0.03, 0.0, 0.2;
    /// Time for which a hypothesis must hold to win within an erratic field, s. Default 3.
    erratic_settle_s = 3.0, 0.1, 60.0;
    /// Time a changed place is held before it is taken as the new place, s. Default 30 (the prototype).
    place_time_s = 30.0, 1.0, 3600.0;
    /// Standard deviation of an erratic field about the earth's, uT, and
    erratic_sd_ut = 10.0, 1.0, 500.0;
    /// its correlation time, s: how slowly the carried field is drawn to erratic samples. Default 10 uT, 2 s.
    erratic_correlation_s = 2.0, 0.1, 100.0;
    /// Deviation of |c| from its running median, as a share, from which the field counts as disturbed. Default 0.15.
    strength_share = 0.15, 0.02, 1.0;
    /// Time constant of that deviation, s. Default 0.05.
    strength_time_s = 0.05, 0.0, 10.0;
    /// Pace of the running median of |c|, uT/s. Default 0.2.
    strength_pace_ut_s = 0.2, 0.0, 10.0;
    /// Standard deviation of the hard iron up to which a calibration counts as found, uT (root of the trace).
    /// Small: late first reading. Large: a wild first guess. Default 6 (the prototype).
    adopt_sd_ut = 6.0, 0.5, 50.0;
    /// Standard deviation of the hard iron (root of the trace) at which the filter starts anew about its own first
    /// answer, uT. Default 8.
    restart_sd_ut = 8.0, 1.0, 50.0;
    /// Rate of turn below which the device rests, rad/s (low-passed 0.5 s, bias removed). Default 0.06: slower turns
    /// cannot be told from bias, and what is learned from them is wrong (measured with a prototype).
    rest_rate_rad_s = 0.06, 0.001, 1.0;
    /// Samples further apart than this break the chain of rotations, if the gyroscope does not bridge it, s. Default 0.5.
    gap_s = 0.5, 0.05, 10.0;
    /// Drift of the hard iron allowed for in a gap, uT per square root of a second. Default 1.
    gap_offset_walk_ut = 1.0, 0.0, 50.0;
    /// Unevenness of the field that the covariance cannot know, per uT of slow difference between c and f.
    /// Small: over-confident in rooms. Large: cautious. Default 2.2, from the six undisturbed recordings.
    uneven_gain = 2.2, 0.0, 10.0;
    /// Most of that slow difference that counts, uT; also its value at the start. Default 0.55.
    uneven_max_ut = 0.55, 0.0, 20.0;
    /// Memory of that difference's power, s. Default 5.
    uneven_time_s = 5.0, 0.1, 300.0;
    /// Gravity, m/s^2. Default 9.80665.
    gravity_m_s2 = 9.80665, 9.0, 10.5;
    /// Deviation of the accelerometer's magnitude from gravity at which its weight has fallen to 37 %, m/s^2.
    /// Default 0.7: a walker's phone swings by 2 to 4.
    gravity_tolerance_m_s2 = 0.7, 0.01, 10.0;
    /// Time constant with which `up` follows the accelerometer, s. Default 2 (measured with a prototype).
    up_time_s = 2.0, 0.05, 60.0;
}
