//! The numbers of the aided estimator: unit, effect, default, and where the default comes from.

use serde::{Deserialize, Serialize};

macro_rules! config {
    ($($(#[$doc:meta])* $name:ident = $default:expr;)*) => {
        /// The numbers of the aided estimator. One set serves every device and motion: change one only with a reason.
        #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
        pub(crate) struct AidedConfig {
            $($(#[$doc])* pub $name: f64,)*
        }

        impl Default for AidedConfig {
            fn default() -> Self {
                Self { $($name: $default,)* }
            }
        }
    };
}

config! {
    /// Middle of the field strengths expected, uT. Default 45: the earth's field is 22 to 67 (world magnetic model). Where the
    /// strength is known, `Config::field_strength_ut` says it to every method, and neither this nor `strength_sd_ut` matters.
    strength_ut = 45.0;
    /// Standard deviation of the field strength about it, uT. Small: biased at the ends of the range. Large: the start
    /// takes longer. Default 13, the spread of the field over the land of the earth.
    strength_sd_ut = 13.0;
    /// Standard deviation of an element of M - I before anything is known. Small: strong soft iron is put into b.
    /// Large: slow start. Default 0.08: phones have up to 10 % (the prototype: 0.06).
    iron_sd = 0.08;
    /// Standard deviation of the gyroscope's bias before anything is known, rad/s. Small: a poor gyroscope is believed.
    /// Large: the start takes longer. Default 0.05: phones were found with up to 0.095 (5.4 deg/s, iPhone 5).
    bias_sd_rad_s = 0.05;
    /// Standard deviation of the magnetometer's delay against the gyroscope before anything is known, s.
    /// Small: a late magnetometer is put into
    /// d. Large: slow start. Default 0.010: from -7 to 27 ms were found (measured with a prototype).
    delay_sd_s = 0.010;
    /// Angle random walk of the gyroscope, rad per square root of a second. Default 3e-4: phones have 1e-4 to 3e-4
    /// (data sheets).
    angle_walk_rad = 3e-4;
    /// Standard deviation of the scale error of a gyroscope's axis before anything is known. Small: a poor gyroscope is
    /// believed. Large: slow start. Default 0.008: data sheets of phones' gyroscopes say 1 to 3 % at the most.
    scale_sd = 0.008;
    /// Random walk of the gyroscope's bias, rad/s per square root of a second. Small: a
    /// warming gyroscope is followed late. Large: the heading wanders. Default 5e-5 (the prototype: 2e-4).
    bias_walk_rad_s = 5e-5;
    /// Largest random walk of the hard iron. Default 1.2: follows 1 uT/s.
    offset_walk_max_ut = 1.2;
    /// Magnetometer noise at the start, uT per axis. Default 0.5 (BROAD, Nexus 5: 0.48; iPhones 0.7 to 1.1).
    noise_start_ut = 0.5;
    /// Least magnetometer noise, uT per axis. Default 0.2.
    noise_min_ut = 0.2;
    /// Largest: above it an anomaly would be swallowed instead of declared. Default 2 (the prototype: 3).
    local_max_ut = 2.0;
    /// Share of gated samples from which the status is `Suspect` and the hypotheses start. Default 0.14: 0.09 s of
    /// nothing but gated samples. Small: spikes start hypotheses.
    suspect_share = 0.14;
    /// Rotation since the onset before a hypothesis may win, rad. Small: eager, false steps in real rooms. Large: late.
    /// Default 0.5 (measured with a prototype).
    decide_rotation_rad = 0.5;
    /// Time a changed place is held before it is taken as the new place, s. Default 30 (the prototype).
    place_time_s = 30.0;
    /// Deviation of |c| from its running median, as a share, from which the field counts as disturbed. Default 0.15.
    strength_share = 0.15;
    /// Standard deviation of the hard iron up to which a calibration counts as found, uT (root of the trace).
    /// Small: late first reading. Large: a wild first guess. Default 6 (the prototype).
    adopt_sd_ut = 6.0;
    /// Rate of turn below which the device rests, rad/s (low-passed 0.5 s, bias removed). Default 0.06: slower turns
    /// cannot be told from bias, and what is learned from them is wrong (measured with a prototype).
    rest_rate_rad_s = 0.06;
    /// Samples further apart than this break the chain of rotations, if the gyroscope does not bridge it, s. Default 0.5.
    gap_s = 0.5;
    /// Drift of the hard iron allowed for in a gap, uT per square root of a second. Default 1.
    gap_offset_walk_ut = 1.0;
    /// Unevenness of the field that the covariance cannot know, per uT of slow difference between c and f.
    /// Small: over-confident in rooms. Large: cautious. Default 2.15, from the six undisturbed recordings.
    uneven_gain = 2.15;
    /// Gravity, m/s^2. Default 9.80665.
    gravity_m_s2 = 9.80665;
    /// Time constant with which `up` follows the accelerometer, s. Small: motion tilts it. Large: the gyroscope's errors do.
    /// Default 5.
    up_time_s = 5.0;
}
