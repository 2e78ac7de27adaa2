//! Runs that are no record of the machine that was asked for: each fails with its reason, alone and in lanes.

use input::{MachineFile, Resolved};
use simulate::{Asked, Error, Record, Settings, Transient, simulate, simulate_together};

/// A shipped machine with these values changed.
fn machine(name: &str, changes: &[(&str, &str)]) -> Resolved {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/machines");
    let path = std::path::Path::new(folder).join(name);
    let file = input::machine_file::read(&path).unwrap();
    let mut tree = file.to_tree().clone();
    for (path, value) in changes {
        input::paths::set(&mut tree, path, (*value).into()).unwrap();
    }
    MachineFile::from_tree(&tree).unwrap().resolve().unwrap()
}

/// The single-stage machine on a free crank.
fn free(torque: &str, slope: &str, inertia: &str) -> Resolved {
    let mut machine = machine(
        "single-stage.yaml",
        &[("joints.big_end.clearance", "0.1 mm")],
    );
    let number = |text: &str| text.parse::<f64>().unwrap();
    machine.machine.crankshaft.inertia = number(inertia);
    machine.machine.drive = mechanism::drive::Drive::Free(mechanism::drive::MotorLine {
        reference_speed: machine.speed,
        mean_torque: number(torque),
        slope: number(slope),
    });
    machine
}

fn settings() -> Settings {
    Settings {
        transient: Transient::Revolutions(2),
        revolutions: 3,
        tolerance: 1e-7,
        ..Settings::default()
    }
}

/// The same record by itself, with a trace, and beside two others in lanes: all must come to the same end.
fn run(machine: &Resolved, settings: &Settings) -> Result<Record, Error> {
    let of = |traced| simulate(&machine.machine, &machine.sensors, settings, traced);
    let (alone, traced) = (of(false), of(true));
    let asked = Asked::from_rest(&machine.machine, &machine.sensors, settings);
    let together = simulate_together(&[asked; 3], |_, record| record);
    for other in together.into_iter().chain([traced]) {
        match (&alone, other) {
            (Ok(a), Ok(b)) => assert_eq!(a.penetrations, b.penetrations),
            (a, b) => assert_eq!(
                a.as_ref().map_err(std::mem::discriminant).err(),
                b.as_ref().map_err(std::mem::discriminant).err(),
            ),
        }
    }
    alone
}

#[test]
fn a_crank_that_its_motor_cannot_turn_is_told_to_turn_back() {
    let long = Settings {
        transient: Transient::Revolutions(60),
        ..settings()
    };
    let error = run(&free("5", "1", "2"), &long).unwrap_err();
    // Swinging in its gas, it is met on its way back, or on its way forth and much too slow.
    let told = matches!(error, Error::TurnsBack { .. } | Error::OffSpeed { .. });
    assert!(told && error.to_string().contains("500 rpm"), "{error}");
}

#[test]
fn a_machine_at_another_speed_than_its_own_is_told() {
    // The motor gives twice what the load takes, on a flat line: the speed that it would need is far off.
    let error = run(&free("200", "5", "1"), &settings()).unwrap_err();
    assert!(matches!(error, Error::OffSpeed { .. }), "{error}");
    assert!(error.to_string().contains("off the 500 rpm"), "{error}");
}

#[test]
fn a_machine_near_its_speed_is_recorded_with_the_speed_that_it_has() {
    let record = run(&free("60", "40", "8"), &settings()).unwrap();
    let rpm = record.mean_speed * 30.0 / std::f64::consts::PI;
    assert!((490.0..510.0).contains(&rpm) && rpm != 500.0, "{rpm}");
    assert!(record.energy_residual.is_none());
}

/// A record never begins before its transient ends, however long a slow crank takes for that: its first
/// samples differ from one another.
#[test]
fn a_slow_crank_is_not_recorded_while_it_stands_still() {
    let long = Settings {
        transient: Transient::Revolutions(60),
        ..settings()
    };
    let machine = free("40", "12", "8");
    let record = run(&machine, &long).unwrap();
    for series in &record.series {
        assert!(series[..100].windows(2).any(|pair| pair[0] != pair[1]));
    }
}

#[test]
fn forces_lost_in_rounding_are_an_open_ledger() {
    let machine = machine(
        "single-stage.yaml",
        &[
            ("joints.big_end.clearance", "0.2 mm"),
            ("crosshead.mass", "1e30 kg"),
        ],
    );
    let settings = settings();
    let traced = simulate(&machine.machine, &machine.sensors, &settings, true);
    let asked = Asked::from_rest(&machine.machine, &machine.sensors, &settings);
    // In a dataset the works are kept along for one revolution, after the record.
    let together = simulate_together(&[asked, asked], |_, record| record);
    for record in together.into_iter().chain([traced]) {
        let error = record.unwrap_err();
        assert!(matches!(error, Error::EnergyMissing { .. }), "{error}");
    }
}

#[test]
fn a_record_that_is_kept_balances() {
    let machine = machine(
        "single-stage.yaml",
        &[("joints.big_end.clearance", "0.2 mm")],
    );
    let settings = settings();
    let asked = Asked::from_rest(&machine.machine, &machine.sensors, &settings);
    for record in simulate_together(&[asked, asked, asked], |_, record| record) {
        let missing = record.unwrap().energy_residual.unwrap();
        assert!(missing != 0.0 && missing.abs() < 1e-7, "{missing:e}");
    }
}

#[test]
fn what_is_rough_is_recorded_still() {
    let rough = Settings {
        tolerance: 1e-4,
        ..settings()
    };
    let light = [
        ("joints.big_end.clearance", "0.3 mm"),
        ("joints.small_end.clearance", "0.3 mm"),
        ("joints.big_end.contact.damping", "2e3 N s/m"),
        ("joints.small_end.contact.damping", "2e3 N s/m"),
    ];
    run(&machine("single-stage.yaml", &light), &rough).unwrap();
}

#[test]
fn a_joint_that_gives_by_more_than_its_clearance_is_told() {
    let load = [
        ("joints.big_end.clearance", "0.05 mm"),
        ("cylinder.piston_radius", "120 mm"),
        ("cylinder.discharge", "1 MPa"),
    ];
    let deep = run(&machine("single-stage.yaml", &load), &settings()).unwrap();
    let [joint] = &deep.penetrations[..] else {
        panic!("{:?}", deep.penetrations)
    };
    assert!(joint.is_too_deep(), "{joint}");
    let text = joint.to_string();
    for part in ["big_end", "clearance of 50.000 µm", "materials"] {
        assert!(text.contains(part), "{text}");
    }
    // As it is shipped, the machine's contact is soft (MODEL.md, section 8), but not as soft as that.
    let usual = [("joints.big_end.clearance", "0.1 mm")];
    let usual = run(&machine("single-stage.yaml", &usual), &settings()).unwrap();
    let [joint] = &usual.penetrations[..] else {
        panic!("{:?}", usual.penetrations)
    };
    assert!(
        (2e-5..1e-4).contains(&joint.deepest) && !joint.is_too_deep(),
        "{joint}"
    );
}

#[test]
fn a_rate_that_shows_no_revolution_or_fits_no_memory_is_refused() {
    let machine = machine("single-stage.yaml", &[]);
    for (rate, part) in [(8.0, "at least 20.8333 Hz"), (1e12, "at most")] {
        let settings = Settings {
            sample_rate: rate,
            ..settings()
        };
        let error = run(&machine, &settings).unwrap_err();
        assert!(matches!(error, Error::Settings(_)), "{error}");
        assert!(error.to_string().contains(part), "{error}");
    }
}
