//! Recordings: CSV or gzipped CSV with a header, columns found by name.
//!
//! `t_s,mx,my,mz[,ax,ay,az][,gx,gy,gz][,qw,qx,qy,qz]`: seconds; uT; m/s^2; rad/s; reference orientation. A simulated one
//! adds `true_bx,true_by,true_bz`, the true hard iron (uT); `sys_mx,sys_my,sys_mz` is the field that the operating system
//! calibrated (uT). A row may leave all cells of a sensor empty: each sensor then has its own times and rate.

mod columns;
mod content;
mod events;
mod read;
mod record;
mod rows;
mod source;
mod write;

pub(crate) use columns::Line;
pub use content::{Content, files_of};
pub use events::Events;
pub use read::Rows;
pub(crate) use read::Text;
pub(crate) use record::{Delimiter, Record};
pub use rows::{Course, Extent, Inertial, Recording, Row, name_of};
pub(crate) use source::{GZIP, text};
pub use source::{Source, read, read_from, unzipped};
pub use write::write_recording;
