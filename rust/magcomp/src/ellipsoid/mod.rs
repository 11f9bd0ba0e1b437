//! The least-squares ellipsoid of eq. (9) and (10): moments, closed-form start, cost, report.

mod cost;
mod exact;
mod fit;
mod moments;
mod options;
mod report;
mod start;

pub use crate::math::descend::Termination;
pub(crate) use crate::status::FitError;
pub use fit::fit_ellipsoid;
pub use moments::Moments;
pub use options::{FitOptions, SMALLEST_SAMPLE_COUNT};
pub(crate) use report::mean_square_angle;
pub use report::{EllipsoidFit, direction_sigma_deg};
