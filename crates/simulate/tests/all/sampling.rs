//! What sensors see between the evaluations of a step, and of a motion that repeats itself, against the motion evaluated at
//! every instant.

use input::{MachineFile, Resolved};
use serde_json::{Value, json};
use signal::decimate::Decimator;
use simulate::{Asked, Settings, Transient, simulate, simulate_together};
use std::path::Path;

/// The shipped machine with these values.
fn changed(values: &[(&str, Value)]) -> Resolved {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/machines");
    let file = input::machine_file::read(&folder.join("single-stage.yaml")).unwrap();
    let mut tree = file.to_tree().clone();
    for (path, value) in values {
        input::paths::set(&mut tree, path, value.clone()).unwrap();
    }
    MachineFile::from_tree(&tree).unwrap().resolve().unwrap()
}

/// The shipped machine with both joints this clear.
fn machine(clearance: &str) -> Resolved {
    let path = |joint: &str| format!("joints.{joint}.clearance");
    changed(&[
        (&path("big_end"), clearance.into()),
        (&path("small_end"), clearance.into()),
    ])
}

/// A machine whose motion repeats itself after two revolutions, and whose contact remembers at which speed it was met.
fn of_two_revolutions() -> Resolved {
    let contact =
        json!({"law": "lankarani_nikravesh", "stiffness": "24 GN/m^1.5", "restitution": 0.5});
    changed(&[
        ("speed", "700 rpm".into()),
        ("joints.small_end.clearance", "0.4 mm".into()),
        ("joints.small_end.contact", contact),
        ("joints.small_end.friction.coefficient", 0.01.into()),
    ])
}

/// What the polynomials within steps leave out is less than the tolerance allows the steps themselves, over the largest value. The
/// trace is evaluated at every instant, and by the same filter becomes what the sensor recorded.
#[test]
fn polynomials_within_steps_leave_out_less_than_the_tolerance() {
    for clearance in ["0.02 mm", "0.1 mm", "0.3 mm"] {
        let Resolved {
            machine, sensors, ..
        } = machine(clearance);
        let at = |column: &str| {
            let found = sensors
                .iter()
                .position(|s| s.measured.column(&[]) == column);
            found.unwrap()
        };
        for tolerance in [1e-5, 1e-6, 1e-7, 1e-9] {
            let settings = Settings {
                transient: Transient::Revolutions(3),
                revolutions: 2,
                tolerance,
                ..Settings::default()
            };
            let record = simulate(&machine, &sensors, &settings, true).unwrap();
            let trace = record.trace.unwrap();
            let decimator = Decimator::new(trace.stride).unwrap();
            let lead = decimator.half_length();
            for (column, evaluated) in [
                ("crosshead_acceleration_m_s2", &trace.throws[0].acceleration),
                ("cylinder_pressure_pa", &trace.throws[0].pressure),
            ] {
                let recorded = &record.series[at(column)];
                let filtered = decimator.apply(evaluated);
                let first = lead.div_ceil(trace.stride);
                assert_eq!(lead % trace.stride, 0);
                let largest = recorded.iter().fold(0.0_f64, |l, x| l.max(x.abs()));
                let off = filtered.iter().zip(&recorded[first..]);
                let off = off.fold(0.0_f64, |l, (a, b)| l.max((a - b).abs()));
                assert!(
                    off < tolerance * largest,
                    "{clearance} {tolerance}: {column} {off:e}"
                );
                eprintln!("{clearance} {tolerance:e}: {column} {:.1e}", off / largest);
            }
        }
    }
}

/// A motion that repeats itself is integrated over one period, of which the record is the repetition. The trace is of the motion
/// as it goes on: it differs by less than the tolerance, by an RMS of which the integration itself errs eight times (`tests/peers`).
#[test]
fn a_repetition_is_the_motion_as_it_goes_on() {
    for clearance in ["0.02 mm", "0.1 mm", "0.3 mm"] {
        for (tolerance, transient) in [(1e-6, 0), (1e-7, 0), (1e-7, 30), (1e-9, 10)] {
            let settings = settings(transient, tolerance);
            let (series, fewer) = repeated_and_gone_on(&machine(clearance), &settings);
            assert!(fewer, "{clearance} {tolerance}");
            let [repeated, gone_on] = series;
            let off = difference(&repeated, &gone_on);
            assert!(off < tolerance, "{clearance} {tolerance}: {off:e}");
            eprintln!("{clearance} {tolerance:e} {transient}: {off:.1e}");
        }
    }
}

/// Where contacts are met hard, the steps of one revolution are not those of the next, and its motion as it goes on differs by what
/// the integration errs. The repetition errs no more: twice as much would be two errors that add up.
#[test]
fn a_repetition_of_two_revolutions_errs_as_the_integration_does() {
    let machine = of_two_revolutions();
    let settings = |tolerance| settings(40, tolerance);
    let (series, fewer) = repeated_and_gone_on(&machine, &settings(1e-7));
    assert!(fewer);
    let ([_, exact], _) = repeated_and_gone_on(&machine, &settings(1e-11));
    let [repeated, gone_on] = series.map(|record| difference(&record, &exact));
    assert!(repeated < 2.0 * gone_on, "{repeated:e} {gone_on:e}");
    eprintln!("two revolutions: {repeated:.1e} for {gone_on:.1e}");
}

/// The frame follows the machine and settles later: what is left of its free vibration is added to the repetition. A frame whose
/// springs harden the least bit has no such free vibration and is integrated throughout.
#[test]
fn a_frame_swings_on_where_the_machine_repeats_itself() {
    let Resolved {
        mut machine,
        sensors,
        ..
    } = machine("0.2 mm");
    for carries in [false, true] {
        for transient in [0, 6] {
            machine.frame.as_mut().unwrap().carries = carries;
            let mut hardening = machine.clone();
            hardening.frame.as_mut().unwrap().hardening = 1e-200;
            let settings = Settings {
                revolutions: 10,
                ..settings(transient, 1e-9)
            };
            let [swung, integrated] = [&machine, &hardening]
                .map(|machine| simulate(machine, &sensors, &settings, false).unwrap());
            let [fewer, all] = [&swung, &integrated].map(|record| record.work.accepted);
            assert!(4 * fewer < 3 * all, "{fewer} of {all}");
            for (i, sensor) in sensors.iter().enumerate() {
                let name = sensor.measured.column(&[]);
                // Where it begins anew, a rounding makes a turn.
                if name == "crank_angle_rad" {
                    continue;
                }
                let off = difference(&swung.series[i], &integrated.series[i]);
                assert!(off < settings.tolerance, "{name}: {off:e}");
                eprintln!("{name} {carries} {transient}: {off:.1e}, {fewer} of {all} steps");
            }
        }
    }
}

/// Over the period that is repeated the works are integrals of powers, and balance the energy as works that are integrated along do.
#[test]
fn the_energy_of_a_repeated_period_balances() {
    for clearance in ["0.02 mm", "0.1 mm", "0.3 mm"] {
        let machine = machine(clearance);
        for tolerance in [1e-6, 1e-7, 1e-9] {
            let settings = settings(10, tolerance);
            let asked = Asked::from_rest(&machine.machine, &machine.sensors, &settings);
            for record in simulate_together(&[asked, asked], |_, record| record) {
                let missing = record.unwrap().energy_residual.unwrap();
                assert!(
                    missing.abs() < tolerance,
                    "{clearance} {tolerance}: {missing:e}"
                );
                eprintln!("{clearance} {tolerance:e}: {missing:.1e}");
            }
        }
    }
}

/// Twenty recorded revolutions.
fn settings(transient: u32, tolerance: f64) -> Settings {
    Settings {
        transient: Transient::Revolutions(transient),
        revolutions: 20,
        tolerance,
        ..Settings::default()
    }
}

/// The crosshead's acceleration as recorded, and of the motion as it goes on, by the same filter: the same samples of both; and
/// whether the record takes fewer steps.
fn repeated_and_gone_on(machine: &Resolved, settings: &Settings) -> ([Vec<f64>; 2], bool) {
    let column = "crosshead_acceleration_m_s2";
    let mut sensors = machine.sensors.iter();
    let sensor = sensors.find(|s| s.measured.column(&[]) == column).unwrap();
    let sensors = std::slice::from_ref(sensor);
    let traced = simulate(&machine.machine, sensors, settings, true).unwrap();
    let record = simulate(&machine.machine, sensors, settings, false).unwrap();
    assert_eq!(record.series, traced.series);
    let trace = traced.trace.unwrap();
    let decimator = Decimator::new(trace.stride).unwrap();
    let first = decimator.half_length().div_ceil(trace.stride);
    let gone_on = decimator.apply(&trace.throws[0].acceleration);
    let repeated = record.series[0][first..first + gone_on.len()].to_vec();
    (
        [repeated, gone_on],
        record.work.accepted < traced.work.accepted,
    )
}

/// RMS of the difference from a record, over its RMS.
fn difference(of: &[f64], from: &[f64]) -> f64 {
    let square = |values: &mut dyn Iterator<Item = f64>| values.map(|x| x * x).sum::<f64>();
    let off = square(&mut of.iter().zip(from).map(|(a, b)| a - b));
    (off / square(&mut from.iter().copied())).sqrt()
}
