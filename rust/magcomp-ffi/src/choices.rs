// made by bindings/generate.sh from bindings/config.toml
//! What a setting can be that is no number.

use crate::convert::same;

/// How the hard and soft iron are estimated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
pub enum Method {
    /// Gyroscope and gravity beside the magnetometer; works as `Adaptive` while there is no usable gyroscope.
    Auto,
    /// As `Auto` in far less memory: without a usable gyroscope it keeps its calibration, and learns nothing.
    Aided,
    /// The magnetometer alone: notices changes, and relearns them as fast as the samples allow.
    Adaptive,
    /// The paper's: an ellipsoid fit over the latest samples, whose number follows sigma_T.
    Windowed,
    /// The first step of the paper's method alone: one fit of the first well spread samples, kept from then on.
    Constant,
}

/// The axis of the device whose heading is reported.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
pub enum ReferenceAxis {
    /// Top edge of the screen, +y.
    TopEdge,
    /// Back camera, -z.
    Camera,
    /// The horizontal direction between top edge and camera: no flip when the phone passes upright.
    Auto,
}

/// How the screen's content is turned against the device's natural orientation, as Android's `Display.getRotation`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
pub enum ScreenRotation {
    /// Natural orientation: portrait on phones.
    Deg0,
    /// Landscape, the device turned counter-clockwise: the screen's top is the device's right edge.
    Deg90,
    /// Upside down.
    Deg180,
    /// The other landscape: the screen's top is the device's left edge.
    Deg270,
}

/// The residual that a fit squares and sums.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
pub enum Residual {
    /// Eq. (10) of the paper as written. Biased in scale by about 3 nu^2 (nu: noise over field strength), and in everything when the sphere is only partly covered.
    Algebraic,
    /// Divided by its own gradient: a distance in raw units, free of the noise bias.
    Corrected,
}

/// How the standard deviations in sigma_T, eq. (15), are normalised.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
pub enum Normalisation {
    /// By half the range of each axis, 180 and 90 degrees: even orientations give 0.723, and so N = 626 of 100 to 2000.
    HalfRange,
    /// By sqrt(2) times the standard deviation of evenly spread directions, which so give 1.
    EvenSphere,
}

same! {
    Method: Method { Auto, Aided, Adaptive, Windowed, Constant }
    ReferenceAxis: ReferenceAxis { TopEdge, Camera, Auto }
    ScreenRotation: ScreenRotation { Deg0, Deg90, Deg180, Deg270 }
    Residual: Residual { Algebraic, Corrected }
    Normalisation: Normalisation { HalfRange, EvenSphere }
}
