//! Sensor Logger (Kelvin Choi; iOS and Android): a zip or a folder with one CSV for each sensor, `time` in nanoseconds since 1970,
//! the axes in the order z, y, x. From its pages UNITS.md, COORDINATES.md and CROSSPLATFORM.md
//! (github.com/tszheichoi/awesome-sensor-logger).
//!
//! Of the accelerometer: AccelerometerUncalibrated is in g with Apple's sign on iOS, in m/s^2 on Android and where the setting
//! "Standardise Units & Frames" is on; its size tells which. TotalAcceleration is Android's alone. Gravity is in m/s^2 with the
//! sign of the platform, which Metadata.csv names. Accelerometer lacks gravity and is not used. Location has bearings from true north, with their accuracy.

use super::document::Document;
use super::fix::course;
use super::names::{left_over, sensor_of_stem};
use super::plausible::{BETWEEN_G_AND_M_S2, low_size};
use super::session::Session;
use super::sheet::Sheet;
use super::stream::Stream;
use super::units::{GRAVITY_M_S2, Units};
use crate::error::RecordingError;
use crate::recording::Course;
use magcomp::nalgebra::Vector3;

/// Files of the app that hold a sensor, or something that sounds like one and is not needed.
const FILES: [&str; 8] = [
    "magnetometeruncalibrated",
    "magnetometer",
    "gyroscopeuncalibrated",
    "gyroscope",
    "accelerometeruncalibrated",
    "totalacceleration",
    "accelerometer",
    "gravity",
];

/// Whether a table is of one sensor; all sensors in one table, as the app can export them too, are read by their names.
pub(super) fn is_header(header: &[String]) -> bool {
    let has = |name: &str| header.iter().any(|column| column == name);
    has("time") && has("seconds_elapsed") && left_over(header, |_| false).is_empty()
}

pub(super) fn read(documents: &[Document], units: &Units) -> Result<Session, RecordingError> {
    let mut session = Session { is_time_told: true, ..Session::default() };
    for document in documents.iter().filter(|document| is_header(&Sheet::new(document).header)) {
        let stem = document.stem();
        if sensor_of_stem(&stem).is_some() && !FILES.contains(&stem.as_str()) {
            let names =
                "the app calls its files MagnetometerUncalibrated.csv, Gyroscope.csv, AccelerometerUncalibrated.csv";
            session.leave_out(&stem, format!("{}: {names}; rename it if it is one of them", document.path.display()));
        }
    }
    let find = |stem: &str| documents.iter().find(|document| document.stem() == stem);

    let (mut raw, system) = (find("magnetometeruncalibrated"), find("magnetometer"));
    if raw.is_some_and(|raw| raw.text.is_empty()) && system.is_some() {
        session.optional("magnetometer, uncalibrated", &[raw.take()], stream);
    }
    match (raw, system) {
        (Some(raw), system) => {
            session.raw = stream(raw)?;
            let system = session.optional("the system's field", &[system], stream);
            session.system = system.map(|(_, stream)| stream).unwrap_or_default();
        }
        (None, Some(calibrated)) => {
            session.raw = stream(calibrated)?;
            session.notes.push(
                "the magnetometer is the one that the system calibrates, because MagnetometerUncalibrated was not recorded".to_owned(),
            );
        }
        (None, None) => {}
    }
    let rates = [find("gyroscopeuncalibrated"), find("gyroscope")];
    if let Some((_, rate)) = session.optional("gyroscope", &rates, stream) {
        session.rate = rate;
    }
    let ups = [find("accelerometeruncalibrated"), find("totalacceleration"), find("gravity")];
    match session.optional("accelerometer", &ups, stream) {
        Some((which, up)) => {
            let factor = match (units.acceleration, which) {
                (Some(factor), _) => factor,
                (None, 0) if low_size(&up).is_some_and(|size| size < BETWEEN_G_AND_M_S2) => -GRAVITY_M_S2,
                (None, 2) => platform_sign(find("metadata"), &up)?,
                _ => 1.0,
            };
            session.up = up;
            session.up.events.iter_mut().for_each(|(_, up)| *up *= factor);
        }
        None if find("accelerometer").is_some() => session.notes.push(
            "Accelerometer has no gravity in it and was left out; record AccelerometerUncalibrated, TotalAcceleration or Gravity"
                .to_owned(),
        ),
        None => {}
    }
    if let Some(location) = find("location") {
        if let Some([latitude, longitude, altitude]) = first_fix(location) {
            session.stand_at(latitude, longitude, altitude);
        }
        match courses(location) {
            Ok((course, without)) => (session.course, session.without_course) = (course, without),
            Err(why) => session.leave_out("location", why),
        }
    }
    Ok(session)
}

/// The courses of a Location.csv, and how many fixes have none: all of them where it has no bearing or no speed.
fn courses(document: &Document) -> Result<(Stream<Course>, usize), RecordingError> {
    let (sheet, mut courses, mut without) = (Sheet::new(document), Stream::default(), 0);
    let (Some(time), Some(bearing), Some(speed)) =
        (sheet.column("time"), sheet.column("bearing"), sheet.column("speed"))
    else {
        sheet.rows(|_| {
            without += 1;
            Ok(())
        })?;
        return Ok((courses, without));
    };
    let accuracy = sheet.column("bearingAccuracy");
    sheet.rows(|cells| {
        let known = |column: usize| cells.number(column).unwrap_or(f64::NAN);
        let found = course(known(bearing), accuracy.map_or(f64::NAN, known), known(speed));
        without += usize::from(found.is_none());
        if let Some(course) = found {
            courses.add(cells.time_ns(time, 1)?, course, || [cells.place(time), cells.place(bearing)])?;
        }
        Ok(())
    })?;
    Ok((courses, without))
}

/// Latitude and longitude, degrees, and height, m, of the first fix; not a number where it is not known.
fn first_fix(document: &Document) -> Option<[f64; 3]> {
    let sheet = Sheet::new(document);
    let cells = sheet.first_row()?;
    let known = |name: &str| sheet.column(name).and_then(|column| cells.number(column).ok()).unwrap_or(f64::NAN);
    Some([known("latitude"), known("longitude"), known("altitude")])
}

fn stream(document: &Document) -> Result<Stream<Vector3<f64>>, RecordingError> {
    let sheet = Sheet::new(document);
    let time = sheet.required("time")?;
    let axes = [sheet.required("x")?, sheet.required("y")?, sheet.required("z")?];
    sheet.stream(time, axes, |cells| cells.time_ns(time, 1))
}

/// 1 for Android's sign of gravity, -1 for Apple's.
fn platform_sign(metadata: Option<&Document>, gravity: &Stream<Vector3<f64>>) -> Result<f64, RecordingError> {
    let cell = |name: &str| {
        let sheet = Sheet::new(metadata?);
        let column = sheet.column(name)?;
        Some(sheet.first_row()?.text(column).to_lowercase())
    };
    let standardised = cell("standardisation").is_some_and(|text| text == "true");
    match cell("platform").as_deref() {
        Some("android") => Ok(1.0),
        Some("ios") => Ok(if standardised { 1.0 } else { -1.0 }),
        _ => Err(RecordingError::Usage(format!(
            "{}: the sign of gravity depends on the platform, and no Metadata.csv names it; add that file, or say --units a=m/s2 \
             for Android, a=-m/s2 for iOS",
            gravity.first.as_ref().map_or_else(String::new, |[place, _]| place.path.display().to_string())
        ))),
    }
}
