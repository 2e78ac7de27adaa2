//! Recordings from MCAP: one topic of flat messages, a sample each.
//!
//! Channels are the fields that are real numbers. Labels are those of the metadata record `labels`,
//! as this program writes them. Memory is that of the longest record, and at most that of a
//! decompressed block.

use super::super::guarded::guarded;
use super::ros2::{Field, decode, fields};
use crate::measured::{
    MeasuredChannel, MeasuredFile, Options, Recording, Samples, TimeColumn, TimeUnit, name_and_unit,
    one_rate, selected,
};
use crate::{Column, Error, Kind, Value};
use mcap::records::{Record, op};
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// A longer record does not hold samples.
const LONGEST_RECORD: usize = 1 << 26;

/// Most bytes that are read at a time, also where the file asks for more.
const MOST_AT_ONCE: usize = 1 << 20;

/// More fields than a message of channels has.
const MOST_FIELDS: usize = 1 << 12;

/// What the messages of a topic hold.
#[derive(Clone, Debug)]
enum Messages {
    Ros2(Vec<Field>),
    /// JSON objects: the names of the fields that are numbers in the first one.
    Json(Vec<String>),
}

struct Stream {
    path: PathBuf,
    file: File,
    reader: LinearReader,
}

struct McapSamples {
    stream: Stream,
    channel: u16,
    messages: Messages,
    /// Which fields are wanted.
    wanted: Vec<usize>,
    first_ns: Option<u64>,
}

fn damaged(path: &Path, reason: impl ToString) -> Error {
    Error::damaged("MCAP", path, reason)
}

/// What stands in a file before its first sample.
#[derive(Default)]
struct Heading {
    schemas: BTreeMap<u16, (String, String)>,
    /// Topics whose messages can be read, by the channel's number.
    topics: BTreeMap<u16, (String, Messages)>,
    labels: BTreeMap<String, String>,
    /// The number of the channel of the first sample.
    first: Option<u16>,
}

/// Opens a file.
pub(crate) fn open(path: &Path, options: &Options) -> Result<MeasuredFile, Error> {
    let heading = heading(path)?;
    let sampled = heading
        .first
        .and_then(|id| Some((id, heading.topics.get(&id)?)));
    let Some((channel, (_, messages))) = sampled else {
        return Err(damaged(
            path,
            "it has no messages with numbers alone, neither of ROS 2 nor in JSON",
        ));
    };
    let (places, all) = messages.channels();
    let wanted = selected(&all, options)?;
    let channels: Vec<_> = wanted.iter().map(|&i| all[i].clone()).collect();
    let stated = heading
        .labels
        .get("sample_rate_hz")
        .and_then(|rate| rate.parse().ok());
    let rate = one_rate(path, stated, options)?;
    let samples = McapSamples {
        stream: Stream::open(path)?,
        channel,
        messages: messages.clone(),
        wanted: wanted.iter().map(|&i| places[i]).collect(),
        first_ns: None,
    };
    let labels = heading
        .labels
        .iter()
        .filter(|(name, _)| *name != "sample_rate_hz");
    let labels = labels.map(|(name, value)| label(name, value)).collect();
    let time = TimeColumn {
        name: "log_time".into(),
        unit: TimeUnit::Seconds(1e-9),
        single_precision: false,
    };
    let count = channels.len();
    MeasuredFile::of_one(channels, labels, |labels| {
        Recording::new(path, labels, count, rate, Some(time), samples)
    })
}

/// A label as a column: a number where its name ends in a unit, or counts.
fn label(name: &str, text: &str) -> (Column, Value) {
    let (_, unit) = name_and_unit(name);
    let column = |kind| {
        let column = Column::new(name, kind, "as the recording is labelled").optional();
        match &unit {
            Some(unit) => column.unit(unit),
            None => column,
        }
    };
    if unit.is_some() {
        let number = text.parse().ok().filter(|x: &f64| x.is_finite());
        return (column(Kind::Real), number.into());
    }
    if ["repeat", "faulty_joints"].contains(&name) {
        return (column(Kind::Integer), text.parse::<i64>().ok().into());
    }
    (column(Kind::Text), text.into())
}

fn heading(path: &Path) -> Result<Heading, Error> {
    let mut stream = Stream::open(path)?;
    let mut heading = Heading::default();
    while heading.first.is_none() && stream.next(|record| heading.take(record))? {}
    let readable = heading.topics.values().map(|(topic, _)| topic.as_str());
    let readable: Vec<&str> = readable.collect();
    if readable.len() > 1 {
        return Err(damaged(
            path,
            format!(
                "it has several topics of numbers, and only one can be read: {}",
                readable.join(", ")
            ),
        ));
    }
    Ok(heading)
}

impl Heading {
    fn take(&mut self, record: Record) {
        match record {
            Record::Schema { header, data } => {
                let text = String::from_utf8_lossy(&data).into_owned();
                self.schemas.insert(header.id, (header.encoding, text));
            }
            Record::Channel(channel) => {
                let schema = self.schemas.get(&channel.schema_id);
                let messages = match (channel.message_encoding.as_str(), schema) {
                    ("cdr", Some((encoding, text))) if encoding == "ros2msg" => {
                        fields(text).map(Messages::Ros2)
                    }
                    ("json", _) => Some(Messages::Json(Vec::new())),
                    _ => None,
                };
                let usable = messages.filter(|messages| match messages {
                    Messages::Ros2(fields) => {
                        fields.len() <= MOST_FIELDS && fields.iter().any(Field::is_real)
                    }
                    Messages::Json(_) => true,
                });
                if let Some(messages) = usable {
                    self.topics.insert(channel.id, (channel.topic, messages));
                }
            }
            Record::Metadata(metadata) if metadata.name == "labels" => {
                self.labels = metadata.metadata;
            }
            Record::Message { header, data } => {
                let Some((_, messages)) = self.topics.get_mut(&header.channel_id) else {
                    return;
                };
                if let Messages::Json(names) = messages {
                    *names = json_numbers(&data);
                    if names.is_empty() {
                        self.topics.remove(&header.channel_id);
                        return;
                    }
                }
                self.first = Some(header.channel_id);
            }
            _ => {}
        }
    }
}

/// The names of the fields of a JSON object that are numbers.
fn json_numbers(data: &[u8]) -> Vec<String> {
    let object: Option<serde_json::Map<String, serde_json::Value>> =
        serde_json::from_slice(data).ok();
    let fields = object.into_iter().flatten();
    let numbers = fields.filter(|(_, value)| value.is_number());
    numbers.map(|(name, _)| name).take(MOST_FIELDS).collect()
}

impl Messages {
    /// The channels, and which fields they are.
    fn channels(&self) -> (Vec<usize>, Vec<MeasuredChannel>) {
        let channel = |column: &str, comment: Option<&String>| {
            let (name, unit) = name_and_unit(column);
            MeasuredChannel {
                column: column.to_owned(),
                name,
                unit: comment.cloned().or(unit),
            }
        };
        match self {
            Self::Ros2(fields) => fields
                .iter()
                .enumerate()
                .filter(|(_, field)| field.is_real())
                .map(|(i, field)| (i, channel(&field.name, field.comment.as_ref())))
                .unzip(),
            Self::Json(names) => names
                .iter()
                .enumerate()
                .map(|(i, name)| (i, channel(name, None)))
                .unzip(),
        }
    }

    /// The numbers of a message, in the order of the fields.
    fn decode(&self, data: &[u8]) -> Option<Vec<f64>> {
        match self {
            Self::Ros2(fields) => decode(data, fields),
            Self::Json(names) => {
                let object: serde_json::Map<String, serde_json::Value> =
                    serde_json::from_slice(data).ok()?;
                let number = |name: &String| object.get(name).and_then(|value| value.as_f64());
                Some(
                    names
                        .iter()
                        .map(|name| number(name).unwrap_or(f64::NAN))
                        .collect(),
                )
            }
        }
    }
}

impl Stream {
    fn open(path: &Path) -> Result<Self, Error> {
        let options = LinearReaderOptions::default()
            .with_validate_chunk_crcs(true)
            .with_record_length_limit(LONGEST_RECORD);
        Ok(Self {
            path: path.to_owned(),
            file: files::open(path).map_err(Error::io("open", path))?,
            reader: LinearReader::new_with_options(options),
        })
    }

    /// Hands the next record to `take` that can matter; false at the end. A record that is longer than its chunk
    /// is a mistake of its own to the MCAP library.
    fn next(&mut self, take: impl FnOnce(Record)) -> Result<bool, Error> {
        let path = self.path.clone();
        let contradiction = || damaged(&path, "its chunks and records contradict each other");
        guarded(|| self.advance(take), contradiction)
    }

    fn advance(&mut self, take: impl FnOnce(Record)) -> Result<bool, Error> {
        loop {
            let Some(event) = self.reader.next_event() else {
                return Ok(false);
            };
            match event.map_err(|error| damaged(&self.path, error))? {
                LinearReadEvent::ReadRequest(needed) => {
                    let into = self.reader.insert(needed.clamp(1, MOST_AT_ONCE));
                    let read = self
                        .file
                        .read(into)
                        .map_err(Error::io("read", &self.path))?;
                    self.reader.notify_read(read);
                }
                LinearReadEvent::Record { data, opcode } => {
                    match lengths_fit(opcode, data) {
                        None => continue,
                        Some(true) => {}
                        Some(false) => {
                            let reason = "a record is shorter than it announces";
                            return Err(damaged(&self.path, reason));
                        }
                    }
                    let record = mcap::parse_record(opcode, data);
                    take(record.map_err(|error| damaged(&self.path, error))?);
                    return Ok(true);
                }
            }
        }
    }
}

/// Whether the texts and blocks of a record are within it; none of records that do not matter here.
/// The MCAP library takes memory for what a text announces before it looks whether that is there.
fn lengths_fit(opcode: u8, data: &[u8]) -> Option<bool> {
    let fixed = match opcode {
        op::MESSAGE => return Some(true),
        op::SCHEMA => 2,
        op::CHANNEL => 4,
        op::METADATA => 0,
        _ => return None,
    };
    let blocks = data.get(fixed..).and_then(blocks);
    let fit = blocks.is_some_and(|blocks| match (opcode, blocks.as_slice()) {
        // The last block is a map of texts.
        (op::CHANNEL, [_, _, map]) | (op::METADATA, [_, map]) => self::blocks(map).is_some(),
        (op::SCHEMA, [_, _, _]) => true,
        _ => false,
    });
    Some(fit)
}

/// Blocks that each begin with their length; none where they do not fill `data`.
fn blocks(mut data: &[u8]) -> Option<Vec<&[u8]>> {
    let mut blocks = Vec::new();
    while let Some((length, rest)) = data.split_first_chunk() {
        let length = usize::try_from(u32::from_le_bytes(*length)).ok()?;
        let (block, rest) = rest.split_at_checked(length)?;
        blocks.push(block);
        data = rest;
    }
    data.is_empty().then_some(blocks)
}

impl Samples for McapSamples {
    fn read(
        &mut self,
        most: usize,
        times: &mut Vec<f64>,
        channels: &mut [Vec<f64>],
    ) -> Result<usize, Error> {
        let mut samples = 0;
        let Self {
            stream,
            channel,
            messages,
            wanted,
            first_ns,
        } = self;
        while samples < most {
            let mut broken = false;
            let more = stream.next(|record| {
                let Record::Message { header, data } = record else {
                    return;
                };
                if header.channel_id != *channel {
                    return;
                }
                let Some(numbers) = messages.decode(&data) else {
                    broken = true;
                    return;
                };
                let first = *first_ns.get_or_insert(header.log_time);
                times.push(header.log_time.wrapping_sub(first) as i64 as f64);
                for (channel, &field) in channels.iter_mut().zip(wanted.iter()) {
                    channel.push(numbers.get(field).map_or(f64::NAN, |x| *x));
                }
                samples += 1;
            })?;
            if broken {
                return Err(damaged(
                    &stream.path,
                    "a message has not the bytes of its definition",
                ));
            }
            if !more {
                break;
            }
        }
        Ok(samples)
    }
}
