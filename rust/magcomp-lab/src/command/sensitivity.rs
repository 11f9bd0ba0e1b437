//! `magcomp sensitivity`.

use crate::error::LabError;
use crate::experiment::sensitivity::{SEEDS, run};
use clap::Args;
use std::io::Write;

/// Every choice of the estimators halved and doubled on a fixed benchmark, as markdown (docs/dev/TUNING.md)
#[derive(Debug, Args)]
pub(super) struct Sensitivity {}

impl Sensitivity {
    pub fn run(self) -> Result<(), LabError> {
        let mut out = std::io::stdout().lock();
        write!(out, "{}", run(SEEDS)?.markdown())?;
        out.flush()?;
        Ok(())
    }
}
