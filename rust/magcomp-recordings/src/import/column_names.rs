//! Names of a table's columns, as options give them.

use super::layout;
use std::str::FromStr;

/// The quantities of columns, and their names in a recording.
const QUANTITIES: [(&str, &str); 17] = [
    ("t", "t_s"),
    ("mx", "mx"),
    ("my", "my"),
    ("mz", "mz"),
    ("ax", "ax"),
    ("ay", "ay"),
    ("az", "az"),
    ("gx", "gx"),
    ("gy", "gy"),
    ("gz", "gz"),
    ("sx", "sys_mx"),
    ("sy", "sys_my"),
    ("sz", "sys_mz"),
    ("qw", "qw"),
    ("qx", "qx"),
    ("qy", "qy"),
    ("qz", "qz"),
];

/// Names of a file's columns, in the order of `QUANTITIES`.
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnNames {
    pub(super) names: Vec<String>,
    /// Those that were given.
    given: Vec<usize>,
}

impl Default for ColumnNames {
    fn default() -> Self {
        Self { names: QUANTITIES.iter().map(|(_, name)| (*name).to_owned()).collect(), given: Vec::new() }
    }
}

impl FromStr for ColumnNames {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut names = Self::default();
        for part in text.split(',') {
            let (what, name) = part.split_once('=').ok_or("expected such as t=time_ns,mx=mag_x,my=mag_y,mz=mag_z")?;
            let index = QUANTITIES.iter().position(|(known, _)| *known == what.trim());
            let known = || QUANTITIES.map(|(known, _)| known).join(", ");
            let index = index.ok_or_else(|| format!("'{what}' is none of {}", known()))?;
            names.names[index] = name.trim().to_owned();
            names.given.push(index);
        }
        Ok(names)
    }
}

impl ColumnNames {
    /// Whether all of the columns that were given are numbers.
    pub(super) fn are_numbers(&self) -> bool {
        !self.given.is_empty() && layout::are_numbers(self.given.iter().map(|index| self.names[*index].as_str()))
    }
}
