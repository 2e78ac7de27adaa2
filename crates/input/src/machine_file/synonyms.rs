//! Names that data sheets have for what a machine file says: `stroke`, `bore`, `wrist_pin`.
//!
//! A synonym is accepted where its meaning is exact. The tree that a machine is read from has the file's own keys
//! only, so that sweeps, calibrations and paths need no others.

use super::written::{Mistakes, Written};
use crate::error::{Error, join};
use crate::quantity::{FromZero, Kind, Length, Positive, Quantity, Ratio, Speed};
use crate::tree::{find, moved, put, take};
use crate::unit::Measure;
use serde_json::{Value, json};

/// What a synonym does to its value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Meaning {
    /// Nothing: another name.
    Same,
    /// The key has half of it: a radius for a diameter.
    Half,
    /// Revolutions a minute, as a bare number.
    Rpm,
    /// A bare number in the SI unit that ends the name, as programs write it in recordings.yaml.
    Si,
    /// The same, of which the key has half.
    HalfSi,
    /// A clearance volume, in % of the swept volume of its chamber: the gap is that share of the stroke.
    OfStroke,
}

/// A name that data sheets have for a key.
pub(crate) struct Synonym {
    /// The name, from the top of the file or of a throw.
    pub(crate) name: &'static str,
    /// The key of a machine file, from the same place.
    pub(crate) key: &'static str,
    pub(crate) meaning: Meaning,
}

macro_rules! synonyms {
    ($( $meaning:ident $key:literal: $($name:literal)*; )*) => {
        &[ $($( Synonym { name: $name, key: $key, meaning: Meaning::$meaning } ),*),* ]
    };
}

/// The synonyms; a section is renamed before what stands in it.
pub(crate) const SYNONYMS: &[Synonym] = synonyms! {
    Same "rod": "connecting_rod";
    Same "joints.main": "main_bearing" "joints.main_bearing";
    Same "joints.big_end": "crank_pin" "joints.crank_pin" "joints.crankpin";
    Same "joints.small_end": "crosshead_pin" "wrist_pin" "joints.crosshead_pin" "joints.wrist_pin";
    Same "joints.guide": "crosshead_guide" "joints.crosshead_guide";
    Half "crank.radius": "stroke" "crank.stroke";
    Same "crank.radius": "crank.throw" "crank_radius";
    Rpm "speed": "rpm" "speed_rpm";
    Si "crank.radius": "crank_radius_m";
    HalfSi "crank.radius": "stroke_m";
    Si "rod.length": "rod_length_m";
    Si "rod.mass": "rod_mass_kg";
    Si "rod.centre_of_mass": "rod_big_end_to_cg_m";
    Si "rod.inertia": "rod_inertia_cg_kg_m2";
    Si "crosshead.mass": "crosshead_mass_kg";
    Si "cylinder.piston_radius": "piston_radius_m";
    Si "cylinder.suction": "suction_pressure_pa";
    Si "cylinder.discharge": "discharge_pressure_pa";
    Si "cylinder.back": "back_pressure_pa";
    Si "cylinder.head_clearance": "head_clearance_m";
    Si "cylinder.crank_end.rod_radius": "piston_rod_radius_m";
    Si "cylinder.crank_end.clearance": "crank_end_clearance_m";
    Same "cylinder.expansion_exponent": "polytropic_expansion_exponent";
    Si "joints.big_end.journal_radius": "big_end_journal_radius_m";
    Si "joints.small_end.journal_radius": "small_end_journal_radius_m";
    Si "gravity.acceleration": "gravity_m_s2";
    Same "rod.length": "rod_length" "connecting_rod_length";
    Same "rod.mass": "rod.weight" "connecting_rod_mass" "connecting_rod_weight";
    Same "rod.centre_of_mass": "rod.center_of_mass" "rod.centre_of_gravity" "rod.center_of_gravity";
    Same "rod.inertia": "rod.moment_of_inertia";
    Same "crosshead.mass": "crosshead.weight" "reciprocating_mass" "reciprocating_weight";
    Same "crosshead.inertia": "crosshead.moment_of_inertia";
    Half "cylinder.piston_radius": "bore" "piston_diameter" "cylinder_diameter" "cylinder.bore"
        "cylinder.piston_diameter" "cylinder.diameter";
    Half "cylinder.crank_end.rod_radius": "rod_diameter" "piston_rod_diameter" "cylinder.rod_diameter"
        "cylinder.piston_rod_diameter" "cylinder.crank_end.rod_diameter" "cylinder.crank_end.piston_rod_diameter";
    Same "cylinder.suction": "suction_pressure" "cylinder.suction_pressure";
    Same "cylinder.discharge": "discharge_pressure" "cylinder.discharge_pressure";
    Same "cylinder.exponent": "cylinder.polytropic_exponent" "polytropic_exponent";
    OfStroke "cylinder.head_clearance": "clearance_volume" "cylinder.clearance_volume" "head_end_clearance_volume"
        "cylinder.head_end_clearance_volume";
    OfStroke "cylinder.crank_end.clearance": "cylinder.crank_end.clearance_volume" "crank_end_clearance_volume"
        "cylinder.crank_end_clearance_volume";
    Half "joints.main.journal_radius": "main_journal_diameter" "joints.main.journal_diameter" "joints.main.diameter";
    Half "joints.big_end.journal_radius": "crank_pin_diameter" "joints.big_end.journal_diameter"
        "joints.big_end.pin_diameter" "joints.big_end.diameter";
    Half "joints.small_end.journal_radius": "crosshead_pin_diameter" "wrist_pin_diameter"
        "joints.small_end.journal_diameter" "joints.small_end.pin_diameter" "joints.small_end.diameter";
    Half "joints.main.clearance": "joints.main.diametral_clearance";
    Half "joints.big_end.clearance": "joints.big_end.diametral_clearance";
    Half "joints.small_end.clearance": "joints.small_end.diametral_clearance";
    Half "joints.guide.clearance": "joints.guide.diametral_clearance";
    Same "joints.main.clearance": "joints.main.radial_clearance";
    Same "joints.big_end.clearance": "joints.big_end.radial_clearance";
    Same "joints.small_end.clearance": "joints.small_end.radial_clearance";
};

/// The names that people write for keys of a machine file: the key, the name, and what the name states of it.
pub fn synonyms() -> impl Iterator<Item = (&'static str, &'static str, &'static str)> {
    SYNONYMS.iter().filter_map(|s| {
        let states = match s.meaning {
            Meaning::Same => "the same",
            Meaning::Half => "twice",
            Meaning::Rpm => "in rpm, without a unit",
            Meaning::OfStroke => "in % of the swept volume",
            Meaning::Si | Meaning::HalfSi => return None,
        };
        Some((s.key, s.name, states))
    })
}

/// Whether `name` is a synonym that people write, and not programs.
pub(crate) fn is_of_people(name: &str) -> bool {
    let is_of_people = |s: &Synonym| {
        s.name == name
            && !matches!(s.meaning, Meaning::Si | Meaning::HalfSi)
            && s.key != "cylinder.exponent"
            && s.key != "cylinder.expansion_exponent"
    };
    SYNONYMS.iter().any(is_of_people)
}

/// The synonyms that may stand in the section at `place`.
pub(crate) fn names_in(place: &str) -> impl Iterator<Item = &'static str> {
    let throw = place
        .strip_prefix("throws.")
        .map(|rest| rest.split_once('.').unwrap_or((rest, "")));
    let section = throw.map_or(place, |(_, section)| section).to_owned();
    SYNONYMS.iter().filter_map(move |s| {
        let (above, name) = s.name.rsplit_once('.').unwrap_or(("", s.name));
        (above == section).then_some(name)
    })
}

/// The key that a path should name in the place of the synonym `name`, and what it has of the value; none where it is
/// no synonym.
pub(crate) fn instead(name: &str) -> Option<String> {
    let synonym = SYNONYMS.iter().find(|s| s.name == name)?;
    let key = synonym.key;
    let last = name.rsplit('.').next().unwrap_or(name);
    Some(match synonym.meaning {
        Meaning::Half | Meaning::HalfSi => format!("{key} (half of the {last})"),
        Meaning::OfStroke => format!("{key} (a length, that share of the stroke)"),
        Meaning::Rpm => format!("{key} (with its unit, e.g. '500 rpm')"),
        Meaning::Same | Meaning::Si => key.to_owned(),
    })
}

/// The key of a machine file that `key`, in which there may be synonyms, stands for.
pub(crate) fn canonical(key: &str) -> String {
    let throw = key
        .strip_prefix("throws.")
        .and_then(|rest| rest.split_once('.'));
    let rest = throw.map_or(key, |(_, rest)| rest);
    let place = key[..key.len() - rest.len()].trim_end_matches('.');
    let rest = SYNONYMS.iter().fold(rest.to_owned(), |key, synonym| {
        let to = key_at(synonym, throw.is_some());
        moved(&key, synonym.name, to).unwrap_or(key)
    });
    join(place, &rest)
}

/// The synonym that `section` has for its key `key` of a machine file, with its place; `key` itself where it has none. What
/// throws share stands at the top.
pub(crate) fn as_written(section: &Value, key: &str) -> String {
    let throw = key
        .strip_prefix("throws.")
        .and_then(|rest| rest.split_once('.'));
    let rest = throw.map_or(key, |(_, rest)| rest);
    let place = key[..key.len() - rest.len()].trim_end_matches('.');
    let meant = |s: &&Synonym| key_at(s, throw.is_some()) == rest;
    let names = SYNONYMS.iter().filter(meant);
    let mut places = names.flat_map(|s| [join(place, s.name), s.name.to_owned()]);
    let written = places.find(|name| find(section, name).is_some());
    written.unwrap_or_else(|| key.to_owned())
}

/// Puts the keys of a machine file in the place of their synonyms.
pub(super) fn replace(written: &mut Written, mistakes: &mut Mistakes) {
    for place in places(&written.tree) {
        for synonym in SYNONYMS {
            let is_throw = !place.is_empty();
            if synonym.meaning != Meaning::OfStroke {
                one(
                    written,
                    &place,
                    synonym,
                    key_at(synonym, is_throw),
                    mistakes,
                );
            }
        }
    }
    // Their gap needs the stroke.
    for place in places(&written.tree) {
        for synonym in SYNONYMS.iter().filter(|s| s.meaning == Meaning::OfStroke) {
            one(written, &place, synonym, synonym.key, mistakes);
        }
    }
}

/// The top, and each throw.
pub(super) fn places(tree: &Value) -> Vec<String> {
    let throws = tree["throws"].as_array().map_or(0, Vec::len);
    let throws = (0..throws).map(|i| format!("throws.{i}"));
    std::iter::once(String::new()).chain(throws).collect()
}

/// The key of a synonym; a throw has its crank radius under another one.
fn key_at(synonym: &Synonym, is_throw: bool) -> &'static str {
    match (synonym.key, is_throw) {
        ("crank.radius", true) => "crank_radius",
        (key, _) => key,
    }
}

fn one(written: &mut Written, place: &str, synonym: &Synonym, key: &str, mistakes: &mut Mistakes) {
    let (from, to) = (join(place, synonym.name), join(place, key));
    if from == to {
        return;
    }
    let Some(value) = find(&written.tree, &from) else {
        return;
    };
    // The pin itself may be meant where its joint is not described: a length there is no section.
    let is_section = [Meaning::Same] == [synonym.meaning] && !key.contains('.') || is_joint(key);
    if is_section && !(value.is_object() || value == "ideal") {
        let expected = format!(
            "a section, as {key} has it; a diameter is {}",
            diameter_of(key)
        );
        mistakes.note(
            written,
            Error::unexpected(&from, crate::error::shown(value), expected),
        );
        take(&mut written.tree, &from);
        return;
    }
    if find(&written.tree, &to).is_some_and(|there| !there.is_null()) {
        let expected = format!("it or {}, not both", written.original(&to));
        mistakes.note(written, Error::clash(&from, expected));
        take(&mut written.tree, &from);
        return;
    }
    match meant(written, place, synonym, value) {
        Ok(meant) => {
            let (mut tree, own) = (written.tree.clone(), value.clone());
            take(&mut tree, &from);
            if put(&mut tree, &to, meant) {
                written.tree = tree;
                written.changed(&to, &own);
                written.moved(from, to);
            }
        }
        Err(error) => {
            mistakes.note(written, error.under(&from));
            written.wrong(to);
            take(&mut written.tree, &from);
        }
    }
}

fn is_joint(key: &str) -> bool {
    key.strip_prefix("joints.")
        .is_some_and(|joint| !joint.contains('.'))
}

/// The name of the diameter that people may mean by a pin.
fn diameter_of(key: &str) -> &'static str {
    match key {
        "joints.main" => "main_journal_diameter",
        "joints.big_end" => "crank_pin_diameter",
        "joints.small_end" => "crosshead_pin_diameter",
        _ => "not among its keys",
    }
}

/// The value of the key.
fn meant(written: &Written, place: &str, synonym: &Synonym, value: &Value) -> Result<Value, Error> {
    if let Some(error) = contradiction(synonym, value) {
        return Err(error);
    }
    match synonym.meaning {
        Meaning::Same => Ok(value.clone()),
        Meaning::Half if value == "ideal" => Ok(value.clone()),
        Meaning::Half => {
            let whole: Quantity<Length, FromZero> = read(&said_twice(synonym, value))?;
            Ok(text::<Length>(whole.si() / 2.0))
        }
        Meaning::Rpm => match value {
            Value::Number(number) => Ok(json!(format!("{number} rpm"))),
            other => read::<Positive<Speed>>(other).map(|_| other.clone()),
        },
        Meaning::Si | Meaning::HalfSi => {
            let unit = unit_of(synonym.name);
            let Some(number) = value.as_f64().filter(|_| value.is_number()) else {
                let expected = format!("a plain number, in {unit}: the key names its unit");
                return Err(Error::unexpected("", crate::error::shown(value), expected));
            };
            let share = if synonym.meaning == Meaning::HalfSi {
                0.5
            } else {
                1.0
            };
            Ok(json!(format!("{:e} {unit}", number * share)))
        }
        Meaning::OfStroke if place.is_empty() && strokes_differ(&written.tree) => Err(
            Error::clash("", "it in each throw, as their strokes differ"),
        ),
        Meaning::OfStroke => {
            let share: Positive<Ratio> = read(value)?;
            if share.si() > LARGEST_CLEARANCE {
                let expected = "a percentage up to 500 % of the swept volume";
                return Err(Error::unexpected("", crate::error::shown(value), expected));
            }
            match crank_radius(&written.tree, place) {
                Some(radius) => Ok(text::<Length>(share.si() * 2.0 * radius)),
                // A wrong one is a mistake by itself, which keeps the machine from being read.
                None if is_radius_wrong(written, place) => Ok(text::<Length>(share.si())),
                None => {
                    let expected = "a crank radius or a stroke beside it, as it is a share of the swept volume";
                    Err(Error::clash("", expected).against("crank.radius"))
                }
            }
        }
    }
}

/// The largest clearance volume, a share of the swept volume. Cylinders have 5 to 50 %, with open pockets up to about 200 %.
const LARGEST_CLEARANCE: f64 = 5.0;

/// A name that says how a clearance is measured.
struct Sided {
    /// How the name ends.
    name: &'static str,
    /// The word for it after a length, and the other word.
    word: &'static str,
    other: &'static str,
    /// The key for what is measured in the other way.
    instead: &'static str,
}

const SIDED: [Sided; 2] = [
    Sided {
        name: "diametral_clearance",
        word: "diametral",
        other: "radial",
        instead: "clearance",
    },
    Sided {
        name: "radial_clearance",
        word: "radial",
        other: "diametral",
        instead: "diametral_clearance",
    },
];

/// How `name` says that a clearance is measured.
fn sided(name: &str) -> Option<&'static Sided> {
    SIDED.iter().find(|sided| name.ends_with(sided.name))
}

/// The value without the word that its name says already: `diametral_clearance: 0.1 mm diametral`.
fn said_twice(synonym: &Synonym, value: &Value) -> Value {
    let length = sided(synonym.name).and_then(|sided| {
        let length = value.as_str()?.trim_end().strip_suffix(sided.word)?;
        length.ends_with(char::is_whitespace).then(|| length.trim())
    });
    length.map_or_else(|| value.clone(), Value::from)
}

/// That the value is measured in another way than its name says: `diametral_clearance: 0.1 mm radial`.
fn contradiction(synonym: &Synonym, value: &Value) -> Option<Error> {
    let Sided {
        word,
        other,
        instead,
        ..
    } = sided(synonym.name)?;
    let is_other = value.as_str()?.trim_end().ends_with(other);
    let expected = format_args!("a {word} clearance; a {other} one belongs at the key {instead}");
    is_other.then(|| Error::unexpected("", crate::error::shown(value), expected))
}

/// The joint that data sheets call `name`: `small_end` for `wrist_pin`.
pub(super) fn joint_called(name: &str) -> Option<&'static str> {
    let synonym = SYNONYMS.iter().find(|s| s.name == name)?;
    let joint = synonym.key.strip_prefix("joints.")?;
    (!joint.contains('.')).then_some(joint)
}

fn read<T: serde::de::DeserializeOwned>(value: &Value) -> Result<T, Error> {
    crate::reader::read(value)
}

fn text<K: Kind>(si: f64) -> Value {
    let dimension = K::DIMENSION;
    Measure { si, dimension }.to_string().into()
}

/// The crank radius of the throw at `place`, as it is stated.
fn stated_radius<'a>(tree: &'a Value, place: &str) -> Option<&'a Value> {
    let own = find(tree, &join(place, "crank_radius"));
    own.or_else(|| find(tree, "crank.radius"))
}

/// The crank radius of the throw at `place`, m; none where it is missing or wrong.
fn crank_radius(tree: &Value, place: &str) -> Option<f64> {
    let radius = stated_radius(tree, place)?.as_str()?;
    Positive::<Length>::parse(radius)
        .ok()
        .map(|radius| radius.si())
}

/// Whether the file has something for the crank radius of the throw at `place` that cannot be read as one.
fn is_radius_wrong(written: &Written, place: &str) -> bool {
    let stated = stated_radius(&written.tree, place).is_some_and(|radius| !radius.is_null());
    let own = join(place, "crank_radius");
    stated || written.is_wrong("crank.radius") || written.is_wrong(&own)
}

/// Whether a throw has a crank radius of its own.
fn strokes_differ(tree: &Value) -> bool {
    let throws = tree["throws"].as_array().into_iter().flatten();
    throws
        .into_iter()
        .any(|throw| throw.get("crank_radius").is_some())
}

/// The SI unit that ends a name.
fn unit_of(name: &str) -> &'static str {
    const ENDS: [(&str, &str); 5] = [
        ("_kg_m2", "kg m^2"),
        ("_m_s2", "m/s^2"),
        ("_kg", "kg"),
        ("_pa", "Pa"),
        ("_m", "m"),
    ];
    let end = ENDS.iter().find(|(end, _)| name.ends_with(end));
    end.map_or("", |(_, unit)| unit)
}
