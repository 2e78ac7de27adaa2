//! calibration.yaml: which parameters are fitted to which recordings, and how.
//!
//! ```yaml
//! bundle: ../recordings/compressor-7
//! parameters:
//!   joints.big_end.contact.stiffness: {bounds: [1 GN/m^1.5, 100 GN/m^1.5]}
//!   cylinder.exponent:
//! relation: conformal
//! hold_out: [run07]
//! ```
//!
//! The same keys stand in a sweep's section `calibrate`.

use crate::amount::Amount;
use crate::bundle::Bundle;
use crate::choice::{Count, Or};
use crate::error::Error;
use crate::quantity::{AboveZero, FromZero, Number};
use crate::yaml::Document;
use crate::{reader, sided};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde::de::value::SeqAccessDeserializer;
use serde::de::{Deserializer, MapAccess, SeqAccess, Visitor};
use serde_json::Value;
use std::borrow::Cow;
use std::fmt;
use std::path::{Path, PathBuf};

/// How a machine is calibrated.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Calibration {
    /// The recordings: a folder with recordings.yaml, from the folder of this file; or several of
    /// one machine, whose runs are then called FOLDER/RUN.
    pub bundle: Or<PathBuf, Vec<PathBuf>>,
    /// The machine file, from the folder of this file; the bundle's machine section where it is
    /// left out.
    #[serde(default)]
    #[schemars(example = "machine.yaml")]
    pub machine: Option<PathBuf>,
    /// What is fitted: a list of paths of the machine file, or a section of paths with their
    /// bounds. Where it is left out, contact stiffness, contact damping and friction of every joint
    /// that is clear in some run.
    #[serde(default)]
    pub parameters: Parameters,
    /// How the best fit is searched.
    #[serde(default)]
    pub optimiser: Optimiser,
    /// How contact parameters follow the clearance. Where it is left out, as the machine file has
    /// it; where a bundle's machine section says nothing, fitted if the fitted runs have several
    /// clearances, else eq5.
    #[serde(default)]
    #[schemars(example = &"conformal")]
    pub relation: Option<Relation>,
    /// Runs that are predicted and not fitted to. Where it is left out, of every four the last whose
    /// clearances a fitted run has.
    #[serde(default)]
    #[schemars(example = &vec!("run04"))]
    pub hold_out: Option<Vec<String>>,
    /// Runs that are not used at all.
    #[serde(default)]
    #[schemars(example = &vec!("run07"))]
    pub leave_out: Vec<String>,
    /// What the random numbers of the search follow from; 0 where it is left out.
    #[serde(default)]
    pub seed: Option<Count<0, { u32::MAX }>>,
    /// Most evaluations of the model, all runs being one; 5000 where it is left out.
    #[serde(default)]
    #[schemars(example = 5000)]
    pub evaluations: Option<Count<1, { u32::MAX }>>,
}

/// What is fitted: paths of the machine file in the order of the file, each with its bounds where
/// it has some.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parameters(pub Vec<(String, Option<[Amount; 2]>)>);

/// What a parameter may say.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct Parameter {
    /// Least and greatest value; around the machine file's value where they are left out.
    #[serde(default)]
    bounds: Option<[Amount; 2]>,
}

/// How the best fit is searched.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Optimiser {
    /// Levenberg-Marquardt from several points; a global search where that leaves more than noise.
    #[default]
    Default,
    /// CMA-ES.
    CmaEs,
    /// Levenberg-Marquardt from the nominal values.
    LevenbergMarquardt,
    /// A genetic algorithm.
    #[schemars(transform = name_alone)]
    Genetic(Option<Genetic>),
}

/// Settings of the genetic algorithm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Genetic {
    /// Individuals.
    #[serde(default)]
    pub population: Option<Count<4, 1_000_000>>,
    /// How far a child may lie outside its parents (BLX-α).
    #[serde(default)]
    pub crossover: Option<Number<FromZero>>,
    /// Probability that a gene mutates, up to 1.
    #[serde(default)]
    pub mutation: Option<Number<AboveZero>>,
}

/// How contact parameters follow the clearance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Relation {
    /// Eq. (5) of the papers.
    Eq5,
    /// The conformal form of Hertz.
    Conformal,
    /// Not at all.
    Constant,
    /// By powers that are fitted: it takes recordings at two clearances or more.
    Fitted,
}

/// The variant's name may stand for it, without settings.
fn name_alone(schema: &mut Schema) {
    let section = schema.clone();
    *schema = json_schema!({"anyOf": [{"const": "genetic"}, section]});
}

/// Settings, and where they are from.
#[derive(Clone, Debug)]
pub struct Given {
    /// The settings.
    pub calibration: Calibration,
    /// The folder from which their paths start.
    pub base: PathBuf,
    document: Option<Document>,
}

impl Given {
    /// Those of one settings file, or the default ones of bundles.
    ///
    /// # Errors
    /// An invalid settings file, or a settings file beside other inputs.
    pub fn read(inputs: &[PathBuf]) -> Result<Self, Error> {
        let is_bundle = |path: &PathBuf| path.is_dir() || Bundle::is_at(path);
        Ok(match inputs {
            [file] if !is_bundle(file) => {
                let (calibration, document) = Calibration::read(file)?;
                Self {
                    calibration,
                    base: file.parent().unwrap_or(Path::new("")).to_owned(),
                    document: Some(document),
                }
            }
            bundles => Self {
                calibration: Calibration::with_defaults(bundles.to_vec()),
                base: PathBuf::new(),
                document: None,
            },
        })
    }

    /// `error` with its line in the settings file.
    pub fn locate(&self, error: Error) -> Error {
        match &self.document {
            Some(document) => document.locate(error),
            None => error,
        }
    }
}

impl Calibration {
    /// The default settings for these bundles.
    pub fn with_defaults(bundles: Vec<PathBuf>) -> Self {
        Self {
            bundle: Or::Section(bundles),
            machine: None,
            parameters: Parameters::default(),
            optimiser: Optimiser::Default,
            relation: None,
            hold_out: None,
            leave_out: Vec::new(),
            seed: None,
            evaluations: None,
        }
    }

    /// Reads a settings file; `document` gives the lines of mistakes that are found later.
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
        Self::checked(document, |_, _| Ok(()))
    }

    /// As [`Calibration::from_document`], where `further` finds further mistakes in the settings and the content that they were
    /// read from; their keys are those of the file.
    ///
    /// # Errors
    /// All mistakes, with their lines.
    pub fn checked(
        document: &Document,
        further: impl Fn(&Self, &Value) -> Result<(), Error>,
    ) -> Result<Self, Error> {
        document.collect(schema, |tree| {
            let settings: Self = reader::read(tree)?;
            sided::check(tree)?;
            settings.check()?;
            further(&settings, tree).map(|()| settings)
        })
    }

    /// What the types do not say: no list without entries, bounds in their order, a probability.
    ///
    /// # Errors
    /// The first mistake; keys are those of this section.
    pub fn check(&self) -> Result<(), Error> {
        if self.bundles().is_empty() {
            return Err(Error::clash("bundle", "a folder with recordings.yaml"));
        }
        for (path, bounds) in &self.parameters.0 {
            let Some([low, high]) = bounds else { continue };
            let alike = low.dimension == high.dimension;
            if !(alike && low.si < high.si) {
                let key = format!("parameters.{path}.bounds");
                let found = format!("{} to {}", low.to_value(), high.to_value());
                let expected = "two values of one unit, the lesser first";
                return Err(Error::unexpected(key, found.replace('"', ""), expected));
            }
        }
        if let Optimiser::Genetic(Some(genetic)) = self.optimiser
            && genetic.mutation.is_some_and(|m| m.get() > 1.0)
        {
            let expected = "a probability, from 0 to 1";
            return Err(Error::clash("optimiser.genetic.mutation", expected));
        }
        Ok(())
    }

    /// The folders of recordings.
    pub fn bundles(&self) -> &[PathBuf] {
        match &self.bundle {
            Or::Scalar(one) => std::slice::from_ref(one),
            Or::Section(several) => several,
        }
    }
}

/// The JSON Schema of calibration.yaml, for editors and checks.
pub fn schema() -> Value {
    let mut schema = crate::schema::generate::<Calibration>();
    schema["title"] = "calibration.yaml".into();
    schema
}

impl<'de> Deserialize<'de> for Parameters {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Paths;
        impl<'de> Visitor<'de> for Paths {
            type Value = Parameters;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a list of paths of the machine file, or a section of them")
            }
            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Parameters, A::Error> {
                let paths: Vec<String> = Vec::deserialize(SeqAccessDeserializer::new(list))?;
                Ok(Parameters(paths.into_iter().map(|p| (p, None)).collect()))
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Parameters, A::Error> {
                let mut all = Vec::new();
                while let Some((path, says)) = map.next_entry::<String, Option<Parameter>>()? {
                    all.push((path, says.unwrap_or_default().bounds));
                }
                Ok(Parameters(all))
            }
        }
        deserializer.deserialize_any(Paths)
    }
}

impl JsonSchema for Parameters {
    fn schema_name() -> Cow<'static, str> {
        "Parameters".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let says = generator.subschema_for::<Parameter>();
        json_schema!({
            "anyOf": [
                {"type": "array", "items": {"type": "string"}},
                {"type": "object", "additionalProperties": {"anyOf": [says, {"type": "null"}]}}
            ]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn read(text: &str) -> Result<Calibration, Error> {
        Calibration::from_document(&Document::parse(text, "c.yaml")?)
    }

    fn message(text: &str) -> String {
        read(text).unwrap_err().to_string()
    }

    #[test]
    fn paths_are_a_list_or_a_section() {
        let list = read("bundle: b\nparameters: [speed, cylinder.exponent]\n").unwrap();
        let section = read("bundle: b\nparameters:\n  speed:\n  cylinder.exponent: {}\n").unwrap();
        assert_eq!(list, section);
        assert_eq!(list.parameters.0[1], ("cylinder.exponent".into(), None));
        assert_eq!(list.bundles(), [PathBuf::from("b")]);
        assert_eq!(list.optimiser, Optimiser::Default);
        let text = "bundle: [a, b]\nparameters: {rod.mass: {bounds: [4 kg, 5000 g]}}\n";
        let bounded = read(text).unwrap();
        assert_eq!(bounded.bundles().len(), 2);
        assert_eq!(
            bounded.parameters.0[0].1.map(|b| b.map(|b| b.si)),
            Some([4.0, 5.0])
        );
    }

    #[test]
    fn the_genetic_algorithm_needs_no_settings() {
        let plain = read("bundle: b\noptimiser: genetic\n").unwrap();
        assert_eq!(plain.optimiser, Optimiser::Genetic(None));
        let full = read("bundle: b\noptimiser: {genetic: {population: 40, mutation: 0.1}}\n");
        let Optimiser::Genetic(Some(genetic)) = full.unwrap().optimiser else {
            panic!("no genetic algorithm");
        };
        assert_eq!(genetic.population.map(Count::get), Some(40));
    }

    #[test]
    fn mistakes_tell_their_line() {
        for (text, expected) in [
            (
                "bundl: b\n",
                "c.yaml:1:1: bundl: unknown key; expected one of bundle, machine",
            ),
            ("seed: 1\n", "c.yaml:1:1: bundle: missing"),
            (
                "bundle: b\noptimiser: cmaes\n",
                "c.yaml:2:12: optimiser: found 'cmaes', expected one of default, cma_es, \
                 levenberg_marquardt, genetic; did you mean 'cma_es'?",
            ),
            (
                "bundle: b\nrelation: eq6\n",
                "c.yaml:2:11: relation: found 'eq6', expected one of eq5, conformal",
            ),
            (
                "bundle: []\n",
                "c.yaml:1:9: bundle: found an empty list, expected a folder",
            ),
            (
                "bundle: b\nparameters: {rod.mass: {bounds: [5 kg, 4 kg]}}\n",
                "c.yaml:2:33: parameters.rod.mass.bounds: found 5 kg to 4 kg, expected two values",
            ),
            (
                "bundle: b\nparameters: {rod.mass: {bound: [4 kg, 5 kg]}}\n",
                "parameters.rod.mass.bound: unknown key; expected bounds; did you mean 'bounds'?",
            ),
            (
                "bundle: b\noptimiser: {genetic: {mutation: 1.5}}\n",
                "c.yaml:2:33: optimiser.genetic.mutation: found 1.5, expected a probability",
            ),
            (
                "bundle: b\nparameters: speed\n",
                "parameters: found 'speed', expected a list",
            ),
        ] {
            let message = message(text);
            assert!(message.contains(expected), "{message}");
        }
    }

    #[test]
    fn all_mistakes_are_told_at_once() {
        let text = "bundle: b\nparameters: {rod.mass: {bounds: [5 kg, 4 kg]}, crosshead.mass: {bounds: [1 kg, 2 m]}}\n\
                    optimiser: defalt\n";
        let mistakes = read(text).unwrap_err().into_each();
        let keys: Vec<&str> = mistakes.iter().map(Error::key).collect();
        let expected = [
            "parameters.rod.mass.bounds",
            "parameters.crosshead.mass.bounds",
            "optimiser",
        ];
        assert_eq!(keys, expected);
    }

    #[test]
    fn the_schema_takes_what_is_read() {
        let schema = schema();
        assert_eq!(
            schema["properties"]["relation"]["$ref"],
            json!("#/$defs/Relation")
        );
        let optimiser = schema["$defs"]["Optimiser"].to_string();
        assert!(optimiser.contains("\"const\":\"genetic\""), "{optimiser}");
    }
}
