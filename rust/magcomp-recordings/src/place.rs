//! The Earth's field at a place on a date, from the world magnetic model.

use crate::error::RecordingError;
use serde::Serialize;
use std::fmt;
use std::str::FromStr;
use world_magnetic_model::GeomagneticField;
use world_magnetic_model::time::{Date, Month, OffsetDateTime};
use world_magnetic_model::uom::si::angle::degree;
use world_magnetic_model::uom::si::f32::{Angle, Length};
use world_magnetic_model::uom::si::length::meter;
use world_magnetic_model::uom::si::magnetic_flux_density::microtesla;

/// `LAT,LON[,HEIGHT_M]`: degrees, north and east positive; metres above the ellipsoid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GeoPoint {
    /// Latitude, degrees, north positive.
    pub latitude_deg: f64,
    /// Longitude, degrees, east positive.
    pub longitude_deg: f64,
    /// Height above the WGS 84 ellipsoid, m.
    pub height_m: f64,
}

impl FromStr for GeoPoint {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let expected = || "expected LAT,LON[,HEIGHT_M] such as 45.19,5.73,200 (degrees, north and east positive)";
        let values: Vec<f64> =
            text.split(',').map(|v| v.trim().parse()).collect::<Result<_, _>>().map_err(|_| expected())?;
        let (latitude_deg, longitude_deg, height_m) = match values[..] {
            [latitude, longitude] => (latitude, longitude, 0.0),
            [latitude, longitude, height] => (latitude, longitude, height),
            _ => return Err(expected().to_owned()),
        };
        if !(latitude_deg.abs() <= 90.0 && longitude_deg.abs() <= 180.0 && height_m.is_finite()) {
            return Err("latitude is -90 to 90, longitude -180 to 180".to_owned());
        }
        Ok(Self { latitude_deg, longitude_deg, height_m })
    }
}

/// `YYYY-MM-DD`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Day(Date);

impl Day {
    /// The day (UTC) of a time, ns since 1970; none where it is not within 2000 to 2100: such a time counts from elsewhere.
    pub fn of_unix_ns(time_ns: i64) -> Option<Self> {
        let date = OffsetDateTime::from_unix_timestamp(time_ns / 1_000_000_000).ok()?.date();
        (2000..2100).contains(&date.year()).then_some(Self(date))
    }
}

impl fmt::Display for Day {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:04}-{:02}-{:02}", self.0.year(), u8::from(self.0.month()), self.0.day())
    }
}

impl FromStr for Day {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts: Vec<&str> = text.split('-').collect();
        let date = match parts[..] {
            [year, month, day] if year.len() == 4 => (|| {
                let month = Month::try_from(month.parse::<u8>().ok()?).ok()?;
                Date::from_calendar_date(year.parse().ok()?, month, day.parse().ok()?).ok()
            })(),
            _ => None,
        };
        date.map(Self).ok_or_else(|| "expected a date as YYYY-MM-DD".to_owned())
    }
}

/// The Earth's field at a place.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct EarthField {
    /// Total field, uT.
    pub total_field_ut: f64,
    /// Angle below the horizon, degrees.
    pub dip_deg: f64,
    /// Declination, degrees, east positive.
    pub declination_deg: f64,
}

/// The Earth's field at a place on a day.
///
/// # Errors
/// [`RecordingError::Declination`] where the model holds no value: dates before 2020 or after 2029, heights far off.
pub fn earth_field(place: GeoPoint, day: Day) -> Result<EarthField, RecordingError> {
    let angle = |deg: f64| Angle::new::<degree>(deg as f32);
    GeomagneticField::new(
        Length::new::<meter>(place.height_m as f32),
        angle(place.latitude_deg),
        angle(place.longitude_deg),
        day.0,
    )
    .map(|field| EarthField {
        total_field_ut: f64::from(field.f().get::<microtesla>()),
        dip_deg: f64::from(field.inclination().get::<degree>()),
        declination_deg: f64::from(field.declination().get::<degree>()),
    })
    .map_err(|error| RecordingError::Declination(format!("{error} ({day}; --date names another day)")))
}

/// The years that the model holds, as dates.
const MODEL: [&str; 2] = ["2020-01-01", "2029-12-31"];

/// As [`earth_field`]; for a day outside of the model's years with total field and dip of the nearest one, which change by 0.3 uT and 0.2 degrees
/// a year at most, and without the declination (not a number). The sentence says so.
///
/// # Errors
/// [`RecordingError::Declination`] where the model holds no value for other reasons: heights far off.
pub fn earth_field_near(place: GeoPoint, day: Day) -> Result<(EarthField, Option<String>), RecordingError> {
    let [first, last] = MODEL.map(|day| day.parse::<Day>().expect("the model's own dates"));
    let nearest = Day(day.0.clamp(first.0, last.0));
    let field = earth_field(place, nearest)?;
    if nearest == day {
        return Ok((field, None));
    }
    let told = format!(
        "the world magnetic model holds {} to {}, and the recording is of {day}: total field and dip are those of {nearest}; there is no declination, \
         and no true heading",
        first.0.year(),
        last.0.year()
    );
    Ok((EarthField { declination_deg: f64::NAN, ..field }, Some(told)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_day_outside_of_the_model_has_the_nearest_years_field() {
        let place: GeoPoint = "45.19,5.73,200".parse().unwrap();
        let of = |day: &str| earth_field_near(place, day.parse().unwrap()).unwrap();
        let nearest = of("2020-01-01");
        assert!(nearest.1.is_none() && nearest.0.declination_deg.is_finite());
        let (before, told) = of("2019-11-24");
        assert_eq!((before.total_field_ut, before.dip_deg), (nearest.0.total_field_ut, nearest.0.dip_deg));
        assert!(before.declination_deg.is_nan() && told.unwrap().contains("those of 2020-01-01"));
        assert!(of("2035-01-01").1.unwrap().contains("those of 2029-12-31") && of("2026-01-01").1.is_none());
    }

    #[test]
    fn agrees_with_noaa() {
        // test values published with WMM2025 (NOAA): 2025.0, 0 km
        let published =
            [("80,0", 1.28, 83.21, 55.179), ("0,120", -0.16, -14.93, 41.064), ("-80,-120", 68.78, -72.00, 54.698)];
        for (place, declination_deg, dip_deg, total_field_ut) in published {
            let found = earth_field(place.parse().unwrap(), "2025-01-01".parse().unwrap()).unwrap();
            assert!((found.declination_deg - declination_deg).abs() < 0.05, "{place}: {found:?}");
            assert!((found.dip_deg - dip_deg).abs() < 0.05, "{place}: {found:?}");
            assert!((found.total_field_ut - total_field_ut).abs() < 0.05, "{place}: {found:?}");
        }
    }

    #[test]
    fn a_day_is_that_of_its_time() {
        // `date -u -d @1795342272`
        assert_eq!(Day::of_unix_ns(1_795_342_272_345_000_000).unwrap().to_string(), "2026-11-22");
        for elsewhere in [0, 86_400_000_000_000, -1, i64::MAX] {
            assert_eq!(Day::of_unix_ns(elsewhere), None);
        }
    }

    #[test]
    fn says_what_it_expected() {
        assert!("45".parse::<GeoPoint>().unwrap_err().contains("LAT,LON"));
        assert!("95,0".parse::<GeoPoint>().is_err() && "nan,0".parse::<GeoPoint>().is_err());
        assert!("2025-13-01".parse::<Day>().is_err() && "25-01-01".parse::<Day>().is_err());
        assert!(earth_field("45,5".parse().unwrap(), "1990-01-01".parse().unwrap()).is_err());
    }
}
