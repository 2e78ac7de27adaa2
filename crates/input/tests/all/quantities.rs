//! Quantities: what texts mean, exactly, and that nothing a person types is a crash.

use input::machine_file::MachineFile;
use input::quantity::{
    Acceleration, Angle, Damping, Force, ForcePerPressure, Frequency, Inertia, Kind, Length, Mass,
    NonNegative, Number, Positive, Pressure, Quantity, Ratio, Speed, Torque, TorqueSlope, Velocity,
};
use input::unit::{Dimension, Measure, UnitError, parse};
use input::{paths, yaml};
use proptest::prelude::*;
use serde_json::{Value, json};
use std::f64::consts::PI;

fn si(text: &str) -> f64 {
    parse(text).unwrap_or_else(|e| panic!("{text}: {e}")).si
}

#[test]
fn texts_mean_exactly_their_decimal_number() {
    for (text, value) in [
        ("120 mm", 0.12),
        ("0.3 mm", 0.0003),
        ("10 um", 1e-5),
        ("10 µm", 1e-5),
        ("10 μm", 1e-5),
        ("1.1 cm", 0.011),
        ("0.393 MPa", 393e3),
        ("3.93 bar", 393e3),
        ("24 GN/m^1.5", 2.4e10),
        ("2e4 N s/m", 2e4),
        ("10 kHz", 1e4),
        ("5 %", 0.05),
        ("12 kg", 12.0),
        ("300 g", 0.3),
        ("1.2 t", 1200.0),
        ("0.6 kg m^2", 0.6),
        ("0.6 kg m2", 0.6),
        ("0.6 kg·m²", 0.6),
        ("0.6 kg*m²", 0.6),
        ("6000 kg cm^2", 0.6),
        ("60 N·m", 60.0),
        ("9.81 m/s^2", 9.81),
        ("9.81 m/s²", 9.81),
        ("9.81 m s⁻²", 9.81),
        ("9.81 m s^-2", 9.81),
        ("8 1/s", 8.0),
        ("-90 deg", -90.0 * PI / 180.0),
        ("+.5 °", 0.5 * PI / 180.0),
        ("500 rpm", 500.0 * PI / 30.0),
        ("2 min", 120.0),
        ("120mm", 0.12),
        (" 1.5E-3  m ", 1.5e-3),
        ("1 N/mm", 1000.0),
        ("0 Pa", 0.0),
        ("3 bara", 3e5),
        ("3 bar(a)", 3e5),
        ("−90 m", -90.0),
        ("−1.5e−3 m", -1.5e-3),
        ("2 m^−1", 2.0),
        ("20 gn", 20.0 * 9.80665),
        ("20 g0", 20.0 * 9.80665),
    ] {
        assert_eq!(si(text), value, "{text}");
    }
    // Pounds per square inch: NIST Special Publication 811, appendix B.8.
    for text in ["100 psi", "100 psia"] {
        assert!((si(text) / 689_475.7 - 1.0).abs() < 1e-7, "{text}");
    }
    // A fractional power of a prefix is no power of ten: 1 N/mm^1.5 = 10^4.5 N/m^1.5.
    assert!((si("1 N/mm^1.5") / 10f64.powf(4.5) - 1.0).abs() < 1e-15);
}

#[test]
fn texts_that_are_no_quantities() {
    let unknown = |name: &str, nearest| UnitError::Unknown {
        name: name.to_owned(),
        nearest,
    };
    for (text, error) in [
        ("", UnitError::NoNumber),
        ("mm", UnitError::NoNumber),
        ("-", UnitError::NoNumber),
        (". m", UnitError::NoNumber),
        ("1e999 m", UnitError::NoNumber),
        ("1e99999999999 m", UnitError::NoNumber),
        ("12", UnitError::NoUnit),
        ("1 m/", UnitError::Form),
        ("1 /s", UnitError::Form),
        ("1 m/s/s", UnitError::Form),
        ("1 m^", UnitError::Form),
        ("1 m^^2", UnitError::Form),
        ("1 m^1e9", UnitError::Form),
        ("1 m^nan", UnitError::Form),
        ("1 ^2", UnitError::Form),
        ("0,1 mm", UnitError::Comma),
        ("5 RPM", unknown("RPM", Some("rpm"))),
        ("5 hz", unknown("hz", Some("Hz"))),
        ("5 inchs", unknown("inchs", Some("inch"))),
        ("−", UnitError::NoNumber),
        ("5 krpm", unknown("krpm", Some("rpm"))),
    ] {
        assert_eq!(parse(text), Err(error), "{text}");
    }
}

#[test]
fn dimensions_tell_quantities_apart() {
    assert!(Positive::<Length>::parse("5 kg").is_err());
    assert!(Positive::<Speed>::parse("8 Hz").is_err());
    assert!(Positive::<Frequency>::parse("500 rpm").is_err());
    assert!(Positive::<Mass>::parse("-5 kg").is_err());
    assert!(Positive::<Mass>::parse("0 kg").is_err());
    assert!(NonNegative::<Mass>::parse("0 kg").is_ok());
    assert!(Quantity::<Ratio>::parse("0.05").is_err());
    assert_eq!(
        parse("24 GN/m^1.5").unwrap().dimension.stiffness_exponent(),
        Some(1.5)
    );
    assert_eq!(
        parse("1 GN/m^1.1").unwrap().dimension.stiffness_exponent(),
        Some(1.1)
    );
    assert_eq!(parse("1 kg").unwrap().dimension.stiffness_exponent(), None);
}

#[test]
fn values_are_written_short_and_in_si() {
    let text = |si, dimension| Measure { si, dimension }.to_string();
    assert_eq!(text(0.0001, Dimension::new(1.0, 0.0, 0.0, 0.0)), "0.0001 m");
    assert_eq!(text(-0.25, Dimension::new(0.0, 0.0, 0.0, 1.0)), "-0.25 rad");
    assert_eq!(text(2.4e10, Dimension::stiffness(1.5)), "2.4e10 N/m^1.5");
    assert_eq!(text(2.4e8, Dimension::stiffness(1.0)), "2.4e8 N/m");
    assert_eq!(text(0.05, Dimension::NONE), "5 %");
    assert_eq!(text(0.005, Dimension::NONE), "0.5 %");
    assert_eq!(
        text(105e3, Dimension::new(-1.0, 1.0, -2.0, 0.0)),
        "105000 Pa"
    );
    assert_eq!(
        text(1234.5, Dimension::new(0.0, 0.0, 2.0, -1.0)),
        "1234.5 s^2 rad^-1"
    );
}

/// What is written of a value reads back as that value, bit by bit.
fn round_trip<K: Kind>(value: f64) {
    let quantity = Quantity::<K>::new(value).unwrap();
    let text = quantity.to_string();
    let again = Quantity::<K>::parse(&text).unwrap();
    assert_eq!(again.si().to_bits(), value.to_bits(), "{text}");
    let tree = serde_json::to_value(quantity).unwrap();
    assert_eq!(tree, json!(text));
}

fn finite() -> impl Strategy<Value = f64> {
    use proptest::num::f64::{NEGATIVE, NORMAL, POSITIVE, SUBNORMAL, ZERO};
    // Percentages above 1e306 cannot be written in percent.
    (POSITIVE | NEGATIVE | NORMAL | SUBNORMAL | ZERO).prop_filter("in range", |x| x.abs() < 1e300)
}

proptest! {
    #[test]
    fn every_kind_round_trips(value in finite()) {
        round_trip::<Length>(value);
        round_trip::<Mass>(value);
        round_trip::<Angle>(value);
        round_trip::<Speed>(value);
        round_trip::<Frequency>(value);
        round_trip::<Velocity>(value);
        round_trip::<Acceleration>(value);
        round_trip::<Force>(value);
        round_trip::<Torque>(value);
        round_trip::<TorqueSlope>(value);
        round_trip::<Pressure>(value);
        round_trip::<Inertia>(value);
        round_trip::<Damping>(value);
        round_trip::<ForcePerPressure>(value);
        round_trip::<Ratio>(value);
    }

    #[test]
    fn every_dimension_round_trips(
        value in finite(),
        halves in prop::array::uniform4(-6i8..=6),
    ) {
        let [length, mass, time, angle] = halves.map(|n| f64::from(n) / 2.0);
        let measure = Measure { si: value, dimension: Dimension::new(length, mass, time, angle) };
        prop_assert_eq!(parse(&measure.to_string()), Ok(measure));
    }

    #[test]
    fn prefixes_shift_the_decimal_point_without_rounding(
        digits in 1u64..=u64::MAX, exponent in -20i32..20,
        prefix in prop::sample::select(vec![("n", -9), ("u", -6), ("m", -3), ("c", -2), ("k", 3), ("M", 6), ("G", 9)]),
    ) {
        let (prefix, ten) = prefix;
        let expected: f64 = format!("{digits}e{}", exponent + ten).parse().unwrap();
        prop_assert_eq!(si(&format!("{digits}e{exponent} {prefix}m")), expected);
    }

    #[test]
    fn numbers_round_trip_through_yaml(value in finite()) {
        let text = yaml::to_string(&json!({"x": value})).unwrap();
        #[derive(serde::Deserialize, schemars::JsonSchema)]
        struct File { x: Number }
        let file: File = yaml::from_str(&text, "n.yaml").unwrap();
        prop_assert_eq!(file.x.get(), value);
    }

    #[test]
    fn any_text_is_a_quantity_or_a_message(text in ".{0,40}") {
        let _ = parse(&text);
        let _ = Positive::<Length>::parse(&text);
    }

    #[test]
    fn any_units_are_a_quantity_or_a_message(text in "[-+0-9.e]{1,6} [a-zA-Zµ°%^²⁻/·* 0-9.-]{0,12}") {
        let _ = parse(&text);
    }

    #[test]
    fn any_text_is_a_machine_or_one_line(text in "(?s).{0,200}") {
        one_line(&text);
    }

    #[test]
    fn any_yaml_is_a_machine_or_one_line(text in "([a-e?:{}\\[\\],&*!|>'\"%@ \n#0-9-]|: |\n  |\n- ){0,60}") {
        one_line(&text);
    }

    #[test]
    fn a_damaged_machine_is_a_machine_or_one_line(
        at in 0usize..6000, length in 0usize..40, insert in "[ -~\n]{0,10}",
    ) {
        let text = include_str!("../../../../data/machines/single-stage.yaml");
        let letters: Vec<char> = text.chars().collect();
        let at = at.min(letters.len());
        let end = (at + length).min(letters.len());
        let damaged: String = letters[..at].iter().copied()
            .chain(insert.chars())
            .chain(letters[end..].iter().copied())
            .collect();
        one_line(&damaged);
    }

    #[test]
    fn any_path_and_value_leave_a_machine_or_one_line(
        path in "(joints|throws|sensors|effects|crank|gravity|rod|0|x)(\\.(big_end|main|contact|law|clearance|drive|free|0|noise|rms|mass|direction|)){0,5}",
        value in prop::sample::select(vec![json!(null), json!(1), json!("1 mm"), json!([]), json!({}), json!("ideal"), json!([{"name": 3}]), json!({"law": {}})]),
    ) {
        let text = include_str!("../../../../data/machines/single-stage.yaml");
        let mut tree: Value = yaml::Document::parse(text, "m.yaml").unwrap().tree;
        let _ = paths::get(&tree, &path);
        if paths::set(&mut tree, &path, value.clone()).is_ok() {
            prop_assert_eq!(paths::get(&tree, &path).unwrap(), Some(&value));
        }
        if let Err(error) = MachineFile::from_tree(&tree).and_then(|file| file.resolve()) {
            let lines = error.to_string().lines().count();
            prop_assert_eq!(lines, error.into_each().len());
        }
    }
}

fn one_line(text: &str) {
    if let Err(error) = MachineFile::from_yaml(text, "m.yaml").and_then(|file| file.resolve()) {
        // A line for each mistake, in the order of the file.
        let message = error.to_string();
        let mistakes = error.into_each();
        assert_eq!(message.lines().count(), mistakes.len(), "{message:?}");
        assert!(
            message.lines().all(|line| line.starts_with("m.yaml:")),
            "{message}"
        );
        let places: Vec<_> = mistakes.iter().map(input::Error::place).collect();
        assert!(places.is_sorted(), "{message}");
    }
}

#[test]
fn a_gauge_pressure_is_told_from_an_absolute_one() {
    for (text, unit, absolute) in [
        ("3.4 barg", "barg", "bar"),
        ("50 psig", "psig", "psi"),
        ("50 PSIG", "psig", "psi"),
        ("340 kPa(g)", "kPa(g)", "kPa"),
    ] {
        let message = Quantity::<Pressure>::parse(text).unwrap_err();
        let expected = format!("{unit} counts from the ambient pressure");
        assert!(message.contains(&expected), "{message}");
        assert!(message.contains(&format!("in {absolute}")), "{message}");
        assert!(!message.contains("did you mean"), "{message}");
    }
}

#[test]
fn a_unit_to_the_power_of_0_is_none() {
    for text in ["3 m0", "3 m^0", "3 Pa⁰"] {
        assert_eq!(parse(text), Err(UnitError::Form), "{text}");
    }
}
