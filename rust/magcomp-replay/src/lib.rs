//! A recording through the compensator, row by row, and what it comes to: what a user of the command and the page in a browser (`web/`) have.
//!
//! Recordings and loggers' sessions come from the crate `magcomp-recordings`. `play` gives the rows to a compensator, `judge` finds how good it was,
//! `say` puts that into words, `draw` into pictures; `outcome` does all of it. `table`, `plot` and `report` show any results, the laboratory's too.
//! In a browser there are no verbs.

pub mod atomic;
pub mod beside;
#[cfg(not(target_family = "wasm"))]
pub mod command;
mod draw;
pub mod error;
mod judge;
mod outcome;
mod play;
pub mod plot;
#[cfg(not(target_family = "wasm"))]
pub mod progress;
pub mod report;
mod say;
pub mod statistics;
pub mod table;

pub use draw::{Figures, figures, offset_picture};
pub use judge::{
    AbsoluteHeading, Bearing, BearingTold, Bearings, Declared, DeviceChange, Disturbance, HeadingError, Judge,
    Judgement, Kinds, KnownHeading, LegJudgement, Legs, Mark, MarkTold, PlaceDiffered, TurnJudgement, Vectors,
    VectorsJudge, Waypoint, azimuth_deg, judge, off_deg, read_waypoints, reference_heading_deg, usual_part,
};
pub use outcome::{Gathering, Known, Outcome, session_table};
pub use play::{
    Courses, Ignore, Player, Step, calibration_json, replay, replay_with, write_calibration, write_explain_header,
    write_explanation, write_header, write_row,
};
pub use say::{Grade, Place, Played, Verdict, table, verdicts_table};
