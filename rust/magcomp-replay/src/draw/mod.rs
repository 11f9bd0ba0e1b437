//! A replay in pictures: over time, and as a sphere.

mod figures;
mod figures_view;
mod offset_view;
mod sphere;
mod sphere_view;
mod square;

pub use figures::{Figures, figures};
pub use offset_view::offset_picture;
