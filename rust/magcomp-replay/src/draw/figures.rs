//! A replay as a picture over time: heading with its sigma, total field and dip, M and b with their sigmas, status and events;
//! with a reference the errors too; why the readings said so, where that is told. Then the sphere.

use super::sphere::Sphere;
use crate::error::RunError;
use crate::judge::{Circle, Mark, azimuth_deg, off_deg};
use crate::play::Step;
use crate::plot::{Band, Colour, Thin};
use crate::report::{Moment, Report};
use crate::statistics::Sizes;
use magcomp::nalgebra::Vector3;
use magcomp::{Calibration, Explanation};
use magcomp_recordings::recording::{Extent, Recording, Row};

/// Lanes of the status strip, from the bottom, and their colours.
pub(super) const LANES: [(&str, Colour); 6] = [
    ("rejected", Colour::Status(0)),
    ("disturbed", Colour::Status(1)),
    ("suspect", Colour::Status(2)),
    ("tracking", Colour::Status(3)),
    ("held", Colour::Status(4)),
    ("collecting", Colour::Status(5)),
];
/// Pixels across a picture: the band has about one point a pixel, and spans of a lane that are less apart are drawn as one.
const PIXELS: usize = 1000;

/// A replay as a picture, made row by row in memory that does not grow with it.
#[derive(Clone, Debug, Default)]
pub struct Figures {
    pub(super) extent: Extent,
    rows: usize,
    pub(super) raw: Thin,
    pub(super) corrected: Thin,
    pub(super) raw_error: ErrorLine,
    pub(super) corrected_error: ErrorLine,
    pub(super) heading_error: ErrorLine,
    pub(super) two_sigma: Sizes,
    pub(super) band: Band,
    pub(super) system: Thin,
    pub(super) total_field: Sizes,
    pub(super) raw_field: Sizes,
    pub(super) heading: Vec<(f64, f64)>,
    pub(super) heading_band: Band,
    pub(super) dip: Thin,
    pub(super) truth: [Thin; 3],
    /// b, then M_xx M_yy M_zz less 1 and M_xy M_xz M_yz, with one sigma to both sides.
    pub(super) parameters: [Thin; 9],
    pub(super) parameter_bands: [Band; 9],
    pub(super) sphere: Sphere,
    pub(super) window: Thin,
    pub(super) sigma_t: Thin,
    pub(super) any_sigma_t: bool,
    /// Why, where it is told.
    pub(super) inside: Option<Inside>,
    /// For each lane of the status strip, from when to when, s.
    pub(super) lanes: [Vec<(f64, f64)>; LANES.len()],
    /// The lane of the latest row.
    lane: Option<usize>,
    /// For the cursor: time, s; heading and its two sigmas, degrees; where north was by the reference, degrees; status.
    pub(super) moments: Vec<Moment>,
    /// What a tester noted: s after the first row, and its name.
    pub(super) noted: Vec<(f64, String)>,
}

/// The inside of the estimator over time.
#[derive(Clone, Debug)]
pub(super) struct Inside {
    pub(super) ratio: Thin,
    pub(super) log_odds: Thin,
    pub(super) white_ut: Thin,
    pub(super) local_ut: Thin,
}

impl Inside {
    fn new(rows: usize) -> Self {
        let line = || Thin::new(rows);
        Self { ratio: line(), log_odds: line(), white_ut: line(), local_ut: line() }
    }

    fn add(&mut self, time_s: f64, explanation: &Explanation) {
        let Explanation { innovation, hypotheses, noise, .. } = explanation;
        self.ratio.add(time_s, innovation.map_or(f64::NAN, |it| it.ratio));
        self.log_odds.add(time_s, hypotheses[1].map_or(f64::NAN, |it| it.log_odds));
        self.white_ut.add(time_s, noise.white_ut.unwrap_or(f64::NAN));
        self.local_ut.add(time_s, noise.local_ut.unwrap_or(f64::NAN));
    }
}

/// Azimuths as a line about their median, which is known only at the end. Within a stretch an azimuth is stored by its
/// difference from another one, so that the lowest and the highest are those of one turn.
#[derive(Clone, Debug, Default)]
pub(super) struct ErrorLine {
    azimuths: Circle,
    line: Thin,
}

impl ErrorLine {
    fn add(&mut self, time_s: f64, azimuth_deg: Option<f64>) {
        let near = self.line.present().map(|(_, azimuth_deg)| azimuth_deg);
        if let Some(azimuth_deg) = azimuth_deg {
            self.azimuths.add(azimuth_deg, None, true);
        }
        let turned = |azimuth_deg: f64| near.map_or(azimuth_deg, |near| near + off_deg(azimuth_deg, near));
        self.line.add(time_s, azimuth_deg.map_or(f64::NAN, turned));
    }

    /// Their median, degrees.
    pub fn centre_deg(&self) -> f64 {
        self.azimuths.centre_deg()
    }

    pub fn points(&self) -> Vec<(f64, f64)> {
        let centre_deg = self.azimuths.centre_deg();
        self.line.points().into_iter().map(|(x, azimuth_deg)| (x, off_deg(azimuth_deg, centre_deg))).collect()
    }
}

impl Figures {
    /// For a recording of this extent.
    pub fn new(extent: &Extent) -> Self {
        let line = || Thin::new(extent.rows);
        let error = || ErrorLine { azimuths: Circle::default(), line: line() };
        Self {
            extent: *extent,
            raw: line(),
            corrected: line(),
            raw_error: error(),
            corrected_error: error(),
            heading_error: error(),
            system: line(),
            dip: line(),
            truth: [line(), line(), line()],
            parameters: std::array::from_fn(|_| line()),
            sphere: Sphere::new(extent),
            window: line(),
            sigma_t: line(),
            ..Self::default()
        }
    }

    /// The same with what a tester noted.
    pub fn with(self, marks: &[Mark]) -> Self {
        Self { noted: marks.iter().map(|mark| (mark.at_s, mark.name.clone())).collect(), ..self }
    }

    /// The next row, the compensator's step for it, and why its reading says what it says.
    pub fn add(&mut self, row: &Row, step: &Step, explanation: Option<&Explanation>) {
        let Step { reading, calibration, sigma, .. } = step;
        self.sphere.add(row, step);
        let time_s = row.time_s - self.extent.start_s;
        self.raw.add(time_s, row.field_ut.norm());
        self.corrected.add(time_s, reading.field_ut.map_or(f64::NAN, |c| c.norm()));
        self.system.add(time_s, row.system_ut.map_or(f64::NAN, |system| system.norm()));
        self.raw_field.add(row.field_ut.norm());
        reading.field_ut.iter().for_each(|c| self.total_field.add(c.norm()));
        self.dip.add(time_s, reading.heading.and_then(|heading| heading.inclination_deg).unwrap_or(f64::NAN));

        let azimuth = |vector: Option<Vector3<f64>>| azimuth_deg(row, &vector?);
        self.raw_error.add(time_s, azimuth(Some(row.field_ut)));
        self.corrected_error.add(time_s, azimuth(reading.field_ut));
        self.heading_error.add(time_s, azimuth(reading.filtered_field_ut.or(reading.field_ut)));
        let two_sigma = reading.heading.and_then(|heading| Some(2.0 * heading.heading_sigma_deg?));
        two_sigma.iter().for_each(|sigma| self.two_sigma.add(*sigma));
        // the heading's line runs within the noise of the samples: one point a pixel is enough
        let sampled = self.rows.is_multiple_of(self.extent.rows.div_ceil(PIXELS).max(1));
        if sampled {
            let label = reading.status.label();
            let status = LANES.iter().map(|(name, _)| *name).find(|name| *name == label).unwrap_or_default();
            let heading_deg = reading.heading.map(|heading| heading.heading_deg);
            let north_deg = azimuth(reading.filtered_field_ut.or(reading.field_ut));
            self.moments.push((time_s, heading_deg, two_sigma, north_deg, status));
            let sigma = two_sigma.unwrap_or(f64::NAN);
            self.band.push((time_s, -sigma, sigma));
            let heading_deg = reading.heading.map_or(f64::NAN, |heading| heading.heading_deg);
            // through north the line begins anew on the other side
            if self.heading.last().is_some_and(|(_, before)| (heading_deg - before).abs() > 180.0) {
                self.heading.push((time_s, f64::NAN));
                self.heading_band.push((time_s, f64::NAN, f64::NAN));
            }
            self.heading.push((time_s, heading_deg));
            self.heading_band.push((time_s, heading_deg - sigma, heading_deg + sigma));
        }

        let parameters = calibration.map(|calibration| parameters(&calibration));
        for i in 0..9 {
            let value = parameters.map_or(f64::NAN, |parameters| parameters[i]);
            self.parameters[i].add(time_s, value);
            if sampled {
                let sigma = sigma.map_or(f64::NAN, |sigma| sigma[i]);
                self.parameter_bands[i].push((time_s, value - sigma, value + sigma));
            }
        }
        for i in 0..3 {
            self.truth[i].add(time_s, row.hard_iron_ut.map_or(f64::NAN, |b| b[i]));
        }
        self.window.add(time_s, reading.window as f64 / 2000.0);
        self.sigma_t.add(time_s, reading.sigma_t.unwrap_or(f64::NAN));
        self.any_sigma_t |= reading.sigma_t.is_some();
        if let Some(explanation) = explanation {
            self.inside.get_or_insert_with(|| Inside::new(self.extent.rows)).add(time_s, explanation);
        }
        self.add_status(time_s, reading.status.label());
        self.rows += 1;
    }

    /// Lengthens the span of the row before, then begins another one or goes on with one that is not a pixel away.
    fn add_status(&mut self, time_s: f64, label: &str) {
        if let Some(span) = self.lane.and_then(|lane| self.lanes[lane].last_mut()) {
            span.1 = time_s;
        }
        self.lane = LANES.iter().position(|(name, _)| *name == label);
        let Some(lane) = self.lane else { return };
        let pixel_s = self.extent.duration_s() / PIXELS as f64;
        match self.lanes[lane].last_mut() {
            Some(span) if time_s - span.1 < pixel_s => span.1 = time_s,
            _ => self.lanes[lane].push((time_s, time_s)),
        }
    }
}

/// b (uT), M_xx M_yy M_zz less 1, M_xy M_xz M_yz: the order of `Compensator::covariance`.
fn parameters(calibration: &Calibration) -> [f64; 9] {
    let (b, m) = (calibration.hard_iron_ut(), calibration.soft_iron());
    [b.x, b.y, b.z, m.m11 - 1.0, m.m22 - 1.0, m.m33 - 1.0, m.m12, m.m13, m.m23]
}

/// Adds the picture of a replay in memory, as [`Figures`].
pub fn figures(report: &mut Report, name: &str, recording: &Recording, steps: &[Step]) -> Result<(), RunError> {
    let mut figures = Figures::new(&recording.extent());
    recording.rows.iter().zip(steps).for_each(|(row, step)| figures.add(row, step, None));
    figures.finish(report, name, &recording.name())
}
