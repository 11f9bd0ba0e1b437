//! A replay as a table.

use super::sentences::{counted, sentences, signed};
use crate::judge::Judgement;
use crate::judge::Kinds;
use crate::statistics::MeanSpread;
use crate::table::{Table, number};

/// The summary of a replay: first what it comes to, in sentences; `recording` is its name.
pub fn table(recording: &str, method: &str, judgement: &Judgement) -> Table {
    let is_system = judgement.total_field_ut.system.is_some();
    let columns: &[&str] =
        if is_system { &["", "raw", "the system's", "corrected"] } else { &["", "raw", "corrected"] };
    let mut table = Table::new(&format!("{recording}, method {method}"), columns);
    table.lead = sentences(judgement);
    let mut lines = Lines { table: &mut table, is_system };
    add_published(&mut lines, judgement);
    add_field(&mut lines, judgement);
    add_heading(&mut lines, judgement);
    if let Some(legs) = judgement.legs {
        let name = format!("heading over {} legs, circular sd, deg", legs.legs);
        let cell = |deg| Some(number(Some(deg), 1));
        lines.add(
            &name,
            Kinds { raw: cell(legs.raw_deviation_deg), system: None, compensated: cell(legs.deviation_deg) },
        );
    }
    add_rest(&mut lines, judgement);
    add_notes(&mut table, judgement);
    table
}

/// The rows of a table in the making.
struct Lines<'a> {
    table: &'a mut Table,
    /// There is a column for the system's field.
    is_system: bool,
}

impl Lines<'_> {
    fn add(&mut self, name: &str, cells: Kinds<String>) {
        let Kinds { raw, system, compensated } = cells;
        let system = self.is_system.then_some(system);
        let cells = std::iter::once(raw).chain(system).chain([compensated]);
        let row = std::iter::once(name.to_owned()).chain(cells.map(Option::unwrap_or_default));
        self.table.row(row.collect());
    }

    fn add_ours(&mut self, name: &str, cell: String) {
        self.add(name, Kinds { compensated: Some(cell), ..Kinds::default() });
    }

    /// Shares of the heading errors within their sigmas, a line each.
    fn add_within(&mut self, whose: &str, shares: Option<[f64; 2]>) {
        for (sigmas, share) in (1..).zip(shares.into_iter().flatten()) {
            let name = format!("heading errors{whose} within {sigmas} sigma, %");
            self.add_ours(&name, number(Some(100.0 * share), 0));
        }
    }
}

fn add_published(lines: &mut Lines, judgement: &Judgement) {
    let known = &judgement.known;
    lines.add_ours("published heading known to 30 deg, % of the time", number(Some(100.0 * known.share), 0));
    lines.add_ours("published heading, sigma, median, deg", number(known.sigma_deg, 1));
    if let Some(published) = judgement.published_heading {
        lines.add_ours("published heading, constant angle taken out, deg", signed(published.constant_deg));
        lines.add_ours("published heading, error rms, deg", number(Some(published.rms_deg), 2));
        lines.add_ours("published heading, error p95, deg", number(Some(published.p95_deg), 2));
        lines.add_within(", published,", published.within_sigma);
    }
}

fn add_field(lines: &mut Lines, judgement: &Judgement) {
    let spread = |figures: Kinds<MeanSpread>| figures.map(|figure| number(Some(figure.spread), 2));
    let mean = |figures: Kinds<MeanSpread>| figures.map(|figure| number(Some(figure.mean), 1));
    lines.add("spread of total field, uT", spread(judgement.total_field_ut));
    lines.add("mean of total field, uT", mean(judgement.total_field_ut));
    if judgement.dip_deg.compensated.is_some() {
        lines.add("spread of dip, deg", spread(judgement.dip_deg));
        lines.add("mean of dip, deg", mean(judgement.dip_deg));
    }
    if let Some(full) = judgement.full_turns {
        let name = format!("swing within {}, rms, deg", counted(full.turns, "full turn"));
        lines.add(&name, full.rms_deg.map(|deg| number(Some(deg), 1)));
    }
}

fn add_heading(lines: &mut Lines, judgement: &Judgement) {
    let Some(heading) = judgement.heading else { return };
    let kinds = Kinds { raw: judgement.raw_heading, system: judgement.system_heading, compensated: Some(heading) };
    lines.add("constant angle taken out, deg", kinds.map(|error| signed(error.constant_deg)));
    lines.add("heading error rms, deg", kinds.map(|error| number(Some(error.rms_deg), 2)));
    lines.add("heading error p95, deg", kinds.map(|error| number(Some(error.p95_deg), 2)));
    lines.add_within("", heading.within_sigma);
    if let Some(carried) = judgement.carried_heading {
        lines.add_ours("heading error rms of f, deg", number(Some(carried.rms_deg), 2));
        lines.add_ours("heading error p95 of f, deg", number(Some(carried.p95_deg), 2));
        lines.add_within(" of f", carried.within_sigma);
    }
}

fn add_rest(lines: &mut Lines, judgement: &Judgement) {
    lines.add_ours("rows", judgement.rows.to_string());
    lines.add_ours("answered, %", number(Some(100.0 * judgement.answered), 1));
    lines.add_ours("first answer after, s", number(judgement.first_s, 2));
    if let Some(disturbance) = judgement.disturbance {
        let percent = |share: Option<f64>| number(share.map(|share| 100.0 * share), 0);
        lines.add_ours("total field off by over 15 %, % of rows", percent(Some(disturbance.share)));
        lines.add_ours("of these rows called disturbed, %", percent(disturbance.recall));
        lines.add_ours("of the rows called disturbed: field off, %", percent(disturbance.precision));
    }
    for event in &judgement.events {
        let when = format!("{:.2}, {:.2}", event.since_s, event.decided_s);
        lines.add_ours(&format!("{} since, decided at, s", event.kind), when);
    }
    for (status, count) in &judgement.status {
        lines.add_ours(&format!("status {status}, rows"), count.to_string());
    }
}

fn add_notes(table: &mut Table, judgement: &Judgement) {
    let (from_s, to_s) = judgement.counted_s;
    table.note(&format!(
        "Spreads, errors and disturbance count from {from_s:.0} to {to_s:.0} s. Spread: standard deviation. Raw and the system's (the field \
         that the operating system calibrated): on the rows that have a corrected sample."
    ));
    if judgement.dip_deg.compensated.is_some() {
        let by = match judgement.heading {
            Some(_) => "the reference's horizon",
            None => "a horizon without the magnetometer: gyroscope and gravity, or gravity alone",
        };
        table.note(&format!("Dip: by {by}; not of the raw field, whose hard iron hides it."));
    }
    if judgement.full_turns.is_some() {
        table.note(
            "Swing: how far the field's azimuth moves while the device turns once about the vertical within a minute, by gyroscope and gravity, \
             less the gyroscope's drift. A hard iron that is left over swings it.",
        );
    }
    if judgement.heading.is_some() {
        table.note(
            "Headings are judged by the reference, up to one constant: the circular median of heading less reference, positive where \
             headings are too far clockwise. Compensated: the corrected sample c. f: the field that the gyroscope carries. Published: the \
             heading of the reading, where its axis is within 60 deg of the horizontal. The first sentence tells the published one.",
        );
    }
}
