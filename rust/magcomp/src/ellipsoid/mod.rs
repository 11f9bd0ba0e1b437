//! The least-squares ellipsoid of eq. (9) and (10): moments, closed-form start, iteration, report.

mod fit;
pub(crate) mod ldl;
mod moments;
mod report;
mod start;

pub use fit::{FitError, FitOptions, Residual, SMALLEST_SAMPLE_COUNT, Termination, fit_ellipsoid};
pub(crate) use moments::ExactSum;
pub use moments::Moments;
pub use report::{EllipsoidFit, direction_sigma_deg};
