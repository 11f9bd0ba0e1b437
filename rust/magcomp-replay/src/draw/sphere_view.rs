//! The sphere as SVG: three projections along the device's axes and one view from aside.
//!
//! A sphere of radius F seen through M is the ellipsoid M (F u). Along an axis its outline is F L (cos, sin), L L^T being the part
//! of M M^T that belongs to the other two axes. From aside, w is out of the paper: a wire is in front where w > 0.

use super::sphere::{Epoch, Sample, Sphere};
use super::square::{PANEL, Square, picture, text};
use crate::plot::Colour;
use crate::report::Report;
use magcomp::nalgebra::{Matrix2, Matrix3, Rotation3, Vector2, Vector3};
use std::f64::consts::{PI, TAU};

/// Stretches that are shown, at most.
const MOST_EPOCHS: usize = 6;
/// Height of the line above a panel, pixels.
const TITLE: f64 = 42.0;
/// Points of a kind in a panel, at most.
const MOST_POINTS: usize = 1500;
/// Directions that are looked for, and the cosine of the angle within which a sample sees one: 12 degrees.
const DIRECTIONS: usize = 200;
const SEES: f64 = 0.978;
/// Half the width of a panel in radii of the sphere: at least, and at most.
const SHOWN: (f64, f64) = (1.3, 2.5);
/// The view from aside: turned about z, then tilted, degrees.
const TURNED: f64 = 35.0;
const TILTED: f64 = 25.0;
/// Wires every so many degrees.
const WIRE: usize = 30;

/// Axes of the three projections: right, up, and their names.
const PROJECTIONS: [(usize, usize, &str); 3] =
    [(0, 1, "x right, y up"), (0, 2, "x right, z up"), (1, 2, "y right, z up")];

/// Adds the picture `NAME_sphere.svg` and the page `NAME_sphere.html`; `recording` is the recording's name.
pub(super) fn show(sphere: &Sphere, report: &mut Report, name: &str, recording: &str) {
    let epochs = sphere.epochs();
    if epochs.is_empty() {
        return;
    }
    let shown = MOST_EPOCHS.min(epochs.len());
    let more = match epochs.len() - shown {
        0 => String::new(),
        more => format!(" The latest {shown} stretches are shown, {more} before them are not."),
    };
    let caption = format!(
        "{recording}: one line for each stretch between decided changes. Raw samples less b (grey) lie on the fitted \
         ellipsoid where M and b are right, corrected samples (blue) on the sphere; both outlines are those of the calibration \
         at the stretch's end. Right: the corrected sphere turned; red rings are directions that no sample of the stretch came \
         within 12 degrees of.{more}"
    );
    report.figure(&format!("{name}_sphere"), svg(&epochs[epochs.len() - shown..]), &caption);
    report.page(&format!("{name}_sphere"), sphere.page(recording), "Turn the sphere, scrub in time");
}

/// A picture of these stretches, one below the other.
fn svg(epochs: &[Epoch<'_>]) -> String {
    picture(4.0 * PANEL, epochs.len() as f64 * (PANEL + TITLE), |out| {
        epochs.iter().enumerate().for_each(|(row, epoch)| draw(out, epoch, row as f64 * (PANEL + TITLE)));
    })
}

fn draw(out: &mut String, epoch: &Epoch<'_>, top: f64) {
    let (m, b, radius) = match &epoch.calibration {
        Some(calibration) => (*calibration.soft_iron(), *calibration.hard_iron_ut(), calibration.field_strength_ut()),
        None => (Matrix3::identity(), middle(epoch.samples), extent(epoch.samples)),
    };
    let every = epoch.samples.len().div_ceil(MOST_POINTS).max(1);
    let raw: Vec<Vector3<f64>> = epoch.samples.iter().step_by(every).map(|sample| sample.raw - b).collect();
    let corrected: Vec<Vector3<f64>> =
        epoch.samples.iter().step_by(every).filter_map(|sample| sample.corrected).collect();
    let mut sizes: Vec<f64> = raw.iter().map(|v| v.amax()).collect();
    sizes.sort_by(f64::total_cmp);
    let most = 1.1 * sizes[sizes.len() * 98 / 100];
    let scale = 0.5 * PANEL / most.clamp(SHOWN.0 * radius, SHOWN.1 * radius);

    let begins = epoch.event.map_or_else(|| "the start".to_owned(), |event| format!("{:?}", event.kind));
    let fitted = match &epoch.calibration {
        Some(_) => format!("b = ({:.1}, {:.1}, {:.1}) uT, |h| = {radius:.1} uT", b.x, b.y, b.z),
        None => "no calibration yet; raw samples about their middle".to_owned(),
    };
    let (from_s, to_s) = epoch.span_s;
    text(out, 12.0, top + 18.0, 15, &format!("{from_s:.1} to {to_s:.1} s, from {begins}: {fitted}"));
    let calibrated = epoch.calibration.is_some();
    for (column, (i, j, name)) in PROJECTIONS.into_iter().enumerate() {
        let panel = Square { left: column as f64 * PANEL, top: top + TITLE, scale };
        panel.begin(out, name);
        let flat = |v: &Vector3<f64>| Vector2::new(v[i], v[j]);
        panel.points(out, raw.iter().map(flat), Colour::Grey);
        panel.points(out, corrected.iter().map(flat), Colour::Blue);
        if calibrated {
            let whole = m * m.transpose();
            let part = Matrix2::new(whole[(i, i)], whole[(i, j)], whole[(j, i)], whole[(j, j)]);
            let shape = part.cholesky().map_or_else(Matrix2::identity, |root| root.l()) * radius;
            let circle =
                || (0..=72).map(|k| Vector2::new((k as f64 * TAU / 72.0).cos(), (k as f64 * TAU / 72.0).sin()));
            panel.line(out, circle().map(|u| shape * u), Colour::Grey, 1.0);
            panel.line(out, circle().map(|u| u * radius), Colour::Blue, 1.0);
        }
        panel.end(out);
    }
    let panel = Square { left: 3.0 * PANEL, top: top + TITLE, scale: 0.5 * PANEL / (SHOWN.0 * radius) };
    panel.begin(out, "from aside: seen and unseen directions");
    aside(out, &panel, &corrected, radius);
    panel.end(out);
}

/// Sphere, samples and unseen directions from aside.
fn aside(out: &mut String, panel: &Square, corrected: &[Vector3<f64>], radius: f64) {
    let view = Rotation3::from_axis_angle(&Vector3::x_axis(), (TILTED - 90.0).to_radians())
        * Rotation3::from_axis_angle(&Vector3::z_axis(), TURNED.to_radians());
    let direction = |azimuth: usize, elevation: f64| {
        let ((sin, cos), (up, across)) = ((azimuth as f64).to_radians().sin_cos(), elevation.to_radians().sin_cos());
        Vector3::new(across * cos, across * sin, up)
    };
    let parallels = (1..180 / WIRE).map(|k| (0..=72).map(|a| direction(5 * a, 90.0 - (k * WIRE) as f64)).collect());
    let meridians = (0..360 / WIRE).map(|k| (0..=36).map(|e| direction(k * WIRE, 90.0 - 5.0 * e as f64)).collect());
    let wires: Vec<Vec<Vector3<f64>>> = parallels.chain(meridians).collect();
    for wire in &wires {
        for pair in wire.windows(2) {
            let (from, to) = (view * pair[0] * radius, view * pair[1] * radius);
            panel.line(
                out,
                [from.xy(), to.xy()].into_iter(),
                Colour::Grey,
                if from.z + to.z > 0.0 { 0.5 } else { 0.15 },
            );
        }
    }
    let turned: Vec<Vector3<f64>> = corrected.iter().map(|c| view * c).collect();
    panel.points(out, turned.iter().map(|v| v.xy()), Colour::Blue);
    for unseen in unseen(corrected) {
        let at = view * unseen * radius;
        panel.ring(out, at.xy(), if at.z > 0.0 { 1.0 } else { 0.3 });
    }
}

/// Directions that no sample comes near, of some that are spread evenly (a spiral of equal areas by the golden angle).
fn unseen(corrected: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let seen: Vec<Vector3<f64>> = corrected.iter().filter_map(|c| c.try_normalize(1e-9)).collect();
    let golden = PI * (3.0 - 5.0_f64.sqrt());
    let spread = (0..DIRECTIONS).map(|k| {
        let z = 1.0 - (2 * k + 1) as f64 / DIRECTIONS as f64;
        let (sin, cos) = (golden * k as f64).sin_cos();
        let across = (1.0 - z * z).sqrt();
        Vector3::new(across * cos, across * sin, z)
    });
    spread.filter(|direction| !seen.iter().any(|c| c.dot(direction) > SEES)).collect()
}

fn bounds(samples: &[Sample]) -> (Vector3<f64>, Vector3<f64>) {
    let first = samples[0].raw;
    samples.iter().fold((first, first), |(low, high), sample| (low.inf(&sample.raw), high.sup(&sample.raw)))
}

fn middle(samples: &[Sample]) -> Vector3<f64> {
    let (low, high) = bounds(samples);
    (low + high) / 2.0
}

fn extent(samples: &[Sample]) -> f64 {
    let (low, high) = bounds(samples);
    (0.5 * (high - low).amax()).max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use magcomp::Calibration;

    fn samples(calibration: &Calibration, upper: bool) -> Vec<Sample> {
        let golden = PI * (3.0 - 5.0_f64.sqrt());
        let direction = |k: usize| {
            let z = 1.0 - (2 * k + 1) as f64 / 2000.0;
            let (sin, cos) = (golden * k as f64).sin_cos();
            Vector3::new((1.0 - z * z).sqrt() * cos, (1.0 - z * z).sqrt() * sin, if upper { z.abs() } else { z })
        };
        let sample = |k: usize| {
            let h = direction(k) * calibration.field_strength_ut();
            Sample { time_s: k as f64 / 100.0, raw: calibration.distort(&h), corrected: Some(h), calibration: Some(0) }
        };
        (0..2000).map(sample).collect()
    }

    #[test]
    fn directions_that_no_sample_came_near_are_told() {
        let calibration = Calibration::identity(50.0).unwrap();
        let corrected =
            |upper| samples(&calibration, upper).iter().filter_map(|sample| sample.corrected).collect::<Vec<_>>();
        assert!(unseen(&corrected(false)).is_empty());
        let missing = unseen(&corrected(true));
        assert!(missing.iter().all(|direction| direction.z < 0.0));
        // the lower half but for the 12 degrees below its edge: 0.5 (1 - sin 12) of the directions
        assert!((missing.len() as f64 - 0.5 * (1.0 - 0.208) * DIRECTIONS as f64).abs() < 6.0, "{}", missing.len());
    }

    #[test]
    fn raw_samples_lie_within_the_outline_and_touch_it() {
        let m = Matrix3::new(1.2, 0.1, -0.05, 0.1, 0.8, 0.07, -0.05, 0.07, 1.0);
        let calibration = Calibration::new(m, Vector3::new(100.0, -50.0, 300.0), 50.0).unwrap();
        let whole = m * m.transpose();
        for (i, j, _) in PROJECTIONS {
            let part = Matrix2::new(whole[(i, i)], whole[(i, j)], whole[(j, i)], whole[(j, j)]);
            let inverse = part.try_inverse().unwrap() / 2500.0;
            let size = |sample: &Sample| {
                let v = sample.raw - calibration.hard_iron_ut();
                let flat = Vector2::new(v[i], v[j]);
                flat.dot(&(inverse * flat)).sqrt()
            };
            let largest = samples(&calibration, false).iter().map(size).fold(0.0, f64::max);
            assert!((0.995..=1.0 + 1e-9).contains(&largest), "{largest}");
        }
    }

    #[test]
    fn the_picture_is_an_svg_of_bounded_size_with_both_styles() {
        let calibration = Calibration::identity(50.0).unwrap();
        let samples = samples(&calibration, true);
        let epoch = Epoch { event: None, span_s: (0.0, 20.0), samples: &samples, calibration: Some(calibration) };
        let picture = svg(&[epoch.clone(), Epoch { calibration: None, ..epoch }]);
        assert!(picture.starts_with("<svg") && picture.trim_end().ends_with("</svg>"));
        assert!(picture.contains("prefers-color-scheme") && picture.contains("no calibration yet"));
        assert!(!picture.contains("NaN") && picture.len() < 400_000, "{} bytes", picture.len());
    }
}
