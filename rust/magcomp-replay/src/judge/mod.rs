//! How good a replay was, as far as a recording can tell.

mod absolute;
mod changes;
mod circle;
mod directions;
mod judgement;
mod known;
mod legs;
mod level;
mod rows;
mod told;
mod turns;
mod vectors;

pub use absolute::{AbsoluteHeading, reference_heading_deg};
pub use changes::{Declared, DeviceChange, PlaceDiffered};
pub(crate) use circle::Circle;
pub use circle::{HeadingError, off_deg};
pub use directions::{Kinds, azimuth_deg};
pub use judgement::{Disturbance, Judgement};
pub use known::KnownHeading;
pub use legs::{LegJudgement, Legs, Waypoint, read_waypoints};
pub use rows::{Judge, judge, usual_part};
pub use told::{Bearing, BearingTold, Bearings, Mark, MarkTold};
pub use turns::TurnJudgement;
pub use vectors::{Vectors, VectorsJudge};
