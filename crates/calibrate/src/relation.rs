//! Which relation between clearances a machine's contact parameters follow.

use crate::error::Error;
use crate::parameter::Parameter;
use input::{paths, unit};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// A relation between the contact parameters of a joint at different clearances. Each is described in
/// [`mechanism::joints::clearance_relation`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Relation {
    /// The stiffness by Eq. (5) of the papers.
    #[serde(rename = "eq5")]
    Equation5,
    /// The stiffness by the conformal form of Hertz's formula.
    Conformal,
    /// Nothing depends on the clearance.
    Constant,
    /// Fitted powers of the clearance: one for the stiffness and one for the damping of
    /// all joints, so that two joints' recordings support each other. The depth stays.
    Fitted,
}

/// Exponents that a fit of the relation starts from, and keeps where they are not identifiable: those of Eq. (5),
/// of stiffness and damping.
const NOMINAL: [f64; 2] = [0.0, -0.2];
/// Exponent of the clearance that the stiffness of a conformal bearing follows.
const CONFORMAL: f64 = -0.5;
/// Exponent of the penetration in Hertz's law, which is that of a contact that states none.
const HERTZ: f64 = 1.5;

impl Relation {
    /// All of them.
    pub const ALL: [Self; 4] = [
        Self::Equation5,
        Self::Conformal,
        Self::Constant,
        Self::Fitted,
    ];

    /// Its name in commands and results.
    pub fn name(self) -> &'static str {
        match self {
            Self::Equation5 => "eq5",
            Self::Conformal => "conformal",
            Self::Constant => "constant",
            Self::Fitted => "fitted",
        }
    }

    /// What stands for it in a machine file.
    fn content(self) -> Value {
        match self {
            Self::Fitted => json!({"stiffness": NOMINAL[0], "damping": NOMINAL[1]}),
            named => named.name().into(),
        }
    }

    /// Gives the contact of `joints` this relation, and the clearance from which it leads where the
    /// machine file `tree` states none.
    ///
    /// # Errors
    /// A joint that the file does not have.
    pub fn set(self, tree: &mut Value, joints: &[ClearJoint]) -> Result<(), Error> {
        for joint in joints {
            let [relation, from] = joint.keys();
            if paths::get(tree, &from)?.is_none() {
                paths::set(tree, &from, joint.text.clone().into())?;
            }
            paths::set(tree, &relation, self.content())?;
        }
        Ok(())
    }
}

/// A bearing that is clear in some run.
#[derive(Clone, Debug, PartialEq)]
pub struct ClearJoint {
    /// Its path in the machine file: `throws.throw1.joints.big_end`.
    pub path: String,
    /// The smallest clearance that it has in a run, m: its normal one.
    pub clearance: f64,
    /// The same as the run has it.
    text: String,
}

impl ClearJoint {
    /// The bearings of the machine file `tree` that are clear in one of the runs, whose settings
    /// these are. A guide is not one of them: its faces have no radius, and no relation holds for it.
    ///
    /// # Errors
    /// A clearance that is no length.
    pub fn in_runs<'a>(
        tree: &Value,
        runs: impl Iterator<Item = &'a [(String, Value)]> + Clone,
    ) -> Result<Vec<Self>, Error> {
        let mut joints = Vec::new();
        for path in paths::matching(tree, &pattern(tree, "journal_radius"))? {
            let path = path.trim_end_matches(".journal_radius").to_owned();
            let mut smallest: Option<Self> = None;
            for settings in runs.clone() {
                let Some((clearance, text)) = clearance(tree, settings, &path)? else {
                    continue;
                };
                if smallest.as_ref().is_none_or(|s| clearance < s.clearance) {
                    smallest = Some(Self {
                        path: path.clone(),
                        clearance,
                        text,
                    });
                }
            }
            joints.extend(smallest);
        }
        Ok(joints)
    }

    /// What the machine file has for its relation; none where it has none.
    ///
    /// # Errors
    /// A joint that the file does not have.
    pub fn relation<'a>(&self, tree: &'a Value) -> Result<Option<&'a Value>, Error> {
        Ok(paths::get(tree, &self.keys()[0])?)
    }

    /// The clearance from which its relation leads, m; none where the machine file has none.
    ///
    /// # Errors
    /// A clearance that is no length.
    pub fn at_clearance(&self, tree: &Value) -> Result<Option<f64>, Error> {
        at_clearance(tree, &self.path)
    }

    /// The path of its clearance.
    pub fn clearance_path(&self) -> String {
        format!("{}.clearance", self.path)
    }

    fn keys(&self) -> [String; 2] {
        ["relation", "at_clearance"].map(|key| format!("{}.contact.{key}", self.path))
    }
}

/// The clearances of `joints` in a run with these settings, m; none for one that is ideal there.
///
/// # Errors
/// A clearance that is no length.
pub fn clearances(
    tree: &Value,
    joints: &[ClearJoint],
    settings: &[(String, Value)],
) -> Result<Vec<Option<f64>>, Error> {
    let of = |joint: &ClearJoint| Ok(clearance(tree, settings, &joint.path)?.map(|(c, _)| c));
    joints.iter().map(of).collect()
}

/// Whether some joint has several clearances in these runs. Each run has a clearance per joint, m, as [`clearances`]
/// gives them.
pub fn several(runs: &[Vec<Option<f64>>]) -> bool {
    let joints = runs.first().map_or(0, Vec::len);
    (0..joints).any(|joint| {
        let mut clear = runs.iter().filter_map(|run| run[joint]);
        let first = clear.next();
        clear.any(|c| Some(c) != first)
    })
}

/// The parameters of [`Relation::Fitted`]: the exponents of stiffness and damping that the joints
/// of the machine file `tree` share. The relation has to be set first.
///
/// # Errors
/// A machine file without such exponents, or in which they differ.
pub fn exponents(tree: &Value) -> Result<Vec<Parameter>, Error> {
    ["stiffness", "damping"]
        .map(|key| Parameter::at(tree, &pattern(tree, &format!("contact.relation.{key}"))))
        .into_iter()
        .collect()
}

/// The clearance from which the relation of the joint at `path` leads, m; none where the machine file has none.
///
/// # Errors
/// A clearance that is no length.
pub(crate) fn at_clearance(tree: &Value, path: &str) -> Result<Option<f64>, Error> {
    let key = format!("{path}.contact.at_clearance");
    let text = paths::get(tree, &key)?.and_then(Value::as_str);
    text.map(|text| length(&key, text)).transpose()
}

/// Gives the contacts of `joints` the powers of the clearance that their named relations come to. A relation has to be set
/// first.
///
/// # Errors
/// A joint that the file does not have.
pub(crate) fn set_powers(tree: &mut Value, joints: &[ClearJoint]) -> Result<(), Error> {
    for joint in joints {
        let exponent = paths::get(tree, &format!("{}.contact.exponent", joint.path))?;
        let exponent = exponent.and_then(Value::as_f64).unwrap_or(HERTZ);
        let patch = CONFORMAL / (exponent + 1.0);
        let exponents = match joint.relation(tree)? {
            Some(Value::Object(stated)) => ["stiffness", "damping", "depth"]
                .map(|key| stated.get(key).and_then(Value::as_f64).unwrap_or(0.0)),
            Some(Value::String(name)) if name == Relation::Conformal.name() => {
                [CONFORMAL, patch, -patch]
            }
            Some(Value::String(name)) if name == Relation::Equation5.name() => [0.0, patch, 0.0],
            _ => [0.0; 3],
        };
        let [stiffness, damping, depth] = exponents;
        let powers = json!({"stiffness": stiffness, "damping": damping, "depth": depth});
        paths::set(tree, &joint.keys()[0], powers)?;
    }
    Ok(())
}

/// The exponents of stiffness and damping that the contacts of `joints` follow, as [`set_powers`] has them: shared by all where
/// they are equal, and else one for each.
///
/// # Errors
/// A machine file without such exponents.
pub(crate) fn exponents_of(tree: &Value, joints: &[ClearJoint]) -> Result<Vec<Parameter>, Error> {
    if joints.is_empty() {
        return Ok(Vec::new());
    }
    if let Ok(shared) = exponents(tree)
        && joints.iter().all(|joint| {
            let path = &joint.path;
            let place = |key: &str| format!("{path}.contact.relation.{key}");
            shared[0].places.contains(&place("stiffness"))
        })
    {
        return Ok(shared);
    }
    let paths = joints.iter().flat_map(|joint| {
        ["stiffness", "damping"].map(|key| format!("{}.contact.relation.{key}", joint.path))
    });
    paths.map(|path| Parameter::at(tree, &path)).collect()
}

/// The paths of every joint's `key`.
fn pattern(tree: &Value, key: &str) -> String {
    let throws = if tree["throws"].is_array() {
        "throws.*."
    } else {
        ""
    };
    format!("{throws}joints.*.{key}")
}

/// The clearance of the joint at `path` in a run: m, and as it is written.
fn clearance(
    tree: &Value,
    settings: &[(String, Value)],
    path: &str,
) -> Result<Option<(f64, String)>, Error> {
    let key = format!("{path}.clearance");
    let of_run = settings.iter().rev().find(|(path, _)| *path == key);
    let value = match of_run {
        Some((_, value)) => Some(value),
        None => paths::get(tree, &key)?,
    };
    match value.and_then(Value::as_str) {
        None | Some("ideal") => Ok(None),
        Some(text) => {
            let clearance = length(&key, text)?;
            Ok((clearance > 0.0).then(|| (clearance, text.to_owned())))
        }
    }
}

/// The length that stands at `key`, m.
fn length(key: &str, text: &str) -> Result<f64, Error> {
    let measure = unit::parse_clearance(text).map_err(|error| Error::Parameter {
        path: key.to_owned(),
        reason: format!("'{text}': {error}"),
    })?;
    Ok(measure.si)
}
