//! The whole state as text, and back: what a snapshot holds, and when it is taken over.

use super::active::Active;
use super::{Compensator, Inputs};
use crate::calibration::Given;
use crate::config::Config;
use crate::estimator::paper::{Clerk, ClerkState};
use crate::heading::HeadingConfig;
use crate::sensing::pairing::InertialPairing;
use crate::snapshot::{Restored, SnapshotError, open, seal};

/// What a snapshot holds besides the calibration.
type State = (Config, Inputs, InertialPairing, Box<Active>, ClerkState);

impl Compensator {
    /// The config without how headings are reported, which is no part of what was learned.
    fn made_with(&self) -> Config {
        Config { heading: HeadingConfig::default(), ..self.config.clone() }
    }

    /// The whole state as text with a version and a checksum. A compensator with the same config that restores it gives
    /// bit-identical readings from there on.
    #[must_use]
    pub fn snapshot(&self) -> String {
        let state = (self.made_with(), &self.inputs, &self.pairing, &self.active, self.clerk.state());
        seal(self.calibration(), &state)
    }

    /// The calibration in force alone, as such a text of a few hundred characters, for [`Self::restore_calibration`]; none
    /// when there is none.
    #[must_use]
    pub fn snapshot_calibration(&self) -> Option<String> {
        self.calibration().map(|calibration| seal(Some(calibration), &()))
    }

    /// Takes over a snapshot: everything when it was made by the same build of this library with the same config,
    /// the heading settings aside; else as [`Self::restore_calibration`].
    ///
    /// # Errors
    /// [`SnapshotError`] when it is damaged or from a newer version; nothing has changed then.
    pub fn restore(&mut self, snapshot: &str) -> Result<Restored, SnapshotError> {
        let kept = open(snapshot)?;
        let config = self.made_with();
        if let Some((_, inputs, pairing, active, state)) = kept.state::<State>()?.filter(|state| state.0 == config) {
            // each is sound by itself, or it would not be here; they must belong together, and to the config
            let sound = inputs.latest.is_none_or(|latest| latest.field_ut.amax() <= config.range_ut)
                && pairing.belongs_to(inputs.latest.map(|latest| latest.time_ns))
                && active.belongs_to(&config);
            let clerk = Clerk::new(config.windowed, config.field_strength_ut, config.initial);
            let clerk = clerk.resume(state, config.range_ut).filter(|_| sound);
            self.clerk = clerk.ok_or(SnapshotError::Damaged)?;
            (self.inputs, self.pairing, self.active) = (inputs, pairing, active);
            return Ok(Restored::Everything);
        }
        self.begin_with(kept.calibration.map(Given::usual));
        Ok(Restored::CalibrationOnly)
    }

    /// Takes over a snapshot's calibration, if it has one, and all else starts anew, the clock too: for the next launch
    /// of an app, or of a device whose clock begins at 0 again.
    ///
    /// # Errors
    /// [`SnapshotError`] when it is damaged or from a newer version; nothing has changed then.
    pub fn restore_calibration(&mut self, snapshot: &str) -> Result<(), SnapshotError> {
        self.begin_with(open(snapshot)?.calibration.map(Given::usual));
        Ok(())
    }
}
