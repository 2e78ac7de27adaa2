//! HDF5 (The HDF Group, *HDF5 File Format Specification Version 3.0*), and with it NetCDF-4 and MAT files of version 7.3.
//!
//! - Every vector of real numbers is a channel. A matrix has one channel per column (or row, where those are the longer
//!   ones), called `name_1`, `name_2`, ... A channel is called by its path from the group that has all of them.
//! - Its unit is the attribute `units` or `unit`.
//! - A number, as a dataset or an attribute, is the sample rate or the speed as in a MAT file. The one that stands nearest to a
//!   channel counts: its own attribute, then what its group has, and so on outwards.
//! - Packed numbers become values by the attributes `scale_factor` and `add_offset`; `_FillValue` and `missing_value` are missing
//!   samples.
//! - Text, enumerations, compounds and arrays of more axes are left out. Links to other files are not followed.

mod contents;
mod numbers;
mod packing;
mod samples;

use super::guarded::guarded;
use super::recording_format::{RecordingFormat, has};
use crate::measured::{
    MeasuredChannel, MeasuredFile, Options, Recording, TimeColumn, TimeUnit, agree, is_sample_rate, is_speed,
    name_and_unit, one_length, one_rate, only_rate, selected, speed_label, time_unit, unclear_number,
};
use crate::{Error, measured::expansion};
use contents::{Array, Contents};
use hdf5_reader::{Hdf5File, OpenOptions};
use numbers::Number;
use samples::{Hdf5Samples, Reader, contradicts, damaged};
use std::path::Path;

/// HDF5 as a format of recordings.
pub(crate) const FORMAT: RecordingFormat = RecordingFormat {
    name: "HDF5",
    endings: &["h5", "hdf5", "hdf", "he5", "nc", "nxs", "mat"],
    signature_at: Some(0),
    recognise: |head| {
        let signature = b"\x89HDF\r\n\x1a\n";
        let is_matlab = has(head, 0, b"MATLAB 7.3") || has(head, 512, signature);
        match has(head, 0, signature) {
            true => Some("an HDF5 file"),
            false => is_matlab.then_some("a MAT file of version 7.3"),
        }
    },
    open: |path, options| guarded(|| open(path, options), || contradicts(path)),
};

/// Opens a file.
fn open(path: &Path, options: &Options) -> Result<MeasuredFile, Error> {
    // The system's own words for a file that cannot be opened.
    files::open(path).map_err(Error::io("open", path))?;
    let limits = OpenOptions::default().with_max_chunk_bytes(expansion::ALWAYS as usize);
    let file = Hdf5File::open_with_options(path, limits).map_err(|error| damaged(path, error))?;
    let contents = Contents::read(&file).map_err(|error| damaged(path, error))?;
    let root = common_group(&contents.arrays);
    // Each channel with its array, and its place there.
    let (mut all, mut places) = (Vec::new(), Vec::new());
    for array in &contents.arrays {
        for index in 0..array.channels {
            all.push(channel(array, index, &root));
            places.push((array, index));
        }
    }
    let unit_of_time = |i: usize| {
        let name = all[i].name.rsplit('/').next().unwrap_or_default();
        // NetCDF has `seconds since 2026-01-01`.
        let unit = all[i].unit.as_deref();
        time_unit(name, unit.and_then(|unit| unit.split(" since ").next()))
    };
    let (times, rest): (Vec<usize>, Vec<usize>) =
        (0..all.len()).partition(|&i| unit_of_time(i).is_some());
    let candidates: Vec<MeasuredChannel> = rest.iter().map(|&i| all[i].clone()).collect();
    if candidates.is_empty() {
        return Err(damaged(path, "it has no vector or matrix of real numbers"));
    }
    let wanted = selected(&candidates, options)?;
    let channels: Vec<_> = wanted.iter().map(|&i| candidates[i].clone()).collect();
    let wanted: Vec<usize> = wanted.iter().map(|&i| rest[i]).collect();
    let arrays: Vec<&Array> = wanted.iter().map(|&i| places[i].0).collect();
    let lengths = arrays.iter().map(|array| array.samples);
    let length = one_length(FORMAT.name, path, &channels, lengths)?;
    let time = nearest_time(times.iter().map(|&i| (i, places[i].0)), arrays[0], length);
    let column = time.map(|i| TimeColumn {
        name: all[i].name.clone(),
        unit: unit_of_time(i).unwrap_or(TimeUnit::Unstated),
        single_precision: places[i].0.number == Number::F32,
    });
    let samples = Hdf5Samples {
        path: path.to_owned(),
        time: time.map(|i| Reader::new(path, places[i].0, vec![places[i].1])).transpose()?,
        channels: Reader::of_channels(path, wanted.iter().map(|&i| places[i]))?,
        at: 0,
        length,
    };
    let of_file = stated_rate(path, &contents, &arrays)?;
    let nearest = contents.nearest(&arrays[0].path, is_sample_rate);
    let unclear = nearest.first().and_then(|(name, hz)| unclear_number(name, *hz));
    let rate = one_rate(path, of_file.filter(|_| unclear.is_none()), options)?;
    let speed = contents.stated(&arrays[0].path, is_speed);
    let count = channels.len();
    let labels = speed.and_then(speed_label).into_iter().collect();
    MeasuredFile::of_one(channels, labels, |labels| {
        let recording = Recording::new(path, labels, count, rate, column, samples)?;
        Ok(recording.with_unclear_rate(unclear))
    })
}

/// The path of the innermost group that has all arrays, with its `/`; empty for the root.
fn common_group(arrays: &[Array]) -> String {
    let group = |array: &Array| match array.path.rfind('/') {
        Some(end) => array.path[..=end].to_owned(),
        None => String::new(),
    };
    let mut groups = arrays.iter().map(group);
    let first = groups.next().unwrap_or_default();
    groups.fold(first, |common, group| {
        let shared = common.bytes().zip(group.bytes());
        let alike = shared.take_while(|(a, b)| a == b).count();
        let end = common.as_bytes()[..alike].iter().rposition(|b| *b == b'/');
        common[..end.map_or(0, |end| end + 1)].to_owned()
    })
}

/// The channel of this index of an array.
fn channel(array: &Array, index: usize, root: &str) -> MeasuredChannel {
    let of = |path: &str| match array.channels {
        1 => path.to_owned(),
        _ => format!("{path}_{}", index + 1),
    };
    let (name, unit) = name_and_unit(&array.path[root.len()..]);
    MeasuredChannel {
        column: of(&array.path),
        name: of(&name),
        unit: array.unit.clone().or(unit),
    }
}

/// The column of time of this length that shares the longest path with a channel.
fn nearest_time<'a>(
    times: impl Iterator<Item = (usize, &'a Array)>,
    channel: &Array,
    length: u64,
) -> Option<usize> {
    let shared = |time: &Array| {
        let both = time.path.split('/').zip(channel.path.split('/'));
        both.take_while(|(a, b)| a == b).count()
    };
    let same_length = times.filter(|(_, array)| array.samples == length);
    // The first of several that are as near.
    let nearest = same_length.min_by_key(|(_, array)| std::cmp::Reverse(shared(array)));
    nearest.map(|(i, _)| i)
}

/// The sample rate that the file states for all of these arrays.
fn stated_rate(path: &Path, contents: &Contents, arrays: &[&Array]) -> Result<Option<f64>, Error> {
    for array in arrays {
        let nearest = contents.nearest(&array.path, is_sample_rate);
        only_rate(&nearest).map_err(|reason| damaged(path, reason))?;
    }
    let rate = |array: &&Array| contents.stated(&array.path, is_sample_rate);
    let first = rate(&arrays[0]);
    let other = arrays.iter().find(|array| match (first, rate(array)) {
        (Some(first), Some(rate)) => !agree(first, rate),
        (first, rate) => first != rate,
    });
    match other {
        None => Ok(first),
        Some(other) => {
            let hz = |rate: Option<f64>| rate.map_or("none".to_owned(), |rate| format!("{rate} Hz"));
            let reason = format!(
                "its channels differ in sample rate, so that they cannot be read together: {} ({}), {} ({})",
                arrays[0].path,
                hz(first),
                other.path,
                hz(rate(other))
            );
            Err(damaged(path, reason))
        }
    }
}
