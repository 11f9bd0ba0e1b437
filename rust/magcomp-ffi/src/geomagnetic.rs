//! The Earth's field at a place and date, by the World Magnetic Model.

use crate::error::MagcompError;
use crate::guarded::caught;
use world_magnetic_model::GeomagneticField as Model;
use world_magnetic_model::time::OffsetDateTime;
use world_magnetic_model::uom::si::angle::degree;
use world_magnetic_model::uom::si::f32::{Angle, Length};
use world_magnetic_model::uom::si::length::meter;
use world_magnetic_model::uom::si::magnetic_flux_density::microtesla;

/// The Earth's field at a place and date.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Record)]
pub struct GeomagneticField {
    /// From true to magnetic north, degrees, east positive.
    pub declination_deg: f64,
    /// One standard deviation of it, degrees, as the model states it.
    pub declination_sigma_deg: f64,
    /// Below the horizon, degrees, positive when the field points down.
    pub inclination_deg: f64,
    /// Strength, microtesla: what `Config.field_strength_ut` takes.
    pub total_field_ut: f64,
}

/// The Earth's field by the World Magnetic Model.
///
/// Latitude -90 to 90 degrees north, longitude -180 to 180 degrees east, height above the ellipsoid in metres
/// (-1000 to 850000), time in milliseconds since 1970-01-01 UTC. Fails with `Place` outside the model's range.
#[uniffi::export]
pub fn geomagnetic_field(
    latitude_deg: f64,
    longitude_deg: f64,
    height_m: f64,
    unix_time_ms: i64,
) -> Result<GeomagneticField, MagcompError> {
    let time = OffsetDateTime::from_unix_timestamp(unix_time_ms.div_euclid(1000))
        .map_err(|_| MagcompError::Place { why: format!("{unix_time_ms} ms since 1970 is no date") })?;
    let model = caught(|| {
        Model::new(
            Length::new::<meter>(height_m as f32),
            Angle::new::<degree>(latitude_deg as f32),
            Angle::new::<degree>(longitude_deg as f32),
            time.date(),
        )
    });
    let model = model.map_err(|what| MagcompError::Panicked { what })??;
    Ok(GeomagneticField {
        declination_deg: model.declination().get::<degree>().into(),
        declination_sigma_deg: model.declination_uncertainty().get::<degree>().into(),
        inclination_deg: model.inclination().get::<degree>().into(),
        total_field_ut: model.f().get::<microtesla>().into(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const MIDYEAR_2025_MS: i64 = 1_750_000_000_000;

    /// The signs and units; the model's numbers are the crate's own tests' matter.
    #[test]
    fn the_field_of_paris_and_of_sydney() {
        let paris = geomagnetic_field(48.86, 2.35, 35.0, MIDYEAR_2025_MS).unwrap();
        assert!((0.5..3.0).contains(&paris.declination_deg), "{paris:?}");
        assert!((63.0..65.0).contains(&paris.inclination_deg), "{paris:?}");
        assert!((47.0..50.0).contains(&paris.total_field_ut), "{paris:?}");
        let sydney = geomagnetic_field(-33.87, 151.21, 20.0, MIDYEAR_2025_MS).unwrap();
        assert!((12.0..14.0).contains(&sydney.declination_deg), "{sydney:?}");
        assert!((-66.0..-63.0).contains(&sydney.inclination_deg), "{sydney:?}");
    }

    #[test]
    fn a_place_or_date_outside_the_model_is_an_error() {
        for (latitude_deg, longitude_deg, height_m, time_ms) in [
            (91.0, 0.0, 0.0, MIDYEAR_2025_MS),
            (f64::NAN, 0.0, 0.0, MIDYEAR_2025_MS),
            (0.0, 181.0, 0.0, MIDYEAR_2025_MS),
            (0.0, 0.0, 1e7, MIDYEAR_2025_MS),
            (0.0, 0.0, 0.0, 0),
            (0.0, 0.0, 0.0, i64::MAX),
        ] {
            let field = geomagnetic_field(latitude_deg, longitude_deg, height_m, time_ms);
            assert!(matches!(field, Err(MagcompError::Place { .. })), "{latitude_deg} {longitude_deg}: {field:?}");
        }
    }
}
