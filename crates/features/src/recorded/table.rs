//! The table of features: its columns over all files, and its rows.

use super::counted::counted;
use super::inputs::{Input, Stated};
use super::shaft::{self, Crank};
use super::units::{Role, Scaled, scaled};
use super::{Error, Said, Unit};
use crate::cut_off::cut_off;
use crate::{Cell, CrankAngles, Reason, column};
use input::bundle_channel::{Meaning, unit_of_column};
use recordings::measured::{Bridge, MeasuredChannel, MeasuredFile, Window};
use recordings::{Column, Kind, Schema, Value};
use signal::channel::Channel;
use simulate::Chamber;
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;

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

/// Samples that are cut off, fewer of which are not worth a warning.
const MANY: usize = 8;

/// Share of what a channel varies by that may be rounded off without a warning.
const ROUNDED: f64 = 1e-3;

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
    fn position(&mut self, column: Column) -> Result<usize, Error> {
        if let Some(&position) = self.positions.get(&column.name) {
            let (kind, other) = (column.kind, self.columns[position].kind);
            if kind != other {
                let name = column.name;
                return Err(Error::Kinds { name, kind, other });
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
    /// The chambers of the machine, under the names of the channels that have their pressures.
    chambers: Vec<Chamber>,
    /// Why the bundle's machine gives no chambers, where there are pressures.
    no_machine: Option<String>,
    /// Channels that are not in SI, with the reason where they have a unit.
    pub(super) without_unit: Vec<String>,
    features: Vec<Column>,
    feature_positions: Vec<usize>,
    /// Places among the labels of all files; none for a label that has a column of its own.
    label_positions: Vec<Option<usize>>,
    /// Labels from elsewhere, with their places.
    known: Vec<(usize, Value)>,
    /// Where the file's labels have the speed, and the window.
    pub(super) speed_label: Option<usize>,
    window_label: Option<usize>,
    stated_speed_rpm: Option<f64>,
    /// Whether the kind of motion is judged.
    motion: bool,
}

impl Layout {
    /// The layout of a file's rows; `columns` grows by those that it adds. Labels and features
    /// are collected in two passes, so that all labels stand before all features.
    pub(super) fn new(
        input: &Input,
        file: &MeasuredFile,
        said: &Said,
        labels: &mut Columns,
    ) -> Result<Self, Error> {
        let shown = input.path.display().to_string();
        let mut label = |column: Column| {
            let position = labels.position(column);
            position.map_err(|error| Error::in_file(&input.path, error))
        };
        let meaning = |channel: &MeasuredChannel| input.stated(channel).map(|s| s.meaning.clone());
        let reference = shaft::reference(&input.path, file, &said.crank, meaning)?;
        let channels = channels(input, file, said.unit.as_ref(), reference);
        let channels = channels.map_err(|reason| Error::in_file(&input.path, reason))?;
        let measured = || channels.iter().filter(|c| c.role == Role::Measured);
        let (chambers, no_machine) = match &input.machine {
            Some(Ok(machine)) => (machine.chambers_of(&channels), None),
            Some(Err(reason)) => (Vec::new(), Some(reason.clone())),
            None => (Vec::new(), None),
        };
        let no_machine = no_machine.filter(|_| measured().any(|c| c.unit == "Pa"));
        let without_unit = measured().filter_map(without_unit).collect();
        let names = measured().map(|c| (c.name.as_str(), c.unit.as_str()));
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
                false => Some(label(column.clone())?),
            };
            label_positions.push(position);
        }
        let mut known = Vec::new();
        for (column, value) in &input.labels {
            known.push((label(column.clone())?, value.clone()));
        }
        let is = |name: &str, kind| own(name).filter(|&i| file.labels()[i].kind == kind);
        Ok(Self {
            features: crate::columns(names, said.motion)
                .into_iter()
                .map(column)
                .collect(),
            feature_positions: Vec::new(),
            speed_label: is("speed_rpm", Kind::Real),
            window_label: is("window", Kind::Integer),
            stated_speed_rpm: input.speed_rpm,
            motion: said.motion,
            file: shown,
            channels,
            chambers,
            no_machine,
            without_unit,
            label_positions,
            known,
        })
    }

    /// That the file cannot be used.
    pub(super) fn wrong(&self, reason: String) -> Error {
        let file = self.file.clone();
        Error::Wrong { file, reason }
    }

    /// The speed of a recording with these labels, as it is stated.
    pub(super) fn stated_speed(&self, labels: &[Value]) -> Result<Option<f64>, Error> {
        let label = self.speed_label.and_then(|i| labels.get(i));
        match (label, self.stated_speed_rpm) {
            (Some(Value::Real(of_file)), Some(said)) if (of_file / said - 1.0).abs() > 0.01 => {
                Err(self.wrong(format!(
                    "the speed is {of_file} rpm, but --speed says {said:.4} rpm"
                )))
            }
            (Some(Value::Real(of_file)), _) => Ok(Some(*of_file)),
            (_, said) => Ok(said),
        }
    }

    /// Where the crank stands at each of these samples of the channels; none without a channel
    /// for it.
    pub(super) fn crank(&self, samples: &[&[f64]]) -> Option<Result<Crank, signal::Error>> {
        let mut channels = self.channels.iter().zip(samples);
        channels.find_map(|(channel, samples)| shaft::crank(samples, channel))
    }

    /// What a line between two samples of each channel is.
    pub(super) fn bridges(&self) -> Vec<Bridge> {
        let bridge = |channel: &Scaled| match channel.role {
            Role::CrankAngle { .. } => Bridge::Turn(TAU / channel.to_si.scale),
            _ => Bridge::Line,
        };
        self.channels.iter().map(bridge).collect()
    }
}

/// How a channel that is not in SI is shown.
fn without_unit(channel: &Scaled) -> Option<String> {
    match &channel.not_si {
        Some(why) => Some(format!("{} ({why})", channel.name)),
        None => channel.unit.is_empty().then(|| channel.name.clone()),
    }
}

/// The channels of a file in SI, each with a name of its own. `reference` is the one that gives the
/// crank angle.
fn channels(
    input: &Input,
    file: &MeasuredFile,
    default_unit: Option<&Unit>,
    reference: Option<(usize, Scaled)>,
) -> Result<Vec<Scaled>, String> {
    let mut channels = Vec::new();
    for (i, channel) in file.channels().iter().enumerate() {
        if let Some((at, reference)) = &reference
            && *at == i
        {
            channels.push(reference.clone());
            continue;
        }
        let mut channel = channel.clone();
        let said = input.stated(&channel);
        if let Some(said) = said {
            channel.unit = Some(said.unit.clone());
        }
        let of_crank = said
            .is_some_and(|s| matches!(s.meaning, Meaning::CrankAngle(_) | Meaning::Tacho { .. }));
        if of_crank || (reference.is_some() && shaft::is_crank_angle(&channel)) {
            channels.push(Scaled::reference(Role::Unused, shaft::AS_IT_IS));
            continue;
        }
        let mut scaled = scaled(&channel, default_unit)?;
        if let Some(said) = said {
            as_stated(&mut scaled, said);
        }
        let taken = |name: &str| {
            let mut measured = channels
                .iter()
                .filter(|c: &&Scaled| c.role == Role::Measured);
            measured.any(|c| c.name == name)
        };
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

/// Takes over what a bundle says of a channel. Its offset holds whether or not its name has a meaning.
fn as_stated(scaled: &mut Scaled, said: &Stated) {
    scaled.to_si.offset = said.offset;
    if let Meaning::Measured { column, to_si } = &said.meaning {
        scaled.to_si = *to_si;
        scaled.not_si = None;
        scaled.unit = unit_of_column(column).to_owned();
        scaled.column = Some(column.clone());
    }
}

/// The table of all files: the schema, and the layouts with their places in it.
pub(super) fn schema(labels: Columns, layouts: &mut [Layout]) -> Result<Schema, Error> {
    let mut all = Columns::default();
    let mut add = |column: Column| all.position(column);
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
    Schema::new(all.columns).map_err(Error::File)
}

/// A window that is to become a row.
pub struct Job {
    pub(super) layout: std::sync::Arc<Layout>,
    pub(super) labels: std::sync::Arc<Vec<Value>>,
    /// Which window of its recording.
    pub(super) index: u64,
    pub(super) sample_rate_hz: f64,
    pub(super) speed_rpm: Option<f64>,
    pub(super) window: Window,
    /// Columns of the table.
    pub(super) columns: usize,
}

/// A row of the table, and what is to be said of it.
pub struct Row {
    /// The values, in the order of the columns.
    pub values: Vec<Value>,
    /// Why features have no value, by column.
    pub(super) reasons: Vec<(usize, Reason)>,
    pub(super) file: String,
    pub(super) start_s: f64,
    pub(super) warning: Option<String>,
    /// Samples that were missing and are bridged.
    pub(super) bridged: usize,
}

/// A window in SI.
#[derive(Clone, Debug)]
pub struct Recorded {
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Its channels but for the crank angle.
    pub channels: Vec<Channel>,
    /// The crank angle from top dead centre at each sample, in [0, 2π), rad, where it is known.
    pub crank_angle: Option<Vec<f32>>,
}

/// The channels of a window.
pub fn recorded(job: &Job) -> Recorded {
    let raw: Vec<&[f64]> = job.window.channels.iter().map(Vec::as_slice).collect();
    let crank = job.layout.crank(&raw).and_then(Result::ok);
    let crank = crank.filter(|crank| crank.from_top_dead_centre);
    Recorded {
        sample_rate_hz: job.sample_rate_hz,
        channels: channels_in_si(job),
        crank_angle: crank.map(|crank| crank.angles),
    }
}

/// The measured channels of a window.
fn channels_in_si(job: &Job) -> Vec<Channel> {
    let measured = job.layout.channels.iter().zip(&job.window.channels);
    let measured = measured.filter(|(channel, _)| channel.role == Role::Measured);
    measured
        .map(|(channel, samples)| Channel {
            name: channel.name.clone(),
            unit: channel.unit.clone(),
            samples: samples.iter().map(|x| channel.in_si(*x)).collect(),
        })
        .collect()
}

/// The row of a window.
pub fn row(job: &Job) -> Row {
    let (layout, columns) = (&*job.layout, job.columns);
    let channels = channels_in_si(job);
    let raw: Vec<&[f64]> = job.window.channels.iter().map(Vec::as_slice).collect();
    let samples = raw.first().map_or(0, |samples| samples.len());
    let crank = layout.crank(&raw);
    let known = crank.as_ref().and_then(|crank| crank.as_ref().ok());
    let (cells, reasons) = crate::row_with_reasons(
        &crate::Window {
            sample_rate: job.sample_rate_hz,
            speed_rpm: job.speed_rpm,
            crank_angle: known.map(|crank| CrankAngles {
                angles: &crank.angles,
                from_top_dead_centre: crank.from_top_dead_centre,
            }),
            channels: &channels,
            chambers: &layout.chambers,
        },
        layout.motion,
    );
    let speed = known.map(|crank| shaft::speed_rpm(crank, job.sample_rate_hz));
    let measured_rpm = speed
        .as_ref()
        .and_then(|speed| speed.as_ref().ok().copied());
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
        measured_rpm.or(job.speed_rpm).into(),
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
    let of_crank = shaft::warning(
        crank.as_ref(),
        speed.as_ref(),
        job.speed_rpm,
        job.sample_rate_hz,
    );
    let empty = empty_channels(layout, &channels, &reasons);
    let warning = warnings(job, &channels, of_crank, empty);
    row[columns - 1] = warning.clone().into();
    let reasons = layout.feature_positions.iter().copied().zip(reasons);
    Row {
        values: row,
        reasons: reasons
            .filter_map(|(column, reason)| Some((column, reason?)))
            .collect(),
        file: layout.file.clone(),
        start_s: job.window.start_s,
        warning,
        bridged: job.window.bridged.iter().sum(),
    }
}

impl Row {
    /// Keeps these columns alone, in this order.
    pub fn keep(&mut self, columns: &[usize]) {
        let mut all = std::mem::take(&mut self.values);
        let kept = columns.iter();
        self.values = kept
            .map(|i| std::mem::replace(&mut all[*i], Value::Missing))
            .collect();
        let place = |column: usize| columns.iter().position(|i| *i == column);
        let reasons = self.reasons.drain(..);
        self.reasons = reasons
            .filter_map(|(column, reason)| Some((place(column)?, reason)))
            .collect();
    }

    /// What looks wrong with the window, with its file and time.
    pub fn warning(&self) -> Option<String> {
        let warning = self.warning.as_ref()?;
        Some(format!("{} at {:.3} s: {warning}", self.file, self.start_s))
    }
}

/// That float32, in which features take samples, rounds off more than [`ROUNDED`] of what a channel varies by.
fn rounded_off(channel: &Scaled, samples: &[f64]) -> Option<String> {
    let is_exact = |x: &f64| x.is_nan() || f64::from(*x as f32) == *x;
    if channel.role != Role::Measured || samples.iter().all(is_exact) {
        return None;
    }
    let low = samples.iter().copied().fold(f64::INFINITY, f64::min);
    let high = samples.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let rounding = high.abs().max(low.abs()) * f64::from(f32::EPSILON);
    let varies = high - low;
    (varies > 0.0 && rounding > ROUNDED * varies).then(|| {
        format!(
            "{}: its values vary by {varies:.3e}, of which float32 rounds off {rounding:.1e} because the largest is \
             {high:.3e}: take a constant off the column",
            channel.name
        )
    })
}

/// The channels without any feature in a window, with the reason.
fn empty_channels(
    layout: &Layout,
    channels: &[Channel],
    reasons: &[Option<Reason>],
) -> Vec<String> {
    let empty = channels.iter().filter_map(|channel| {
        let begin = format!("{}.", crate::stem(&channel.name, &channel.unit));
        let columns = layout.features.iter().zip(reasons);
        let mut of_channel = columns.filter(|(column, _)| column.name.starts_with(&begin));
        let (_, first) = of_channel.next()?;
        let first = first.as_ref()?;
        let is_empty = of_channel.all(|(_, reason)| reason.is_some());
        let missing = channel.samples.iter().filter(|x| x.is_nan()).count();
        let why = match (missing, channel.samples.len()) {
            (0, _) => first.to_string(),
            (n, of) => format!("{n} of {of} samples are no numbers up to {:.1e}", f32::MAX),
        };
        is_empty.then(|| format!("{}: no features, {why}", channel.name))
    });
    empty.collect()
}

fn warnings(
    job: &Job,
    channels: &[Channel],
    crank: Option<String>,
    empty: Vec<String>,
) -> Option<String> {
    let gap = job.window.gap_s;
    let gap = gap.map(|gap| format!("{gap:.6} s are missing before the window"));
    let bridged = job.layout.channels.iter().zip(&job.window.bridged);
    let bridged = bridged
        .filter(|(_, count)| **count > 0)
        .map(|(channel, count)| {
            let samples = counted(*count as u64, "missing sample");
            format!("{}: {samples} bridged by a line", channel.name)
        });
    // Pressures rest at their limits while a valve is open.
    let clipped = channels
        .iter()
        .filter(|c| c.unit != "Pa")
        .filter_map(|channel| {
            let samples = cut_off(&channel.samples);
            (samples >= MANY).then(|| {
                format!(
                    "{}: may be clipped, {samples} samples stand at its limits",
                    channel.name
                )
            })
        });
    let no_machine = job.layout.no_machine.iter();
    let no_machine = no_machine.map(|reason| format!("the bundle's machine is not used: {reason}"));
    let rounded = job.layout.channels.iter().zip(&job.window.channels);
    let rounded = rounded.filter_map(|(channel, samples)| rounded_off(channel, samples));
    let of_crank = gap.into_iter().chain(crank).chain(no_machine).chain(empty);
    let of_crank = of_crank.chain(rounded);
    let all: Vec<String> = of_crank.chain(bridged).chain(clipped).collect();
    (!all.is_empty()).then(|| all.join("; "))
}
