//! `magcomp step`.

use super::{Common, finite};
use crate::error::LabError;
use crate::experiment::step::{ResidualChoice, StepOptions, run};
use crate::motion::Motion;
use crate::parameters::ParameterSet;
use crate::report::Report;
use clap::{Args, value_parser};

/// Figs. 4 and 5: all nine parameters step by 50 % and the windowed method follows.
#[derive(Debug, Args)]
pub(super) struct Step {
    /// Runs to average
    #[arg(long, default_value_t = 60, value_parser = value_parser!(u32).range(1..))]
    runs: u32,
    /// Parameters before the step
    #[arg(long, value_enum, default_value_t)]
    set: ParameterSet,
    /// How the device turns
    #[arg(long, value_enum, default_value_t)]
    motion: Motion,
    /// Signal-to-noise ratio, dB
    #[arg(long, default_value_t = 30.0, value_parser = finite)]
    snr: f64,
    /// What the fits minimise
    #[arg(long, value_enum, default_value_t)]
    residual: ResidualChoice,
    #[command(flatten)]
    common: Common,
}

impl Step {
    pub fn run(self) -> Result<(), LabError> {
        let options = StepOptions {
            set: self.set,
            motion: self.motion,
            snr_db: self.snr,
            residual: self.residual,
            runs: self.runs as usize,
            seed: self.common.seed,
        };
        let result = run(&options)?;
        self.common.finish(&result.tables(), &result, || {
            let mut report = Report::new(
                "Following a step of all nine parameters",
                "The paper's figs. 4 and 5: soft and hard iron step by 50 % while the device turns; the windowed method \
                 re-estimates them from the latest samples.",
            );
            result.add_to(&mut report)?;
            Ok(report)
        })
    }
}
