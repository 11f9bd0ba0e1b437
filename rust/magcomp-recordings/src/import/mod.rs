//! Sessions that phone loggers recorded, made into recordings: each sensor keeps its own times and rates, nothing is resampled.
//!
//! The readers follow the loggers' documentation and were tried on files written by hand after it; that of Sensor Logger
//! also on an iPhone's real session. Parquet, Arrow and ROS 2 were tried on files that other people's writers made
//! (`tests/sessions/make.py`). No real file of the other loggers was at hand.

#[cfg(feature = "formats")]
mod arrow_lengths;
#[cfg_attr(not(feature = "formats"), path = "columnar_missing.rs")]
mod columnar;
mod dates;
mod document;
mod fix;
mod forms;
mod gnss_logger;
mod guard;
mod input;
mod ipin;
mod layout;
mod make;
mod matlab;
#[cfg(feature = "formats")]
mod mcap_records;
mod names;
mod open;
mod options;
mod order;
#[cfg(feature = "formats")]
mod parquet_lengths;
mod phyphox;
mod plain;
mod plausible;
#[cfg_attr(not(feature = "formats"), path = "ros_missing.rs")]
mod ros;
mod sensor_logger;
mod session;
mod sheet;
mod stream;
mod typed;
mod units;

pub use make::import;
pub use open::{Loaded, Opened, load, open, open_bytes};
pub use options::{ColumnNames, ImportOptions};
pub use session::{Sensor, Summary};
pub use units::{Frame, Frames, Shifts, Units};
