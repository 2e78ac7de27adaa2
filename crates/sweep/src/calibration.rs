//! A sweep that calibrates its machine first: what it asks for, and its plan with what was found.
//!
//! What was found is kept as [`Calibration`] and put into the sweep file's tree: the machine with
//! the values found, and the uncertainty as `vary_together` and `vary`. The plan is that of this
//! tree, and the dataset's `sweep.yaml` holds it: it no longer names the recordings.

mod results;

use std::path::{Path, PathBuf};

use calibrate::{Existing, Prepared, Settings};
use input::bundle::Bundle;
use input::choice::Or;
use input::file_kind::FileKind;
use input::yaml::Document;
use input::{Error, Problem, paths};
use scalar::elementary::exp;
use serde_json::{Map, Value, json};

use crate::Plan;
use crate::dataset::{self, CALIBRATION, Claim, Tables, check_calibration};
use crate::sweep_file::{self, Amount, Calibrate, SweepFile, Uncertainty, Undetermined};

/// sweep.yaml.
pub const SWEEP_FILE: FileKind = FileKind {
    name: "sweep",
    file: "sweep.yaml",
    content: "the cases of a dataset",
    words: "a sweep",
    schema: sweep_file::schema,
    check: |folder, document| Sweep::new(document, folder)?.nominal().map(drop),
    recordings: |_| Vec::new(),
};

/// A sweep file that has been read, but not planned yet.
#[derive(Clone, Debug)]
pub struct Sweep {
    document: Document,
    folder: PathBuf,
    file: SweepFile,
}

/// A calibrated machine, and what is not known of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    /// The tree of its machine file.
    pub machine: Value,
    /// The fitted values.
    pub estimates: Vec<Estimate>,
    /// Correlation of each pair of estimates (of their logarithms where they have a ratio).
    pub correlations: Vec<Vec<f64>>,
    /// How contact parameters follow the clearance: what the recordings do not exclude.
    pub relations: Relations,
    /// Whether the model fits the recordings to within their noise, so that there are intervals.
    pub is_adequate: bool,
}

/// The relations to the clearance that recordings do not exclude.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Relations {
    /// Each as the machine file has it, and how likely it is, up to a common factor.
    pub weights: Vec<(Value, f64)>,
    /// The joints that have one: path, and the clearance for which their contact was fitted, m.
    pub joints: Vec<(String, f64)>,
}

impl Relations {
    /// Gives the joints of `machine` the first relation where they have none, and their clearance,
    /// and returns what is drawn as an entry of `vary`. None where there is nothing to draw, or the
    /// sweep varies it itself.
    fn drawn(
        &self,
        machine: &mut Value,
        varied: impl Fn(&str) -> bool,
    ) -> Result<Option<(String, Value)>, Error> {
        let pattern = match machine["throws"].is_array() {
            true => "throws.*.joints.*.contact.relation",
            false => "joints.*.contact.relation",
        };
        let path = |joint: &str, key: &str| format!("{joint}.contact.{key}");
        let own = |(joint, _): &(String, f64)| varied(&path(joint, "relation"));
        let [(first, _), _, ..] = &self.weights[..] else {
            return Ok(None);
        };
        if self.joints.is_empty() || self.joints.iter().any(own) || varied(pattern) {
            return Ok(None);
        }
        for (joint, clearance) in &self.joints {
            let stated = path(joint, "at_clearance");
            if paths::get(machine, &stated)?.is_none() {
                paths::set(machine, &stated, format!("{clearance} m").into())?;
            }
            let relation = path(joint, "relation");
            if paths::get(machine, &relation)?.is_none() {
                paths::set(machine, &relation, first.clone())?;
            }
        }
        let (values, weights): (Vec<&Value>, Vec<f64>) = self
            .weights
            .iter()
            .map(|(value, weight)| (value, *weight))
            .unzip();
        let choice = json!({"choice": {"values": values, "weights": weights}});
        Ok(Some((pattern.to_owned(), choice)))
    }
}

/// A fitted value.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Its path in the machine file.
    pub path: String,
    /// Its value, as the machine file has it.
    pub value: Value,
    /// Least and greatest value of the search.
    pub bounds: [Value; 2],
    /// Whether it was searched on a logarithmic scale.
    pub logarithmic: bool,
    /// Standard deviation: of the logarithm on a logarithmic scale, else of the value, SI; none
    /// where the recordings do not determine it.
    pub deviation: Option<f64>,
}

impl Sweep {
    /// Reads the sweep file at `path`.
    ///
    /// # Errors
    /// A file that cannot be read, or a mistake in it, with its line.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let folder = path.parent().unwrap_or(Path::new(""));
        Self::new(Document::open(path)?, folder)
    }

    /// The sweep file with the content `document` in `folder`.
    ///
    /// # Errors
    /// All mistakes in it, with their lines.
    pub fn new(document: Document, folder: &Path) -> Result<Self, Error> {
        let read = |tree: &Value| {
            let file: SweepFile = Document::from_tree(tree.clone()).read()?;
            if let Some(calibrate) = &file.calibrate {
                let checked = calibrate.settings.check();
                checked.map_err(|error| error.under("calibrate"))?;
            }
            Ok(file)
        };
        let file = document
            .collect(sweep_file::schema, read)
            .map_err(|error| {
                match document.tree.get("calibrate") {
                    Some(_) => error,
                    // The plan finds these, and what does not go together.
                    None => Plan::new(&document, folder).err().unwrap_or(error),
                }
            })?;
        Ok(Self {
            document,
            folder: folder.to_owned(),
            file,
        })
    }

    /// The calibration that it asks for.
    pub fn calibrate(&self) -> Option<&Calibrate> {
        self.file.calibrate.as_ref()
    }

    /// The folder that its paths start from.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// `error`, whose key is one of the section `calibrate`, with its line in the file.
    pub fn locate(&self, error: Error) -> Error {
        self.document.locate(error.under("calibrate"))
    }

    /// The folders of the recordings.
    pub fn bundles(&self) -> Vec<PathBuf> {
        let bundles = self.calibrate().map(|c| c.settings.bundles());
        let bundles = bundles.unwrap_or_default().iter();
        bundles.map(|bundle| self.folder.join(bundle)).collect()
    }

    /// The tree of the sweep's own machine file, where it names one.
    ///
    /// # Errors
    /// A machine file that cannot be read.
    pub fn machine(&self) -> Result<Option<Value>, Error> {
        Ok(match &self.file.machine {
            None => None,
            Some(Or::Section(_)) => Some(self.document.tree["machine"].clone()),
            Some(Or::Scalar(path)) => {
                let machine = input::machine_file::read(&self.folder.join(path))?;
                Some(machine.to_tree().clone())
            }
        })
    }

    /// The machine before any calibration: the sweep's own, or the bundle's machine section at the
    /// conditions of its first run.
    fn nominal_machine(&self) -> Result<Value, Error> {
        if let Some(machine) = self.machine()? {
            return Ok(machine);
        }
        match self.bundles().first() {
            None => Err(self.document.locate(Error::missing("machine"))),
            Some(bundle) => machine_of(&Bundle::read(bundle)?),
        }
    }

    /// The plan of a sweep without a calibration; of one with it, the plan with the nominal machine.
    ///
    /// # Errors
    /// As [`Plan::read`].
    pub fn nominal(&self) -> Result<Plan, Error> {
        let plan = match self.calibrate() {
            None => Plan::new(&self.document, &self.folder),
            Some(_) => self.plan(self.nominal_machine()?, Map::new(), None),
        }?;
        // What its tables cannot have is found before anything is simulated.
        let tables = Tables::new(&plan);
        tables.map_err(|error| {
            let error = Error::new("cases", Problem::Other(error.to_string()));
            self.document.locate(error)
        })?;
        Ok(plan)
    }

    /// The calibration that it asks for, into its folder in that of the dataset, `root`. An existing one is used if
    /// it has the same recordings, machine and settings.
    ///
    /// # Errors
    /// A sweep that asks for none; settings, a machine or recordings that cannot be used.
    pub fn prepared(&self, root: &Path) -> Result<Prepared, calibrate::Error> {
        let Some(asked) = self.calibrate() else {
            return Err(self.document.locate(Error::missing("calibrate")).into());
        };
        let machine = self.machine()?;
        let settings = Settings {
            calibration: &asked.settings,
            base: self.folder(),
            machine: machine.as_ref(),
            allow_outside: false,
            clearances_unknown: false,
            locate: &|error: Error| self.locate(error),
        };
        calibrate::prepare(&settings, &root.join(CALIBRATION), Existing::Renew)
    }

    /// The plan with the calibration that the dataset's folder `root` holds; none where it holds none or one of something
    /// else.
    ///
    /// # Errors
    /// Settings or recordings that cannot be used, or a calibration that is damaged.
    pub fn plan_if_kept(&self, root: &Path) -> Result<Option<Plan>, crate::Error> {
        let is_done = self.prepared(root)?.is_done();
        let plan = is_done.then(|| self.kept(&root.join(CALIBRATION)));
        plan.transpose()
    }

    /// Locks the place `root` of the dataset. Where the sweep asks for a calibration, `finish` makes it in the folder that
    /// it is given, and the plan has what was found; else the plan is `nominal`.
    ///
    /// # Errors
    /// Settings or recordings that cannot be used (nothing was written then), a place that cannot be used, or those of
    /// `finish`.
    pub fn claim<E: From<crate::Error>>(
        &self,
        nominal: Plan,
        root: &Path,
        existing: dataset::Existing,
        finish: impl FnOnce(Prepared, &Path) -> Result<(), E>,
    ) -> Result<(Claim, Plan), E> {
        if self.calibrate().is_none() {
            check_calibration(&nominal)?;
            return Ok((Claim::new(root, existing)?, nominal));
        }
        let prepared = self.prepared(root).map_err(crate::Error::from)?;
        let mut claim = Claim::new(root, existing)?;
        let folder = claim.calibration(prepared.is_done())?;
        finish(prepared, &folder)?;
        Ok((claim, self.kept(&folder)?))
    }

    /// The same sweep of the machine with this content.
    ///
    /// # Errors
    /// As [`Sweep::new`].
    pub fn with_machine(&self, machine: Value) -> Result<Self, Error> {
        let mut document = self.document.clone();
        if let Some(sweep) = document.tree.as_object_mut() {
            sweep.insert("machine".into(), machine);
        }
        Self::new(document, &self.folder)
    }

    /// The plan with the calibrated machine, and with its uncertainty where the sweep asks for it.
    /// What the sweep varies itself is left to it.
    ///
    /// # Errors
    /// As [`Plan::read`].
    pub fn calibrated(&self, calibration: &Calibration) -> Result<Plan, Error> {
        let uncertainty = self.calibrate().map(|c| (c.uncertainty, c.undetermined));
        let (uncertainty, undetermined) = uncertainty.unwrap_or_default();
        self.calibrated_with(calibration, uncertainty, undetermined)
    }

    /// The same with so much of its uncertainty.
    fn calibrated_with(
        &self,
        calibration: &Calibration,
        uncertainty: Uncertainty,
        undetermined: Undetermined,
    ) -> Result<Plan, Error> {
        let varied = |path: &str| self.file.vary.0.iter().any(|(own, _)| own == path);
        let mut machine = calibration.machine.clone();
        let sampled = uncertainty == Uncertainty::Sampled;
        let together = sampled.then(|| calibration.together(varied)).flatten();
        let mut alone = calibration.prior(|path| {
            let is_open = undetermined == Undetermined::Prior || sampled && is_relation(path);
            varied(path) || !is_open
        });
        if sampled {
            alone.extend(calibration.relations.drawn(&mut machine, varied)?);
        }
        self.plan(machine, alone, together)
    }

    /// The plan of this file with `machine` in the place of its calibration, and more variation.
    fn plan(
        &self,
        machine: Value,
        alone: Map<String, Value>,
        together: Option<Value>,
    ) -> Result<Plan, Error> {
        let mut document = self.document.clone();
        if let Some(sweep) = document.tree.as_object_mut() {
            sweep.shift_remove("calibrate");
            sweep.insert("machine".into(), machine);
            sweep.insert("calibrated".into(), CALIBRATION.into());
            if !alone.is_empty() {
                let vary = sweep.entry("vary").or_insert_with(|| json!({}));
                if let Some(vary) = vary.as_object_mut() {
                    vary.extend(alone);
                }
            }
            if let Some(entry) = together {
                let list = sweep.entry("vary_together").or_insert_with(|| json!([]));
                if let Some(list) = list.as_array_mut() {
                    list.push(entry);
                }
            }
        }
        Plan::new(&document, &self.folder)
    }
}

/// Whether a value belongs to a relation between clearances, whose nominal exponents are no knowledge.
fn is_relation(path: &str) -> bool {
    path.contains(".relation.")
}

/// The machine section of a bundle as a machine file's tree, at the conditions of the first run.
///
/// # Errors
/// A bundle without such a section, or a mistake in it or in the first run.
pub fn machine_of(bundle: &Bundle) -> Result<Value, Error> {
    if bundle.machine.is_null() {
        return Err(bundle.locate(Error::missing("machine")));
    }
    let tree = input::from_bundle(&bundle.machine);
    let mut tree = tree.map_err(|error| bundle.locate(error.under("machine")))?;
    if let Some(first) = bundle.runs.first() {
        let settings = input::run_settings(&first.section, &tree);
        let settings = settings.map_err(|error| bundle.locate(error.under("runs.0")))?;
        for (path, value) in settings {
            paths::set(&mut tree, &path, value)?;
        }
    }
    Ok(tree)
}

impl Calibration {
    /// The joint distribution of what the recordings determine, as an entry of `vary_together`; none
    /// where that is nothing.
    fn together(&self, varied: impl Fn(&str) -> bool) -> Option<Value> {
        let estimates = self.estimates.iter().enumerate();
        let drawn: Vec<(usize, &Estimate, f64)> = estimates
            .filter(|(_, estimate)| !varied(&estimate.path))
            .filter_map(|(i, estimate)| Some((i, estimate, estimate.deviation?)))
            .collect();
        let parameters: Map<String, Value> = drawn
            .iter()
            .map(|(_, estimate, deviation)| (estimate.path.clone(), estimate.gaussian(*deviation)))
            .collect();
        let correlations: Vec<Vec<f64>> = drawn
            .iter()
            .map(|(i, ..)| {
                drawn
                    .iter()
                    .map(|(j, ..)| self.correlations[*i][*j])
                    .collect()
            })
            .collect();
        let entry = json!({"parameters": parameters, "correlations": correlations});
        (!drawn.is_empty()).then_some(entry)
    }

    /// The search ranges of what the recordings do not determine, as entries of `vary`.
    fn prior(&self, varied: impl Fn(&str) -> bool) -> Map<String, Value> {
        let open = self.estimates.iter().filter(|e| e.deviation.is_none());
        open.filter(|estimate| !varied(&estimate.path))
            .map(|estimate| {
                let rule = if estimate.logarithmic {
                    "log_uniform"
                } else {
                    "uniform"
                };
                (estimate.path.clone(), json!({rule: estimate.bounds}))
            })
            .collect()
    }
}

impl Estimate {
    /// The distribution of its value, as `vary_together` has it.
    fn gaussian(&self, deviation: f64) -> Value {
        let (value, range) = (&self.value, &self.bounds);
        if self.logarithmic {
            let factor = exp(deviation);
            return json!({"lognormal": {"median": value, "factor": factor, "range": range}});
        }
        let deviation = Amount {
            si: deviation,
            dimension: Amount::from_value(value).and_then(|amount| amount.dimension),
        };
        json!({"normal": {"mean": value, "deviation": deviation.to_value(), "range": range}})
    }
}
