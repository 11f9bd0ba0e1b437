//! The 24 ways in which a frame lies along another, their mirrors, and units of the gyroscope: which of them explains a vector's turn.
//! A vector that points the other way turns alike, so its own mirror is told from a turn by the dip alone. A mirror of the rates is another
//! matter: no change of the vector's axes explains it.

use super::windows::{Fit, Window, fit, unexplained};
use magcomp::nalgebra::Matrix3;

/// Fewer windows tell nothing.
const FEWEST: usize = 16;
/// The rates' units that are tried, of rad/s, and the option that says so.
const UNITS: [(f64, &str); 2] = [(1.0, "rad/s"), (std::f64::consts::PI / 180.0, "deg/s")];

/// How a vector's turn fits the gyroscope.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fits {
    /// What is left over of the vector's changes, as a share: as they are, and the best way.
    pub as_is: f64,
    pub best: f64,
    /// The change of the gyroscope's axes that fits best; the identity is none.
    pub axes: Matrix3<f64>,
    /// The unit of the rates that fits best.
    pub unit: &'static str,
    pub fit: Fit,
    /// Each half of the windows says so.
    pub is_steady: bool,
}

impl Fits {
    /// Of a vector that has a constant part, or none; none where there is too little to see.
    pub fn of(windows: &[Window], has_offset: bool) -> Option<Self> {
        if windows.len() < FEWEST {
            return None;
        }
        let zero = unexplained(windows);
        if zero <= 0.0 {
            return None;
        }
        let as_is = fit(windows, &Matrix3::identity(), has_offset);
        let (mut best, mut axes, mut unit) = (as_is, Matrix3::identity(), UNITS[0]);
        for candidate in UNITS {
            for turn in turns() {
                let found = fit(windows, &(turn * candidate.0), has_offset);
                // a tie is none: a turn about one axis alone fits several ways
                if found.left < 0.98 * best.left {
                    (best, axes, unit) = (found, turn, candidate);
                }
            }
        }
        let halves = windows.split_at(windows.len() / 2);
        let gain = |part: &[Window]| {
            let [better, before] = [axes * unit.0, Matrix3::identity()].map(|rates| fit(part, &rates, has_offset).left);
            better < 0.85 * before
        };
        let is_steady = gain(halves.0) && gain(halves.1);
        let (as_is, left) = (as_is.left / zero, best.left / zero);
        Some(Self { as_is, best: left, axes, unit: unit.1, fit: best, is_steady })
    }

    /// Whether the vector turns with the gyroscope as it should.
    pub fn agrees(&self) -> bool {
        self.as_is < 0.7 && !self.differs()
    }

    /// Whether another way fits, and clearly better.
    pub fn differs(&self) -> bool {
        self.is_steady && self.best < 0.7 && self.best < 0.7 * self.as_is
    }

    /// Whether the best way mirrors the rates: the gyroscope's axes are wrong then, and none of the vector's.
    pub fn is_mirror(&self) -> bool {
        self.axes.determinant() < 0.0
    }

    /// Whether the axes of the best way are others.
    pub fn is_turned(&self) -> bool {
        self.axes != Matrix3::identity()
    }
}

/// All frames along the axes, the right-handed ones first.
fn turns() -> Vec<Matrix3<f64>> {
    let mut found = Vec::new();
    for order in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
        for signs in 0..8 {
            let mut turn = Matrix3::zeros();
            for (row, column) in order.into_iter().enumerate() {
                turn[(row, column)] = if signs >> row & 1 == 0 { 1.0 } else { -1.0 };
            }
            found.push(turn);
        }
    }
    found.sort_by(|a: &Matrix3<f64>, b| b.determinant().total_cmp(&a.determinant()));
    found
}

/// Axes as one types them: `y,-x,z`.
pub(super) fn typed(axes: &Matrix3<f64>) -> String {
    let axis = |row: usize| {
        let column = (0..3).find(|column| axes[(row, *column)] != 0.0).unwrap_or(row);
        format!("{}{}", if axes[(row, column)] < 0.0 { "-" } else { "" }, ["x", "y", "z"][column])
    };
    [axis(0), axis(1), axis(2)].join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_24_right_handed_frames_and_their_mirrors() {
        let turns = turns();
        assert_eq!(turns.len(), 48);
        assert!(
            turns
                .iter()
                .enumerate()
                .all(|(k, turn)| !turns[..k].contains(turn) && (turn.determinant() > 0.5) == (k < 24))
        );
        assert_eq!(typed(&Matrix3::new(0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0)), "y,-x,z");
    }
}
