//! `magcomp replay`: one recording. Several: `each`.

mod each;

use super::common::{
    Common, MethodChoice, NormalisationChoice, ResidualChoice, as_typed, between, input, output, refuse_outputs, warn,
    warn_of,
};
use super::import::ImportArguments;
use crate::atomic::AtomicFile;
use crate::error::RunError;
use crate::progress;
use crate::{
    Bearing, Gathering, Ignore, Judgement, Known, Mark, Outcome, Player, Step, Verdict, read_waypoints, session_table,
    usual_part, write_calibration, write_explain_header, write_explanation, write_header, write_row,
};
use clap::{Args, ValueEnum};
use magcomp::nalgebra::Vector3;
use magcomp::{Config, Event, Explanation, HeadedAxis, HeadingConfig, ReferenceAxis, WindowedConfig};
use magcomp_recordings::error::RecordingError;
use magcomp_recordings::import::{ImportOptions, Opened, open};
use magcomp_recordings::place::{Day, EarthField, GeoPoint, earth_field_near};
use magcomp_recordings::recording::{Extent, Row, name_of};
use serde::Serialize;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Rows that are played without reading and writing in between, which would make `push` look slower than it is.
const CHUNK: usize = 4096;

/// Run a recording through the compensator, one row out for every magnetometer sample.
///
/// IN is any input of `magcomp import`, or CSV, gzipped or not, with a header:
/// t_s,mx,my,mz[,ax,ay,az][,gx,gy,gz][,qw,qx,qy,qz] (s; uT; m/s^2, Android's sign; rad/s; reference orientation, device to
/// east-north-up). A row may leave a sensor's cells empty: then each has its own times. sys_mx,sys_my,sys_mz (uT) is the
/// field that the operating system calibrated; course_deg,course_sigma_deg are headings from outside (--course). Other columns are
/// ignored. Out (--output): the corrected sample c, the estimator's own estimate f, the heading, and the parameters in force; until there is
/// a calibration c is empty, b = 0, W = 1.
///
/// The summary begins with what it comes to. Against a reference orientation the heading is judged up to one constant, the circular
/// median of heading less reference, which is told (positive: headings too far clockwise; of the true heading where a declination
/// is known). It is the published heading, on rows after 20 s whose axis is within 60 degrees of the horizontal; "raw" and "the
/// system's" are what those fields would give with the reference's own horizon, on the rows that have a corrected sample.
/// Without a reference: total field and dip, mean and spread (standard deviation), against what the Earth has (--place: there); and how
/// far the field swings within a full turn of at most a minute, by the gyroscope.
#[allow(rustdoc::broken_intra_doc_links, reason = "columns in brackets may be missing; it is the help")]
#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
pub struct Replay {
    /// The recording, or the session of a phone logger as of `magcomp import`
    #[arg(value_name = "IN", required = true, value_parser = input)]
    inputs: Vec<PathBuf>,
    #[command(flatten)]
    import: ImportArguments,
    /// How M and b are estimated
    #[arg(long, value_enum, default_value_t)]
    method: MethodChoice,
    /// Windowed and constant: the residual that the fits minimise
    #[arg(long, value_enum, default_value_t)]
    residual: ResidualChoice,
    /// Windowed: how sigma_T is normalised
    #[arg(long, value_enum, default_value = "half-range")]
    normalisation: NormalisationChoice,
    /// Sensors of the recording to leave out
    #[arg(long, value_enum, value_delimiter = ',')]
    ignore: Vec<Sensor>,
    /// Where one row for every input row is written; without it only the summary is printed
    ///
    /// t_s; cx,cy,cz the corrected sample and fx,fy,fz the carried field, uT; heading_deg, heading_sigma_deg, inclination_deg; sigma_t, window and
    /// coverage (samples and directions that the estimator looks at); status; bx,by,bz the hard iron, uT; w00 to w22 the inverse of M, row by row;
    /// ns, the time of the push in nanoseconds; true_heading_deg where a declination is known. A cell is empty where nothing is known.
    #[arg(long, value_name = "OUT.csv", value_parser = output)]
    output: Option<PathBuf>,
    /// Where it is told for every input row why the reading says what it says: estimator and phase, innovation against its expected size,
    /// hypotheses with onset and log odds, noise levels
    #[arg(long, value_name = "OUT.csv")]
    explain: Option<PathBuf>,
    /// Where the last calibration is written: JSON with M, b, field strength and covariance, which `Calibration` reads
    #[arg(long, value_name = "OUT.json")]
    calibration: Option<PathBuf>,
    /// The magnetometer's full scale, uT: samples with a component at or beyond it are rejected, and counted; without, it is found in motion
    #[arg(long, value_name = "UT", value_parser = |text: &str| between(text, 1.0, 100_000.0))]
    rail: Option<f64>,
    /// The axis whose heading it is
    #[arg(long, value_enum, default_value_t)]
    axis: AxisChoice,
    /// Use the recording's columns course_deg,course_sigma_deg (from true north) as headings from outside; of what they are
    #[arg(long, value_enum, value_name = "OF")]
    course: Option<CourseOf>,
    /// Declination, degrees, east positive: adds the column true_heading_deg
    #[arg(long, value_name = "DEG", value_parser = |text: &str| between(text, -180.0, 180.0), allow_negative_numbers = true, conflicts_with_all = ["place", "date"])]
    declination: Option<f64>,
    /// Take declination, total field and dip of this place (degrees, north and east positive; metres) from the world magnetic model
    #[arg(long, value_name = "LAT,LON[,HEIGHT_M]", allow_hyphen_values = true)]
    place: Option<GeoPoint>,
    /// The date for --place; the recording's own when not given
    #[arg(long, value_name = "YYYY-MM-DD", requires = "place")]
    date: Option<Day>,
    /// Count rows from here on in the figures, s after the first row; 20 s, or half of a shorter recording, when not given
    #[arg(long, value_name = "S", value_parser = |text: &str| between(text, 0.0, 1e9))]
    from: Option<f64>,
    /// Count rows up to here
    #[arg(long, value_name = "S", value_parser = |text: &str| between(text, 0.0, 1e9))]
    to: Option<f64>,
    /// Judge the heading by the legs between surveyed positions: CSV t_s,x_m,y_m (s; m, x right and y up on the map)
    #[arg(long, value_name = "CSV")]
    waypoints: Option<PathBuf>,
    /// What you noted: something was done to the device at so many seconds after the first row; may be given again
    #[arg(long, value_name = "S=WORD")]
    mark: Vec<Mark>,
    /// Where the axis pointed at so many seconds after the first row, degrees from north (true north with --place or --declination); may be given again
    #[arg(long, value_name = "S=DEG")]
    bearing: Vec<Bearing>,
    /// Play it so many times; of each row the least time counts, which other work on the machine does not lengthen
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    passes: u32,
    #[command(flatten)]
    common: Common,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Sensor {
    /// Gyroscope
    Gyro,
    /// Accelerometer
    Accel,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum AxisChoice {
    /// Top edge of the screen
    #[default]
    Top,
    /// Back camera
    Camera,
    /// The horizontal direction between both
    Auto,
}

/// What a course is the heading of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum CourseOf {
    /// Top edge of the device
    Top,
    /// Back camera
    Camera,
    /// A vehicle in which the device lies in a holder
    Vehicle,
}

impl From<CourseOf> for HeadedAxis {
    fn from(it: CourseOf) -> Self {
        match it {
            CourseOf::Top => Self::Device(Vector3::y()),
            CourseOf::Camera => Self::Device(-Vector3::z()),
            CourseOf::Vehicle => Self::Vehicle,
        }
    }
}

impl Replay {
    /// Runs the verb.
    pub fn run(self) -> Result<(), RunError> {
        let import = self.import.clone().into();
        match self.play(&self.inputs, &import) {
            Ok(played) => self.finish(&played),
            Err(RunError::Recording(RecordingError::Several { sessions, why })) => {
                self.replay_each(&import, sessions, why)
            }
            // a stray file among recordings: the table names it
            Err(RunError::Recording(why)) if self.has_folder_of_recordings() => {
                self.replay_each(&import, 0, why.to_string())
            }
            Err(why) => Err(why),
        }
    }

    /// Prints what one recording came to.
    fn finish(&self, outcome: &Outcome) -> Result<(), RunError> {
        let Outcome { tables, verdict, judgement, .. } = outcome;
        let told = Told { verdict, judgement };
        self.common.finish_beside(self.output.as_deref(), tables, &told, || outcome.report())?;
        if verdict.is_wrong {
            let name = self.inputs.first().map_or_else(String::new, |path| name_of(path));
            return Err(RunError::Bad(format!("{name} is bad: {}", verdict.reason())));
        }
        Ok(())
    }

    /// One recording from the first row to the last.
    fn play(&self, sources: &[PathBuf], import: &ImportOptions) -> Result<Outcome, RunError> {
        self.refuse_outputs()?;
        let opened = open(sources, import)?;
        warn(&opened.warnings);
        warn_of(&opened.conventions);
        let (earth, mut notes) = self.earth(&opened)?;
        let Opened { mut source, session, warnings, conventions, .. } = opened;
        let modelled = earth.map(|earth| earth.declination_deg).filter(|deg| deg.is_finite());
        let declination_deg = self.declination.or(modelled);
        let config = self.config(declination_deg)?;
        let waypoints = self.waypoints.as_deref().map(read_waypoints).transpose()?.unwrap_or_default();
        let mut players = self.players(&config)?;
        let (extent, is_drawn) = (*source.extent(), self.common.report.is_some());
        let part = self.part(&extent)?;
        let mut written = Written::create(self, declination_deg.is_some())?;
        let is_explained = self.explain.is_some() || is_drawn;
        let gathering = Gathering::new(&extent, part, config.heading.axis, &waypoints, is_drawn);
        let mut gathering = gathering.noted(&self.mark, &self.bearing);
        let bar = progress::bar(extent.rows, "replay");
        let mut rows = source.rows()?.peekable();
        while rows.peek().is_some() {
            let chunk = rows.by_ref().take(CHUNK).collect::<Result<Vec<Row>, _>>()?;
            let (steps, explanations) = play_chunk(&mut players, &chunk, is_explained);
            for (k, (row, step)) in chunk.iter().zip(&steps).enumerate() {
                written.add(row, step, explanations.get(k))?;
                gathering.add(row, step, explanations.get(k));
            }
            bar.inc(chunk.len() as u64);
        }
        bar.finish_and_clear();
        written.finish()?;
        if let Some(path) = &self.calibration {
            write_calibration(path, players[0].compensator(), &name_of(source.path()), extent.end_s)?;
        }

        let courses = players[0].courses().clone();
        if courses.used > 0 && declination_deg.is_none() {
            let why = "the headings from outside count from true north, and the declination is not known, which widens the sigma";
            notes.push(format!("{why}: --place LAT,LON or --declination DEG"));
        }
        let known = Known { session: session.as_ref().map(session_table), conventions, warnings, notes, courses };
        Ok(gathering.finish(&name_of(source.path()), &as_typed(&self.method), earth, &known))
    }

    fn refuse_outputs(&self) -> Result<(), RunError> {
        let inputs: Vec<&Path> = self.inputs.iter().chain(&self.waypoints).map(PathBuf::as_path).collect();
        let outputs = [("--output", &self.output), ("--explain", &self.explain), ("--calibration", &self.calibration)];
        let outputs: Vec<_> = outputs.into_iter().filter_map(|(name, path)| Some((name, path.as_deref()?))).collect();
        refuse_outputs(&inputs, &outputs, self.common.report.as_deref())
    }

    /// What the Earth has where it was recorded, as far as that is known, and what there is to say of it.
    fn earth(&self, opened: &Opened) -> Result<(Option<EarthField>, Vec<String>), RunError> {
        // a log's own position needs no option; it may be older than the model
        let own = opened.position.filter(|_| self.place.is_none() && self.declination.is_none());
        let mut notes = Vec::new();
        let mut at = |place, day| {
            let (field, told) = earth_field_near(place, day)?;
            warn(told.as_slice());
            notes.extend(told);
            Ok::<_, RecordingError>(field)
        };
        let earth = match (self.place, self.date.or(opened.day)) {
            (Some(place), Some(day)) => Some(at(place, day)?),
            (Some(_), None) => {
                let why = "its times do not say the date that --place needs; add --date YYYY-MM-DD";
                return Err(RunError::Usage(format!("{}: {why}", opened.source.path().display())));
            }
            // a height that the model does not hold ends no replay that asked for no place
            (None, day) => own.zip(day).and_then(|(place, day)| at(place, day).ok()),
        };
        Ok((earth, notes))
    }

    fn config(&self, declination_deg: Option<f64>) -> Result<Config, RunError> {
        let axis = match self.axis {
            AxisChoice::Top => ReferenceAxis::TopEdge,
            AxisChoice::Camera => ReferenceAxis::Camera,
            AxisChoice::Auto => ReferenceAxis::Auto,
        };
        let heading = HeadingConfig { axis, declination_deg, ..HeadingConfig::default() };
        let windowed = WindowedConfig {
            residual: self.residual.into(),
            normalisation: self.normalisation.into(),
            ..WindowedConfig::default()
        };
        let config =
            Config { method: self.method.method(), heading, windowed, rail_ut: self.rail, ..Config::default() };
        config.validate()?;
        Ok(config)
    }

    /// One for each pass.
    fn players(&self, config: &Config) -> Result<Vec<Player>, RunError> {
        let ignore = Ignore {
            gyroscope: self.ignore.contains(&Sensor::Gyro),
            accelerometer: self.ignore.contains(&Sensor::Accel),
        };
        let course_of = self.course.map(HeadedAxis::from);
        (0..self.passes).map(|_| Ok(Player::new(config, ignore)?.aided_by_courses(course_of))).collect()
    }

    /// The part that the figures are of, s after the first row.
    fn part(&self, extent: &Extent) -> Result<Range<f64>, RunError> {
        let usual = usual_part(extent);
        let part = self.from.unwrap_or(usual.start)..self.to.unwrap_or(usual.end);
        let end_s = extent.duration_s();
        if part.start >= part.end.min(end_s) && end_s > 0.0 {
            let to = self.to.map_or_else(String::new, |to| format!(" and --to {to}"));
            let why = format!("leave no row to count: the recording lasts {end_s:.1} s");
            return Err(RunError::Usage(format!("--from {}{to} {why}", part.start)));
        }
        Ok(part)
    }
}

/// Plays rows in every pass: the steps, each with its least time, and where it is asked for why each reading said what it said.
fn play_chunk(players: &mut [Player], chunk: &[Row], is_explained: bool) -> (Vec<Step>, Vec<Explanation>) {
    let (first, others) = players.split_first_mut().expect("there is at least one pass");
    let (mut steps, mut explanations) = (Vec::with_capacity(chunk.len()), Vec::new());
    for row in chunk {
        steps.push(first.play(row));
        if is_explained {
            explanations.push(first.compensator().explain());
        }
    }
    for player in others {
        for (step, row) in steps.iter_mut().zip(chunk) {
            step.push_ns = step.push_ns.min(player.play(row).push_ns);
        }
    }
    (steps, explanations)
}

/// The files with a line for each row, where they are asked for.
struct Written {
    output: Option<AtomicFile>,
    explained: Option<AtomicFile>,
    is_true: bool,
    /// The latest event that was explained.
    told: Option<Event>,
}

impl Written {
    fn create(verb: &Replay, is_true: bool) -> Result<Self, RunError> {
        let create = |path: &Option<PathBuf>| path.as_deref().map(AtomicFile::create).transpose();
        let (mut output, mut explained) = (create(&verb.output)?, create(&verb.explain)?);
        output.iter_mut().try_for_each(|output| output.write(|out| write_header(out, is_true)))?;
        explained.iter_mut().try_for_each(|explained| explained.write(write_explain_header))?;
        Ok(Self { output, explained, is_true, told: None })
    }

    fn add(&mut self, row: &Row, step: &Step, explanation: Option<&Explanation>) -> Result<(), RunError> {
        let Self { output, explained, is_true, told } = self;
        output.iter_mut().try_for_each(|output| output.write(|out| write_row(out, row, step, *is_true)))?;
        let mut both = explained.iter_mut().zip(explanation);
        both.try_for_each(|(file, inside)| file.write(|out| write_explanation(out, row, &step.reading, inside, told)))
    }

    fn finish(self) -> Result<(), RunError> {
        self.output.into_iter().chain(self.explained).try_for_each(AtomicFile::finish)
    }
}

/// What is printed as JSON: the verdict first.
#[derive(Serialize)]
struct Told<'a> {
    verdict: &'a Verdict,
    #[serde(flatten)]
    judgement: &'a Judgement,
}
