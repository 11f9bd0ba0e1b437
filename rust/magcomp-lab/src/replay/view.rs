//! A replay as a table.

use super::judge::Judgement;
use crate::table::{Table, number};

/// The summary of a replay; `recording` is its name.
#[must_use]
pub fn table(recording: &str, method: &str, judgement: &Judgement) -> Table {
    let title = format!("{recording}, method {method}");
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
        within(&mut line, "", heading.within_sigma);
        if let Some(carried) = judgement.carried_heading {
            line("heading error rms of f, deg", String::new(), number(Some(carried.rms_deg), 2));
            line("heading error p95 of f, deg", String::new(), number(Some(carried.p95_deg), 2));
            within(&mut line, " of f", carried.within_sigma);
        }
        if let Some(published) = judgement.published_heading {
            line("published heading, error rms, deg", String::new(), number(Some(published.rms_deg), 2));
            line("published heading, error p95, deg", String::new(), number(Some(published.p95_deg), 2));
            within(&mut line, ", published,", published.within_sigma);
        }
    }
    if let Some(legs) = judgement.legs {
        let name = format!("heading over {} legs, circular sd, deg", legs.legs);
        line(&name, number(Some(legs.raw_deviation_deg), 1), number(Some(legs.deviation_deg), 1));
    }
    if let Some(disturbance) = judgement.disturbance {
        let percent = |share: Option<f64>| number(share.map(|share| 100.0 * share), 0);
        line("total field off by over 15 %, % of rows", String::new(), percent(Some(disturbance.share)));
        line("of these rows called disturbed, %", String::new(), percent(disturbance.recall));
        line("of the rows called disturbed: field off, %", String::new(), percent(disturbance.precision));
    }
    for event in &judgement.events {
        let when = format!("{:.2}, {:.2}", event.since_s, event.decided_s);
        line(&format!("{} since, decided at, s", event.kind), String::new(), when);
    }
    for (status, count) in &judgement.status {
        line(&format!("status {status}, rows"), String::new(), count.to_string());
    }
    line("push, mean ns", String::new(), number(Some(judgement.mean_push_ns), 0));
    line("push, 99.9 % below ns", String::new(), judgement.p999_push_ns.to_string());
    line("push, longest ns", String::new(), judgement.max_push_ns.to_string());
    let reference = if judgement.heading.is_some() {
        " Headings are judged by the reference, up to one constant. Compensated: the corrected sample c. f: the field that the gyroscope carries. Published: the heading of the reading."
    } else {
        ""
    };
    let (from_s, to_s) = judgement.counted_s;
    // beside raw and ours, where it was recorded
    if let Some(spread_percent) = judgement.system_spread_percent {
        table.columns.insert(2, "the system's".to_owned());
        let heading = judgement.system_heading;
        for row in &mut table.rows {
            let cell = match row[0].as_str() {
                "spread of total field, %" => number(Some(spread_percent), 2),
                "heading error rms, deg" => number(heading.map(|heading| heading.rms_deg), 2),
                "heading error p95, deg" => number(heading.map(|heading| heading.p95_deg), 2),
                _ => String::new(),
            };
            row.insert(2, cell);
        }
        table.note("The system's: the field that the operating system calibrated, on the rows that ours answered.");
    }
    table.note(&format!("Errors, spread and disturbance count from {from_s:.0} to {to_s:.0} s. Spread: standard deviation over mean.{reference}"));
    table
}

/// Shares of the heading errors within their sigmas, a line each.
fn within(line: &mut impl FnMut(&str, String, String), whose: &str, shares: Option<[f64; 2]>) {
    for (sigmas, share) in (1..).zip(shares.into_iter().flatten()) {
        let name = format!("heading errors{whose} within {sigmas} sigma, %");
        line(&name, String::new(), number(Some(100.0 * share), 0));
    }
}
