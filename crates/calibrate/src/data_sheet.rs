//! The values of a data sheet that are usually wrong, and by how much.
//!
//! A calibration takes masses, lengths, clearances and the gain of its sensors for known. Where one of them
//! is not, no contact parameters explain the recordings. Each may be freed within a prior: normal, about the
//! stated value, in the coordinate of its [`Parameter`].

use crate::error::Error;
use crate::observation::Observation;
use crate::parameter::{Parameter, Scale};
use crate::problem::Problem;
use crate::relation::{ClearJoint, clearances};
use input::{MachineFile, paths};
use serde_json::{Value, json};
use simulate::sensor::Quantity;

/// Standard deviation of a stated mass. Castings differ from their drawings by 3 to 5 %. A crosshead is
/// stated with or without its pin and piston rod.
const MASS: f64 = 0.05;
/// Of an inertia, which is not weighed but estimated from a drawing.
const INERTIA: f64 = 0.1;
/// Of a centre of mass: weighed at both ends, with the errors of two masses.
const CENTRE_OF_MASS: f64 = 0.05;
/// Of a rod's length: it is shimmed and rebushed, by millimetres in hundreds.
const LENGTH: f64 = 0.01;
/// Of a stated clearance: a feeler gauge has steps of 0.02 mm, about 0.1 mm.
const CLEARANCE: f64 = 0.2;
/// Of a clearance volume: the pockets of the valves are left out or estimated.
const VOLUME: f64 = 0.1;
/// Of an exponent of the gas: that of the gas by itself lies 0.1 above those of cooled cylinders, and of moist gas below.
const EXPONENT: f64 = 0.04;
/// Of the pressure of a line: a gauge of class 1.6 (EN 837-1) is that share of its range off, at half of its range twice as much.
const LINE: f64 = 0.03;
/// Of the gain of a sensor: accelerometers for industry are sold to ±5 or ±10 %.
const GAIN: f64 = 0.05;
/// Of the delay between a channel and the crank angle, s. Anti-alias filters of 1 to 5 kHz have a group delay
/// of 0.1 to 0.5 ms.
const DELAY: f64 = 5e-4;
/// Median of a low-pass that is not stated, Hz, and the logarithm of the factor about it. Cables, magnets and
/// mounts end between 1 and 10 kHz.
const CUTOFF: f64 = 3e3;
const CUTOFF_FACTOR: f64 = 0.7;
/// Its order: that of a sensor on its mount.
const ORDER: u32 = 2;
/// How many standard deviations of its prior a value may lie from the stated one.
pub const REACH: f64 = 3.0;

/// Values that stand in a data sheet by themselves, and the relative standard deviation of each.
const VALUES: [(&str, f64); 9] = [
    ("crank.mass", MASS),
    ("rod.length", LENGTH),
    ("rod.mass", MASS),
    ("rod.centre_of_mass", CENTRE_OF_MASS),
    ("rod.inertia", INERTIA),
    ("crosshead.mass", MASS),
    ("cylinder.head_clearance", VOLUME),
    ("cylinder.crank_end.clearance", VOLUME),
    ("cylinder.exponent", EXPONENT),
];

/// Where the pressures of lines stand.
const LINES: [&str; 2] = ["cylinder.suction", "cylinder.discharge"];

/// A value that may be wrong.
#[derive(Clone, Debug)]
pub struct Doubt {
    /// The machine file, with the value where it had none.
    pub tree: Value,
    /// The value.
    pub parameter: Parameter,
    /// Standard deviation of its prior, in its coordinate.
    pub deviation: f64,
    /// Coordinates from which it is looked at.
    pub starts: Vec<f64>,
    /// Whether the data sheet states it.
    pub stated: bool,
}

impl Doubt {
    /// Whether it is a value of the machine by itself or the pressure of its lines, and no clearance of a joint and nothing of a sensor.
    pub fn is_of_machine(&self) -> bool {
        let path = self.parameter.path.as_str();
        let is_value = |(key, _): &(&str, f64)| path == *key || path.ends_with(&format!(".{key}"));
        self.parameter.is_of_each_run() || VALUES.iter().any(is_value)
    }

    /// The problem with this value free as well, the last of the parameters.
    pub fn added(&self, problem: &Problem) -> Problem {
        let mut added = problem.clone();
        added.tree = self.tree.clone();
        added.parameters.push(self.parameter.clone());
        added
    }
}

/// What may be wrong with the data sheet of a problem's machine; what is fitted already is in no doubt.
///
/// # Errors
/// An invalid machine file.
pub fn doubts(problem: &Problem) -> Result<Vec<Doubt>, Error> {
    let mut doubts = of_machine(problem)?;
    doubts.extend(of_joints(problem)?);
    doubts.extend(of_lines(problem)?);
    doubts.extend(of_sensors(problem)?);
    doubts.retain(|doubt| {
        let of_runs = doubt.parameter.is_of_each_run();
        let fitted = |place: &String| {
            let mut parameters = problem.parameters.iter();
            parameters.any(|p| (of_runs || p.run.is_none()) && p.places.contains(place))
        };
        !doubt.parameter.places.iter().any(fitted)
    });
    Ok(doubts)
}

/// The pressures of lines that every run states: all were read from one gauge.
fn of_lines(problem: &Problem) -> Result<Vec<Doubt>, Error> {
    let mut doubts = Vec::new();
    let Some(first) = problem.runs.first() else {
        return Ok(doubts);
    };
    let mut tree = problem.tree.clone();
    for (path, value) in &first.settings {
        paths::set(&mut tree, path, value.clone())?;
    }
    let is_line = |path: &str| LINES.iter().any(|line| path.ends_with(line));
    let is_stated = |path: &str| {
        let states = |run: &Observation| run.settings.iter().any(|(own, _)| own == path);
        problem.runs.iter().all(states)
    };
    for (path, _) in &first.settings {
        if is_line(path) && is_stated(path) {
            let doubt = relative(tree.clone(), path, LINE).map(|doubt| Doubt {
                tree: problem.tree.clone(),
                parameter: doubt.parameter.of_each_run(),
                ..doubt
            });
            doubts.extend(doubt);
        }
    }
    Ok(doubts)
}

fn of_machine(problem: &Problem) -> Result<Vec<Doubt>, Error> {
    let tree = &problem.tree;
    let names: Vec<String> = match tree["throws"].as_array() {
        Some(throws) => (0..throws.len())
            .map(|i| {
                let name = throws[i]["name"].as_str().map(str::to_owned);
                format!("throws.{}.", name.unwrap_or_else(|| i.to_string()))
            })
            .collect(),
        None => vec![String::new()],
    };
    let mut doubts = Vec::new();
    for (key, width) in VALUES {
        // The crank is one, with any number of throws.
        let prefixes: &[String] = match key.starts_with("crank.") {
            true => &[String::new()],
            false => &names,
        };
        for prefix in prefixes {
            let path = format!("{prefix}{key}");
            if let Ok(Some(_)) = paths::get(tree, &path) {
                doubts.extend(relative(tree.clone(), &path, width));
            }
        }
    }
    Ok(doubts)
}

/// The clearances that all runs state alike: where they differ, a single value would be none of them.
fn of_joints(problem: &Problem) -> Result<Vec<Doubt>, Error> {
    let of_runs = problem.runs.iter().map(|run| &run.settings[..]);
    let joints = ClearJoint::in_runs(&problem.tree, of_runs)?;
    let state = |run: &Observation| clearances(&problem.tree, &joints, &run.settings);
    let states = problem
        .runs
        .iter()
        .map(state)
        .collect::<Result<Vec<_>, _>>()?;
    let mut doubts = Vec::new();
    for (i, joint) in joints.iter().enumerate() {
        if states.iter().any(|state| state[i] != Some(joint.clearance)) {
            continue;
        }
        let mut tree = problem.tree.clone();
        let path = joint.clearance_path();
        let mut settings = problem.runs.iter().flat_map(|run| &run.settings);
        if let Some((_, value)) = settings.rfind(|(key, _)| *key == path) {
            paths::set(&mut tree, &path, value.clone())?;
        }
        doubts.extend(relative(tree, &path, CLEARANCE).map(|doubt| Doubt {
            starts: (-3..=3).map(|i| 0.15 * f64::from(i)).collect(),
            ..doubt
        }));
    }
    Ok(doubts)
}

/// A positive value with a relative standard deviation.
fn relative(tree: Value, path: &str, width: f64) -> Option<Doubt> {
    let nominal = Parameter::at(&tree, path).ok()?.nominal;
    let factor = 1.0 + REACH * width;
    let parameter = Parameter::within(&tree, path, [nominal / factor, nominal * factor]).ok()?;
    Some(Doubt {
        tree,
        parameter,
        deviation: width,
        starts: vec![0.0],
        stated: true,
    })
}

/// Gain, delay and low-pass of each channel.
fn of_sensors(problem: &Problem) -> Result<Vec<Doubt>, Error> {
    let mut columns: Vec<&str> = Vec::new();
    for channel in problem.runs.iter().flat_map(|run| &run.channels) {
        if !columns.contains(&channel.column.as_str()) {
            columns.push(&channel.column);
        }
    }
    let mut doubts = Vec::new();
    for column in columns {
        let Some((tree, sensor)) = with_sensor(&problem.tree, column)? else {
            continue;
        };
        let with = |key: &str, value: Value| {
            let mut tree = tree.clone();
            let path = format!("{sensor}.{key}");
            let stated = matches!(paths::get(&tree, &path), Ok(Some(value)) if !value.is_null());
            if !stated {
                paths::set(&mut tree, &path, value)?;
            }
            Ok::<_, Error>((tree, path, stated))
        };
        let (gained, path, _) = with("gain", json!(1.0))?;
        doubts.extend(relative(gained, &path, GAIN));
        let (late, path, _) = with("delay", json!("0 s"))?;
        if let Ok(parameter) = Parameter::within(&late, &path, [0.0, REACH * DELAY]) {
            doubts.push(Doubt {
                deviation: DELAY / (0.5 * REACH * DELAY),
                tree: late,
                parameter,
                starts: vec![0.0],
                stated: true,
            });
        }
        // Pressures have next to nothing where a cable ends.
        if Quantity::of_column(column).is_pressure() {
            continue;
        }
        let (filtered, path, stated) = with(
            "low_pass",
            json!({"cutoff": format!("{CUTOFF} Hz"), "order": ORDER}),
        )?;
        let path = format!("{path}.cutoff");
        let factor = (REACH * CUTOFF_FACTOR).exp();
        let bounds = [CUTOFF / factor, CUTOFF * factor];
        if !stated && let Ok(parameter) = Parameter::within(&filtered, &path, bounds) {
            doubts.push(Doubt {
                tree: filtered,
                parameter,
                deviation: CUTOFF_FACTOR,
                starts: vec![-1.5 * CUTOFF_FACTOR, 0.0, 1.5 * CUTOFF_FACTOR],
                stated: false,
            });
        }
    }
    debug_assert!(
        doubts
            .iter()
            .all(|d| d.parameter.scale == Scale::Logarithmic || d.stated)
    );
    Ok(doubts)
}

/// The machine file with a sensor for the column, and the path of that; none for a column of no sensor.
fn with_sensor(tree: &Value, column: &str) -> Result<Option<(Value, String)>, Error> {
    let machine = MachineFile::from_tree(tree)?.resolve()?;
    let throws = machine.machine.throws.iter();
    let names: Vec<&str> = throws.map(|throw| throw.name.as_str()).collect();
    let mut sensors = machine.sensors.iter();
    if let Some(i) = sensors.position(|sensor| sensor.measured.column(&names) == column) {
        return Ok(Some((tree.clone(), format!("sensors.{i}"))));
    }
    let (throw, name) = match column.split_once('.') {
        Some((throw, name)) => (Some(throw), name),
        None => (None, column),
    };
    let mut item = match name {
        "crosshead_acceleration_m_s2" => json!({"measure": "crosshead_acceleration"}),
        "cylinder_pressure_pa" => json!({"measure": "cylinder_pressure"}),
        "cylinder_pressure_crank_end_pa" => json!({"measure": "cylinder_pressure", "end": "crank"}),
        _ => return Ok(None),
    };
    if let Some(throw) = throw {
        item["throw"] = throw.into();
    }
    let mut tree = tree.clone();
    if !tree["sensors"].is_array() {
        tree["sensors"] = json!([]);
    }
    let count = tree["sensors"].as_array().map_or(0, Vec::len);
    if let Some(sensors) = tree["sensors"].as_array_mut() {
        sensors.push(item);
    }
    Ok(Some((tree, format!("sensors.{count}"))))
}
