//! The Earth's field at a place and date, by the World Magnetic Model.

use crate::error::MagcompError;
use crate::guarded::caught;
use world_magnetic_model::time::{Date, OffsetDateTime};
use world_magnetic_model::uom::si::angle::degree;
use world_magnetic_model::uom::si::f32::{Angle, Length};
use world_magnetic_model::uom::si::length::meter;
use world_magnetic_model::uom::si::magnetic_flux_density::microtesla;
use world_magnetic_model::{Error, GeomagneticField as Model};

/// By how much the field across a compass needle changes in a year, uT: the root mean square over the Earth (a test computes it anew).
const CHANGE_UT_PER_YEAR: f64 = 0.04;

const DAYS_PER_YEAR: f64 = 365.25;

/// The Earth's field at a place and date.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Record)]
pub struct GeomagneticField {
    /// From true to magnetic north, degrees, east positive.
    pub declination_deg: f64,
    /// One standard deviation of it, degrees, as the model states it; wider at a date outside the model's years.
    pub declination_sigma_deg: f64,
    /// Below the horizon, degrees, positive when the field points down.
    pub inclination_deg: f64,
    /// Strength, microtesla: what `Config.field_strength_ut` takes.
    pub total_field_ut: f64,
}

/// The Earth's field by the World Magnetic Model.
///
/// Latitude -90 to 90 degrees north, longitude -180 to 180 degrees east, height above the ellipsoid in metres
/// (-1000 to 850000), time in milliseconds since 1970-01-01 UTC. The model serves 2020 to 2029. At any other date the field is that
/// of the nearest day of those years, and the declination's sigma is wider by what the Earth's field changes meanwhile. Fails with
/// `Place` at a place outside the model's range.
#[uniffi::export]
pub fn geomagnetic_field(
    latitude_deg: f64,
    longitude_deg: f64,
    height_m: f64,
    unix_time_ms: i64,
) -> Result<GeomagneticField, MagcompError> {
    let model = caught(|| {
        let at = |date| {
            let angle = |deg| Angle::new::<degree>(deg as f32);
            Model::new(Length::new::<meter>(height_m as f32), angle(latitude_deg), angle(longitude_deg), date)
        };
        let date = day_of(unix_time_ms);
        match at(date) {
            Err(Error::DateOutsideOfValidityRange { min_date, max_date }) => {
                let nearest = date.clamp(min_date, max_date);
                at(nearest).map(|model| (model, (date.to_julian_day() - nearest.to_julian_day()).unsigned_abs()))
            }
            model => model.map(|model| (model, 0)),
        }
    });
    let (model, days_away) = model.map_err(|what| MagcompError::Panicked { what })??;
    let years_away = f64::from(days_away) / DAYS_PER_YEAR;
    let level_ut: f64 = model.h().get::<microtesla>().into();
    let change_deg = (CHANGE_UT_PER_YEAR * years_away).atan2(level_ut).to_degrees();
    let stated_deg: f64 = model.declination_uncertainty().get::<degree>().into();
    Ok(GeomagneticField {
        declination_deg: model.declination().get::<degree>().into(),
        declination_sigma_deg: stated_deg.hypot(change_deg).min(180.0),
        inclination_deg: model.inclination().get::<degree>().into(),
        total_field_ut: model.f().get::<microtesla>().into(),
    })
}

/// The day of a time; the first or last that can be written for one before or after those.
fn day_of(unix_time_ms: i64) -> Date {
    let beyond = if unix_time_ms < 0 { Date::MIN } else { Date::MAX };
    OffsetDateTime::from_unix_timestamp(unix_time_ms.div_euclid(1000)).map_or(beyond, OffsetDateTime::date)
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
    fn a_place_outside_the_model_is_an_error() {
        for (latitude_deg, longitude_deg, height_m) in
            [(91.0, 0.0, 0.0), (f64::NAN, 0.0, 0.0), (0.0, 181.0, 0.0), (0.0, 0.0, 1e7)]
        {
            for time_ms in [MIDYEAR_2025_MS, 0] {
                let field = geomagnetic_field(latitude_deg, longitude_deg, height_m, time_ms);
                assert!(matches!(field, Err(MagcompError::Place { .. })), "{latitude_deg} {longitude_deg}: {field:?}");
            }
        }
    }

    const DAY_MS: i64 = 86_400_000;

    #[test]
    fn outside_its_years_the_field_is_that_of_the_nearest_day_and_less_sure() {
        let paris = |time_ms| geomagnetic_field(48.86, 2.35, 35.0, time_ms).unwrap();
        let [first, last] = [18_262 * DAY_MS, 21_914 * DAY_MS]; // 2020-01-01, 2029-12-31
        let alike = |one: GeomagneticField, other: GeomagneticField| {
            GeomagneticField { declination_sigma_deg: 0.0, ..one }
                == GeomagneticField { declination_sigma_deg: 0.0, ..other }
        };
        for (edge, towards) in [(first, -1), (last, 1)] {
            assert!(!alike(paris(edge), paris(edge - 365 * towards * DAY_MS)), "within its years the field drifts");
            let mut sigma_deg = paris(edge).declination_sigma_deg;
            for years in [1, 5, 20, 55] {
                let away = paris(edge + towards * years * 365 * DAY_MS);
                assert!(alike(away, paris(edge)), "{away:?}");
                assert!(away.declination_sigma_deg > sigma_deg, "{years}: {away:?}");
                sigma_deg = away.declination_sigma_deg;
            }
            // 0.04 uT a year across a level field of 21 uT
            assert!((5.0..8.0).contains(&sigma_deg), "{sigma_deg}");
        }
        for time_ms in [0, i64::MIN, i64::MAX] {
            let field = paris(time_ms);
            assert!(alike(field, paris(if time_ms > 0 { last } else { first })), "{field:?}");
            assert!(field.declination_sigma_deg <= 90.0 + 1.0, "{field:?}");
        }
    }

    #[test]
    fn the_change_of_a_year_is_the_models_own() {
        let (mut sum, mut weights) = (0.0, 0.0);
        for latitude in (-88..=88).step_by(4) {
            for longitude in (-180..180).step_by(5) {
                let across_ut = |days: i64, from: f64| {
                    let at = geomagnetic_field(latitude.into(), longitude.into(), 0.0, days * DAY_MS).unwrap();
                    let level_ut = at.total_field_ut * at.inclination_deg.to_radians().cos();
                    (level_ut * (at.declination_deg - from).to_radians().sin(), at.declination_deg)
                };
                let (_, before) = across_ut(20_089, 0.0); // 2025-01-01
                let (change_ut, _) = across_ut(20_089 + 1461, before);
                let area = f64::from(latitude).to_radians().cos();
                sum += area * (change_ut / 4.0).powi(2);
                weights += area;
            }
        }
        let rms_ut = (sum / weights).sqrt();
        assert!((rms_ut - CHANGE_UT_PER_YEAR).abs() < 0.002, "{rms_ut} uT a year");
    }
}
