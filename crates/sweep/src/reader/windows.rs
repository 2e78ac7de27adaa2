//! The rows of the table of features.

use super::channel_features::ChannelFeatures;
use super::files::Files;
use super::labels::{self, Label, Text};
use super::{Error, Sensors, Subset, numbers, texts};
use crate::Plan;
use crate::labels::NONE;
use recordings::Table;
use std::collections::BTreeSet;

/// All windows of a dataset, in the order of the files.
pub struct Windows {
    /// The files of the table, from the dataset's folder.
    pub(super) files: Vec<String>,
    /// Which of the files a window is in, and in which row of it.
    pub(super) place: Vec<(usize, usize)>,
    /// The case of each window.
    pub case_id: Vec<String>,
    /// The split of each window.
    pub split: Vec<String>,
    /// The fault of each window: joints and effects joined by `+`, or `none`.
    pub fault: Vec<String>,
    /// The numbers that describe a case.
    pub labels: Vec<Label>,
    /// The parameters that are text.
    pub texts: Vec<Text>,
    /// The features of each of the dataset's sensors.
    pub measured: Vec<ChannelFeatures>,
}

/// The windows of one case.
pub struct Case {
    /// The first of them; labels are the same for all.
    pub first: usize,
    /// All of them.
    pub windows: Vec<usize>,
}

impl Windows {
    /// # Errors
    /// A table that is damaged or lacks a column.
    pub(super) fn read(files: &Files, plan: &Plan, sensors: &Sensors) -> Result<Self, Error> {
        let rate = plan.settings.sample_rate;
        let channels = sensors.channels().iter();
        let mut windows = Self {
            files: files.paths(Subset::Features),
            place: Vec::new(),
            case_id: Vec::new(),
            split: Vec::new(),
            fault: Vec::new(),
            labels: labels::numbers(plan),
            texts: labels::texts(plan),
            measured: channels
                .map(|channel| ChannelFeatures::new(channel, rate))
                .collect(),
        };
        let names = windows.columns();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        for (i, path) in windows.files.clone().iter().enumerate() {
            let file = files.open(path)?;
            let rows = 0..file.rows();
            files.read(path, &file, &names, rows, |table| windows.append(i, table))?;
        }
        Ok(windows)
    }

    /// The columns that they are read from.
    fn columns(&self) -> Vec<String> {
        let ids = ["case_id", "split", "fault"].map(str::to_owned);
        let labels = self.labels.iter().map(|label| label.column.clone());
        let texts = self.texts.iter().map(|text| text.column.clone());
        let measured = self.measured.iter().flat_map(ChannelFeatures::columns);
        let all = ids.into_iter().chain(labels).chain(texts).chain(measured);
        all.collect()
    }

    fn append(&mut self, file: usize, table: &Table) -> Result<(), recordings::Error> {
        self.place.extend((0..table.rows()).map(|row| (file, row)));
        self.case_id.extend(texts(table, "case_id")?);
        self.split.extend(texts(table, "split")?);
        self.fault.extend(texts(table, "fault")?);
        for label in &mut self.labels {
            label.values.extend(numbers(table, &label.column)?);
        }
        for text in &mut self.texts {
            text.values.extend(texts(table, &text.column)?);
        }
        self.measured
            .iter_mut()
            .try_for_each(|measured| measured.append(table))
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.case_id.len()
    }

    /// The windows of each case, in the order of the sweep.
    pub(super) fn cases(&self) -> Vec<Case> {
        let mut order: Vec<usize> = (0..self.count()).collect();
        order.sort_by(|&a, &b| self.case_id[a].cmp(&self.case_id[b]));
        order
            .chunk_by(|&a, &b| self.case_id[a] == self.case_id[b])
            .map(|windows| Case {
                first: windows[0],
                windows: windows.to_vec(),
            })
            .collect()
    }

    /// The joints and effects that the fault of the window names.
    pub fn faults(&self, window: usize) -> impl Iterator<Item = &str> {
        self.fault[window].split('+').filter(|name| *name != NONE)
    }

    /// The joints, each with its clearance in the window's case, m.
    pub fn clearances(&self, window: usize) -> impl Iterator<Item = (&str, f64)> {
        let labels = self.labels.iter();
        labels.filter_map(move |label| Some((label.joint()?, label.values[window])))
    }

    /// The largest clearance of the window's case among the faulty joints, or among all where none
    /// is faulty, in m.
    pub fn largest_clearance(&self, window: usize) -> f64 {
        let joints: BTreeSet<&str> = self.clearances(window).map(|(joint, _)| joint).collect();
        let faulty = self.faults(window).filter(|name| joints.contains(name));
        let faulty: BTreeSet<&str> = faulty.collect();
        self.clearances(window)
            .filter(|(joint, _)| faulty.is_empty() || faulty.contains(joint))
            .map(|(_, clearance)| clearance)
            .fold(0.0, f64::max)
    }

    /// Everything that is said about the window's case but its clearances: the same for cases that
    /// are equal in all else.
    pub fn all_else(&self, window: usize) -> Vec<String> {
        let numbers = self.labels.iter().filter(|label| label.joint().is_none());
        let numbers = numbers.map(|label| format!("{:e}", label.values[window]));
        let texts = self.texts.iter().map(|text| text.values[window].clone());
        numbers.chain(texts).collect()
    }
}
