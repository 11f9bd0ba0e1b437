//! Our headings beside those of other methods, on every recording of a folder.

use super::figures::Worse;
use super::folder::{name_of, recordings, system_half};
use super::groups::{Groups, Rule};
use super::score::{GroupScore, Score, Summary, with_warnings};
use crate::baseline::{Baseline, Contestant, Known};
use crate::experiment::compare_recording::{FIELD_UT, NOISE_UT, push_inertial};
use crate::experiment::put_on::{Course, Heading, HeadingJudge};
use crate::parallel::map_shown;
use magcomp::nalgebra::{Quaternion, UnitQuaternion, Vector3};
use magcomp::{Calibration, ConfigError, FitOptions, MagneticSample, Residual, fit_ellipsoid};
use magcomp_recordings::import::{ImportOptions, open};
use magcomp_recordings::recording::Row;
use magcomp_replay::Ignore;
use magcomp_replay::beside::read_table;
use magcomp_replay::error::RunError;
use serde::{Deserialize, Serialize};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// A method in the comparison.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rival {
    /// Its name in tables.
    pub name: &'static str,
    contestant: Contestant,
    /// Value of its one free number.
    value: f64,
    given: Given,
}

/// What a method is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Given {
    /// The raw field.
    Raw,
    /// The field that the operating system has calibrated.
    System,
    /// The raw field, and a calibration from a constant field of that day.
    Calibrated,
}

const fn rival(name: &'static str, contestant: Contestant, value: f64, given: Given) -> Rival {
    Rival { name, contestant, value, given }
}

impl Rival {
    /// A fresh one; none where it cannot take part, as one that lacks the calibration it is to be given.
    fn make(&self, initial: Option<Calibration>) -> Result<Option<Box<dyn Baseline>>, ConfigError> {
        let initial = initial.filter(|_| self.given == Given::Calibrated);
        if self.given == Given::Calibrated && initial.is_none() {
            return Ok(None);
        }
        let known =
            Known { seed: 0, noise_ut: NOISE_UT, field_ut: FIELD_UT, parameters: None, initial, reference: false };
        self.contestant.make(self.value, &known)
    }
}

/// All of them, in the order of the tables: from the magnetometer alone, then with gyroscope and accelerometer. magcomp's is the last of each.
pub(super) const RIVALS: [Rival; 15] = [
    rival("the raw field", Contestant::None, 0.0, Given::Raw),
    rival("the system's field", Contestant::None, 0.0, Given::System),
    rival("a sphere, window of 2000", Contestant::Sphere, 2000.0, Given::Raw),
    rival("an ellipsoid, window of 2000", Contestant::Linear, 2000.0, Given::Raw),
    rival("a calibration of that day, kept", Contestant::Constant, 0.0, Given::Calibrated),
    rival("the paper's method, cold", Contestant::PaperHalfRange, 0.5, Given::Raw),
    rival("the paper's method, with its first step", Contestant::PaperHalfRange, 0.5, Given::Calibrated),
    rival("magcomp, magnetometer alone: corrected sample", Contestant::Adaptive, 0.0, Given::Raw),
    rival("x-io Fusion on the raw field", Contestant::XioRaw, 0.0, Given::Raw),
    rival("x-io Fusion on the system's field", Contestant::XioRaw, 0.0, Given::System),
    rival("VQF on the raw field", Contestant::VqfRaw, 9.0, Given::Raw),
    rival("VQF on the system's field", Contestant::VqfRaw, 9.0, Given::System),
    rival("VQF on a fit with the gyroscope's turns", Contestant::VqfTurns, 9.0, Given::Raw),
    rival("VQF on magcomp's corrected sample", Contestant::VqfCorrected, 9.0, Given::Raw),
    rival(OURS, Contestant::Aided, 0.0, Given::Raw),
];

/// Our own, the last of them.
pub(super) const OURS: &str = "magcomp: heading";
/// The methods whose headings are drawn where a magnet is put on.
pub(super) const DRAWN: [&str; 3] = ["the system's field", "VQF on the system's field", OURS];
/// Time that a hand needs about a change, s: before it, and after it.
const HAND_S: [f64; 2] = [8.0, 3.0];
/// Rows of each part that a step of b is formed from, at least.
const FEWEST_ROWS: usize = 100;

/// The hard iron of a magnet that was put on a sensor and taken off, uT.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MagnetStep {
    /// By the reference orientation.
    pub true_ut: [f64; 3],
    /// By magcomp's calibration.
    pub found_ut: [f64; 3],
}

/// All methods on one recording.
#[derive(Clone, Debug, Serialize)]
pub struct Compared {
    /// Its name.
    pub recording: String,
    /// Its group.
    pub group: String,
    /// Of the magnet, where the index tells of one.
    pub magnet: Option<MagnetStep>,
    /// By method, in the order of the tables; none where it cannot take part or has too few answers.
    pub headings: Vec<Option<Heading>>,
    /// From which second after the first row on they are judged, where the index tells one, and the courses of those that are drawn.
    #[serde(skip)]
    pub drawn: Option<(f64, [Course; 3])>,
    /// Share of our errors within two of their sigmas, 0 to 1; none where too few rows have one.
    pub within_two_sigma: Option<f64>,
    /// Changes of the device that magcomp declared.
    pub device_steps: usize,
}

/// What a folder of recordings came to.
#[derive(Clone, Debug, Serialize)]
pub struct Comparison {
    /// Names of the methods; those of the entries are the last.
    pub methods: Vec<String>,
    /// By name.
    pub recordings: Vec<Compared>,
    /// Our published heading by groups, as `evaluate --recordings` judges it.
    pub ours: Vec<GroupScore>,
    /// Parts that may be wrong.
    pub warnings: Vec<String>,
}

/// The answers of a program that is none of ours.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Its name in tables.
    pub name: String,
    /// Where they are, a file for each recording, of its name: as many rows, with qw,qx,qy,qz (device to east-north-up) or a corrected
    /// field, cx,cy,cz. A row without an answer has empty cells.
    pub folder: PathBuf,
}

impl FromStr for Entry {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, folder) = text
            .split_once('=')
            .filter(|(name, folder)| !name.is_empty() && !folder.is_empty())
            .ok_or("expected NAME=DIR")?;
        Ok(Self { name: name.to_owned(), folder: PathBuf::from(folder) })
    }
}

/// A line of an entry.
#[derive(Deserialize)]
struct EntryLine {
    qw: Option<f64>,
    qx: Option<f64>,
    qy: Option<f64>,
    qz: Option<f64>,
    cx: Option<f64>,
    cy: Option<f64>,
    cz: Option<f64>,
}

impl EntryLine {
    /// Magnetic north, or the corrected field, in the device.
    fn vector(&self) -> Option<Vector3<f64>> {
        let vector = if let (Some(w), Some(x), Some(y), Some(z)) = (self.qw, self.qx, self.qy, self.qz) {
            UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z)).inverse() * Vector3::y()
        } else {
            Vector3::new(self.cx?, self.cy?, self.cz?)
        };
        vector.iter().all(|value| value.is_finite()).then_some(vector)
    }
}

impl Entry {
    /// Its answers to a recording; none where it has no file of that name.
    fn answers(&self, recording: &str, rows: usize) -> Result<Option<Vec<EntryLine>>, RunError> {
        let Some(file) = csv_of(&self.folder, recording) else { return Ok(None) };
        let lines: Vec<EntryLine> = read_table(&file, "answers with the columns qw,qx,qy,qz or cx,cy,cz")?;
        if lines.len() == rows {
            return Ok(Some(lines));
        }
        let why = format!("{} rows for a recording of {rows}", lines.len());
        Err(RunError::Usage(format!("{}: {why}", file.display())))
    }
}

/// The file of this name in a folder, as it is or packed.
fn csv_of(folder: &Path, name: &str) -> Option<PathBuf> {
    ["csv.gz", "csv"].map(|end| folder.join(format!("{name}.{end}"))).into_iter().find(|file| file.is_file())
}

/// Plays every recording of `folder` that has a reference through all methods, beside the answers of `entries`; `index` and `threads` as
/// of [`super::judge_folder`].
pub fn compare_folder(
    folder: &Path,
    index: Option<&Path>,
    entries: &[Entry],
    threads: NonZeroUsize,
) -> Result<Comparison, RunError> {
    let paths = recordings(folder)?;
    let groups = Groups::of(folder, index)?;
    let both = map_shown("compare", &paths, threads, |path| {
        let (score, warnings) = Score::of(path, &groups, Ignore::default())?;
        let ours = Compared {
            within_two_sigma: score.figures["within_two_sigma"],
            device_steps: score.device_steps,
            ..compared(path, &groups, entries)?
        };
        Ok::<_, RunError>(((score, warnings), ours))
    });
    let both = both.into_iter().collect::<Result<Vec<_>, _>>()?;
    let (scores, recordings): (Vec<(Score, Vec<String>)>, Vec<Compared>) = both.into_iter().unzip();
    let (scores, warnings) = with_warnings(scores, &groups);
    let ours = GroupScore::of_all(&scores, &groups);
    let methods = RIVALS.iter().map(|rival| rival.name.to_owned());
    let methods = methods.chain(entries.iter().map(|entry| entry.name.clone())).collect();
    Ok(Comparison { methods, recordings, ours, warnings })
}

/// A line of the operating system's half of a trial; cells are empty where it had no field.
#[derive(Deserialize)]
struct SystemLine {
    mx: Option<f64>,
    my: Option<f64>,
    mz: Option<f64>,
}

/// The operating system's field beside each row of a recording; none where the recording has no such half.
fn system_of(path: &Path, rows: usize) -> Result<Vec<Option<Vector3<f64>>>, RunError> {
    let Some(half) = system_half(path) else { return Ok(Vec::new()) };
    let lines: Vec<SystemLine> = read_table(&half, "the system's field, with the columns mx,my,mz")?;
    if lines.len() != rows {
        let why = format!("{} rows for a recording of {rows}", lines.len());
        return Err(RunError::Usage(format!(
            "{}: {why}; write a row for each of its rows, with empty cells where there is no field",
            half.display()
        )));
    }
    Ok(lines.iter().map(|line| Some(Vector3::new(line.mx?, line.my?, line.mz?))).collect())
}

/// One recording through all methods.
fn compared(path: &Path, groups: &Groups, entries: &[Entry]) -> Result<Compared, RunError> {
    let recording = name_of(path);
    let Rule { group, declination_deg, magnet_s, calibration, judged_s, .. } = groups.find(&recording);
    let initial = calibration.as_ref().map(|name| first_step(path, name)).transpose()?;
    let mut opened = open(&[path.to_owned()], &ImportOptions::default())?;
    let extent = *opened.source.extent();
    let system = system_of(path, extent.rows)?;
    let judge = || HeadingJudge::new(&extent, judged_s.map(|judged_s| extent.start_s + judged_s));
    let mut running = Vec::new();
    for rival in RIVALS {
        running.push((rival, rival.make(initial)?, judge()));
    }
    let entered = entries.iter().map(|entry| Ok((entry.answers(&recording, extent.rows)?, judge())));
    let mut entered: Vec<(Option<Vec<EntryLine>>, HeadingJudge)> = entered.collect::<Result<_, RunError>>()?;
    let mut magnet = magnet_s.map(|told| Magnet::new(told, extent.start_s));
    for (k, row) in opened.source.rows()?.enumerate() {
        let row = row?;
        let system_ut = row.system_ut.or(system.get(k).copied().flatten());
        for (rival, method, judge) in &mut running {
            let Some(method) = method else { continue };
            if rival.contestant.is_aided() {
                push_inertial(method.as_mut(), &row);
            }
            let field_ut = if rival.given == Given::System { system_ut } else { Some(row.field_ut) };
            let field_ut = field_ut.filter(|field| field.iter().all(|value| value.is_finite()));
            let answer = field_ut.and_then(|field_ut| {
                method.push(&MagneticSample { time_ns: row.time_ns, field_ut });
                method.latest(&field_ut)
            });
            judge.add(&row, answer.as_ref(), method.sigma_deg());
        }
        for (lines, judge) in &mut entered {
            let answer = lines.as_ref().and_then(|lines| lines.get(k)?.vector());
            judge.add(&row, answer.as_ref(), None);
        }
        if let (Some(magnet), Some((_, Some(ours), _))) = (&mut magnet, running.last()) {
            magnet.add(&row, ours.as_ref());
        }
    }
    let judges = running.iter().map(|(_, _, judge)| judge).chain(entered.iter().map(|(_, judge)| judge));
    let headings = judges.map(|judge| judge.heading(*declination_deg)).collect();
    let course = |name: &str| {
        let judge = running.iter().find(|(rival, ..)| rival.name == name).map(|(.., judge)| judge);
        judge.map_or_else(Course::new, HeadingJudge::course)
    };
    let drawn = judged_s.map(|judged_s| (judged_s, DRAWN.map(course)));
    Ok(Compared {
        group: group.to_owned(),
        recording,
        magnet: magnet.and_then(|it| it.step()),
        headings,
        drawn,
        within_two_sigma: None,
        device_steps: 0,
    })
}

/// The paper's first step: the ellipsoid through all samples of the recording of this name, which lies beside `path`, as (10) is written.
fn first_step(path: &Path, name: &str) -> Result<Calibration, RunError> {
    let folder = path.parent().unwrap_or(Path::new("."));
    let missing = || RunError::Usage(format!("{}: there is no recording {name} beside it", path.display()));
    let file = csv_of(folder, name).ok_or_else(missing)?;
    let mut opened = open(std::slice::from_ref(&file), &ImportOptions::default())?;
    let rows: Vec<Row> = opened.source.rows()?.collect::<Result<_, _>>()?;
    let samples: Vec<Vector3<f64>> = rows.iter().map(|row| row.field_ut).collect();
    let options = FitOptions { residual: Residual::Algebraic, ..FitOptions::default() };
    let refused = |error| RunError::Usage(format!("{}: no calibration: {error}", file.display()));
    fit_ellipsoid(&samples, &options).map(|fit| fit.calibration).map_err(refused)
}

/// What a magnet did, gathered row by row.
struct Magnet {
    on_s: f64,
    off_s: f64,
    /// Without it, before and after; and while it sat there.
    rows: [Vec<Moment>; 2],
}

/// A row's raw field, attitude by the reference, and our hard iron.
struct Moment {
    raw_ut: Vector3<f64>,
    attitude: UnitQuaternion<f64>,
    found_ut: Vector3<f64>,
}

impl Magnet {
    fn new((on_s, off_s): (f64, f64), start_s: f64) -> Self {
        Self { on_s: on_s + start_s, off_s: off_s + start_s, rows: Default::default() }
    }

    fn add(&mut self, row: &Row, ours: &dyn Baseline) {
        let [before_s, after_s] = HAND_S;
        let is_with = (self.on_s + after_s..self.off_s - before_s).contains(&row.time_s);
        let is_without = row.time_s < self.on_s - before_s || row.time_s > self.off_s + after_s;
        if let (Some(attitude), Some(ours), true) = (row.attitude, ours.calibration(), is_with || is_without) {
            let moment = Moment { raw_ut: row.field_ut, attitude, found_ut: *ours.hard_iron_ut() };
            self.rows[usize::from(is_with)].push(moment);
        }
    }

    /// The medians with it less those without.
    fn step(&self) -> Option<MagnetStep> {
        if self.rows.iter().any(|rows| rows.len() < FEWEST_ROWS) {
            return None;
        }
        let without = &self.rows[0];
        let earth_ut = without.iter().map(|it| it.attitude * it.raw_ut).sum::<Vector3<f64>>() / without.len() as f64;
        let step = |of: &dyn Fn(&Moment) -> Vector3<f64>| {
            let [without, with] = self.rows.each_ref().map(|rows| median(rows.iter().map(of).collect()));
            (with - without).into()
        };
        let true_ut = step(&|it| it.raw_ut - it.attitude.inverse() * earth_ut);
        Some(MagnetStep { true_ut, found_ut: step(&|it| it.found_ut) })
    }
}

/// Of each component.
fn median(vectors: Vec<Vector3<f64>>) -> Vector3<f64> {
    Vector3::from_fn(|axis, _| {
        let values = vectors.iter().map(|vector| vector[axis]).collect();
        Summary::of(values, Worse::Large).map_or(f64::NAN, |summary| summary.median)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The raw field as an entry comes to what the raw field does; a row without cells is no answer; too few rows are refused.
    #[test]
    fn an_entry_is_judged_as_the_methods_are() {
        let recordings = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/recordings");
        let name = "broad_36_attached_magnet_5cm";
        let path = recordings.join(format!("{name}.csv.gz"));
        let mut source = open(std::slice::from_ref(&path), &ImportOptions::default()).unwrap().source;
        let rows: Vec<Row> = source.rows().unwrap().map(Result::unwrap).collect();
        let line = |(k, row): (usize, &Row)| {
            let [x, y, z] = row.field_ut.into();
            if k % 2 == 0 { format!("{x},{y},{z}\n") } else { ",,\n".to_owned() }
        };
        let folder = tempfile::tempdir().unwrap();
        let text: String = rows.iter().enumerate().map(line).collect();
        std::fs::write(folder.path().join(format!("{name}.csv")), format!("cx,cy,cz\n{text}")).unwrap();
        let entry: Entry = format!("mine={}", folder.path().display()).parse().unwrap();
        let groups = Groups::of(&recordings, None).unwrap();
        let found = compared(&path, &groups, std::slice::from_ref(&entry)).unwrap();
        let [raw, mine] = [found.headings[0].unwrap(), found.headings.last().unwrap().unwrap()];
        assert!((raw.rms_deg - mine.rms_deg).abs() < 0.1 && (mine.answered - 0.5).abs() < 0.01, "{raw:?} {mine:?}");
        assert!(entry.answers(name, rows.len() + 1).is_err() && entry.answers("other", 1).unwrap().is_none());
        assert!("mine".parse::<Entry>().is_err());
    }

    #[test]
    fn the_systems_field_may_have_empty_cells_but_no_row_may_lack() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("walk_uncal.csv");
        assert_eq!(system_of(&path, 3).unwrap(), []);
        std::fs::write(folder.path().join("walk_oscal.csv"), "t_s,mx,my,mz\n0.0,1,2,3\n0.1,,,\n0.2,4,,5\n").unwrap();
        assert_eq!(system_of(&path, 3).unwrap(), [Some(Vector3::new(1.0, 2.0, 3.0)), None, None]);
        for rows in [2, 4] {
            let why = system_of(&path, rows).unwrap_err().to_string();
            assert!(why.contains(&format!("3 rows for a recording of {rows}")) && why.contains("empty cells"), "{why}");
        }
    }

    use magcomp::nalgebra::Matrix3;

    /// A turning sensor in a field of 50 uT, (1, -2, 30) uT from 50 s to 100 s; our hard iron is 0.5 uT short of that along z.
    #[test]
    fn the_step_of_a_magnet_is_what_the_raw_field_lacks_to_the_earths() {
        struct Ours(Calibration);
        impl Baseline for Ours {
            fn push(&mut self, _: &MagneticSample) {}
            fn correct(&self, _: &Vector3<f64>) -> Option<Vector3<f64>> {
                None
            }
            fn calibration(&self) -> Option<Calibration> {
                Some(self.0)
            }
        }
        let mut magnet = Magnet::new((50.0, 100.0), 10.0);
        for k in 0..6000 {
            let time_s = 10.0 + f64::from(k) / 50.0;
            let attitude = UnitQuaternion::from_euler_angles(0.5 * time_s.sin(), 0.7 * time_s, 0.3 * time_s);
            // the hand is about the sensor: what it reads then counts for nothing
            let is_hand = (52.0..63.0).contains(&time_s) || (102.0..113.0).contains(&time_s);
            let with = f64::from(u8::from((60.0..110.0).contains(&time_s))) + 9.0 * f64::from(u8::from(is_hand));
            let step = Vector3::new(1.0, -2.0, 30.0) * with;
            let field_ut = attitude.inverse() * Vector3::new(0.0, 20.0, -45.0) + step;
            let ours = Calibration::new(Matrix3::identity(), step - Vector3::z() * (0.5 * with), 50.0).unwrap();
            let row =
                Row { time_s, time_ns: (time_s * 1e9) as i64, field_ut, attitude: Some(attitude), ..Row::default() };
            magnet.add(&row, &Ours(ours));
        }
        let MagnetStep { true_ut, found_ut } = magnet.step().unwrap();
        assert!((Vector3::from(true_ut) - Vector3::new(1.0, -2.0, 30.0)).norm() < 1e-9, "{true_ut:?}");
        assert!((Vector3::from(found_ut) - Vector3::new(1.0, -2.0, 29.5)).norm() < 1e-9, "{found_ut:?}");
    }
}
