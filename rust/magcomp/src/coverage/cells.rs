//! When each direction of the sphere was last seen: 48 cells of equal area.

use crate::math::elementary::{cos, sin};
use alloc::vec::Vec;
use arrayvec::ArrayVec;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::Vector3;

/// Mathematics: cells on the whole sphere, the sum of those of the bands, each about 30 degrees across.
pub const CELLS: usize = 48;

/// Mathematics: bands of latitude, north to south, cut so that every cell has the area 4 pi / 48: the first cell of each, and how many it has.
const BANDS: [(usize, usize); 6] = [(0, 4), (4, 8), (12, 12), (24, 12), (36, 8), (44, 4)];

/// Mathematics: tangents of 30, 45 and 60 degrees, at which a quarter of two or of three cells is cut.
const CUTS: [&[f64]; 3] = [&[], &[1.0], &[0.577_350_269_189_625_8, 1.732_050_807_568_877_2]];

/// Which of the latest samples was seen in each cell.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Coverage {
    /// Number of the sample that was last seen in each cell, the first is 1; 0: none was.
    last_seen: ArrayVec<u64, CELLS>,
    /// Number of the latest sample.
    latest: u64,
    /// So many of the latest samples count.
    window: u64,
    /// How many cells were seen by a sample after `before`, the latest that counts no longer; none of them leaves before the sample `oldest` does.
    seen: usize,
    before: u64,
    oldest: u64,
}

impl Default for Coverage {
    /// Nothing was seen, and every sample will count.
    fn default() -> Self {
        Self { last_seen: [0; CELLS].into(), latest: 0, window: u64::MAX, seen: 0, before: 0, oldest: u64::MAX }
    }
}

impl Coverage {
    /// The cell of a direction, 0 to 47. Any length will do but 0, which counts as straight down.
    #[must_use]
    pub fn cell(direction: &Vector3<f64>) -> usize {
        let (length, [x, y, z]) = (direction.norm(), direction.data.0[0]);
        let is_above =
            |(first, cells): &(usize, usize)| z > length * (1.0 - 2.0 * (first + cells) as f64 / CELLS as f64);
        let (first, cells) = BANDS.into_iter().find(is_above).unwrap_or(BANDS[5]);
        // quarters from the west on, anticlockwise: along where each begins, and across
        let (quarter, along, across) = match (x < 0.0, y < 0.0) {
            (true, true) => (0, -x, -y),
            (false, true) => (1, -y, x),
            (false, false) => (2, x, y),
            (true, false) => (3, y, -x),
        };
        let cuts = CUTS[cells / 4 - 1].iter().filter(|tangent| across > along * *tangent).count();
        first + quarter * (cells / 4) + cuts
    }

    /// Unit vector to the middle of a cell.
    pub(super) fn middle(cell: usize) -> Vector3<f64> {
        let (first, cells) = BANDS.into_iter().find(|(first, cells)| cell < first + cells).unwrap_or(BANDS[5]);
        let z = 1.0 - (2 * first + cells) as f64 / CELLS as f64;
        let phi = ((cell - first) as f64 + 0.5) / cells as f64 * core::f64::consts::TAU - core::f64::consts::PI;
        let flat = (1.0 - z * z).sqrt();
        Vector3::new(flat * cos(phi), flat * sin(phi), z)
    }

    /// The next sample, whose direction (any length) may not be known.
    pub(crate) fn see(&mut self, direction: Option<&Vector3<f64>>) {
        self.latest += 1;
        if let Some(direction) = direction {
            let last_seen = core::mem::replace(&mut self.last_seen[Self::cell(direction)], self.latest);
            self.seen += usize::from(last_seen <= self.before);
            self.oldest = self.oldest.min(self.latest);
        }
        self.count();
    }

    /// From now on only so many of the latest samples count.
    pub(crate) fn count_latest(&mut self, samples: usize) {
        self.window = samples as u64;
        self.count();
    }

    /// Counts the cells anew where one may have left, or come back.
    fn count(&mut self) {
        let before = self.latest.saturating_sub(self.window);
        if before >= self.oldest || before < self.before {
            let seen = self.last_seen.iter().filter(|seen| **seen > before);
            (self.seen, self.oldest) = seen.fold((0, u64::MAX), |(count, oldest), seen| (count + 1, oldest.min(*seen)));
        }
        self.before = before;
    }

    fn is_seen(&self, cell: usize) -> bool {
        self.last_seen[cell] > self.before
    }

    /// Share of the cells with at least one sample, 0 to 1.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.seen as f64 / CELLS as f64
    }

    /// Middles of the cells without a sample, unit vectors in the device frame: point the field there next.
    #[must_use]
    pub fn unseen_directions(&self) -> Vec<Vector3<f64>> {
        (0..CELLS).filter(|cell| !self.is_seen(*cell)).map(Self::middle).collect()
    }
}
