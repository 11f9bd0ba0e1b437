//! The paper's method, whole: sigma_T, (12) to (15), in `uniformity`; the window (16) and fig. 3 in `windowed`;
//! section III, a constant external field, in `constant`. The samples it looks at are kept by a clerk, who counts for all methods: `clerk`.

mod clerk;
mod config;
mod constant;
mod uniformity;
mod windowed;

pub(crate) use clerk::{Clerk, Noted};
pub use config::WindowedConfig;
pub use constant::ConstantField;
pub use uniformity::{Normalisation, uniformity};
pub(crate) use windowed::Windowed;
pub use windowed::window_length;
