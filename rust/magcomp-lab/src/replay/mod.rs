//! A recording through the compensator, row by row.

mod circle;
mod export;
mod figures;
mod judge;
mod legs;
mod marks;
mod output;
mod player;
mod sizes;
mod sphere;
mod sphere_view;
mod view;

pub use circle::HeadingError;
pub use export::write_calibration;
pub use figures::{Figures, figures};
pub use judge::{Declared, Disturbance, Judge, Judgement, Vectors, VectorsJudge, judge, usual_part};
pub use legs::{LegJudgement, Legs, Waypoint, read_waypoints};
pub use output::Output;
pub use player::{Ignore, Player, Step, replay, replay_with};
pub use view::table;
