//! Cases become rows: they are run, cut into windows and summed up, all on one thread.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::fmt::{self, Display};
use std::ops::Range;
use std::path::Path;

use recordings::formats::mcap;
use recordings::{FailedCase, Value};
use signal::channel::Channel;

use super::over_crank_angle::{self, AngleWindow};
use super::recording::{Failure, Recording, Runner};
use super::tables::{features_row, labels, signals_row};
use crate::Plan;
use crate::plan::Case;
use crate::split::Split;
use crate::sweep_file::Format;

/// What is made of a case.
#[derive(Clone, Copy)]
pub(super) enum Wanted<'a> {
    /// What a dataset has of it: signals and features. The text goes into MCAP files.
    Dataset { sweep_yaml: &'a str },
    /// Rows of `signals` alone, whatever the format of the dataset is.
    Signals,
}

/// What a case leaves behind.
pub(super) struct CaseRows {
    pub case_id: String,
    pub split: Split,
    pub fault: String,
    /// What is doubtful about it.
    pub warnings: Vec<String>,
    /// Rows of `features`, one per window.
    pub features: Vec<Vec<Value>>,
    pub signals: Signals,
}

/// The recordings of a case.
pub(super) enum Signals {
    /// Rows of `signals`, one per window.
    Rows(Vec<Vec<Value>>),
    /// The bytes of an MCAP file.
    Mcap(Vec<u8>),
}

/// Why a case failed whose process died.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Death(pub String);

impl Display for Death {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Death {}

/// The cases whose processes died when they were tried.
pub(super) type Dead = BTreeMap<u64, Death>;

/// Runs these cases of `plan` but for those of `dead`.
pub(super) fn run_cases(
    plan: &Plan,
    cases: Range<u64>,
    dead: &Dead,
    runner: &Runner,
    wanted: Wanted,
) -> Vec<Result<CaseRows, FailedCase>> {
    let planned: Vec<Result<Case, Failure>> = cases
        .clone()
        .map(|index| match dead.get(&index) {
            Some(death) => Err(Failure::from(death.clone())),
            None => plan.case(index).map_err(Failure::from),
        })
        .collect();
    let whole: Vec<Case> = planned.iter().flatten().cloned().collect();
    let mut recordings = runner(&whole).into_iter();
    let rows = planned.into_iter().map(|case| {
        let case = case?;
        let missing = || Err("the case was not simulated".into());
        let recording = recordings.next().unwrap_or_else(missing)?;
        rows(plan, case, recording, wanted)
    });
    cases
        .zip(rows)
        .map(|(index, rows)| rows.map_err(|failure| failed(plan, index, &failure)))
        .collect()
}

/// Case `index`, which failed.
fn failed(plan: &Plan, index: u64, failure: &Failure) -> FailedCase {
    let case_id = plan.case_id(index);
    FailedCase {
        reason: failure.to_string(),
        died: failure.is::<Death>(),
        command: FailedCase::command_of(Path::new("sweep.yaml"), &case_id),
        case_id,
    }
}

fn rows(
    plan: &Plan,
    mut case: Case,
    mut recording: Recording,
    wanted: Wanted,
) -> Result<CaseRows, Failure> {
    case.motion = recording.motion.take();
    check_channels(plan, &recording)?;
    let windows = cut_up(plan, &case, &recording)?;
    let rate = recording.sample_rate_hz;
    let features = match wanted {
        Wanted::Dataset { .. } => (windows.iter().enumerate())
            .map(|(i, window)| features_row(plan, &case, i, &window.recorded, rate))
            .collect(),
        Wanted::Signals => Vec::new(),
    };
    Ok(CaseRows {
        features,
        signals: match (plan.format, wanted) {
            (Format::Mcap, Wanted::Dataset { sweep_yaml }) => {
                Signals::Mcap(to_mcap(plan, &case, &recording, sweep_yaml)?)
            }
            _ => Signals::Rows(
                (windows.into_iter().enumerate())
                    .map(|(i, window)| signals_row(plan, &case, i, window.signals(), rate))
                    .collect(),
            ),
        },
        split: case.split,
        case_id: case.id,
        fault: case.labels.fault,
        warnings: recording.warnings,
    })
}

/// A window of a recording.
struct Window {
    /// The channels as recorded.
    recorded: Vec<Channel>,
    /// The channels over the crank angle, where the signals are.
    over_angle: Option<Vec<Channel>>,
}

impl Window {
    /// The channels of its row of `signals`.
    fn signals(self) -> Vec<Channel> {
        self.over_angle.unwrap_or(self.recorded)
    }
}

fn cut_up(plan: &Plan, case: &Case, recording: &Recording) -> Result<Vec<Window>, Failure> {
    let Some(over_angle) = plan.over_angle else {
        let ranges = windows(case, recording)?.into_iter();
        let window = |range| Window {
            recorded: cut(&recording.channels, range),
            over_angle: None,
        };
        return Ok(ranges.map(window).collect());
    };
    let windows =
        over_crank_angle::windows(case, recording, over_angle, plan.settings.revolutions)?;
    let window = |window: AngleWindow| Window {
        recorded: cut(&recording.channels, window.recorded),
        over_angle: Some(window.channels),
    };
    Ok(windows.into_iter().map(window).collect())
}

/// Checks that a recording has the channels of the tables, in full.
fn check_channels(plan: &Plan, recording: &Recording) -> Result<(), Failure> {
    let expected = plan.channels();
    let names = expected.iter().map(|(name, _)| name.as_str());
    if !recording.channels.iter().map(|c| c.name.as_str()).eq(names) {
        let found: Vec<&str> = recording.channels.iter().map(|c| c.name.as_str()).collect();
        return Err(format!("the recording has the channels {}", found.join(", ")).into());
    }
    let not_finite = |c: &&Channel| !c.samples.iter().all(|x| x.is_finite());
    match recording.channels.iter().find(not_finite) {
        None => Ok(()),
        Some(channel) => Err(format!("{} is not finite throughout", channel.name).into()),
    }
}

/// The samples of each window. Windows are as long as their revolutions take at the case's speed.
fn windows(case: &Case, recording: &Recording) -> Result<Vec<Range<usize>>, Failure> {
    let recorded = recording
        .channels
        .iter()
        .map(|c| c.samples.len())
        .min()
        .unwrap_or(0);
    let Some(windows) = case.windows else {
        return Ok(std::iter::once(0..recorded).collect());
    };
    let revolutions = f64::from(windows.revolutions.get());
    let length = revolutions * TAU / case.resolved.speed * recording.sample_rate_hz;
    // Equal lengths, so that the rows of one speed can be stacked.
    let samples = length.floor() as usize;
    let ranges: Vec<Range<usize>> = (0..windows.count.get())
        .map(|window| (f64::from(window) * length).round() as usize)
        .map(|start| start..start + samples)
        .collect();
    match ranges.last() {
        Some(last) if last.end > recorded => {
            Err(format!("{recorded} samples were recorded, {} are needed", last.end).into())
        }
        _ => Ok(ranges),
    }
}

fn cut(channels: &[Channel], range: Range<usize>) -> Vec<Channel> {
    let cut = |channel: &Channel| Channel {
        name: channel.name.clone(),
        unit: channel.unit.clone(),
        samples: channel.samples[range.clone()].to_vec(),
    };
    channels.iter().map(cut).collect()
}

fn to_mcap(
    plan: &Plan,
    case: &Case,
    recording: &Recording,
    sweep_yaml: &str,
) -> Result<Vec<u8>, Failure> {
    let channels: Vec<mcap::Channel> = recording
        .channels
        .iter()
        .map(|channel| mcap::Channel {
            name: &channel.name,
            unit: &channel.unit,
            samples: &channel.samples,
        })
        .collect();
    let sample_rate_hz = recording.sample_rate_hz;
    let mut labels = labels(plan, case);
    labels.insert("sample_rate_hz".to_owned(), sample_rate_hz.to_string());
    Ok(mcap::write(
        Vec::new(),
        &mcap::Recording {
            sample_rate_hz,
            channels: &channels,
            labels: &labels,
            sweep_yaml,
        },
    )?)
}
