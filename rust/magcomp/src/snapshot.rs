//! A state as text that can be kept:
//! `{"magcomp_snapshot":1,"crc32":"...","library":"0.1.0","calibration":"...","state":"..."}`.
//!
//! `calibration` and `state` are postcard (a compact serde format without field names) in hexadecimal digits, so every
//! bit is kept. The form of `calibration` belongs to the version in front. That of `state` is whatever the estimators
//! hold, so only the version of the library that wrote it reads it. The checksum is over the text that follows it.

use crate::calibration::Calibration;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// Version of the format written here.
pub const SNAPSHOT_VERSION: u32 = 1;

/// What was taken over from a snapshot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Restored {
    /// Everything: readings go on as if nothing had happened.
    Everything,
    /// The snapshot holds no more, or was made with another config or by another version of this library: its calibration
    /// was taken over, the rest starts anew.
    CalibrationOnly,
}

/// Why a snapshot can't be used. The compensator it was given to has not changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SnapshotError {
    /// Not a whole snapshot, or changed since it was written.
    #[error("snapshot is damaged; start without it")]
    Damaged,
    /// Written by a newer version.
    #[error("snapshot has version {found}, this library reads up to {SNAPSHOT_VERSION}; update it or start without it")]
    Newer {
        /// Version of the snapshot.
        found: u32,
    },
}

/// A whole, unchanged snapshot.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Opened<'a> {
    pub calibration: Option<Calibration>,
    library: &'a str,
    state: &'a str,
}

const LIBRARY: &str = env!("CARGO_PKG_VERSION");
const MARK: &str = "{\"magcomp_snapshot\":";

/// A state as text.
pub(crate) fn seal<S: Serialize>(calibration: Option<Calibration>, state: &S) -> String {
    let (calibration, state) = (encode(&calibration), encode(state));
    let body = format!("\"library\":\"{LIBRARY}\",\"calibration\":\"{calibration}\",\"state\":\"{state}\"}}");
    format!("{MARK}{SNAPSHOT_VERSION},\"crc32\":\"{:08x}\",{body}", crc32(body.as_bytes()))
}

/// What a text holds.
pub(crate) fn open(text: &str) -> Result<Opened<'_>, SnapshotError> {
    let (found, rest) = text.strip_prefix(MARK).and_then(|rest| rest.split_once(',')).ok_or(SnapshotError::Damaged)?;
    // a newer version may have other fields: only its number is read
    match found.parse() {
        Ok(SNAPSHOT_VERSION) => {}
        Ok(found) if found > SNAPSHOT_VERSION => return Err(SnapshotError::Newer { found }),
        _ => return Err(SnapshotError::Damaged),
    }
    opened(rest).ok_or(SnapshotError::Damaged)
}

fn opened(rest: &str) -> Option<Opened<'_>> {
    let (checksum, body) = rest.strip_prefix("\"crc32\":\"")?.split_once("\",")?;
    if checksum != format!("{:08x}", crc32(body.as_bytes())) {
        return None;
    }
    let (library, rest) = body.strip_prefix("\"library\":\"")?.split_once("\",\"calibration\":\"")?;
    let (calibration, rest) = rest.split_once("\",\"state\":\"")?;
    Some(Opened { calibration: decode(calibration)?, library, state: rest.strip_suffix("\"}")? })
}

impl Opened<'_> {
    /// The state; none when another version of the library wrote it, or the calibration alone was kept.
    pub fn state<S: DeserializeOwned>(&self) -> Result<Option<S>, SnapshotError> {
        if self.library != LIBRARY || self.state.is_empty() {
            return Ok(None);
        }
        decode(self.state).map(Some).ok_or(SnapshotError::Damaged)
    }
}

/// The checksum of zip and PNG: division by the polynomial 0x04c11db7, lowest bit first.
fn crc32(bytes: &[u8]) -> u32 {
    let remainder = bytes.iter().fold(u32::MAX, |remainder, byte| {
        (0..8).fold(remainder ^ u32::from(*byte), |r, _| if r & 1 == 1 { r >> 1 ^ 0xedb8_8320 } else { r >> 1 })
    });
    !remainder
}

const DIGITS: &[u8; 16] = b"0123456789abcdef";

/// Empty only if memory runs out.
fn encode<S: Serialize>(value: &S) -> String {
    let bytes = postcard::to_allocvec(value).unwrap_or_default();
    let digit = |nibble: u8| char::from(DIGITS[usize::from(nibble)]);
    bytes.iter().flat_map(|byte| [digit(byte >> 4), digit(byte & 15)]).collect()
}

fn decode<S: DeserializeOwned>(digits: &str) -> Option<S> {
    let nibble = |digit: &u8| char::from(*digit).to_digit(16).map(|nibble| nibble as u8);
    let (pairs, []) = digits.as_bytes().as_chunks::<2>() else { return None };
    let bytes: Option<Vec<u8>> = pairs.iter().map(|[high, low]| Some(nibble(high)? << 4 | nibble(low)?)).collect();
    match postcard::take_from_bytes(&bytes?) {
        Ok((value, [])) => Some(value),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    #[test]
    fn another_version_of_the_library_reads_the_calibration_alone() {
        let calibration = Calibration::identity(45.0).shifted(Vector3::new(1.0, -2.0, 0.1));
        let ours = seal(Some(calibration), &7_u8);
        assert_eq!(open(&ours).unwrap().state(), Ok(Some(7_u8)));
        let (_, body) = ours.split_once("\"library\"").unwrap();
        let body = format!("\"library\"{body}").replacen(LIBRARY, "0.0.9", 1);
        let theirs = format!("{MARK}1,\"crc32\":\"{:08x}\",{body}", crc32(body.as_bytes()));
        let opened = open(&theirs).unwrap();
        assert_eq!(opened.calibration, Some(calibration));
        assert_eq!(opened.state::<u8>(), Ok(None));
    }

    #[test]
    fn the_checksum_is_that_of_the_catalogue() {
        assert_eq!(crc32(b"123456789"), 0xcbf4_3926);
    }

    #[test]
    fn a_state_that_is_too_long_or_too_short_is_damaged() {
        let text = seal(None, &[1_u16, 2]);
        assert_eq!(open(&text).unwrap().state(), Ok(Some([1_u16, 2])));
        assert_eq!(open(&text).unwrap().state::<[u16; 1]>(), Err(SnapshotError::Damaged));
        assert_eq!(open(&text).unwrap().state::<[u16; 3]>(), Err(SnapshotError::Damaged));
    }
}
