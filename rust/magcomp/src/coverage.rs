//! Which directions of the sphere have been seen: 48 cells of equal area, for guidance while calibrating.

#[cfg(test)]
mod tests;

use nalgebra::{SVector, Vector3};

/// Cells in each band of latitude, north to south. Bands are cut so that every cell has the area 4 pi / 48.
const BANDS: [usize; 6] = [4, 8, 12, 12, 8, 4];
/// Cells on the whole sphere, each about 30 degrees across.
pub const CELLS: usize = 48;

/// The first cell of each band, and how many it has.
fn bands() -> impl Iterator<Item = (usize, usize)> {
    (0..BANDS.len()).map(|band| (BANDS[..band].iter().sum(), BANDS[band]))
}

/// Counts of samples per cell.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Coverage {
    counts: SVector<u32, CELLS>,
}

impl Default for Coverage {
    fn default() -> Self {
        Self { counts: SVector::zeros() }
    }
}

impl Coverage {
    /// The cell of a direction (any length), 0 to 47.
    #[must_use]
    pub fn cell(direction: &Vector3<f64>) -> usize {
        let length = direction.norm();
        let z = if length > 0.0 { direction.z / length } else { 1.0 };
        let turn = direction.y.atan2(direction.x) / std::f64::consts::TAU + 0.5;
        let is_above = |last: usize| z > 1.0 - 2.0 * last as f64 / CELLS as f64;
        let (first, cells) = bands().find(|(first, cells)| is_above(first + cells)).unwrap_or((CELLS - 4, 4));
        first + ((turn * cells as f64) as usize).min(cells - 1)
    }

    /// Unit vector to the middle of a cell.
    fn middle(cell: usize) -> Vector3<f64> {
        let (first, cells) = bands().find(|(first, cells)| cell < first + cells).unwrap_or((CELLS - 4, 4));
        let z = 1.0 - (2 * first + cells) as f64 / CELLS as f64;
        let phi = ((cell - first) as f64 + 0.5) / cells as f64 * std::f64::consts::TAU - std::f64::consts::PI;
        let flat = (1.0 - z * z).sqrt();
        Vector3::new(flat * phi.cos(), flat * phi.sin(), z)
    }

    /// So many samples more in a cell, or fewer; in none, nothing changes.
    pub(crate) fn add(&mut self, cell: Option<u8>, samples: i32) {
        if let Some(count) = cell.and_then(|cell| self.counts.get_mut(usize::from(cell))) {
            *count = count.saturating_add_signed(samples);
        }
    }

    /// Share of the cells with at least one sample, 0 to 1.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.counts.iter().filter(|count| **count > 0).count() as f64 / CELLS as f64
    }

    /// Middles of the cells without a sample, unit vectors in the device frame: point the field there next.
    #[must_use]
    pub fn unseen_directions(&self) -> Vec<Vector3<f64>> {
        (0..CELLS).filter(|cell| self.counts[*cell] == 0).map(Self::middle).collect()
    }
}
