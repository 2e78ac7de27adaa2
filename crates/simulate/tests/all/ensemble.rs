//! Records made side by side against the same ones made one by one.

use input::{MachineFile, Resolved};
use serde_json::Value;
use simulate::{Asked, Settings, Transient, simulate, simulate_together};
use std::path::Path;

fn machine(file: &str, changes: &[(&str, &str)]) -> Resolved {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/machines");
    let file = input::machine_file::read(&folder.join(file)).unwrap();
    let mut tree: Value = file.to_tree().clone();
    for (path, value) in changes {
        input::paths::set(&mut tree, path, (*value).into()).unwrap();
    }
    MachineFile::from_tree(&tree).unwrap().resolve().unwrap()
}

/// Machines of several builds and speeds: more of them than lanes, so that lanes change hands, and with
/// rattling ones among them.
fn machines() -> Vec<Resolved> {
    let clearances = [
        "0.02 mm", "0.3 mm", "0.1 mm", "0.5 mm", "0.05 mm", "0.2 mm", "0.15 mm", "0.4 mm",
        "0.25 mm", "0.03 mm", "0.35 mm",
    ];
    let mut machines = Vec::new();
    for (i, clearance) in clearances.into_iter().enumerate() {
        let speed = format!("{} rpm", 400 + 37 * i);
        let mut changes = vec![
            ("joints.small_end.clearance", clearance),
            ("speed", speed.as_str()),
        ];
        if i % 3 > 0 {
            changes.push(("joints.big_end.clearance", "0.12 mm"));
        }
        if i % 4 == 0 {
            changes.push(("joints.small_end.contact.damping", "3 kN s/m"));
        }
        machines.push(machine("single-stage.yaml", &changes));
    }
    machines.push(machine("two-stage.yaml", &[]));
    machines.push(machine(
        "two-stage.yaml",
        &[("throws.throw1.joints.big_end.clearance", "0.2 mm")],
    ));
    machines
}

fn settings(index: usize) -> Settings {
    let transients = [
        Transient::Revolutions(2),
        Transient::Settled {
            change: 1e-3,
            at_most: 4,
        },
    ];
    Settings {
        transient: transients[index % 2],
        revolutions: 1 + index as u32 % 2,
        tolerance: [1e-6, 1e-8][index / 2 % 2],
        ..Settings::default()
    }
}

#[test]
fn a_record_has_the_same_bits_alone_and_in_any_lane() {
    let machines = machines();
    let settings: Vec<Settings> = (0..machines.len()).map(settings).collect();
    let asked: Vec<Asked> = machines
        .iter()
        .zip(&settings)
        .map(|(resolved, settings)| Asked {
            machine: &resolved.machine,
            sensors: &resolved.sensors,
            settings,
        })
        .collect();
    let alone: Vec<_> = asked
        .iter()
        .map(|asked| simulate(asked.machine, asked.sensors, asked.settings, false).unwrap())
        .collect();
    let records = simulate_together(&asked, |_, record| record);
    assert_eq!(records.len(), alone.len());
    for (i, (record, alone)) in records.into_iter().zip(&alone).enumerate() {
        let record = record.unwrap();
        assert_eq!(record.series, alone.series, "record {i}");
        assert_eq!(record.work, alone.work, "record {i}");
        assert_eq!(record.transient, alone.transient, "record {i}");
        // The ledger of records made together is that of the revolution after them.
        assert!(
            record
                .energy_residual
                .is_some_and(|missing| missing.abs() < 1e-6)
        );
    }
}

#[test]
fn a_record_that_fails_does_not_touch_the_others() {
    let resolved = machine(
        "single-stage.yaml",
        &[("joints.small_end.clearance", "0.2 mm")],
    );
    let usual = settings(0);
    let impossible = Settings {
        tolerance: 1e-30,
        ..usual
    };
    let asked: Vec<Asked> = [usual, impossible, usual]
        .iter()
        .map(|settings| Asked {
            machine: &resolved.machine,
            sensors: &resolved.sensors,
            settings: if settings.tolerance < 1e-20 {
                &impossible
            } else {
                &usual
            },
        })
        .collect();
    let records = simulate_together(&asked, |_, record| record);
    assert!(records[1].is_err());
    let alone = simulate(&resolved.machine, &resolved.sensors, &usual, false).unwrap();
    for i in [0, 2] {
        assert_eq!(records[i].as_ref().unwrap().series, alone.series);
    }
}
