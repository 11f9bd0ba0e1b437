//! What is found of a recording's sensors, and the events that it is found in.

use super::tested::Tested;
use magcomp::nalgebra::{UnitQuaternion, Vector3};
use serde::Serialize;

/// How much a finding says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Weight {
    /// Worth knowing.
    Note,
    /// The result may be worse than it need be.
    Doubt,
    /// The result is wrong.
    Fault,
}

/// Takes a finding: its kind, how much it says, and the sentence.
pub(super) type Add<'a> = dyn FnMut(&'static str, Weight, String) + 'a;

/// One thing that was found, in a sentence with the option that mends it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// Its kind: gyroscope_unit, field_axes and so on.
    pub kind: &'static str,
    /// How much it says.
    pub weight: Weight,
    /// The sentence.
    pub text: String,
}

/// What was found, and what it was found by.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Conventions {
    /// What was found; nothing where nothing is amiss.
    pub findings: Vec<Finding>,
    /// What was tested, and what could not be.
    pub tested: Vec<Tested>,
    /// Size of the field about the centre that the gyroscope tells, uT.
    pub radius_ut: Option<f64>,
    /// The field's angle below the horizon about that centre, degrees.
    pub dip_deg: Option<f64>,
    /// How late the field is behind the gyroscope, s.
    pub field_delay_s: Option<f64>,
}

/// The events of a recording's sensors, time in ns: uT, m/s^2, rad/s, device to east-north-up.
#[derive(Clone, Copy, Debug)]
pub struct Streams<'a> {
    /// The raw field.
    pub field: &'a [(i64, Vector3<f64>)],
    /// The accelerometer.
    pub up: &'a [(i64, Vector3<f64>)],
    /// The gyroscope.
    pub rate: &'a [(i64, Vector3<f64>)],
    /// A reference orientation.
    pub attitude: &'a [(i64, UnitQuaternion<f64>)],
}
