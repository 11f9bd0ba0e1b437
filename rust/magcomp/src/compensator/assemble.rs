//! From an estimator's answer to a reading: heading and attitude with their uncertainties, and what goes on from sample to sample.

use super::Compensator;
use crate::attitude::Attitude;
use crate::config::HeadingConfig;
use crate::estimator::answer::{Answer, KnownNorth};
use crate::heading::Heading;
use crate::level::{Level, Tilt};
use crate::math::elementary::hypot;
use crate::pointing::{KnownLevel, Pointing};
use crate::reading::{Reading, Status};
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::Vector3;

/// The level frame of the estimator's own estimate where it has one, else of the corrected sample.
fn by_field(answer: &Answer, up: Option<Vector3<f64>>, tilt: Tilt) -> Option<KnownLevel> {
    let level = Level::of(&answer.filtered_field_ut.or(answer.field_ut)?, &up?)?;
    let covariance_ut2 = answer.filtered_covariance_ut2.or(answer.field_covariance_ut2);
    Some(KnownLevel { level, across_rad2: covariance_ut2.map(|it| level.across_rad2(&it)), tilt })
}

/// The same of north alone, as a level field.
fn by_north(known: &KnownNorth, at_rest_deg: f64) -> Option<KnownLevel> {
    let level = Level::of(&known.north, &known.up)?;
    let tilt = Tilt { sigma_deg: hypot(at_rest_deg, known.tilt_rad2.sqrt().to_degrees()), ..Tilt::default() };
    Some(KnownLevel { level, across_rad2: Some(known.variance_rad2), tilt })
}

impl Compensator {
    /// The reading of a sample, and what the heading of any axis is formed of.
    pub(super) fn assemble(&self, time_ns: i64, status: Status, answer: &Answer) -> (Reading, Option<Pointing>) {
        // without a gyroscope nobody else carries the vertical
        let (up, motion_rad2) = match answer.tilt_rad2 {
            Some(tilt_rad2) => (answer.up, tilt_rad2),
            None => (answer.up.and_then(|_| self.state.tilt.up()), self.state.tilt.variance_rad2()),
        };
        let HeadingConfig { axis, screen_rotation, declination_deg, tilt_sigma_deg, .. } = self.config.heading;
        let sigma_deg = hypot(tilt_sigma_deg, motion_rad2.sqrt().to_degrees());
        let by_field = by_field(answer, up, Tilt { sigma_deg, common_rad2: answer.common_rad2 });
        let by_north = answer.north.and_then(|known| by_north(&known, tilt_sigma_deg));
        // with the declination that headings from outside have shown, where none is set
        let declination_deg = declination_deg.or_else(|| Some(self.state.north.declination_deg()?.0));
        let heading = |it: &KnownLevel| it.heading(axis, screen_rotation, declination_deg);
        let own = by_field.as_ref().and_then(heading);
        let told = by_north.as_ref().and_then(heading);
        // a north from outside knows nothing of the field's dip
        let inclination_deg = own.and_then(|own| own.inclination_deg);
        let heading = told.map(|told| Heading { inclination_deg, ..told }).or(own);
        let known = by_north.or(by_field);
        let pointing = known.map(|it| it.pointing(declination_deg));
        let reading = Reading {
            time_ns,
            field_ut: answer.field_ut,
            field_sigma_ut: answer.field_covariance_ut2.map(|covariance| (covariance.trace().max(0.0) / 3.0).sqrt()),
            filtered_field_ut: answer.filtered_field_ut,
            total_field_ut: answer.field_ut.map(|field| field.norm()),
            heading,
            attitude: pointing
                .zip(known)
                .map(|(it, known)| Attitude { to_world: it.to_world, sigma_deg: known.sigma_deg() }),
            sigma_t: answer.sigma_t,
            direction_sigma_deg: answer.direction_sigma_deg,
            worst_sigma_deg: answer.worst_sigma_deg,
            model_order: answer.model_order,
            window: answer.window,
            coverage: self.guidance.coverage.share(),
            mode: answer.mode,
            event: self.state.event,
            status,
        };
        (reading, pointing)
    }
}
