//! What sensors see between the evaluations of a step, and of a motion that repeats itself, against the motion evaluated at
//! every instant.

use input::{MachineFile, Resolved};
use signal::decimate::Decimator;
use simulate::{Settings, Transient, simulate};
use std::path::Path;

/// The shipped machine with both joints this clear.
fn machine(clearance: &str) -> Resolved {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/machines");
    let file = input::machine_file::read(&folder.join("single-stage.yaml")).unwrap();
    let mut tree = file.to_tree().clone();
    for joint in ["big_end", "small_end"] {
        let path = format!("joints.{joint}.clearance");
        input::paths::set(&mut tree, &path, clearance.into()).unwrap();
    }
    MachineFile::from_tree(&tree).unwrap().resolve().unwrap()
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
        let Resolved {
            machine, sensors, ..
        } = machine(clearance);
        let sensor = |column: &str| sensors.iter().find(|s| s.measured.column(&[]) == column);
        let sensor = sensor("crosshead_acceleration_m_s2").unwrap().clone();
        for (tolerance, transient) in [(1e-6, 0), (1e-7, 0), (1e-7, 30), (1e-9, 10)] {
            let settings = Settings {
                transient: Transient::Revolutions(transient),
                revolutions: 20,
                tolerance,
                ..Settings::default()
            };
            let sensors = std::slice::from_ref(&sensor);
            let traced = simulate(&machine, sensors, &settings, true).unwrap();
            let record = simulate(&machine, sensors, &settings, false).unwrap();
            assert_eq!(record.series, traced.series);
            let [steps, all] = [&record, &traced].map(|r| r.work.accepted);
            assert!(steps < all, "{clearance} {tolerance}: {steps} of {all}");

            let trace = traced.trace.unwrap();
            let decimator = Decimator::new(trace.stride).unwrap();
            let first = decimator.half_length().div_ceil(trace.stride);
            let recorded = &record.series[0][first..];
            let filtered = decimator.apply(&trace.throws[0].acceleration);
            let square = |of: &mut dyn Iterator<Item = f64>| of.map(|x| x * x).sum::<f64>();
            let off = square(&mut filtered.iter().zip(recorded).map(|(a, b)| a - b));
            let off = (off / square(&mut filtered.iter().copied())).sqrt();
            assert!(off < tolerance, "{clearance} {tolerance}: {off:e}");
            eprintln!("{clearance} {tolerance:e} {transient}: {off:.1e}, {steps} of {all} steps");
        }
    }
}
