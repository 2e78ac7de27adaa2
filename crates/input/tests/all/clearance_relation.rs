//! What `relation` and `at_clearance` of a contact do to its parameters.

use input::{MachineFile, machine_file, paths};
use mechanism::joints::contact::ContactLaw;
use serde_json::{Value, json};
use std::path::PathBuf;

/// What the section `contact` means at the big end of the single-stage machine (journal of 50 mm)
/// with this clearance.
fn law(contact: Value, clearance: &str) -> ContactLaw {
    let path =
        PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../data/machines/single-stage.yaml");
    let mut tree = machine_file::read(&path).unwrap().to_tree().clone();
    paths::set(&mut tree, "joints.big_end.clearance", json!(clearance)).unwrap();
    paths::set(&mut tree, "joints.big_end.contact", contact).unwrap();
    let resolved = MachineFile::from_tree(&tree).unwrap().resolve().unwrap();
    let joint = resolved.machine.throws[0].big_end.clear();
    joint.unwrap().contact.clone()
}

/// Stiffness, damping and depth of IMPACT, stated at 0.1 mm, with this clearance.
fn impact(relation: Value, clearance: &str) -> [f64; 3] {
    let contact = json!({"stiffness": "24 GN/m^1.5", "damping": "2e4 N s/m", "depth": "10 um",
        "relation": relation, "at_clearance": "0.1 mm"});
    let ContactLaw::Impact(law) = law(contact, clearance) else {
        panic!("another law")
    };
    [law.stiffness, law.damping, law.depth]
}

fn assert_near(found: [f64; 3], expected: [f64; 3]) {
    for (found, expected) in found.into_iter().zip(expected) {
        let difference = (found / expected - 1.0).abs();
        assert!(difference < 1e-8, "{found:e} {expected:e}");
    }
}

#[test]
fn parameters_hold_as_they_stand_at_their_clearance() {
    for relation in [
        json!("eq5"),
        json!("conformal"),
        json!("constant"),
        json!({"stiffness": -0.5, "damping": 0.3, "depth": 1}),
    ] {
        assert_eq!(impact(relation, "0.1 mm"), [24e9, 2e4, 1e-5]);
    }
}

#[test]
fn each_relation_carries_them_to_another() {
    // R₁ = 50 mm and R₂ = 50.1, 50.3 mm: R₁R₂ = 2505, 2515 mm².
    // Eq. (5): √((2515/100.3)/(2505/100.1)); conformal: √((2515/0.3)/(2505/0.1)). The damping of
    // both by the power 0.4 of the latter.
    let damping = 0.803_381_452_220;
    let expected = [24e9 * 1.000_994_524_396, 2e4 * damping, 1e-5];
    assert_near(impact(json!("eq5"), "0.3 mm"), expected);
    let stiffness = 0.578_501_517_131;
    let expected = [24e9 * stiffness, 2e4 * damping, 1e-5 / damping];
    assert_near(impact(json!("conformal"), "0.3 mm"), expected);
    assert_eq!(impact(json!("constant"), "0.3 mm"), [24e9, 2e4, 1e-5]);
    let powers = json!({"stiffness": -0.5, "damping": -0.25});
    let expected = [24e9 / 2.0, 2e4 / 2_f64.sqrt(), 1e-5];
    assert_near(impact(powers, "0.4 mm"), expected);
}

#[test]
fn a_stiffness_from_materials_is_the_one_at_the_stated_clearance() {
    let stiffness = |from: &str, relation: Option<&str>, clearance: &str| {
        let materials = json!({"from": from, "youngs_modulus": "207 GPa", "poisson_ratio": 0.3});
        let mut contact = json!({"law": "hertz", "stiffness": materials});
        if let Some(relation) = relation {
            contact["relation"] = json!(relation);
            contact["at_clearance"] = json!("0.1 mm");
        }
        law(contact, clearance).spring().0
    };
    for from in ["eq5", "conformal"] {
        // From there its own relation leads to what the formula gives directly.
        let ratio = stiffness(from, Some(from), "0.3 mm") / stiffness(from, None, "0.3 mm");
        assert!((ratio - 1.0).abs() < 1e-12, "{from}: {ratio}");
        let held = stiffness(from, Some("constant"), "0.3 mm");
        assert_eq!(held, stiffness(from, None, "0.1 mm"));
    }
}

#[test]
fn every_law_takes_what_it_has() {
    let relation = json!({"stiffness": -0.5, "damping": -0.25, "depth": 0.2});
    for name in [
        "hertz",
        "kelvin_voigt",
        "hunt_crossley",
        "lankarani_nikravesh",
        "flores",
    ] {
        let mut contact = json!({"law": name, "relation": relation, "at_clearance": "0.1 mm"});
        contact["stiffness"] = json!("24 GN/m^1.5");
        match name {
            "hertz" => {}
            "kelvin_voigt" => {
                contact["stiffness"] = json!("24 GN/m");
                contact["damping"] = json!("2e4 N s/m");
            }
            _ => contact["restitution"] = json!(0.9),
        }
        let law = law(contact, "0.4 mm");
        assert!((law.spring().0 / 12e9 - 1.0).abs() < 1e-12, "{name}");
        match law {
            ContactLaw::KelvinVoigt(law) => {
                assert!((law.damping * 2_f64.sqrt() / 2e4 - 1.0).abs() < 1e-12);
            }
            ContactLaw::HuntCrossley(law)
            | ContactLaw::LankaraniNikravesh(law)
            | ContactLaw::Flores(law) => assert_eq!(law.restitution, 0.9),
            _ => {}
        }
    }
}
