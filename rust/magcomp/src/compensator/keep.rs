//! Calibrations from elsewhere, and the one that is kept for the next launch.

use super::Compensator;
use super::adopted::Adopted;
use crate::calibration::Given;
use crate::config::Config;
use crate::kept::{CalibrationSource, KeptCalibration};
use crate::range::{ConfigError, in_range};
use crate::sample::MagneticSample;
use crate::sensing::tilt::calm;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::Vector3;

impl Compensator {
    /// From now on this calibration is in force, until something better is learned. The stream goes on.
    ///
    /// One that was kept has aged by `unix_time_s` (seconds since 1970, by the clock that [`Self::keep`] was told), less the time it was kept
    /// at: the older, the likelier the device has changed since. `None`: not known, so of one that was learned as good as nothing is
    /// believed beforehand. The first sample that comes with a vertical is judged by: a total field or a dip that is not as it was widens the
    /// hard iron's uncertainty or moves it, up to a start from nothing. The status is never `Tracking` before live samples of a turned
    /// device agree. The windowed methods have no prior: their readings have no sigma before their own fit.
    ///
    /// A calibration of the operating system replaces nothing that was learned. Beside one of another source that no live sample has confirmed
    /// the first such is one more measurement of the hard iron.
    pub fn adopt(&mut self, kept: &KeptCalibration, unix_time_s: Option<i64>) {
        let belief = &mut self.state.belief;
        if kept.source() == CalibrationSource::System {
            if belief.has_learned {
                return;
            }
            if let Some(adopted) = &mut belief.adopted {
                if adopted.hear(kept) {
                    self.begin_as_believed();
                }
                return;
            }
        }
        let given = Given { calibration: *kept.calibration(), covariance: *kept.covariance() };
        (belief.adopted, belief.has_learned) = (Some(Adopted::new(kept, unix_time_s)), false);
        belief.adopted_sigma_ut = Some(given.hard_iron_ut2().sqrt());
        self.begin_from(Some(given));
    }

    /// The calibration in force with what is known of it, to be kept for the next launch; `unix_time_s` is now, seconds since 1970. `None`
    /// while nothing was learned from live samples: what was adopted is kept where it came from.
    #[must_use]
    pub fn keep(&self, unix_time_s: i64) -> Option<KeptCalibration> {
        let Given { calibration, covariance } = self.estimator.in_force().filter(|_| self.state.belief.has_learned)?;
        KeptCalibration::learned(calibration, covariance, self.state.belief.inclination_deg, unix_time_s)
    }

    /// Time passed that the clock of the samples does not show, about so many seconds: the system slept. The device may have been turned,
    /// carried off or changed: the calibration is as unsure from here on as one that was kept for so long, and where the field points is
    /// found anew. The samples' time goes on.
    ///
    /// # Errors
    /// [`ConfigError`] when `hidden_s` is not a time of up to 1e9 s; nothing has changed then.
    pub fn push_gap(&mut self, hidden_s: f64) -> Result<(), ConfigError> {
        in_range("hidden_s", hidden_s, 0.0..=1e9, "s")?;
        self.state.presence.pause();
        self.state.pairing.pause();
        self.state.stand_in.pause();
        self.state.witnesses.pause();
        self.state.north.pause();
        if let Some(kept) = self.keep(0) {
            self.state.belief.adopted = Some(Adopted::new(&kept, Some(hidden_s as i64)));
            self.begin_from(self.estimator.in_force());
        }
        Ok(())
    }

    /// The calibration of the config.
    pub(super) fn adopt_initial(&mut self) {
        let Config { initial: Some(calibration), initial_sigma_ut, .. } = self.config else { return };
        // its sigma is that of a validated config
        if let Ok(kept) = KeptCalibration::given(calibration, initial_sigma_ut) {
            self.adopt(&kept, None);
        }
    }

    /// What live samples say of an adopted calibration, before anything is learned.
    pub(super) fn judge_adopted(&mut self, sample: &MagneticSample, up_m_s2: Option<Vector3<f64>>) {
        let Some(adopted) = &mut self.state.belief.adopted else { return };
        if adopted.see(sample, up_m_s2.and_then(|up| calm(&up)).as_ref()) {
            self.begin_as_believed();
        }
    }

    fn begin_as_believed(&mut self) {
        let believed = self.state.belief.adopted.as_ref().and_then(Adopted::believed);
        self.begin_from(believed);
    }

    fn begin_from(&mut self, given: Option<Given>) {
        self.estimator.begin_from(given);
        let counted = self.estimator.counted();
        self.guidance.look_through(counted.through, counted.samples);
    }

    /// All begins anew, but for the calibration in force. Not inlined: a state is large, and a sample hardly ever needs another.
    #[inline(never)]
    pub(super) fn begin_another_clock(&mut self) {
        let belief = self.state.belief;
        let given = self.estimator.in_force().map(|given| belief.no_surer_than_usual(given));
        self.reset();
        self.state.belief = belief;
        self.begin_from(given);
    }
}
