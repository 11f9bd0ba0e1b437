//! The 24 ways in which a frame lies along another, their mirrors, and units of the gyroscope: which of them explains a vector's turn.
//! A vector that points the other way turns alike, so its own mirror is told from a turn by the dip alone. A mirror of the rates is another
//! matter: no change of the vector's axes explains it.

use super::windows::{Fit, Window, fit, unexplained};
use magcomp::nalgebra::{Matrix3, Rotation3, Vector3};

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
    /// What is left over by the best of all other axes: a turn about one axis alone fits several ways.
    rival: f64,
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
        let mut rival = f64::INFINITY;
        for candidate in UNITS {
            for turn in turns() {
                let found = fit(windows, &(turn * candidate.0), has_offset);
                if candidate.0 == 1.0 && turn != Matrix3::identity() {
                    rival = rival.min(found.left);
                }
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
        let (as_is, left, rival) = (as_is.left / zero, best.left / zero, rival / zero);
        Some(Self { as_is, best: left, axes, unit: unit.1, fit: best, is_steady, rival })
    }

    /// Whether the vector turns with the gyroscope as it should.
    pub fn agrees(&self) -> bool {
        self.as_is < 0.7 && !self.differs()
    }

    /// Whether it does, and would in no other way.
    pub fn is_proven(&self) -> bool {
        self.agrees() && self.as_is < 0.7 * self.rival
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

/// Parts of a recording by each of which a turn about the screen's normal is told.
const PARTS: usize = 6;
/// How sharply a part has to tell it, 15 degrees beside, and all parts together.
const BESIDE_DEG: f64 = 15.0;
const LEAST_SHARPNESS: f64 = 0.02;
const LEAST_WEIGHT: f64 = 0.1;
/// The uncertainty of one part at least, degrees.
const PART_DEG: f64 = 1.0;
/// Turns that are tried, and their step, degrees.
const MOST_ASKEW_DEG: f64 = 45.0;
const ASKEW_STEP_DEG: f64 = 3.0;
/// Phones are askew by up to 5 degrees; a turn is told from this one on, and where it is this many times its uncertainty.
const LEAST_ASKEW_DEG: f64 = 7.0;
const CERTAIN: f64 = 4.0;
/// The uncertainty up to which the turn is told, degrees.
const KNOWN_DEG: f64 = 2.5;

/// A turn of the magnetometer about the screen's normal, against the gyroscope, by the parts of a recording.
#[derive(Clone, Copy, Debug)]
pub(super) struct Askew {
    deg: f64,
    sigma_deg: f64,
}

impl Askew {
    /// None where no part of the recording tells it.
    pub fn of(windows: &[Window]) -> Option<Self> {
        let parts: Vec<(f64, f64)> = (windows.chunks(windows.len().div_ceil(PARTS).max(1)))
            .filter(|part| part.len() >= FEWEST)
            .filter_map(askew_deg)
            .collect();
        let weight: f64 = parts.iter().map(|part| part.1).sum();
        if weight < LEAST_WEIGHT {
            return None;
        }
        let deg = parts.iter().map(|(deg, weight)| deg * weight).sum::<f64>() / weight;
        let square = parts.iter().map(|(part, weight)| (part - deg).powi(2) * weight).sum::<f64>() / weight;
        let count = weight * weight / parts.iter().map(|part| part.1.powi(2)).sum::<f64>();
        // one part alone does not show how far parts differ
        let fair = if count >= 2.0 { count / (count - 1.0) } else { 1.0 };
        Some(Self { deg, sigma_deg: ((square * fair + PART_DEG * PART_DEG) / count).sqrt() })
    }

    /// The turn, where it is large and certain, degrees anticlockwise seen from the front.
    pub fn proven_deg(&self) -> Option<f64> {
        (self.is_known() && self.deg.abs() > LEAST_ASKEW_DEG.max(CERTAIN * self.sigma_deg)).then_some(self.deg)
    }

    /// Whether the recording tells the turn.
    pub fn is_known(&self) -> bool {
        self.sigma_deg < KNOWN_DEG
    }

    /// Whether it is turned by no more than phones are. What is more, and not certain, is neither proven nor sound.
    pub fn is_sound(&self) -> bool {
        self.is_known() && self.deg.abs() <= LEAST_ASKEW_DEG
    }

    /// How far it may be turned, degrees.
    pub fn within_deg(&self) -> f64 {
        self.deg.abs() + 2.0 * self.sigma_deg
    }
}

/// The turn about the screen's normal that leaves least over, degrees, and how sharply: what is left over 15 degrees beside it, less 1. None
/// where it is not told.
fn askew_deg(windows: &[Window]) -> Option<(f64, f64)> {
    let left = |deg: f64| {
        let turned = Rotation3::from_axis_angle(&Vector3::z_axis(), deg.to_radians());
        fit(windows, turned.matrix(), true).left
    };
    let steps = (MOST_ASKEW_DEG / ASKEW_STEP_DEG) as i32;
    let tried: Vec<(f64, f64)> =
        (-steps..=steps).map(|step| f64::from(step) * ASKEW_STEP_DEG).map(|deg| (deg, left(deg))).collect();
    let k = (0..tried.len()).min_by(|a, b| tried[*a].1.total_cmp(&tried[*b].1))?;
    // the lowest point of the parabola through three
    let ((_, before), (deg, at), (_, after)) = (*tried.get(k.checked_sub(1)?)?, tried[k], *tried.get(k + 1)?);
    let bend = before - 2.0 * at + after;
    let deg = deg + if bend > 0.0 { ASKEW_STEP_DEG * (before - after) / bend / 2.0 } else { 0.0 };
    let sharpness = (left(deg - BESIDE_DEG).min(left(deg + BESIDE_DEG)) / at - 1.0).min(1.0);
    (sharpness > LEAST_SHARPNESS).then_some((deg, sharpness))
}

/// All frames along the axes, the right-handed ones first.
pub(super) fn turns() -> Vec<Matrix3<f64>> {
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
