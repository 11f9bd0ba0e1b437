//! A replay in words: its verdict, its sentences, its table.

mod sentences;
mod verdict;
mod view;

pub use verdict::{Grade, Place, Played, Verdict, verdicts_table};
pub use view::table;
