//! Text with a unit: `24 GN/m^1.5` becomes an SI value and a dimension, and back.
//!
//! ```text
//! quantity = number unit          unit    = product ["/" product]
//! product  = factor {sep factor}  sep     = " " | "*" | "·"
//! factor   = [prefix] name [exponent]     exponent = "^1.5" | "²" | "2"
//! ```
//!
//! Everything after the one `/` is in the denominator. Powers of ten are moved into the decimal
//! number before it is rounded, so that `0.3 mm` is exactly the number that `0.0003` is.

pub use crate::dimension::{Dimension, Measure};

use crate::error::nearest;
use crate::kind::KINDS;
use crate::unit_table::{ABSOLUTE, COMMON, PREFIXES, SIDES, UNITS, Unit};
use scalar::Scalar;
use std::fmt;

pub(crate) use crate::unit_table::gauge;
pub use mechanism::GRAVITY;

/// Why a text is no quantity.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum UnitError {
    /// It does not begin with a number, or with one that is too large.
    #[error("no number")]
    NoNumber,
    /// A decimal comma.
    #[error("the decimal sign is a point")]
    Comma,
    /// Thousands that are set apart.
    #[error("thousands are not set apart, and the decimal sign is a point")]
    Thousands,
    /// A number that goes on in an odd way.
    #[error("the number is not understood")]
    Number,
    /// Nothing follows the number.
    #[error("no unit")]
    NoUnit,
    /// A unit that does not exist.
    #[error("there is no unit '{name}'{}", .nearest.map_or(String::new(), |n| format!("; did you mean '{n}'?")))]
    Unknown {
        /// Its name.
        name: String,
        /// The unit that was probably meant.
        nearest: Option<&'static str>,
    },
    /// A pressure over the ambient pressure, which a quantity cannot be.
    #[error(
        "{name} counts from the ambient pressure: add that and give the absolute pressure, in {absolute}; \
         the pressures of a machine's cylinders may stay if the machine has the key ambient_pressure, e.g. \
         '1.013 bar'"
    )]
    Gauge {
        /// The unit as it is written.
        name: &'static str,
        /// The unit without the reference.
        absolute: &'static str,
    },
    /// The word `radial` or `diametral` at a length that is no clearance.
    #[error("only a clearance is radial or diametral")]
    Sided,
    /// Units in a form that is not understood.
    #[error("the unit is not understood")]
    Form,
}

/// The dimension in SI units: `N/m^1.5`, `kg m^2`; `%` for a pure number.
impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        if let Some(kind) = KINDS.iter().find(|k| k.dimension == *self) {
            return f.write_str(kind.unit);
        }
        if let Some(exponent) = self.stiffness_exponent() {
            return match exponent {
                1.0 => f.write_str("N/m"),
                _ => write!(f, "N/m^{exponent}"),
            };
        }
        let mut separator = "";
        for (exponent, name) in self.exponents().into_iter().zip(["m", "kg", "s", "rad"]) {
            if exponent != 0.0 {
                write!(f, "{separator}{name}^{exponent}")?;
                separator = " ";
            }
        }
        Ok(())
    }
}

/// The shortest text that [`parse`] reads as exactly this value: `2.4e10 N/m^1.5`, `5 %`.
impl fmt::Display for Measure {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let percent = if self.dimension == Dimension::NONE {
            2
        } else {
            0
        };
        write!(f, "{} {}", decimal(self.si, percent), self.dimension)
    }
}

/// Reads a number with its unit.
///
/// # Errors
/// A text that does not begin with a number in range, or whose unit is missing or not known.
pub fn parse(text: &str) -> Result<Measure, UnitError> {
    let text = text.trim();
    let (number, rest) = split_number(text).ok_or(UnitError::NoNumber)?;
    if rest.trim().is_empty() {
        return Err(UnitError::NoUnit);
    }
    if let Some(error) = odd_end(rest) {
        return Err(error);
    }
    let scale = Scale::parse(rest)?;
    let si = scale.apply(number).ok_or(UnitError::NoNumber)?;
    Ok(Measure {
        si,
        dimension: scale.dimension,
    })
}

/// Reads an acceleration with its unit: `g` is the standard acceleration of gravity, as on the data sheets of
/// sensors, where it is a gram elsewhere.
///
/// # Errors
/// As [`parse`].
pub fn parse_acceleration(text: &str) -> Result<Measure, UnitError> {
    let gravities = text
        .trim()
        .strip_suffix('g')
        .map(|rest| match rest.strip_suffix('m') {
            Some(thousandths) => (thousandths.trim_end(), "mm/s^2"),
            None => (rest.trim_end(), "m/s^2"),
        });
    match gravities {
        Some((number, unit)) if is_number(number) => {
            let one = parse(&format!("{number} {unit}"))?;
            Ok(Measure {
                si: one.si * GRAVITY,
                ..one
            })
        }
        _ => parse(text),
    }
}

/// Reads a clearance with its unit: `0.1 mm` and `0.1 mm radial` are radial, `0.1 mm diametral` is half of that.
///
/// # Errors
/// As [`parse`].
pub fn parse_clearance(text: &str) -> Result<Measure, UnitError> {
    let text = text.trim();
    let with = |word: &str| {
        let length = text.strip_suffix(word)?;
        length.ends_with(char::is_whitespace).then_some(length)
    };
    if let Some(length) = with("radial") {
        return parse(length);
    }
    match with("diametral") {
        Some(length) => parse(length).map(|whole| Measure {
            si: whole.si / 2.0,
            ..whole
        }),
        None => parse(text),
    }
}

/// The pressure above the ambient one that a text such as `20 barg` states, Pa; none where its unit counts from
/// zero.
pub fn parse_gauge(text: &str) -> Option<f64> {
    let text = text.trim();
    let (_, unit) = split_number(text)?;
    let (_, absolute) = gauge(unit.trim())?;
    let number = &text[..text.len() - unit.len()];
    parse(&format!("{number} {absolute}")).ok().map(|p| p.si)
}

/// What is wrong with a number after which `rest` stands.
fn odd_end(rest: &str) -> Option<UnitError> {
    let mut signs = rest.chars();
    let sign = signs.next()?;
    let digits = signs.take_while(char::is_ascii_digit).count();
    match (sign, digits) {
        (',' | '\'' | '’' | '_', 3) => Some(UnitError::Thousands),
        (',', _) => Some(UnitError::Comma),
        ('.' | '\'' | '’' | '_', _) => Some(UnitError::Number),
        _ => None,
    }
}

fn is_number(text: &str) -> bool {
    split_number(text).is_some_and(|(_, rest)| rest.is_empty())
}

/// A decimal number as it is written: the digits with their point, and the power of ten.
type Decimal<'a> = (&'a str, i32);

/// The minus sign of typesetting (U+2212), which counts as a hyphen before a number.
pub(crate) const MINUS: char = '−';

/// Bytes of the sign at the start of `text`.
fn sign_length(text: &str) -> usize {
    let sign = text.chars().next();
    sign.filter(|c| ['+', '-', MINUS].contains(c))
        .map_or(0, char::len_utf8)
}

/// `text` with a hyphen for each minus sign, as programs read it.
pub(crate) fn plain_minus(text: &str) -> String {
    text.replace(MINUS, "-")
}

/// The number at the start of `text`, and what follows it.
fn split_number(text: &str) -> Option<(Decimal<'_>, &str)> {
    let digits = |from: usize| {
        let rest = &text.as_bytes()[from..];
        from + rest.iter().take_while(|b| b.is_ascii_digit()).count()
    };
    let byte = |at: usize| text.as_bytes().get(at).copied();
    let start = sign_length(text);
    let whole = digits(start);
    let end = match byte(whole) {
        Some(b'.') => digits(whole + 1),
        _ => whole,
    };
    if !text[start..end].contains(|c: char| c.is_ascii_digit()) {
        return None;
    }
    let mantissa = &text[..end];
    if matches!(byte(end), Some(b'e' | b'E')) {
        let sign = end + 1 + sign_length(&text[end + 1..]);
        let stop = digits(sign);
        if stop > sign {
            let exponent = plain_minus(&text[end + 1..stop]).parse().ok()?;
            return Some(((mantissa, exponent), &text[stop..]));
        }
    }
    Some(((mantissa, 0), &text[end..]))
}

/// The size of a unit: 10^ten × numerator / denominator SI units.
struct Scale {
    ten: f64,
    numerator: f64,
    denominator: f64,
    dimension: Dimension,
}

impl Scale {
    fn parse(text: &str) -> Result<Self, UnitError> {
        let mut scale = Self {
            ten: 0.0,
            numerator: 1.0,
            denominator: 1.0,
            dimension: Dimension::NONE,
        };
        for (i, product) in text.split('/').enumerate() {
            let power = match i {
                0 => 1.0,
                1 => -1.0,
                _ => return Err(UnitError::Form),
            };
            let separator = |c: char| c.is_whitespace() || "*·⋅".contains(c);
            let mut factors = product
                .split(separator)
                .filter(|f| !f.is_empty())
                .peekable();
            factors.peek().ok_or(UnitError::Form)?;
            for factor in factors {
                let (name, exponent) = split_exponent(factor)?;
                scale.multiply(name, power * exponent)?;
            }
        }
        Ok(scale)
    }

    fn multiply(&mut self, name: &str, power: f64) -> Result<(), UnitError> {
        let (unit, prefix) = find(name)?;
        self.ten += power * f64::from(unit.ten + prefix);
        let (above, below) = if power < 0.0 {
            (unit.denominator, unit.numerator)
        } else {
            (unit.numerator, unit.denominator)
        };
        if unit.numerator != 1.0 {
            self.numerator *= raise(above, power.abs());
            self.denominator *= raise(below, power.abs());
        }
        self.dimension = self.dimension.times(&unit.dimension, power);
        Ok(())
    }

    /// The number in SI units; none where it is not finite.
    fn apply(&self, (mantissa, exponent): Decimal) -> Option<f64> {
        let whole = self.ten.floor();
        let exponent = exponent.checked_add(whole as i32)?;
        let mantissa = plain_minus(mantissa);
        let shifted: f64 = format!("{mantissa}e{exponent}").parse().ok()?;
        let fraction = self.ten - whole;
        let shifted = if fraction == 0.0 {
            shifted
        } else {
            shifted * Scalar::powf(10.0, fraction)
        };
        let si = shifted * self.numerator / self.denominator;
        si.is_finite().then_some(si)
    }
}

fn raise(base: f64, power: f64) -> f64 {
    if power == 1.0 {
        base
    } else {
        Scalar::powf(base, power)
    }
}

/// The unit called `name`, and the power of ten of its prefix.
fn find(name: &str) -> Result<(&'static Unit, i32), UnitError> {
    let absolute = ABSOLUTE.into_iter().find(|(unit, _)| *unit == name);
    let name = absolute.map_or(name, |(_, unit)| unit);
    if let Some(unit) = UNITS.iter().find(|u| u.name == name) {
        return Ok((unit, 0));
    }
    for (prefix, ten) in PREFIXES {
        if let Some(rest) = name.strip_prefix(prefix)
            && let Some(unit) = UNITS.iter().find(|u| u.prefixed && u.name == rest)
        {
            return Ok((unit, ten));
        }
    }
    if SIDES.contains(&name) {
        return Err(UnitError::Sided);
    }
    if let Some((name, absolute)) = gauge(name) {
        return Err(UnitError::Gauge { name, absolute });
    }
    Err(UnitError::Unknown {
        name: name.chars().take(20).collect(),
        nearest: nearest(name, COMMON.into_iter().chain(SIDES)),
    })
}

/// `m^1.5`, `m²` or `m2`: the name and the exponent. A unit whose name has a digit stays whole.
fn split_exponent(factor: &str) -> Result<(&str, f64), UnitError> {
    if UNITS.iter().any(|unit| unit.name == factor) {
        return Ok((factor, 1.0));
    }
    let is_exponent = |c: char| c.is_ascii_digit() || "^⁰¹²³⁴⁵⁶⁷⁸⁹⁻".contains(c);
    let Some(split) = factor.find(is_exponent) else {
        return Ok((factor, 1.0));
    };
    let (name, exponent) = factor.split_at(split);
    let plain: String = exponent
        .strip_prefix('^')
        .unwrap_or(exponent)
        .chars()
        .map(|c| match "⁰¹²³⁴⁵⁶⁷⁸⁹⁻".chars().position(|s| s == c) {
            Some(i) => ['0', '1', '2', '3', '4', '5', '6', '7', '8', '9', '-'][i],
            None if c == MINUS => '-',
            None => c,
        })
        .collect();
    let exponent: f64 = plain.parse().map_err(|_| UnitError::Form)?;
    // Larger ones are slips of the keyboard, and would overflow the power of ten; 0 would leave the
    // unit without effect.
    if name.is_empty() || exponent.is_nan() || exponent == 0.0 || exponent.abs() > 9.0 {
        return Err(UnitError::Form);
    }
    Ok((name, exponent))
}

/// The shortest decimal text of `value` × 10^`shift`, without rounding.
fn decimal(value: f64, shift: i32) -> String {
    let scientific = format!("{value:e}");
    let Some((mantissa, exponent)) = scientific.split_once('e') else {
        return scientific;
    };
    let exponent = exponent.parse::<i32>().unwrap_or(0) + shift;
    let (sign, mantissa) = match mantissa.strip_prefix('-') {
        Some(rest) => ("-", rest),
        None => ("", mantissa),
    };
    let digits = mantissa.replace('.', "");
    match exponent {
        _ if value == 0.0 => format!("{sign}0"),
        -4..0 => {
            let zeros = "0".repeat((-exponent - 1) as usize);
            format!("{sign}0.{zeros}{digits}")
        }
        0..6 => {
            let point = exponent as usize + 1;
            if digits.len() <= point {
                format!("{sign}{digits:0<point$}")
            } else {
                format!("{sign}{}.{}", &digits[..point], &digits[point..])
            }
        }
        _ => format!("{sign}{mantissa}e{exponent}"),
    }
}
