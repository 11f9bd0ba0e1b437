//! The tables.

use clap::ValueEnum;
use magcomp_replay::command::as_typed;

/// Variants that are shown in one table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Group {
    /// With gyroscope: nothing happens, a change of the device or the place, a drift, spikes, a poor gyroscope
    Ordinary,
    /// With gyroscope: turned about one axis from a cold start
    OneAxis,
    /// With gyroscope: all sensors pause
    Pause,
    /// Without gyroscope
    Alone,
    /// Carried phones: fields of the Earth at other latitudes
    Latitude,
    /// Carried phones: the device changes, at once, slowly, again and again
    Steps,
    /// Carried phones: other ways to carry them
    Motion,
    /// Carried phones: uneven places, doors, other rooms, cars
    Places,
    /// Carried phones: rates, delays, noise and errors of the sensors
    Sensors,
    /// Carried phones: sensors at fault, an app that reads them wrongly
    Faults,
    /// Carried phones: half an hour
    Long,
    /// Carried phones: a place's field swings while the device goes on as before: a bridge, a tram, mains
    Swinging,
    /// Carried phones: turned and moved fast, in step and not, and swayed gently
    Shaken,
    /// Carried phones: boards with magnets along the way
    Magnets,
    /// Carried phones: changes that go back, and changes in another place
    Back,
    /// Carried phones: a second launch at rest or walking, b as it was or changed since
    Launches,
    /// Carried phones: a field that a logger interpolated or repeated
    Resampled,
    /// Carried phones: sensors of 5 to 25 Hz
    Slow,
    /// Carried phones: axes, signs, units and kinds of samples that an app mistakes
    Conventions,
    /// Carried phones: an accelerometer at fault
    Accelerometer,
    /// Carried phones: a gyroscope at fault, or out of time with the magnetometer
    Gyroscope,
    /// Even orientations and the magnetometer alone, as in the paper's simulation
    Paper,
}

impl Group {
    /// Its name on the command line, with which the names of its newer variants begin.
    pub fn name(self) -> String {
        as_typed(&self)
    }

    /// The table's title.
    pub fn title(self) -> &'static str {
        match self {
            Self::Ordinary => "With gyroscope and accelerometer",
            Self::OneAxis => "Turned about one axis from a cold start, with gyroscope",
            Self::Pause => "All sensors pause at 30 s, walking, with gyroscope",
            Self::Alone => "Magnetometer and accelerometer, no gyroscope",
            Self::Latitude => "Carried phones: latitudes",
            Self::Steps => "Carried phones: the device changes",
            Self::Motion => "Carried phones: motions",
            Self::Places => "Carried phones: places",
            Self::Sensors => "Carried phones: sensors",
            Self::Faults => "Carried phones: sensors at fault",
            Self::Long => "Carried phones: half an hour",
            Self::Swinging => "Carried phones: the place's field swings",
            Self::Shaken => "Carried phones: shaken",
            Self::Magnets => "Carried phones: boards with magnets",
            Self::Back => "Carried phones: changes that go back, and in another place",
            Self::Launches => "Carried phones: the second launch",
            Self::Resampled => "Carried phones: a resampled field",
            Self::Slow => "Carried phones: slow sensors",
            Self::Conventions => "Carried phones: other conventions",
            Self::Accelerometer => "Carried phones: the accelerometer at fault",
            Self::Gyroscope => "Carried phones: the gyroscope at fault",
            Self::Paper => "The paper's simulation, magnetometer alone",
        }
    }
}
