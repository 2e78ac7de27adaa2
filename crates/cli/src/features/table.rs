//! The table of features: its columns over all files, and its rows.

use super::inputs::Input;
use super::units::{CRANK_ANGLE, Scaled, scaled};
use super::warnings::clipped;
use crate::Failure;
use ::features::Cell;
use recordings::measured::{MeasuredFile, Window};
use recordings::{Column, Kind, Schema, Value};
use signal::channel::Channel;
use signal::crank_angle::CrankAngle;
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;
use sweep::dataset::feature_column;

/// The columns with which every row begins; the labels follow.
const FIRST_COLUMNS: usize = 6;

fn first_columns() -> [Column; FIRST_COLUMNS] {
    let real =
        |name: &str, unit: &str, meaning: &str| Column::new(name, Kind::Real, meaning).unit(unit);
    [
        Column::new("file", Kind::Text, "the recording"),
        Column::new(
            "window",
            Kind::Integer,
            "which window of the recording, from 0",
        ),
        real(
            "start_s",
            "s",
            "where the window begins, after the first sample",
        ),
        real("duration_s", "s", "length of the window"),
        real("sample_rate_hz", "Hz", "samples per second"),
        real(
            "speed_rpm",
            "rpm",
            "mean speed of the crank, from its angle where there is one",
        )
        .optional(),
    ]
}

/// The column with which every row ends, behind [`MISSING`].
fn warnings_column() -> Column {
    Column::new("warnings", Kind::Text, "what looks wrong with the window").optional()
}

/// The last of a file's features, which stands behind those of all files.
const MISSING: &str = "missing";

/// The columns of the table, each once.
#[derive(Default)]
pub(super) struct Columns {
    columns: Vec<Column>,
    positions: BTreeMap<String, usize>,
}

impl Columns {
    /// Where the column stands; it is added if it is new.
    fn position(&mut self, column: Column) -> Result<usize, String> {
        if let Some(&position) = self.positions.get(&column.name) {
            let other = &self.columns[position];
            if other.kind != column.kind {
                return Err(format!(
                    "column `{}` is {} here and {} in another file: give them in separate calls",
                    column.name, column.kind, other.kind
                ));
            }
            return Ok(position);
        }
        self.positions
            .insert(column.name.clone(), self.columns.len());
        self.columns.push(column);
        Ok(self.columns.len() - 1)
    }
}

/// What the rows of one file hold, and where it stands.
pub(super) struct Layout {
    pub(super) file: String,
    pub(super) channels: Vec<Scaled>,
    /// Channels whose unit is not known.
    pub(super) without_unit: Vec<String>,
    features: Vec<Column>,
    feature_positions: Vec<usize>,
    /// Places among the labels of all files; none of what is told by a column of its own.
    label_positions: Vec<Option<usize>>,
    /// Labels from elsewhere, with their places.
    known: Vec<(usize, Value)>,
    /// Where the file's labels have the speed, and the window.
    pub(super) speed_label: Option<usize>,
    window_label: Option<usize>,
    stated_speed_rpm: Option<f64>,
}

impl Layout {
    /// The layout of a file's rows; `columns` grows by those that it adds. Labels and features
    /// are collected in two passes, so that all labels stand before all features.
    pub(super) fn new(
        input: &Input,
        file: &MeasuredFile,
        default_unit: Option<&(f64, String)>,
        labels: &mut Columns,
    ) -> Result<Self, Failure> {
        let shown = input.path.display().to_string();
        let wrong = |reason: String| Failure::input(format!("{shown}: {reason}"));
        let channels = channels(input, file, default_unit).map_err(wrong)?;
        let unknown = channels.iter().filter(|c| c.unit.is_empty());
        let without_unit = unknown.map(|c| c.name.clone()).collect();
        let names = channels.iter().map(|c| (c.name.as_str(), c.unit.as_str()));
        let own = |name: &str| file.labels().iter().position(|c| c.name == name);
        let fixed: BTreeSet<String> = first_columns()
            .into_iter()
            .map(|c| c.name)
            .chain([MISSING.to_owned(), warnings_column().name])
            .collect();
        let mut label_positions = Vec::new();
        for column in file.labels() {
            let position = match fixed.contains(&column.name) {
                true => None,
                false => Some(labels.position(column.clone()).map_err(wrong)?),
            };
            label_positions.push(position);
        }
        let mut known = Vec::new();
        for (column, value) in &input.labels {
            known.push((
                labels.position(column.clone()).map_err(wrong)?,
                value.clone(),
            ));
        }
        let is = |name: &str, kind| own(name).filter(|&i| file.labels()[i].kind == kind);
        Ok(Self {
            features: ::features::columns(names, true)
                .into_iter()
                .map(feature_column)
                .collect(),
            feature_positions: Vec::new(),
            speed_label: is("speed_rpm", Kind::Real),
            window_label: is("window", Kind::Integer),
            stated_speed_rpm: input.speed_rpm,
            file: shown,
            channels,
            without_unit,
            label_positions,
            known,
        })
    }

    /// The speed of a recording with these labels, as it is stated.
    pub(super) fn stated_speed(&self, labels: &[Value]) -> Result<Option<f64>, Failure> {
        let label = self.speed_label.and_then(|i| labels.get(i));
        match (label, self.stated_speed_rpm) {
            (Some(Value::Real(of_file)), Some(said)) if (of_file / said - 1.0).abs() > 0.01 => {
                Err(Failure::input(format!(
                    "{}: the speed is {of_file} rpm, but --speed says {said:.4} rpm",
                    self.file
                )))
            }
            (Some(Value::Real(of_file)), _) => Ok(Some(*of_file)),
            (_, said) => Ok(said),
        }
    }

    pub(super) fn crank_angle(&self) -> Option<usize> {
        self.channels.iter().position(|c| c.is_crank_angle)
    }
}

/// The channels of a file in SI, each with a name of its own.
fn channels(
    input: &Input,
    file: &MeasuredFile,
    default_unit: Option<&(f64, String)>,
) -> Result<Vec<Scaled>, String> {
    let mut channels = Vec::new();
    for channel in file.channels() {
        let mut channel = channel.clone();
        if let Some(unit) = input.units.get(&channel.column) {
            channel.unit = Some(unit.clone());
        }
        let mut scaled = scaled(&channel, default_unit)?;
        let taken = |name: &str| channels.iter().any(|c: &Scaled| c.name == name);
        if taken(&scaled.name) {
            scaled.name = channel.column.clone();
        }
        if taken(&scaled.name) {
            return Err(format!("two columns are called `{}`", channel.column));
        }
        channels.push(scaled);
    }
    Ok(channels)
}

/// The table of all files: the schema, and the layouts with their places in it.
pub(super) fn schema(labels: Columns, layouts: &mut [Layout]) -> Result<Schema, Failure> {
    let mut all = Columns::default();
    let mut add = |column: Column| all.position(column).map_err(Failure::input);
    for column in first_columns() {
        add(column)?;
    }
    for column in labels.columns {
        add(column)?;
    }
    for layout in layouts.iter_mut() {
        for column in &layout.features {
            if column.name != MISSING {
                layout.feature_positions.push(add(column.clone())?);
            }
        }
    }
    for layout in layouts.iter_mut() {
        for column in &layout.features {
            if column.name == MISSING {
                layout.feature_positions.push(add(column.clone())?);
            }
        }
    }
    add(warnings_column())?;
    Schema::new(all.columns).map_err(Failure::input)
}

/// A window that is to become a row.
pub(super) struct Job {
    pub(super) layout: std::sync::Arc<Layout>,
    pub(super) labels: std::sync::Arc<Vec<Value>>,
    /// Which window of its recording.
    pub(super) index: u64,
    pub(super) sample_rate_hz: f64,
    pub(super) speed_rpm: Option<f64>,
    pub(super) window: Window,
}

/// The row of a window in a table of `columns` columns.
pub(super) fn row(job: &Job, columns: usize) -> Vec<Value> {
    let layout = &*job.layout;
    let channels: Vec<Channel> = layout
        .channels
        .iter()
        .zip(&job.window.channels)
        .map(|(channel, samples)| Channel {
            name: channel.name.clone(),
            unit: channel.unit.clone(),
            samples: samples.iter().map(|x| in_si(*x, channel)).collect(),
        })
        .collect();
    let samples = channels.first().map_or(0, |c| c.samples.len());
    let crank_angle = channels.iter().find(|c| c.name == CRANK_ANGLE);
    let crank_angle = crank_angle.map(|c| c.samples.as_slice());
    let cells = ::features::row(
        &::features::Window {
            sample_rate: job.sample_rate_hz,
            speed_rpm: job.speed_rpm,
            crank_angle,
            channels: &channels,
        },
        true,
    );
    let measured = crank_angle.and_then(|angle| speed_rpm(angle, job.sample_rate_hz));
    let index = match layout.window_label.and_then(|i| job.labels.get(i)) {
        Some(Value::Integer(window)) if job.index == 0 => *window,
        _ => job.index as i64,
    };
    let mut row = vec![Value::Missing; columns];
    let first: [Value; FIRST_COLUMNS] = [
        layout.file.as_str().into(),
        index.into(),
        job.window.start_s.into(),
        (samples as f64 / job.sample_rate_hz).into(),
        job.sample_rate_hz.into(),
        measured.or(job.speed_rpm).into(),
    ];
    for (place, value) in row.iter_mut().zip(first) {
        *place = value;
    }
    for (position, value) in layout.label_positions.iter().zip(job.labels.iter()) {
        if let Some(position) = position {
            row[FIRST_COLUMNS + position] = value.clone();
        }
    }
    for (position, value) in &layout.known {
        row[FIRST_COLUMNS + position] = value.clone();
    }
    for (position, cell) in layout.feature_positions.iter().zip(cells) {
        row[*position] = match cell {
            None => Value::Missing,
            Some(Cell::Number(number)) => number.into(),
            Some(Cell::Text(text)) => text.into(),
        };
    }
    row[columns - 1] = warnings(job, &channels).into();
    row
}

/// A sample in SI; crank angles are taken into [0, 2π).
fn in_si(sample: f32, channel: &Scaled) -> f32 {
    if channel.factor == 1.0 && !channel.is_crank_angle {
        return sample;
    }
    let value = f64::from(sample) * channel.factor;
    if channel.is_crank_angle {
        value.rem_euclid(TAU) as f32
    } else {
        value as f32
    }
}

/// The mean speed that the crank angle tells.
pub(super) fn speed_rpm(crank_angle: &[f32], sample_rate_hz: f64) -> Option<f64> {
    let readings: Vec<f64> = crank_angle.iter().map(|a| f64::from(*a)).collect();
    let angle = CrankAngle::from_encoder(&readings).ok()?;
    Some(60.0 * sample_rate_hz / angle.samples_per_revolution())
}

/// Samples of a crank angle as the file has them, in [0, 2π).
pub(super) fn crank_angle_of(samples: &[f32], channel: &Scaled) -> Vec<f32> {
    samples.iter().map(|x| in_si(*x, channel)).collect()
}

fn warnings(job: &Job, channels: &[Channel]) -> Option<String> {
    let gap = job.window.gap_s;
    let gap = gap.map(|gap| format!("{gap:.6} s are missing before the window"));
    // Pressures rest at their limits while a valve is open.
    let clipped = channels
        .iter()
        .filter(|c| c.name != CRANK_ANGLE && c.unit != "Pa")
        .filter_map(|channel| {
            let samples = clipped(&channel.samples)?;
            Some(format!(
                "{}: may be clipped, {samples} samples stand at its limits",
                channel.name
            ))
        });
    let all: Vec<String> = gap.into_iter().chain(clipped).collect();
    (!all.is_empty()).then(|| all.join("; "))
}
