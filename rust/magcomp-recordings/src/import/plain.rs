//! Any table: columns named by options, or by words in the header. Each file holds the sensors whose columns it has, so several files make
//! one session, but no two of them the same sensor.

use super::document::Document;
use super::layout::{self, Layout, SECOND_NS, Taken, Time};
use super::names::{factor_of, guess, sensor_of_stem};
use super::options::{ColumnNames, ImportOptions};
use super::session::{Kind, Session};
use super::sheet::{Sheet, header_of};
use crate::error::{Place, RecordingError};

/// Whether a file has a time and some sensor under these names.
pub(super) fn is_header(header: &[String], names: &ColumnNames, has_rate: bool) -> bool {
    let has = |index: usize| header.contains(&names.names[index]);
    let time = &names.names[0];
    let sum = || time.contains('+') && time.split(['+', '*']).any(|part| header.iter().any(|name| name == part.trim()));
    (has(0) || has_rate || sum()) && [1, 4, 7, 10].into_iter().any(has)
}

/// Whether a file is a recording with a magnetometer under a recording's own names.
pub(super) fn is_recording(header: &[String]) -> bool {
    ["t_s", "mx", "my", "mz"].iter().all(|name| header.iter().any(|column| column == name))
}

pub(super) fn read(documents: &mut [Document], options: &ImportOptions) -> Result<Session, RecordingError> {
    let names = options.columns.clone().unwrap_or_default();
    let (numbers, has_rate) = (names.are_numbers(), options.rate.is_some());
    for document in documents.iter_mut() {
        // titles before the table: those before its names, or before numbers where the columns are numbers
        let digits = |header: &[String]| {
            header.len() > 1 && header.iter().all(|cell| cell.replace(',', ".").parse::<f64>().is_ok())
        };
        document.begin_at(|line| {
            let header = header_of(line);
            if numbers { digits(&header) } else { is_header(&header, &names, has_rate) }
        });
    }
    let mut session = Session::default();
    let stems = by_stems(documents, &names, options);
    let mut owners: [Option<&Document>; 4] = [None; 4];
    for (k, document) in documents.iter().enumerate() {
        let is_alone = documents.len() == 1;
        let layout = match &stems {
            Some(kinds) => by_names(document, &names, options).map(|layout| Layout {
                sensors: layout.sensors.into_iter().take(1).map(|taken| Taken { kind: kinds[k], ..taken }).collect(),
                ..layout
            }),
            None => layout_of(document, &names, options, &mut session.notes),
        };
        let has_field = |layout: &Layout| layout.sensors.iter().any(|taken| taken.kind == Kind::Field);
        let header = Sheet::new(document).header;
        let needed = is_alone || names.names[1..4].iter().any(|name| header.contains(name));
        let mut part = Session::default();
        let read = layout.and_then(|layout| layout::read(document, &layout, &mut part).map(|()| layout));
        match read {
            Ok(layout) => {
                for taken in &layout.sensors {
                    let owner = &mut owners[taken.kind as usize];
                    if let Some(before) = owner.replace(document) {
                        return Err(RecordingError::several(&before.path, &document.path));
                    }
                }
                session.take(part);
            }
            // the others can be done without
            Err(why) if needed || matches!(&stems, Some(kinds) if kinds[k] == Kind::Field) => return Err(why),
            Err(why) => {
                let guessed = guess(document, &options.units.unwrap_or_default(), options.rate);
                if guessed.as_ref().is_some_and(has_field) {
                    return Err(why);
                }
                session.leave_out("no magnetometer", why);
            }
        }
    }
    if let Some(kinds) = &stems {
        let told: Vec<String> = documents
            .iter()
            .zip(kinds)
            .map(|(document, kind)| format!("{}: {}", document.path.display(), kind.word()))
            .collect();
        session.notes.push(format!(
            "the files' names tell the sensors, because all have the same columns ({})",
            told.join("; ")
        ));
    }
    Ok(session)
}

/// The sensors of files that all have the columns named for one sensor, and names that tell different sensors.
fn by_stems(documents: &[Document], names: &ColumnNames, options: &ImportOptions) -> Option<Vec<Kind>> {
    if documents.len() < 2 || options.columns.is_none() {
        return None;
    }
    let has_all = |document: &Document| {
        let header = Sheet::new(document).header;
        names.names[1..4].iter().all(|name| header.contains(name))
    };
    let kinds: Vec<Kind> = documents.iter().map(|document| sensor_of_stem(&document.stem())).collect::<Option<_>>()?;
    let differ = (0..kinds.len()).all(|k| !kinds[..k].contains(&kinds[k]));
    (differ && documents.iter().all(has_all)).then_some(kinds)
}

fn layout_of(
    document: &Document,
    names: &ColumnNames,
    options: &ImportOptions,
    notes: &mut Vec<String>,
) -> Result<Layout, RecordingError> {
    let header = Sheet::new(document).header;
    if options.columns.is_none()
        && !is_header(&header, names, options.rate.is_some())
        && let Some(layout) = guess(document, &options.units.unwrap_or_default(), options.rate)
    {
        notes.push(layout::told(document, &layout));
        return Ok(layout);
    }
    by_names(document, names, options)
}

fn by_names(document: &Document, names: &ColumnNames, options: &ImportOptions) -> Result<Layout, RecordingError> {
    let units = options.units.unwrap_or_default();
    let sheet = Sheet::new(document);
    let time = match options.rate {
        Some(hz) => Time::Rate(hz),
        None => layout::time(&sheet, &names.names[0], units.time_ns.unwrap_or(SECOND_NS))?,
    };
    let mut sensors = Vec::new();
    for (kind, first) in [(Kind::Field, 1), (Kind::Up, 4), (Kind::Rate, 7), (Kind::System, 10)] {
        let columns = group::<3>(&sheet, names, first)?;
        let factor = factor_of(kind, &units).unwrap_or(1.0);
        sensors.extend(columns.map(|columns| Taken { kind, columns, factor, time: None }));
    }
    if sensors.is_empty() {
        let columns = names.names[1..4].join(",");
        return Err(RecordingError::Form {
            place: Place { path: sheet.path().to_owned(), line: document.first_line_number(), column: None },
            expected: format!("a sensor's columns, such as {columns}; name them by --columns mx=NAME,..."),
            found: sheet.shown(),
        });
    }
    let course = ["course_deg", "course_sigma_deg"].map(|name| sheet.header.iter().position(|column| column == name));
    let course = if let [Some(heading), Some(sigma)] = course { Some([heading, sigma]) } else { None };
    Ok(Layout { time, sensors, attitude: group::<4>(&sheet, names, 13)?, course })
}

/// Where a sensor's columns are: all of them or none.
fn group<const N: usize>(
    sheet: &Sheet<'_>,
    names: &ColumnNames,
    first: usize,
) -> Result<Option<[usize; N]>, RecordingError> {
    let names = &names.names[first..first + N];
    if names.iter().all(|name| sheet.column(name).is_none()) {
        return Ok(None);
    }
    let mut columns = [0; N];
    for (column, name) in columns.iter_mut().zip(names) {
        *column = sheet.required(name)?;
    }
    Ok(Some(columns))
}
