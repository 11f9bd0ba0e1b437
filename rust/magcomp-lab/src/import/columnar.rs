//! Parquet: a table of flat columns, made into CSV with the same names, which is then read as any plain CSV. A timestamp of
//! milliseconds or microseconds becomes seconds; one of nanoseconds is a whole number (`--units t=ns`).

use crate::error::LabError;
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use std::io;
use std::path::Path;

/// First bytes of a Parquet file.
pub(super) const PARQUET: &[u8] = b"PAR1";

/// The CSV of a Parquet file, whose line 2 is the table's first row.
pub(super) fn as_csv(path: &Path, bytes: Vec<u8>) -> Result<Vec<u8>, LabError> {
    convert(bytes).map_err(|why| LabError::Read { path: path.to_owned(), source: io::Error::other(why) })
}

fn convert(bytes: Vec<u8>) -> Result<Vec<u8>, ParquetError> {
    let reader = SerializedFileReader::new(bytes::Bytes::from(bytes))?;
    let schema = reader.metadata().file_metadata().schema();
    let mut csv = csv::Writer::from_writer(Vec::new());
    let failed = |error: csv::Error| ParquetError::External(error.into());
    csv.write_record(schema.get_fields().iter().map(|field| field.name())).map_err(failed)?;
    for row in reader.get_row_iter(None)? {
        csv.write_record(row?.get_column_iter().map(|(_, field)| cell(field))).map_err(failed)?;
    }
    csv.into_inner().map_err(|error| ParquetError::General(error.to_string()))
}

fn cell(field: &Field) -> String {
    let seconds = |value: i64, in_a_second: i64, digits: usize| {
        let (whole, part) = (value.div_euclid(in_a_second), value.rem_euclid(in_a_second));
        format!("{whole}.{part:0digits$}")
    };
    match field {
        Field::Null => String::new(),
        // times before 1970 are no recording's
        Field::TimestampMillis(value) => seconds(*value, 1000, 3),
        Field::TimestampMicros(value) => seconds(*value, 1_000_000, 6),
        Field::Double(value) => value.to_string(),
        Field::Float(value) => value.to_string(),
        Field::Str(text) => text.clone(),
        other => other.to_string(),
    }
}
