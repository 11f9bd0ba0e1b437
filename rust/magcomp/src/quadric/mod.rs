//! The least-squares ellipsoid of eq. (9) and (10): moments, closed-form start, iteration, report.

mod exact;
mod fit;
mod iteration;
pub(crate) mod ldl;
mod moments;
mod options;
mod report;
mod start;
pub(crate) mod symmetric;

pub(crate) use exact::ExactSums;
pub use fit::fit_ellipsoid;
pub use iteration::Termination;
pub use moments::Moments;
pub use options::{FitError, FitOptions, Residual, SMALLEST_SAMPLE_COUNT};
pub(crate) use report::mean_square_angle;
pub use report::{EllipsoidFit, direction_sigma_deg};
