//! Units of measured channels: what a file says becomes SI, so that features compare.

use input::bundle_channel::ToSi;
use input::recorded_unit::recorded_unit;
use input::unit::Dimension;
use recordings::measured::{MeasuredChannel, stem};

/// Units of channels that stay as they are: electrical ones and temperatures.
const STAY: [&str; 13] = [
    "V", "mV", "µV", "uV", "kV", "A", "mA", "Ohm", "Ω", "K", "°C", "degC", "°F",
];

/// A channel as the features take it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Scaled {
    /// Name without its unit.
    pub(super) name: String,
    /// The model's column of it, where a bundle states what it is.
    pub(super) column: Option<String>,
    /// Unit as the features know it, empty where it is not known.
    pub(super) unit: String,
    /// How its numbers become those of the unit.
    pub(super) to_si: ToSi,
    /// What it is for.
    pub(super) role: Role,
    /// Why its numbers are not in SI, where its unit is one that should be.
    pub(super) not_si: Option<String>,
}

/// What a channel is for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Role {
    /// It has features.
    Measured,
    /// The crank angle, with its reading at top dead centre, rad, if that is known.
    CrankAngle { top_dead_centre: Option<f64> },
    /// Pulses once per revolution, with the angle from a pulse to top dead centre, rad, if that is known.
    Tacho { top_dead_centre: Option<f64> },
    /// A crank angle too, but another channel is used for it.
    Unused,
}

impl Scaled {
    /// The channel that gives the crank angle.
    pub(super) fn reference(role: Role, to_si: ToSi) -> Self {
        Self {
            name: "crank_angle".to_owned(),
            column: None,
            unit: "rad".to_owned(),
            to_si,
            role,
            not_si: None,
        }
    }

    /// A sample in SI.
    pub(super) fn in_si(&self, sample: f64) -> f32 {
        match self.to_si {
            ToSi {
                offset: 0.0,
                scale: 1.0,
            } => sample as f32,
            to_si => to_si.apply(sample) as f32,
        }
    }
}

/// The unit of channels without one.
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// What 1 in the file is, in `si`.
    factor: f64,
    /// The unit, as the features know it.
    si: String,
}

impl Unit {
    /// A unit (`m/s^2`), or how much one unit of the file is (`100 m/s^2`); none for any other text.
    pub fn parse(text: &str) -> Option<Self> {
        let text = text.trim();
        let split = text.find(|c: char| !(c.is_ascii_digit() || "+-.eE".contains(c)));
        let (number, unit) = text.split_at(split.unwrap_or(text.len()));
        let amount: f64 = match number {
            "" => 1.0,
            number => number.parse().ok()?,
        };
        let unit = unit.trim();
        let Some(InSi::Times(factor, si)) = in_si(unit, unit != "G") else {
            return None;
        };
        let is_amount = amount.is_finite() && amount != 0.0;
        is_amount.then_some(Self {
            factor: amount * factor,
            si,
        })
    }
}

/// The channel in SI; `default` is the unit where it has none.
pub(super) fn scaled(channel: &MeasuredChannel, default: Option<&Unit>) -> Result<Scaled, String> {
    let base = stem(&channel.name);
    if base.eq_ignore_ascii_case("crank_angle") {
        return crank_angle(channel);
    }
    let mut not_si = None;
    let (name, factor, unit) = match (&channel.unit, default) {
        (Some(unit), _) => match in_si(unit, is_acceleration(&channel.name)) {
            Some(InSi::Times(factor, si)) => (base, factor, si),
            Some(InSi::Gauge(name)) => {
                not_si = Some(format!("{unit} counts from the ambient pressure"));
                (base, 1.0, name)
            }
            None => {
                let is_known = STAY.contains(&unit.as_str());
                not_si = (!is_known).then(|| format!("the unit {unit} is not known"));
                (base, 1.0, unit.clone())
            }
        },
        (None, Some(unit)) => (channel.name.as_str(), unit.factor, unit.si.clone()),
        (None, None) => (channel.name.as_str(), 1.0, String::new()),
    };
    Ok(Scaled {
        name: name.to_owned(),
        column: None,
        unit,
        to_si: times(factor),
        role: Role::Measured,
        not_si,
    })
}

/// Whether a channel is an acceleration by its name.
fn is_acceleration(name: &str) -> bool {
    let lower = name.to_lowercase();
    let mut words = lower.split(|c: char| !c.is_alphabetic());
    let starts = |word: &str| {
        ["accel", "vibr", "beschl"]
            .iter()
            .any(|begin| word.starts_with(begin))
    };
    words.any(|word| ["acc", "vib"].contains(&word) || starts(word))
}

fn times(scale: f64) -> ToSi {
    ToSi { offset: 0.0, scale }
}

fn crank_angle(channel: &MeasuredChannel) -> Result<Scaled, String> {
    let factor = match channel.unit.as_deref() {
        Some("rad") => 1.0,
        Some("deg" | "°") => std::f64::consts::PI / 180.0,
        _ => {
            return Err(format!(
                "column `{}`: a crank angle is called crank_angle_rad or crank_angle_deg",
                channel.column
            ));
        }
    };
    let role = Role::CrankAngle {
        top_dead_centre: Some(0.0),
    };
    Ok(Scaled::reference(role, times(factor)))
}

/// What a unit becomes.
enum InSi {
    /// So many of a unit of SI.
    Times(f64, String),
    /// A pressure that counts from the ambient one: it stays in this unit.
    Gauge(String),
}

/// What a unit becomes; none where it is not known. Speeds stay in rpm, as the field has them, and shares in %.
fn in_si(unit: &str, is_acceleration: bool) -> Option<InSi> {
    if unit == "%" {
        return Some(InSi::Times(1.0, unit.to_owned()));
    }
    let found = recorded_unit(unit, is_acceleration)?;
    Some(match (found.name.as_str(), found.dimension) {
        (name, _) if found.gauge => InSi::Gauge(format!("{name}g")),
        ("rpm", _) => InSi::Times(1.0, found.name),
        (_, dimension) if dimension == Dimension::NONE => InSi::Times(found.si, "1".to_owned()),
        (_, dimension) => InSi::Times(found.si, dimension.to_string()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn channel(name: &str, unit: Option<&str>) -> MeasuredChannel {
        MeasuredChannel {
            column: name.to_owned(),
            name: name.to_owned(),
            unit: unit.map(str::to_owned),
        }
    }

    #[test]
    fn units_become_si() {
        for (name, unit, expected) in [
            ("acc_m_s2", Some("m/s2"), ("acc", "m/s^2", 1.0)),
            ("acc_g", Some("g"), ("acc", "m/s^2", 9.80665)),
            ("p", Some("bar"), ("p", "Pa", 1e5)),
            ("p", Some("PSI"), ("p", "Pa", 6_894.757_293_168_361)),
            ("p", Some("Mpa"), ("p", "Pa", 1e6)),
            ("p", Some("bar g"), ("p", "barg", 1.0)),
            ("acc", Some("mg"), ("acc", "m/s^2", 9.80665e-3)),
            ("Vibration 1", Some("G"), ("Vibration 1", "m/s^2", 9.80665)),
            ("XH Accel", Some("m/sec^2"), ("XH Accel", "m/s^2", 1.0)),
            ("oil", Some("mg"), ("oil", "mg", 1.0)),
            ("v", Some("ips"), ("v", "m/s", 0.0254)),
            ("load", Some("%"), ("load", "%", 1.0)),
            ("ratio", Some("1"), ("ratio", "1", 1.0)),
            ("ratio", Some("‰"), ("ratio", "1", 1e-3)),
            ("v_mm_s", Some("mm/s"), ("v", "m/s", 1e-3)),
            ("u", Some("V"), ("u", "V", 1.0)),
            ("u", None, ("u", "", 1.0)),
            ("speed_rpm", Some("rpm"), ("speed", "rpm", 1.0)),
        ] {
            let found = scaled(&channel(name, unit), None).unwrap();
            assert_eq!(
                (found.name.as_str(), found.unit.as_str(), found.to_si.scale),
                expected
            );
        }
        let angle = scaled(&channel("crank_angle_deg", Some("deg")), None).unwrap();
        assert!(matches!(angle.role, Role::CrankAngle { .. }));
        assert!((angle.to_si.apply(180.0) - std::f64::consts::PI).abs() < 1e-15);
        assert!(scaled(&channel("crank_angle", None), None).is_err());
    }

    #[test]
    fn what_is_not_in_si_says_why() {
        for (name, unit, why) in [
            ("acc", Some("mg"), None),
            ("u", Some("V"), None),
            ("load", Some("%"), None),
            ("mass", Some("kg"), None),
            ("x", Some("mg"), Some("the unit mg is not known")),
            ("field", Some("G"), Some("the unit G is not known")),
            (
                "d",
                Some("mil pk-pk"),
                Some("the unit mil pk-pk is not known"),
            ),
            (
                "p",
                Some("PSIG"),
                Some("PSIG counts from the ambient pressure"),
            ),
        ] {
            let found = scaled(&channel(name, unit), None).unwrap();
            assert_eq!(found.not_si.as_deref(), why, "{name}");
        }
    }

    #[test]
    fn a_unit_is_a_name_or_an_amount() {
        for (text, factor, si) in [
            ("m/s^2", 1.0, "m/s^2"),
            ("100 m/s^2", 100.0, "m/s^2"),
            ("2.5 bar", 2.5e5, "Pa"),
            ("mg", 9.80665e-3, "m/s^2"),
        ] {
            let si = si.to_owned();
            assert_eq!(Unit::parse(text), Some(Unit { factor, si }));
        }
        for wrong in ["", "7", "0 Pa", "nonsense", "1 / m", "G", "barg"] {
            assert_eq!(Unit::parse(wrong), None, "{wrong}");
        }
    }
}
