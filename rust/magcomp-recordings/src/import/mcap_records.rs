//! The records of an mcap file that a bag of ROS 2 needs: schemas, channels, messages (mcap.dev, "MCAP format specification").

use crate::recording::Content;
use mcap::records::op;
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use std::collections::BTreeMap;
use std::error::Error;
use std::io::{BufReader, Read};
use std::rc::Rc;

/// Where messages of one topic come from.
pub(super) struct Channel {
    pub topic: String,
    /// Name of the schema; empty where the bag has none.
    pub schema: String,
    pub encoding: String,
}

pub(super) struct Message {
    pub channel: Rc<Channel>,
    pub log_time: u64,
    pub data: Vec<u8>,
}

/// The messages of a bag in the file's order.
///
/// The three kinds of records that it takes are read here: the crate's own reader allocates whatever length a string in a record
/// states, and reads the summary too, which nothing here needs.
pub(super) struct Messages<'a> {
    content: BufReader<&'a mut Content>,
    records: LinearReader,
    schemas: BTreeMap<u16, String>,
    channels: BTreeMap<u16, Rc<Channel>>,
}

impl<'a> Messages<'a> {
    pub fn new(content: &'a mut Content, most_bytes: u64) -> Self {
        let most_bytes = usize::try_from(most_bytes).unwrap_or(usize::MAX);
        let records =
            LinearReader::new_with_options(LinearReaderOptions::default().with_record_length_limit(most_bytes));
        Self { content: BufReader::new(content), records, schemas: BTreeMap::new(), channels: BTreeMap::new() }
    }

    pub fn next(&mut self) -> Result<Option<Message>, Box<dyn Error + Send + Sync>> {
        while let Some(event) = self.records.next_event() {
            match event? {
                LinearReadEvent::ReadRequest(bytes) => {
                    let count = self.content.read(self.records.insert(bytes))?;
                    self.records.notify_read(count);
                }
                LinearReadEvent::Record { opcode: op::SCHEMA, data } => {
                    let (id, name) = schema(data).ok_or("the file is damaged: a schema is longer than its record")?;
                    self.schemas.insert(id, name);
                }
                LinearReadEvent::Record { opcode: op::CHANNEL, data } => {
                    let found = channel(data, &self.schemas);
                    let (id, channel) = found.ok_or("the file is damaged: a channel is longer than its record")?;
                    self.channels.insert(id, Rc::new(channel));
                }
                LinearReadEvent::Record { opcode: op::MESSAGE, data } => {
                    let found = message(data, &self.channels);
                    return found.map(Some).ok_or("the file is damaged: a message has no channel".into());
                }
                LinearReadEvent::Record { .. } => {}
            }
        }
        Ok(None)
    }
}

/// Identity and name of the schema in a record.
fn schema(mut record: &[u8]) -> Option<(u16, String)> {
    Some((u16::from_le_bytes(taken(&mut record)?), text(&mut record)?))
}

fn channel(mut record: &[u8], schemas: &BTreeMap<u16, String>) -> Option<(u16, Channel)> {
    let (id, schema) = (u16::from_le_bytes(taken(&mut record)?), u16::from_le_bytes(taken(&mut record)?));
    let schema = schemas.get(&schema).cloned().unwrap_or_default();
    Some((id, Channel { topic: text(&mut record)?, schema, encoding: text(&mut record)? }))
}

fn message(mut record: &[u8], channels: &BTreeMap<u16, Rc<Channel>>) -> Option<Message> {
    let channel = channels.get(&u16::from_le_bytes(taken(&mut record)?))?.clone();
    let _sequence: [u8; 4] = taken(&mut record)?;
    let log_time = u64::from_le_bytes(taken(&mut record)?);
    let _publish_time: [u8; 8] = taken(&mut record)?;
    Some(Message { channel, log_time, data: record.to_vec() })
}

fn taken<const N: usize>(rest: &mut &[u8]) -> Option<[u8; N]> {
    let (first, after) = rest.split_first_chunk()?;
    *rest = after;
    Some(*first)
}

fn text(rest: &mut &[u8]) -> Option<String> {
    let length = u32::from_le_bytes(taken(rest)?) as usize;
    let (text, after) = rest.split_at_checked(length)?;
    *rest = after;
    String::from_utf8(text.to_vec()).ok()
}
