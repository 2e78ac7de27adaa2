//! The shipped two-stage machine is the one that the reference trajectories belong to.

use input::machine_file::read;
use mechanism::drive::Drive;
use mechanism::joints::contact::ContactLaw;
use mechanism::joints::friction::FrictionLaw;
use mechanism::joints::revolute::{JointModel, Revolute};
use mechanism::{Direction, Machine, Throw};
use serde_json::Value;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::path::PathBuf;

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn machine() -> Machine {
    let file = read(&root().join("data/machines/two-stage.yaml")).unwrap();
    file.resolve().unwrap().machine
}

/// The parameters of a throw by the names of reference.json.
fn parameters(throw: &Throw, gravity: f64) -> BTreeMap<String, f64> {
    let (rod, gas) = (&throw.rod, &throw.cylinder);
    let end = gas.crank_end.as_ref().unwrap();
    let area = |radius: f64| PI * radius * radius;
    let sigma = match throw.direction {
        Direction::Forward => 1.0,
        Direction::Opposed => -1.0,
    };
    let mut all: BTreeMap<String, f64> = [
        ("R", throw.crank_radius),
        ("L", rod.length),
        ("a", rod.centre_of_mass),
        ("mr", rod.mass),
        ("Ir", rod.inertia),
        ("ms", throw.crosshead.mass),
        ("S0", gas.head_clearance),
        ("m", gas.exponent),
        ("ps", gas.suction),
        ("pd", gas.discharge),
        ("pb", gas.back),
        ("Ap", area(gas.piston_radius)),
        ("da", 1.0),
        ("S0c", end.clearance),
        ("Arod", area(end.rod_radius)),
        ("psi", throw.pin_angle),
        ("sigma", sigma),
        ("g", gravity),
        ("bigclear", 1.0),
        ("smallclear", 1.0),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .into();
    for (joint, end) in [(&throw.big_end, "B"), (&throw.small_end, "S")] {
        let Revolute::Clear(clear) = joint else {
            panic!("an ideal joint")
        };
        assert_eq!(clear.model, JointModel::ThreeMode);
        let (ContactLaw::Impact(contact), FrictionLaw::Coulomb(friction)) =
            (&clear.contact, &clear.friction)
        else {
            panic!("another law")
        };
        let values = [
            ("c", clear.clearance),
            ("Rj", clear.journal_radius),
            ("K", contact.stiffness),
            ("n", contact.exponent),
            ("dmax", contact.depth),
            ("Cmax", contact.damping),
            ("cf", friction.coefficient),
            ("vs", friction.slip_speed),
        ];
        all.extend(values.map(|(name, value)| (format!("{name}{end}"), value)));
    }
    all
}

fn close(ours: f64, reference: f64) -> bool {
    (ours - reference).abs() <= 1e-13 * reference.abs()
}

#[test]
fn two_stage_has_the_parameters_of_the_reference() {
    let path = root().join("data/reference/trajectories/reference.json");
    let reference: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let reference = &reference["two_stage_free"]["parameters"];
    let machine = machine();
    assert_eq!(machine.main, Revolute::Ideal);
    assert!(machine.effects.is_empty());
    assert_eq!(machine.gravity_x, 0.0);

    let throws = reference["throws"].as_array().unwrap();
    assert_eq!(machine.throws.len(), throws.len());
    for (throw, expected) in machine.throws.iter().zip(throws) {
        assert!(throw.guide.clear().is_none());
        let ours = parameters(throw, -machine.gravity_y);
        let expected = expected.as_object().unwrap();
        assert_eq!(ours.len(), expected.len());
        for (name, value) in expected {
            let (ours, value) = (ours[name], value.as_f64().unwrap());
            assert!(close(ours, value), "{} {name}: {ours} {value}", throw.name);
        }
    }

    let Drive::Free(motor) = &machine.drive else {
        panic!("a given speed")
    };
    for (name, ours) in [
        ("J", machine.crankshaft.inertia),
        ("T0", motor.mean_torque),
        ("kT", motor.slope),
        ("omega_ref", motor.reference_speed),
    ] {
        let value = reference["drive"][name].as_f64().unwrap();
        assert!(close(ours, value), "{name}: {ours} {value}");
    }
}
