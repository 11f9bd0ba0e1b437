//! A recording in memory, and its rows.

use magcomp::nalgebra::{UnitQuaternion, Vector3};
use std::path::{Path, PathBuf};

/// The values of the other sensors at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inertial {
    /// In whole nanoseconds.
    pub time_ns: i64,
    /// Gyroscope, rad/s.
    pub rate_rad_s: Option<Vector3<f64>>,
    /// Accelerometer, m/s^2, Android's sign.
    pub up_m_s2: Option<Vector3<f64>>,
    /// A heading from outside.
    pub course: Option<Course>,
}

/// A heading that something else than the magnetometer knew, from true north.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Course {
    /// Clockwise from true north.
    pub heading_deg: f64,
    /// One standard deviation.
    pub sigma_deg: f64,
}

/// A magnetometer sample, and the events of the other sensors since the sample before it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Row {
    /// Time as written, s.
    pub time_s: f64,
    /// The same in whole nanoseconds, strictly increasing.
    pub time_ns: i64,
    /// Raw field, uT, device frame; not finite where the file says `nan`.
    pub field_ut: Vector3<f64>,
    /// Events of the inertial sensors between the sample before and this one, in order; none where all sensors share their rows.
    pub before: Vec<Inertial>,
    /// Accelerometer at this very time, m/s^2, Android's sign.
    pub up_m_s2: Option<Vector3<f64>>,
    /// Gyroscope at this very time, rad/s.
    pub rate_rad_s: Option<Vector3<f64>>,
    /// The latest field that the operating system calibrated since the sample before, uT.
    pub system_ut: Option<Vector3<f64>>,
    /// Reference orientation, device to east-north-up; None where the file has none or says `nan`.
    pub attitude: Option<UnitQuaternion<f64>>,
    /// True hard iron, uT, where it is known.
    pub hard_iron_ut: Option<Vector3<f64>>,
    /// A heading from outside at this very time.
    pub course: Option<Course>,
}

impl Row {
    /// The events of the inertial sensors up to this row, in order.
    pub fn inertial(&self) -> impl Iterator<Item = Inertial> {
        let now =
            Inertial { time_ns: self.time_ns, rate_rad_s: self.rate_rad_s, up_m_s2: self.up_m_s2, course: self.course };
        self.before.iter().copied().chain([now])
    }

    /// The accelerometer's latest value since the sample before, m/s^2, Android's sign.
    pub fn latest_up(&self) -> Option<Vector3<f64>> {
        self.up_m_s2.or_else(|| self.before.iter().rev().find_map(|event| event.up_m_s2))
    }
}

/// How many rows a recording has, and over what time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Extent {
    /// Rows.
    pub rows: usize,
    /// Time of the first row, s.
    pub start_s: f64,
    /// The same in nanoseconds.
    pub start_ns: i64,
    /// Time of the last row, s.
    pub end_s: f64,
    /// Index of the first row with a reference orientation.
    pub first_reference: Option<usize>,
    /// Some row has the field that the operating system calibrated.
    pub system: bool,
}

impl Extent {
    /// Counts one more row.
    pub fn add(&mut self, row: &Row) {
        if self.rows == 0 {
            (self.start_s, self.start_ns) = (row.time_s, row.time_ns);
        }
        if row.attitude.is_some() {
            self.first_reference.get_or_insert(self.rows);
        }
        self.system |= row.system_ut.is_some();
        self.end_s = row.time_s;
        self.rows += 1;
    }

    /// First to last row, s.
    pub fn duration_s(&self) -> f64 {
        self.end_s - self.start_s
    }
}

/// A recording in memory.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// Where it came from.
    pub path: PathBuf,
    /// Its rows, in order.
    pub rows: Vec<Row>,
}

impl Recording {
    /// How many rows it has, and over what time.
    pub fn extent(&self) -> Extent {
        let mut extent = Extent::default();
        self.rows.iter().for_each(|row| extent.add(row));
        extent
    }

    /// File name, for tables.
    pub fn name(&self) -> String {
        name_of(&self.path)
    }
}

/// A file's name without its folder, for tables.
pub fn name_of(path: &Path) -> String {
    path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}
