//! A change that methods follow: one variant of the catalogue, the answers of some methods side by side, from a cold start.

use super::answers;
use crate::catalogue::{PhoneChange, Variant, phone};
use crate::motion::Motion;
use crate::parallel::{cores, map_shown};
use crate::score::{Begin, Errors, Figures, Line, Runs, Settled, Stretch};
use magcomp::Method;
use magcomp_recordings::recording::Recording;
use magcomp_replay::error::RunError;
use magcomp_replay::{Ignore, Step};
use serde::Serialize;

/// Beside each other.
const METHODS: [Method; 2] = [Method::Aided, Method::Windowed];

/// Options of the experiment.
#[derive(Clone, Debug)]
pub struct FollowOptions {
    pub variant: Variant,
    /// Runs; run k has the seed `seed + k`.
    pub runs: usize,
    /// The first seed.
    pub seed: u64,
}

impl FollowOptions {
    /// The step that belongs to a motion; none where the aided method has nothing to show.
    pub fn of(motion: Motion) -> Option<Self> {
        let change = match motion {
            Motion::Tumble => PhoneChange::Parameters,
            Motion::Walk => PhoneChange::Offset,
            _ => return None,
        };
        let variant = phone("step", motion, change).in_an_even_place();
        Some(Self { variant, runs: 20, seed: 1 })
    }
}

/// One answer of one method: f, or what its calibration makes of the sample without noise.
#[derive(Clone, Debug, Serialize)]
pub struct AnswerResult {
    /// Method and answer.
    pub name: String,
    /// Error over the last 10 s before the change, degrees.
    pub before_deg: Runs,
    /// Seconds after a change until its 95th percentile over the trailing second stays below 5 degrees.
    pub below_5_deg: Runs,
    /// The same for 2 degrees.
    pub below_2_deg: Runs,
    /// |b - true b| 3 s after a change, uT.
    pub hard_iron_ut: Runs,
}

/// One method.
#[derive(Clone, Debug, Serialize)]
pub struct FollowMethod {
    pub method: Method,
    /// Published headings, events, losses.
    pub line: Line,
    /// From a change to the status suspect or disturbed, s.
    pub alarm_s: Runs,
    /// Largest error of f, or of the calibration, from a change on, degrees.
    pub worst_deg: Runs,
}

/// The experiment as numbers.
#[derive(Clone, Debug, Serialize)]
pub struct FollowResult {
    pub scenario: String,
    pub runs: usize,
    pub answers: Vec<AnswerResult>,
    pub methods: Vec<FollowMethod>,
    /// The first method in the first run, for the picture.
    #[serde(skip)]
    pub first: Option<(Recording, Vec<Step>)>,
}

pub fn run(options: &FollowOptions) -> Result<FollowResult, RunError> {
    let FollowOptions { variant, runs, seed } = options;
    let jobs: Vec<usize> = (0..runs * METHODS.len()).collect();
    let done = map_shown("step", &jobs, cores(), |k| {
        let (simulation, recording, steps) =
            answers(variant, seed.wrapping_add((k % runs) as u64), METHODS[k / runs], Ignore::default())?;
        let figures = Figures::of(&simulation, &steps);
        Ok::<_, RunError>((figures, (*k == 0).then_some((recording, steps))))
    });
    let mut done: Vec<_> = done.into_iter().collect::<Result<_, _>>()?;
    let first = done.first_mut().and_then(|(_, picture)| picture.take());
    let figures: Vec<Figures> = done.into_iter().map(|(figures, _)| figures).collect();
    let (mut answers, mut results) = (Vec::new(), Vec::new());
    for (method, own) in METHODS.iter().zip(figures.chunks(*runs)) {
        let name = name(*method);
        if *method == Method::Aided {
            answers.push(AnswerResult::of(format!("{name}, f"), own, |it| it.carried_deg, |it| it.main_s));
        }
        answers.push(AnswerResult::of(format!("{name}, c"), own, |it| it.calibration_deg, |it| it.calibration_s));
        let changes = || changed(own);
        results.push(FollowMethod {
            method: *method,
            line: Line::of(own),
            alarm_s: Runs::of(changes().map(|one| one.alarm_s)),
            worst_deg: Runs::of(changes().map(|one| one.worst_deg)),
        });
    }
    Ok(FollowResult { scenario: variant.about.clone(), runs: *runs, answers, methods: results, first })
}

/// The stretches behind a change.
fn changed(runs: &[Figures]) -> impl Iterator<Item = &Stretch> {
    runs.iter().flat_map(|run| &run.stretches).filter(|one| one.begin != Begin::Start)
}

impl AnswerResult {
    fn of(
        name: String,
        runs: &[Figures],
        before: fn(&Errors) -> Option<f64>,
        settled: fn(&Settled) -> [Option<f64>; 2],
    ) -> Self {
        let settled = |limit: usize| changed(runs).map(move |one| settled(&one.settled?)[limit]);
        Self {
            name,
            before_deg: Runs::of(runs.iter().map(|run| before(&run.before))),
            below_5_deg: Runs::of(settled(0)),
            below_2_deg: Runs::of(settled(1)),
            hard_iron_ut: Runs::of(changed(runs).map(|one| one.hard_iron_ut)),
        }
    }
}

pub(super) fn name(method: Method) -> String {
    format!("{method:?}").to_lowercase()
}
