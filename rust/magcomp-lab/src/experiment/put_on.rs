//! A magnet put on a device in the middle of its recording, by arithmetic: a constant field is added to the samples from then on. And headings
//! that are judged from then on, by the constant angle of the rows before: nothing is forgiven that the magnet does.

use magcomp::nalgebra::Vector3;
use magcomp_recordings::recording::{Extent, Row};
use magcomp_replay::error::RunError;
use magcomp_replay::plot::{Colour, Layers, Panel, Series, draw};
use magcomp_replay::{VectorsJudge, off_deg};
use serde::Serialize;

/// The field that is added, device frame, uT: 27 uT in all. benchmarks/convert.py adds the same.
const MAGNET_UT: Vector3<f64> = Vector3::new(18.0, -12.0, 16.0);
/// Length of a span of the course, s.
const SPAN_S: f64 = 1.0;
/// Largest error that a picture shows, degrees: a line ends there.
const SHOWN_DEG: f64 = 60.0;
/// Size of the picture, pixels: README shows it 1.3 times as large, with letters of 12 pixels.
const SIZE: (u32, u32) = (640, 270);

/// The middle of a recording, s.
pub fn middle_s(extent: &Extent) -> f64 {
    extent.start_s + extent.duration_s() / 2.0
}

/// The row as it would be with the magnet, where it is on.
pub fn with_magnet(mut row: Row, on_s: f64) -> Row {
    if row.time_s >= on_s {
        row.field_ut += MAGNET_UT;
        row.system_ut = row.system_ut.map(|field| field + MAGNET_UT);
    }
    row
}

/// A method's heading on a recording.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Heading {
    /// Share of the judged rows with an answer.
    pub answered: f64,
    /// Rms of the error up to one constant, degrees.
    pub rms_deg: f64,
    /// Rms of the error against magnetic north by the reference, degrees.
    pub absolute_deg: f64,
}

/// Judges a method's vectors: over the whole recording without its first seconds, or from a moment on.
#[derive(Clone, Debug)]
pub struct HeadingJudge {
    all: VectorsJudge,
    later: Option<(f64, VectorsJudge)>,
    start_s: f64,
    course: Vec<Span>,
}

/// A second of a heading: the sums of its unit vectors and of its sigmas, degrees, and how many there are of each.
#[derive(Clone, Copy, Debug, Default)]
struct Span {
    east: f64,
    north: f64,
    sigmas_deg: f64,
    with_sigma: u32,
}

/// The error over time in a picture: the middle of a second, s; mean error, degrees, clockwise; mean sigma, degrees, where there is one.
pub type Course = Vec<(f64, f64, Option<f64>)>;

impl HeadingJudge {
    /// `from_s`: judged from then on, by the constant of the rows before.
    pub fn new(extent: &Extent, from_s: Option<f64>) -> Self {
        let course = vec![Span::default(); (extent.duration_s() / SPAN_S) as usize + 1];
        let later = from_s.map(|from_s| (from_s, VectorsJudge::new(extent)));
        Self { all: VectorsJudge::new(extent), later, start_s: extent.start_s, course }
    }

    /// The next row, the vector where the method has one, and its sigma, degrees, where it tells one.
    pub fn add(&mut self, row: &Row, vector: Option<&Vector3<f64>>, sigma_deg: Option<f64>) {
        match &mut self.later {
            Some((from_s, later)) if row.time_s >= *from_s => later.add(row, vector),
            _ => self.all.add(row, vector),
        }
        let earth = row.attitude.zip(vector).map(|(attitude, vector)| (attitude * vector).xy());
        let span = self.course.get_mut(((row.time_s - self.start_s) / SPAN_S) as usize);
        if let (Some(span), Some(level)) = (span, earth.and_then(|earth| earth.try_normalize(0.0))) {
            (span.east, span.north) = (span.east + level.x, span.north + level.y);
            if let Some(sigma_deg) = sigma_deg {
                (span.sigmas_deg, span.with_sigma) = (span.sigmas_deg + sigma_deg, span.with_sigma + 1);
            }
        }
    }

    /// The figures; none without enough answers, before the moment too. `north_deg`: how far magnetic north is east of the reference's.
    pub fn heading(&self, north_deg: f64) -> Option<Heading> {
        let Some((_, later)) = &self.later else {
            let vectors = self.all.vectors(north_deg);
            let error = vectors.heading?;
            return Some(Heading {
                answered: vectors.answered,
                rms_deg: error.rms_deg,
                absolute_deg: error.absolute_rms_deg,
            });
        };
        let [own, north] = [self.centre_deg()?, north_deg].map(|deg| later.vectors(deg));
        Some(Heading {
            answered: own.answered,
            rms_deg: own.heading?.absolute_rms_deg,
            absolute_deg: north.heading?.absolute_rms_deg,
        })
    }

    /// Where the method has north by the reference, degrees: in all rows, or in those before the moment.
    fn centre_deg(&self) -> Option<f64> {
        Some(-self.all.vectors(0.0).heading?.constant_deg)
    }

    /// The error over time about the constant that the figures take out.
    pub fn course(&self) -> Course {
        let Some(centre_deg) = self.centre_deg() else { return Course::new() };
        let known = self.course.iter().enumerate().filter(|(_, span)| span.east != 0.0 || span.north != 0.0);
        let point = |(k, span): (usize, &Span)| {
            // north too far east makes a heading too small
            let off_deg = off_deg(centre_deg, span.east.atan2(span.north).to_degrees());
            let sigma_deg = (span.with_sigma > 0).then(|| span.sigmas_deg / f64::from(span.with_sigma));
            ((k as f64 + 0.5) * SPAN_S, off_deg, sigma_deg)
        };
        known.map(point).collect()
    }
}

/// A line of a picture.
pub struct Drawn<'a> {
    pub name: String,
    pub colour: Colour,
    pub course: &'a [(f64, f64, Option<f64>)],
}

/// The errors of a few methods over time, with the two-sigma band of those that tell a sigma, and what happened when, s after the first row.
pub fn picture(drawn: &[Drawn<'_>], happened: &[(f64, &str)]) -> Result<String, RunError> {
    let series = drawn.iter().map(|line| {
        let points = line.course.iter().map(|(s, error_deg, _)| (*s, error_deg.clamp(-SHOWN_DEG, SHOWN_DEG)));
        Series::new(&line.name, line.colour, broken(points))
    });
    let band = |line: &Drawn<'_>| {
        let band = line.course.iter().filter_map(|(s, error_deg, sigma_deg)| {
            let two_deg = 2.0 * (*sigma_deg)?;
            Some((*s, error_deg - two_deg, error_deg + two_deg))
        });
        (line.colour, band.collect::<Vec<_>>())
    };
    let bands = drawn.iter().map(band).filter(|(_, band)| !band.is_empty()).collect();
    let panel = Panel {
        y_range: Some((-SHOWN_DEG * 1.05, SHOWN_DEG * 1.2)),
        layers: Layers {
            bands,
            marks: happened.iter().map(|(at_s, name)| (*at_s, (*name).to_owned())).collect(),
            ..Layers::default()
        },
        ..Panel::new("", "s", "heading error, deg", series)
    };
    draw(&[panel], 1, SIZE)
}

/// The points with a gap where seconds are missing, and where a line would cross the picture because an error passes 180 degrees.
fn broken(points: impl Iterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
    let mut out: Vec<(f64, f64)> = Vec::new();
    for (s, deg) in points {
        if let Some((before_s, before_deg)) = out.last().copied()
            && (s - before_s > 1.5 * SPAN_S || (deg - before_deg).abs() > 1.5 * SHOWN_DEG)
        {
            out.push((0.5 * (s + before_s), f64::NAN));
        }
        out.push((s, deg));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use magcomp::nalgebra::UnitQuaternion;

    const EXTENT: Extent =
        Extent { start_s: 10.0, end_s: 110.0, rows: 1000, first_reference: Some(0), start_ns: 0, system: false };

    /// A heading that is 3 degrees off until 60 s and 10 degrees off from then on.
    fn judge(from_s: Option<f64>) -> HeadingJudge {
        let mut judge = HeadingJudge::new(&EXTENT, from_s);
        for k in 0..1000 {
            let time_s = 10.0 + 0.1 * f64::from(k);
            let off_deg: f64 = if time_s < 60.0 { 3.0 } else { 10.0 };
            let (east, north) = off_deg.to_radians().sin_cos();
            let attitude = UnitQuaternion::from_euler_angles(0.1, 0.2, 0.05 * f64::from(k));
            let vector = attitude.inverse() * Vector3::new(east, north, -1.0);
            let row = Row { time_s, attitude: Some(attitude), ..Row::default() };
            judge.add(&row, (k % 2 == 0).then_some(&vector), Some(2.0));
        }
        judge
    }

    #[test]
    fn from_a_moment_on_the_constant_is_that_of_the_rows_before() {
        let found = judge(Some(60.0)).heading(1.0).unwrap();
        assert!((found.rms_deg - 7.0).abs() < 0.01 && (found.absolute_deg - 9.0).abs() < 0.01, "{found:?}");
        assert!((found.answered - 0.5).abs() < 0.01, "{found:?}");
        // over all rows one constant takes out most of it
        assert!(judge(None).heading(1.0).unwrap().rms_deg < 6.0);
        // without rows before there is no constant
        assert_eq!(judge(Some(0.0)).heading(1.0), None);
        let course = judge(Some(60.0)).course();
        assert_eq!(course.len(), 100);
        // north too far east by 7 degrees: headings are 7 degrees too small
        assert!(course[20].1.abs() < 0.01 && (course[80].1 + 7.0).abs() < 0.01, "{course:?}");
        assert_eq!(course[80].2, Some(2.0));
    }

    #[test]
    fn the_magnet_is_in_both_fields_from_its_second_on() {
        let row = |time_s| Row { time_s, system_ut: Some(Vector3::zeros()), ..Row::default() };
        let [before, after] = [59.9, 60.0].map(|time_s| with_magnet(row(time_s), middle_s(&EXTENT)));
        assert_eq!((before.field_ut.norm(), before.system_ut.unwrap().norm()), (0.0, 0.0));
        assert_eq!((after.field_ut, after.system_ut), (MAGNET_UT, Some(MAGNET_UT)));
        assert!((MAGNET_UT.norm() - 27.0).abs() < 0.1);
    }

    #[test]
    fn a_line_breaks_where_it_would_cross_the_picture() {
        let points = broken([(0.5, 59.0), (1.5, -59.0), (2.5, -58.0), (5.5, -57.0)].into_iter());
        assert_eq!(points.iter().filter(|(_, deg)| deg.is_nan()).count(), 2, "{points:?}");
    }
}
