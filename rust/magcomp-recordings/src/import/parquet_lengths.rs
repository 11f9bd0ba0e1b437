//! The lengths that the pages of a Parquet file state are checked before its reader allocates so much. Page headers are Thrift
//! structs in the compact protocol (github.com/apache/parquet-format, parquet.thrift).

use parquet::basic::{Encoding, Type};
use parquet::column::page::{Page, PageReader};
use parquet::file::metadata::ColumnChunkMetaData;
use parquet::file::reader::FileReader;
use parquet::file::serialized_reader::SerializedFileReader;
use std::error::Error;

type Checked<T = ()> = Result<T, Box<dyn Error + Send + Sync>>;

/// A packed page may become this many times longer, and this long in any case, bytes.
const MOST_TIMES: i64 = 1000;
const SMALL_BYTES: i64 = 1 << 20;
/// Values of a page, at most.
const MOST_VALUES: i64 = 1 << 23;
/// Structs within structs of a page header, at most.
const DEEPEST: usize = 16;
/// Encodings of texts that state how many there are.
const DELTA_LENGTH_BYTE_ARRAY: i64 = 6;
const DELTA_BYTE_ARRAY: i64 = 7;

fn damaged<T>(column: &ColumnChunkMetaData, what: &str) -> Checked<T> {
    Err(format!("column '{}': {what}", column.column_path().string()).into())
}

/// Checks the pages of all columns.
pub(super) fn check(reader: &SerializedFileReader<bytes::Bytes>, bytes: &[u8]) -> Checked {
    let groups = reader.metadata().row_groups();
    for (k, group) in groups.iter().enumerate() {
        for (j, column) in group.columns().iter().enumerate() {
            if check_headers(column, bytes)? {
                check_texts(column, reader.get_row_group(k)?.get_column_page_reader(j)?)?;
            }
        }
    }
    Ok(())
}

/// Checks the headers of a column's pages. Returns whether some have texts that state how many there are.
fn check_headers(column: &ColumnChunkMetaData, bytes: &[u8]) -> Checked<bool> {
    let (start, length) = column.byte_range();
    let end = usize::try_from(start.saturating_add(length)).unwrap_or(usize::MAX);
    let Some(mut rest) = bytes.get(usize::try_from(start)?..end) else {
        return damaged(column, "the file is damaged: it is longer than the file");
    };
    let value_bytes = match column.column_type() {
        Type::BOOLEAN => 0,
        Type::INT64 | Type::DOUBLE => 8,
        Type::INT96 => 12,
        Type::INT32 | Type::FLOAT | Type::BYTE_ARRAY => 4,
        Type::FIXED_LEN_BYTE_ARRAY => i64::from(column.column_descr().type_length()).max(1),
    };
    let mut texts = false;
    while !rest.is_empty() {
        let Some(header) = Header::read(&mut rest) else {
            return damaged(column, "the file is damaged: no page where one should be");
        };
        let Header { packed, unpacked, values, dictionary, encoding } = header;
        let most = packed.saturating_mul(MOST_TIMES).max(SMALL_BYTES);
        let fits = usize::try_from(packed).is_ok_and(|packed| packed <= rest.len());
        if !fits || !(0..=most).contains(&unpacked) || !(0..=MOST_VALUES).contains(&values) {
            return damaged(column, "the file is damaged: a page is longer than the file");
        }
        if dictionary && values.saturating_mul(value_bytes) > unpacked {
            return damaged(column, "the file is damaged: a dictionary has more values than bytes");
        }
        if encoding == DELTA_BYTE_ARRAY && !dictionary {
            return damaged(
                column,
                "text of encoding DELTA_BYTE_ARRAY is not read; write the table without this column",
            );
        }
        texts |= encoding == DELTA_LENGTH_BYTE_ARRAY && !dictionary;
        rest = &rest[packed as usize..];
    }
    Ok(texts)
}

/// Checks that pages of texts state no more texts than values.
fn check_texts(column: &ColumnChunkMetaData, mut pages: Box<dyn PageReader>) -> Checked {
    while let Some(page) = pages.get_next_page()? {
        if page.encoding() != Encoding::DELTA_LENGTH_BYTE_ARRAY {
            continue;
        }
        let buffer = page.buffer();
        let levels = match &page {
            Page::DataPageV2 { def_levels_byte_len, rep_levels_byte_len, .. } => {
                *def_levels_byte_len as usize + *rep_levels_byte_len as usize
            }
            _ => {
                let descriptor = column.column_descr();
                let kinds = [descriptor.max_rep_level(), descriptor.max_def_level()];
                kinds.iter().filter(|level| **level > 0).fold(0_usize, |at, _| {
                    let length = buffer.get(at..).and_then(|rest| rest.first_chunk().copied());
                    at.saturating_add(4).saturating_add(u32::from_le_bytes(length.unwrap_or_default()) as usize)
                })
            }
        };
        let mut rest = buffer.get(levels..).unwrap_or_default();
        // size of a block, its parts, the number of values
        let total = varint(&mut rest).and(varint(&mut rest)).and(varint(&mut rest));
        if total.is_none_or(|total| total > u64::from(page.num_values())) {
            return damaged(column, "the file is damaged: a page has more texts than values");
        }
    }
    Ok(())
}

/// What a page header says.
#[derive(Default)]
struct Header {
    packed: i64,
    unpacked: i64,
    values: i64,
    dictionary: bool,
    encoding: i64,
}

impl Header {
    /// Reads the header that `rest` begins with, and moves on.
    fn read(rest: &mut &[u8]) -> Option<Self> {
        let mut header = Self::default();
        fields(rest, &mut |rest, id, kind| {
            match (id, kind) {
                (2, I32) => header.unpacked = signed(rest)?,
                (3, I32) => header.packed = signed(rest)?,
                (5 | 7 | 8, STRUCT) => {
                    header.dictionary |= id == 7;
                    let encoding = if id == 8 { 4 } else { 2 };
                    fields(rest, &mut |rest, inner, kind| match (inner, kind) {
                        (1, I32) => signed(rest).map(|values| header.values = values),
                        (inner, I32) if inner == encoding => signed(rest).map(|encoding| header.encoding = encoding),
                        _ => skip(rest, kind, DEEPEST),
                    })?;
                }
                _ => skip(rest, kind, DEEPEST)?,
            }
            Some(())
        })?;
        Some(header)
    }
}

// kinds of fields of the compact protocol; 1 and 2 are true and false
const I32: u8 = 5;
const STRUCT: u8 = 12;

type OnField<'a> = dyn FnMut(&mut &[u8], i64, u8) -> Option<()> + 'a;

/// Calls `field` with the number and kind of each field of a struct; it must read the field's value.
fn fields(rest: &mut &[u8], field: &mut OnField<'_>) -> Option<()> {
    let mut id = 0_i64;
    loop {
        let first = byte(rest)?;
        if first == 0 {
            return Some(());
        }
        id = if first >> 4 == 0 { signed(rest)? } else { id.checked_add(i64::from(first >> 4))? };
        field(rest, id, first & 15)?;
    }
}

fn skip(rest: &mut &[u8], kind: u8, depth: usize) -> Option<()> {
    let depth = depth.checked_sub(1)?;
    match kind {
        1 | 2 => {}
        3 => drop(byte(rest)?),
        4..=6 => drop(varint(rest)?),
        7 => *rest = rest.get(8..)?,
        8 => {
            let length = usize::try_from(varint(rest)?).ok()?;
            *rest = rest.get(length..)?;
        }
        9 | 10 => {
            let first = byte(rest)?;
            let count = if first >> 4 == 15 { varint(rest)? } else { u64::from(first >> 4) };
            // true and false take a byte in a list
            let kind = if first & 15 < 3 { 3 } else { first & 15 };
            (0..count).try_for_each(|_| skip(rest, kind, depth))?;
        }
        STRUCT => fields(rest, &mut |rest, _, kind| skip(rest, kind, depth))?,
        _ => return None,
    }
    Some(())
}

fn byte(rest: &mut &[u8]) -> Option<u8> {
    let (first, others) = rest.split_first()?;
    *rest = others;
    Some(*first)
}

fn varint(rest: &mut &[u8]) -> Option<u64> {
    let mut value = 0;
    for shift in (0..64).step_by(7) {
        let byte = byte(rest)?;
        value |= u64::from(byte & 127) << shift;
        if byte < 128 {
            return Some(value);
        }
    }
    None
}

/// A number whose sign is its last bit.
fn signed(rest: &mut &[u8]) -> Option<i64> {
    varint(rest).map(|value| (value >> 1) as i64 ^ -((value & 1) as i64))
}
