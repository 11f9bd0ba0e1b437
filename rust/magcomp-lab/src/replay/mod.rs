//! A recording through the compensator, row by row.

mod changes;
mod circle;
mod explain;
mod export;
mod figures;
mod judge;
mod kinds;
mod legs;
mod level;
mod marks;
mod output;
mod player;
mod sizes;
mod sphere;
mod sphere_view;
mod turns;
mod view;

pub use changes::{DeviceChange, PlaceDiffered};
pub use circle::HeadingError;
pub use explain::ExplainOutput;
pub use export::write_calibration;
pub use figures::{Figures, figures};
pub use judge::{Declared, Disturbance, Judge, Judgement, MeanSpread, Vectors, VectorsJudge, judge, usual_part};
pub use kinds::Kinds;
pub use legs::{LegJudgement, Legs, Waypoint, read_waypoints};
pub use output::Output;
pub use player::{Ignore, Player, Step, replay, replay_with};
pub use turns::TurnJudgement;
pub use view::table;
