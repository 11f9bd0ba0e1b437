//! Any table: columns named by options, or by words in the header. Each file holds the sensors whose columns it has, so several files make
//! one session, but no two of them the same sensor.

use super::document::Document;
use super::layout::{self, Layout, Taken, Time};
use super::names::{guess, left_over, sensor_of_stem};
use super::options::{ColumnNames, ImportOptions};
use super::session::Session;
use super::sheet::{Sheet, header_of};
use super::units::{Kind, written_factor};
use crate::error::{Place, RecordingError};
use crate::recording::name_of;

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
    let common = options.columns.clone().unwrap_or_default();
    if let Some(file) = common.unknown_file(documents.iter().map(|document| document.path.as_path())) {
        let files: Vec<String> = documents.iter().map(|document| name_of(&document.path)).collect();
        return Err(RecordingError::Usage(format!(
            "--columns {file}:...: no such file; there are {}",
            files.join(", ")
        )));
    }
    let names_of = |document: &Document| common.of_file(&document.path).unwrap_or_else(|| common.clone());
    let has_rate = options.rate.is_some();
    for document in documents.iter_mut() {
        // titles before the table: those before its names, or before numbers where the columns are numbers
        let digits = |header: &[String]| {
            header.len() > 1 && header.iter().all(|cell| cell.replace(',', ".").parse::<f64>().is_ok())
        };
        let names = names_of(document);
        let numbers = names.are_numbers();
        document.begin_at(|line| {
            let header = header_of(line);
            if numbers { digits(&header) } else { is_header(&header, &names, has_rate) }
        });
    }
    let mut session = Session { is_time_told: true, ..Session::default() };
    let stems = by_stems(documents, &common, options)?;
    let mut owners: [Option<&Document>; 4] = [None; 4];
    let mut not_taken = Vec::new();
    for (k, document) in documents.iter().enumerate() {
        let is_alone = documents.len() == 1;
        let names = names_of(document);
        let by_stem = stems.as_ref().and_then(|kinds| kinds[k]);
        let layout = match by_stem {
            Some(kind) => by_names(document, &names, options).map(|layout| Layout {
                sensors: layout.sensors.into_iter().take(1).map(|taken| Taken { kind, ..taken }).collect(),
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
                session.is_time_told &= layout.is_time_told;
                not_taken.push((document, left_over(&header, |column| layout.takes(column))));
                session.take(part);
            }
            // the others can be done without
            Err(why) if needed || by_stem == Some(Kind::Field) => return Err(why),
            Err(why) => {
                let guessed = guess(document, &options.units.unwrap_or_default(), options.rate);
                if guessed.as_ref().is_some_and(has_field) {
                    return Err(why);
                }
                session.leave_out("no magnetometer", why);
            }
        }
    }
    not_taken.iter().for_each(|(document, sensors)| session.tell_left_over(&document.path, sensors));
    if let Some(kinds) = &stems {
        let named = documents.iter().zip(kinds).filter_map(|(document, kind)| Some((document, (*kind)?)));
        let told: Vec<String> =
            named.map(|(document, kind)| format!("{}: {}", document.path.display(), kind.word())).collect();
        session.notes.push(format!(
            "the files' names tell the sensors, because all have the same columns ({})",
            told.join("; ")
        ));
    }
    Ok(session)
}

/// The sensors of files that all have the columns named for one sensor, by the files' names; none of a file that has names of its own. None
/// at all where there is one file, or each has columns of its own.
///
/// # Errors
/// The files whose names tell no sensor, or one that another has.
fn by_stems(
    documents: &[Document],
    names: &ColumnNames,
    options: &ImportOptions,
) -> Result<Option<Vec<Option<Kind>>>, RecordingError> {
    if documents.len() < 2 || options.columns.is_none() {
        return Ok(None);
    }
    let has_all = |document: &Document| {
        let header = Sheet::new(document).header;
        names.names[1..4].iter().all(|name| header.contains(name))
    };
    let is_alike = |document: &Document| names.of_file(&document.path).is_none() && has_all(document);
    let alike: Vec<&Document> = documents.iter().filter(|document| is_alike(document)).collect();
    if alike.len() < 2 {
        return Ok(None);
    }
    let kind_of = |document: &Document| sensor_of_stem(&document.stem()).filter(|_| is_alike(document));
    let kinds: Vec<Option<Kind>> = documents.iter().map(kind_of).collect();
    let known = || documents.iter().zip(&kinds).filter_map(|(document, kind)| Some((document, (*kind)?)));
    for (k, (document, kind)) in known().enumerate() {
        if let Some((before, _)) = known().take(k).find(|(_, before)| *before == kind) {
            return Err(RecordingError::several(&before.path, &document.path));
        }
    }
    if known().next().is_none() {
        return Err(RecordingError::several(&alike[0].path, &alike[1].path));
    }
    match alike.into_iter().find(|document| kind_of(document).is_none()) {
        Some(document) => Err(RecordingError::Usage(which_sensor(document))),
        None => Ok(Some(kinds)),
    }
}

/// Asks for the sensor of a file whose name does not tell it.
pub(super) fn which_sensor(document: &Document) -> String {
    let name = name_of(&document.path);
    let header = Sheet::new(document).header;
    let column = |axis: &str| {
        let found = header.iter().find(|column| column.eq_ignore_ascii_case(axis));
        found.cloned().unwrap_or_else(|| axis.to_owned())
    };
    let [x, y, z] = ["x", "y", "z"].map(column);
    format!(
        "{}: which sensor is it? rename it to mag.csv, acc.csv or gyr.csv, or say it behind --columns t=NAME,...: {name}:gx={x},gy={y},gz={z} for          a gyroscope (ax,ay,az accelerometer, mx,my,mz magnetometer)",
        document.path.display()
    )
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
        None => layout::time(&sheet, &names.names[0], units.time_ns)?,
    };
    let is_time_told = match &time {
        Time::Rate(_) => true,
        Time::Columns(parts) => {
            let column = parts[0].0;
            units.time_ns.is_some() || parts.len() > 1 || sheet.time_unit(column).is_some() || sheet.has_dates(column)
        }
    };
    let mut sensors = Vec::new();
    for (kind, first) in [(Kind::Field, 1), (Kind::Up, 4), (Kind::Rate, 7), (Kind::System, 10)] {
        let columns = group::<3>(&sheet, names, first)?;
        sensors.extend(columns.map(|columns| {
            let written = || written_factor(kind, &sheet.unit(columns[0])?);
            Taken { kind, columns, factor: units.factor(kind).or_else(written).unwrap_or(1.0), time: None }
        }));
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
    Ok(Layout { time, is_time_told, sensors, attitude: group::<4>(&sheet, names, 13)?, course })
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
