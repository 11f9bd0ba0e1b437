//! The verbs that play, check and import recordings, and what every verb of `magcomp` shares.

mod check;
mod common;
mod import;
mod replay;

pub use check::Check;
pub use common::{
    Common, MethodChoice, NormalisationChoice, ResidualChoice, as_typed, between, finite, input, refuse_outputs, warn,
};
pub use import::Import;
pub use replay::Replay;
