// made by bindings/generate.sh from bindings/config.toml
//! The settings as members of C's struct, and what some of them choose from.

use crate::error::Failure;

/// How the hard and soft iron are estimated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Method {
    /// Gyroscope and gravity beside the magnetometer; works as `Adaptive` while there is no usable gyroscope.
    Auto = 0,
    /// The magnetometer alone: notices changes, and relearns them as fast as the samples allow.
    Adaptive = 1,
    /// The paper's: an ellipsoid fit over the latest samples, whose number follows sigma_T.
    Windowed = 2,
    /// The first step of the paper's method alone: one fit of the first well spread samples, kept from then on.
    Constant = 3,
}

/// The axis of the device whose heading is reported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Axis {
    /// Top edge of the screen, +y.
    TopEdge = 0,
    /// Back camera, -z.
    Camera = 1,
    /// The horizontal direction between top edge and camera: no flip when the phone passes upright.
    Auto = 2,
}

/// Settings. magcomp_config_default fills in the defaults; change what is to differ. As text, for magcomp_compensator_create, they have
/// these names; those of a heading are in {"heading": {}}, those of the paper's method in {"windowed": {}}. What differs, and what is there alone:
///
/// - method: One of "Auto", "Aided", "Adaptive", "Windowed", "Constant".
/// - initial: A calibration to begin with, from elsewhere; that of the last launch is for `adopt_kept`. Default none. {"soft_iron": [9 numbers], "hard_iron_ut": [3 numbers], "field_strength_ut": |h|}
/// - initial_sigma_ut: One standard deviation of each component of `initial`'s hard iron, microtesla, 0.01 to 1000. Default 2; larger makes the first headings less sure, and learning faster.
/// - heading.axis: One of "TopEdge", "Camera", "Auto".
/// - heading.screen_rotation: One of "Deg0", "Deg90", "Deg180", "Deg270".
/// - windowed.n_min: N_min, samples, 9 to N_max: the shortest window, and what sigma_T looks at. Default 100; smaller follows changes sooner with more noise.
/// - windowed.n_max: N_max, samples, at most 100 000: the longest window. Default 2000; larger is steadier under poor motion and slower to forget.
/// - windowed.sigma_th: sigma_th, dimensionless, 0 to 10: below it nothing is updated. Default 0.1.
/// - windowed.normalisation: How the standard deviations in sigma_T are normalised. Default `HalfRange`. One of "HalfRange", "EvenSphere".
/// - windowed.residual: The residual that fits square and sum. Default `Corrected`. `Algebraic` follows the paper as written: a window is fitted however far its samples lie from one ellipsoid. One of "Algebraic", "Corrected".
/// - windowed.noise_floor_ut: Least white noise, microtesla per axis, 0 to 1000, for which a fit is judged. Default 5; smaller accepts poorer coverage where the residual is small.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct Config {
    /// sizeof(magcomp_config).
    pub size: usize,
    /// A magcomp_method. How the hard and soft iron are estimated. Default MAGCOMP_METHOD_AUTO.
    pub method: i32,
    /// A magcomp_axis. The axis whose heading it is. Default MAGCOMP_AXIS_TOP_EDGE.
    pub axis: i32,
    /// How the screen's content is turned against the device. Default 0, not at all. One of 0, 90, 180, 270.
    pub screen_rotation_deg: i32,
    /// Largest component of a raw sample, microtesla, 1 to 100 000; a larger one is rejected. Default 2000; larger accepts stronger magnets.
    pub range_ut: f64,
    /// The magnetometer's full scale, microtesla (Android: `Sensor.getMaximumRange`). A component at or beyond it is rejected as saturated. 1 to 100 000. Default NaN: it is found once an axis has read the same extreme again and again in motion.
    pub rail_ut: f64,
    /// The field's strength, microtesla, 1 to 1000, where it is known (the geomagnetic model gives it): then the soft iron carries the sensor's scale. Every method listens to it. Default NaN: found by the method.
    pub field_strength_ut: f64,
    /// Declination, degrees, east positive, -180 to 180: gives `true_heading_deg`. Default NaN.
    pub declination_deg: f64,
    /// Standard deviation of `up` at rest, degrees, 0 to 90, for `heading_sigma_deg`; what motion adds to gravity comes on top. Default 0.5.
    pub tilt_sigma_deg: f64,
}

impl Default for Config {
    fn default() -> Self {
        let it = magcomp_core::Config::default();
        Self {
            size: size_of::<Self>(),
            method: Method::Auto as i32,
            axis: Axis::TopEdge as i32,
            screen_rotation_deg: 0,
            range_ut: it.range_ut,
            rail_ut: it.rail_ut.unwrap_or(f64::NAN),
            field_strength_ut: it.field_strength_ut.unwrap_or(f64::NAN),
            declination_deg: it.heading.declination_deg.unwrap_or(f64::NAN),
            tilt_sigma_deg: it.heading.tilt_sigma_deg,
        }
    }
}

/// `then!(lines, c, Config { its members })`.
#[cfg(test)]
macro_rules! members {
    ($then:ident, $lines:ident, $c:literal) => { $then!($lines, $c, Config { size, method, axis, screen_rotation_deg, range_ut, rail_ut, field_strength_ut, declination_deg, tilt_sigma_deg }) };
}
#[cfg(test)]
pub(crate) use members;

fn known(value: f64) -> Option<f64> {
    (!value.is_nan()).then_some(value)
}

// C may have all members of a group, or some
#[allow(clippy::needless_update)]
impl Config {
    pub(crate) fn core(&self) -> Result<magcomp_core::Config, Failure> {
        Ok(magcomp_core::Config {
            method: match self.method {
                it if it == Method::Auto as i32 => magcomp_core::Method::Auto,
                it if it == Method::Adaptive as i32 => magcomp_core::Method::Adaptive,
                it if it == Method::Windowed as i32 => magcomp_core::Method::Windowed,
                it if it == Method::Constant as i32 => magcomp_core::Method::Constant,
                it => return Err(Failure::config(format!("method is {it}, expected a magcomp_method"))),
            },
            range_ut: self.range_ut,
            rail_ut: known(self.rail_ut),
            field_strength_ut: known(self.field_strength_ut),
            heading: self.heading()?,
            ..magcomp_core::Config::default()
        })
    }

    pub(crate) fn heading(&self) -> Result<magcomp_core::HeadingConfig, Failure> {
        Ok(magcomp_core::HeadingConfig {
            axis: match self.axis {
                it if it == Axis::TopEdge as i32 => magcomp_core::ReferenceAxis::TopEdge,
                it if it == Axis::Camera as i32 => magcomp_core::ReferenceAxis::Camera,
                it if it == Axis::Auto as i32 => magcomp_core::ReferenceAxis::Auto,
                it => return Err(Failure::config(format!("axis is {it}, expected a magcomp_axis"))),
            },
            screen_rotation: match self.screen_rotation_deg {
                0 => magcomp_core::ScreenRotation::Deg0,
                90 => magcomp_core::ScreenRotation::Deg90,
                180 => magcomp_core::ScreenRotation::Deg180,
                270 => magcomp_core::ScreenRotation::Deg270,
                it => return Err(Failure::config(format!("screen_rotation_deg is {it}, expected 0, 90, 180 or 270"))),
            },
            declination_deg: known(self.declination_deg),
            tilt_sigma_deg: self.tilt_sigma_deg,
            ..magcomp_core::HeadingConfig::default()
        })
    }
}
