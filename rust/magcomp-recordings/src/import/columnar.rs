//! Parquet and Arrow: a table of flat columns is made into CSV with the same names, which is then read as any plain CSV. A timestamp
//! becomes seconds; a time that is a plain number keeps its unit (`--units t=ns`).
//!
//! Arrow: a file (Feather, version 2) or a stream, buffers plain or compressed with LZ4 or zstd.

use super::forms::{ARROW_FILE, PARQUET};
use super::guard::{guarded, one_line};
use super::input::MOST_BYTES;
use super::{arrow_lengths, parquet_lengths};
use crate::error::RecordingError;
use arrow_array::cast::AsArray;
use arrow_array::types::{
    DurationMicrosecondType, DurationMillisecondType, DurationNanosecondType, DurationSecondType, Float16Type,
    Float32Type, Float64Type, Int8Type, Int16Type, Int32Type, Int64Type, TimestampMicrosecondType,
    TimestampMillisecondType, TimestampNanosecondType, TimestampSecondType, UInt8Type, UInt16Type, UInt32Type,
    UInt64Type,
};
use arrow_array::{Array, RecordBatch};
use arrow_ipc::reader::{FileReader as ArrowFile, StreamReader as ArrowStream};
use arrow_schema::{ArrowError, DataType, TimeUnit};
use parquet::basic::{LogicalType, TimeUnit as ParquetUnit};
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use std::error::Error;
use std::io::{self, Cursor, Write};
use std::panic::AssertUnwindSafe;
use std::path::Path;

type Failed = Box<dyn Error + Send + Sync>;
type Csv = csv::Writer<Capped>;

/// The CSV of a Parquet or Arrow file, whose line 2 is the table's first row.
pub(super) fn as_csv(path: &Path, bytes: Vec<u8>) -> Result<Vec<u8>, RecordingError> {
    let made = guarded(AssertUnwindSafe(|| {
        let mut csv = csv::Writer::from_writer(Capped(Vec::new()));
        if bytes.starts_with(PARQUET) {
            parquet(bytes, &mut csv)?;
        } else if bytes.starts_with(ARROW_FILE) {
            arrow_lengths::check_file(&bytes)?;
            let reader = ArrowFile::try_new_buffered(Cursor::new(bytes), None)?;
            arrow(&reader.schema().fields, reader, &mut csv)?;
        } else {
            arrow_lengths::check_stream(&bytes)?;
            let reader = ArrowStream::try_new_buffered(Cursor::new(bytes), None)?;
            arrow(&reader.schema().fields, reader, &mut csv)?;
        }
        let text = csv.into_inner().map_err(|error| Failed::from(error.to_string()))?;
        Ok(text.0)
    }));
    let text: Result<Vec<u8>, Failed> = made.unwrap_or_else(|damaged| Err(damaged.into()));
    text.map_err(one_line).map_err(RecordingError::read(path))
}

/// Text of at most [`MOST_BYTES`]: packed tables can have any number of rows.
struct Capped(Vec<u8>);

impl Write for Capped {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if (self.0.len() + bytes.len()) as u64 > MOST_BYTES {
            let why = format!("the table has more than {} MiB of text; import a shorter one", MOST_BYTES >> 20);
            return Err(io::Error::new(io::ErrorKind::FileTooLarge, why));
        }
        self.0.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn parquet(bytes: Vec<u8>, csv: &mut Csv) -> Result<(), Failed> {
    let bytes = bytes::Bytes::from(bytes);
    let reader = SerializedFileReader::new(bytes.clone())?;
    parquet_lengths::check(&reader, &bytes)?;
    let columns = reader.metadata().file_metadata().schema().get_fields();
    // rows give a timestamp of nanoseconds as a number
    let nanoseconds: Vec<bool> = (columns.iter())
        .map(|column| {
            let kind = column.get_basic_info().logical_type_ref();
            matches!(kind, Some(LogicalType::Timestamp(kind)) if kind.unit == ParquetUnit::NANOS)
        })
        .collect();
    csv.write_record(columns.iter().map(|column| column.name()))?;
    for row in reader.get_row_iter(None)? {
        let row = row.map_err(|error: ParquetError| error)?;
        let cells = row.get_column_iter().zip(&nanoseconds);
        csv.write_record(cells.map(|((_, field), nanoseconds)| parquet_cell(field, *nanoseconds)))?;
    }
    Ok(())
}

fn parquet_cell(field: &Field, nanoseconds: bool) -> String {
    match field {
        Field::Null => String::new(),
        Field::Long(value) if nanoseconds => seconds(*value, TimeUnit::Nanosecond),
        Field::TimestampMillis(value) => seconds(*value, TimeUnit::Millisecond),
        Field::TimestampMicros(value) => seconds(*value, TimeUnit::Microsecond),
        Field::Double(value) => value.to_string(),
        Field::Float(value) => value.to_string(),
        Field::Str(text) => text.clone(),
        other => other.to_string(),
    }
}

fn arrow(
    fields: &arrow_schema::Fields,
    batches: impl Iterator<Item = Result<RecordBatch, ArrowError>>,
    csv: &mut Csv,
) -> Result<(), Failed> {
    csv.write_record(fields.iter().map(|field| field.name()))?;
    for batch in batches {
        let batch = batch?;
        for row in 0..batch.num_rows() {
            csv.write_record(batch.columns().iter().map(|column| arrow_cell(column.as_ref(), row)))?;
        }
    }
    Ok(())
}

fn arrow_cell(column: &dyn Array, row: usize) -> String {
    macro_rules! number {
        ($kind:ty) => {
            column.as_primitive::<$kind>().value(row).to_string()
        };
    }
    macro_rules! time {
        ($unit:expr, $second:ty, $milli:ty, $micro:ty, $nano:ty) => {
            seconds(
                match $unit {
                    TimeUnit::Second => column.as_primitive::<$second>().value(row),
                    TimeUnit::Millisecond => column.as_primitive::<$milli>().value(row),
                    TimeUnit::Microsecond => column.as_primitive::<$micro>().value(row),
                    TimeUnit::Nanosecond => column.as_primitive::<$nano>().value(row),
                },
                *$unit,
            )
        };
    }
    if column.is_null(row) {
        return String::new();
    }
    match column.data_type() {
        DataType::Float16 => number!(Float16Type),
        DataType::Float32 => number!(Float32Type),
        DataType::Float64 => number!(Float64Type),
        DataType::Int8 => number!(Int8Type),
        DataType::Int16 => number!(Int16Type),
        DataType::Int32 => number!(Int32Type),
        DataType::Int64 => number!(Int64Type),
        DataType::UInt8 => number!(UInt8Type),
        DataType::UInt16 => number!(UInt16Type),
        DataType::UInt32 => number!(UInt32Type),
        DataType::UInt64 => number!(UInt64Type),
        DataType::Timestamp(unit, _) => time!(
            unit,
            TimestampSecondType,
            TimestampMillisecondType,
            TimestampMicrosecondType,
            TimestampNanosecondType
        ),
        DataType::Duration(unit) => {
            time!(unit, DurationSecondType, DurationMillisecondType, DurationMicrosecondType, DurationNanosecondType)
        }
        DataType::Utf8 => column.as_string::<i32>().value(row).to_owned(),
        DataType::LargeUtf8 => column.as_string::<i64>().value(row).to_owned(),
        DataType::Utf8View => column.as_string_view().value(row).to_owned(),
        // an error about this cell then names what it is
        other => other.to_string(),
    }
}

/// A number of units as seconds with all digits.
fn seconds(value: i64, unit: TimeUnit) -> String {
    let digits = match unit {
        TimeUnit::Second => return value.to_string(),
        TimeUnit::Millisecond => 3,
        TimeUnit::Microsecond => 6,
        TimeUnit::Nanosecond => 9,
    };
    let (sign, size, in_a_second) = (if value < 0 { "-" } else { "" }, value.unsigned_abs(), 10_u64.pow(digits));
    format!("{sign}{}.{:0digits$}", size / in_a_second, size % in_a_second, digits = digits as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_keep_their_digits_and_sign() {
        assert_eq!(seconds(-1_500, TimeUnit::Millisecond), "-1.500");
        assert_eq!(seconds(-1, TimeUnit::Microsecond), "-0.000001");
        assert_eq!(seconds(1_700_000_000_010_000_001, TimeUnit::Nanosecond), "1700000000.010000001");
        assert_eq!(seconds(12, TimeUnit::Second), "12");
    }
}
