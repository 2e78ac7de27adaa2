//! The rows of the table of features: a number per label and window, none of the recordings.

use super::dataset::Dataset;
use super::features::Measured;
use crate::Failure;
use recordings::Table;
use std::collections::BTreeSet;
use sweep::Plan;

/// All windows of a dataset, in the order of the files.
pub(super) struct Windows {
    /// The files of the table, from the dataset's folder.
    pub(super) files: Vec<String>,
    /// Which of the files a window is in, and in which row of it.
    pub(super) place: Vec<(usize, usize)>,
    pub(super) case_id: Vec<String>,
    pub(super) split: Vec<String>,
    pub(super) fault: Vec<String>,
    /// Values by window of each of the dataset's labels; NaN where one is missing.
    pub(super) labels: Vec<Vec<f64>>,
    /// Values by window of each parameter that is text.
    pub(super) texts: Vec<Vec<String>>,
    /// The features of each of the dataset's sensors.
    pub(super) measured: Vec<Measured>,
}

impl Windows {
    /// # Errors
    /// A table that is damaged or lacks a column.
    pub(super) fn read(dataset: &Dataset) -> Result<Self, Failure> {
        let texts = text_columns(&dataset.plan);
        let mut windows = Self {
            files: dataset.files("features"),
            place: Vec::new(),
            case_id: Vec::new(),
            split: Vec::new(),
            fault: Vec::new(),
            labels: vec![Vec::new(); dataset.labels.len()],
            texts: vec![Vec::new(); texts.len()],
            measured: dataset
                .sensors
                .channels()
                .iter()
                .map(|channel| Measured::new(channel, dataset.plan.settings.sample_rate))
                .collect(),
        };
        for (i, path) in windows.files.clone().iter().enumerate() {
            let file = dataset.table(path)?;
            let mut names = vec!["case_id", "split", "fault"];
            names.extend(dataset.labels.iter().map(|label| label.column.as_str()));
            names.extend(texts.iter().copied());
            let measured: Vec<String> = windows
                .measured
                .iter()
                .flat_map(Measured::columns)
                .collect();
            names.extend(measured.iter().map(String::as_str));
            let table = file.read(&names, 0..file.rows());
            table
                .and_then(|table| windows.append(i, &table, dataset, &texts))
                .map_err(|error| dataset.unreadable(path, error))?;
        }
        Ok(windows)
    }

    fn append(
        &mut self,
        file: usize,
        table: &Table,
        dataset: &Dataset,
        texts: &[&str],
    ) -> Result<(), recordings::Error> {
        let text = |name: &str| -> Result<Vec<String>, recordings::Error> {
            let values = table.values::<String>(name)?.iter();
            Ok(values
                .map(|value| value.clone().unwrap_or_default())
                .collect())
        };
        self.place.extend((0..table.rows()).map(|row| (file, row)));
        self.case_id.extend(text("case_id")?);
        self.split.extend(text("split")?);
        self.fault.extend(text("fault")?);
        for (label, values) in dataset.labels.iter().zip(&mut self.labels) {
            values.extend(numbers(table, &label.column)?);
        }
        for (name, values) in texts.iter().zip(&mut self.texts) {
            values.extend(text(name)?);
        }
        self.measured
            .iter_mut()
            .try_for_each(|measured| measured.append(table))
    }

    pub(super) fn count(&self) -> usize {
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
    pub(super) fn faults(&self, window: usize) -> impl Iterator<Item = &str> {
        self.fault[window].split('+').filter(|name| *name != "none")
    }

    /// The largest clearance of the window's case among the faulty joints, or among all where none
    /// is faulty, in m.
    pub(super) fn largest_clearance(&self, dataset: &Dataset, window: usize) -> f64 {
        let joints = dataset.labels.iter().filter_map(|l| l.joint.as_deref());
        let joints: BTreeSet<&str> = joints.collect();
        let faulty = self.faults(window).filter(|name| joints.contains(name));
        let faulty: BTreeSet<&str> = faulty.collect();
        let counts = |joint: &String| faulty.is_empty() || faulty.contains(joint.as_str());
        let clearances = dataset.labels.iter().zip(&self.labels);
        clearances
            .filter(|(label, _)| label.joint.as_ref().is_some_and(counts))
            .map(|(_, values)| values[window])
            .fold(0.0, f64::max)
    }
}

/// The windows of one case.
pub(super) struct Case {
    /// The first of them; labels are the same for all.
    pub(super) first: usize,
    pub(super) windows: Vec<usize>,
}

/// The values of a column of numbers; NaN where one is missing.
pub(super) fn numbers(
    table: &Table,
    name: &str,
) -> Result<impl Iterator<Item = f64>, recordings::Error> {
    let values = table.values::<f64>(name)?.iter();
    Ok(values.map(|value| value.unwrap_or(f64::NAN)))
}

fn text_columns(plan: &Plan) -> Vec<&str> {
    let texts = plan.parameters.iter().filter(|p| !p.is_number);
    texts.map(|p| p.column.as_str()).collect()
}
