//! Contacts from the materials of pin and bush.

use input::{MachineFile, paths};
use mechanism::joints::contact::ContactLaw;

/// A machine whose big end has this contact.
fn machine(contact: &str) -> String {
    format!(
        "name: a\nspeed: 740 rpm\nstroke: 150 mm\n\
         rod: {{length: 400 mm, mass: 12 kg, centre_of_mass: 150 mm, inertia: 0.3 kg m^2}}\n\
         crosshead: {{mass: 18 kg}}\n\
         cylinder: {{bore: 100 mm, suction: 1 bar, discharge: 4 bar, back: 1 bar, exponent: 1.4, head_clearance: 15 mm}}\n\
         joints:\n  big_end:\n    clearance: 0.1 mm\n    journal_radius: 50 mm\n    contact: {contact}\n"
    )
}

fn law(contact: &str) -> ContactLaw {
    let file = MachineFile::from_yaml(&machine(contact), "m.yaml").unwrap();
    let resolved = file.resolve().unwrap_or_else(|e| panic!("{e}"));
    resolved.machine.throws[0]
        .big_end
        .clear()
        .unwrap()
        .contact
        .clone()
}

fn message(contact: &str) -> String {
    let file = MachineFile::from_yaml(&machine(contact), "m.yaml");
    file.and_then(|file| file.resolve())
        .unwrap_err()
        .to_string()
}

/// E* of steel in bronze: 1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂.
fn steel_in_bronze() -> f64 {
    1.0 / ((1.0 - 0.3 * 0.3) / 207e9 + (1.0 - 0.349 * 0.349) / 111e9)
}

#[test]
fn the_stiffness_is_that_of_hertz() {
    let given = "damping: 2e4 N s/m, depth: 10 um";
    let named = law(&format!(
        "{{law: impact, materials: {{pin: steel, bush: bronze}}, {given}}}"
    ));
    // 4/3 E* √R, R = R₁R₂/(R₂ − R₁) of a pin of 50 mm with 0.1 mm of clearance.
    let expected = 4.0 / 3.0 * steel_in_bronze() * f64::sqrt(0.05 * 0.0501 / 1e-4);
    let (stiffness, exponent) = named.spring();
    assert!(
        (stiffness / expected - 1.0).abs() < 1e-9,
        "{stiffness:e} {expected:e}"
    );
    assert_eq!(exponent, 1.5);
    let constants = law(&format!(
        "{{materials: {{pin: {{youngs_modulus: 207 GPa, poisson_ratio: 0.3}}, \
         bush: {{youngs_modulus: 111 GPa, poisson_ratio: 0.349}}}}, {given}}}"
    ));
    assert_eq!(constants, named);
    // Eq. (5) has R₁R₂/(R₁ + R₂) in its place.
    let papers = law(&format!(
        "{{materials: {{pin: steel, bush: bronze, form: eq5}}, {given}}}"
    ));
    let softer = f64::sqrt(1e-4 / 0.1001);
    assert!((papers.spring().0 / stiffness / softer - 1.0).abs() < 1e-9);
}

#[test]
fn the_law_cylinder_has_the_composite_modulus() {
    let own = law(
        "{law: cylinder, materials: {pin: steel, bush: bronze}, length: 60 mm, restitution: 0.7}",
    );
    let modulus = steel_in_bronze();
    let stated = law(&format!(
        "{{law: cylinder, modulus: {modulus:e} Pa, length: 60 mm, restitution: 0.7}}"
    ));
    assert!((own.spring().0 / stated.spring().0 - 1.0).abs() < 1e-9);
}

#[test]
fn sweeps_and_calibrations_find_a_stiffness() {
    let text = machine("{materials: {pin: steel, bush: bronze}, damping: 2e4 N s/m, depth: 10 um}");
    let file = MachineFile::from_yaml(&text, "m.yaml").unwrap();
    let mut tree = file.to_tree().clone();
    let path = "joints.big_end.contact.stiffness";
    let stiffness = paths::get(&tree, path).unwrap().unwrap().as_str().unwrap();
    assert!(stiffness.ends_with(" N/m^1.5"), "{stiffness}");
    // With the relation of its form the stiffness at another clearance is that of the formula there.
    paths::set(&mut tree, "joints.big_end.clearance", "0.4 mm".into()).unwrap();
    let wider = MachineFile::from_tree(&tree).unwrap().resolve().unwrap();
    let wider = wider.machine.throws[0]
        .big_end
        .clear()
        .unwrap()
        .contact
        .clone();
    let expected = 4.0 / 3.0 * steel_in_bronze() * f64::sqrt(0.05 * 0.0504 / 4e-4);
    assert!((wider.spring().0 / expected - 1.0).abs() < 1e-9);
}

#[test]
fn mistakes_name_what_belongs_there() {
    for (contact, expected) in [
        (
            "{materials: {pin: steel, bush: bronce}, damping: 2e4 N s/m, depth: 10 um}",
            "joints.big_end.contact.materials.bush: found 'bronce', expected one of steel, stainless_steel, cast_iron, \
             bronze, brass, aluminium, white_metal; did you mean 'bronze'?",
        ),
        (
            "{materials: {pin: steel, bush: bronze}, stiffness: 24 GN/m^1.5, damping: 2e4 N s/m, depth: 10 um}",
            "joints.big_end.contact.materials: found a section, expected it or stiffness, not both",
        ),
        (
            "{materials: steel, damping: 2e4 N s/m, depth: 10 um}",
            "joints.big_end.contact.materials: found 'steel', expected a section with the keys pin, bush, form",
        ),
        (
            "{exponent: 1.4, materials: {pin: steel, bush: bronze}, damping: 2e4 N s/m, depth: 10 um}",
            "joints.big_end.contact.materials: found a section, expected a stiffness in N/m^1.4, because the exponent \
             is 1.4",
        ),
    ] {
        let message = message(contact);
        assert!(message.contains(expected), "{message}");
    }
}
