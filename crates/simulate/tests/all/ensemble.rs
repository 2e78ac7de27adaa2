//! Records made side by side against the same ones made one by one.

use input::{MachineFile, Resolved};
use serde_json::Value;
use simulate::{
    Asked, Settings, Transient, WarmStart, sensitivities, settle, settled_together, simulate,
    simulate_together,
};
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

fn asked<'a>(machines: &'a [Resolved], settings: &'a [Settings]) -> Vec<Asked<'a>> {
    let of = |(resolved, settings): (&'a Resolved, &'a Settings)| {
        Asked::from_rest(&resolved.machine, &resolved.sensors, settings)
    };
    machines.iter().zip(settings).map(of).collect()
}

#[test]
fn a_record_has_the_same_bits_alone_and_in_any_lane() {
    let machines = machines();
    let settings: Vec<Settings> = (0..machines.len()).map(settings).collect();
    let asked = asked(&machines, &settings);
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
        .map(|settings| {
            let settings = if settings.tolerance < 1e-20 {
                &impossible
            } else {
                &usual
            };
            Asked::from_rest(&resolved.machine, &resolved.sensors, settings)
        })
        .collect();
    let records = simulate_together(&asked, |_, record| record);
    assert!(records[1].is_err());
    let alone = simulate(&resolved.machine, &resolved.sensors, &usual, false).unwrap();
    for i in [0, 2] {
        assert_eq!(records[i].as_ref().unwrap().series, alone.series);
    }
}

/// Settings of a fit: of a motion that repeats itself one period is looked at.
fn of_a_fit(index: usize) -> Settings {
    Settings {
        transient: Transient::Settled {
            change: 1e-2,
            // The second is not given enough to settle.
            at_most: if index == 1 { 2 } else { 12 },
        },
        inner_rate: 0.0,
        ..settings(index)
    }
}

#[test]
fn a_settled_motion_has_the_same_bits_alone_and_in_any_lane_and_is_what_derivatives_are_of() {
    let machines = machines();
    let settings: Vec<Settings> = (0..machines.len()).map(of_a_fit).collect();
    let asked = asked(&machines, &settings);
    let together = settled_together(&asked);
    assert_eq!(together.len(), asked.len());
    let mut settled = 0;
    for (i, (found, asked)) in together.into_iter().zip(&asked).enumerate() {
        let found = found.unwrap();
        let alone = settled_together(std::slice::from_ref(asked)).remove(0);
        assert_eq!(found, alone.unwrap(), "record {i}");
        let with_derivatives = sensitivities(asked, &[]).unwrap();
        assert_eq!(found.settled, with_derivatives.settled, "record {i}");
        settled += usize::from(found.settled);
        for (found, expected) in found.series.iter().zip(&with_derivatives.series) {
            assert_eq!(found.len(), expected.len());
            // Of one that has not settled they part, as from any other start.
            let within = if with_derivatives.settled { 1e-2 } else { 2.0 };
            let apart = apart(found, expected);
            assert!(apart <= within, "record {i}: {apart}");
        }
    }
    assert!((10..asked.len()).contains(&settled), "{settled}");
}

/// The greatest difference of two series over the greatest value.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    let largest = b.iter().fold(0.0_f64, |l, x| l.max(x.abs()));
    let pairs = a.iter().zip(b);
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest
}

#[test]
fn a_machine_that_goes_on_from_its_settled_motion_has_it_again_in_fewer_steps() {
    let machines = machines();
    let settings: Vec<Settings> = (0..machines.len()).map(of_a_fit).collect();
    let from_rest = asked(&machines, &settings);
    let starts = from_rest.iter().map(settle);
    let starts: Vec<Option<WarmStart>> = starts.collect::<Result<_, _>>().unwrap();
    let pairs = from_rest.iter().zip(&starts);
    let warm = pairs.map(|(asked, start)| Asked {
        warm_start: start.as_ref(),
        ..*asked
    });
    let warm: Vec<Asked> = warm.collect();
    let [before, after] = [&from_rest, &warm].map(|all| settled_together(all));
    let mut settled = 0;
    for (i, (before, after)) in before.into_iter().zip(after).enumerate() {
        let (before, after) = (before.unwrap(), after.unwrap());
        let alone = settled_together(&warm[i..=i]).remove(0).unwrap();
        assert_eq!(after, alone, "record {i}");
        assert_eq!(starts[i].is_some(), before.settled, "record {i}");
        if !before.settled {
            assert_eq!(before, after, "record {i}");
            continue;
        }
        settled += 1;
        assert!(after.settled && after.steps < before.steps, "record {i}");
        let with_derivatives = sensitivities(&warm[i], &[]).unwrap();
        let channels = after.series.iter().zip(&before.series);
        for ((after, before), other) in channels.zip(&with_derivatives.series) {
            // A crank that is free settles slowly.
            let within = if i < 11 { 1e-3 } else { 3e-2 };
            let [from_rest, of_derivatives] = [before, other].map(|x| apart(after, x));
            assert!(
                from_rest < within && of_derivatives < 1e-5,
                "record {i}: {from_rest} {of_derivatives}"
            );
        }
    }
    assert!(settled >= 10, "{settled}");
}

#[test]
fn a_machine_of_another_build_begins_at_rest() {
    let clear = |clearance| {
        machine(
            "single-stage.yaml",
            &[("joints.big_end.clearance", clearance)],
        )
    };
    let machines = [
        clear("0.1 mm"),
        clear("0.1001 mm"),
        machine("two-stage.yaml", &[]),
    ];
    let settings = [0, 0, 0].map(of_a_fit);
    let from_rest = asked(&machines, &settings);
    let start = settle(&from_rest[0]).unwrap();
    assert!(start.is_some());
    let found = |asked: &Asked| {
        let all = [None, start.as_ref()].map(|warm_start| Asked {
            warm_start,
            ..*asked
        });
        settled_together(&all).into_iter().map(Result::unwrap)
    };
    let alike: Vec<_> = found(&from_rest[1]).collect();
    assert!(alike[1].settled && alike[1].steps < alike[0].steps);
    let other: Vec<_> = found(&from_rest[2]).collect();
    assert_eq!(other[0], other[1]);
}
