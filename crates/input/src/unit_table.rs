//! The units that files may have.

use crate::dimension::Dimension;
use mechanism::GRAVITY;
use std::f64::consts::PI;

/// A unit.
pub(crate) struct Unit {
    /// Its name.
    pub(crate) name: &'static str,
    /// Whether it takes prefixes.
    pub(crate) prefixed: bool,
    /// Its size: 10^ten × numerator / denominator SI units.
    pub(crate) ten: i32,
    pub(crate) numerator: f64,
    pub(crate) denominator: f64,
    pub(crate) dimension: Dimension,
}

const fn unit(name: &'static str, prefixed: bool, ten: i32, dimension: Dimension) -> Unit {
    Unit {
        name,
        prefixed,
        ten,
        numerator: 1.0,
        denominator: 1.0,
        dimension,
    }
}

const fn odd(name: &'static str, numerator: f64, denominator: f64, dimension: Dimension) -> Unit {
    Unit {
        numerator,
        denominator,
        ..unit(name, false, 0, dimension)
    }
}

/// An inch and a foot, m; a pound, kg; a pound-force, 0.45359237 kg × 9.80665 m/s², in N (NIST Special Publication 811).
const INCH: f64 = 0.0254;
const FOOT: f64 = 0.3048;
const POUND: f64 = 0.453_592_37;
const POUND_FORCE: f64 = 4.448_221_615_260_5;

/// All of them.
pub(crate) const UNITS: [Unit; 40] = [
    unit("m", true, 0, Dimension::new(1.0, 0.0, 0.0, 0.0)),
    unit("g", true, -3, Dimension::new(0.0, 1.0, 0.0, 0.0)),
    unit("t", false, 3, Dimension::new(0.0, 1.0, 0.0, 0.0)),
    unit("s", true, 0, Dimension::new(0.0, 0.0, 1.0, 0.0)),
    odd("min", 60.0, 1.0, Dimension::new(0.0, 0.0, 1.0, 0.0)),
    odd("h", 3600.0, 1.0, Dimension::new(0.0, 0.0, 1.0, 0.0)),
    unit("rad", true, 0, Dimension::new(0.0, 0.0, 0.0, 1.0)),
    odd("deg", PI, 180.0, Dimension::new(0.0, 0.0, 0.0, 1.0)),
    odd("°", PI, 180.0, Dimension::new(0.0, 0.0, 0.0, 1.0)),
    odd("rpm", PI, 30.0, Dimension::new(0.0, 0.0, -1.0, 1.0)),
    unit("Hz", true, 0, Dimension::new(0.0, 0.0, -1.0, 0.0)),
    unit("N", true, 0, Dimension::new(1.0, 1.0, -2.0, 0.0)),
    unit("J", true, 0, Dimension::new(2.0, 1.0, -2.0, 0.0)),
    unit("W", true, 0, Dimension::new(2.0, 1.0, -3.0, 0.0)),
    unit("Pa", true, 0, Dimension::new(-1.0, 1.0, -2.0, 0.0)),
    unit("bar", true, 5, Dimension::new(-1.0, 1.0, -2.0, 0.0)),
    // A pound-force per square inch.
    odd(
        "psi",
        POUND_FORCE,
        INCH * INCH,
        Dimension::new(-1.0, 1.0, -2.0, 0.0),
    ),
    odd(
        "ksi",
        1e3 * POUND_FORCE,
        INCH * INCH,
        Dimension::new(-1.0, 1.0, -2.0, 0.0),
    ),
    odd("in", INCH, 1.0, Dimension::new(1.0, 0.0, 0.0, 0.0)),
    odd("inch", INCH, 1.0, Dimension::new(1.0, 0.0, 0.0, 0.0)),
    odd("inches", INCH, 1.0, Dimension::new(1.0, 0.0, 0.0, 0.0)),
    // A thousandth of an inch.
    odd("mil", INCH, 1e3, Dimension::new(1.0, 0.0, 0.0, 0.0)),
    odd("mils", INCH, 1e3, Dimension::new(1.0, 0.0, 0.0, 0.0)),
    odd("thou", INCH, 1e3, Dimension::new(1.0, 0.0, 0.0, 0.0)),
    odd("ft", FOOT, 1.0, Dimension::new(1.0, 0.0, 0.0, 0.0)),
    odd("foot", FOOT, 1.0, Dimension::new(1.0, 0.0, 0.0, 0.0)),
    odd("feet", FOOT, 1.0, Dimension::new(1.0, 0.0, 0.0, 0.0)),
    odd("lb", POUND, 1.0, Dimension::new(0.0, 1.0, 0.0, 0.0)),
    odd("lbs", POUND, 1.0, Dimension::new(0.0, 1.0, 0.0, 0.0)),
    odd("pounds", POUND, 1.0, Dimension::new(0.0, 1.0, 0.0, 0.0)),
    odd("lbm", POUND, 1.0, Dimension::new(0.0, 1.0, 0.0, 0.0)),
    odd("lbf", POUND_FORCE, 1.0, Dimension::new(1.0, 1.0, -2.0, 0.0)),
    odd("kgf", GRAVITY, 1.0, Dimension::new(1.0, 1.0, -2.0, 0.0)),
    // The mechanical one: 550 foot-pounds-force a second.
    odd(
        "hp",
        550.0 * FOOT * POUND_FORCE,
        1.0,
        Dimension::new(2.0, 1.0, -3.0, 0.0),
    ),
    odd("atm", 101_325.0, 1.0, Dimension::new(-1.0, 1.0, -2.0, 0.0)),
    odd("gn", GRAVITY, 1.0, Dimension::new(1.0, 0.0, -2.0, 0.0)),
    odd("g0", GRAVITY, 1.0, Dimension::new(1.0, 0.0, -2.0, 0.0)),
    unit("%", false, -2, Dimension::NONE),
    unit("‰", false, -3, Dimension::NONE),
    unit("1", false, 0, Dimension::NONE),
];

/// Prefixes, and the power of ten of each.
pub(crate) const PREFIXES: [(char, i32); 11] = [
    ('n', -9),
    ('u', -6),
    ('µ', -6), // micro sign, U+00B5
    ('μ', -6), // Greek mu, U+03BC
    ('m', -3),
    ('c', -2),
    ('d', -1),
    ('h', 2),
    ('k', 3),
    ('M', 6),
    ('G', 9),
];

/// Pressure units that name the absolute reference, and the unit that each is.
pub(crate) const ABSOLUTE: [(&str, &str); 8] = [
    ("bara", "bar"),
    ("bar(a)", "bar"),
    ("psia", "psi"),
    ("psi(a)", "psi"),
    ("kPaa", "kPa"),
    ("kPa(a)", "kPa"),
    ("MPaa", "MPa"),
    ("MPa(a)", "MPa"),
];

/// Pressure units over the ambient pressure, and the unit that each is one of.
const GAUGE: [(&str, &str); 10] = [
    ("mbarg", "mbar"),
    ("mbar(g)", "mbar"),
    ("barg", "bar"),
    ("bar(g)", "bar"),
    ("psig", "psi"),
    ("psi(g)", "psi"),
    ("kPag", "kPa"),
    ("kPa(g)", "kPa"),
    ("MPag", "MPa"),
    ("MPa(g)", "MPa"),
];

/// Words that say how a clearance is measured.
pub(crate) const SIDES: [&str; 2] = ["radial", "diametral"];

/// A gauge pressure's unit with the unit that it is one of, if `name` is one; capitals do not count.
pub(crate) fn gauge(name: &str) -> Option<(&'static str, &'static str)> {
    let mut units = GAUGE.into_iter();
    units.find(|(gauge, _)| gauge.eq_ignore_ascii_case(name))
}

/// Names that are suggested for a misspelt one.
pub(crate) const COMMON: [&str; 42] = [
    "m", "mm", "um", "cm", "kg", "g", "t", "s", "ms", "min", "h", "rad", "deg", "rpm", "Hz", "kHz",
    "N", "kN", "MN", "GN", "J", "kJ", "W", "kW", "Pa", "kPa", "MPa", "GPa", "bar", "mbar", "psi",
    "atm", "in", "inch", "ft", "lb", "lbf", "kgf", "hp", "mil", "ksi", "%",
];
