//! A state as text that can be kept: `{"magcomp_snapshot": 1, "crc32": "...", "state": {...}}`.
//!
//! The checksum is over the text of `state`, byte for byte; numbers keep every bit.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

/// Version of the format written here.
pub const SNAPSHOT_VERSION: u32 = 1;

/// What was taken over from a snapshot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Restored {
    /// Everything: readings go on as if nothing had happened.
    Everything,
    /// The snapshot was made with another config: its calibration was taken over, the rest starts anew.
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

#[derive(Serialize, Deserialize)]
struct Sealed<'a> {
    magcomp_snapshot: u32,
    crc32: String,
    #[serde(borrow)]
    state: &'a RawValue,
}

#[derive(Deserialize)]
struct Version {
    magcomp_snapshot: u32,
}

/// A state as text. Empty only if the state can't be written as JSON, which finite numbers can.
pub(crate) fn seal<T: Serialize>(state: &T) -> String {
    let text = serde_json::value::to_raw_value(state).and_then(|state| {
        let crc32 = format!("{:08x}", crc32fast::hash(state.get().as_bytes()));
        serde_json::to_string(&Sealed { magcomp_snapshot: SNAPSHOT_VERSION, crc32, state: &state })
    });
    text.unwrap_or_default()
}

/// The state in a text.
pub(crate) fn open<T: DeserializeOwned>(text: &str) -> Result<T, SnapshotError> {
    // a newer version may have other fields: only its number is read
    let version: Version = serde_json::from_str(text).map_err(|_| SnapshotError::Damaged)?;
    if version.magcomp_snapshot > SNAPSHOT_VERSION {
        return Err(SnapshotError::Newer { found: version.magcomp_snapshot });
    }
    if version.magcomp_snapshot != SNAPSHOT_VERSION {
        return Err(SnapshotError::Damaged);
    }
    let sealed: Sealed = serde_json::from_str(text).map_err(|_| SnapshotError::Damaged)?;
    if sealed.crc32 != format!("{:08x}", crc32fast::hash(sealed.state.get().as_bytes())) {
        return Err(SnapshotError::Damaged);
    }
    serde_json::from_str(sealed.state.get()).map_err(|_| SnapshotError::Damaged)
}
