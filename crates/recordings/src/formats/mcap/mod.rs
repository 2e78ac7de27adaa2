//! MCAP: one recording per file, for Foxglove, PlotJuggler and the tools of ROS 2.
//!
//! Every sample is one message of one topic, `/crosshead`. All channels are sampled together, and
//! the plots of Foxglove draw a point per message. (An array within a message is plotted against
//! its index, not against time). The message is a flat ROS 2 message in CDR. Its definition
//! lies in the file with the units as comments: nothing has to be installed to read it. The labels
//! are the metadata record `labels`, the sweep is the attachment `sweep.yaml`.
//!
//! The reader takes files of this program, flat ROS 2 messages of other programs, and messages in JSON.

mod read;
mod ros2;
mod write;

pub use write::{Channel, Recording, write};

use super::recording_format::{RecordingFormat, has};

/// MCAP as a format of recordings.
pub(crate) const FORMAT: RecordingFormat = RecordingFormat {
    name: "MCAP",
    endings: &["mcap"],
    signature_at: Some(0),
    recognise: |head| has(head, 0, b"\x89MCAP").then_some("an MCAP file"),
    open: read::open,
};

/// The topic of the samples.
pub const TOPIC: &str = "/crosshead";
