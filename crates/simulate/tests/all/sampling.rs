//! What sensors see between the evaluations of a step, against the motion evaluated at every instant.

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
