//! Bundles of pressures that never reach the discharge line: accepted, with a note, or refused for their unit.

use calibrate::shut_valve::sentences;
use calibrate::{Error, Settings, Task, Valve, task};
use input::calibration::Calibration;
use std::f64::consts::TAU;
use std::fmt::Write;
use std::fs;

const SUCTION: f64 = 105e3;
const PER_REVOLUTION: usize = 360;
const REVOLUTIONS: usize = 12;

/// A bundle of one run with this pressure, Pa, over the crank angle, in a file that is said to be in `unit`, 1 Pa being `size`
/// there.
fn task_of(pressure: impl Fn(f64) -> f64, unit: &str, size: f64) -> Result<Task, Error> {
    task_with(393e3, pressure, unit, size)
}

/// The same with this discharge pressure, Pa.
fn task_with(
    discharge: f64,
    pressure: impl Fn(f64) -> f64,
    unit: &str,
    size: f64,
) -> Result<Task, Error> {
    let folder = tempfile::tempdir().unwrap();
    let list = format!(
        "
machine:
  type: single-stage
  stroke_m: 0.24
  rod_length_m: 0.6
  piston_radius_m: 0.05
  double_acting: false
  head_clearance_m: 0.024
  polytropic_exponent: 1.4
  back_pressure_pa: 0
  rod_mass_kg: 12.0
  rod_big_end_to_cg_m: 0.22
  rod_inertia_cg_kg_m2: 0.6
  crosshead_mass_kg: 18.0
runs:
- id: motored
  file: motored.csv
  speed_rpm: 500
  load: {{suction_pressure_pa: {SUCTION}, discharge_pressure_pa: {discharge}}}
  channels:
  - {{name: crank angle, column: angle, unit: deg}}
  - {{name: cylinder pressure, column: pressure, unit: {unit}}}
"
    );
    fs::write(folder.path().join("recordings.yaml"), list).unwrap();
    let mut csv = "angle,pressure\n".to_owned();
    for i in 0..REVOLUTIONS * PER_REVOLUTION {
        let angle = i as f64 / PER_REVOLUTION as f64;
        // Noise that no two revolutions share.
        let noise = (1.7 * (i * i % 1009) as f64).sin() * 30.0;
        let pressure = size * (pressure(TAU * angle) + noise);
        writeln!(csv, "{},{pressure}", 360.0 * angle.fract()).unwrap();
    }
    fs::write(folder.path().join("motored.csv"), csv).unwrap();
    task(&Settings {
        calibration: &Calibration::with_defaults(vec![folder.path().to_owned()]),
        base: folder.path(),
        machine: None,
        allow_outside: false,
        clearances_unknown: false,
        locate: &|error| error,
    })
}

#[test]
fn pressures_at_the_suction_line_are_accepted_with_a_note() {
    // Motored without valves, and unloaded with a valve that throttles.
    for loss in [0.0, 0.04] {
        let task = task_of(|angle| SUCTION * (1.0 - loss * angle.sin()), "Pa", 1.0).unwrap();
        let [shut] = &task.shut_valves[..] else {
            panic!("{:?}", task.shut_valves);
        };
        assert_eq!(shut.valve, Valve::Discharge);
        assert!(
            (shut.reached_pa / SUCTION - 1.0 - loss).abs() < 0.01,
            "{shut:?}"
        );
        let said = sentences(&task.shut_valves);
        let expected = "cylinder_pressure_pa, motored: the discharge valve does not open.";
        assert!(said[0].starts_with(expected), "{said:?}");
        // The discharge line is not seen, and its pressure is not fitted.
        let paths: Vec<&str> = task
            .problem
            .parameters
            .iter()
            .map(|p| p.path.as_str())
            .collect();
        let expected = [
            "cylinder.exponent",
            "cylinder.head_clearance",
            "runs.motored.cylinder.suction",
        ];
        assert_eq!(paths, expected);
        // It is a motion that repeats itself.
        assert!(task.problem.runs[0].repeats_like(&task.problem.runs));
    }
}

#[test]
fn a_wrong_unit_of_the_same_pressures_is_refused() {
    for (unit, size) in [("Pa", 1e-5), ("kPa", 1e-5), ("bar", 1e-3), ("psi", 1e-3)] {
        let refused = task_of(|_| SUCTION, unit, size)
            .err()
            .map(|error| error.to_string());
        let refused = refused.unwrap_or_default();
        assert!(refused.contains("check its unit"), "{unit}: {refused}");
    }
}

#[test]
fn a_pressure_without_a_mean_says_nothing_of_valves_and_is_not_calibrated_to() {
    let task = task_of(|angle| -1e5 * angle.cos(), "Pa", 1.0).unwrap();
    assert!(task.shut_valves.is_empty());
    let refused = task.refuse_without_mean().unwrap_err().to_string();
    assert!(
        refused.contains("state its `high_pass` in the machine file"),
        "{refused}"
    );
    let absolute = task_of(|angle| SUCTION * (1.0 - 0.04 * angle.sin()), "Pa", 1.0).unwrap();
    absolute.refuse_without_mean().unwrap();
}

#[test]
fn lines_of_the_same_pressure_have_one_value() {
    let task = task_with(
        SUCTION,
        |angle| SUCTION * (1.0 - 0.04 * angle.sin()),
        "Pa",
        1.0,
    )
    .unwrap();
    assert!(task.shut_valves.is_empty());
    let parameters = task.problem.parameters.iter();
    let lines: Vec<_> = parameters.filter(|p| p.run.is_some()).collect();
    assert_eq!(lines.len(), 1);
    assert_eq!(lines[0].places, ["cylinder.suction", "cylinder.discharge"]);
    // The machine is possible at any value.
    for x in lines[0].box_bounds() {
        let mut tree = task.problem.tree.clone();
        lines[0]
            .write_for("motored", &mut tree, lines[0].value(x))
            .unwrap();
        let machine = input::MachineFile::from_tree(&tree).unwrap();
        assert!(machine.resolve().is_ok());
    }
}
