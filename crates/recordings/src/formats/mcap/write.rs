//! Recordings to MCAP.

use super::TOPIC;
use crate::Error;
use mcap::records::{MessageHeader, Metadata};
use mcap::write::NoSeek;
use mcap::{Attachment, McapError, WriteOptions};
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;

/// The definition of the time stamp, as it follows the message in the schema.
const TIME: &str = "
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
";

/// The first bytes of a message: plain CDR, little-endian.
const CDR_LITTLE_ENDIAN: [u8; 4] = [0, 1, 0, 0];

const NANOSECONDS: u64 = 1_000_000_000;

/// One channel of a recording.
#[derive(Clone, Copy, Debug)]
pub struct Channel<'a> {
    /// Name; dots (`throw1.cylinder_pressure_pa`) become `_` in the message.
    pub name: &'a str,
    /// Unit as people write it.
    pub unit: &'a str,
    /// The samples.
    pub samples: &'a [f32],
}

/// A recording with all that belongs to it.
#[derive(Clone, Copy, Debug)]
pub struct Recording<'a> {
    /// Samples per second; the first sample is at time 0.
    pub sample_rate_hz: f64,
    /// The channels, all of one length.
    pub channels: &'a [Channel<'a>],
    /// Names and values of what is known about the case.
    pub labels: &'a BTreeMap<String, String>,
    /// The resolved sweep, from which the recording can be made again.
    pub sweep_yaml: &'a str,
}

/// Writes a recording and hands the writer back.
///
/// # Errors
/// When the sample rate is not positive, the channels differ in length, a name cannot be that of a
/// field, or the writer fails.
pub fn write<W: Write>(out: W, recording: &Recording) -> Result<W, Error> {
    if !(recording.sample_rate_hz > 0.0 && recording.sample_rate_hz.is_finite()) {
        return Err(Error::SampleRate(recording.sample_rate_hz));
    }
    let samples = samples(recording.channels)?;
    let schema = message_definition(recording.channels)?;
    // No threads, no clock, no version of a library: the same recording gives the same bytes.
    let options = WriteOptions::new()
        .library("crosshead")
        .compression_level(3)
        .compression_threads(0)
        .disable_seeking(true);
    let mut file = options.create(NoSeek::new(out)).map_err(encode)?;
    file.write_metadata(&Metadata {
        name: "labels".into(),
        metadata: recording.labels.clone(),
    })
    .map_err(encode)?;
    file.attach(&Attachment {
        log_time: 0,
        create_time: 0,
        name: "sweep.yaml".into(),
        media_type: "application/yaml".into(),
        data: Cow::Borrowed(recording.sweep_yaml.as_bytes()),
    })
    .map_err(encode)?;
    let schema = file
        .add_schema("crosshead/msg/Sample", "ros2msg", schema.as_bytes())
        .map_err(encode)?;
    let channel_id = file
        .add_channel(schema, TOPIC, "cdr", &BTreeMap::new())
        .map_err(encode)?;
    let mut message = Vec::new();
    for i in 0..samples {
        let time = time_ns(i, recording.sample_rate_hz);
        let header = MessageHeader {
            channel_id,
            sequence: i as u32,
            log_time: time,
            publish_time: time,
        };
        encode_message(&mut message, time, i, recording.channels);
        file.write_to_known_channel(&header, &message)
            .map_err(encode)?;
    }
    file.finish().map_err(encode)?;
    let mut out = file.into_inner().into_inner();
    out.flush().map_err(Error::Write)?;
    Ok(out)
}

fn encode(error: McapError) -> Error {
    Error::encode("MCAP", error)
}

/// The number of samples of every channel.
fn samples(channels: &[Channel]) -> Result<usize, Error> {
    let expected = channels.first().map_or(0, |channel| channel.samples.len());
    for channel in channels {
        if channel.samples.len() != expected {
            return Err(Error::ChannelLength {
                channel: channel.name.to_owned(),
                found: channel.samples.len(),
                expected,
            });
        }
    }
    Ok(expected)
}

/// Time of a sample, to the nearest nanosecond.
fn time_ns(i: usize, sample_rate_hz: f64) -> u64 {
    (i as f64 * NANOSECONDS as f64 / sample_rate_hz).round() as u64
}

/// The message in the language of ROS 2: a time stamp, then a number per channel.
fn message_definition(channels: &[Channel]) -> Result<String, Error> {
    let mut text = "builtin_interfaces/Time stamp\n".to_owned();
    let mut names = BTreeSet::from(["stamp".to_owned()]);
    for channel in channels {
        let name = field_name(channel.name)?;
        // A line break within the unit would end the comment.
        let unit = channel
            .unit
            .split_whitespace()
            .collect::<Vec<_>>()
            .join(" ");
        text += format!("float32 {name} # {unit}").trim_end_matches(" # ");
        text += "\n";
        if !names.insert(name.clone()) {
            return Err(Error::DuplicateField(name));
        }
    }
    Ok(text + TIME.trim_start())
}

/// The name as a field: letters, digits and single underscores, starting with a letter and not
/// ending in an underscore (design.ros2.org, "Interface definition", field names).
fn field_name(name: &str) -> Result<String, Error> {
    let field = name.replace('.', "_");
    let letters = field
        .bytes()
        .all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_');
    let shape = field.starts_with(|c: char| c.is_ascii_lowercase())
        && !field.ends_with('_')
        && !field.contains("__");
    if letters && shape {
        Ok(field)
    } else {
        Err(Error::FieldName(name.to_owned()))
    }
}

/// CDR: every number little-endian at a multiple of its size, which here leaves no gaps.
fn encode_message(message: &mut Vec<u8>, time_ns: u64, i: usize, channels: &[Channel]) {
    message.clear();
    message.extend(CDR_LITTLE_ENDIAN);
    message.extend(((time_ns / NANOSECONDS) as i32).to_le_bytes());
    message.extend(((time_ns % NANOSECONDS) as u32).to_le_bytes());
    for channel in channels {
        message.extend(channel.samples[i].to_le_bytes());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mcap::{MessageStream, Summary};

    fn channel<'a>(name: &'a str, samples: &'a [f32]) -> Channel<'a> {
        Channel {
            name,
            unit: "m/s^2",
            samples,
        }
    }

    fn written(channels: &[Channel], sample_rate_hz: f64) -> Result<Vec<u8>, Error> {
        let labels = BTreeMap::from([("fault".to_owned(), "big_end".to_owned())]);
        let sweep_yaml = "seed: 7\n";
        let recording = Recording {
            sample_rate_hz,
            channels,
            labels: &labels,
            sweep_yaml,
        };
        write(Vec::new(), &recording)
    }

    #[test]
    fn a_recording_reads_back_message_by_message() {
        let first: Vec<f32> = (0..100_000).map(|i| i as f32 * 0.5).collect();
        let second: Vec<f32> = first.iter().map(|x| -x).collect();
        let channels = [
            channel("throw1.acceleration_m_s2", &first),
            channel("b", &second),
        ];
        let bytes = written(&channels, 24_000.0).unwrap();
        assert_eq!(bytes, written(&channels, 24_000.0).unwrap());

        let mut count = 0;
        for (i, message) in MessageStream::new(&bytes).unwrap().enumerate() {
            let message = message.unwrap();
            // 24 kHz: a sample every 41 666.67 ns, so that every third is at a whole number.
            let time = (i as u64 * 125_000 + 1) / 3;
            assert_eq!(
                (message.channel.topic.as_str(), message.log_time),
                (TOPIC, time)
            );
            let word = |k: usize| message.data[4 * k..4 * k + 4].try_into().unwrap();
            assert_eq!(word(0), CDR_LITTLE_ENDIAN);
            let stamp = u64::from(u32::from_le_bytes(word(1))) * NANOSECONDS
                + u64::from(u32::from_le_bytes(word(2)));
            assert_eq!(stamp, time);
            assert_eq!(
                (f32::from_le_bytes(word(3)), f32::from_le_bytes(word(4))),
                (first[i], second[i])
            );
            count += 1;
        }
        assert_eq!(count, first.len());

        let summary = Summary::read(&bytes).unwrap().unwrap();
        assert!(summary.chunk_indexes.len() > 1);
        let schema = &summary.schemas[&1];
        let definition = std::str::from_utf8(&schema.data).unwrap();
        assert!(
            definition
                .contains("\nfloat32 throw1_acceleration_m_s2 # m/s^2\nfloat32 b # m/s^2\n==="),
            "{definition}"
        );
        let labels = mcap::read::metadata(&bytes, &summary.metadata_indexes[0]).unwrap();
        assert_eq!(
            (labels.name.as_str(), labels.metadata["fault"].as_str()),
            ("labels", "big_end")
        );
        let sweep = mcap::read::attachment(&bytes, &summary.attachment_indexes[0]).unwrap();
        assert_eq!(
            (sweep.name.as_str(), &*sweep.data),
            ("sweep.yaml", b"seed: 7\n".as_slice())
        );
    }

    #[test]
    fn a_recording_without_samples_is_a_file() {
        let bytes = written(&[channel("a", &[])], 1e4).unwrap();
        assert_eq!(MessageStream::new(&bytes).unwrap().count(), 0);
    }

    #[test]
    fn what_cannot_be_a_message_is_refused() {
        let message = |channels: &[Channel]| written(channels, 1e4).unwrap_err().to_string();
        for name in [
            "",
            "2nd",
            "Acceleration",
            "a__b",
            "a_",
            "a b",
            "a-b",
            "druck_µpa",
        ] {
            assert!(
                message(&[channel(name, &[])]).contains("cannot be a field"),
                "{name}"
            );
        }
        for names in [["a.b", "a_b"], ["stamp", "a"]] {
            let found = message(&names.map(|name| channel(name, &[])));
            assert!(found.starts_with("two channels are the field"), "{found}");
        }
        assert_eq!(
            message(&[channel("a", &[0.0]), channel("b", &[])]),
            "channel `b` has 0 samples where the first channel has 1"
        );
        for rate in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(written(&[], rate), Err(Error::SampleRate(_))));
        }
    }
}
