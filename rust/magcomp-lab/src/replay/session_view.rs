//! What a session had, for the user.

use crate::table::{Table, number};
use magcomp_recordings::import::Summary;

/// The content of a session as a table.
pub fn session_table(summary: &Summary) -> Table {
    let mut table =
        Table::new(&format!("{} session", summary.logger), &["sensor", "events", "rate Hz", "longest pause s"]);
    for sensor in &summary.sensors {
        let (rate, pause) = (number(sensor.rate_hz, 1), number(sensor.longest_pause_s, 3));
        table.row(vec![sensor.sensor.to_owned(), sensor.events.to_string(), rate, pause]);
    }
    summary.notes.iter().for_each(|note| table.note(note));
    table
}
