//! A replay as a table and as pictures.

use super::Step;
use super::judge::{Judgement, azimuth_deg, centred};
use crate::error::LabError;
use crate::plot::{Colour, Panel, Series, draw};
use crate::recording::Recording;
use crate::report::Report;
use crate::table::{Table, number};

/// The summary of a replay.
#[must_use]
pub fn table(recording: &Recording, method: &str, judgement: &Judgement) -> Table {
    let title = format!("{}, method {method}", recording.name());
    let mut table = Table::new(&title, &["", "raw", "compensated"]);
    let mut line = |name: &str, raw: String, ours: String| table.row(vec![name.to_owned(), raw, ours]);
    line("rows", judgement.rows.to_string(), judgement.rows.to_string());
    line("answered, %", String::new(), number(Some(100.0 * judgement.answered), 1));
    line("first answer after, s", String::new(), number(judgement.first_s, 2));
    line("spread of total field, %", number(judgement.raw_spread_percent, 2), number(judgement.spread_percent, 2));
    if let Some(heading) = judgement.heading {
        let raw = judgement.raw_heading;
        line("heading error rms, deg", number(raw.map(|raw| raw.rms_deg), 2), number(Some(heading.rms_deg), 2));
        line("heading error p95, deg", number(raw.map(|raw| raw.p95_deg), 2), number(Some(heading.p95_deg), 2));
    }
    for (status, count) in &judgement.status {
        line(&format!("status {status}, rows"), String::new(), count.to_string());
    }
    line("push, mean ns", String::new(), number(Some(judgement.mean_push_ns), 0));
    line("push, 99 % below ns", String::new(), judgement.p99_push_ns.to_string());
    let reference =
        if judgement.heading.is_some() { "; heading against the reference, up to one constant" } else { "" };
    table
        .note(&format!("spread: standard deviation over mean, first {:.0} s left out{reference}", judgement.warm_up_s));
    table
}

/// Adds what a number cannot show: total field, heading error, offset, sigma_T and window over time.
///
/// # Errors
/// [`LabError::Plot`].
pub fn figures(report: &mut Report, name: &str, recording: &Recording, steps: &[Step]) -> Result<(), LabError> {
    let start_s = recording.rows.first().map_or(0.0, |row| row.time_s);
    let over_time = |value: &dyn Fn(usize) -> Option<f64>| -> Vec<(f64, f64)> {
        let point = |k: usize| (recording.rows[k].time_s - start_s, value(k).unwrap_or(f64::NAN));
        (0..steps.len()).map(point).collect()
    };
    let panel = |title: &str, y_label: &str, series: Vec<Series>| Panel {
        title: title.to_owned(),
        x_label: "time, s".to_owned(),
        y_label: y_label.to_owned(),
        y_range: None,
        series,
    };
    let corrected = |k: usize| steps[k].reading.field_ut;
    let raw = |k: usize| recording.rows[k].field_ut;

    let mut panels = vec![panel(
        "total field",
        "uT",
        vec![
            Series::new("raw", Colour::Grey, over_time(&|k| Some(raw(k).norm()))),
            Series::new("compensated", Colour::Blue, over_time(&|k| Some(corrected(k)?.norm()))),
        ],
    )];
    if recording.rows.iter().any(|row| row.attitude.is_some()) {
        let errors = |vector: &dyn Fn(usize) -> Option<magcomp::nalgebra::Vector3<f64>>| {
            centred((0..steps.len()).map(|k| azimuth_deg(&recording.rows[k], &vector(k)?)).collect())
        };
        let (before, after) = (errors(&|k| Some(raw(k))), errors(&corrected));
        panels.push(panel(
            "heading error against the reference",
            "deg",
            vec![
                Series::new("raw", Colour::Grey, over_time(&|k| before[k])),
                Series::new("compensated", Colour::Blue, over_time(&|k| after[k])),
            ],
        ));
    }
    let offsets = [("b_x", Colour::Blue), ("b_y", Colour::Orange), ("b_z", Colour::Green)].into_iter().enumerate();
    let offset = |i: usize| over_time(&|k| Some(steps[k].calibration?.hard_iron_ut()[i]));
    panels.push(panel("hard iron", "uT", offsets.map(|(i, (name, c))| Series::new(name, c, offset(i))).collect()));
    panels.push(panel(
        "sigma_T, and window N / 2000",
        "",
        vec![
            Series::new("N / 2000", Colour::Grey, over_time(&|k| Some(steps[k].reading.window as f64 / 2000.0))),
            Series::new("sigma_T", Colour::Blue, over_time(&|k| steps[k].reading.sigma_t)),
        ],
    ));
    let caption = format!("{}: what the sensor said (grey) and what the compensator made of it.", recording.name());
    report.figure(name, draw(&panels, 1, (1100, 260))?, &caption);
    Ok(())
}
