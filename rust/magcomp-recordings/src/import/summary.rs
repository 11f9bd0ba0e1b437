//! What a session had, for the user.

use super::session::Sensor;
use crate::conventions::Conventions;
use crate::place::{Day, GeoPoint};
use serde::Serialize;

/// The content of a session.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// The logger, or plain CSV.
    pub logger: &'static str,
    /// Its sensors.
    pub sensors: Vec<Sensor>,
    /// Notes for the user.
    pub notes: Vec<String>,
    /// Parts that were left out, or may be wrong.
    pub warnings: Vec<String>,
    /// Whether units, signs, axes and clocks are what they are taken for.
    pub conventions: Conventions,
    /// The day of the first event (UTC), where the session says so.
    #[serde(skip)]
    pub day: Option<Day>,
    /// Where it was recorded, where the session says so.
    #[serde(skip)]
    pub position: Option<GeoPoint>,
}
