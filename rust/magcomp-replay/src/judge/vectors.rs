//! A method's vectors on a recording, judged row by row.

use super::circle::{Circle, HeadingError, off_deg};
use super::directions::{Directions, azimuth_deg};
use super::rows::usual_part;
use crate::statistics::{MeanSpread, Spread};
use magcomp::nalgebra::Vector3;
use magcomp_recordings::recording::{Extent, Row};
use serde::Serialize;

/// Length of a span of the heading's course, s, and the most spans of one.
const SPAN_S: f64 = 1.0;
const MOST_SPANS: f64 = 2000.0;

/// The figures of a method's vectors on a recording, without the first seconds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Vectors {
    /// Share of the rows with a vector, 0 to 1.
    pub answered: f64,
    /// Total field, uT; none of a method that gives an attitude alone.
    pub total_field_ut: Option<MeanSpread>,
    /// Heading error; none without a reference.
    pub heading: Option<HeadingError>,
}

/// Judges the vectors of a method row by row, in memory that does not grow with them.
#[derive(Clone, Debug)]
pub struct VectorsJudge {
    extent: Extent,
    rows: usize,
    answered: usize,
    live: Directions,
    every: Circle,
    span_s: f64,
    /// For every span the first azimuth in it, degrees, and the differences of its others from that one.
    spans: Vec<Option<(f64, Spread)>>,
}

impl VectorsJudge {
    /// For a recording of this extent.
    pub fn new(extent: &Extent) -> Self {
        let span_s = (extent.duration_s() / MOST_SPANS).max(SPAN_S);
        let spans = vec![None; (extent.duration_s() / span_s) as usize + 1];
        let (live, every) = (Directions::default(), Circle::default());
        Self { extent: *extent, rows: 0, answered: 0, live, every, span_s, spans }
    }

    /// The next row, and the vector where the method has one.
    pub fn add(&mut self, row: &Row, vector: Option<&Vector3<f64>>) {
        self.rows += 1;
        let Some(vector) = vector else { return };
        self.answered += 1;
        let after_s = row.time_s - self.extent.start_s;
        if after_s > usual_part(&self.extent).start {
            self.live.add(row, vector, None, true);
        }
        if let Some(azimuth_deg) = azimuth_deg(row, vector) {
            self.every.add(azimuth_deg, None, true);
            if let Some(span) = self.spans.get_mut((after_s / self.span_s) as usize) {
                let (first_deg, others) = span.get_or_insert((azimuth_deg, Spread::default()));
                others.add(off_deg(azimuth_deg, *first_deg));
            }
        }
    }

    /// The figures; `north_deg`: how far magnetic north is east of the reference's, degrees.
    pub fn vectors(&self, north_deg: f64) -> Vectors {
        Vectors {
            answered: self.answered as f64 / self.rows.max(1) as f64,
            total_field_ut: self.live.lengths.mean_spread(),
            heading: self.live.azimuths.heading_error(north_deg),
        }
    }

    /// Heading error rms over every second, longer where there would be more than 2000 of them: (middle, s; degrees), where there
    /// are a reference and vectors. For a picture: azimuths of one second that lie on both sides of the centre's opposite are
    /// taken for neighbours.
    pub fn heading_course(&self) -> Vec<(f64, f64)> {
        let centre_deg = self.every.centre_deg();
        let known = self.spans.iter().enumerate().filter_map(|(k, span)| Some((k, (*span)?)));
        let point = |(k, (first_deg, others)): (usize, (f64, Spread))| {
            let MeanSpread { mean, spread } = others.all();
            ((k as f64 + 0.5) * self.span_s, off_deg(first_deg + mean, centre_deg).hypot(spread))
        };
        known.map(point).collect()
    }
}
