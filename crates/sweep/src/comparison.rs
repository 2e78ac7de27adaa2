//! Two recordings, or two datasets, side by side: features, waveforms, spectra.

use crate::in_order::in_order;
use features::recorded::{Error, Recorded, Said, Table, WindowLength, inputs, recorded, row};
use recordings::{Kind, Role, Value};
use serde::Serialize;
use signal::amplitude_spectrum::{AmplitudeSpectrum, amplitude_spectrum};
use signal::angle_resampling::AngleGrid;
use signal::crank_angle::CrankAngle;
use signal::windows::Window;
use std::path::{Path, PathBuf};

/// Points of a waveform over a revolution: one every half degree.
const WAVEFORM_POINTS: usize = 720;

/// What two recordings or datasets have in common, and how it differs.
#[derive(Clone, Debug, Serialize)]
pub struct Comparison {
    /// The two, in the order in which they were named.
    pub sides: [Side; 2],
    /// The features of both, in the order of the table of features.
    pub features: Vec<ComparedFeature>,
    /// The channels of both, of the first window of each.
    #[serde(skip)]
    pub channels: Vec<ComparedChannel>,
}

/// One of the two.
#[derive(Clone, Debug, Serialize)]
pub struct Side {
    /// As it was named.
    pub name: String,
    /// Windows over which features are averaged.
    pub windows: u64,
}

/// A feature of both.
#[derive(Clone, Debug, Serialize)]
pub struct ComparedFeature {
    /// Its column.
    pub name: String,
    /// Its unit; `1` for a pure number.
    pub unit: String,
    /// Its mean over the windows of the first that have it.
    pub a: Option<f64>,
    /// Its mean over the windows of the second that have it.
    pub b: Option<f64>,
    /// b − a.
    pub difference: Option<f64>,
    /// b / a; none where a is 0.
    pub ratio: Option<f64>,
}

/// A channel of both.
#[derive(Clone, Debug)]
pub struct ComparedChannel {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// The means over the revolutions, at crank angles every half degree; none where the crank angle of one
    /// is not known.
    pub waveforms: Option<[Vec<f64>; 2]>,
    /// The amplitudes over frequency, of a Hann window.
    pub spectra: [AmplitudeSpectrum; 2],
}

impl Comparison {
    /// The features, those that differ most first.
    pub fn most_different(&self) -> Vec<&ComparedFeature> {
        let distance = |feature: &ComparedFeature| feature.distance().unwrap_or(-1.0);
        let mut features: Vec<&ComparedFeature> = self.features.iter().collect();
        features.sort_by(|a, b| distance(b).total_cmp(&distance(a)));
        features
    }
}

impl ComparedFeature {
    /// |b − a| over |a| + |b|: 0 for equal values, 1 for opposite signs or one that is 0.
    pub fn distance(&self) -> Option<f64> {
        let (a, b) = (self.a?, self.b?);
        let size = a.abs() + b.abs();
        (size > 0.0).then(|| (b - a).abs() / size)
    }
}

/// Compares what stands at two paths, each read as `said`, in windows of this length.
///
/// # Errors
/// A path that is no recording, bundle or dataset, or a recording that cannot be used.
pub fn compare(
    paths: [&Path; 2],
    said: &Said,
    length: WindowLength,
    pool: &rayon::ThreadPool,
) -> Result<Comparison, Error> {
    let [a, b] = paths.map(|path| Read::new(path, said, length, pool));
    let (a, b) = (a?, b?);
    let features = a.columns.iter().zip(&a.means).filter_map(|(column, mean)| {
        let other = b.columns.iter().position(|c| c == column)?;
        Some(compared(column, *mean, b.means[other]))
    });
    let features = features.collect();
    Ok(Comparison {
        features,
        channels: channels(&a, &b),
        sides: [a.side, b.side],
    })
}

fn compared((name, unit): &(String, String), a: Option<f64>, b: Option<f64>) -> ComparedFeature {
    let both = a.zip(b);
    ComparedFeature {
        name: name.clone(),
        unit: unit.clone(),
        a,
        b,
        difference: both.map(|(a, b)| b - a),
        ratio: both.filter(|(a, _)| *a != 0.0).map(|(a, b)| b / a),
    }
}

/// One of the two, read.
struct Read {
    side: Side,
    /// Names and units of its features.
    columns: Vec<(String, String)>,
    means: Vec<Option<f64>>,
    first: Option<Recorded>,
}

impl Read {
    fn new(
        path: &Path,
        said: &Said,
        length: WindowLength,
        pool: &rayon::ThreadPool,
    ) -> Result<Self, Error> {
        let paths: [PathBuf; 1] = [path.to_owned()];
        let inputs = inputs(&paths, said)?;
        let table = Table::new(&inputs, said)?;
        let columns = table.schema().columns().iter().enumerate();
        let is_feature = |role: Option<Role>| role == Some(Role::Feature);
        let columns = columns.filter(|(_, c)| is_feature(c.role) && c.kind == Kind::Real);
        let unit = |unit: &Option<String>| unit.clone().unwrap_or_else(|| "1".to_owned());
        let columns = columns.map(|(i, c)| (i, (c.name.clone(), unit(&c.unit))));
        let (places, columns): (Vec<usize>, Vec<_>) = columns.unzip();
        let mut sums = vec![(0.0, 0_u64); places.len()];
        let mut windows = 0;
        let mut first = None;
        let look_ahead = 2 * pool.current_num_threads();
        in_order(
            pool,
            look_ahead,
            table.windows(length),
            |job| job.as_ref().ok().map(row),
            |job, row| {
                let job = job?;
                first.get_or_insert_with(|| recorded(&job));
                windows += 1;
                let values = row.map_or_else(Vec::new, |row| row.values);
                for (sum, place) in sums.iter_mut().zip(&places) {
                    if let Some(Value::Real(value)) = values.get(*place) {
                        *sum = (sum.0 + value, sum.1 + 1);
                    }
                }
                Ok::<(), Error>(())
            },
        )?;
        let mean = |(sum, count): (f64, u64)| (count > 0).then(|| sum / count as f64);
        Ok(Self {
            side: Side {
                name: path.display().to_string(),
                windows,
            },
            columns,
            means: sums.into_iter().map(mean).collect(),
            first,
        })
    }
}

/// The channels that both have.
fn channels(a: &Read, b: &Read) -> Vec<ComparedChannel> {
    let (Some(a), Some(b)) = (&a.first, &b.first) else {
        return Vec::new();
    };
    let both = a.channels.iter().filter_map(|channel| {
        let same = |c: &&signal::channel::Channel| c.name == channel.name && c.unit == channel.unit;
        let other = b.channels.iter().find(same)?;
        let [x, y] = [channel, other].map(|c| c.samples.iter().map(|x| f64::from(*x)).collect());
        let [x, y]: [Vec<f64>; 2] = [x, y];
        Some(ComparedChannel {
            name: channel.name.clone(),
            unit: channel.unit.clone(),
            waveforms: waveform(a, &x).zip(waveform(b, &y)).map(<[_; 2]>::from),
            spectra: [spectrum(a, &x)?, spectrum(b, &y)?],
        })
    });
    both.collect()
}

/// The mean over the revolutions; none without a crank angle from top dead centre.
fn waveform(of: &Recorded, x: &[f64]) -> Option<Vec<f64>> {
    let readings: Vec<f64> = of
        .crank_angle
        .as_ref()?
        .iter()
        .map(|a| f64::from(*a))
        .collect();
    let angle = CrankAngle::from_encoder(&readings).ok()?;
    let grid = AngleGrid::new(&angle, WAVEFORM_POINTS).ok()?;
    Some(grid.resample(x).ok()?.synchronous_mean())
}

fn spectrum(of: &Recorded, x: &[f64]) -> Option<AmplitudeSpectrum> {
    amplitude_spectrum(x, of.sample_rate_hz, Window::Hann).ok()
}
