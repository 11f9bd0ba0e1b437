//! Bags of ROS 2 in mcap files: `sensor_msgs/msg/MagneticField` (tesla) and `sensor_msgs/msg/Imu` (rad/s; m/s^2 with Android's sign,
//! as REP 145 has it), timed by the stamps in their headers. Messages are CDR as ROS 2 writes it: 4 bytes of encapsulation, then
//! stamp, `frame_id`, and numbers of 8 bytes aligned to 8. An Imu's own orientation is not read: it is a filter's, no reference.

use super::guard::{guarded, one_line};
use super::mcap_records::Messages;
use super::session::Session;
use super::units::Units;
use crate::error::{Place, RecordingError};
use crate::recording::Content;
use crate::time::MOST_NS;
use magcomp::nalgebra::Vector3;
use std::collections::BTreeSet;
use std::panic::AssertUnwindSafe;
use std::path::{Path, PathBuf};

/// A record in a packed chunk may have this many bytes, whatever the file has.
const UNPACKED_BYTES: u64 = 64 << 20;
const MICROTESLA: f64 = 1e6;
/// What zstd packed begins so.
const ZSTD: &[u8] = b"\x28\xb5\x2f\xfd";
/// Numbers of an Imu before the angular velocity (orientation and its covariance), of a vector with its covariance.
const ORIENTATION: usize = 4 + 9;
const VECTOR: usize = 3 + 9;

/// Reads bags as one session; of `topics` alone where some are named.
///
/// A bag that is cut off, as one of a robot that was switched off, or damaged gives what is before that place, with a warning.
pub(super) fn read_bags(
    mut bags: Vec<(PathBuf, Content)>,
    topics: &[String],
    units: &Units,
) -> Result<Session, RecordingError> {
    let first = bags[0].0.clone();
    let mut bag = Bag::default();
    let field = units.field.unwrap_or(MICROTESLA);
    let (rate, acceleration) = (units.rate.unwrap_or(1.0), units.acceleration.unwrap_or(1.0));
    for (path, content) in &mut bags {
        // a length beyond the file's end is damage; records in packed chunks may be longer than a small file
        let most_bytes = content.bytes().map_err(RecordingError::read(path))?.max(UNPACKED_BYTES);
        let mut messages = Messages::new(content, most_bytes);
        for number in 1.. {
            let next = guarded(AssertUnwindSafe(|| messages.next())).unwrap_or_else(|damaged| Err(damaged.into()));
            let message = match next {
                Ok(None) => break,
                Ok(Some(message)) => message,
                Err(why) => {
                    bag.damaged.push(RecordingError::read(path)(one_line(why)));
                    break;
                }
            };
            let topic = &message.channel.topic;
            let Some(kind) = Kind::of(&message.channel.schema) else { continue };
            if !topics.is_empty() && !topics.contains(topic) {
                continue;
            }
            bag.topics[kind as usize].insert(topic.clone());
            let place = || Place { path: path.clone(), line: number, column: None };
            let numbers = match kind {
                Kind::Field => VECTOR,
                Kind::Imu => ORIENTATION + 2 * VECTOR,
            };
            let Some((stamp_ns, values)) = decode(&message.data, numbers) else {
                let encoding = &message.channel.encoding;
                let expected = format!("a CDR message of {} with its covariances", kind.name());
                let why = if message.data.starts_with(ZSTD) {
                    "messages that are packed one by one; `ros2 bag convert` unpacks them"
                } else {
                    "record with ROS 2 itself"
                };
                return Err(RecordingError::Form {
                    place: Place { column: Some((1, topic.clone())), ..place() },
                    expected,
                    found: format!("{} bytes of encoding '{encoding}'; {why}", message.data.len()),
                });
            };
            // a driver that leaves the stamp empty: the time of the record
            let logged_ns = i64::try_from(message.log_time).ok().filter(|time_ns| *time_ns < MOST_NS);
            let Some(time_ns) = (if stamp_ns == 0 { logged_ns } else { Some(stamp_ns) }) else {
                return Err(RecordingError::Form {
                    place: Place { column: Some((1, format!("{topic} log_time"))), ..place() },
                    expected: "a time within 146 years of 1970".to_owned(),
                    found: format!("{} ns", message.log_time),
                });
            };
            bag.unstamped += usize::from(stamp_ns == 0);
            let vector = |at: usize| Vector3::from_column_slice(&values[at..at + 3]);
            let places = |name: &str| {
                let column = |name: &str| Place { column: Some((1, format!("{topic} {name}"))), ..place() };
                [column("header.stamp"), column(name)]
            };
            let session = &mut bag.session;
            match kind {
                Kind::Field => session.raw.add(time_ns, vector(0) * field, || places("magnetic_field"))?,
                Kind::Imu => {
                    session.rate.add(time_ns, vector(ORIENTATION) * rate, || places("angular_velocity"))?;
                    let up = vector(ORIENTATION + VECTOR) * acceleration;
                    session.up.add(time_ns, up, || places("linear_acceleration"))?;
                }
            }
        }
    }
    bag.finish(&first)
}

#[derive(Clone, Copy)]
enum Kind {
    Field,
    Imu,
}

impl Kind {
    fn of(schema: &str) -> Option<Self> {
        [Self::Field, Self::Imu].into_iter().find(|kind| kind.name() == schema)
    }

    fn name(self) -> &'static str {
        match self {
            Self::Field => "sensor_msgs/msg/MagneticField",
            Self::Imu => "sensor_msgs/msg/Imu",
        }
    }
}

#[derive(Default)]
struct Bag {
    session: Session,
    topics: [BTreeSet<String>; 2],
    unstamped: usize,
    /// Why reading a bag ended before its end.
    damaged: Vec<RecordingError>,
}

impl Bag {
    fn finish(self, path: &Path) -> Result<Session, RecordingError> {
        for (kind, topics) in [Kind::Field, Kind::Imu].into_iter().zip(&self.topics) {
            if topics.len() > 1 {
                let names: Vec<&str> = topics.iter().map(String::as_str).collect();
                let why = format!("{} is on {}; name one by --topics", kind.name(), names.join(" and "));
                return Err(RecordingError::Usage(format!("{}: {why}", path.display())));
            }
        }
        let mut session = self.session;
        for why in self.damaged {
            if session.raw.events.is_empty() {
                return Err(why);
            }
            session.warnings.push(format!("{why}; what is before that place was taken"));
        }
        if self.unstamped > 0 {
            session
                .notes
                .push(format!("{} messages had no stamp: the time they were recorded is theirs", self.unstamped));
        }
        session.notes.push("axes are the bag's; of a robot (x forward, y left, z up) give --frame=-y,x,z".to_owned());
        Ok(session)
    }
}

/// The stamp, ns, and so many numbers after the header of a CDR message.
fn decode(data: &[u8], numbers: usize) -> Option<(i64, Vec<f64>)> {
    let little = match data.get(..2)? {
        [0, 1] => true,
        [0, 0] => false,
        _ => return None,
    };
    let body = data.get(4..)?;
    let word = |at: usize| {
        let bytes: [u8; 4] = body.get(at..at + 4)?.try_into().ok()?;
        Some(if little { u32::from_le_bytes(bytes) } else { u32::from_be_bytes(bytes) })
    };
    let (seconds, nanoseconds, length) = (word(0)? as i32, word(4)?, word(8)? as usize);
    let start = 12_usize.checked_add(length)?.checked_next_multiple_of(8)?;
    let number = |k: usize| {
        let bytes: [u8; 8] = body.get(start + 8 * k..start + 8 * k + 8)?.try_into().ok()?;
        Some(if little { f64::from_le_bytes(bytes) } else { f64::from_be_bytes(bytes) })
    };
    // the length of a string may be any number in a damaged file
    body.get(start..)?;
    let values = (0..numbers).map(number).collect::<Option<_>>()?;
    Some((i64::from(seconds) * 1_000_000_000 + i64::from(nanoseconds), values))
}
