//! A machine in the words and units of its data sheet. The SI values are worked out by hand from the definitions of
//! the units (NIST Special Publication 811).

use input::MachineFile;
use input::quantity::{Acceleration, Clearance, Length, NonNegative, Positive};
use input::unit::{UnitError, parse};
use mechanism::joints::revolute::Revolute;
use proptest::prelude::*;
use std::f64::consts::PI;
use std::path::Path;

/// Two throws of a US data sheet: bore, stroke, clearance in %, diametral clearances, psig.
const SHEET: &str = "\
name: two throws
rpm: 740
ambient_pressure: 14.7 psia
stroke: 6 in
connecting_rod: {length: 16 in, weight: 95 lb, center_of_gravity: 5.5 in, moment_of_inertia: 5400 lb in^2}
reciprocating_weight: 210 lb
cylinder: {back: 0 psig, exponent: 1.26}
crank_pin: {diameter: 5 in, diametral_clearance: 0.006 in, contact: {stiffness: 60 GN/m^1.5, damping: 2e4 N s/m, depth: 10 um}}
joints:
  wrist_pin: {diameter: 3.5 in, clearance: 4 mil diametral, contact: {stiffness: 50 GN/m^1.5, damping: 2e4 N s/m, depth: 10 um}}
throws:
  - {name: throw1, bore: 9.5 in, rod_diameter: 2.5 in, suction_pressure: 50 psig, discharge_pressure: 150 psig, clearance_volume: 16 %, crank_end_clearance_volume: 18 %}
  - {name: throw2, bore: 6 in, rod_diameter: 2.5 in, suction_pressure: 148 psig, discharge_pressure: 420 psig, clearance_volume: 20 %, crank_end_clearance_volume: 22 %, direction: opposed, crank_pin_angle: 180 deg}
";

const INCH: f64 = 0.0254;
const POUND: f64 = 0.45359237;
const PSI: f64 = 6894.757293168361;

fn resolve(text: &str) -> input::Resolved {
    MachineFile::from_yaml(text, "m.yaml")
        .and_then(|file| file.resolve())
        .unwrap()
}

fn refusal(text: &str) -> String {
    let file = MachineFile::from_yaml(text, "m.yaml").and_then(|file| file.resolve());
    file.unwrap_err().to_string()
}

fn assert_near(found: f64, expected: f64) {
    assert!(
        (found - expected).abs() <= 4e-16 * expected.abs(),
        "{found} for {expected}"
    );
}

#[test]
fn units_of_data_sheets_are_what_they_are_defined_to_be() {
    for (text, si) in [
        ("1 in", INCH),
        ("1 ft", 0.3048),
        ("1 inches", INCH),
        ("1 feet", 0.3048),
        ("1 foot", 0.3048),
        ("1 lbs", POUND),
        ("1 pounds", POUND),
        ("1 mil", 2.54e-5),
        ("1 mils", 2.54e-5),
        ("1 thou", 2.54e-5),
        ("1 psi", PSI),
        ("1 psia", PSI),
        ("1 ksi", 6_894_757.293_168_361),
        ("1 lb", POUND),
        ("1 lbf", 4.448_221_615_260_5),
        ("1 hp", 745.699_871_582_270_2),
        ("1 kgf/cm²", 98_066.5),
        ("1 kgf/cm2", 98_066.5),
        ("1 atm", 101_325.0),
        ("1 bara", 1e5),
        ("5 mm/s", 0.005),
        ("1 lb in^2", POUND * INCH * INCH),
        ("1 lbf in", 4.448_221_615_260_5 * INCH),
    ] {
        let found = parse(text).unwrap().si;
        assert!((found / si - 1.0).abs() < 3e-16, "{text}: {found}");
    }
}

#[test]
fn g_is_gravity_where_an_acceleration_belongs_and_a_gram_elsewhere() {
    let acceleration = |text| Positive::<Acceleration>::parse(text).map(|a| a.si());
    assert_eq!(acceleration("50 g"), Ok(50.0 * 9.80665));
    assert_eq!(acceleration("500 mg"), Ok(0.5 * 9.80665));
    assert_eq!(acceleration("2g"), Ok(2.0 * 9.80665));
    assert_eq!(parse("50 g").unwrap().si, 0.05);
    assert!(acceleration("50 kg").is_err());
    let wrong = acceleration("50 gg").unwrap_err();
    assert!(wrong.contains("there is no unit 'gg'"), "{wrong}");
}

#[test]
fn a_clearance_is_radial_unless_it_says_diametral() {
    let clearance = |text| NonNegative::<Clearance>::parse(text).map(|c| c.si());
    assert_eq!(clearance("0.10 mm diametral"), Ok(0.00005));
    assert_eq!(clearance("0.05 mm radial"), Ok(0.00005));
    assert_eq!(clearance("0.05 mm"), Ok(0.00005));
    assert_eq!(parse("0.1 mm diametral"), Err(UnitError::Sided));
    let refused = Positive::<Length>::parse("150 mm diametral").unwrap_err();
    assert!(
        refused.contains("only a clearance is radial or diametral"),
        "{refused}"
    );
    assert!(clearance("0.1 mmdiametral").is_err());
    assert!(clearance("diametral").is_err());
}

#[test]
fn a_data_sheet_is_the_machine_that_it_describes() {
    let machine = resolve(SHEET);
    assert_near(machine.speed, 740.0 * 2.0 * PI / 60.0);
    for (throw, bore, pressures, gaps) in [
        (0, 9.5, [50.0, 150.0], [0.16, 0.18]),
        (1, 6.0, [148.0, 420.0], [0.20, 0.22]),
    ] {
        let throw = &machine.machine.throws[throw];
        assert_near(throw.crank_radius, 3.0 * INCH);
        assert_near(throw.rod.length, 16.0 * INCH);
        assert_near(throw.rod.mass, 95.0 * POUND);
        assert_near(throw.rod.centre_of_mass, 5.5 * INCH);
        assert_near(throw.rod.inertia, 5400.0 * POUND * INCH * INCH);
        assert_near(throw.crosshead.mass, 210.0 * POUND);
        let cylinder = &throw.cylinder;
        assert_near(cylinder.piston_radius, bore / 2.0 * INCH);
        assert_near(cylinder.suction, (pressures[0] + 14.7) * PSI);
        assert_near(cylinder.discharge, (pressures[1] + 14.7) * PSI);
        assert_near(cylinder.back, 14.7 * PSI);
        // A clearance volume of c % of the swept volume is a gap of c % of the stroke: the area is the same.
        assert_near(cylinder.head_clearance, gaps[0] * 6.0 * INCH);
        let end = cylinder.crank_end.as_ref().unwrap();
        assert_near(end.clearance, gaps[1] * 6.0 * INCH);
        assert_near(end.rod_radius, 1.25 * INCH);
        for (joint, radius, clearance) in [
            (&throw.big_end, 2.5 * INCH, 0.003 * INCH),
            (&throw.small_end, 1.75 * INCH, 0.002 * INCH),
        ] {
            let Revolute::Clear(joint) = joint else {
                panic!("ideal")
            };
            assert_near(joint.journal_radius, radius);
            assert_near(joint.clearance, clearance);
        }
    }
}

/// The small machine whose `stroke` and `crank.radius` are compared.
const METRIC: &str = "\
name: metric
speed: 740 rpm
STROKE
rod: {length: 600 mm, mass: 12 kg, centre_of_mass: 220 mm, inertia: 0.6 kg m^2}
crosshead: {mass: 18 kg}
cylinder: {piston_radius: 50 mm, suction: 1 bar, discharge: 4 bar, back: 0 Pa, exponent: 1.4, head_clearance: 24 mm}
";

#[test]
fn a_synonym_is_its_key_exactly() {
    let plain = METRIC.replace("STROKE", "crank: {radius: 75 mm}");
    for (from, to) in [
        ("crank: {radius: 75 mm}", "stroke: 150 mm"),
        ("crank: {radius: 75 mm}", "crank: {stroke: 150 mm}"),
        ("crank: {radius: 75 mm}", "stroke_m: 0.15"),
        ("crank: {radius: 75 mm}", "crank_radius_m: 0.075"),
        ("speed: 740 rpm", "rpm: 740"),
        ("speed: 740 rpm", "rpm: 740 rpm"),
        ("speed: 740 rpm", "speed_rpm: 740"),
        ("rod: {", "connecting_rod: {"),
        ("mass: 12 kg", "weight: 12 kg"),
        ("crosshead: {mass: 18 kg}", "reciprocating_mass: 18 kg"),
        ("piston_radius: 50 mm", "bore: 100 mm"),
        ("head_clearance: 24 mm", "clearance_volume: 16 %"),
        ("crosshead: {mass: 18 kg}", "crosshead_mass_kg: 18"),
        ("exponent: 1.4", "polytropic_exponent: 1.4"),
    ] {
        assert_eq!(plain.matches(from).count(), 1, "{from}");
        let other = plain.replace(from, to);
        let file = MachineFile::from_yaml(&other, "m.yaml").unwrap();
        assert_eq!(file.resolve().unwrap(), resolve(&plain), "{to}");
        // What is handed on has the keys of machine files alone.
        let again = MachineFile::from_tree(file.to_tree()).unwrap();
        assert_eq!(again.resolve().unwrap(), resolve(&plain), "{to}");
        assert!(
            input::paths::get(file.to_tree(), "crank.radius")
                .unwrap()
                .is_some(),
            "{to}"
        );
    }
}

#[test]
fn synonyms_that_say_nothing_exact_are_refused() {
    let with = |line: &str| METRIC.replace("STROKE", line);
    for (line, expected) in [
        (
            "stroke: 150 mm\ncrank: {radius: 75 mm}",
            "m.yaml:3:9: stroke: found '150 mm', expected it or crank.radius, not both",
        ),
        (
            "stroke: 150 kg",
            "m.yaml:3:9: stroke: found '150 kg' (a mass), expected a length of at least 0 with its unit, e.g. '0.1 mm'",
        ),
        (
            "stroke: 150",
            "m.yaml:3:9: stroke: found 150, expected a length of at least 0 with its unit, e.g. '0.1 mm'",
        ),
        (
            "stroke: 150 mm\ncrank_pin: 100 mm",
            "m.yaml:4:12: crank_pin: found '100 mm', expected a section, as joints.big_end has it; a diameter is crank_pin_diameter",
        ),
        (
            "stroke_m: 150 mm",
            "m.yaml:3:11: stroke_m: found '150 mm', expected a plain number, in m: the key names its unit",
        ),
        (
            "stroke: 1300 mm",
            "m.yaml:4:15: rod.length: found '600 mm', expected a length above the crank radius, 0.65 m",
        ),
    ] {
        assert_eq!(refusal(&with(line)), expected);
    }
}

#[test]
fn a_gauge_pressure_needs_the_ambient_one() {
    let with = |line: &str| METRIC.replace("STROKE", line).replace("4 bar", "20 barg");
    let machine = resolve(&with("stroke: 150 mm\nambient_pressure: 1 atm"));
    assert_near(machine.machine.throws[0].cylinder.discharge, 2_101_325.0);
    let message = refusal(&with("stroke: 150 mm"));
    assert!(message.starts_with("m.yaml:6:"), "{message}");
    assert!(
        message.contains("cylinder.discharge: found '20 barg'"),
        "{message}"
    );
    assert!(message.contains("the key ambient_pressure"), "{message}");
}

/// What is said of the data sheet with `to` in the place of each `from`, a mistake a line.
fn said_of(changes: &[(&str, &str)]) -> String {
    let sheet = changes.iter().fold(SHEET.to_owned(), |sheet, (from, to)| {
        assert!(sheet.contains(from), "{from}");
        sheet.replacen(from, to, 1)
    });
    refusal(&sheet)
}

#[test]
fn a_wrong_stroke_is_one_mistake() {
    for stroke in ["stroke: 6", "crank: {radius: 3}", "crank_radius: wide"] {
        let message = said_of(&[("stroke: 6 in", stroke)]);
        assert_eq!(message.lines().count(), 1, "{message}");
        assert!(message.starts_with("m.yaml:4:"), "{message}");
    }
    let none = said_of(&[("stroke: 6 in\n", "")]);
    assert!(
        none.contains("expected a crank radius or a stroke beside it"),
        "{none}"
    );
}

#[test]
fn the_crank_radius_may_stand_at_the_top() {
    let half = SHEET.replace("stroke: 6 in", "crank_radius: 3 in");
    assert_eq!(resolve(&half).machine, resolve(SHEET).machine);
}

#[test]
fn values_are_shown_as_they_are_written() {
    for (from, to, expected) in [
        (
            "rod_diameter: 2.5 in",
            "rod_diameter: 0 in",
            "throws.0.rod_diameter: found '0 in', expected a length greater than 0",
        ),
        (
            "back: 0 psig",
            "back: -20 psig",
            "cylinder.back: found '-20 psig' (-36.542 kPa absolute), expected a pressure of at least 0",
        ),
        (
            "rpm: 740",
            "rpm: 0",
            "rpm: found 0, expected a rotational speed greater than 0",
        ),
    ] {
        let message = said_of(&[(from, to)]);
        assert!(message.contains(expected), "{message}");
        assert_eq!(message.lines().count(), 1, "{message}");
    }
}

#[test]
fn a_clearance_is_measured_as_its_name_says() {
    let diametral = "diametral_clearance: 0.006 in";
    let twice = SHEET.replace(diametral, "diametral_clearance: 0.006 in diametral");
    assert_eq!(resolve(&twice).machine, resolve(SHEET).machine);
    for (to, expected) in [
        (
            "diametral_clearance: 0.006 in radial",
            "found '0.006 in radial', expected a diametral clearance; a radial one belongs at the key clearance",
        ),
        (
            "radial_clearance: 0.006 in diametral",
            "found '0.006 in diametral', expected a radial clearance; a diametral one belongs at the key diametral_clearance",
        ),
        (
            "diametral_clearance: 6 in",
            "found '6 in', expected a radial clearance below journal_radius, 0.0635 m, or a diametral one below 0.127 m",
        ),
    ] {
        let message = said_of(&[(diametral, to)]);
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn a_joint_without_clearance_needs_no_contact() {
    let pin = "wrist_pin: {diameter: 3.5 in, clearance: 4 mil diametral, contact: {stiffness: 50 GN/m^1.5, damping: 2e4 N s/m, depth: 10 um}}";
    let ideal = resolve(&SHEET.replace(pin, "wrist_pin: ideal"));
    for joint in [
        "wrist_pin: {clearance: ideal}",
        "wrist_pin: {clearance: 0 mm}",
        "wrist_pin: {diameter: 3.5 in, clearance: 0 mm, normal_clearance: 0.1 mm}",
    ] {
        assert!(SHEET.contains(pin));
        assert_eq!(
            resolve(&SHEET.replace(pin, joint)).machine,
            ideal.machine,
            "{joint}"
        );
    }
    for (joint, expected) in [
        ("wrist_pin: {clearance: 0.1 mm}", "missing"),
        (
            "wrist_pin: {clearance: ideal, colour: red}",
            "colour: unknown key",
        ),
        (
            "wrist_pin: {clearance: ideal, diameter: -1 in}",
            "found '-1 in'",
        ),
    ] {
        let message = said_of(&[(pin, joint)]);
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn what_no_machine_can_be_is_refused() {
    for (from, to, expected) in [
        (
            "exponent: 1.26",
            "exponent: 126",
            "cylinder.exponent: found 126, expected a polytropic exponent up to 2",
        ),
        (
            "clearance_volume: 16 %",
            "clearance_volume: 1600 %",
            "throws.0.clearance_volume: found '1600 %', expected a percentage up to 500 %",
        ),
    ] {
        let message = said_of(&[(from, to)]);
        assert!(message.contains(expected), "{message}");
        assert_eq!(message.lines().count(), 1, "{message}");
    }
}

#[test]
fn a_tail_rod_is_no_misspelt_piston_rod() {
    for (from, to) in [
        (
            "rod_diameter: 2.5 in",
            "rod_diameter: 2.5 in, tail_rod_diameter: 2 in",
        ),
        ("back: 0 psig", "back: 0 psig, tail_rod_diameter: 2 in"),
    ] {
        let message = said_of(&[(from, to)]);
        assert!(
            message.contains("unknown key; a tail rod is not modelled: leave the key out"),
            "{message}"
        );
        assert_eq!(message.lines().count(), 1, "{message}");
    }
}

#[test]
fn a_joint_of_an_effect_has_one_name() {
    for (joint, meant) in [
        ("crosshead_pin", "small_end"),
        ("wrist_pin", "small_end"),
        ("crank_pin", "big_end"),
    ] {
        let effects =
            format!("effects:\n  - extra_clearance: {{joint: {joint}, change: 0.1 mm}}\n");
        let message = refusal(&format!("{SHEET}{effects}"));
        let expected = format!(
            "found '{joint}', expected one of main, big_end, small_end; did you mean '{meant}'?"
        );
        assert!(message.contains(&expected), "{message}");
    }
}

#[test]
fn a_misspelt_synonym_is_told_its_name() {
    let message = refusal(&METRIC.replace("STROKE", "stoke: 150 mm"));
    assert!(
        message.starts_with("m.yaml:3:1: stoke: unknown key; expected one of name, speed,"),
        "{message}"
    );
    assert!(message.ends_with("did you mean 'stroke'?"), "{message}");
    let message = refusal(
        &METRIC
            .replace("STROKE", "stroke: 150 mm")
            .replace("piston_radius: 50", "pore: 100"),
    );
    assert!(message.ends_with("did you mean 'bore'?"), "{message}");
}

#[test]
fn paths_say_which_key_a_synonym_stands_for() {
    let file =
        MachineFile::from_yaml(&METRIC.replace("STROKE", "stroke: 150 mm"), "m.yaml").unwrap();
    let message = |path: &str| {
        input::paths::keys(file.to_tree(), path)
            .unwrap_err()
            .to_string()
    };
    assert_eq!(
        message("stroke"),
        "stroke: unknown key; give crank.radius (half of the stroke)"
    );
    assert_eq!(
        message("cylinder.bore"),
        "cylinder.bore: unknown key; give cylinder.piston_radius (half of the bore)"
    );
}

/// `text` with `length` letters at `at` replaced by `insert`.
fn damaged(text: &str, at: usize, length: usize, insert: &str) -> String {
    let letters: Vec<char> = text.chars().collect();
    let at = at % letters.len();
    let end = (at + length).min(letters.len());
    let after: String = letters[end..].iter().collect();
    letters[..at].iter().collect::<String>() + insert + &after
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_damaged_data_sheet_is_a_machine_or_its_mistakes(
        at in 0usize..5000, length in 0usize..40, insert in "[ -~\n]{0,10}",
    ) {
        let text = damaged(SHEET, at, length, &insert);
        if let Err(error) = MachineFile::from_yaml(&text, "m.yaml").and_then(|file| file.resolve()) {
            let places: Vec<_> = error.into_each().iter().map(input::Error::place).collect();
            prop_assert!(!places.is_empty() && places.is_sorted());
        }
    }

    #[test]
    fn a_damaged_bundle_or_calibration_is_right_or_its_mistakes(
        at in 0usize..5000, length in 0usize..40, insert in "[ -~\n]{0,10}",
    ) {
        let bundle = input::template::bundle(&[]).unwrap();
        let calibration = input::template::calibration("b").unwrap();
        let sheet = SHEET.replace('\n', "\n  ");
        let bundle = format!("{bundle}\nmachine:\n  {sheet}");
        if let Ok(document) = input::yaml::Document::parse(&damaged(&bundle, at, length, &insert), "b.yaml") {
            let _ = input::check_bundle(Path::new("."), &document);
        }
        if let Ok(document) = input::yaml::Document::parse(&damaged(&calibration, at, length, &insert), "c.yaml") {
            let _ = input::calibration::Calibration::from_document(&document);
        }
    }
}
