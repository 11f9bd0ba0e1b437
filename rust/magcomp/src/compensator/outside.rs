//! What something else than the phone's own sensors knows: headings and orientations from outside.

use super::Compensator;
use crate::math::elementary::atan2;
use crate::reading::HeadingAid;
use crate::sample::{AttitudeSample, HeadedAxis, HeadingSample, Yaw, seconds};
use crate::sensing::pairing::{EventRejection, MAX_LEAD_S};
use nalgebra::Vector3;

impl Compensator {
    /// A heading from outside: a GNSS course, a landmark. It is used at the magnetometer sample that follows it in time, or comes up to 5 s late.
    ///
    /// North is carried by the gyroscope from one to the next; without a gyroscope they are not used. One that contradicts what is known is
    /// ignored ([`Self::heading_aid`]), unless others say the same for a minute. `filtered_field_ut`, heading and attitude go by it; the calibration
    /// and `field_ut` do not.
    ///
    /// # Errors
    /// [`EventRejection`] says why it was not taken; nothing has changed then.
    pub fn push_heading(&mut self, sample: HeadingSample) -> Result<(), EventRejection> {
        self.state.north.push(sample, self.state.stream.latest_ns())
    }

    /// An orientation from outside: a camera's pose. While the gyroscope is missing its turns stand in for it; where its world's y axis points
    /// north it is a heading too, of the device's most horizontal axis, as of [`Self::push_heading`].
    ///
    /// # Errors
    /// [`EventRejection`] says why it was not taken; nothing has changed then.
    pub fn push_attitude(&mut self, sample: AttitudeSample) -> Result<(), EventRejection> {
        let AttitudeSample { time_ns, to_world, yaw } = sample;
        if !to_world.coords.iter().all(|it| it.is_finite()) {
            return Err(EventRejection::NotFinite);
        }
        if self.state.stream.latest_ns().is_some_and(|latest| seconds(latest, time_ns) > MAX_LEAD_S) {
            return Err(EventRejection::Ahead);
        }
        self.state.stand_in.check(time_ns)?;
        if let Yaw::Absolute { sigma_deg, reference } = yaw {
            let axis = Vector3::ith((to_world.inverse() * Vector3::z()).iamin(), 1.0);
            let pointing = to_world * axis;
            let heading_deg = atan2(pointing.x, pointing.y).to_degrees();
            let axis = HeadedAxis::Device(axis);
            self.push_heading(HeadingSample { time_ns, heading_deg, sigma_deg, reference, axis })?;
        }
        if self.tuning.stand_in {
            self.state.stand_in.take(time_ns, to_world, &mut self.state.pairing);
        }
        Ok(())
    }

    /// What headings from outside are worth after the latest sample. None where none came in the last two minutes.
    #[must_use]
    pub fn heading_aid(&self) -> Option<HeadingAid> {
        self.state.north.aid(self.state.stream.latest_ns()?)
    }

    /// The declination that true headings from outside have shown, degrees, east positive, and its standard deviation. None before the first,
    /// and while `HeadingConfig::declination_deg` is set.
    #[must_use]
    pub fn found_declination_deg(&self) -> Option<(f64, f64)> {
        self.state.north.declination_deg().filter(|_| self.config.heading.declination_deg.is_none())
    }
}
