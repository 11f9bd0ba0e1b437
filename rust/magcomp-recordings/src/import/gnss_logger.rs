//! GnssLogger (Google) and loggers of its form: each row begins with the name of its kind, then has `utcTimeMillis,
//! elapsedRealtimeNanos, x, y, z`, and for an uncalibrated sensor the system's estimate of the bias. From LOGGING_FORMAT.md
//! (github.com/google/gps-measurement-tools).
//!
//! A fix is `Fix,Provider,LatitudeDegrees,LongitudeDegrees,AltitudeMeters,SpeedMps,AccuracyMeters,BearingDegrees,UnixTimeMillis,
//! SpeedAccuracyMps,BearingAccuracyDegrees,elapsedRealtimeNanos,...`.
//!
//! The system's calibrated field is `Mag` where it was recorded, else `UncalMag` less its bias.

use super::document::Document;
use super::fix::course;
use super::session::Session;
use super::sheet::Sheet;
use super::typed::Sensors;
use super::units::Kind;
use crate::error::RecordingError;
use crate::recording::Delimiter;

/// Columns of a row: milliseconds since 1970, the time, the value, the bias.
const UNIX_MS: usize = 1;
const TIME: usize = 2;
const VALUE: [usize; 3] = [3, 4, 5];
const BIAS: [usize; 3] = [6, 7, 8];
/// Columns of a fix: latitude and longitude, degrees, and height, m; m/s, degrees, degrees, the time of the sensors' clock.
const FIX_PLACE: [usize; 3] = [2, 3, 4];
const FIX_SPEED: usize = 5;
const FIX_BEARING: usize = 7;
const FIX_ACCURACY: usize = 10;
const FIX_TIME: usize = 11;
/// Rows of sensors that are read.
const KINDS: [&str; 6] = ["UncalMag", "Mag", "UncalGyro", "Gyro", "UncalAccel", "Accel"];

/// Whether some row of the first few hundred kilobytes is of this form.
pub(super) fn is_log(document: &Document) -> bool {
    document.has_row_of(&KINDS, b',')
}

pub(super) fn read(documents: &[Document]) -> Result<Session, RecordingError> {
    let mut sensors = Sensors::default();
    sensors.uncalibrated.is_time_told = true;
    let mut first: Option<&Document> = None;
    for document in documents {
        let sheet = Sheet::of_lines(document, Delimiter::Mark(b','));
        let before = sensors.samples();
        let cut = sheet.lines(|cells| {
            let session = &mut sensors.uncalibrated;
            let kind = cells.text(0);
            if kind == "Fix" {
                let known = |column: usize| cells.number(column).unwrap_or(f64::NAN);
                // an older log has no time of the sensors' clock in its fixes
                let time_ns = cells.time_ns(FIX_TIME, 1).ok();
                let found = course(known(FIX_BEARING), known(FIX_ACCURACY), known(FIX_SPEED)).zip(time_ns);
                session.without_course += usize::from(found.is_none());
                session.stand_at(known(FIX_PLACE[0]), known(FIX_PLACE[1]), known(FIX_PLACE[2]));
                if let Some((course, time_ns)) = found {
                    session.course.add(time_ns, course, || [cells.place(FIX_TIME), cells.place(FIX_BEARING)])?;
                }
                return Ok(());
            }
            if !KINDS.contains(&kind.as_str()) {
                return Ok(());
            }
            let time_ns = cells.time_ns(TIME, 1)?;
            session.start_unix_ns = session.start_unix_ns.or_else(|| cells.time_ns(UNIX_MS, 1_000_000).ok());
            let Some(value) = cells.vector(VALUE)? else { return Ok(()) };
            let sensor = match kind.as_str() {
                "UncalMag" | "Mag" => Kind::Field,
                "UncalGyro" | "Gyro" => Kind::Rate,
                _ => Kind::Up,
            };
            let stream = sensors.stream(sensor, kind.starts_with("Uncal"));
            stream.add(time_ns, value, || [cells.place(TIME), cells.place(VALUE[0])])?;
            if kind == "UncalMag"
                && let Some(bias) = cells.vector(BIAS)?
            {
                sensors.uncalibrated.system.add(time_ns, value - bias, || [cells.place(TIME), cells.place(BIAS[0])])?;
            }
            Ok(())
        })?;
        sensors.uncalibrated.notes.extend(cut);
        if sensors.samples() > before
            && let Some(first) = first.replace(document)
        {
            return Err(RecordingError::several(&first.path, &document.path));
        }
    }
    Ok(sensors.settle())
}
