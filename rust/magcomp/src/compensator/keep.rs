//! The whole state as text, and back: what a snapshot holds, and when it is taken over.

use super::{Compensator, Inputs};
use crate::calibration::Calibration;
use crate::config::Config;
use crate::estimator::adaptive::Adaptive;
use crate::estimator::aided::{Aided, AidedConfig};
use crate::estimator::paper::WindowedState;
use crate::heading::HeadingConfig;
use crate::sensing::pairing::InertialPairing;
use crate::snapshot::{Restored, SnapshotError, open, seal};
use serde::{Deserialize, Serialize};

/// What a snapshot holds besides the calibration.
#[derive(Debug, Serialize, Deserialize)]
struct State {
    config: Config,
    inputs: Inputs,
    pairing: InertialPairing,
    aided: Aided,
    adaptive: Box<Adaptive>,
    windowed: WindowedState,
}

impl State {
    /// Whether its parts belong together and to a config; each is sound by itself, or it would not be here.
    fn is_sound(&self, config: &Config) -> bool {
        let latest = self.inputs.latest;
        latest.is_none_or(|latest| latest.field_ut.amax() <= config.range_ut)
            && self.pairing.belongs_to(latest.map(|latest| latest.time_ns))
            && self.aided.belongs_to(&Aided::new(AidedConfig::default(), config.field_strength_ut))
            && self.adaptive.belongs_to(config.field_strength_ut)
    }
}

impl Compensator {
    /// The config without how headings are reported, which is no part of what was learned.
    fn made_with(&self) -> Config {
        Config { heading: HeadingConfig::default(), ..self.config.clone() }
    }

    /// The whole state as text with a version and a checksum. A compensator with the same config that restores it gives
    /// bit-identical readings from there on.
    #[must_use]
    pub fn snapshot(&self) -> String {
        let state = State {
            config: self.made_with(),
            inputs: self.inputs,
            pairing: self.pairing.clone(),
            aided: self.aided.clone(),
            adaptive: self.adaptive.clone(),
            windowed: self.windowed.state(),
        };
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
        if let Some(state) = kept.state::<State>()?.filter(|state| state.config == config) {
            let sound = state.is_sound(&config);
            let windowed = Self::windowed(&config).resume(state.windowed, config.range_ut).filter(|_| sound);
            self.windowed = windowed.ok_or(SnapshotError::Damaged)?;
            (self.aided, self.adaptive, self.pairing, self.inputs) =
                (state.aided, state.adaptive, state.pairing, state.inputs);
            return Ok(Restored::Everything);
        }
        self.begin_with(kept.calibration);
        Ok(Restored::CalibrationOnly)
    }

    /// Takes over a snapshot's calibration, if it has one, and all else starts anew, the clock too: for the next launch
    /// of an app, or of a device whose clock begins at 0 again.
    ///
    /// # Errors
    /// [`SnapshotError`] when it is damaged or from a newer version; nothing has changed then.
    pub fn restore_calibration(&mut self, snapshot: &str) -> Result<(), SnapshotError> {
        self.begin_with(open(snapshot)?.calibration);
        Ok(())
    }

    pub(super) fn begin_with(&mut self, calibration: Option<Calibration>) {
        self.reset();
        if let Some(calibration) = calibration {
            self.adopt(calibration);
        }
    }
}
