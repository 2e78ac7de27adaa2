//! The catalogue of effects, entry by entry.

use input::effects::{CATALOGUE, Entry, Kind, Proposal};
use input::machine_file::MachineFile;
use input::{Resolved, paths};
use mechanism::drive::Drive;
use mechanism::effects::{Joint, Law};
use mechanism::joints::guide::Guide;
use serde_json::{Value, json};
use std::f64::consts::TAU;

/// The shipped machine of one throw, with clearance at both ends.
fn tree() -> Value {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../data/machines/single-stage.yaml"
    );
    let file = input::machine_file::read(std::path::Path::new(path)).unwrap();
    let mut tree = file.to_tree().clone();
    for joint in ["big_end", "small_end"] {
        let path = format!("joints.{joint}.clearance");
        paths::set(&mut tree, &path, json!("0.2 mm")).unwrap();
    }
    tree
}

fn resolve(tree: &Value) -> Resolved {
    MachineFile::from_tree(tree).unwrap().resolve().unwrap()
}

/// The machine with the items of a list of effects.
fn with(items: Value) -> Value {
    let mut tree = tree();
    tree["effects"] = items;
    tree
}

fn message(items: Value) -> String {
    let file = MachineFile::from_tree(&with(items)).and_then(|file| file.resolve());
    file.unwrap_err().to_string()
}

/// A place for the entry: of every key that must be there, the last word.
fn place(entry: &Entry) -> Vec<(&'static str, &'static str)> {
    let required = entry.places.iter().filter(|choice| choice.required);
    required
        .map(|c| (c.key, *c.words.last().unwrap()))
        .collect()
}

fn start(entry: &Entry) -> Vec<f64> {
    entry.parameters.iter().map(|p| p.start).collect()
}

#[test]
fn the_catalogue_has_the_names_that_other_programs_use() {
    let names: Vec<&str> = CATALOGUE.iter().map(|entry| entry.name).collect();
    for name in [
        "valve_loss",
        "ring_leakage",
        "valve_leakage",
        "heat_transfer",
        "gas_pulsation",
        "valve_flutter",
        "suction_unloading",
        "ring_friction",
        "squeeze_film",
        "guide_clearance",
        "rod_flexibility",
        "frame_compliance",
        "rotating_unbalance",
        "misalignment",
        "speed_fluctuation",
        "bearing_ovality",
        "extra_clearance",
        "thermal_clearance",
        "crank_angle_offset",
        "sensor_resonance",
        "sensor_gain",
        "sensor_offset",
        "sensor_delay",
        "sensor_highpass",
        "mains_hum",
        "empirical_force",
    ] {
        assert!(names.contains(&name), "{name}");
        assert_eq!(input::effects::entry(name).unwrap().name, name);
    }
}

#[test]
fn every_parameter_has_bounds_about_its_usual_value_and_words() {
    for entry in CATALOGUE.iter() {
        assert!(entry.sentence.ends_with('.'), "{}", entry.name);
        for p in entry.parameters {
            let [low, high] = p.bounds;
            assert!((low..=high).contains(&p.start), "{} {}", entry.name, p.key);
            assert!(
                low < high && !p.words.is_empty(),
                "{} {}",
                entry.name,
                p.key
            );
            // Within its bounds an effect does not vanish, unless its amplitude has two signs.
            if let Some(absent) = p.absent {
                assert!(absent != p.start, "{} {}", entry.name, p.key);
                assert!(absent < low || -low == high, "{} {}", entry.name, p.key);
            }
        }
    }
}

#[test]
fn without_amplitude_every_effect_leaves_the_machine_as_it_is() {
    let plain = resolve(&tree());
    for entry in CATALOGUE.iter().filter(|e| e.amplitudes().next().is_some()) {
        let values: Vec<f64> = entry
            .parameters
            .iter()
            .map(|p| p.absent.unwrap_or(p.start))
            .collect();
        let found = resolve(&with(json!([entry.item(&place(entry), &values)])));
        assert_eq!(found.machine, plain.machine, "{}", entry.name);
        assert_eq!(found.sensors, plain.sensors, "{}", entry.name);
    }
}

#[test]
fn every_effect_changes_the_machine_or_its_sensors_at_all_its_places() {
    // With a chamber at both ends of the cylinder.
    let with = |items: Value| {
        let mut tree = with(items);
        tree["cylinder"]["crank_end"] = json!({"rod_radius": "20 mm", "clearance": "24 mm"});
        tree
    };
    let plain = resolve(&with(json!([])));
    for entry in CATALOGUE.iter() {
        let mut places = vec![place(entry)];
        for choice in entry.places {
            for word in choice.words {
                let mut place = place(entry);
                place.retain(|(key, _)| *key != choice.key);
                place.push((choice.key, *word));
                places.push(place);
            }
        }
        for place in places {
            let found = resolve(&with(json!([entry.item(&place, &start(entry))])));
            let ideal_main = place.contains(&("joint", "main"));
            let same = found.machine == plain.machine && found.sensors == plain.sensors;
            // A hum in acceleration is none on a sensor of pressure.
            let no_hum =
                entry.name == "mains_hum" && place.contains(&("measure", "cylinder_pressure"));
            assert!(!same || ideal_main || no_hum, "{} {place:?}", entry.name);
        }
    }
}

#[test]
fn an_effect_needs_play_in_its_joint() {
    let film = |joint: &str| json!({"squeeze_film": {"joint": joint, "viscosity": "0.05 Pa s"}});
    let found = resolve(&with(json!([film("main"), film("big_end")])));
    assert_eq!(found.idle_effects, [0]);
    assert_eq!(
        found.machine,
        resolve(&with(json!([film("big_end")]))).machine
    );
    // Also without a size.
    let ideal = json!([{"thermal_clearance": {"joint": "main", "change": "0 um"}}]);
    assert_eq!(resolve(&with(ideal)).idle_effects, [0]);
    let leak = message(json!([{"ring_leakage": {"end": "crank", "area": "0 mm^2"}}]));
    let key = "effects.0.ring_leakage.end: found 'crank', expected head";
    assert!(leak.starts_with(key), "{leak}");
}

#[test]
fn every_parameter_can_be_reached_by_its_path() {
    for entry in CATALOGUE.iter() {
        let mut tree = with(json!([entry.item(&place(entry), &start(entry))]));
        let before = resolve(&tree);
        for p in entry.parameters {
            let path = format!("effects.{}.{}", entry.name, p.key);
            assert_eq!(input::effects::at_path(&path), Some(p));
            assert_eq!(
                input::effects::at_path(&path.replace("effects.", "effects.7.")),
                Some(p)
            );
            let there = paths::get(&tree, &path).unwrap().cloned();
            assert_eq!(there, Some(p.value(p.start)), "{path}");
            let other = if p.start == p.bounds[1] {
                p.bounds[0]
            } else {
                p.bounds[1]
            };
            let other = match (entry.name, p.key) {
                _ if p.shape => 0.5 * (p.bounds[0] + p.bounds[1]),
                // As far as the other values allow.
                ("speed_fluctuation" | "bearing_ovality" | "thermal_clearance", _) => {
                    p.start * 1.1 + 0.01 * f64::from(u8::from(p.start == 0.0))
                }
                _ => other,
            };
            paths::set(&mut tree, &path, p.value(other)).unwrap();
            let after = resolve(&tree);
            let same = before.machine == after.machine && before.sensors == after.sensors;
            // Where the speed is that of the reference, its power does not count.
            let idle = entry.name == "thermal_clearance" && p.key == "exponent";
            assert!(!same || idle, "{path}");
            paths::set(&mut tree, &path, p.value(p.start)).unwrap();
        }
    }
}

#[test]
fn clearances_become_wider_with_what_follows_from_them() {
    let extra = |joint: &str, clearance: &str| {
        let mut tree = with(json!([{"extra_clearance": {"joint": joint, "clearance": clearance}}]));
        let path = "joints.big_end.clearance";
        paths::set(&mut tree, path, json!("ideal")).unwrap();
        for (key, value) in [("relation", "conformal"), ("at_clearance", "0.2 mm")] {
            let path = format!("joints.small_end.contact.{key}");
            paths::set(&mut tree, &path, json!(value)).unwrap();
        }
        resolve(&tree).machine.throws.remove(0)
    };
    let throw = extra("small_end", "0.1 mm");
    let clear = throw.small_end.clear().unwrap();
    assert!((clear.clearance - 3e-4).abs() < 1e-18);
    let stiffness = clear.contact.spring().0;
    assert!(
        (stiffness / 20e9 - (2.0_f64 / 3.0).sqrt()).abs() < 2e-3,
        "{stiffness}"
    );
    assert!(throw.big_end.clear().is_none());
    // An ideal joint becomes clear.
    let throw = extra("big_end", "0.1 mm");
    assert_eq!(throw.big_end.clear().unwrap().clearance, 1e-4);
}

#[test]
fn warmth_changes_the_clearance_with_the_speed() {
    let clearance = |speed: &str, exponent: f64| {
        let section = json!({"joint": "small_end", "change": "-0.04 mm", "at_speed": "400 rpm", "exponent": exponent});
        let mut tree = with(json!([{"thermal_clearance": section}]));
        paths::set(&mut tree, "speed", json!(speed)).unwrap();
        let machine = resolve(&tree).machine;
        machine.throws[0].small_end.clear().unwrap().clearance
    };
    for (speed, exponent, expected) in [
        ("400 rpm", 1.0, 1.6e-4),
        ("200 rpm", 1.0, 1.8e-4),
        ("200 rpm", 2.0, 1.9e-4),
        ("800 rpm", 1.0, 1.2e-4),
    ] {
        let found = clearance(speed, exponent);
        assert!(
            (found - expected).abs() < 1e-12,
            "{speed} {exponent}: {found}"
        );
    }
}

#[test]
fn a_guide_with_play_needs_nothing_else_of_the_file() {
    let mut tree = with(json!([{"guide_clearance": {"clearance": "0.15 mm"}}]));
    tree["crosshead"].as_object_mut().unwrap().remove("inertia");
    tree["joints"].as_object_mut().unwrap().remove("guide");
    let throw = resolve(&tree).machine.throws.remove(0);
    let Guide::Clear(guide) = &throw.guide else {
        panic!("ideal")
    };
    assert_eq!([guide.clearance, guide.half_length], [1.5e-4, 0.09]);
    assert!((throw.crosshead.inertia - 18.0 * (0.0081 + 0.0049) / 3.0).abs() < 1e-15);
}

#[test]
fn a_frame_that_gives_has_the_stated_mass_and_frequency() {
    let section = json!({"mass_ratio": "6 %", "frequency": "50 Hz", "damping_ratio": "10 %"});
    let frame = resolve(&with(json!([{"frame_compliance": section}])))
        .machine
        .frame
        .unwrap();
    assert!((frame.mass - 300.0).abs() < 1e-9 && frame.carries);
    assert!((frame.stiffness_x / (300.0 * (TAU * 50.0).powi(2)) - 1.0).abs() < 1e-12);
    assert!((frame.damping_y / (2.0 * 0.1 * 300.0 * TAU * 50.0) - 1.0).abs() < 1e-12);
}

#[test]
fn a_fluctuating_speed_is_the_drive_s() {
    let section = json!({"second": "3 %", "second_phase": "90 deg"});
    let Drive::Given(given) = resolve(&with(json!([{"speed_fluctuation": section}])))
        .machine
        .drive
    else {
        panic!("free")
    };
    let found: Vec<[f64; 2]> = given
        .fluctuation
        .iter()
        .map(|h| [h.amplitude, h.phase])
        .collect();
    assert_eq!(found, [[0.0, 0.0], [0.03, TAU / 4.0]]);
}

#[test]
fn several_throws_have_effects_of_their_own() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../data/machines/two-stage.yaml"
    );
    let file = input::machine_file::read(std::path::Path::new(path)).unwrap();
    let mut tree = file.to_tree().clone();
    tree["effects"] = json!([
        {"ring_friction": {"throw": "throw2", "coulomb_force": "300 N"}},
        {"ring_friction": {"throw": "throw1", "coulomb_force": "200 N"}},
        {"squeeze_film": {"joint": "big_end", "viscosity": "0.01 Pa s"}},
        {"extra_clearance": {"throw": "throw2", "joint": "small_end", "clearance": "0.1 mm"}},
    ]);
    let plain = file.resolve().unwrap().machine;
    let machine = resolve(&tree).machine;
    let places: Vec<_> = machine
        .effects
        .iter()
        .map(|e| (e.place.throw, e.place.joint))
        .collect();
    assert_eq!(
        places,
        [
            (Some(1), None),
            (Some(0), None),
            (None, Some(Joint::BigEnd))
        ]
    );
    assert!(matches!(&machine.effects[1].law, Law::RingFriction(r) if r.coulomb_force == 200.0));
    let clearance = |machine: &mechanism::Machine, throw: usize| {
        machine.throws[throw]
            .small_end
            .clear()
            .map_or(0.0, |c| c.clearance)
    };
    assert_eq!(clearance(&machine, 0), clearance(&plain, 0));
    assert!((clearance(&machine, 1) - clearance(&plain, 1) - 1e-4).abs() < 1e-15);
    // An index tells two of a name apart.
    let path = "effects.1.ring_friction.coulomb_force";
    assert_eq!(paths::get(&tree, path).unwrap(), Some(&json!("200 N")));
}

#[test]
fn an_empirical_force_is_the_terms_that_are_stated() {
    let section = json!({"velocity_sign": "-120 N", "cos_2": "35 N"});
    let mut tree = with(json!([{"empirical_force": section}]));
    let force = |tree: &Value| match &resolve(tree).machine.effects[0].law {
        Law::EmpiricalForce(force) => force.clone(),
        other => panic!("{other:?}"),
    };
    let found = force(&tree);
    assert_eq!(found.friction, [-120.0, 0.0, 0.0]);
    assert_eq!(found.cosines, [0.0, 35.0, 0.0, 0.0]);
    assert_eq!(
        (found.sines, found.velocity, found.slip_speed),
        ([0.0; 4], [0.0; 3], 0.05)
    );
    paths::set(
        &mut tree,
        "effects.0.empirical_force.velocity_sign",
        json!("-90 N"),
    )
    .unwrap();
    assert_eq!(force(&tree).friction[0], -90.0);
    // The file says the same when it is written and read again.
    let written = MachineFile::from_tree(&tree).unwrap().to_yaml().unwrap();
    assert!(written.contains("velocity_sign: -90 N"), "{written}");
}

#[test]
fn effects_on_sensors_reach_those_that_no_file_has() {
    let resolved = resolve(&with(json!([
        {"sensor_gain": {"error": "5 %"}},
        {"crank_angle_offset": {"offset": "2 deg"}},
    ])));
    let gain = |throw| {
        let measured = simulate::Measured::CrossheadAcceleration { throw };
        resolved.perfect_sensor(measured).chain.gain
    };
    assert_eq!(gain(0), 1.05);
    let angle = resolved.perfect_sensor(simulate::Measured::CrankAngle);
    assert_eq!(angle.chain.angle_offset, 2_f64.to_radians());
    assert_eq!(angle.chain.gain, 1.0);
}

#[test]
fn messages() {
    for (items, expected) in [
        (
            json!([{"valve_loss": {}}]),
            "effects.0.valve_loss.suction: missing; expected a plain number",
        ),
        (
            json!([{"extra_clearance": {"clearance": "0.1 mm"}}]),
            "effects.0.extra_clearance.joint: missing; expected one of main, big_end, small_end",
        ),
        (
            json!([{"extra_clearance": {"joint": "crosshead", "clearance": "0.1 mm"}}]),
            "effects.0.extra_clearance.joint: found 'crosshead', expected one of main, big_end, small_end",
        ),
        (
            json!([{"ring_friction": {"throw": "throw1", "coulomb_force": "100 N"}}]),
            "effects.0.ring_friction.throw: found 'throw1', expected nothing here",
        ),
        (
            json!([{"ring_friction": {"coulomb_force": "100 N"}}, {"ring_friction": {"coulomb_force": "50 N"}}]),
            "effects.1: found the effect of effects.0 again, expected each effect at most once at its place",
        ),
        (
            json!([{"ring_leakage": {"area": "2 mm"}}]),
            "effects.0.ring_leakage.area: found '2 mm' (a length), expected an area of at least 0 with its unit, e.g. '2 mm^2'",
        ),
        (
            json!([{"suction_unloading": {"held": "200 deg"}}]),
            "effects.0.suction_unloading.held: found '200 deg', expected an angle from 0 to 180 deg with its unit, e.g. '30 deg'",
        ),
        (
            json!([{"valve_flutter": {"suction": "100 %"}}]),
            "effects.0.valve_flutter.suction: found '100 %', expected a percentage of at least 0, below 100 % with its unit, e.g. '5 %'",
        ),
        (
            json!([{"bearing_ovality": {"joint": "small_end", "amplitude": "0.2 mm"}}]),
            "effects.0.bearing_ovality.amplitude: found '0.2 mm', expected a length below the clearance, 0.0002 m",
        ),
        (
            json!([{"thermal_clearance": {"joint": "small_end", "change": "-0.3 mm"}}]),
            "effects.0.thermal_clearance.change: found '-0.3 mm', expected a change that leaves some of 0.0002 m",
        ),
        (
            json!([{"speed_fluctuation": {"first": "60 %"}}]),
            "effects.0.speed_fluctuation.first: found '60 %', expected a percentage up to 50 %",
        ),
        (
            json!([{"empirical_force": {"velocity_sgn": "-120 N"}}]),
            "effects.0.empirical_force.velocity_sgn: unknown key; expected one of constant, cos_1, sin_1, cos_2, sin_2, cos_3, sin_3, cos_4, sin_4, displacement, displacement_cubed, velocity, velocity_squared, velocity_cubed, velocity_sign, pressure_sign, side_force_sign, acceleration, gas_force, big_end_offset, small_end_offset, slip_speed, throw; did you mean 'velocity_sign'?",
        ),
        (
            json!([{"empirical_force": {"cos_2": "30"}}]),
            "effects.0.empirical_force.cos_2: found '30' (no unit), expected a force with its unit, e.g. '200 N'",
        ),
    ] {
        assert_eq!(message(items), expected);
    }
    // What is not there cannot be made wider.
    let mut tree = with(json!([{"extra_clearance": {"joint": "big_end", "clearance": "0.1 mm"}}]));
    tree["joints"].as_object_mut().unwrap().remove("big_end");
    let error = MachineFile::from_tree(&tree)
        .and_then(|file| file.resolve())
        .unwrap_err();
    assert_eq!(
        error.to_string(),
        "effects.0.extra_clearance.joint: found 'big_end', expected a joint with a section that has journal_radius and contact"
    );
    let mut tree = with(json!([{"speed_fluctuation": {"first": "2 %"}}]));
    let motor = json!({"inertia": "8 kg m^2", "mean_torque": "60 N m", "slope": "40 N m s"});
    tree["crank"]["drive"] = json!({"free": motor});
    let error = MachineFile::from_tree(&tree)
        .and_then(|file| file.resolve())
        .unwrap_err();
    assert_eq!(
        error.to_string(),
        "effects.0.speed_fluctuation: found a section, expected a crank of given speed; a free one fluctuates by itself"
    );
}

#[test]
fn the_kind_of_an_effect_goes_with_its_places() {
    let has = |entry: &Entry, key: &str| entry.places.iter().any(|choice| choice.key == key);
    for entry in CATALOGUE.iter() {
        let name = entry.name;
        assert_eq!(entry.kind == Kind::Gas, has(entry, "end"), "{name}");
        assert!(entry.kind == Kind::Joint || !has(entry, "joint"), "{name}");
        assert!(
            entry.kind == Kind::Sensor || !entry.is_of_chosen_sensor(),
            "{name}"
        );
        assert!(
            entry.proposal != Proposal::PerEnd || has(entry, "end"),
            "{name}"
        );
    }
}
