//! The table of a dataset's cases, and what the page shows of each.

use crate::Error;
use crate::case_table::{
    CaseChannel, CaseClass, CaseNumbers, CaseTable, CaseTexts, Curves, rounded,
};
use crate::class_colour::class_colour;
use recordings::{CaseWarning, FailedCase};
use simulate::Chamber;
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::path::Path;
use study::classes;
use study::counts::FaultCount;
use study::recording::Recording;
use study::{scatter, words};
use sweep::reader::{Dataset, Label, LabelledSample, SignalRow};

/// Cases of a table: a page with more takes long to open.
const MOST_CASES: usize = 3_000;
/// Bytes of all curves.
const MOST_BYTES: usize = 1_600_000;
/// Parts of a revolution.
const MOST_PARTS: usize = 120;
const LEAST_PARTS: usize = 48;
/// Orders of the crank's speed in spectra.
const ORDERS: usize = 64;
/// Amplitudes below this have no logarithm to show, m/s².
const LEAST_AMPLITUDE: f64 = 1e-9;
const CUBIC_DECIMETRES: f64 = 1e3;

/// The cases, with the curves of their first windows where the recordings are at hand; `features` are those of all windows.
///
/// # Errors
/// A table that cannot be read.
pub(super) fn cases(
    dataset: &Dataset,
    faults: &[FaultCount],
    features: &LabelledSample,
) -> Result<CaseTable, Error> {
    let joints = dataset.joints();
    let labels = || faults.iter().map(|count| count.fault.as_str());
    let class = |count: &FaultCount| CaseClass {
        label: count.fault.clone(),
        name: classes::name(&count.fault),
        colour: class_colour(&count.fault, &joints, labels()).hex(),
    };
    let every = dataset.cases.len().div_ceil(MOST_CASES).max(1);
    let windows: Vec<usize> = dataset
        .cases
        .iter()
        .step_by(every)
        .map(|case| case.first)
        .collect();
    let table = &dataset.windows;
    let splits = dataset.splits();
    let class_of = |w: usize| labels().position(|label| label == table.fault[w]);
    let split_of = |w: usize| splits.iter().position(|split| *split == table.split[w]);
    let mut cases = CaseTable {
        all: dataset.cases.len(),
        ids: windows.iter().map(|&w| table.case_id[w].clone()).collect(),
        classes: faults.iter().map(class).collect(),
        class: windows
            .iter()
            .map(|&w| class_of(w).unwrap_or_default())
            .collect(),
        split: windows
            .iter()
            .map(|&w| split_of(w).unwrap_or_default())
            .collect(),
        numbers: numbers(dataset, &windows),
        texts: texts(dataset, &windows),
        warnings: warnings(dataset),
        command: FailedCase::command_of(Path::new("sweep.yaml"), "CASE"),
        splits,
        ..CaseTable::default()
    };
    if dataset.has_signals() {
        (cases.step, cases.channels) = channels(dataset, &windows, features)?;
    }
    Ok(cases)
}

/// The warnings of each case up to their first semicolon, after which advice stands.
fn warnings(dataset: &Dataset) -> BTreeMap<String, Vec<String>> {
    let mut of_case: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for CaseWarning { case_id, warning } in &dataset.manifest().warnings {
        let short = warning.split(';').next().unwrap_or_default();
        of_case
            .entry(case_id.clone())
            .or_default()
            .push(short.to_owned());
    }
    of_case
}

/// The labels that vary, then the features of each sensor.
fn numbers(dataset: &Dataset, windows: &[usize]) -> Vec<CaseNumbers> {
    let column = |name: String, unit: &str, values: &[f64]| {
        let own: Vec<f64> = windows.iter().map(|&w| values[w]).collect();
        let largest = own
            .iter()
            .filter(|v| v.is_finite())
            .fold(0.0_f64, |most, v| most.max(v.abs()));
        let (factor, unit) = text::readable_unit(largest, unit);
        CaseNumbers {
            name,
            unit: unit.to_owned(),
            values: own.iter().map(|value| rounded(value * factor)).collect(),
        }
    };
    let varies = |label: &&Label| {
        windows
            .iter()
            .any(|&w| label.values[w] != label.values[windows[0]])
    };
    let labels = dataset.windows.labels.iter().filter(varies);
    let labels =
        labels.map(|label| column(words::name(label), &text::unit(&label.unit), &label.values));
    let features = dataset
        .windows
        .measured
        .iter()
        .enumerate()
        .flat_map(|(i, measured)| {
            let name = |feature: &str| scatter::feature(dataset, i, feature);
            [
                column(name("rms"), "m/s²", &measured.rms),
                column(name("peak"), "m/s²", &measured.peak),
                column(name("kurtosis"), "", &measured.kurtosis),
            ]
        });
    labels.chain(features).collect()
}

/// The parameters that are text and vary.
fn texts(dataset: &Dataset, windows: &[usize]) -> Vec<CaseTexts> {
    let columns = dataset.windows.texts.iter().map(|text| CaseTexts {
        name: words::of_path(&text.path),
        values: windows.iter().map(|&w| text.values[w].clone()).collect(),
    });
    columns
        .filter(|column| column.values.iter().any(|value| *value != column.values[0]))
        .collect()
}

/// The curves of a channel of one case.
#[derive(Clone, Default)]
struct Drawn {
    revolution: Vec<f64>,
    velocity: Vec<f64>,
    orders: Vec<f64>,
}

/// A channel that has curves.
struct Shown<'a> {
    /// Its name in the table.
    column: &'a str,
    unit: &'a str,
    /// Its name as features have it.
    channel: &'a str,
    kind: Kind,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    /// A pressure, which is smooth: one value in each part of the revolution.
    Pressure,
    /// An acceleration.
    Acceleration,
    /// An acceleration that judges faults, with its portrait.
    Judge,
}

impl Shown<'_> {
    /// Bytes of a case with so many parts of the revolution.
    fn bytes(&self, parts: usize) -> usize {
        match self.kind {
            Kind::Pressure => parts,
            Kind::Acceleration => 2 * parts + ORDERS,
            Kind::Judge => 4 * parts + ORDERS,
        }
    }
}

/// Every how many cases one has curves, and those of each acceleration and pressure.
fn channels(
    dataset: &Dataset,
    windows: &[usize],
    features: &LabelledSample,
) -> Result<(usize, Vec<CaseChannel>), Error> {
    let all = dataset.plan.channels();
    let judges = dataset.sensors.channels();
    let shown: Vec<Shown<'_>> = all
        .iter()
        .filter_map(|(column, unit)| {
            let channel = features::stem(column, unit);
            let kind = match *unit {
                "Pa" => Kind::Pressure,
                "m/s^2" if judges.iter().any(|judge| judge == channel) => Kind::Judge,
                "m/s^2" => Kind::Acceleration,
                _ => return None,
            };
            Some(Shown {
                column,
                unit,
                channel,
                kind,
            })
        })
        .collect();
    let bytes = |parts: usize| -> usize {
        let of_case: usize = shown.iter().map(|channel| channel.bytes(parts)).sum();
        windows.len() * of_case
    };
    let mut parts = (LEAST_PARTS..=MOST_PARTS).rev();
    let parts = parts
        .find(|parts| bytes(*parts) <= MOST_BYTES)
        .unwrap_or(LEAST_PARTS);
    let step = bytes(parts).div_ceil(MOST_BYTES).max(1);
    let drawn: Vec<usize> = windows.iter().copied().step_by(step).collect();
    let columns: Vec<String> = shown
        .iter()
        .map(|channel| channel.column.to_owned())
        .collect();
    let mut curves = vec![vec![Drawn::default(); drawn.len()]; shown.len()];
    dataset.each_signal(&drawn, &columns, |at, row| {
        for (i, channel) in shown.iter().enumerate() {
            curves[i][at] = draw(row.with_channel(i), parts, channel.kind)?;
        }
        Ok::<(), Error>(())
    })?;
    let chambers = Chamber::of_machine(&dataset.plan.base.machine);
    let made = shown.iter().zip(&curves).map(|(channel, curves)| {
        let chamber = chambers
            .iter()
            .find(|chamber| chamber.column == channel.column);
        let volumes = chamber.into_iter().flat_map(|chamber| {
            let middle = move |part: usize| TAU * (part as f64 + 0.5) / parts as f64;
            (0..parts).map(move |part| rounded(CUBIC_DECIMETRES * chamber.volume(middle(part))))
        });
        let pack = |of: fn(&Drawn) -> &Vec<f64>| Curves::pack(curves.iter().map(of));
        let revolution = pack(|drawn| &drawn.revolution);
        let largest = revolution.high.iter().copied().fold(0.0, f64::max);
        let (factor, unit) = text::readable_unit(largest, channel.unit);
        CaseChannel {
            name: text::words(channel.channel),
            unit: text::unit(unit),
            revolution: revolution.scaled(factor),
            velocity: (channel.kind == Kind::Judge).then(|| pack(|drawn| &drawn.velocity)),
            orders: (channel.kind != Kind::Pressure).then(|| pack(|drawn| &drawn.orders)),
            envelope: envelope(features, channel.channel, &drawn),
            volume: volumes.collect(),
        }
    });
    Ok((step, made.collect()))
}

/// The curves of the one channel of a row.
fn draw(row: SignalRow, parts: usize, kind: Kind) -> Result<Drawn, study::Error> {
    let recording = Recording::analyse(row)?;
    let velocity = match kind {
        Kind::Judge => recording.response()?.velocity_m_s,
        _ => Vec::new(),
    };
    let (revolution, velocity) = recording.extremes(parts, &velocity);
    if kind == Kind::Pressure {
        let middle = |pair: &[f64]| f64::midpoint(pair[0], pair[1]);
        return Ok(Drawn {
            revolution: revolution.chunks_exact(2).map(middle).collect(),
            ..Drawn::default()
        });
    }
    let orders = recording.order_spectrum()?.amplitude_m_s2;
    let orders = orders.iter().take(ORDERS);
    Ok(Drawn {
        revolution,
        velocity,
        orders: orders
            .map(|amplitude| amplitude.max(LEAST_AMPLITUDE).log10())
            .collect(),
    })
}

/// The amplitudes of the envelope at its orders, from the features; none where the table has no such features.
fn envelope(features: &LabelledSample, channel: &str, windows: &[usize]) -> Option<Curves> {
    let column = |order: usize| {
        let start = format!("{channel}.envelope_order_{order}_");
        features
            .names
            .iter()
            .position(|name| name.starts_with(&start))
    };
    let orders: Vec<usize> = (1..).map_while(column).collect();
    let amplitudes = windows.iter().map(|&window| {
        let of_order = orders
            .iter()
            .map(|&column| features.sample.values.value(window, column));
        of_order.collect()
    });
    let amplitudes: Vec<Vec<f64>> = amplitudes.collect();
    (!orders.is_empty()).then(|| Curves::pack(amplitudes.iter()))
}
