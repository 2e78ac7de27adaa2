//! The exact text of every message that a wrong machine file gives.

use input::effects::CATALOGUE;
use input::machine_file::{self, MachineFile};
use input::paths;
use mechanism::joints::contact::CONTACT_LAWS;
use serde_json::json;
use std::path::Path;

/// A small machine; every line of it has its test.
const MACHINE: &str = "\
name: small
speed: 500 rpm
crank: {radius: 120 mm}
rod:
  length: 600 mm
  mass: 12 kg
  centre_of_mass: 220 mm
  inertia: 0.6 kg m^2
crosshead: {mass: 18 kg}
cylinder:
  piston_radius: 50 mm
  suction: 0.105 MPa
  discharge: 0.393 MPa
  back: 0 Pa
  exponent: 1.4
  head_clearance: 24 mm
joints:
  big_end:
    clearance: 0.1 mm
    journal_radius: 50 mm
    contact: {law: impact, stiffness: 24 GN/m^1.5, damping: 2e4 N s/m, depth: 10 um}
    friction: {law: coulomb, coefficient: 0.05, slip_speed: 0.01 m/s}
sensors:
  - {measure: crosshead_acceleration, range: 500 m/s^2, bits: 16}
effects:
  - valve_loss: {suction: 0.18, discharge: 0.15}
";

/// The message for the small machine with `from` replaced by `to`.
fn message(from: &str, to: &str) -> String {
    assert_eq!(MACHINE.matches(from).count(), 1, "'{from}' must stand once");
    refusal(&MACHINE.replace(from, to))
}

fn refusal(text: &str) -> String {
    match MachineFile::from_yaml(text, "m.yaml").and_then(|file| file.resolve()) {
        Ok(_) => panic!("accepted:\n{text}"),
        Err(error) => error.to_string(),
    }
}

macro_rules! messages {
    ($( $name:ident: $from:literal => $to:literal, $expected:literal; )*) => {
        $( #[test] fn $name() { assert_eq!(message($from, $to), in_full($expected)); } )*
    };
}

/// A message with the names of the lists in it.
fn in_full(message: &str) -> String {
    let effects: Vec<&str> = CATALOGUE.iter().map(|effect| effect.name).collect();
    let laws: Vec<&str> = CONTACT_LAWS.iter().map(|law| law.name).collect();
    let message = message.replace("EFFECTS", &effects.join(", "));
    message.replace("CONTACT LAWS", &laws.join(", "))
}

#[test]
fn the_small_machine_is_right() {
    MachineFile::from_yaml(MACHINE, "m.yaml")
        .unwrap()
        .resolve()
        .unwrap();
}

messages! {
    bare_number: "clearance: 0.1 mm" => "clearance: 0.1",
        "m.yaml:19:16: joints.big_end.clearance: found 0.1, expected a length of at least 0 with its unit, e.g. '0.1 mm', or 'ideal'";
    bare_integer: "speed: 500 rpm" => "speed: 500",
        "m.yaml:2:8: speed: found 500, expected a rotational speed greater than 0 with its unit, e.g. '500 rpm'";
    quoted_number_without_unit: "mass: 12 kg" => "mass: '12'",
        "m.yaml:6:9: rod.mass: found '12' (no unit), expected a mass greater than 0 with its unit, e.g. '12 kg'";
    wrong_dimension: "mass: 12 kg" => "mass: 12 mm",
        "m.yaml:6:9: rod.mass: found '12 mm' (a length), expected a mass greater than 0 with its unit, e.g. '12 kg'";
    frequency_is_no_speed: "speed: 500 rpm" => "speed: 8 Hz",
        "m.yaml:2:8: speed: found '8 Hz' (a frequency), expected a rotational speed greater than 0 with its unit, e.g. '500 rpm'";
    unknown_unit: "mass: 12 kg" => "mass: 12 kq",
        "m.yaml:6:9: rod.mass: found '12 kq' (there is no unit 'kq'; did you mean 'kg'?), expected a mass greater than 0 with its unit, e.g. '12 kg'";
    unit_in_wrong_case: "suction: 0.105 MPa" => "suction: 0.105 mpa",
        "m.yaml:12:12: cylinder.suction: found '0.105 mpa' (there is no unit 'mpa'; did you mean 'MPa'?), expected a pressure greater than 0 with its unit, e.g. '0.393 MPa'";
    two_slashes: "damping: 2e4 N s/m" => "damping: 2e4 N/m/s",
        "m.yaml:21:61: joints.big_end.contact.damping: found '2e4 N/m/s' (the unit is not understood), expected a damping of at least 0 with its unit, e.g. '2e4 N s/m'";
    no_number: "radius: 120 mm" => "radius: wide",
        "m.yaml:3:17: crank.radius: found 'wide', expected a length greater than 0 with its unit, e.g. '0.1 mm'";
    infinite: "radius: 120 mm" => "radius: 1e400 mm",
        "m.yaml:3:17: crank.radius: found '1e400 mm', expected a length greater than 0 with its unit, e.g. '0.1 mm'";
    not_a_number: "exponent: 1.4" => "exponent: .nan",
        "m.yaml:15:13: cylinder.exponent: found '.nan', expected a plain number greater than 0";
    text_for_a_pure_number: "exponent: 1.4" => "exponent: 5 %",
        "m.yaml:15:13: cylinder.exponent: found '5 %' (0.05 as a plain number), expected a plain number greater than 0";
    percentage_for_a_share: "valve_loss: {suction: 0.18" => "valve_loss: {suction: 5 %",
        "m.yaml:26:27: effects.0.valve_loss.suction: found '5 %' (0.05 as a plain number), expected a plain number of at least 0";
    negative_mass: "mass: 12 kg" => "mass: -12 kg",
        "m.yaml:6:9: rod.mass: found '-12 kg', expected a mass greater than 0 with its unit, e.g. '12 kg'";
    negative_clearance: "clearance: 0.1 mm" => "clearance: -0.1 mm",
        "m.yaml:19:16: joints.big_end.clearance: found '-0.1 mm', expected a length of at least 0 with its unit, e.g. '0.1 mm', or 'ideal'";
    unknown_key: "  length: 600 mm" => "  lenght: 600 mm",
        "m.yaml:5:3: rod.lenght: unknown key; expected one of length, mass, centre_of_mass, inertia; did you mean 'length'?";
    unknown_key_far_from_any: "name: small" => "name: small\ncolour: red",
        "m.yaml:2:1: colour: unknown key; expected one of name, speed, ambient_pressure, gravity, crank, rod, crosshead, cylinder, housing, joints, throws, frame, sensors, sample_rate, effects";
    key_with_a_line_break: "name: small" => "name: small\n\"a\\nb\": 1",
        "m.yaml:2:1: a\\nb: unknown key; expected one of name, speed, ambient_pressure, gravity, crank, rod, crosshead, cylinder, housing, joints, throws, frame, sensors, sample_rate, effects";
    misspelt_joint: "  big_end:" => "  big_ned:",
        "m.yaml:18:3: joints.big_ned: unknown key; expected one of main, big_end, small_end, guide; did you mean 'big_end'?";
    misspelt_contact_law: "law: impact" => "law: impct",
        "m.yaml:21:20: joints.big_end.contact.law: found 'impct', expected one of CONTACT LAWS; did you mean 'impact'?";
    misspelt_friction_law: "law: coulomb" => "law: colomb",
        "m.yaml:22:21: joints.big_end.friction.law: found 'colomb', expected one of coulomb, none, adams, ambrosio; did you mean 'coulomb'?";
    law_is_no_text: "law: impact" => "law: 3",
        "m.yaml:21:20: joints.big_end.contact.law: found 3, expected a name, as text";
    misspelt_effect: "valve_loss" => "valve_los",
        "m.yaml:26:5: effects.0: found 'valve_los', expected one of EFFECTS; did you mean 'valve_loss'?";
    misspelt_sensor: "crosshead_acceleration" => "crosshead_aceleration",
        "m.yaml:24:15: sensors.0.measure: found 'crosshead_aceleration', expected one of crosshead_acceleration, crosshead_lateral_acceleration, frame_acceleration, frame_velocity, housing_acceleration, housing_velocity, cylinder_pressure, crank_angle, crank_speed; did you mean 'crosshead_acceleration'?";
    sensor_without_measure: "measure: crosshead_acceleration, " => "",
        "m.yaml:24:5: sensors.0.measure: missing; expected one of crosshead_acceleration, crosshead_lateral_acceleration, frame_acceleration, frame_velocity, housing_acceleration, housing_velocity, cylinder_pressure, crank_angle, crank_speed";
    key_of_another_law: "law: impact" => "law: hertz",
        "m.yaml:21:51: joints.big_end.contact.damping: unknown key; expected one of stiffness, exponent, materials, relation, at_clearance\nm.yaml:21:71: joints.big_end.contact.depth: unknown key; expected one of stiffness, exponent, materials, relation, at_clearance";
    misspelt_relation: "depth: 10 um" => "depth: 10 um, relation: conformel, at_clearance: 0.1 mm",
        "m.yaml:21:96: joints.big_end.contact.relation: found 'conformel', expected one of eq5, conformal, constant; did you mean 'conformal'?";
    misspelt_exponent: "depth: 10 um" => "depth: 10 um, relation: {stifness: -0.5}, at_clearance: 0.1 mm",
        "m.yaml:21:97: joints.big_end.contact.relation.stifness: unknown key; expected one of stiffness, damping, depth; did you mean 'stiffness'?";
    exponent_with_a_unit: "depth: 10 um" => "depth: 10 um, relation: {stiffness: 1 mm}, at_clearance: 0.1 mm",
        "m.yaml:21:108: joints.big_end.contact.relation.stiffness: found '1 mm', expected a plain number";
    relation_without_its_clearance: "depth: 10 um" => "depth: 10 um, relation: eq5",
        "m.yaml:21:5: joints.big_end.contact.at_clearance: missing; expected a length greater than 0 with its unit, e.g. '0.1 mm'";
    clearance_without_a_relation: "depth: 10 um" => "depth: 10 um, at_clearance: 0.1 mm",
        "m.yaml:21:5: joints.big_end.contact.relation: missing; expected one of eq5, conformal, constant";
    relation_at_no_clearance: "depth: 10 um" => "depth: 10 um, relation: eq5, at_clearance: 0 mm",
        "m.yaml:21:115: joints.big_end.contact.at_clearance: found '0 mm', expected a length greater than 0 with its unit, e.g. '0.1 mm'";
    radii_of_flat_faces: "  big_end:" => "  guide: {clearance: 0.1 mm, half_length: 9 cm, half_height: 7 cm, contact: {law: hertz, stiffness: 1 GN/m^1.5, relation: eq5, at_clearance: 1 mm}}\n  big_end:",
        "m.yaml:9:1: crosshead.inertia: missing; expected a moment of inertia greater than 0 with its unit, e.g. '0.6 kg m^2'\nm.yaml:18:123: joints.guide.contact.relation: found 'eq5', expected constant, or exponents: the guide's faces have no radius";
    missing_key: "  mass: 12 kg\n" => "",
        "m.yaml:4:1: rod.mass: missing; expected a mass greater than 0 with its unit, e.g. '12 kg'";
    missing_section: "crosshead: {mass: 18 kg}\n" => "",
        "m.yaml:1:1: crosshead: missing; expected a section with the keys mass, inertia";
    missing_top_key: "speed: 500 rpm\n" => "",
        "m.yaml:1:1: speed: missing; expected a rotational speed greater than 0 with its unit, e.g. '500 rpm'";
    duplicate_key: "  mass: 12 kg" => "  mass: 12 kg\n  mass: 13 kg",
        "m.yaml:7:3: rod.mass: the key stands here a second time";
    section_is_a_value: "crank: {radius: 120 mm}" => "crank: 120 mm",
        "m.yaml:3:8: crank: found '120 mm', expected a section with the keys radius, drive, mass, eccentricity";
    section_is_nothing: "crank: {radius: 120 mm}" => "crank:",
        "m.yaml:3:6: crank: found nothing, expected a section with the keys radius, drive, mass, eccentricity";
    list_is_a_value: "effects:\n  - valve_loss: {suction: 0.18, discharge: 0.15}" => "effects: none",
        "m.yaml:25:10: effects: found 'none', expected a list";
    effect_is_no_section: "valve_loss: {suction: 0.18, discharge: 0.15}" => "3",
        "m.yaml:26:5: effects.0: found 3, expected one of EFFECTS";
    joint_is_another_word: "  big_end:" => "  main: idle\n  big_end:",
        "m.yaml:18:9: joints.main: found 'idle', expected 'ideal' or a section";
    bits_out_of_range: "bits: 16" => "bits: 64",
        "m.yaml:24:63: sensors.0.bits: found 64, expected a whole number from 1 to 32";
    bits_without_range: "range: 500 m/s^2, " => "",
        "m.yaml:24:45: sensors.0.bits: found 16 without a range, expected a key range beside it";
    range_of_wrong_dimension: "range: 500 m/s^2" => "range: 500 Pa",
        "m.yaml:24:46: sensors.0.range: found '500 Pa' (a pressure), expected an acceleration greater than 0 with its unit, e.g. '9.81 m/s^2'";
    rod_shorter_than_crank: "length: 600 mm" => "length: 60 mm",
        "m.yaml:5:11: rod.length: found '60 mm', expected a length above the crank radius, 0.12 m";
    centre_of_mass_outside_the_rod: "centre_of_mass: 220 mm" => "centre_of_mass: 620 mm",
        "m.yaml:7:19: rod.centre_of_mass: found '620 mm', expected a length up to that of the rod, 0.6 m";
    inertia_beyond_the_rod: "inertia: 0.6 kg m^2" => "inertia: 600 kg m^2",
        "m.yaml:8:12: rod.inertia: found '600 kg m^2', expected a moment of inertia up to 4.32 kg m^2: the radius of gyration of 12 kg would be 7.07 m, more than the rod's length, 0.6 m; check its unit";
    inertia_beyond_the_piston: "crosshead: {mass: 18 kg}" => "crosshead: {mass: 18 kg, inertia: 684 kg m^2}",
        "m.yaml:9:35: crosshead.inertia: found '684 kg m^2', expected a moment of inertia up to 162 kg m^2: the radius of gyration of 18 kg would be 6.16 m, more than 5 times the rod's length, 0.6 m; check its unit";
    inertia_beyond_a_flywheel: "crank: {radius: 120 mm}" => "crank: {radius: 120 mm, mass: 70 kg, drive: {free: {inertia: 34000 kg m^2, mean_torque: 100 N m, slope: 500 N m s}}}",
        "m.yaml:3:62: crank.drive.free.inertia: found '34000 kg m^2', expected a moment of inertia up to 2520 kg m^2: the radius of gyration of 70 kg would be 22 m, more than 50 times the crank radius, 0.12 m; check its unit";
    discharge_below_suction: "discharge: 0.393 MPa" => "discharge: 0.093 MPa",
        "m.yaml:13:14: cylinder.discharge: found '0.093 MPa', expected a pressure of at least suction, 105000 Pa";
    clearance_wider_than_the_journal: "clearance: 0.1 mm" => "clearance: 51 mm",
        "m.yaml:19:16: joints.big_end.clearance: found '51 mm', expected a radial clearance below journal_radius, 0.05 m, or a diametral one below 0.1 m";
    stiffness_of_another_exponent: "24 GN/m^1.5" => "24 GN/m",
        "m.yaml:21:39: joints.big_end.contact.stiffness: found '24 GN/m', expected a stiffness in N/m^1.5, because the exponent is 1.5";
    stiffness_is_no_stiffness: "24 GN/m^1.5" => "24 MPa",
        "m.yaml:21:39: joints.big_end.contact.stiffness: found '24 MPa', expected a stiffness in N/m^1.5, because the exponent is 1.5";
    stiffness_as_bare_number: "24 GN/m^1.5" => "2.4e10",
        "m.yaml:21:39: joints.big_end.contact.stiffness: found 24000000000, expected a contact stiffness greater than 0 with its unit N/m^n, e.g. '24 GN/m^1.5'";
    materials_need_the_exponent: "stiffness: 24 GN/m^1.5" => "exponent: 1.3, stiffness: {from: eq5, youngs_modulus: 207 GPa, poisson_ratio: 0.3}",
        "m.yaml:21:54: joints.big_end.contact.stiffness: found a stiffness from materials with the exponent 1.3, expected the exponent 1.5, or a stiffness in N/m^1.3";
    poisson_ratio_too_large: "stiffness: 24 GN/m^1.5" => "stiffness: {from: eq5, youngs_modulus: 207 GPa, poisson_ratio: 0.6}",
        "m.yaml:21:91: joints.big_end.contact.stiffness.poisson_ratio: found 0.6, expected a plain number from 0 to 0.5";
    adams_speeds_in_wrong_order: "law: coulomb, coefficient: 0.05, slip_speed: 0.01 m/s" => "law: adams, static_coefficient: 0.2, dynamic_coefficient: 0.1, stiction_speed: 10 mm/s, transition_speed: 1 mm/s",
        "m.yaml:22:122: joints.big_end.friction.transition_speed: found '1 mm/s', expected a velocity above stiction_speed, 0.01 m/s";
    ambrosio_speeds_in_wrong_order: "law: coulomb, coefficient: 0.05, slip_speed: 0.01 m/s" => "law: ambrosio, coefficient: 0.2, slow: 10 mm/s, fast: 10 mm/s",
        "m.yaml:22:70: joints.big_end.friction.fast: found '10 mm/s', expected a velocity above slow, 0.01 m/s";
    clear_main_needs_the_crank_mass: "  big_end:" => "  main:",
        "m.yaml:3:1: crank.mass: missing; expected a mass greater than 0 with its unit, e.g. '12 kg'";
    frame_sensor_without_frame: "measure: crosshead_acceleration," => "measure: frame_acceleration, axis: x,",
        "m.yaml:24:15: sensors.0.measure: found 'frame_acceleration', expected a section frame in the machine";
    crank_end_sensor_without_chamber: "measure: crosshead_acceleration, range: 500 m/s^2, bits: 16" => "measure: cylinder_pressure, end: crank",
        "m.yaml:24:39: sensors.0.end: found 'crank', expected 'head', or a section crank_end in the cylinder";
    throw_in_a_machine_of_one: "measure: crosshead_acceleration," => "measure: crosshead_acceleration, throw: throw1,",
        "m.yaml:24:46: sensors.0.throw: found 'throw1', expected nothing here";
    sensor_twice: "effects:" => "  - {measure: crosshead_acceleration}\neffects:",
        "m.yaml:25:5: sensors.1: found what sensors.0 measures already, expected each quantity at most once";
    drive_without_parameters: "crank: {radius: 120 mm}" => "crank: {radius: 120 mm, drive: {free: {inertia: 8 kg m^2}}}",
        "m.yaml:3:33: crank.drive.free.mean_torque: missing; expected a torque with its unit, e.g. '60 N m'\nm.yaml:3:33: crank.drive.free.slope: missing; expected a torque per speed of at least 0 with its unit, e.g. '40 N m s'";
    misspelt_drive: "crank: {radius: 120 mm}" => "crank: {radius: 120 mm, drive: fre}",
        "m.yaml:3:32: crank.drive: found 'fre', expected one of given, free; did you mean 'free'?";
    tab_for_indentation: "  mass: 12 kg" => "\tmass: 12 kg",
        "m.yaml:6:1: not valid YAML: indented by a tab; expected spaces";
    unclosed_bracket: "crank: {radius: 120 mm}" => "crank: {radius: 120 mm",
        "m.yaml:3:8: not valid YAML: the bracket '{' is not closed";
}

/// The keys of all mistakes in `text`.
fn keys(text: &str) -> Vec<String> {
    let file = MachineFile::from_yaml(text, "m.yaml").and_then(|file| file.resolve());
    let mistakes = file.unwrap_err().into_each();
    mistakes.iter().map(|e| e.key().to_owned()).collect()
}

#[test]
fn what_a_guess_clashes_with_is_no_mistake() {
    let text = THROWS.replace("{measure: crank_angle}", "{measure: cylinder_pressure, throw: throw1}\n  - {measure: cylinder_pressure, throw: throw3}");
    assert_eq!(keys(&text), ["sensors.1.throw"]);
    let text = text
        .replace("throw: throw3", "throw: throw2")
        .replace("name: throw2", "name: throw 2");
    assert_eq!(keys(&text), ["throws.1.name"]);
    let text = THROWS
        .replace("length: 600 mm, ", "")
        .replace("centre_of_mass: 220 mm", "centre_of_mass: 220");
    assert_eq!(keys(&text), ["rod.length", "rod.centre_of_mass"]);
    let text = MACHINE
        .replace("radius: 120 mm", "radius: 120")
        .replace("length: 600 mm", "length: 10 mm");
    // A centre of mass outside of the rod and an inertia too large for it are some, as all these values are written.
    assert_eq!(
        keys(&text),
        ["crank.radius", "rod.centre_of_mass", "rod.inertia"]
    );
}

/// Two throws that share a rod.
const THROWS: &str = "\
name: two
speed: 500 rpm
crank: {radius: 120 mm}
rod: {length: 600 mm, mass: 12 kg, centre_of_mass: 220 mm, inertia: 0.6 kg m^2}
crosshead: {mass: 18 kg}
cylinder: {piston_radius: 50 mm, suction: 1 bar, discharge: 4 bar, back: 0 Pa, exponent: 1.4, head_clearance: 24 mm}
throws:
  - {name: throw1}
  - {name: throw2, direction: opposed, crank_pin_angle: 180 deg}
sensors:
  - {measure: crank_angle}
";

macro_rules! throw_messages {
    ($( $name:ident: $from:literal => $to:literal, $expected:literal; )*) => {
        $( #[test] fn $name() {
            assert_eq!(THROWS.matches($from).count(), 1);
            assert_eq!(refusal(&THROWS.replace($from, $to)), $expected);
        } )*
    };
}

throw_messages! {
    mistake_in_a_shared_section: "mass: 12 kg" => "mass: 12 m",
        "m.yaml:4:29: rod.mass: found '12 m' (a length), expected a mass greater than 0 with its unit, e.g. '12 kg'";
    unknown_key_in_a_shared_section: "mass: 12 kg" => "masss: 12 kg",
        "m.yaml:4:23: rod.masss: unknown key; expected one of length, mass, centre_of_mass, inertia; did you mean 'mass'?";
    mistake_of_a_throw: "{name: throw1}" => "{name: throw1, rod: {length: 10 mm}}",
        "m.yaml:8:34: throws.0.rod.length: found '10 mm', expected a length above the crank radius, 0.12 m";
    key_that_neither_has: "mass: 12 kg, " => "",
        "m.yaml:4:1: rod.mass: missing; expected a mass greater than 0 with its unit, e.g. '12 kg'";
    same_name_twice: "name: throw2" => "name: throw1",
        "m.yaml:9:12: throws.1.name: found 'throw1', expected a name that no other throw has";
    name_that_is_none: "name: throw2" => "name: throw 2",
        "m.yaml:9:12: throws.1.name: found 'throw 2', expected a letter, then letters, digits and _, e.g. 'throw1'";
    misspelt_direction: "direction: opposed" => "direction: oposed",
        "m.yaml:9:31: throws.1.direction: found 'oposed', expected one of forward, opposed; did you mean 'opposed'?";
    sensor_that_needs_a_throw: "{measure: crank_angle}" => "{measure: cylinder_pressure}",
        "m.yaml:11:5: sensors.0.throw: missing; expected one of throw1, throw2";
    sensor_on_an_unknown_throw: "{measure: crank_angle}" => "{measure: cylinder_pressure, throw: throw3}",
        "m.yaml:11:41: sensors.0.throw: found 'throw3', expected one of throw1, throw2; did you mean 'throw1'?";
    no_throws: "\n  - {name: throw1}\n  - {name: throw2, direction: opposed, crank_pin_angle: 180 deg}" => " []",
        "m.yaml:7:9: throws: found an empty list, expected at least one throw";
}

#[test]
fn files_that_hold_nothing() {
    let files = [
        "",
        "# only a comment\n",
        "- a list\n",
        "500 rpm\n",
        "a: 1\n---\nb: 2\n",
    ];
    assert_eq!(
        files.map(refusal).to_vec(),
        [
            "m.yaml: the file is empty",
            "m.yaml: the file is empty",
            "m.yaml:1:1: found a list, expected a section with the keys name, speed, ambient_pressure, gravity, crank, rod, crosshead, cylinder, housing, joints, throws, frame, sensors, sample_rate, effects",
            "m.yaml:1:1: found text, expected a section with the keys name, speed, ambient_pressure, gravity, crank, rod, crosshead, cylinder, housing, joints, throws, frame, sensors, sample_rate, effects",
            "m.yaml:3:1: not valid YAML: only single YAML document expected but multiple found"
        ]
    );
}

#[test]
fn files_that_cannot_be_read() {
    let message = |path: &str| machine_file::read(Path::new(path)).unwrap_err().to_string();
    assert_eq!(
        ["no/such/machine.yaml", "/"].map(message).to_vec(),
        [
            "no/such/machine.yaml: cannot be read: there is no such file",
            "/: cannot be read: it is a directory"
        ]
    );
}

#[test]
fn paths_that_lead_nowhere() {
    let message = |path: &str| {
        let mut tree = MachineFile::from_yaml(MACHINE, "m.yaml")
            .unwrap()
            .to_tree()
            .clone();
        paths::set(&mut tree, path, json!("1 mm"))
            .unwrap_err()
            .to_string()
    };
    let paths = [
        "joints.big_ned.clearance",
        "joints.big_end.clearence",
        "joints.big_end.clearance.x",
        "throws.throw1.rod.mass",
        "effects.ring_friction.coulomb_force",
        "effects.valve_los.discharge",
        "sensors.7.range",
        "sensors.crosshead_acceleration.rang",
        "",
    ];
    assert_eq!(
        paths.map(message).to_vec(),
        [
            "joints.big_ned: unknown key; expected one of main, big_end, small_end, guide; did you mean 'big_end'?",
            "joints.big_end.clearence: unknown key; expected one of clearance, normal_clearance, journal_radius, model, contact, friction; did you mean 'clearance'?",
            "joints.big_end.clearance.x: unknown key; expected nothing here",
            "throws.throw1: found 'throw1', expected nothing here",
            "effects.ring_friction: found an effect that the machine file does not list, expected it in the list effects of the machine file, e.g. '- ring_friction: {coulomb_force: 100 N}'",
            "effects.valve_los: found 'valve_los', expected valve_loss; did you mean 'valve_loss'?",
            "sensors.7: found '7', expected crosshead_acceleration",
            "sensors.0.rang: unknown key; expected one of measure, throw, range, bits, noise, delay, low_pass, high_pass, mounting, gain, axis, end; did you mean 'range'?",
            "unknown key; expected one of name, speed, ambient_pressure, gravity, crank, rod, crosshead, cylinder, housing, joints, throws, frame, sensors, sample_rate, effects"
        ]
    );
}

#[test]
fn a_word_in_the_way_of_a_path() {
    let mut tree = json!({"joints": {"main": "ideal"}});
    let error = paths::set(&mut tree, "joints.main.clearance", json!("1 mm")).unwrap_err();
    assert_eq!(
        error.to_string(),
        "joints.main: found 'ideal', expected a section, so that joints.main.clearance can be set"
    );
}

#[test]
fn a_tree_without_file_has_messages_without_lines() {
    let mut tree = MachineFile::from_yaml(MACHINE, "m.yaml")
        .unwrap()
        .to_tree()
        .clone();
    paths::set(&mut tree, "rod.mass", json!(12)).unwrap();
    let error = MachineFile::from_tree(&tree).unwrap_err();
    assert_eq!(
        error.to_string(),
        "rod.mass: found 12, expected a mass greater than 0 with its unit, e.g. '12 kg'"
    );
    assert_eq!((error.key(), error.place()), ("rod.mass", None));
}

#[test]
fn deep_and_self_repeating_files_are_refused() {
    let deep = refusal(&"[".repeat(100_000));
    assert_eq!(
        deep,
        "m.yaml:1:256: not valid YAML: recursion limit exceeded"
    );
    let nested = refusal(&format!("name: {}1{}", "{a: ".repeat(90), "}".repeat(90)));
    assert_eq!(
        nested,
        "m.yaml:1:83: not valid YAML: nested too deeply, or too large"
    );
    let mut laughs = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n".to_owned();
    for i in 1..9 {
        let below = format!("*a{}, ", i - 1).repeat(10);
        laughs += &format!("a{i}: &a{i} [{below}]\n");
    }
    assert_eq!(
        refusal(&laughs),
        "m.yaml:1:13: not valid YAML: nested too deeply, or too large"
    );
}

/// Slips counted at any length would take minutes and gigabytes.
#[test]
fn a_name_as_long_as_a_file_has_no_nearest_one_at_once() {
    let long = "clearance".repeat(1_000_000);
    assert_eq!(input::nearest(&long, ["clearance", "journal_radius"]), None);
    assert_eq!(
        input::nearest("claerance", ["clearance"]),
        Some("clearance")
    );
}
