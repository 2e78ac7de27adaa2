//! The shipped machine file, and what survives being written and read again.

use input::machine_file::{MachineFile, read};
use input::{paths, yaml};
use mechanism::Direction;
use mechanism::drive::Drive;
use mechanism::joints::contact::ContactLaw;
use mechanism::joints::friction::FrictionLaw;
use mechanism::joints::guide::Guide;
use mechanism::joints::revolute::{JointModel, Revolute};
use serde_json::{Value, json};
use simulate::sensor::{Axis, ChamberEnd, Measured, NoiseLevel};
use std::path::PathBuf;

fn shipped() -> MachineFile {
    let path =
        PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../data/machines/single-stage.yaml");
    read(&path).unwrap()
}

/// The shipped machine with some values changed.
fn changed(changes: &[(&str, &str)]) -> MachineFile {
    let mut tree = shipped().to_tree().clone();
    for (path, value) in changes {
        paths::set(&mut tree, path, json!(value)).unwrap();
    }
    MachineFile::from_tree(&tree).unwrap()
}

#[test]
fn single_stage_has_the_numbers_of_model_md_section_5() {
    let resolved = shipped().resolve().unwrap();
    let machine = &resolved.machine;
    assert_eq!(resolved.speed, 500.0 * std::f64::consts::PI / 30.0);
    let Drive::Given(given) = &machine.drive else {
        panic!()
    };
    assert_eq!(given.speed, resolved.speed);
    assert_eq!([machine.gravity_x, machine.gravity_y], [0.0, -9.81]);
    assert_eq!(machine.main, Revolute::Ideal);
    assert!(machine.effects.is_empty());
    let [throw] = &machine.throws[..] else {
        panic!()
    };
    assert_eq!(
        (throw.name.as_str(), throw.direction),
        ("", Direction::Forward)
    );
    assert_eq!([throw.crank_radius, throw.pin_angle], [0.120, 0.0]);
    let rod = &throw.rod;
    assert_eq!(
        [rod.length, rod.mass, rod.centre_of_mass, rod.inertia],
        [0.6, 12.0, 0.22, 0.6]
    );
    assert_eq!(throw.crosshead.mass, 18.0);
    let gas = &throw.cylinder;
    assert_eq!(
        [gas.piston_radius, gas.head_clearance, gas.exponent],
        [0.05, 0.024, 1.4]
    );
    assert_eq!(
        [gas.suction, gas.discharge, gas.back],
        [0.105e6, 0.393e6, 0.0]
    );
    assert_eq!(gas.crank_end, None);
    assert_eq!(throw.big_end, Revolute::Ideal);
    assert_eq!(throw.small_end, Revolute::Ideal);
    assert_eq!(throw.guide, Guide::Ideal);
}

#[test]
fn a_clearance_alone_makes_a_joint_clear_with_the_numbers_of_section_5() {
    let resolved = changed(&[
        ("joints.big_end.clearance", "0.1 mm"),
        ("joints.small_end.clearance", "0.3 mm"),
    ]);
    let machine = resolved.resolve().unwrap().machine;
    for (joint, radius, stiffness, clearance) in [
        (&machine.throws[0].big_end, 0.050, 2.4e10, 1e-4),
        (&machine.throws[0].small_end, 0.035, 2.0e10, 3e-4),
    ] {
        let clear = joint.clear().unwrap();
        assert_eq!([clear.clearance, clear.journal_radius], [clearance, radius]);
        assert_eq!(clear.model, JointModel::ThreeMode);
        let ContactLaw::Impact(law) = &clear.contact else {
            panic!()
        };
        assert_eq!(
            [law.stiffness, law.exponent, law.damping, law.depth],
            [stiffness, 1.5, 2e4, 1e-5]
        );
        let FrictionLaw::Coulomb(law) = &clear.friction else {
            panic!()
        };
        assert_eq!([law.coefficient, law.slip_speed], [0.05, 0.01]);
    }
}

#[test]
fn every_joint_of_the_shipped_machine_can_be_made_clear() {
    for joint in ["main", "big_end", "small_end", "guide"] {
        let file = changed(&[(&format!("joints.{joint}.clearance"), "0.2 mm")]);
        let machine = file.resolve().unwrap().machine;
        let throw = &machine.throws[0];
        let clear = match joint {
            "main" => machine.main.clear().map(|c| c.clearance),
            "big_end" => throw.big_end.clear().map(|c| c.clearance),
            "small_end" => throw.small_end.clear().map(|c| c.clearance),
            _ => throw.guide.clear().map(|c| c.clearance),
        };
        assert_eq!(clear, Some(2e-4), "{joint}");
    }
}

#[test]
fn sensors_and_frame_are_as_written() {
    let resolved = shipped().resolve().unwrap();
    let measured: Vec<Measured> = resolved.sensors.iter().map(|s| s.measured).collect();
    assert_eq!(
        measured,
        [
            Measured::CrossheadAcceleration { throw: 0 },
            Measured::CylinderPressure {
                throw: 0,
                end: ChamberEnd::Head
            },
            Measured::CrankAngle,
            Measured::FrameAcceleration { axis: Axis::X },
        ]
    );
    let [acceleration, pressure, angle, _] = &resolved.sensors[..] else {
        panic!()
    };
    assert_eq!(
        acceleration.chain.range,
        Some(simulate::Range::Fixed(2000.0))
    );
    let noise = acceleration.chain.noise.unwrap();
    assert_eq!(
        (noise.level, noise.pink_share),
        (NoiseLevel::OfSignal(0.01), 0.3)
    );
    assert_eq!(
        pressure.chain.noise.unwrap().level,
        NoiseLevel::Absolute(1000.0)
    );
    assert_eq!(
        (angle.chain.bits, angle.chain.range),
        (
            Some(16),
            Some(simulate::Range::Fixed(std::f64::consts::TAU))
        )
    );
    let frame = resolved.machine.frame.unwrap();
    let natural = (frame.stiffness_x / frame.mass).sqrt();
    assert!((natural / (std::f64::consts::TAU * 45.0) - 1.0).abs() < 1e-12);
    assert!((frame.damping_x / (2.0 * frame.mass * natural) - 0.05).abs() < 1e-12);
}

#[test]
fn a_file_written_back_is_the_same_machine() {
    let file = changed(&[
        ("joints.big_end.clearance", "0.1 mm"),
        ("speed", "51.3 rad/s"),
    ]);
    let text = file.to_yaml().unwrap();
    let again = MachineFile::from_yaml(&text, "again.yaml").unwrap();
    assert_eq!(again.to_tree(), file.to_tree());
    assert_eq!(again.resolve().unwrap(), file.resolve().unwrap());
}

#[test]
fn stiffness_follows_from_materials() {
    // MODEL.md section 5 gives 2.40e10 "by Eq. (5) with these radii, rounded"; section 8 says the
    // conformal form is about 30 times stiffer.
    let stiffness = |from: &str| {
        let mut tree = shipped().to_tree().clone();
        let source =
            json!({"from": from, "youngs_modulus": ["207 GPa", "207 GPa"], "poisson_ratio": 0.3});
        paths::set(&mut tree, "joints.big_end.contact.stiffness", source).unwrap();
        paths::set(&mut tree, "joints.big_end.clearance", json!("0.1 mm")).unwrap();
        let machine = MachineFile::from_tree(&tree)
            .unwrap()
            .resolve()
            .unwrap()
            .machine;
        machine.throws[0]
            .big_end
            .clear()
            .unwrap()
            .contact
            .spring()
            .0
    };
    assert!((stiffness("eq5") / 2.40e10 - 1.0).abs() < 5e-3);
    let ratio = stiffness("conformal") / stiffness("eq5");
    assert!((ratio - 1001f64.sqrt()).abs() < 0.1, "{ratio}");
}

#[test]
fn laws_have_their_own_keys_and_a_default() {
    let with = |section: &str, law: Value| {
        let mut tree = shipped().to_tree().clone();
        paths::set(&mut tree, &format!("joints.big_end.{section}"), law).unwrap();
        paths::set(&mut tree, "joints.big_end.clearance", json!("0.1 mm")).unwrap();
        let machine = MachineFile::from_tree(&tree)
            .unwrap()
            .resolve()
            .unwrap()
            .machine;
        machine.throws[0].big_end.clear().unwrap().clone()
    };
    let k = "24 GN/m^1.5";
    let impact = with(
        "contact",
        json!({"stiffness": k, "damping": "2e4 N s/m", "depth": "10 um"}),
    );
    assert!(matches!(impact.contact, ContactLaw::Impact(_)));
    let hertz = with("contact", json!({"law": "hertz", "stiffness": k}));
    assert!(matches!(hertz.contact, ContactLaw::Hertz(_)));
    let linear = json!({"law": "kelvin_voigt", "stiffness": "2e8 N/m", "damping": "1e3 N s/m"});
    assert!(matches!(
        with("contact", linear).contact,
        ContactLaw::KelvinVoigt(_)
    ));
    for law in ["hunt_crossley", "lankarani_nikravesh", "flores"] {
        let clear = with(
            "contact",
            json!({"law": law, "stiffness": k, "restitution": 0.9}),
        );
        let (ContactLaw::HuntCrossley(r)
        | ContactLaw::LankaraniNikravesh(r)
        | ContactLaw::Flores(r)) = clear.contact
        else {
            panic!("{law}")
        };
        assert_eq!(
            [r.stiffness, r.exponent, r.restitution, r.slowest_approach],
            [2.4e10, 1.5, 0.9, 1e-3]
        );
    }
    assert_eq!(
        with("friction", json!({"law": "none"})).friction,
        FrictionLaw::none()
    );
    let adams = json!({"law": "adams", "static_coefficient": 0.2, "dynamic_coefficient": 0.1,
        "stiction_speed": "1 mm/s", "transition_speed": "10 mm/s"});
    assert!(matches!(
        with("friction", adams).friction,
        FrictionLaw::Adams(_)
    ));
    let ambrosio =
        json!({"law": "ambrosio", "coefficient": 0.1, "slow": "1 mm/s", "fast": "10 mm/s"});
    assert!(matches!(
        with("friction", ambrosio).friction,
        FrictionLaw::Ambrosio(_)
    ));
}

/// The two-stage machine of MODEL.md section 7, as far as throws differ.
const TWO_STAGE: &str = "
name: two-stage
speed: 496 rpm
crank:
  radius: 120 mm
  drive: {free: {inertia: 600 kg m^2, mean_torque: 6665 N m, slope: 2.3e4 N m s}}
rod: {length: 600 mm, centre_of_mass: 210 mm, mass: 110 kg, inertia: 4.6 kg m²}
cylinder: {exponent: 1.4, back: 1 bar, crank_end: {rod_radius: 40 mm}}
joints:
  big_end:
    clearance: 0.1 mm
    journal_radius: 110 mm
    contact: {stiffness: 400 GN/m^1.5, damping: 2e5 N·s/m, depth: 10 um}
    friction: {coefficient: 0.05, slip_speed: 0.01 m/s}
throws:
  - name: throw1
    crosshead: {mass: 260 kg}
    cylinder: {piston_radius: 345 mm, suction: 1 bar, discharge: 2.8 bar, head_clearance: 28 mm, crank_end: {clearance: 30 mm}}
  - name: throw2
    direction: opposed
    crank_pin_angle: 180 deg
    crosshead: {mass: 240 kg}
    cylinder: {piston_radius: 185 mm, suction: 2.7 bar, discharge: 13 bar, head_clearance: 30 mm, crank_end: {clearance: 32 mm}}
    joints:
      big_end: {clearance: 0.2 mm, contact: {law: hertz, stiffness: 300 GN/m^1.5}}
sensors:
  - {measure: cylinder_pressure, throw: throw2, end: crank}
effects:
  - valve_loss: {suction: 0.18, discharge: 0.15}
";

#[test]
fn throws_share_what_stands_at_the_top_key_by_key() {
    let resolved = MachineFile::from_yaml(TWO_STAGE, "two.yaml")
        .unwrap()
        .resolve()
        .unwrap();
    let [one, two] = &resolved.machine.throws[..] else {
        panic!()
    };
    assert_eq!(one.rod, two.rod);
    assert_eq!(
        (one.direction, two.direction),
        (Direction::Forward, Direction::Opposed)
    );
    assert_eq!([one.pin_angle, two.pin_angle], [0.0, std::f64::consts::PI]);
    let ends = [one, two].map(|t| t.cylinder.crank_end.clone().unwrap());
    assert_eq!(ends.each_ref().map(|e| e.clearance), [0.030, 0.032]);
    assert_eq!(ends.map(|e| e.rod_radius), [0.04, 0.04]);
    let joints = [one, two].map(|t| t.big_end.clear().unwrap());
    assert_eq!(joints.map(|j| j.clearance), [1e-4, 2e-4]);
    assert_eq!(joints.map(|j| j.journal_radius), [0.11, 0.11]);
    assert!(matches!(joints[0].contact, ContactLaw::Impact(_)));
    // Another law does not take over the damping that the shared one has.
    assert!(matches!(joints[1].contact, ContactLaw::Hertz(_)));
    assert_eq!(resolved.machine.crankshaft.inertia, 600.0);
    let Drive::Free(motor) = &resolved.machine.drive else {
        panic!()
    };
    assert_eq!([motor.mean_torque, motor.slope], [6665.0, 2.3e4]);
    let measured = resolved.sensors[0].measured;
    assert_eq!(
        measured,
        Measured::CylinderPressure {
            throw: 1,
            end: ChamberEnd::Crank
        }
    );
}

#[test]
fn paths_reach_throws_effects_and_sensors_by_name_or_index() {
    let mut tree = MachineFile::from_yaml(TWO_STAGE, "two.yaml")
        .unwrap()
        .to_tree()
        .clone();
    let mut set = |path: &str, value: Value| paths::set(&mut tree, path, value).unwrap();
    // throw1 shares its joints; the path gives it a clearance of its own, and only that.
    set("throws.throw1.joints.big_end.clearance", json!("0.05 mm"));
    set("throws.1.crosshead.mass", json!("250 kg"));
    set("effects.valve_loss.discharge", json!(0.3));
    set("effects.0.valve_loss.suction", json!(0.2));
    set("sensors.cylinder_pressure.noise.rms", json!("2 %"));
    set("gravity.direction", json!("180 deg"));
    let text = paths::get(&tree, "throws.throw2.rod.mass").unwrap();
    assert_eq!(text, Some(&json!("110 kg")));
    assert_eq!(paths::get(&tree, "frame.mass").unwrap(), None);
    let resolved = MachineFile::from_tree(&tree).unwrap().resolve().unwrap();
    let [one, two] = &resolved.machine.throws[..] else {
        panic!()
    };
    assert_eq!(one.big_end.clear().unwrap().clearance, 5e-5);
    assert_eq!(one.big_end.clear().unwrap().journal_radius, 0.11);
    assert_eq!(two.big_end.clear().unwrap().clearance, 2e-4);
    assert_eq!(two.crosshead.mass, 250.0);
    let mechanism::effects::Law::ValveLoss(loss) = &resolved.machine.effects[0].law else {
        panic!()
    };
    assert_eq!([loss.suction, loss.discharge], [0.2, 0.3]);
    assert_eq!(
        resolved.sensors[0].chain.noise.unwrap().level,
        NoiseLevel::OfSignal(0.02)
    );
    assert_eq!(
        [resolved.machine.gravity_x, resolved.machine.gravity_y],
        [-9.81, 0.0]
    );
}

#[test]
fn a_tree_written_as_yaml_reads_back() {
    let tree = json!({"a": ["0 mm", "5 %", "-90 deg", "1e3", "yes", "null", "", " x", "a: b", "# c", "²"],
        "b": {"c": 1e-300, "d": -7, "e": true, "f": null, "g": [], "h": {}}});
    let text = yaml::to_string(&tree).unwrap();
    assert_eq!(yaml::Document::parse(&text, "t.yaml").unwrap().tree, tree);
}

#[test]
fn values_are_replaced_by_their_paths() {
    let values = [
        ("joints.big_end.clearance", json!("0.2 mm")),
        ("speed", json!("600 rpm")),
    ];
    let changed = shipped().with_values(values).unwrap();
    let set = |path| paths::get(changed.to_tree(), path).unwrap().cloned();
    assert_eq!(set("joints.big_end.clearance"), Some(json!("0.2 mm")));
    let speed = changed.resolve().unwrap().speed;
    assert_eq!(speed, 600.0 * std::f64::consts::PI / 30.0);
    let wrong = |path, value| {
        let changed = shipped().with_values([(path, json!(value))]);
        changed.unwrap_err().to_string()
    };
    let message = wrong("joints.bigend.clearance", "0.2 mm");
    assert!(message.contains("did you mean 'big_end'?"), "{message}");
    let message = wrong("speed", "600 mm");
    assert!(
        message.starts_with("speed: found '600 mm' (a length), expected"),
        "{message}"
    );
}

#[test]
fn sensors_are_chosen_by_their_channels() {
    let channels = ["crank_angle_rad", "crosshead_acceleration_m_s2"].map(str::to_owned);
    let chosen = shipped().with_channels(&channels).unwrap();
    let sensors = chosen.resolve().unwrap().sensors;
    let measured: Vec<String> = sensors.iter().map(|s| s.measured.column(&[""])).collect();
    // In the order of the file.
    assert_eq!(measured, ["crosshead_acceleration_m_s2", "crank_angle_rad"]);
    let all = shipped().resolve().unwrap().sensors;
    let same = all.iter().find(|s| s.measured == sensors[0].measured);
    assert_eq!(same, Some(&sensors[0]));
    let unknown = ["crosshead_accelaration_m_s2".to_owned()];
    let message = shipped().with_channels(&unknown).unwrap_err().to_string();
    assert!(
        message.contains("did you mean 'crosshead_acceleration_m_s2'?"),
        "{message}"
    );
}
