//! A state as text that can be kept:
//! `{"magcomp_snapshot":2,"crc32":"...","library":"0.1.0+...","calibration":"...","state":"..."}`.
//!
//! `calibration` and `state` are postcard (a compact serde format without field names) in hexadecimal digits, so every
//! bit is kept. The form of `calibration` is that of every version so far: a 0, or a 1 and 13 doubles, M row by row, b, |h|.
//! That of `state` is whatever the estimators hold, so only a build of the same sources reads it, which `library` names by
//! version and hash (`build.rs`), and never one of another version. The checksum is over the text that follows it.
//!
//! A right checksum makes no state a good one. No number that is not finite gets in (`Finite`), and types that promise more
//! can't be deserialised without it (`sound`).

#[cfg(test)]
mod tests;

use crate::calibration::Calibration;
use postcard::Deserializer;
use postcard::de_flavors::{Flavor, Slice};
use serde::Serialize;
use serde::de::DeserializeOwned;

/// Version of the format written here.
pub const SNAPSHOT_VERSION: u32 = 2;

/// What was taken over from a snapshot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub enum Restored {
    /// Everything: readings go on as if nothing had happened.
    Everything,
    /// The snapshot holds no more, or has an older version, or was made with another config or by another build of this library:
    /// its calibration was taken over, the rest starts anew.
    CalibrationOnly,
}

/// Why a snapshot can't be used. The compensator it was given to has not changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub enum SnapshotError {
    /// Not a whole snapshot, changed since it was written, or none that a compensator writes.
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
    /// None when another version or build of the library wrote it, or the calibration alone was kept.
    state: Option<&'a str>,
}

const LIBRARY: &str = concat!(env!("CARGO_PKG_VERSION"), "+", env!("MAGCOMP_BUILD"));
const MARK: &str = "{\"magcomp_snapshot\":";

/// A state as text.
pub(crate) fn seal<S: Serialize>(calibration: Option<Calibration>, state: &S) -> String {
    let (calibration, state) = (encode(&calibration), encode(state));
    let body = format!("\"library\":\"{LIBRARY}\",\"calibration\":\"{calibration}\",\"state\":\"{state}\"}}");
    format!("{MARK}{SNAPSHOT_VERSION},\"crc32\":\"{:08x}\",{body}", crc32fast::hash(body.as_bytes()))
}

/// What a text holds.
pub(crate) fn open(text: &str) -> Result<Opened<'_>, SnapshotError> {
    let (found, rest) = text.strip_prefix(MARK).and_then(|rest| rest.split_once(',')).ok_or(SnapshotError::Damaged)?;
    // a newer version may have other fields: only its number is read
    match found.parse() {
        Ok(version @ 1..=SNAPSHOT_VERSION) => opened(version, rest).ok_or(SnapshotError::Damaged),
        Ok(found) if found > SNAPSHOT_VERSION => Err(SnapshotError::Newer { found }),
        _ => Err(SnapshotError::Damaged),
    }
}

fn opened(version: u32, rest: &str) -> Option<Opened<'_>> {
    let (checksum, body) = rest.strip_prefix("\"crc32\":\"")?.split_once("\",")?;
    if checksum != format!("{:08x}", crc32fast::hash(body.as_bytes())) {
        return None;
    }
    let (library, rest) = body.strip_prefix("\"library\":\"")?.split_once("\",\"calibration\":\"")?;
    let (calibration, rest) = rest.split_once("\",\"state\":\"")?;
    let state = rest.strip_suffix("\"}")?;
    let is_ours = (version, library) == (SNAPSHOT_VERSION, LIBRARY) && !state.is_empty();
    Some(Opened { calibration: decode(calibration)?, state: is_ours.then_some(state) })
}

impl Opened<'_> {
    /// The state, where there is one.
    pub fn state<S: DeserializeOwned>(&self) -> Result<Option<S>, SnapshotError> {
        self.state.map(|state| decode(state).ok_or(SnapshotError::Damaged)).transpose()
    }
}

/// Empty only if memory runs out.
fn encode<S: Serialize>(value: &S) -> String {
    hex::encode(postcard::to_allocvec(value).unwrap_or_default())
}

fn decode<S: DeserializeOwned>(digits: &str) -> Option<S> {
    let bytes = hex::decode(digits).ok()?;
    let mut deserializer = Deserializer::from_flavor(Finite(Slice::new(&bytes)));
    let value = S::deserialize(&mut deserializer).ok()?;
    deserializer.finalize().ok()?.is_empty().then_some(value)
}

/// Bytes in which postcard finds no number that is not finite. It takes eight bytes at once for an `f64` and four for an
/// `f32`, and for nothing else that a state holds: integers come byte by byte.
struct Finite<'de>(Slice<'de>);

/// No quantity of a sound state is larger, but for what stands for "not known".
const LARGEST: f64 = 1e30;

impl<'de> Flavor<'de> for Finite<'de> {
    type Remainder = &'de [u8];
    type Source = &'de [u8];

    fn pop(&mut self) -> postcard::Result<u8> {
        self.0.pop()
    }

    fn try_take_n(&mut self, count: usize) -> postcard::Result<&'de [u8]> {
        let bytes = self.0.try_take_n(count)?;
        let number = match (bytes.try_into().map(f64::from_le_bytes), bytes.try_into().map(f32::from_le_bytes)) {
            (Ok(number), _) => number,
            (_, Ok(number)) => f64::from(number),
            _ => return Err(postcard::Error::DeserializeBadEncoding),
        };
        if number.abs() <= LARGEST || number.abs() == f64::MAX {
            return Ok(bytes);
        }
        Err(postcard::Error::DeserializeBadEncoding)
    }

    fn finalize(self) -> postcard::Result<&'de [u8]> {
        self.0.finalize()
    }
}
