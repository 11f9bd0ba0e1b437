use nalgebra::Vector3;

use super::{FrameStep, ProcessNoise};

impl FrameStep {
    /// A frame of `dt_s` of which all else is zero.
    pub(crate) fn of_nothing(dt_s: f64) -> Self {
        const NOTHING: Vector3<f64> = Vector3::new(0.0, 0.0, 0.0);
        Self {
            time_ns: 0,
            raw_ut: NOTHING,
            is_blank: false,
            rate_rad_s: NOTHING,
            delayed_rad_s: NOTHING,
            increment_rad: NOTHING,
            angle_rad: 0.0,
            dt_s,
            noise: ProcessNoise { bridged_rad2: 0.0, offset_ut: 0.0, local_ut: 0.0, local_time_s: 1.0 },
            sigma_ut: 0.5,
            late_s: 0.0,
            resting: false,
            bias_variance: None,
            motion: 1.0,
        }
    }
}
