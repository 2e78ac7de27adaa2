//! Exponents and regimes of all cases, as far as the tables have them.

use crate::Error;
use crate::chaos::regime::Regime;
use std::collections::{BTreeMap, BTreeSet};
use sweep::labels::NONE;
use sweep::reader::{Dataset, Meaning, Motions, Windows};

/// What is known about the chaos of one case.
#[derive(Clone, Debug, Default)]
pub struct CaseChaos {
    /// The case.
    pub case_id: String,
    /// The joints with clearance as a label; `none` for the ideal machine.
    pub joints: String,
    /// The largest of their clearances.
    pub clearance_m: f64,
    /// Speed of the crank.
    pub speed_rpm: f64,
    /// The same number for cases that differ in their clearances alone.
    pub operating_point: usize,
    /// Largest Lyapunov exponent from the equations and its standard error, 1/s.
    pub exponent: Option<[f64; 2]>,
    /// Regime from the equations.
    pub regime: Option<Regime>,
    /// What the signal of each window says.
    pub windows: Vec<WindowChaos>,
}

/// What the signal of one window says.
#[derive(Clone, Debug, Default)]
pub struct WindowChaos {
    /// Largest Lyapunov exponent with the ends of its 95 % interval, 1/s: value, low, high.
    pub exponent: Option<[f64; 3]>,
    /// Why there is no exponent; empty if there is one, or if it was not computed.
    pub reason: String,
    /// Regime from the signal.
    pub regime: Option<Regime>,
}

/// What is known of each case, in the order of the sweep.
///
/// # Errors
/// A table that cannot be read.
pub fn cases(dataset: &Dataset) -> Result<Vec<CaseChaos>, Error> {
    let motions = dataset.motions()?;
    let windows = &dataset.windows;
    let by_fault = by_fault(dataset);
    let mut labels = windows.labels.iter();
    let speed = labels.find(|label| label.meaning == Meaning::Speed);
    let mut points: BTreeMap<Vec<String>, usize> = BTreeMap::new();
    let known = dataset.cases.iter().map(|case| {
        let first = case.first;
        let next = points.len();
        let point = points.entry(windows.all_else(first));
        let set = match by_fault {
            true => windows.fault[first].clone(),
            false => clear_joints(windows, first),
        };
        let of_window = |window: &usize| of_window(&motions, *window);
        CaseChaos {
            case_id: windows.case_id[first].clone(),
            clearance_m: largest_clearance(windows, first, &set),
            joints: set,
            speed_rpm: speed.map_or(f64::NAN, |speed| speed.values[first]),
            operating_point: *point.or_insert(next),
            exponent: motions.true_exponent(first),
            regime: true_regime(&motions, first),
            windows: case.windows.iter().map(of_window).collect(),
        }
    });
    Ok(known.collect())
}

fn true_regime(motions: &Motions, window: usize) -> Option<Regime> {
    let (label, period) = motions.true_regime(window)?;
    Regime::from_label(label, period)
}

/// Whether the case of the window is chaotic by the equations; none if they were not computed.
pub(crate) fn is_chaotic(motions: &Motions, window: usize) -> Option<bool> {
    Some(true_regime(motions, window)? == Regime::Chaotic)
}

/// What the signal of a window says.
fn of_window(motions: &Motions, window: usize) -> WindowChaos {
    let regime = motions.regime(window);
    WindowChaos {
        exponent: motions.exponent(window),
        reason: motions.reason(window).unwrap_or_default().to_owned(),
        regime: regime.and_then(|label| Regime::from_label(label, None)),
    }
}

/// The joints that have any clearance.
fn clear_joints(windows: &Windows, window: usize) -> String {
    let clear = windows.clearances(window);
    let clear = clear.filter(|(_, clearance)| *clearance > 0.0);
    let clear: Vec<&str> = clear.map(|(joint, _)| joint).collect();
    match clear.as_slice() {
        [] => NONE.to_owned(),
        clear => clear.join("+"),
    }
}

/// Whether cases are grouped by their fault: where all have clearance in the same joints but
/// faults in different ones, as machines with worn and with sound bearings have. Otherwise they
/// are grouped by the joints that have any clearance.
fn by_fault(dataset: &Dataset) -> bool {
    let firsts = || dataset.cases.iter().map(|case| case.first);
    let sets = firsts().map(|first| clear_joints(&dataset.windows, first));
    let sets: BTreeSet<String> = sets.collect();
    let faults = firsts().map(|first| dataset.windows.fault[first].as_str());
    let faults: BTreeSet<&str> = faults.filter(|fault| *fault != NONE).collect();
    sets.len() == 1 && faults.len() > 1
}

/// The largest clearance among the joints of the set; 0 where the set is of none.
fn largest_clearance(windows: &Windows, window: usize, set: &str) -> f64 {
    let clearances = windows.clearances(window);
    clearances
        .filter(|(joint, _)| set.split('+').any(|name| name == *joint))
        .map(|(_, clearance)| clearance)
        .fold(0.0, f64::max)
}
