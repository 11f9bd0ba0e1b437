//! How files that are no logger's own are read.

use super::plain::ColumnNames;
use super::units::{Frame, Units};
use clap::Args;

/// How plain CSV, Parquet and Arrow are read; the loggers' own files need none of it.
#[derive(Clone, Debug, Default, PartialEq, Args)]
pub struct ImportOptions {
    /// Plain CSV, Parquet, Arrow: names of the columns, of t, mx,my,mz (field), ax,ay,az, gx,gy,gz, sx,sy,sz (the system's field), qw,qx,qy,qz
    #[arg(long, value_name = "t=NAME,mx=NAME,...")]
    pub columns: Option<ColumnNames>,
    /// Plain CSV, Parquet, Arrow, ROS: units of time (s, ms, us, ns), m field (uT, nT, mT, T, G, mG), g gyroscope (rad/s, deg/s), a accelerometer (m/s2, g; with a minus for Apple's sign)
    #[arg(long, value_name = "t=ns,m=uT,...")]
    pub units: Option<Units>,
    /// Which of the file's axes point right, up along the screen, and out of it
    #[arg(long, value_name = "x,y,z", allow_hyphen_values = true)]
    pub frame: Option<Frame>,
    /// ROS: topics to take, where several have the same sensor
    #[arg(long, value_name = "TOPIC,...", value_delimiter = ',')]
    pub topics: Vec<String>,
}
