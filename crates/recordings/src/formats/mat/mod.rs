//! MAT files of version 5 to 7 (MathWorks, *MAT-File Format*, 2024): numeric variables, of either
//! byte order, compressed or not.
//!
//! - Every vector is a channel called as its variable. A matrix has one channel per column (or row,
//!   where those are the longer ones) called `name_1`, `name_2`, ...
//! - A variable that is one number is the sample rate, Hz, when it is called `fs`, `sample_rate`, `sampling_rate` or
//!   `sampling_frequency` (with or without `_hz`), and the speed when its name ends in `rpm`.
//! - Text, cells, structures, and complex and sparse arrays are left out.

mod elements;
mod samples;

use super::recording_format::{RecordingFormat, has};
use crate::measured::{
    MeasuredChannel, MeasuredFile, Options, Recording, TimeColumn, TimeUnit, is_sample_rate, is_speed,
    name_and_unit, one_length, one_rate, only_rate, selected, speed_label, time_unit, unclear_number,
};
use crate::Error;
use elements::{Number, damaged, scalar, scan};
use samples::{MatSamples, Place, Reader};
use std::path::Path;

/// MAT as a format of recordings.
pub(crate) const FORMAT: RecordingFormat = RecordingFormat {
    name: "MAT",
    endings: &["mat"],
    signature_at: Some(126),
    recognise: |head| {
        let is_mat = has(head, 126, b"IM") || has(head, 126, b"MI");
        is_mat.then_some("a MAT file")
    },
    open,
};

/// Opens a file.
fn open(path: &Path, options: &Options) -> Result<MeasuredFile, Error> {
    let (big_endian, variables) = scan(path)?;
    let (scalars, arrays): (Vec<_>, Vec<_>) =
        variables.into_iter().partition(|v| v.rows * v.columns == 1);
    let mut all = Vec::new();
    let mut places = Vec::new();
    for variable in &arrays {
        for place in Place::all(path, variable)? {
            let (name, unit) = name_and_unit(&place.name(variable));
            let column = name.clone();
            all.push(MeasuredChannel { column, name, unit });
            places.push((variable, place));
        }
    }
    let is_time = |i: &usize| time_unit(&all[*i].name, all[*i].unit.as_deref()).is_some();
    let (times, rest): (Vec<usize>, Vec<usize>) = (0..all.len()).partition(is_time);
    let candidates: Vec<MeasuredChannel> = rest.iter().map(|&i| all[i].clone()).collect();
    if candidates.is_empty() {
        return Err(damaged(path, "it has no vector or matrix of real numbers"));
    }
    let wanted = selected(&candidates, options)?;
    let channels: Vec<_> = wanted.iter().map(|&i| candidates[i].clone()).collect();
    let wanted: Vec<usize> = wanted.iter().map(|&i| rest[i]).collect();
    let length = one_length(FORMAT.name, path, &channels, wanted.iter().map(|&i| places[i].1.samples))?;
    let time = times
        .iter()
        .copied()
        .find(|&i| places[i].1.samples == length);
    let reader = |&i: &usize| {
        let (variable, place) = &places[i];
        Reader::open(path, big_endian, variable, place)
    };
    let samples = MatSamples {
        path: path.to_owned(),
        time: time.as_ref().map(reader).transpose()?,
        channels: wanted.iter().map(reader).collect::<Result<_, _>>()?,
        left: length,
    };
    let time = time.map(|i| TimeColumn {
        name: all[i].name.clone(),
        unit: time_unit(&all[i].name, all[i].unit.as_deref()).unwrap_or(TimeUnit::Unstated),
        single_precision: places[i].0.number == Number::F32,
    });
    let scalar = |is: fn(&str) -> bool| {
        let found = scalars.iter().find(|variable| is(&variable.name));
        let value = found.map(|variable| scalar(path, big_endian, variable));
        value.transpose()
    };
    let mut rates = Vec::new();
    for variable in scalars.iter().filter(|variable| is_sample_rate(&variable.name)) {
        rates.push((variable.name.as_str(), self::scalar(path, big_endian, variable)?));
    }
    let of_file = only_rate(&rates).map_err(|reason| damaged(path, reason))?;
    let unclear = rates.first().and_then(|(name, hz)| unclear_number(name, *hz));
    let rate = one_rate(path, of_file.filter(|_| unclear.is_none()), options)?;
    let labels = scalar(is_speed)?.and_then(speed_label);
    let count = channels.len();
    MeasuredFile::of_one(channels, labels.into_iter().collect(), |labels| {
        let recording = Recording::new(path, labels, count, rate, time, samples)?;
        Ok(recording.with_unclear_rate(unclear))
    })
}
