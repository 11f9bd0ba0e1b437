//! What a session had, for the user.

use super::session::Sensor;
use crate::conventions::Conventions;
use crate::place::{Day, GeoPoint};
use crate::table::{Table, number};
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

impl Summary {
    /// As a table.
    #[must_use]
    pub fn table(&self) -> Table {
        let mut table =
            Table::new(&format!("{} session", self.logger), &["sensor", "events", "rate Hz", "longest pause s"]);
        for sensor in &self.sensors {
            let (rate, pause) = (number(sensor.rate_hz, 1), number(sensor.longest_pause_s, 3));
            table.row(vec![sensor.sensor.to_owned(), sensor.events.to_string(), rate, pause]);
        }
        self.notes.iter().for_each(|note| table.note(note));
        table
    }
}
