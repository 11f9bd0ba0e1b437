//! What each choice of the estimators, and each mechanism, is worth: docs/dev/TUNING.md.

mod bench;
mod run;
mod score;
mod view;

pub use run::run;
pub use view::SensitivityOptions;
