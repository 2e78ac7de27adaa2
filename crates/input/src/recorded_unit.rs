//! Units of recordings, as instruments and loggers write them: `PSIG`, `bar(g)`, `m/sec^2`, `mils`, `mg` of an accelerometer.

use crate::dimension::Dimension;
use crate::unit::{self, GRAVITY};
use std::f64::consts::TAU;

const ACCELERATION: Dimension = Dimension::new(1.0, 0.0, -2.0, 0.0);
const ANGLE: Dimension = Dimension::new(0.0, 0.0, 0.0, 1.0);
const PRESSURE: Dimension = Dimension::new(-1.0, 1.0, -2.0, 0.0);

/// A unit of a recording.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedUnit {
    /// Its name as this program writes it, without the reference of a pressure.
    pub name: String,
    /// What it measures.
    pub dimension: Dimension,
    /// SI units in one.
    pub si: f64,
    /// Whether it is a pressure that counts from the ambient one.
    pub gauge: bool,
}

/// Units of accelerometers, in units of the standard acceleration of gravity.
const GRAVITIES: [(&str, f64); 8] = [
    ("g", 1.0),
    ("G", 1.0),
    ("g's", 1.0),
    ("mg", 1e-3),
    ("mG", 1e-3),
    ("ug", 1e-6),
    ("µg", 1e-6), // micro sign, U+00B5
    ("μg", 1e-6), // Greek mu, U+03BC
];

/// Names of angles beyond those of [`unit`], with their size, rad.
const ANGLES: [(&str, f64); 3] = [
    ("degree", TAU / 360.0),
    ("degrees", TAU / 360.0),
    ("rev", TAU),
];

/// Units whose capitals do not count.
const ANY_CASE: [&str; 28] = [
    "bar", "mbar", "psi", "ksi", "Pa", "hPa", "kPa", "MPa", "atm", "kgf/cm^2", "m/s", "mm/s",
    "cm/s", "in/s", "ft/s", "m/s^2", "mm/s^2", "in/s^2", "ft/s^2", "mm", "um", "in", "mil", "Hz",
    "kHz", "rpm", "deg", "rad",
];

/// Prefixes in capitals that are hardly meant: a megabar, megametres.
const UNCLEAR: [&str; 5] = ["Mbar", "Mm", "Mm/s", "Mm/s^2", "Mm/s2"];

/// Other names of units, in small letters.
const OTHER_NAMES: [(&str, &str); 12] = [
    ("ips", "in/s"),
    ("ips2", "in/s2"),
    ("mils", "mil"),
    ("micron", "um"),
    ("microns", "um"),
    ("µm", "um"),
    ("μm", "um"),
    ("kg/cm2", "kgf/cm2"),
    ("at", "kgf/cm2"),
    ("r/min", "rpm"),
    ("1/min", "rpm"),
    ("lb/in2", "psi"),
];

/// How a unit ends for a pressure that counts from the ambient one, in small letters.
const GAUGE_ENDINGS: [&str; 5] = ["(g)", "[g]", "gauge", "gage", "g"];

/// How a unit ends for a pressure that counts from zero, in small letters.
const ABSOLUTE_ENDINGS: [&str; 4] = ["(a)", "[a]", "abs", "a"];

/// The unit that is written so; none where it is not known. `is_acceleration` says that the channel is one: `mg` and `G`
/// are otherwise not clear, and `g` is taken for one in any case.
pub fn recorded_unit(text: &str, is_acceleration: bool) -> Option<RecordedUnit> {
    let text = text.trim();
    let gravities = GRAVITIES.iter().find(|(name, _)| *name == text);
    if let Some((name, size)) = gravities {
        let is_clear = is_acceleration || *name == "g";
        return is_clear.then(|| of(name, ACCELERATION, size * GRAVITY));
    }
    if let Some((name, size)) = ANGLES.iter().find(|(name, _)| *name == text) {
        return Some(of(name, ANGLE, *size));
    }
    // `bar g` is no product of a bar and a gram.
    pressure(text).or_else(|| plain(text))
}

fn of(name: &str, dimension: Dimension, si: f64) -> RecordedUnit {
    RecordedUnit {
        name: name.to_owned(),
        dimension,
        si,
        gauge: false,
    }
}

/// A unit without a reference.
fn plain(text: &str) -> Option<RecordedUnit> {
    let exact = |name: &str| {
        let measure = unit::parse(&format!("1 {name}")).ok()?;
        let is_size = measure.si.is_finite() && measure.si > 0.0;
        is_size.then(|| of(name, measure.dimension, measure.si))
    };
    if UNCLEAR.contains(&text) {
        return None;
    }
    let small = small(text);
    if let Some((_, name)) = OTHER_NAMES.iter().find(|(name, _)| *name == small) {
        return exact(name);
    }
    let alike = |name: &&&str| self::small(name) == small;
    exact(text).or_else(|| ANY_CASE.iter().find(alike).and_then(|name| exact(name)))
}

/// A pressure with the reference behind it.
fn pressure(text: &str) -> Option<RecordedUnit> {
    let lower = text.to_ascii_lowercase();
    let before = |ending: &&str| {
        let start = lower.strip_suffix(*ending)?.len();
        let name = text[..start].trim_end_matches([' ', '-', '_']);
        plain(name).filter(|unit| unit.dimension == PRESSURE)
    };
    let gauge = GAUGE_ENDINGS.iter().find_map(&before);
    let gauge = gauge.map(|unit| RecordedUnit {
        gauge: true,
        ..unit
    });
    gauge.or_else(|| ABSOLUTE_ENDINGS.iter().find_map(before))
}

/// A unit in small letters without what may be written in several ways.
fn small(text: &str) -> String {
    let small = text
        .to_lowercase()
        .replace(['^', '*', ' '], "")
        .replace('²', "2");
    let small = small
        .replace("inches", "in")
        .replace("inch", "in")
        .replace("/sec", "/s");
    small.replace("/s/s", "/s2")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_of_loggers_are_known() {
        let psi = 4.448_221_615_260_5 / (0.0254 * 0.0254);
        for (text, dimension, si, gauge) in [
            ("bar", PRESSURE, 1e5, false),
            ("BAR", PRESSURE, 1e5, false),
            ("mbar", PRESSURE, 1e2, false),
            ("PSI", PRESSURE, psi, false),
            ("psia", PRESSURE, psi, false),
            ("Mpa", PRESSURE, 1e6, false),
            ("kPa abs", PRESSURE, 1e3, false),
            ("bar g", PRESSURE, 1e5, true),
            ("bar(g)", PRESSURE, 1e5, true),
            ("bar (g)", PRESSURE, 1e5, true),
            ("psi g", PRESSURE, psi, true),
            ("PSIG", PRESSURE, psi, true),
            ("kPag", PRESSURE, 1e3, true),
            ("bar gauge", PRESSURE, 1e5, true),
            ("kg/cm2", PRESSURE, 98_066.5, false),
            ("kgf/cm²", PRESSURE, 98_066.5, false),
            ("kg/cm2(g)", PRESSURE, 98_066.5, true),
            ("m/s²", ACCELERATION, 1.0, false),
            ("m/s2", ACCELERATION, 1.0, false),
            ("m/sec^2", ACCELERATION, 1.0, false),
            ("M/S2", ACCELERATION, 1.0, false),
            ("m/s/s", ACCELERATION, 1.0, false),
            ("m/s**2", ACCELERATION, 1.0, false),
            ("ips", Dimension::new(1.0, 0.0, -1.0, 0.0), 0.0254, false),
            ("in/s", Dimension::new(1.0, 0.0, -1.0, 0.0), 0.0254, false),
            (
                "inch/sec",
                Dimension::new(1.0, 0.0, -1.0, 0.0),
                0.0254,
                false,
            ),
            ("mm/sec", Dimension::new(1.0, 0.0, -1.0, 0.0), 1e-3, false),
            ("mils", Dimension::new(1.0, 0.0, 0.0, 0.0), 2.54e-5, false),
            ("mil", Dimension::new(1.0, 0.0, 0.0, 0.0), 2.54e-5, false),
            ("µm", Dimension::new(1.0, 0.0, 0.0, 0.0), 1e-6, false),
            ("degrees", ANGLE, TAU / 360.0, false),
            ("%", Dimension::NONE, 0.01, false),
        ] {
            let found = recorded_unit(text, false).unwrap_or_else(|| panic!("{text}"));
            assert_eq!((found.dimension, found.gauge), (dimension, gauge), "{text}");
            assert!((found.si / si - 1.0).abs() < 1e-12, "{text}: {}", found.si);
        }
    }

    #[test]
    fn gravities_are_accelerations_where_the_channel_is_one() {
        for (text, size) in [("g", 1.0), ("G", 1.0), ("mg", 1e-3), ("µg", 1e-6)] {
            let found = recorded_unit(text, true).unwrap();
            assert_eq!(
                (found.dimension, found.si),
                (ACCELERATION, size * GRAVITY),
                "{text}"
            );
        }
        assert!(recorded_unit("g", false).is_some());
        for text in ["mg", "ug", "G"] {
            assert_eq!(recorded_unit(text, false), None, "{text}");
        }
    }

    #[test]
    fn other_units_are_not_known() {
        for text in [
            "",
            "Mbar",
            "furlong",
            "mil pk-pk",
            "mm/s rms",
            "V",
            "counts",
            "p(g)",
        ] {
            assert_eq!(recorded_unit(text, true), None, "{text}");
        }
    }
}
