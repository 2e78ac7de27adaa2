//! The recording of a run: its channels in SI units, and where its crank stood.

use crate::observation::Channel;
use input::bundle::{self, Bundle};
use input::bundle_channel::Meaning;
use recordings::measured::{MeasuredFile, Options};
use signal::crank_angle::CrankAngle;
use signal::tacho;
use std::f64::consts::TAU;

/// Samples that are read at a time.
const BLOCK: usize = 1 << 16;
/// Speed that is taken for a recording over the crank angle alone, rpm: pressures over the angle do
/// not depend on it.
const ANY_SPEED: f64 = 60.0;

/// A recording.
pub(super) struct Recording {
    pub(super) speed_rpm: f64,
    pub(super) sample_rate: f64,
    /// Whether the bundle or the file states the sample rate, or has times.
    pub(super) is_timed: bool,
    /// In [0, 2π), rad; its zero is not known where it comes from a tacho without an angle.
    pub(super) crank_angle: Option<Vec<f64>>,
    pub(super) channels: Vec<Channel>,
}

/// Reads the recording of a run whose channels have these meanings.
///
/// # Errors
/// In words, what is wrong with it.
pub(super) fn read(
    bundle: &Bundle,
    run: &bundle::Run,
    meanings: &[Meaning],
) -> Result<Recording, String> {
    let listed = || run.channels.iter().zip(meanings);
    let used = listed().filter(|(_, meaning)| !matches!(meaning, Meaning::Time | Meaning::Other));
    let columns: Vec<&str> = used.map(|(channel, _)| channel.column.as_str()).collect();
    let series = Series::read(bundle, run, &columns)?;
    let mut crank_angle = None;
    let mut pulses = None;
    let mut channels = Vec::new();
    for (channel, meaning) in listed() {
        let samples = || series.column(&channel.column).iter().map(|x| f64::from(*x));
        match meaning {
            Meaning::CrankAngle(to_si) => {
                let wrapped = samples().map(|x| to_si.of(x).rem_euclid(TAU));
                crank_angle = Some(wrapped.collect::<Vec<f64>>());
            }
            Meaning::Tacho { at } => {
                let angle = tacho::from_pulses(&samples().collect::<Vec<f64>>());
                let angle = angle.map_err(|e| format!("channel {}: {e}", channel.column))?;
                let at = at.unwrap_or(0.0);
                pulses = Some(angle.iter().map(|a| (a + at).rem_euclid(TAU)).collect());
            }
            Meaning::Measured { column, to_si } => channels.push(Channel {
                column: column.clone(),
                samples: samples().map(|x| to_si.of(x)).collect(),
            }),
            Meaning::Time | Meaning::Other => {}
        }
    }
    let crank_angle = crank_angle.or(pulses);
    let stated = run.speed_rpm.map(|speed| speed.get());
    let per_revolution = match &crank_angle {
        Some(angle) => {
            let angle = CrankAngle::from_encoder(angle);
            let angle = angle.map_err(|error| format!("channel crank angle: {error}"))?;
            Some(angle.samples_per_revolution())
        }
        None => None,
    };
    let (speed_rpm, sample_rate) = match (stated, series.sample_rate, per_revolution) {
        (Some(speed), Some(rate), _) => (speed, rate),
        (None, Some(rate), Some(samples)) => (60.0 * rate / samples, rate),
        // Over the crank angle alone: as if it turned evenly.
        (speed, None, Some(samples)) => {
            if speed.is_none() && channels.iter().any(|c| c.quantity().is_vibration()) {
                return Err("a vibration needs speed_rpm, or times or sample_rate_hz".into());
            }
            let speed = speed.unwrap_or(ANY_SPEED);
            (speed, samples * speed / 60.0)
        }
        (_, None, None) => {
            return Err(
                "its sample rate is not known: sample_rate_hz is missing, and there is \
                        neither a column of time nor a crank angle"
                    .into(),
            );
        }
        (None, Some(_), None) => {
            return Err("speed_rpm is missing, and there is no crank angle to take it from".into());
        }
    };
    Ok(Recording {
        speed_rpm,
        sample_rate,
        is_timed: series.sample_rate.is_some(),
        crank_angle,
        channels,
    })
}

/// Columns of a file.
struct Series {
    sample_rate: Option<f64>,
    columns: Vec<String>,
    samples: Vec<Vec<f32>>,
}

impl Series {
    fn read(bundle: &Bundle, run: &bundle::Run, columns: &[&str]) -> Result<Self, String> {
        let path = bundle.path_of(run).map_err(|error| error.to_string())?;
        let options = Options {
            columns: columns.iter().map(|c| (*c).to_owned()).collect(),
            sample_rate_hz: run.sample_rate_hz.map(|rate| rate.get()),
            skipped_lines: 0,
        };
        let mut file = MeasuredFile::open(&path, &options).map_err(|error| match error {
            recordings::Error::NoColumn { name, among } => {
                let nearest = input::nearest(&name, among.iter().map(String::as_str));
                let hint = nearest.map_or(String::new(), |n| format!("; did you mean {n}?"));
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
        let mut samples: Vec<Vec<f32>> = vec![Vec::new(); found.len()];
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
            columns: found,
            samples,
        };
        series.check(run, &path.display().to_string(), columns)?;
        Ok(series)
    }

    fn check(&self, run: &bundle::Run, file: &str, columns: &[&str]) -> Result<(), String> {
        let count = self.samples.first().map_or(0, Vec::len);
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

    fn column(&self, column: &str) -> &[f32] {
        let place = self.columns.iter().position(|c| c == column);
        place.map_or(&[], |place| &self.samples[place])
    }
}
