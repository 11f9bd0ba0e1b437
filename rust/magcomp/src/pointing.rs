//! What the heading of any axis is formed of, and its sigma.
//!
//! ```text
//! heading: atan2(a.E, a.N) with the axes E, N, U that `to_world` has; its variance: of `across`, of the tilt, and of what both have in common (`heading`)
//! ```

use crate::attitude::{self, Attitude};
use crate::config::{ReferenceAxis, ScreenRotation};
use crate::heading::{self, Heading, true_heading_deg};
use crate::level::{Level, Tilt};
use nalgebra::{UnitQuaternion, Vector3};

/// How a device lies and how well that is known: what the heading of every axis is formed of, in every rotation of a screen.
///
/// Several screens of one device ask the same reading, each for its own heading.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub struct Pointing {
    /// As that of [`Attitude`].
    pub to_world: UnitQuaternion<f64>,
    /// V / H: what a lean of `up` to east turns north by. The tangent of the field's inclination, negated; 0 where north comes from outside.
    pub lean: f64,
    /// Variance of the turn about `up` that the vector to north has of its own, rad^2; None when the calibration's own uncertainty is not known.
    pub across_rad2: Option<f64>,
    /// Standard deviation of `up` about a horizontal axis, degrees.
    pub tilt_sigma_deg: f64,
    /// What that and the vector to north have in common, rad^2.
    pub common_rad2: f64,
    /// The declination in force, degrees.
    pub declination_deg: Option<f64>,
}

/// The level frame of one sample with what is known of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct KnownLevel {
    pub level: Level,
    pub across_rad2: Option<f64>,
    pub tilt: Tilt,
}

impl KnownLevel {
    pub fn heading(
        &self,
        axis: ReferenceAxis,
        rotation: ScreenRotation,
        declination_deg: Option<f64>,
    ) -> Option<Heading> {
        let found = heading::of_level(&self.level, axis, rotation)?;
        let sigma = |it| heading::sigma_of_level(&self.level, axis, rotation, it, &self.tilt);
        Some(Heading {
            heading_sigma_deg: self.across_rad2.and_then(sigma),
            true_heading_deg: declination_deg.map(|it| true_heading_deg(found.heading_deg, it)),
            ..found
        })
    }

    pub fn sigma_deg(&self) -> Option<f64> {
        attitude::sigma_of_level(&self.level, self.across_rad2?, &self.tilt)
    }

    /// What the heading of every axis is formed of, and the attitude.
    pub fn pointing(&self, declination_deg: Option<f64>) -> Pointing {
        Pointing {
            to_world: attitude::of_level(&self.level).to_world,
            lean: self.level.vertical / self.level.horizontal,
            across_rad2: self.across_rad2,
            tilt_sigma_deg: self.tilt.sigma_deg,
            common_rad2: self.tilt.common_rad2,
            declination_deg,
        }
    }
}

impl Pointing {
    /// The heading of an axis; None where the axis is vertical. The inclination is not of the field where north comes from outside.
    #[must_use]
    pub fn heading(&self, axis: ReferenceAxis, rotation: ScreenRotation) -> Option<Heading> {
        self.known().heading(axis, rotation, self.declination_deg)
    }

    /// How the device lies, as the reading has it.
    #[must_use]
    pub fn attitude(&self) -> Attitude {
        Attitude { to_world: self.to_world, sigma_deg: self.known().sigma_deg() }
    }

    fn known(&self) -> KnownLevel {
        let to_device = self.to_world.inverse();
        let level = Level {
            east: to_device * Vector3::x(),
            north: to_device * Vector3::y(),
            up: to_device * Vector3::z(),
            horizontal: 1.0,
            vertical: self.lean,
        };
        let tilt = Tilt { sigma_deg: self.tilt_sigma_deg, common_rad2: self.common_rad2 };
        KnownLevel { level, across_rad2: self.across_rad2, tilt }
    }
}
