//! From an estimator's answer to a reading: heading and attitude with their uncertainties, and what goes on from sample to sample.

use super::Compensator;
use crate::attitude::{self, Attitude};
use crate::config::HeadingConfig;
use crate::estimator::answer::{Answer, KnownNorth};
use crate::heading::{self, Heading, true_heading_deg};
use crate::level::{Level, Tilt};
use crate::math::elementary::hypot;
use crate::pointing::Pointing;
use crate::reading::{Reading, Status};
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::{Matrix3, Vector3};

/// What heading and attitude are formed from.
struct Known {
    /// Of the estimator's own estimate where it has one, else of the corrected sample.
    level: Level,
    covariance_ut2: Option<Matrix3<f64>>,
    tilt: Tilt,
}

impl Known {
    fn of(answer: &Answer, up: Option<Vector3<f64>>, tilt: Tilt) -> Option<Self> {
        let level = Level::of(&answer.filtered_field_ut.or(answer.field_ut)?, &up?)?;
        let covariance_ut2 = answer.filtered_covariance_ut2.or(answer.field_covariance_ut2);
        Some(Self { level, covariance_ut2, tilt })
    }

    /// North alone, as a level field.
    fn to(known: &KnownNorth, at_rest_deg: f64) -> Option<Self> {
        let level = Level::of(&known.north, &known.up)?;
        Some(Self {
            covariance_ut2: Some(level.east * level.east.transpose() * known.variance_rad2),
            tilt: Tilt { sigma_deg: hypot(at_rest_deg, known.tilt_rad2.sqrt().to_degrees()), ..Tilt::default() },
            level,
        })
    }

    fn heading(&self, config: &HeadingConfig) -> Option<Heading> {
        let HeadingConfig { axis, screen_rotation, declination_deg, .. } = *config;
        let found = heading::of_level(&self.level, axis, screen_rotation)?;
        let sigma = |p: Matrix3<f64>| {
            heading::sigma_of_level(&self.level, axis, screen_rotation, self.level.across_rad2(&p), &self.tilt)
        };
        Some(Heading {
            heading_sigma_deg: self.covariance_ut2.and_then(sigma),
            true_heading_deg: declination_deg.map(|it| true_heading_deg(found.heading_deg, it)),
            ..found
        })
    }

    fn attitude(&self) -> Attitude {
        let sigma = |p: Matrix3<f64>| attitude::sigma_of_level(&self.level, self.level.across_rad2(&p), &self.tilt);
        Attitude { sigma_deg: self.covariance_ut2.and_then(sigma), ..attitude::of_level(&self.level) }
    }
}

impl Compensator {
    /// The reading of a sample, and what the heading of any axis is formed of.
    pub(super) fn assemble(&self, time_ns: i64, status: Status, answer: &Answer) -> (Reading, Option<Pointing>) {
        // without a gyroscope nobody else carries the vertical
        let (up, motion_rad2) = match answer.tilt_rad2 {
            Some(tilt_rad2) => (answer.up, tilt_rad2),
            None => (answer.up.and_then(|_| self.state.tilt.up()), self.state.tilt.variance_rad2()),
        };
        let sigma_deg = hypot(self.config.heading.tilt_sigma_deg, motion_rad2.sqrt().to_degrees());
        let by_field = Known::of(answer, up, Tilt { sigma_deg, common_rad2: answer.common_rad2 });
        let by_north = answer.north.and_then(|known| Known::to(&known, self.config.heading.tilt_sigma_deg));
        // with the declination that headings from outside have shown, where none is set
        let declination_deg =
            self.config.heading.declination_deg.or_else(|| Some(self.state.north.declination_deg()?.0));
        let heading = |it: &Known| it.heading(&HeadingConfig { declination_deg, ..self.config.heading });
        let own = by_field.as_ref().and_then(heading);
        let told = by_north.as_ref().and_then(heading);
        // a north from outside knows nothing of the field's dip
        let inclination_deg = own.and_then(|own| own.inclination_deg);
        let heading = told.map(|told| Heading { inclination_deg, ..told }).or(own);
        let known = by_north.or(by_field);
        let pointing =
            known.as_ref().map(|it| Pointing::of(&it.level, it.covariance_ut2.as_ref(), &it.tilt, declination_deg));
        let reading = Reading {
            time_ns,
            field_ut: answer.field_ut,
            field_sigma_ut: answer.field_covariance_ut2.map(|covariance| (covariance.trace().max(0.0) / 3.0).sqrt()),
            filtered_field_ut: answer.filtered_field_ut,
            total_field_ut: answer.field_ut.map(|field| field.norm()),
            heading,
            attitude: known.as_ref().map(Known::attitude),
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
