//! Why the latest reading says what it says: a look inside the estimators, for development and support.

use crate::reading::HeadingAid;
use nalgebra::Vector3;

/// Format: hypotheses of an [`Explanation`], at most.
pub const EXPLAINED_HYPOTHESES: usize = 4;

/// The inside of a compensator after its latest sample that was not rejected; [`crate::Compensator::explain`] makes it. What an estimator does not
/// have is None, never NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub struct Explanation {
    /// The estimator whose calibration is in force. All below is of it, but for `outside`.
    pub estimator: Estimator,
    /// What it is doing.
    pub phase: EstimatorPhase,
    /// The adaptive estimator is tried beside the aided one: the gyroscope keeps breaking off before it has led to a calibration, or is contradicted.
    pub tries_both: bool,
    /// What became of the latest sample; of the adaptive estimator, of its latest complete group of neighbouring samples. None before the first.
    pub sample: Option<SampleUse>,
    /// The latest sample against what the filter expected of it. Aided estimator only, once it has a filter and while there is a rotation.
    pub innovation: Option<InnovationTest>,
    /// Low-passed share of gated samples, 0 to 1; also samples at rest and those that are `Compared` count. Above 0.2 the phase becomes
    /// `Undecided`. Aided estimator only, once it has a filter.
    pub gated_share: Option<f64>,
    /// How far the device was turned while the hypotheses were compared, degrees: below 29, or 14 on the way back to a former calibration, none
    /// wins. Aided estimator only, while `Undecided`.
    pub compared_turn_deg: Option<f64>,
    /// What may have changed last, the likeliest first. Aided estimator: two while `Undecided`, else none. Adaptive estimator: the likeliest of
    /// each change that competes. The paper's methods have none.
    pub hypotheses: [Option<ChangeHypothesis>; EXPLAINED_HYPOTHESES],
    /// Noise and errors of the sensors, as learned so far.
    pub noise: NoiseLevels,
    /// The latest heading from outside. None where none was used or ignored in the last two minutes.
    pub outside: Option<OutsideTest>,
}

/// A heading from outside against north as it was known.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub struct OutsideTest {
    /// What headings from outside are worth, as `Compensator::heading_aid` says.
    pub aid: HeadingAid,
    /// The heading less the expected one, degrees, in [-180, 180].
    pub off_deg: f64,
    /// Its expected size, degrees: one standard deviation. A heading that is off by more than three disagrees.
    pub expected_deg: f64,
    /// Standard deviation of north as headings from outside and the gyroscope have it now, degrees.
    pub north_sigma_deg: f64,
}

/// An estimator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub enum Estimator {
    /// With a gyroscope.
    Aided,
    /// The magnetometer alone.
    Adaptive,
    /// The paper's window, moving or constant.
    Windowed,
}

/// What an estimator is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub enum EstimatorPhase {
    /// No live sample has confirmed a calibration yet.
    Starting,
    /// It follows the samples.
    Running,
    /// Something changed, and it is not decided what.
    Undecided,
}

/// What became of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub enum SampleUse {
    /// The estimate was corrected by it.
    Used,
    /// It does not fit: the estimate was not corrected by it. Of the aided estimator also where the samples alone fit, but only with a field so
    /// uneven as no place has: the test ratio may be below 1 then.
    Gated,
    /// The hypotheses that compete were compared by it, and corrected; the filter was not.
    Compared,
    /// One of many samples that are fitted together, and not judged alone: the aided estimator's first fit, the adaptive one's first group,
    /// the paper's window.
    Pooled,
    /// Not judged: the device rests, or is where it was looked at for long enough. An innovation is told all the same, and counts in
    /// `gated_share`: a magnet may come to a device that rests.
    AtRest,
    /// Not judged: there is no rotation since the sample before.
    NoRotation,
    /// Nothing is learned any more (constant method), nothing could be computed of it, or the sensor is at its full scale.
    Unused,
}

/// A sample against what was expected of it.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub struct InnovationTest {
    /// Raw sample less the expected one, device axes, uT.
    pub innovation_ut: Vector3<f64>,
    /// Its expected size: one standard deviation per axis, uT. While it is `Compared` that of the filter as it was before the change.
    pub expected_ut: Vector3<f64>,
    /// Its normalised square v^T S^-1 v, which is 3 on average, over the gate, 16: a sample above 1 is gated.
    pub ratio: f64,
}

/// What may have changed last, and since when.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub struct ChangeHypothesis {
    /// What changed.
    pub kind: ChangeKind,
    /// Since when, nanoseconds: time of the first sample after the change; of the aided estimator that of the gated sample by which `gated_share` of
    /// the explanation passed 0.1, some 0.05 s after the first.
    pub onset_ns: i64,
    /// Natural logarithm of its odds against the likeliest: 0 for the likeliest itself, else below. Aided estimator: a hypothesis wins once the
    /// other is below -30 (samples count as if 100 came a second), it fits, and the device was turned. Adaptive estimator: joint
    /// probabilities, with what is believed of changes beforehand.
    pub log_odds: f64,
    /// Low-passed share of samples that do not fit it, 0 to 1: above 0.5 it has failed. Aided estimator only.
    pub gated_share: Option<f64>,
}

/// What a hypothesis says has changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub enum ChangeKind {
    /// Nothing was known before. Adaptive estimator only.
    FromNothing,
    /// Nothing but how the device points: a pause. Aided estimator only.
    Unchanged,
    /// Hard and soft iron.
    Device,
    /// Hard iron alone. Adaptive estimator only.
    HardIron,
    /// The device is back at a former calibration; of the adaptive estimator also at the one it began with.
    DeviceBack,
    /// The field of the place.
    Place,
}

/// Noise and errors of the sensors, as learned so far; what an estimator does not learn is None.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub struct NoiseLevels {
    /// White noise of the magnetometer: standard deviation per axis, uT; of the paper's window what its fit leaves.
    pub white_ut: Option<f64>,
    /// Unevenness of the field of the place, as far as it is correlated: standard deviation, per axis (aided) or of the field's strength
    /// (adaptive), uT.
    pub local_ut: Option<f64>,
    /// Random walk of the hard iron in motion, per axis, uT per root of a second.
    pub hard_iron_walk_ut: Option<f64>,
    /// How late the magnetometer is against the gyroscope, s.
    pub delay_s: Option<f64>,
    /// Its standard deviation, s.
    pub delay_sigma_s: Option<f64>,
    /// Bias of the gyroscope, device axes, rad/s.
    pub gyroscope_bias_rad_s: Option<Vector3<f64>>,
    /// Its standard deviation per axis, rad/s.
    pub gyroscope_bias_sigma_rad_s: Option<Vector3<f64>>,
}
