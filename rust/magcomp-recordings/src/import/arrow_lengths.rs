//! The lengths that an Arrow file or stream states are checked against the file before its reader allocates so much.

use arrow_ipc::{Block, MessageHeader, RecordBatch, root_as_footer, root_as_message};
use std::error::Error;

type Checked = Result<(), Box<dyn Error + Send + Sync>>;

/// A packed buffer may become this many times longer, and this long in any case, bytes.
const MOST_TIMES: u64 = 1000;
const SMALL_BYTES: u64 = 1 << 20;
/// Bytes that end a file: the length of the footer, `ARROW1`.
const END: usize = 10;
/// What comes before each message of a stream: -1, and the length of its metadata.
const PREFIX: usize = 8;

fn refused<T>(what: &str) -> Result<T, Box<dyn Error + Send + Sync>> {
    Err(format!("the file is damaged: {what} is longer than the file").into())
}

fn slice<'a>(bytes: &'a [u8], start: i64, length: i64, what: &str) -> Result<&'a [u8], Box<dyn Error + Send + Sync>> {
    let range = usize::try_from(start).ok().zip(usize::try_from(length).ok());
    let part = range.and_then(|(start, length)| bytes.get(start..start.checked_add(length)?));
    part.map_or_else(|| refused(what), Ok)
}

/// Checks a file (Feather 2): its footer names the blocks.
pub(super) fn check_file(bytes: &[u8]) -> Checked {
    let end = bytes.len().checked_sub(END).map_or_else(|| refused("the end"), Ok)?;
    let length = i32::from_le_bytes(bytes[end..end + 4].try_into()?);
    let footer = slice(bytes, end as i64 - i64::from(length), length.into(), "the footer")?;
    let footer = root_as_footer(footer).map_err(|error| format!("the footer is damaged: {error}"))?;
    let blocks = footer.recordBatches().into_iter().chain(footer.dictionaries());
    blocks.flatten().try_for_each(|block| check_block(bytes, block))
}

fn check_block(bytes: &[u8], block: &Block) -> Checked {
    let (start, length) = (block.offset(), i64::from(block.metaDataLength()));
    let metadata = slice(bytes, start, length, "a block")?;
    let body = slice(bytes, start.saturating_add(length), block.bodyLength(), "a block")?;
    // the length of the metadata stands before it, after -1 in all but old files
    let prefix = if metadata.starts_with(&[0xff; 4]) { PREFIX } else { PREFIX / 2 };
    check_message(metadata.get(prefix..).unwrap_or_default(), |_| Ok(body))?;
    Ok(())
}

/// Checks a stream, message by message, to its end or to where it is cut.
pub(super) fn check_stream(bytes: &[u8]) -> Checked {
    let mut at = 0;
    while let Some(prefix) = bytes.get(at..at + PREFIX).filter(|prefix| prefix[..4] == [0xff; 4]) {
        let length = i32::from_le_bytes(prefix[4..].try_into()?);
        if length == 0 {
            break;
        }
        let start = (at + PREFIX) as i64;
        let metadata = slice(bytes, start, length.into(), "a message")?;
        let body_at = start + i64::from(length);
        let length = check_message(metadata, |length| slice(bytes, body_at, length, "a message"))?;
        at = usize::try_from(body_at)? + length;
    }
    Ok(())
}

/// Checks a message, whose body `body` gives for its length. Returns that length.
fn check_message<'a>(
    metadata: &[u8],
    body: impl FnOnce(i64) -> Result<&'a [u8], Box<dyn Error + Send + Sync>>,
) -> Result<usize, Box<dyn Error + Send + Sync>> {
    let message = root_as_message(metadata).map_err(|error| format!("a message is damaged: {error}"))?;
    let body = body(message.bodyLength())?;
    let batch = match message.header_type() {
        MessageHeader::RecordBatch => message.header_as_record_batch(),
        MessageHeader::DictionaryBatch => message.header_as_dictionary_batch().and_then(|batch| batch.data()),
        _ => None,
    };
    batch.map_or(Ok(()), |batch| check_batch(batch, body))?;
    Ok(body.len())
}

fn check_batch(batch: RecordBatch<'_>, body: &[u8]) -> Checked {
    for buffer in batch.buffers().into_iter().flatten() {
        let packed = slice(body, buffer.offset(), buffer.length(), "a buffer")?;
        if batch.compression().is_none() {
            continue;
        }
        // the length once unpacked stands before it; -1 is for not packed
        let Some(length) = packed.first_chunk().map(|length| i64::from_le_bytes(*length)) else { continue };
        let most = (packed.len() as u64).saturating_mul(MOST_TIMES).max(SMALL_BYTES);
        if u64::try_from(length).is_ok_and(|length| length > most) {
            return refused("a packed buffer");
        }
    }
    Ok(())
}
