//! Exponents and regimes of all cases, as far as the tables have them.

use crate::Failure;
use crate::report::dataset::Dataset;
use crate::report::grid::all_else;
use crate::report::windows::{Case, Windows};
use ::report::chaos_page::{CaseChaos, Regime, WindowChaos};
use recordings::{Kind, Table};
use std::collections::{BTreeMap, BTreeSet};

/// The columns, each a value per window; a column that the table lacks has none at all.
#[derive(Default)]
struct Columns {
    true_exponent: Vec<Option<f64>>,
    true_error: Vec<Option<f64>>,
    true_regime: Vec<Option<String>>,
    true_period: Vec<Option<f64>>,
    exponent: Vec<Option<f64>>,
    low: Vec<Option<f64>>,
    high: Vec<Option<f64>>,
    reason: Vec<Option<String>>,
    regime: Vec<Option<String>>,
}

impl Columns {
    fn read(dataset: &Dataset, windows: &Windows) -> Result<Self, Failure> {
        let mut columns = Self::default();
        for path in &windows.files {
            let file = dataset.table(path)?;
            let there: Vec<(String, Kind)> = file
                .schema()
                .columns()
                .iter()
                .map(|column| (column.name.clone(), column.kind))
                .filter(|(name, _)| {
                    name.contains("lyapunov") || name.contains("regime") || name.contains("period")
                })
                .collect();
            let names: Vec<&str> = there.iter().map(|(name, _)| name.as_str()).collect();
            if names.is_empty() {
                continue;
            }
            let table = file.read(&names, 0..file.rows());
            table
                .and_then(|table| columns.append(&table, &there))
                .map_err(|error| dataset.unreadable(path, error))?;
        }
        Ok(columns)
    }

    fn append(&mut self, table: &Table, there: &[(String, Kind)]) -> Result<(), recordings::Error> {
        let reader = Reader { table, there };
        reader.numbers("lyapunov_true_per_s", &mut self.true_exponent)?;
        let error = "lyapunov_true_standard_error_per_s";
        reader.numbers(error, &mut self.true_error)?;
        reader.numbers("period_true_revolutions", &mut self.true_period)?;
        reader.texts("regime_true", &mut self.true_regime)?;
        reader.numbers("lyapunov_per_s", &mut self.exponent)?;
        reader.numbers("lyapunov_low_per_s", &mut self.low)?;
        reader.numbers("lyapunov_high_per_s", &mut self.high)?;
        reader.texts("lyapunov_reason", &mut self.reason)?;
        reader.texts("regime", &mut self.regime)
    }

    /// Exponent from the equations with its standard error.
    fn truth(&self, window: usize) -> Option<[f64; 2]> {
        let error = value(&self.true_error, window).unwrap_or(0.0);
        Some([value(&self.true_exponent, window)?, error])
    }

    fn true_regime(&self, window: usize) -> Option<Regime> {
        let period = value(&self.true_period, window).map(|period| period as u32);
        Regime::of(&value(&self.true_regime, window)?, period)
    }

    fn window(&self, window: usize) -> WindowChaos {
        let exponent = || {
            let number = |column| value(column, window);
            Some([
                number(&self.exponent)?,
                number(&self.low)?,
                number(&self.high)?,
            ])
        };
        let regime = value(&self.regime, window);
        WindowChaos {
            exponent: exponent(),
            reason: value(&self.reason, window).unwrap_or_default(),
            regime: regime.and_then(|label| Regime::of(&label, None)),
        }
    }
}

/// A table and the names and kinds of some of its columns. One that is not there adds no value.
struct Reader<'a> {
    table: &'a Table,
    there: &'a [(String, Kind)],
}

impl Reader<'_> {
    fn kind(&self, name: &str) -> Option<Kind> {
        let found = self.there.iter().find(|(other, _)| other == name);
        found.map(|(_, kind)| *kind)
    }

    fn numbers(&self, name: &str, into: &mut Vec<Option<f64>>) -> Result<(), recordings::Error> {
        match self.kind(name) {
            Some(Kind::Integer) => {
                let values = self.table.values::<i64>(name)?.iter();
                into.extend(values.map(|value| value.map(|n| n as f64)));
            }
            Some(_) => into.extend_from_slice(self.table.values::<f64>(name)?),
            None => {}
        }
        Ok(())
    }

    fn texts(&self, name: &str, into: &mut Vec<Option<String>>) -> Result<(), recordings::Error> {
        if self.kind(name).is_some() {
            into.extend_from_slice(self.table.values::<String>(name)?);
        }
        Ok(())
    }
}

fn value<T: Clone>(column: &[Option<T>], window: usize) -> Option<T> {
    column.get(window).cloned().flatten()
}

/// What is known of each case, in the order of the sweep.
///
/// # Errors
/// A table that cannot be read.
pub(super) fn cases(
    dataset: &Dataset,
    windows: &Windows,
    cases: &[Case],
) -> Result<Vec<CaseChaos>, Failure> {
    let columns = Columns::read(dataset, windows)?;
    let by_fault = by_fault(dataset, windows, cases);
    let speed = dataset
        .labels
        .iter()
        .position(|label| label.column == "speed_rpm");
    let mut points: BTreeMap<Vec<String>, usize> = BTreeMap::new();
    let known = cases.iter().map(|case| {
        let first = case.first;
        let next = points.len();
        let point = points.entry(all_else(dataset, windows, first));
        let set = joint_set(dataset, windows, first, by_fault);
        CaseChaos {
            case_id: windows.case_id[first].clone(),
            clearance_m: if set == "none" {
                0.0
            } else {
                largest_clearance(dataset, windows, first, &set)
            },
            joints: set,
            speed_rpm: speed.map_or(f64::NAN, |at| windows.labels[at][first]),
            operating_point: *point.or_insert(next),
            exponent: columns.truth(first),
            regime: columns.true_regime(first),
            windows: case
                .windows
                .iter()
                .map(|&window| columns.window(window))
                .collect(),
        }
    });
    Ok(known.collect())
}

/// Which cases are chaotic.
pub(in crate::report) struct Regimes {
    columns: Columns,
}

impl Regimes {
    /// # Errors
    /// A table that cannot be read.
    pub(in crate::report) fn read(dataset: &Dataset, windows: &Windows) -> Result<Self, Failure> {
        let columns = Columns::read(dataset, windows)?;
        Ok(Self { columns })
    }

    /// Whether the case of the window is chaotic by the equations; none where nobody asked them.
    pub(in crate::report) fn chaotic(&self, window: usize) -> Option<bool> {
        let regime = self.columns.true_regime(window)?;
        Some(regime == Regime::Chaotic)
    }
}

/// The joints that have any clearance.
fn clear_joints(dataset: &Dataset, windows: &Windows, window: usize) -> String {
    let labels = dataset.labels.iter().zip(&windows.labels);
    let clear: Vec<&str> = labels
        .filter(|(_, values)| values[window] > 0.0)
        .filter_map(|(label, _)| label.joint.as_deref())
        .collect();
    if clear.is_empty() {
        "none".to_owned()
    } else {
        clear.join("+")
    }
}

/// Whether cases are told apart by their fault: where all have clearance in the same joints but
/// faults in different ones, as machines with worn and with sound bearings have. Otherwise they
/// are told apart by the joints that have any clearance.
fn by_fault(dataset: &Dataset, windows: &Windows, cases: &[Case]) -> bool {
    let sets: BTreeSet<String> = cases
        .iter()
        .map(|case| clear_joints(dataset, windows, case.first))
        .collect();
    let faults: BTreeSet<&str> = cases
        .iter()
        .map(|case| windows.fault[case.first].as_str())
        .collect();
    sets.len() == 1 && faults.iter().filter(|fault| **fault != "none").count() > 1
}

fn joint_set(dataset: &Dataset, windows: &Windows, window: usize, by_fault: bool) -> String {
    if by_fault {
        windows.fault[window].clone()
    } else {
        clear_joints(dataset, windows, window)
    }
}

/// The largest clearance among the joints of the set.
fn largest_clearance(dataset: &Dataset, windows: &Windows, window: usize, set: &str) -> f64 {
    let labels = dataset.labels.iter().zip(&windows.labels);
    labels
        .filter(|(label, _)| {
            let joint = label.joint.as_deref();
            set.split('+').any(|name| Some(name) == joint)
        })
        .map(|(_, values)| values[window])
        .fold(0.0, f64::max)
}
