//! hidden-effects.yaml: which effects are hidden in which recordings, to see whether they are found.
//!
//! ```yaml
//! machines:
//!   - bundle: ../data/recordings/example-hidden-effect
//! sizes: [1, 3]
//! noises: [2 %, 5 %]
//! nothing: 2
//! pairs: 3
//! ```
//!
//! Cases come in rounds. A round hides every effect once, and then nothing and pairs as often as
//! the file says. From round to round each gets another combination of machine, noise and size.

use input::Error;
use input::choice::Count;
use input::effects::{CATALOGUE, Entry, entry};
use input::file_kind::FileKind;
use input::quantity::{AboveZero, Frequency, FromZero, Number, Positive, Quantity, Ratio};
use input::yaml::Document;
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::{Map, Value};
use std::path::{Path, PathBuf};

/// hidden-effects.yaml.
pub const HIDDEN_EFFECTS: FileKind = FileKind {
    name: "hidden-effects",
    file: "hidden-effects.yaml",
    content: "a test bench of effects hidden in recordings",
    words: "a test bench of hidden effects",
    schema,
    check: |_, document| HiddenEffects::from_document(&document).map(drop),
    recordings: |_| Vec::new(),
};

/// A test bench: effects, hidden in recordings of machines.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HiddenEffects {
    /// Seed of all random numbers; default 0.
    #[serde(default)]
    pub seed: Option<Count<0, { u32::MAX }>>,
    /// The machines and their runs, at least one.
    pub machines: Vec<BenchMachine>,
    /// The effects that are hidden; default all of the catalogue.
    #[serde(default)]
    pub effects: Option<Vec<String>>,
    /// Sizes of the effects: their amplitudes over the usual ones.
    pub sizes: Vec<Number<AboveZero>>,
    /// Noise of the accelerations, of their RMS; pressures have a quarter of it.
    pub noises: Vec<Quantity<Ratio, FromZero>>,
    /// Cases of a round in which nothing is hidden; default 1.
    #[serde(default)]
    pub nothing: Option<Count<0, 1000>>,
    /// Cases of a round in which two effects are hidden, drawn among the effects; default 0.
    #[serde(default)]
    pub pairs: Option<Count<0, 1000>>,
    /// Cases of a round in which a defect is hidden that is in no catalogue, of each kind in turn:
    /// contacts of another law, an acceleration behind a capacitor, a delayed acceleration, a wrong value of the data
    /// sheet; default 0.
    #[serde(default)]
    pub outside: Option<Count<0, 1000>>,
    /// Rounds; default the number of combinations of machine, noise and size, so that every effect
    /// meets each of them.
    #[serde(default)]
    pub rounds: Option<Count<1, 1_000_000>>,
    /// Revolutions of a recording; default 30.
    #[serde(default)]
    pub revolutions: Option<Count<4, 10_000>>,
    /// Sample rate of a recording; default 20 kHz.
    #[serde(default)]
    pub sample_rate: Option<Positive<Frequency>>,
    /// Share of the cases in which the joints of the recorded machine follow another contact law
    /// (Flores 2011) than those of the calibrated machine; default 0.
    #[serde(default)]
    pub other_contact_law: Option<Quantity<Ratio, FromZero>>,
    /// Whether hidden effects have other forms of their laws than the usual ones, and those of a bearing act in both
    /// bearings of the rod in half of the cases; default false.
    #[serde(default)]
    pub other_forms: Option<bool>,
}

/// A machine and the runs that are recorded of it.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BenchMachine {
    /// Its name.
    pub name: String,
    /// A folder with recordings.yaml, from the folder of this file. Its machine section and the
    /// conditions of its runs are used, its recordings are not.
    pub bundle: PathBuf,
    /// Values of the machine section in place of the bundle's.
    #[serde(default)]
    pub machine: Map<String, Value>,
    /// The runs of the bundle; default all of them.
    #[serde(default)]
    pub runs: Option<Vec<String>>,
    /// Factor on the speeds of the runs; default 1.
    #[serde(default)]
    pub speed_factor: Option<Number<AboveZero>>,
    /// Factor on the clearances of the runs; default 1.
    #[serde(default)]
    pub clearance_factor: Option<Number<AboveZero>>,
    /// Whether the pressures are recorded; default true.
    #[serde(default)]
    pub pressure: Option<bool>,
}

impl HiddenEffects {
    /// Reads a file; the document gives the lines of mistakes that are found later.
    ///
    /// # Errors
    /// All mistakes, with their lines.
    pub fn read(path: &Path) -> Result<(Self, Document), Error> {
        let document = Document::open(path)?;
        Ok((Self::from_document(&document)?, document))
    }

    /// The settings in the file with the content `document`.
    ///
    /// # Errors
    /// All mistakes, with their lines.
    pub fn from_document(document: &Document) -> Result<Self, Error> {
        document.collect(schema, |tree| {
            let settings: Self = Document::from_tree(tree.clone()).read()?;
            settings.check().map(|()| settings)
        })
    }

    /// What the types do not say: lists with entries, effects of the catalogue, machines with names of
    /// their own, a share of at most 1.
    fn check(&self) -> Result<(), Error> {
        for (key, empty) in [
            ("machines", self.machines.is_empty()),
            ("sizes", self.sizes.is_empty()),
            ("noises", self.noises.is_empty()),
        ] {
            if empty {
                return Err(Error::unexpected(key, "an empty list", "one entry or more"));
            }
        }
        for (i, machine) in self.machines.iter().enumerate() {
            if self.machines[..i].iter().any(|m| m.name == machine.name) {
                let key = format!("machines.{i}.name");
                return Err(Error::clash(key, "a name of its own for every machine"));
            }
        }
        let known: Vec<&str> = CATALOGUE.iter().map(|entry| entry.name).collect();
        for (i, name) in self.effects.iter().flatten().enumerate() {
            if entry(name).is_none() {
                return Err(Error::unknown_name(format!("effects.{i}"), name, &known));
            }
        }
        if self.pairs.is_some_and(|pairs| pairs.get() > 0) && self.entries().len() < 2 {
            return Err(Error::clash("pairs", "two effects or more to draw from"));
        }
        if self.other_contact_law.is_some_and(|share| share.si() > 1.0) {
            return Err(Error::clash(
                "other_contact_law",
                "a share, from 0 % to 100 %",
            ));
        }
        Ok(())
    }

    /// The effects that are hidden.
    pub fn entries(&self) -> Vec<&'static Entry> {
        match &self.effects {
            None => CATALOGUE.iter().collect(),
            Some(names) => names.iter().filter_map(|name| entry(name)).collect(),
        }
    }
}

/// The JSON Schema of hidden-effects.yaml, for editors and checks.
pub fn schema() -> Value {
    let mut schema = input::schema::generate::<HiddenEffects>();
    schema["title"] = "hidden-effects.yaml".into();
    schema
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHOLE: &str = "machines: [{name: a, bundle: b}]\nsizes: [1]\nnoises: [2 %]\n";

    fn read(text: &str) -> Result<HiddenEffects, Error> {
        HiddenEffects::from_document(&Document::parse(text, "h.yaml")?)
    }

    #[test]
    fn all_effects_are_hidden_where_none_are_named() {
        assert_eq!(read(WHOLE).unwrap().entries().len(), CATALOGUE.len());
        let some = read(&format!("{WHOLE}effects: [valve_loss, mains_hum]\n")).unwrap();
        let names: Vec<&str> = some.entries().iter().map(|e| e.name).collect();
        assert_eq!(names, ["valve_loss", "mains_hum"]);
        assert!(
            read(&format!("{WHOLE}effects: []\n"))
                .unwrap()
                .entries()
                .is_empty()
        );
    }

    #[test]
    fn mistakes_tell_their_line() {
        for (more, expected) in [
            (
                "effects: [valve_los]\n",
                "h.yaml:4:11: effects.0: found 'valve_los', expected one of valve_loss",
            ),
            (
                "pair: 2\n",
                "h.yaml:4:1: pair: unknown key; expected one of seed",
            ),
            (
                "effects: [valve_loss]\npairs: 2\n",
                "h.yaml:5:8: pairs: found 2, expected two effects or more",
            ),
            (
                "other_contact_law: 150 %\n",
                "h.yaml:4:20: other_contact_law: found '150 %', expected a share",
            ),
        ] {
            let message = read(&format!("{WHOLE}{more}")).unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
        for (text, expected) in [
            (
                WHOLE.replace("sizes: [1]", "sizes: []"),
                "h.yaml:2:8: sizes: found an empty list",
            ),
            (
                WHOLE.replace("2 %", "2"),
                "h.yaml:3:10: noises.0: found 2, expected",
            ),
            (
                WHOLE.replace("a, bundle: b}", "a, bundle: b}, {name: a, bundle: c}"),
                "h.yaml:1:41: machines.1.name: found 'a', expected a name of its own",
            ),
        ] {
            let message = read(&text).unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
    }
}
