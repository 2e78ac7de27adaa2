//! MAT files of version 5 to 7 (MathWorks, *MAT-File Format*, 2024): numeric variables, of either
//! byte order, compressed or not.
//!
//! - Every vector is a channel called as its variable. A matrix has one channel per column (or row,
//!   where those are the longer ones) called `name_1`, `name_2`, ...
//! - A variable that is one number is the sample rate when it is called `fs`, `Fs` or `sample_rate_hz`, and the speed
//!   when its name ends in `rpm`.
//! - Text, cells, structures, and complex and sparse arrays are left out.

mod elements;
mod samples;

use super::recording_format::{RecordingFormat, Seen, has};
use crate::measured::{
    MeasuredChannel, MeasuredFile, Options, Recording, TimeColumn, name_and_unit, one_rate,
    seconds_per_unit, selected,
};
use crate::{Column, Error, Kind, Value};
use elements::{Number, damaged, scalar, scan};
use samples::{MatSamples, Place, Reader};
use std::path::Path;

/// MAT as a format of recordings.
pub(crate) const FORMAT: RecordingFormat = RecordingFormat {
    name: "MAT",
    endings: &["mat"],
    signature_at: Some(126),
    recognise: |head| {
        if has(head, 0, b"MATLAB 7.3") || has(head, 512, b"\x89HDF\r\n\x1a\n") {
            let words = "a MAT file of version 7.3, which is HDF5 (that of `save -v7` is read)";
            return Some(Seen::Unreadable(words));
        }
        let is_mat = has(head, 126, b"IM") || has(head, 126, b"MI");
        is_mat.then_some(Seen::Readable("a MAT file"))
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
    let is_time = |i: &usize| seconds_per_unit(&all[*i].name, all[*i].unit.as_deref()).is_some();
    let (times, rest): (Vec<usize>, Vec<usize>) = (0..all.len()).partition(is_time);
    let candidates: Vec<MeasuredChannel> = rest.iter().map(|&i| all[i].clone()).collect();
    if candidates.is_empty() {
        return Err(damaged(path, "it has no vector or matrix of real numbers"));
    }
    let wanted = selected(&candidates, options)?;
    let channels: Vec<_> = wanted.iter().map(|&i| candidates[i].clone()).collect();
    let wanted: Vec<usize> = wanted.iter().map(|&i| rest[i]).collect();
    let length = one_length(path, &channels, wanted.iter().map(|&i| places[i].1.samples))?;
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
        seconds_per_unit: seconds_per_unit(&all[i].name, all[i].unit.as_deref()).unwrap_or(1.0),
        single_precision: places[i].0.number == Number::F32,
    });
    let scalar = |is: &dyn Fn(&str) -> bool| {
        let found = scalars.iter().find(|v| is(&v.name.to_ascii_lowercase()));
        found
            .map(|variable| scalar(path, big_endian, variable))
            .transpose()
    };
    let stated = scalar(&|name| ["fs", "sample_rate_hz"].contains(&name))?;
    let rate = one_rate(path, stated, options)?;
    let speed = scalar(&|name| name.ends_with("rpm"))?.filter(|s| s.is_finite() && *s > 0.0);
    let speed = speed.map(|speed| {
        let column = Column::new("speed_rpm", Kind::Real, "speed of the crank").unit("rpm");
        (column.optional(), Value::from(speed))
    });
    let count = channels.len();
    MeasuredFile::of_one(channels, speed.into_iter().collect(), |labels| {
        Recording::new(path, labels, count, rate, time, samples)
    })
}

fn one_length(
    path: &Path,
    channels: &[MeasuredChannel],
    lengths: impl Iterator<Item = u64> + Clone,
) -> Result<u64, Error> {
    let first = lengths.clone().next().unwrap_or(0);
    if lengths.clone().all(|length| length == first) {
        return Ok(first);
    }
    let shown: Vec<String> = channels
        .iter()
        .zip(lengths)
        .take(20)
        .map(|(channel, length)| format!("{} ({length})", channel.name))
        .collect();
    let shown = shown.join(", ");
    Err(damaged(
        path,
        format!("its variables differ in length, so that they cannot be read together: {shown}"),
    ))
}
