//! `magcomp crb`.

use crate::experiment::bound::{BoundOptions, SAMPLES, SNR_DB, run};
use crate::parameters::{ParameterSet, TrueParameters};
use clap::{Args, value_parser};
use magcomp_replay::command::{Common, finite};
use magcomp_replay::error::RunError;
use magcomp_replay::report::Report;

/// Fig. 2: error of the ellipsoid fit over the Cramer-Rao bound.
#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
pub(super) struct Crb {
    /// Runs for every N and SNR; the ratios' own error is about 1 / sqrt(6 runs)
    #[arg(long, default_value_t = 400, value_parser = value_parser!(u32).range(1..))]
    runs: u32,
    #[command(flatten)]
    truth: TrueParameters,
    /// Samples P that are averaged at each orientation
    #[arg(long, value_name = "P", default_value_t = 1, value_parser = value_parser!(u32).range(1..=1000))]
    p: u32,
    /// Sample counts N
    #[arg(long, num_args = 1.., value_delimiter = ',', default_values_t = SAMPLES.map(|n| n as u32), value_parser = value_parser!(u32).range(9..=100_000))]
    samples: Vec<u32>,
    /// Signal-to-noise ratios, dB
    #[arg(long, num_args = 1.., value_delimiter = ',', default_values_t = SNR_DB, value_parser = finite)]
    snr: Vec<f64>,
    #[command(flatten)]
    common: Common,
}

impl Crb {
    pub fn run(self) -> Result<(), RunError> {
        let options = BoundOptions {
            truth: self.truth.parameters(ParameterSet::Ref)?,
            runs: self.runs as usize,
            averaged: self.p as usize,
            seed: self.common.seed,
            samples: self.samples.iter().map(|n| *n as usize).collect(),
            snr_db: self.snr,
        };
        let result = run(&options)?;
        self.common.finish(&[result.table()], &result, || {
            Report::new(
                "How close the ellipsoid fit comes to the bound",
                "The paper's fig. 2: root mean square error of the fit over the Cramer-Rao bound, computed from the Fisher \
                 information of h_m = M h + b with the orientations unknown.",
            ).with(|report| result.add_to(report))
        })
    }
}
