//! The comparison as tables, the medians of all groups, what a magnet did, then each group; and as a picture for each group.

use super::figures::Worse;
use super::rivals::{Compared, Comparison, DRAWN, MagnetStep, OURS};
use super::score::{GroupScore, Summary};
use crate::experiment::put_on::{Drawn, Heading, picture};
use magcomp::nalgebra::Vector3;
use magcomp_replay::error::RunError;
use magcomp_replay::plot::{Colour, DotRow, Dots};
use magcomp_replay::report::Report;
use magcomp_replay::table::{Table, number};
use std::fmt::Write as _;

impl Comparison {
    /// The medians, where there is more than one group; magnets that were put on sensors, where there are any; then a table a group.
    pub fn tables(&self) -> Vec<Table> {
        let mut tables: Vec<Table> = self.medians().into_iter().chain(self.magnets()).collect();
        tables.extend(self.ours.iter().map(|ours| self.group(ours)));
        if let Some(last) = tables.last_mut() {
            last.note(
                "Rms of the heading error in degrees: median / nine of ten are not worse / worst recording. Up to one constant: the \
                 constant angle between the frames of reference and sensor is taken out. Against north: magnetic, by the reference. Rows from 20 s on. A field's heading is levelled by the reference, so that its own error \
                 alone is judged; x-io, VQF and magcomp level by themselves. Each method but the calibrated ones starts cold, and answers each sample before it sees the next. Windows, \
                 the paper's threshold (0.5) and VQF's time constant (9 s, its default) are the same everywhere. A calibration of that day, which is the paper's first step: \
                 an ellipsoid through a recording of the same device in a constant field, where the index names one. A fit with the gyroscope's turns: \
                 least squares of M and b, 60 s of memory.",
            );
        }
        tables
    }

    /// Adds the pictures and the tables to a report.
    pub fn add_to(&self, report: &mut Report) -> Result<(), RunError> {
        for (k, ours) in self.ours.iter().enumerate() {
            let own: Vec<&Compared> = self.of_group(ours);
            let row = |method: usize| {
                let name = self.methods[method].clone();
                let colour = if name.starts_with("magcomp") { Colour::Blue } else { Colour::Orange };
                DotRow {
                    name,
                    values: own.iter().filter_map(|it| Some(it.headings[method]?.rms_deg)).collect(),
                    colour,
                }
            };
            let rows = self.taking_part(own.iter().copied()).into_iter().map(row).collect();
            let x_label = "heading error, rms up to one constant, deg";
            let dots = Dots::new(&ours.group, "a recording", x_label, rows, true);
            report.figure(
                &format!("group{}", k + 1),
                dots.draw()?,
                &format!("{}: heading errors of each method", ours.group),
            );
        }
        self.tables().iter().for_each(|table| report.table(table));
        let mut put_on = self.recordings.iter().filter(|it| it.drawn.is_some()).peekable();
        if put_on.peek().is_none() {
            return Ok(());
        }
        report.folded("Each recording over time", |report| {
            put_on.try_for_each(|it| {
                let Some(svg) = self.picture(it)? else { return Ok(()) };
                let caption = format!(
                    "{}: heading error of each second about the constant before the magnet; its rms from then on stands beside the name. The \
                     band is two sigmas wide on both sides. Larger errors than 60 degrees are drawn there.",
                    it.recording
                );
                report.figure(&format!("over_time_{}", it.recording), svg, &caption);
                Ok(())
            })
        })
    }

    /// The headings over time where rows are judged from a moment on.
    fn picture(&self, it: &Compared) -> Result<Option<String>, RunError> {
        let Some((judged_s, courses)) = &it.drawn else { return Ok(None) };
        let drawn = DRAWN.into_iter().zip(courses).filter_map(|(name, course)| {
            let method = self.methods.iter().position(|method| method == name)?;
            let rms = number(Some(it.headings[method]?.rms_deg), 1);
            let (name, colour) = match name {
                "the system's field" => ("phone's calibrated field", Colour::Grey),
                "VQF on the system's field" => ("VQF on that", Colour::Orange),
                _ => ("magcomp", Colour::Blue),
            };
            Some(Drawn { name: format!("{name} {rms}"), colour, course })
        });
        let drawn: Vec<Drawn<'_>> = drawn.collect();
        picture(&drawn, &[(*judged_s, "a magnet is put on")]).map(Some)
    }

    /// Every recording's figures as CSV, docs/data/comparison.csv: a line for each method that answered. The last four columns are of
    /// magcomp's heading alone: the step of the hard iron where a magnet was put on, how far from it the found one is, errors within two
    /// sigmas, changes of the device that were declared.
    pub fn csv(&self) -> String {
        let mut out = "group,recording,method,rms_deg,north_rms_deg,answered_percent,step_ut,step_off_ut,within_2_sigma_percent,device_changes\n".to_owned();
        for it in &self.recordings {
            for (method, heading) in self.methods.iter().zip(&it.headings) {
                let Some(heading) = heading else { continue };
                let cell = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.1}"));
                let own = (method == OURS).then(|| {
                    let step = it.magnet.map(|step| [step.true_ut, step.found_ut].map(Vector3::from));
                    let step = [step.map(|[real, _]| real.norm()), step.map(|[real, found]| (found - real).norm())];
                    let within = cell(it.within_two_sigma.map(|share| 100.0 * share));
                    format!("{},{},{within},{}", cell(step[0]), cell(step[1]), it.device_steps)
                });
                let _ = writeln!(
                    out,
                    "\"{}\",{},\"{method}\",{:.1},{:.1},{:.1},{}",
                    it.group,
                    it.recording,
                    heading.rms_deg,
                    heading.absolute_deg,
                    100.0 * heading.answered,
                    own.as_deref().unwrap_or(",,,")
                );
            }
        }
        out
    }

    fn of_group(&self, ours: &GroupScore) -> Vec<&Compared> {
        self.recordings.iter().filter(|it| it.group == ours.group).collect()
    }

    fn medians(&self) -> Option<Table> {
        if self.ours.len() < 2 {
            return None;
        }
        let columns: Vec<&str> =
            std::iter::once("method").chain(self.ours.iter().map(|it| it.group.as_str())).collect();
        let mut table = Table::new("Median heading error up to one constant, degrees", &columns);
        let median = |ours: &GroupScore, k: usize| {
            let values = self.of_group(ours).iter().filter_map(|it| Some(it.headings[k]?.rms_deg)).collect();
            Summary::of(values, Worse::Large).map(|it| number(Some(it.median), 1))
        };
        let kept = self.taking_part(self.recordings.iter());
        let cells: Vec<Vec<Option<String>>> =
            kept.iter().map(|k| self.ours.iter().map(|ours| median(ours, *k)).collect()).collect();
        let least = |column: usize| {
            let values = cells.iter().filter_map(|row| row[column].as_ref()?.parse::<f64>().ok());
            number(Some(values.fold(f64::INFINITY, f64::min)), 1)
        };
        for (k, row) in kept.iter().zip(&cells) {
            let shown = row.iter().enumerate().map(|(column, cell)| match cell {
                Some(cell) if *cell == least(column) => format!("*{cell}"),
                Some(cell) => cell.clone(),
                None => "-".to_owned(),
            });
            table.row(std::iter::once(self.methods[*k].clone()).chain(shown).collect());
        }
        table.note("*: the best. -: it did not take part, or answered too seldom.");
        Some(table)
    }

    fn magnets(&self) -> Option<Table> {
        let magnets: Vec<(&Compared, MagnetStep)> =
            self.recordings.iter().filter_map(|it| Some((it, it.magnet?))).collect();
        (!magnets.is_empty()).then(|| {
            let columns = ["recording", "true step, uT", "found, uT", "off, uT"];
            let columns: Vec<&str> = columns.into_iter().chain(self.methods.iter().map(String::as_str)).collect();
            let kept = self.taking_part(magnets.iter().map(|(it, _)| *it));
            let mut table = Table::new("A magnet is put on a sensor and taken off again", &[]);
            table.columns = columns.iter().take(4).map(|it| (*it).to_owned()).collect();
            table.columns.extend(kept.iter().map(|k| self.methods[*k].clone()));
            for (it, MagnetStep { true_ut, found_ut }) in magnets {
                let (real, found) = (Vector3::from(true_ut), Vector3::from(found_ut));
                let along = found.dot(&real) / real.norm();
                let step = [real.norm(), along, (found - real).norm()].map(|value| number(Some(value), 1));
                let headings = kept.iter().map(|k| number(it.headings[*k].map(|heading| heading.rms_deg), 1));
                table.row(std::iter::once(it.recording.clone()).chain(step).chain(headings).collect());
            }
            table.note(
                "True step: of the hard iron, by the reference orientation. Found: what magcomp's hard iron steps by along it; off: the length of the \
                 difference. Medians with the magnet, from 3 s after it came to 8 s before it went, less those without. Then heading errors, rms in \
                 degrees up to one constant, from 20 s on.",
            );
            table
        })
    }

    fn group(&self, ours: &GroupScore) -> Table {
        let own = self.of_group(ours);
        let count = if own.len() == 1 { "one recording".to_owned() } else { format!("{} recordings", own.len()) };
        let title = format!("{}: {count}, {:.1} minutes", ours.group, ours.hours * 60.0);
        let mut table = Table::new(&title, &["method", "up to one constant", "against north", "answered %"]);
        for k in self.taking_part(own.iter().copied()) {
            let headings: Vec<Heading> = own.iter().filter_map(|it| it.headings[k]).collect();
            let cell = |of: fn(&Heading) -> f64| three(headings.iter().map(of).collect());
            let answered = headings.iter().map(|it| it.answered).sum::<f64>() / own.len() as f64;
            let cells = [cell(|it| it.rms_deg), cell(|it| it.absolute_deg), number(Some(100.0 * answered), 0)];
            table.row(std::iter::once(self.methods[k].clone()).chain(cells).collect());
        }
        let share = |name: &str| ours.figures[name].map(|it| (100.0 * it.median, 100.0 * it.worst));
        let told = |name: &str| {
            share(name)
                .map_or_else(|| "-".to_owned(), |(median, worst)| format!("{median:.0} % ({worst:.0} % at worst)"))
        };
        table.note(&format!(
            "magcomp: errors within one sigma {}, within two {}; {} changes of the device were declared, {:.1} an hour.",
            told("within_one_sigma"),
            told("within_two_sigma"),
            ours.device_steps,
            ours.device_steps as f64 / ours.hours
        ));
        table
    }

    /// The methods that answered any of these recordings.
    fn taking_part<'a>(&self, recordings: impl Iterator<Item = &'a Compared> + Clone) -> Vec<usize> {
        (0..self.methods.len()).filter(|k| recordings.clone().any(|it| it.headings[*k].is_some())).collect()
    }
}

/// Median, nine of ten and worst; of a single value itself.
fn three(values: Vec<f64>) -> String {
    let (cell, is_one) = (|value| number(Some(value), 1), values.len() == 1);
    Summary::of(values, Worse::Large).map_or_else(
        || "-".to_owned(),
        |it| if is_one { cell(it.worst) } else { [it.median, it.p90, it.worst].map(cell).join(" / ") },
    )
}
