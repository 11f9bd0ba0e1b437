//! `replay --explain`: why each reading said what it said, one row for every input row, in order.

use super::output::{cell, vector};
use magcomp::{ChangeHypothesis, EXPLAINED_HYPOTHESES, Event, Explanation, Reading, Status};
use magcomp_recordings::recording::Row;
use std::fmt::Debug;
use std::io::{self, Write};

/// The columns before those of the hypotheses.
const BEFORE: &str = "t_s,status,event,event_onset_s,estimator,phase,tries_both,sample,\
                      innovation_x_ut,innovation_y_ut,innovation_z_ut,expected_x_ut,expected_y_ut,expected_z_ut,\
                      test_ratio,gated_share,compared_turn_deg";
/// Those of a hypothesis; each begins with `hypothesis_` and its number.
const HYPOTHESIS: [&str; 4] = ["kind", "onset_s", "log_odds", "gated_share"];
/// Those after the hypotheses.
const AFTER: &str = "white_ut,local_ut,hard_iron_walk_ut_per_sqrt_s,delay_s,delay_sigma_s,\
                     gyroscope_bias_x_rad_s,gyroscope_bias_y_rad_s,gyroscope_bias_z_rad_s,\
                     gyroscope_bias_sigma_x_rad_s,gyroscope_bias_sigma_y_rad_s,gyroscope_bias_sigma_z_rad_s,\
                     outside,outside_off_deg,outside_expected_deg,outside_north_sigma_deg";

/// The names of the columns, as a line.
pub fn write_explain_header(out: &mut dyn Write) -> io::Result<()> {
    write!(out, "{BEFORE}")?;
    for k in 1..=EXPLAINED_HYPOTHESES {
        HYPOTHESIS.iter().try_for_each(|column| write!(out, ",hypothesis_{k}_{column}"))?;
    }
    writeln!(out, ",{AFTER}")
}

/// The line of a row, its reading and the inside of the compensator after it; `told` is the event of the rows before, and then of this one.
pub fn write_explanation(
    out: &mut dyn Write,
    row: &Row,
    reading: &Reading,
    explanation: &Explanation,
    told: &mut Option<Event>,
) -> io::Result<()> {
    let seconds = |time_ns: i64| row.time_s + time_ns.saturating_sub(row.time_ns) as f64 * 1e-9;
    // a rejected sample changed nothing: what is told of a sample is of one before it
    let is_rejected = matches!(reading.status, Status::Rejected(_));
    // in the first row that tells it: without a gyroscope it is decided by samples before that
    let event = reading.event.filter(|event| *told != Some(*event));
    *told = reading.event;
    write!(
        out,
        "{},{},{}",
        row.time_s,
        reading.status.label(),
        event.map_or_else(String::new, |event| word(event.kind))
    )?;
    cell(out, event.map(|event| seconds(event.since_ns)), 3)?;
    let Explanation { estimator, phase, tries_both, sample, innovation, hypotheses, noise, outside, .. } = explanation;
    let sample = match sample {
        _ if is_rejected => "rejected".to_owned(),
        sample => sample.map_or_else(String::new, word),
    };
    write!(out, ",{},{},{tries_both},{sample}", word(estimator), word(phase))?;
    let innovation = innovation.filter(|_| !is_rejected);
    vector(out, innovation.map(|it| it.innovation_ut), 4)?;
    vector(out, innovation.map(|it| it.expected_ut), 4)?;
    cell(out, innovation.map(|it| it.ratio), 4)?;
    cell(out, explanation.gated_share, 4)?;
    cell(out, explanation.compared_turn_deg, 2)?;
    for hypothesis in hypotheses {
        let Some(ChangeHypothesis { kind, onset_ns, log_odds, gated_share, .. }) = hypothesis else {
            write!(out, "{}", ",".repeat(HYPOTHESIS.len()))?;
            continue;
        };
        write!(out, ",{},{:.3},{log_odds:.2}", word(kind), seconds(*onset_ns))?;
        cell(out, *gated_share, 4)?;
    }
    cell(out, noise.white_ut, 4)?;
    cell(out, noise.local_ut, 4)?;
    cell(out, noise.hard_iron_walk_ut, 4)?;
    cell(out, noise.delay_s, 6)?;
    cell(out, noise.delay_sigma_s, 6)?;
    vector(out, noise.gyroscope_bias_rad_s, 6)?;
    vector(out, noise.gyroscope_bias_sigma_rad_s, 6)?;
    write!(out, ",{}", outside.map_or_else(String::new, |it| word(it.aid)))?;
    for degrees in
        [outside.map(|it| it.off_deg), outside.map(|it| it.expected_deg), outside.map(|it| it.north_sigma_deg)]
    {
        cell(out, degrees, 2)?;
    }
    writeln!(out)
}

/// The name of a variant, `AtRest` as at_rest.
fn word(variant: impl Debug) -> String {
    let mut word = String::new();
    for letter in format!("{variant:?}").chars() {
        if letter.is_uppercase() && !word.is_empty() {
            word.push('_');
        }
        word.extend(letter.to_lowercase());
    }
    word
}
