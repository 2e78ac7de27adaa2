//! What a channel of a bundle is, and how its numbers become SI values.
//!
//! It follows from the column's name where this program writes such a column
//! (`throw1.crosshead_acceleration_m_s2`), else from the channel's name in words: `throw1 crosshead
//! acceleration`, `cylinder pressure`, `crank-end cylinder pressure`, `crank angle`, `tacho`, `time`.

mod channel;
mod known;
mod of_throw;
mod si;

pub use channel::Channel;
pub use known::unit_of_column;
pub(crate) use si::ambient_pressure;
pub use si::{ToSi, unit_as_stated};

use crate::error::Error;
use crate::machine_file::unit_of_quantity;
use crate::recorded_unit::recorded_unit;
use known::{Kind, Known, known, known_of_throw, words};
use mechanism::declaration::Quantity;
use of_throw::OfThrow;
use si::to_si;

/// What a channel of a recording is.
#[derive(Clone, Debug, PartialEq)]
pub enum Meaning {
    /// The time of each sample.
    Time,
    /// The angle of the crankshaft, recorded or added up.
    CrankAngle(ToSi),
    /// Pulses, one per revolution, which come when the crank stands at `at`, rad, if that is known.
    Tacho {
        /// The crank angle of a pulse.
        at: Option<f64>,
    },
    /// Something that the model predicts, under the name of its column there.
    Measured {
        /// The column, as [`Measured::column`](simulate::Measured::column) names it.
        column: String,
        /// How it becomes SI.
        to_si: ToSi,
    },
    /// Nothing that is used.
    Other,
}

/// Slips of the keyboard up to which a name is taken for a known one that is misspelt. `oil pressure`
/// is further away.
const SLIPS: usize = 2;

/// What a channel is in a machine whose throws have these names: one that is empty in a machine of one throw, and none
/// at all where the machine is not known, so that any name of a throw may stand before the rest. Mistakes stand under
/// the keys of the channel.
///
/// # Errors
/// A unit that is unknown, or of the wrong dimension for what the channel is; a gauge pressure whose
/// ambient pressure is not given; a name that is almost a known one, or a known one of a throw that the machine lacks.
pub fn meaning(channel: &Channel, throws: &[&str]) -> Result<Meaning, Error> {
    let known = known(if throws.is_empty() { &[""] } else { throws });
    let exact = known.iter().find(|(column, ..)| *column == channel.column);
    let spoken = [&channel.name, &channel.column].map(|text| words(text));
    // The name says more than the column: a crank end's pressure may stand in a column `pressure`.
    let said = |text: &String| known.iter().find(|(_, names, _)| names.contains(text));
    let found = exact.or_else(|| spoken.iter().find_map(said));
    let Some((column, _, kind)) = found else {
        return match OfThrow::of(channel) {
            Some(of_throw) if throws.is_empty() => {
                let (column, to_si) = of_throw.column(channel)?;
                Ok(Meaning::Measured { column, to_si })
            }
            Some(of_throw) => Err(of_throw.unknown(throws)),
            None => misspelt(channel, &spoken[0], &known, throws.is_empty()),
        };
    };
    Ok(match kind {
        Kind::Time => Meaning::Time,
        Kind::Tacho => Meaning::Tacho {
            at: channel.crank_angle_rad.map(|at| at.get()),
        },
        Kind::CrankAngle => Meaning::CrankAngle(to_si(channel, Quantity::Angle)?),
        Kind::Measured(quantity) => Meaning::Measured {
            column: column.clone(),
            to_si: to_si(channel, *quantity)?,
        },
    })
}

/// Refuses a name, in words, that is almost a known one; behind any name of a throw, too, where that may be any.
fn misspelt(
    channel: &Channel,
    spoken: &str,
    known: &[Known],
    any_throw: bool,
) -> Result<Meaning, Error> {
    let all = known.iter().filter_map(|(_, names, _)| names.first());
    let all: Vec<&str> = all.map(String::as_str).collect();
    if spoken.len() > 3 && all.iter().any(|name| is_near(spoken, name)) {
        return Err(Error::unknown_name("name", &channel.name, &all));
    }
    let breaks = spoken.match_indices(' ').map(|(at, _)| &spoken[at + 1..]);
    let mut rests = breaks.filter(|rest| any_throw && rest.contains(' '));
    let of_throws: Vec<String> = known_of_throw("")
        .filter_map(|(_, names, _)| names.first().cloned())
        .collect();
    let near = |rest: &str| of_throws.iter().any(|name| is_near(rest, name));
    match rests.find(|rest| near(rest)) {
        Some(rest) => {
            let names: Vec<&str> = of_throws.iter().map(String::as_str).collect();
            Err(Error::unknown_name("name", rest, &names))
        }
        None => Ok(Meaning::Other),
    }
}

/// Whether `spoken` is `name` but for a few slips of the keyboard. As many as the lengths differ by are needed at
/// least: a name may be as long as a file.
fn is_near(spoken: &str, name: &str) -> bool {
    name.len().abs_diff(spoken.len()) <= SLIPS * char::MAX.len_utf8()
        && strsim::damerau_levenshtein(spoken, name) <= SLIPS
}

/// What a column of this name and unit is called in a bundle: as its name says, else as its unit suggests in a machine of
/// one throw; none where neither says anything.
pub(crate) fn suggested_name(column: &str, unit: &str) -> Option<String> {
    let channel = Channel {
        name: String::new(),
        column: column.to_owned(),
        unit: unit.to_owned(),
        file: None,
        offset: None,
        crank_angle_rad: None,
    };
    if !matches!(meaning(&channel, &[]), Ok(Meaning::Other)) {
        return Some(words(column));
    }
    let dimension = recorded_unit(unit, true)?.dimension;
    let of = |quantity| unit_of_quantity(quantity).0 == dimension;
    let suggestions = [
        (Quantity::Acceleration, "crosshead acceleration"),
        (Quantity::Pressure, "cylinder pressure"),
        (Quantity::Angle, "crank angle"),
    ];
    let found = suggestions.iter().find(|(quantity, _)| of(*quantity));
    found.map(|(_, name)| (*name).to_owned())
}

/// Whether a channel has the time of each sample.
pub(crate) fn is_time(channel: &Channel) -> bool {
    matches!(meaning(channel, &[]), Ok(Meaning::Time))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Number;
    use crate::unit::GRAVITY;
    use std::f64::consts::TAU;

    fn channel(name: &str, column: &str, unit: &str) -> Channel {
        Channel {
            name: name.into(),
            column: column.into(),
            unit: unit.into(),
            file: None,
            offset: None,
            crank_angle_rad: None,
        }
    }

    fn column(name: &str, column: &str, unit: &str, throws: &[&str]) -> (String, f64) {
        match meaning(&channel(name, column, unit), throws).unwrap() {
            Meaning::Measured { column, to_si } => (column, to_si.scale),
            other => panic!("{name}: {other:?}"),
        }
    }

    #[test]
    fn names_and_columns_tell_what_a_channel_is() {
        let one = [""];
        let two = ["throw1", "throw2"];
        for (name, of, unit, throws, expected, scale) in [
            (
                "",
                "crosshead_acceleration_m_s2",
                "m/s2",
                &one[..],
                "crosshead_acceleration_m_s2",
                1.0,
            ),
            (
                "crosshead acceleration",
                "ch1",
                "g",
                &one,
                "crosshead_acceleration_m_s2",
                GRAVITY,
            ),
            (
                "",
                "acc [g]",
                "g",
                &one,
                "crosshead_acceleration_m_s2",
                GRAVITY,
            ),
            (
                "Cylinder Pressure",
                "p1",
                "bar",
                &one,
                "cylinder_pressure_pa",
                1e5,
            ),
            ("", "pressure_kPa", "kPa", &one, "cylinder_pressure_pa", 1e3),
            (
                "crank-end cylinder pressure",
                "pressure_psi",
                "psi",
                &one,
                "cylinder_pressure_crank_end_pa",
                4.448_221_615_260_5 / 6.4516e-4,
            ),
            (
                "throw2 crosshead acceleration",
                "b",
                "mm/s^2",
                &two,
                "throw2.crosshead_acceleration_m_s2",
                1e-3,
            ),
            (
                "crosshead acceleration",
                "1",
                "50 g",
                &one,
                "crosshead_acceleration_m_s2",
                50.0 * GRAVITY,
            ),
            (
                "throw1 cylinder pressure",
                "c",
                "MPa",
                &two,
                "throw1.cylinder_pressure_pa",
                1e6,
            ),
            (
                "throw1 guide acceleration",
                "a2",
                "g",
                &two,
                "throw1.housing_acceleration_y_m_s2",
                GRAVITY,
            ),
            (
                "Guide vibration",
                "a3",
                "mm/s2",
                &one,
                "housing_acceleration_y_m_s2",
                1e-3,
            ),
            (
                "throw2 housing acceleration x",
                "a4",
                "m/s2",
                &two,
                "throw2.housing_acceleration_x_m_s2",
                1.0,
            ),
            (
                "",
                "throw2 guide velocity [in/s]",
                "in/s",
                &two,
                "throw2.housing_velocity_y_m_s",
                0.0254,
            ),
            (
                "casing velocity",
                "v",
                "ips",
                &two,
                "frame_velocity_x_m_s",
                0.0254,
            ),
            (
                "",
                "frame_velocity_y_mm_s",
                "mm/s",
                &one,
                "frame_velocity_y_m_s",
                1e-3,
            ),
            (
                "frame acceleration x",
                "f",
                "m/s²",
                &two,
                "frame_acceleration_x_m_s2",
                1.0,
            ),
        ] {
            let (found, factor) = column(name, of, unit, throws);
            assert_eq!(found, expected, "{name} {of}");
            assert!(
                (factor / scale - 1.0).abs() < 1e-12,
                "{name} {of}: {factor}"
            );
        }
    }

    #[test]
    fn angles_times_and_pulses_are_told_apart() {
        let of = |name: &str, unit: &str| meaning(&channel(name, "x", unit), &[""]).unwrap();
        assert_eq!(of("time", "s"), Meaning::Time);
        assert_eq!(of("tacho", "V"), Meaning::Tacho { at: None });
        assert_eq!(of("oil temperature", "K"), Meaning::Other);
        let Meaning::CrankAngle(degrees) = of("crank angle", "deg") else {
            panic!("no angle");
        };
        assert!((degrees.apply(180.0) - TAU / 2.0).abs() < 1e-15);
        assert!((degrees.back(TAU) - 360.0).abs() < 1e-12);
    }

    #[test]
    fn a_gauge_pressure_needs_the_ambient_one() {
        let mut gauge = channel("cylinder pressure", "p", "psig");
        let message = meaning(&gauge, &[""]).unwrap_err().to_string();
        assert!(
            message.contains("unit: psig counts from the ambient pressure"),
            "{message}"
        );
        gauge.offset = Number::new(14.6);
        let Ok(Meaning::Measured { to_si, .. }) = meaning(&gauge, &[""]) else {
            panic!("no pressure");
        };
        // 14.6 psi is 100 663.456 Pa.
        assert!((to_si.apply(0.0) - 100_663.456).abs() < 1e-3);
    }

    #[test]
    fn a_throw_of_a_machine_that_is_not_known_may_have_any_name() {
        for (name, of, unit, expected) in [
            (
                "T1 cylinder pressure",
                "HE",
                "psi",
                Ok("T1.cylinder_pressure_pa"),
            ),
            (
                "Frame 2 crank-end cylinder pressure",
                "CE",
                "bar",
                Ok("Frame_2.cylinder_pressure_crank_end_pa"),
            ),
            (
                "",
                "T1.crosshead_acceleration_m_s2",
                "m/s2",
                Ok("T1.crosshead_acceleration_m_s2"),
            ),
            ("T1 crosshead acceleration", "a", "gee", Err("gee")),
            (
                "T1 crosshed acceleration",
                "a",
                "g",
                Err("did you mean 'crosshead acceleration'?"),
            ),
            (
                "T1 cylinder pressure",
                "HE",
                "psig",
                Err("unit: psig counts from the ambient pressure"),
            ),
        ] {
            let found = meaning(&channel(name, of, unit), &[]);
            match (found, expected) {
                (Ok(Meaning::Measured { column, .. }), Ok(expected)) => {
                    assert_eq!(column, expected);
                }
                (Err(error), Err(expected)) => {
                    assert!(error.to_string().contains(expected), "{error}");
                }
                (found, expected) => panic!("{name} {of}: {found:?}, not {expected:?}"),
            }
        }
    }

    #[test]
    fn a_throw_that_the_machine_lacks_is_told() {
        let two = ["T1", "T2"];
        for (name, of, throws, expected) in [
            (
                "T9 cylinder pressure",
                "HE",
                &two[..],
                "name: found 'T9', expected one of T1, T2",
            ),
            (
                "",
                "throw1.cylinder_pressure_pa",
                &two,
                "column: found 'throw1', expected one of T1, T2",
            ),
            (
                "cylinder pressure",
                "HE",
                &two,
                "the name of a throw before it, one of T1, T2",
            ),
            (
                "T1 cylinder pressure",
                "HE",
                &[""],
                "expected 'cylinder pressure': the machine has one throw",
            ),
        ] {
            let error = meaning(&channel(name, of, "Pa"), throws).unwrap_err();
            assert!(error.to_string().contains(expected), "{error}");
        }
        // What is no channel of a throw is none of a throw that is not there.
        for name in ["oil pressure", "T9 oil pressure", "suction pressure"] {
            assert_eq!(
                meaning(&channel(name, "x", "bar"), &two),
                Ok(Meaning::Other)
            );
        }
    }

    #[test]
    fn a_unit_holds_whatever_the_name_says() {
        for (unit, offset, expected) in [
            ("psig", Some(14.4), ("psi", 14.4)),
            ("psig", None, ("psig", 0.0)),
            ("psi", Some(14.4), ("psi", 14.4)),
            ("V", None, ("V", 0.0)),
        ] {
            let mut channel = channel("oil pressure", "x", unit);
            channel.offset = offset.and_then(Number::new);
            assert_eq!(unit_as_stated(&channel), expected);
        }
    }

    #[test]
    fn wrong_channels_are_told() {
        for (name, unit, expected) in [
            (
                "crosshead acceleration",
                "Pa",
                "unit: found 'Pa', expected an acceleration",
            ),
            (
                "crosshead acceleration",
                "m/z2",
                "unit: there is no unit 'z'",
            ),
            (
                "crosshead acceleration",
                "",
                "unit: no unit; expected an acceleration",
            ),
            (
                "crosshed acceleration",
                "m/s2",
                "did you mean 'crosshead acceleration'?",
            ),
        ] {
            let message = meaning(&channel(name, "x", unit), &[""])
                .unwrap_err()
                .to_string();
            assert!(message.contains(expected), "{message}");
        }
    }
}
