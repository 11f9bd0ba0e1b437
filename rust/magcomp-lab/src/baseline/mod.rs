//! Methods to compare with: one small file each, behind one trait, and the list of all with the number that is tuned.

mod algebraic;
mod enclosing;
mod fusion;
mod helmholtz;
mod kalman;
mod method;
mod network;
mod ours;
mod turns;
mod vqf;
mod window;
mod xio;

pub use fusion::Fusion;
pub use helmholtz::Helmholtz;
pub use kalman::Kalman;
pub use method::{Baseline, Nothing};
pub use network::Network;
pub use ours::Ours;
pub use turns::Turns;
pub use vqf::Vqf;
pub use window::{Surface, Windowed};
pub use xio::Xio;

use crate::parameters::Parameters;
use clap::ValueEnum;
use magcomp::{Calibration, Config, ConfigError, Method, Normalisation, Residual, WindowedConfig};
use magcomp_replay::command::as_typed;

/// A method by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Contestant {
    /// Ours, from the magnetometer alone
    Adaptive,
    /// The raw sample
    None,
    /// One ellipsoid fit, then kept
    Constant,
    /// The paper's, sigma_T by half ranges, residual as written
    PaperHalfRange,
    /// The paper's, sigma_T 1 for an even sphere, residual as written
    PaperEvenSphere,
    /// The paper's with the corrected residual and our checks, half ranges
    WindowedHalfRange,
    /// The same, even sphere
    WindowedEvenSphere,
    /// Linear ellipsoid fit over a window
    Linear,
    /// Ellipsoid of least volume around a window
    Enclosing,
    /// Sphere through a window
    Sphere,
    /// Extended Kalman filter over nine parameters
    Extended,
    /// Unscented Kalman filter over nine parameters
    Unscented,
    /// Neural network, trained on true directions until the change
    Network,
    /// Calibrated in a Helmholtz coil before, then kept
    Helmholtz,
    /// Ours with gyroscope and accelerometer: its attitude
    Aided,
    /// The same: its corrected sample
    AidedSample,
    /// The orientation filter VQF, given the raw field
    VqfRaw,
    /// VQF, given our corrected sample
    VqfCorrected,
    /// VQF, given the field by a least-squares fit of M and b that uses the gyroscope's turns
    VqfTurns,
    /// The orientation filter Fusion of x-io Technologies, given the raw field
    XioRaw,
    /// A complementary filter that tracks b alone
    Fusion,
}

/// Facts that a method is given before a stream.
#[derive(Clone, Debug)]
pub struct Known {
    /// Names its random numbers.
    pub seed: u64,
    /// Noise of the samples, uT per axis: for those that ask for it.
    pub noise_ut: f64,
    /// Field strength, uT.
    pub field_ut: f64,
    /// Parameters before the change; None for a recording.
    pub parameters: Option<Parameters>,
    /// A calibration from an earlier session, where there is one: for ours and for the paper's.
    pub initial: Option<Calibration>,
    /// True directions will be taught, of the samples before the change or of a recording's first part.
    pub reference: bool,
}

impl Contestant {
    /// Its name on the command line.
    pub fn name(self) -> String {
        as_typed(&self)
    }

    /// The values of its one free number that are tried on other seeds; the first where there is nothing to tune.
    pub fn grid(self) -> &'static [f64] {
        match self {
            Self::Linear | Self::Enclosing | Self::Sphere => &[150.0, 300.0, 600.0, 1200.0, 2000.0],
            Self::Extended | Self::Unscented => &[1e-9, 1e-8, 1e-7, 1e-6, 1e-5, -1e-9, -1e-8, -1e-7, -1e-6, -1e-5],
            Self::PaperHalfRange | Self::PaperEvenSphere | Self::WindowedHalfRange | Self::WindowedEvenSphere => {
                &[0.1, 0.3, 0.5, 0.65]
            }
            Self::Network => &[1e-4, 1e-3, 5e-3],
            Self::VqfRaw | Self::VqfCorrected | Self::VqfTurns => &[3.0, 9.0, 27.0],
            Self::Fusion => &[0.1, 0.3, 1.0],
            _ => &[0.0],
        }
    }

    /// Whether it takes gyroscope and accelerometer too.
    pub fn is_aided(self) -> bool {
        self.gives_attitude() || self == Self::AidedSample
    }

    /// Whether it answers with north by its own attitude, where others answer with a field.
    pub fn gives_attitude(self) -> bool {
        matches!(self, Self::Aided | Self::VqfRaw | Self::VqfCorrected | Self::VqfTurns | Self::XioRaw | Self::Fusion)
    }

    /// A fresh one; None where it cannot take part.
    pub fn make(self, value: f64, known: &Known) -> Result<Option<Box<dyn Baseline>>, ConfigError> {
        let length = value as usize;
        let ours = |config: Config| Ours::new(config).map(|ours| Box::new(ours) as Box<dyn Baseline>);
        let method = |method| Config { method, initial: known.initial, ..Config::default() };
        let windowed = |normalisation, residual| {
            let windowed = WindowedConfig { sigma_th: value, normalisation, residual, ..WindowedConfig::default() };
            Config { windowed, ..method(Method::Windowed) }
        };
        Ok(Some(match self {
            Self::Adaptive => ours(method(Method::Adaptive))?,
            Self::Aided => Box::new(Ours::attitude(method(Method::Auto))?),
            Self::AidedSample => ours(method(Method::Auto))?,
            Self::VqfRaw => Box::new(Vqf::new(value, None)),
            Self::VqfCorrected => Box::new(Vqf::new(value, Some(ours(method(Method::Auto))?))),
            Self::VqfTurns => Box::new(Vqf::new(value, Some(Box::new(Turns::default())))),
            Self::XioRaw => Box::new(Xio::default()),
            Self::Fusion => Box::new(Fusion::new(value)),
            Self::Constant => ours(method(Method::Constant))?,
            Self::PaperHalfRange => ours(windowed(Normalisation::HalfRange, Residual::Algebraic))?,
            Self::PaperEvenSphere => ours(windowed(Normalisation::EvenSphere, Residual::Algebraic))?,
            Self::WindowedHalfRange => ours(windowed(Normalisation::HalfRange, Residual::Corrected))?,
            Self::WindowedEvenSphere => ours(windowed(Normalisation::EvenSphere, Residual::Corrected))?,
            Self::None => Box::new(Nothing),
            Self::Linear => Box::new(Windowed::new(Surface::Linear, length)),
            Self::Enclosing => Box::new(Windowed::new(Surface::Enclosing, length)),
            Self::Sphere => Box::new(Windowed::new(Surface::Sphere, length)),
            Self::Extended => Box::new(Kalman::new(false, value, known.noise_ut)),
            Self::Unscented => Box::new(Kalman::new(true, value, known.noise_ut)),
            Self::Network if known.reference => Box::new(Network::new(value, known.seed)),
            Self::Network => return Ok(None),
            Self::Helmholtz => {
                let Some(parameters) = &known.parameters else { return Ok(None) };
                Box::new(Helmholtz::new(parameters, known.field_ut, known.noise_ut, known.seed))
            }
        }))
    }
}
