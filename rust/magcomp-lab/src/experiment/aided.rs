//! The device's own disturbance steps while its owner turns it about or walks: the aided method beside the paper's, on
//! the same streams, from a cold start, each sample answered before the next is seen.
//!
//! Tumbling, all nine parameters step by 50 %; walking, b steps by (20, -15, 10) uT. 60 s, the step after 30 s.

use super::aided_change::{ChangeResult, Noticed};
use super::aided_score::{Answer, MethodResult, Outcome, score};
use super::config;
use super::nees::Nees;
use crate::error::LabError;
use crate::motion::Motion;
use crate::phone::{Phone, PhoneChange};
use crate::progress;
use crate::recording::Recording;
use crate::replay::{Ignore, Step, replay_with};
use crate::simulate::Simulation;
use magcomp::{Compensator, Method};
use serde::Serialize;

/// Options of the experiment.
#[derive(Clone, Copy, Debug)]
pub struct AidedOptions {
    /// The phone; run k uses its seed + k.
    pub phone: Phone,
    /// Runs.
    pub runs: usize,
}

impl AidedOptions {
    /// The step that belongs to a motion; none where the aided method has nothing to show.
    #[must_use]
    pub fn of(motion: Motion) -> Option<Self> {
        let change = match motion {
            Motion::Tumble => PhoneChange::Parameters,
            Motion::Pedestrian => PhoneChange::Offset,
            Motion::Uniform | Motion::Stroll | Motion::Planar | Motion::Still => return None,
        };
        Some(Self { phone: Phone { motion, change, ..Phone::default() }, runs: 20 })
    }
}

/// The experiment as numbers.
#[derive(Clone, Debug, Serialize)]
pub struct AidedResult {
    /// What was run.
    pub scenario: String,
    /// Runs.
    pub runs: usize,
    /// Samples a second.
    pub rate_hz: f64,
    /// f and c of the aided method, c of the windowed.
    pub methods: Vec<MethodResult>,
    /// The aided method's reaction to the change; none where nothing changes at once.
    pub change: Option<ChangeResult>,
    /// The first run, for the picture.
    #[serde(skip)]
    pub first: Option<(Recording, Vec<Step>)>,
}

/// A simulation through a method: its steps, and the NEES of b after each sample where it is known.
///
/// # Errors
/// [`LabError::Config`] when the config is refused.
pub fn follow(
    stream: &Simulation,
    recording: &Recording,
    method: Method,
) -> Result<(Vec<Step>, Vec<Option<f64>>), LabError> {
    let mut nees = Vec::with_capacity(stream.truth.len());
    let steps = replay_with(recording, &config(method), Ignore::default(), |k, compensator: &Compensator| {
        nees.push(Nees::of(compensator, &stream.truth[k]).map(|nees| nees.hard_iron));
    })?;
    Ok((steps, nees))
}

/// Runs the experiment.
///
/// # Errors
/// [`LabError`] when a config is refused.
pub fn run(options: &AidedOptions) -> Result<AidedResult, LabError> {
    let names = ["aided, f", "aided, c", "windowed, c"];
    let mut outcomes: [Vec<Outcome>; 3] = Default::default();
    let mut changes = Vec::new();
    let mut first = None;
    let bar = progress::bar(options.runs, "aided step");
    for k in 0..options.runs {
        let seed = options.phone.seed.wrapping_add(k as u64);
        let scenario = Phone { seed, ..options.phone }.scenario();
        let (stream, earth_ut) = (scenario.run(), scenario.world_ut.start);
        let recording = Recording::of(&stream, "simulated");
        let (aided, nees) = follow(&stream, &recording, Method::Aided)?;
        let (windowed, _) = follow(&stream, &recording, Method::Windowed)?;
        changes.push(Noticed::of(&stream, &aided, earth_ut));
        outcomes[0].push(score(&stream, &aided, &[], Answer::Carried, earth_ut));
        outcomes[1].push(score(&stream, &aided, &nees, Answer::Corrected, earth_ut));
        outcomes[2].push(score(&stream, &windowed, &[], Answer::Corrected, earth_ut));
        first.get_or_insert((recording, aided));
        bar.inc(1);
    }
    bar.finish_and_clear();
    let methods = names.into_iter().zip(&outcomes).map(|(name, runs)| MethodResult::of(name, runs));
    Ok(AidedResult {
        scenario: options.phone.describe(),
        runs: options.runs,
        rate_hz: options.phone.rate_hz,
        methods: methods.collect(),
        change: ChangeResult::of(options.phone.change, &changes),
        first,
    })
}
