//! The paper's method, whole: sigma_T, (12) to (15), in `uniformity`; the window (16) in `window`; fig. 3 in `windowed`; section III, a
//! constant external field, in `constant`. `config` has the paper's own numbers.

mod config;
mod constant;
mod uniformity;
mod window;
mod windowed;

pub use constant::ConstantField;
pub(crate) use uniformity::evenness;
pub use uniformity::uniformity;
pub use window::window_length;
pub(crate) use windowed::Windowed;
