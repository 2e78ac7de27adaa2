//! The files of a run, read, and brought to one time base where there are several.

use input::bundle::{self, Bundle, Channel};
use input::bundle_channel::Meaning;
use recordings::measured::{MeasuredFile, Options};
use std::path::{Path, PathBuf};

/// Samples that are read at a time.
const BLOCK: usize = 1 << 16;
/// Share of a sample by which two files of one run may drift apart from their first to their last sample.
const DRIFT: f64 = 0.5;

/// Columns of a file.
pub(super) struct Series {
    pub(super) sample_rate: Option<f64>,
    file: PathBuf,
    /// Time of the first sample, s.
    start_s: Option<f64>,
    columns: Vec<String>,
    samples: Vec<Vec<f64>>,
}

/// The samples of a channel.
pub(super) fn samples_of<'a>(all: &'a [Series], channel: &Channel) -> &'a [f64] {
    let is_of = |series: &&Series| {
        channel
            .file
            .as_ref()
            .is_none_or(|file| *file == series.file)
    };
    let series = all.iter().find(is_of);
    series.map_or(&[], |series| series.column(&channel.column))
}

/// Brings the files of a run to one time base: they begin with the latest of their first samples and are equally
/// long. Nothing is interpolated, so that samples of two files are up to half a sample apart.
fn align(all: &mut [Series]) -> Result<(), String> {
    if all.len() < 2 {
        return Ok(());
    }
    let mut known = Vec::new();
    for series in all.iter() {
        let file = series.file.display();
        let rate = series.sample_rate.ok_or_else(|| {
            format!("{file}: its sample rate is not known: it has no column of time, and sample_rate_hz is missing")
        })?;
        let start = series.start_s.ok_or_else(|| {
            format!(
                "{file}: when it starts is not known: it has no column of time; state `start_s` beside it in `files`, \
                 for each file without one"
            )
        })?;
        known.push((rate, start, series.len()));
    }
    let (rate, _, longest) = known[0];
    for ((other, ..), series) in known.iter().zip(all.iter()) {
        if (other / rate - 1.0).abs() * longest as f64 > DRIFT {
            return Err(format!(
                "{} has {rate} samples per second and {} has {other}: export the files of one run at one rate, or \
                 list them as two runs",
                all[0].file.display(),
                series.file.display()
            ));
        }
    }
    let latest = known
        .iter()
        .map(|(_, start, _)| *start)
        .fold(f64::NEG_INFINITY, f64::max);
    let skips = known
        .iter()
        .map(|(_, start, _)| ((latest - start) * rate).round() as usize);
    let skips: Vec<usize> = skips.collect();
    let lengths = known
        .iter()
        .zip(&skips)
        .map(|((.., len), skip)| len.saturating_sub(*skip));
    let length = lengths.min().unwrap_or(0);
    if length == 0 {
        let each = known
            .iter()
            .zip(all.iter())
            .map(|((rate, start, len), series)| {
                let end = start + *len as f64 / rate;
                format!("{} from {start} to {end} s", series.file.display())
            });
        return Err(format!(
            "its files have no time in common: {}; `start_s` in `files` states when each starts on a common clock",
            each.collect::<Vec<_>>().join(", ")
        ));
    }
    for (series, skip) in all.iter_mut().zip(skips) {
        for samples in &mut series.samples {
            samples.drain(..skip);
            samples.truncate(length);
        }
    }
    Ok(())
}

impl Series {
    /// The recordings of a run whose channels have these meanings, on one time base.
    ///
    /// # Errors
    /// In words, what is wrong with one of them, or with all together.
    pub(super) fn of_run(
        bundle: &Bundle,
        run: &bundle::Run,
        meanings: &[Meaning],
    ) -> Result<Vec<Self>, String> {
        let is_used = |i: usize| !matches!(meanings.get(i), Some(Meaning::Time | Meaning::Other));
        let mut all = Vec::new();
        for (index, (file, stated)) in run.recordings().enumerate() {
            let used = run.channels_of(file).filter(|(i, _)| is_used(*i));
            let columns: Vec<&str> = used.map(|(_, channel)| channel.column.as_str()).collect();
            if columns.is_empty() && index > 0 {
                continue;
            }
            let path = bundle.path_of_file(run, index);
            let path = path.map_err(|error| error.to_string())?;
            let mut series = Self::read(&path, run, &columns)?;
            series.file = file.to_owned();
            series.start_s = stated.or(series.start_s);
            all.push(series);
        }
        align(&mut all)?;
        Ok(all)
    }

    fn len(&self) -> usize {
        self.samples.first().map_or(0, Vec::len)
    }

    fn read(path: &Path, run: &bundle::Run, columns: &[&str]) -> Result<Self, String> {
        let options = Options {
            columns: columns.iter().map(|c| (*c).to_owned()).collect(),
            sample_rate_hz: run.sample_rate_hz.map(|rate| rate.get()),
            skipped_lines: 0,
        };
        let mut file = MeasuredFile::open(path, &options).map_err(|error| match error {
            recordings::Error::NoColumn { name, among } => {
                let nearest = input::nearest(&name, among.iter().map(String::as_str));
                let hint = nearest.map_or(".".into(), |n| format!("; did you mean {n}?"));
                let all = among.join(", ");
                let file = path.display();
                format!("{file} has no column {name}{hint} Its columns are {all}.")
            }
            error => error.to_string(),
        })?;
        let heads = file
            .channels()
            .iter()
            .map(|c| (c.column.clone(), c.name.clone()));
        // A channel may be asked for by its name without the unit.
        let asked = |(column, name): (String, String)| match columns.contains(&column.as_str()) {
            true => column,
            false => name,
        };
        let found: Vec<String> = heads.map(asked).collect();
        let mut recording = match file.next() {
            Some(recording) => recording.map_err(|e| e.to_string())?,
            None => return Err(format!("{} is empty", path.display())),
        };
        let mut samples: Vec<Vec<f64>> = vec![Vec::new(); found.len()];
        loop {
            let block = recording
                .read(BLOCK, &mut samples)
                .map_err(|e| e.to_string())?;
            if let Some(gap) = block.gap_s {
                let at = samples.first().map_or(0, Vec::len) - block.samples;
                return Err(format!("{gap} s are missing before sample {at}"));
            }
            if block.samples == 0 {
                break;
            }
        }
        let series = Self {
            sample_rate: recording.sample_rate_hz(),
            file: path.to_owned(),
            start_s: recording.start_s(),
            columns: found,
            samples,
        };
        series.check(run, &path.display().to_string(), columns)?;
        Ok(series)
    }

    fn check(&self, run: &bundle::Run, file: &str, columns: &[&str]) -> Result<(), String> {
        let count = self.len();
        if let Some(stated) = run.samples.filter(|stated| *stated != count as u64) {
            return Err(format!(
                "{file} has {count} samples, and recordings.yaml says {stated}: is the file cut off?"
            ));
        }
        for column in columns {
            if let Some(i) = self.column(column).iter().position(|x| !x.is_finite()) {
                return Err(format!(
                    "channel {column} of {file} has no number at sample {i}"
                ));
            }
        }
        Ok(())
    }

    fn column(&self, column: &str) -> &[f64] {
        let place = self.columns.iter().position(|c| c == column);
        place.map_or(&[], |place| &self.samples[place])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file whose sample i, taken at `start_s` + i / rate, has its time as its value.
    fn file(name: &str, start_s: Option<f64>, rate: Option<f64>, count: usize) -> Series {
        let time = |i: usize| start_s.unwrap_or(0.0) + i as f64 / rate.unwrap_or(1.0);
        Series {
            sample_rate: rate,
            file: name.into(),
            start_s,
            columns: vec!["a".to_owned()],
            samples: vec![(0..count).map(time).collect()],
        }
    }

    #[test]
    fn files_begin_together_and_are_equally_long() {
        let mut all = [
            file("a.csv", Some(10.0), Some(1000.0), 5000),
            file("b.csv", Some(12.0), Some(1000.0), 5000),
            file("c.csv", Some(11.5), Some(1000.0), 1000),
        ];
        align(&mut all).unwrap();
        for series in &all {
            assert_eq!(series.len(), 500, "{}", series.file.display());
            assert!((series.samples[0][0] - 12.0).abs() < 1e-5);
        }
    }

    #[test]
    fn what_cannot_be_aligned_is_refused_with_its_reason() {
        let first = || file("a.csv", Some(0.0), Some(1000.0), 5000);
        for (second, expected) in [
            (
                file("b.csv", None, Some(1000.0), 10),
                "b.csv: when it starts is not known",
            ),
            (
                file("b.csv", Some(0.0), None, 10),
                "b.csv: its sample rate is not known",
            ),
            (
                file("b.csv", Some(0.0), Some(500.0), 10),
                "a.csv has 1000 samples per second and b.csv has 500",
            ),
            (
                file("b.csv", Some(60.0), Some(1000.0), 10),
                "no time in common: a.csv from 0 to 5 s, b.csv from 60 to 60.01 s",
            ),
        ] {
            let message = align(&mut [first(), second]).unwrap_err();
            assert!(message.contains(expected), "{message}");
        }
        assert_eq!(align(&mut [file("a.csv", None, None, 3)]), Ok(()));
    }
}
