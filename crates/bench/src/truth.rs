//! The hidden truth of a recorded machine: its contacts and its effects.

use crate::error::Error;
use crate::machine::Machine;
use calibrate::{Parameter, Relation};
use input::effects::{self, Entry, Proposal};
use input::paths;
use rand::RngExt;
use rand::seq::IndexedRandom;
use scalar::random::Stream;
use serde_json::{Map, Value};

/// True contact parameters over their nominal values.
const CONTACT: [f64; 2] = [0.6, 1.4];
/// Amplitudes and constants differ from their usual values by up to this factor.
const AMPLITUDE: f64 = 1.25;
const CONSTANT: f64 = 1.5;
/// Coefficients of restitution of the other contact law.
const RESTITUTION: [f64; 2] = [0.3, 0.7];
/// Frequencies of mains, Hz, and the share by which a grid is off at most.
const MAINS: [f64; 2] = [50.0, 60.0];
const GRID: f64 = 0.002;
/// Values that a data sheet may have wrong, with their usual error (a share), and by how many of these they are off.
const SHEET: [(&str, f64); 4] = [
    ("rod.length", 0.01),
    ("rod.mass", 0.05),
    ("rod.inertia", 0.1),
    ("crosshead.mass", 0.05),
];
const WRONG: [f64; 2] = [0.7, 1.5];
/// Terms of a law: a force of many has none.
const TERMS: usize = 2;
/// Terms that named effects make: misalignment, and friction of the rings.
const NAMED: [&str; 6] = [
    "cos_1",
    "sin_1",
    "cos_2",
    "sin_2",
    "velocity_sign",
    "pressure_sign",
];
/// What is recorded, of the words that `measure` may have.
const MEASURED: [&str; 2] = ["crosshead_acceleration", "cylinder_pressure"];

/// The machine file of a machine with true contacts: parameters of their own, which follow the
/// clearance or do not; with `other_law` that of Flores, Machado, Silva and Martins 2011.
///
/// # Errors
/// A machine without contact parameters.
pub fn contacts(machine: &Machine, other_law: bool, random: &mut Stream) -> Result<Value, Error> {
    let mut tree = machine.tree.clone();
    let relation = match random.random::<bool>() {
        true => Relation::Equation5,
        false => Relation::Constant,
    };
    for joint in &machine.joints {
        for key in [
            "contact.stiffness",
            "contact.damping",
            "friction.coefficient",
        ] {
            let path = format!("{}.{key}", joint.path);
            let parameter = Parameter::at(&tree, &path).map_err(Error::Contact)?;
            let factor = random.random_range(CONTACT[0]..CONTACT[1]);
            let value = parameter.nominal * factor;
            parameter.write(&mut tree, value)?;
        }
        if other_law {
            let at = format!("{}.contact", joint.path);
            let own = |key: &str| -> Result<Value, input::Error> {
                let value = paths::get(&tree, &format!("{at}.{key}"))?;
                Ok(value.cloned().unwrap_or_default())
            };
            let restitution = random.random_range(RESTITUTION[0]..RESTITUTION[1]);
            let law = [
                ("law", "flores".into()),
                ("stiffness", own("stiffness")?),
                ("exponent", own("exponent")?),
                ("restitution", restitution.into()),
            ];
            let law: Map<String, Value> = law
                .map(|(key, value)| (key.to_owned(), value))
                .into_iter()
                .collect();
            paths::set(&mut tree, &at, law.into())?;
        }
    }
    relation.set(&mut tree, &machine.joints)?;
    Ok(tree)
}

/// An effect, with place, values and signs drawn, as items of a machine file's list: one, or with `other_forms` two in
/// both bearings of the rod. Whether the machine can have it there is not looked at.
pub fn effect(
    entry: &Entry,
    machine: &Machine,
    size: f64,
    other_forms: bool,
    random: &mut Stream,
) -> Vec<Value> {
    let throws = machine.throws();
    let mut place: Vec<(&str, &str)> = Vec::new();
    for choice in entry.places {
        let words: Vec<&str> = match choice.key {
            "throw" => throws.clone(),
            "end" if !machine.is_double_acting() => Vec::new(),
            "measure" => MEASURED.to_vec(),
            _ => choice.words.to_vec(),
        };
        let everywhere = choice.key == "end" && random.random::<bool>();
        if let Some(word) = words.choose(random).filter(|_| !everywhere) {
            place.push((choice.key, word));
        }
    }
    let drawn = |(index, parameter): (usize, &effects::Parameter)| match (entry.name, parameter.key)
    {
        ("mains_hum", "frequency") => {
            let mains = MAINS[usize::from(random.random::<bool>())];
            mains * random.random_range(1.0 - GRID..1.0 + GRID)
        }
        _ if parameter.shape && other_forms => {
            let [low, high] = parameter.bounds;
            // A further wave is no larger than the first one usually is.
            let is_wave = entry.waves().any(|[amplitude, _]| amplitude == index);
            let most = if is_wave {
                entry.usual_wave(index)
            } else {
                high
            };
            random.random_range(low..high.min(most))
        }
        _ => value(parameter, size, random),
    };
    let mut values: Vec<f64> = entry.parameters.iter().enumerate().map(drawn).collect();
    if entry.proposal == Proposal::ForceLaw {
        as_law(entry, &mut values, random);
    }
    let in_both =
        other_forms && place.iter().any(|(key, _)| *key == "joint") && random.random::<bool>();
    let bearings: &[&str] = if in_both {
        &["big_end", "small_end"]
    } else {
        &[]
    };
    let in_bearing = |bearing: &&str| {
        let moved = place.iter().map(|(key, word)| match *key {
            "joint" => (*key, *bearing),
            _ => (*key, *word),
        });
        entry.item(&moved.collect::<Vec<_>>(), &values)
    };
    match bearings {
        [] => vec![entry.item(&place, &values)],
        both => both.iter().map(in_bearing).collect(),
    }
}

/// Gives a machine file one value that the data sheet of `machine` does not have: a mass, a length or an inertia.
///
/// # Errors
/// A machine without such values.
pub fn wrong_data_sheet(tree: &mut Value, random: &mut Stream) -> Result<(), Error> {
    let prefix = match tree["throws"].as_array() {
        Some(_) => "throws.0.",
        None => "",
    };
    let Some((key, width)) = SHEET.choose(random) else {
        return Ok(());
    };
    let path = format!("{prefix}{key}");
    let parameter = Parameter::at(tree, &path).map_err(Error::Contact)?;
    let sign = if random.random::<bool>() { 1.0 } else { -1.0 };
    let factor = 1.0 + sign * width * random.random_range(WRONG[0]..WRONG[1]);
    Ok(parameter.write(tree, parameter.nominal * factor)?)
}

/// Leaves the amplitudes of a few terms that no effect with a name makes, and takes the others away.
fn as_law(entry: &Entry, values: &mut [f64], random: &mut Stream) {
    let parameters = entry.parameters.iter().enumerate();
    let terms: Vec<(usize, f64)> = parameters
        .filter_map(|(i, parameter)| Some((i, parameter.absent?)))
        .collect();
    let nameless = |(i, _): &&(usize, f64)| !NAMED.contains(&entry.parameters[*i].key);
    let nameless: Vec<usize> = terms.iter().filter(nameless).map(|(i, _)| *i).collect();
    let kept: Vec<usize> = nameless.sample(random, TERMS).copied().collect();
    for (i, absent) in terms.iter().filter(|(i, _)| !kept.contains(i)) {
        values[*i] = *absent;
    }
}

/// A value of a parameter: anywhere for a phase or an order, around the usual one for the others.
fn value(parameter: &effects::Parameter, size: f64, random: &mut Stream) -> f64 {
    let [low, high] = parameter.bounds;
    if parameter.shape {
        return parameter.start;
    }
    if parameter.cyclic {
        return random.random_range(low..high);
    }
    if parameter.whole {
        return random.random_range(low..high + 1.0).floor();
    }
    let Some(absent) = parameter.absent else {
        // Evenly on a logarithmic scale, as far as the bounds go.
        let from = low.max(parameter.start / CONSTANT);
        let to = high.min(parameter.start * CONSTANT);
        return from * (to / from).powf(random.random());
    };
    let sign = match absent > low && random.random::<bool>() {
        true => -1.0,
        false => 1.0,
    };
    let factor = AMPLITUDE.powf(random.random_range(-1.0..1.0));
    let drawn = absent + sign * size * factor * (parameter.start - absent);
    drawn.clamp(low, high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use input::effects::CATALOGUE;
    use scalar::random::{Purpose, stream};

    #[test]
    fn values_stay_within_the_bounds_of_the_catalogue_and_follow_the_size() {
        let mut random = stream(1, 1, Purpose::Design);
        for parameter in CATALOGUE.iter().flat_map(|entry| entry.parameters) {
            let [low, high] = parameter.bounds;
            for size in [0.5, 1.0, 3.0] {
                for _ in 0..50 {
                    let value = value(parameter, size, &mut random);
                    assert!((low..=high).contains(&value), "{}", parameter.key);
                    assert!(!parameter.whole || value.fract() == 0.0);
                    let Some(absent) = parameter.absent else {
                        continue;
                    };
                    let usual = (parameter.start - absent).abs();
                    let share = (value - absent).abs() / usual / size;
                    let inside = value > low && value < high;
                    assert!(!inside || (0.8..=1.25).contains(&share), "{share}");
                }
            }
        }
    }

    #[test]
    fn a_force_of_no_name_has_a_law_of_a_few_terms() {
        let mut random = stream(1, 1, Purpose::Design);
        let entry = effects::proposed(Proposal::ForceLaw).unwrap();
        let mut values = vec![7.0; entry.parameters.len()];
        as_law(entry, &mut values, &mut random);
        let kept = entry.parameters.iter().zip(&values);
        let kept = kept.filter(|(p, value)| p.absent.is_some() && **value == 7.0);
        let kept: Vec<&str> = kept.map(|(p, _)| p.key).collect();
        assert_eq!(kept.len(), TERMS);
        assert!(kept.iter().all(|key| !NAMED.contains(key)), "{kept:?}");
        assert!(NAMED.iter().all(|key| entry.parameter(key).is_some()));
        let others = entry.parameters.iter().zip(&values);
        let mut others = others.filter(|(p, _)| p.absent.is_none());
        assert!(others.all(|(_, value)| *value == 7.0));
    }
}
