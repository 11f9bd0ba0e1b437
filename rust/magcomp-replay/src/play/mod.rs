//! The rows of a recording through a compensator, and what is written of them.

mod explain;
mod export;
mod output;
mod player;

pub use explain::{write_explain_header, write_explanation};
pub use export::{calibration_json, write_calibration};
pub use output::{write_header, write_row};
pub use player::{Courses, Ignore, Player, Step, replay, replay_with};
