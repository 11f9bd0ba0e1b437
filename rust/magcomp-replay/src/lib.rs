//! A recording through the compensator, row by row.

mod absolute;
mod changes;
mod circle;
mod directions;
mod explain;
mod export;
mod figures;
mod figures_view;
mod judge;
mod judgement;
mod known;
mod legs;
mod level;
mod offset_view;
mod outcome;
mod output;
mod player;
mod sentences;
mod sphere;
mod sphere_view;
mod square;
mod told;
mod turns;
mod vectors;
mod verdict;
mod view;

pub use absolute::AbsoluteHeading;
#[cfg(not(target_family = "wasm"))]
pub(crate) use absolute::reference_heading_deg;
pub use changes::{Declared, DeviceChange, PlaceDiffered};
pub use circle::HeadingError;
#[cfg(not(target_family = "wasm"))]
pub(crate) use circle::off_deg;
pub use directions::Kinds;
#[cfg(not(target_family = "wasm"))]
pub(crate) use directions::azimuth_deg;
pub use explain::{write_explain_header, write_explanation};
pub use export::{calibration_json, write_calibration};
pub use figures::{Figures, figures};
pub use judge::{Judge, judge, usual_part};
pub use judgement::{Disturbance, Judgement};
pub use known::KnownHeading;
pub use legs::{LegJudgement, Legs, Waypoint, read_waypoints};
pub use offset_view::offset_picture;
pub use outcome::{Gathering, Known, Outcome, session_table};
pub use output::{write_header, write_row};
pub use player::{Courses, Ignore, Player, Step, replay, replay_with};
pub use told::{Bearing, BearingTold, Bearings, Mark, MarkTold};
pub use turns::TurnJudgement;
pub use vectors::{Vectors, VectorsJudge};
pub use verdict::{Grade, Place, Played, Verdict, verdicts_table};
pub use view::table;
