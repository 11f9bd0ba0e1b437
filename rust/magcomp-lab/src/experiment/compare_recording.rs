//! Methods side by side on a recording: spread of the total field, and heading against the reference orientation up to one
//! constant, as `replay` judges them. The network may learn from the reference over the first 40 %.

use crate::baseline::{Baseline, Contestant, Known};
use magcomp::nalgebra::Vector3;
use magcomp::{MagneticSample, RotationRateSample, UpSample};
use magcomp_recordings::error::RecordingError;
use magcomp_recordings::recording::{Extent, Row};
use magcomp_replay::error::RunError;
use magcomp_replay::{Vectors, VectorsJudge};
use serde::Serialize;

/// Share of a recording with a reference to learn from.
const LEARNED: f64 = 0.4;
/// Noise given to the Kalman filters, uT: that of phones' magnetometers.
pub const NOISE_UT: f64 = 0.5;
/// Field strength they start from, uT.
pub const FIELD_UT: f64 = 50.0;
/// Dip of the directions the network learns, degrees: that of central Europe. North is the reference's.
const DIP_DEG: f64 = 65.0;

/// Value of a method's one free number: the middle of its grid, since there are no other seeds of a recording.
fn middle(contestant: Contestant) -> f64 {
    let grid = contestant.grid();
    grid[grid.iter().filter(|value| **value >= 0.0).count() / 2]
}

/// Gives a method the events of gyroscope and accelerometer up to a row.
pub fn push_inertial(method: &mut dyn Baseline, row: &Row) {
    let usable = |v: &Vector3<f64>| v.iter().all(|value| value.is_finite());
    for event in row.inertial() {
        if let Some(rate_rad_s) = event.rate_rad_s.filter(usable) {
            method.push_rate(&RotationRateSample { time_ns: event.time_ns, rate_rad_s });
        }
        if let Some(up_m_s2) = event.up_m_s2.filter(usable) {
            method.push_up(&UpSample { time_ns: event.time_ns, up_m_s2 });
        }
    }
}

/// A method on a recording.
#[derive(Clone, Debug, Serialize)]
pub struct RecordingScore {
    pub name: String,
    /// Value of its free number; none without one.
    pub value: Option<f64>,
    /// Whether it had gyroscope and accelerometer too.
    pub aided: bool,
    pub vectors: Vectors,
    /// Heading error rms over a second, degrees, over time, s: for the picture. Empty without a reference.
    #[serde(skip)]
    pub course_deg: Vec<(f64, f64)>,
}

/// Runs methods on a recording of this extent, side by side row by row.
pub fn compare_rows(
    extent: &Extent,
    rows: impl IntoIterator<Item = Result<Row, RecordingError>>,
    methods: &[Contestant],
    seed: u64,
) -> Result<Vec<RecordingScore>, RunError> {
    let taught = (extent.rows as f64 * LEARNED) as usize;
    let (down, north) = DIP_DEG.to_radians().sin_cos();
    let field = Vector3::new(0.0, north, -down);
    let reference = extent.first_reference.is_some_and(|first| first < taught);
    let known = Known { seed, noise_ut: NOISE_UT, field_ut: FIELD_UT, parameters: None, initial: None, reference };
    let mut running = Vec::new();
    for contestant in methods {
        if let Some(method) = contestant.make(middle(*contestant), &known)? {
            running.push((*contestant, method, VectorsJudge::new(extent)));
        }
    }
    for (k, row) in rows.into_iter().enumerate() {
        let row = row?;
        let finite = row.field_ut.iter().all(|value| value.is_finite());
        for (contestant, method, judge) in &mut running {
            if contestant.is_aided() {
                push_inertial(method.as_mut(), &row);
            }
            let corrected = finite.then(|| {
                if let Some(attitude) = row.attitude.filter(|_| k < taught) {
                    method.teach(attitude.inverse() * field);
                }
                method.push(&MagneticSample { time_ns: row.time_ns, field_ut: row.field_ut });
                method.latest(&row.field_ut)
            });
            judge.add(&row, corrected.flatten().as_ref());
        }
    }
    let score = |(contestant, _, judge): &(Contestant, _, VectorsJudge)| RecordingScore {
        name: contestant.name(),
        aided: contestant.is_aided(),
        value: (contestant.grid().len() > 1).then(|| middle(*contestant)),
        // north by an attitude has no length
        vectors: match (judge.vectors(0.0), contestant.gives_attitude()) {
            (vectors, true) => Vectors { total_field_ut: None, ..vectors },
            (vectors, false) => vectors,
        },
        course_deg: judge.heading_course(),
    };
    Ok(running.iter().map(score).collect())
}
