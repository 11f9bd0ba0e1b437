//! Constant-field calibration as it crosses the border.

use crate::config::FitOptions;
use crate::convert::count;
use crate::error::MagcompError;
use crate::guarded::Guarded;
use crate::record::{Coverage, Fit, Vector3};
use std::sync::Arc;

/// One calibration from a set of orientations: collects them, shows which directions are missing, and fits.
#[derive(uniffi::Object)]
pub struct ConstantField {
    samples_per_orientation: usize,
    session: Guarded<magcomp::ConstantField>,
}

#[uniffi::export]
impl ConstantField {
    /// A session that averages `samples_per_orientation` samples in a row (at least 1) into one orientation. Above 1
    /// the device must be held still meanwhile; 1 is for a device that is turned about.
    #[uniffi::constructor]
    pub fn new(samples_per_orientation: i32) -> Arc<Self> {
        let samples_per_orientation = usize::try_from(samples_per_orientation).unwrap_or(1);
        let session = Guarded::new(magcomp::ConstantField::new(samples_per_orientation));
        Arc::new(Self { samples_per_orientation, session })
    }

    /// One raw sample, microtesla, device frame. Fails with `Rejected` when it is not finite or a component
    /// is beyond +-100 000; nothing has changed then.
    pub fn add(&self, raw_ut: Vector3) -> Result<(), MagcompError> {
        self.session.with(|session| Ok(session.add(&raw_ut.into())?))
    }

    /// Orientations so far.
    pub fn orientations(&self) -> Result<i32, MagcompError> {
        self.session.with(|session| Ok(count(session.orientations())))
    }

    /// Which directions were seen and which were not, about the best centre known so far. Costs a fit.
    pub fn coverage(&self) -> Result<Coverage, MagcompError> {
        self.session.with(|session| Ok((&session.coverage()).into()))
    }

    /// The calibration with its covariance. Fails with `Fit`, which says what is missing; the session can go on.
    pub fn finish(&self, options: Option<FitOptions>) -> Result<Fit, MagcompError> {
        let options = options.map_or(Ok(magcomp::FitOptions::default()), TryInto::try_into)?;
        self.session.with(|session| Ok((&session.finish(&options)?).into()))
    }

    /// Forgets the orientations, and makes it usable again after `Panicked`.
    pub fn reset(&self) -> Result<(), MagcompError> {
        self.session.replace(|| Ok(magcomp::ConstantField::new(self.samples_per_orientation)))
    }

    /// Frees the native state now; from then on every call fails with `Closed`. May be called twice.
    pub fn shut_down(&self) {
        self.session.shut_down();
    }
}
