//! The joints of a machine that may be worn.

use crate::error::Error;
use input::{paths, unit};
use serde_json::Value;

/// Usual clearance of a bearing over its journal's radius, of a guide over the crosshead's half height: the scale where
/// the file states neither a clearance nor a normal one.
const USUAL: f64 = 1e-3;
/// The least clearance that is searched, over the normal one.
const LEAST: f64 = 1.0 / 3.0;
/// The greatest clearance that is searched: this many times the normal one, or this share of the journal's radius.
const GREATEST: f64 = 10.0;
const GREATEST_SHARE: f64 = 0.02;
/// A clearance stays below this share of the radius.
const BELOW: f64 = 0.5;

/// A joint that may be worn.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Joint {
    /// Its path in the machine file.
    pub path: String,
    /// Its clearance in the machine file, m; none where it is ideal there.
    pub stated: Option<f64>,
    /// Its normal clearance, m.
    pub normal: f64,
    /// Least and greatest clearance that is searched, m.
    pub bounds: [f64; 2],
}

impl Joint {
    /// The joints of a machine file that have the parameters of a clear joint.
    ///
    /// # Errors
    /// A value that is not a length where one belongs.
    pub fn of_machine(tree: &Value) -> Result<Vec<Self>, Error> {
        let mut patterns = vec!["joints.*.clearance"];
        if tree["throws"].is_array() {
            patterns = vec!["joints.main.clearance", "throws.*.joints.*.clearance"];
        }
        let mut joints = Vec::new();
        for pattern in patterns {
            for path in paths::matching(tree, pattern)? {
                joints.push(Self::at(tree, path.trim_end_matches(".clearance"))?);
            }
        }
        Ok(joints)
    }

    fn at(tree: &Value, path: &str) -> Result<Self, Error> {
        let length = |key: &str| length(tree, &format!("{path}.{key}"));
        let stated = length("clearance")?.filter(|clearance| *clearance > 0.0);
        let size = match length("journal_radius")? {
            Some(radius) => Some(radius),
            None => length("half_height")?,
        };
        let size = size.ok_or_else(|| Error::Parameter {
            path: path.to_owned(),
            reason: "it has neither a journal radius nor a half height".to_owned(),
        })?;
        let normal = length("normal_clearance")?.filter(|clearance| *clearance > 0.0);
        let normal = normal.or(stated).unwrap_or(USUAL * size);
        let least = stated.unwrap_or(normal).min(normal) * LEAST;
        let greatest = (GREATEST * normal).max(GREATEST_SHARE * size);
        let greatest = greatest
            .max(GREATEST * stated.unwrap_or(0.0))
            .min(BELOW * size);
        Ok(Self {
            path: path.to_owned(),
            stated,
            normal,
            bounds: [least, greatest],
        })
    }

    /// Where its clearance stands.
    pub fn clearance_path(&self) -> String {
        format!("{}.clearance", self.path)
    }

    /// The clearance from which its search leads, m: that of the machine file, or the normal one.
    pub fn start(&self) -> f64 {
        self.stated.unwrap_or(self.normal)
    }
}

/// The length at a path, m; none where there is none.
fn length(tree: &Value, path: &str) -> Result<Option<f64>, Error> {
    // A guide has no journal, and a bearing no height.
    let Ok(value) = paths::get(tree, path) else {
        return Ok(None);
    };
    let Some(text) = value
        .and_then(Value::as_str)
        .filter(|text| *text != "ideal")
    else {
        return Ok(None);
    };
    let measure = unit::parse_clearance(text).map_err(|error| Error::Parameter {
        path: path.to_owned(),
        reason: format!("'{text}': {error}"),
    })?;
    Ok(Some(measure.si))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn machine(name: &str) -> Value {
        let file = format!("{}/../../data/machines/{name}", env!("CARGO_MANIFEST_DIR"));
        let file = input::machine_file::read(Path::new(&file)).unwrap();
        file.to_tree().clone()
    }

    #[test]
    fn every_joint_of_every_throw_may_be_worn() {
        let joints = Joint::of_machine(&machine("two-stage.yaml")).unwrap();
        let paths: Vec<&str> = joints.iter().map(|joint| joint.path.as_str()).collect();
        let mut expected = vec!["joints.main".to_owned()];
        for throw in ["throw1", "throw2"] {
            expected.extend(
                ["big_end", "small_end", "guide"]
                    .map(|name| format!("throws.{throw}.joints.{name}")),
            );
        }
        let mut sorted = paths.clone();
        sorted.sort_unstable();
        expected.sort_unstable();
        assert_eq!(sorted, expected);
        let big = joints
            .iter()
            .find(|j| j.path.ends_with("throw2.joints.big_end"))
            .unwrap();
        assert_eq!((big.stated, big.normal), (Some(1e-4), 1.2e-4));
        assert!((big.bounds[1] - 2.2e-3).abs() < 1e-12, "{big:?}");
        let guide = joints.iter().find(|j| j.path.ends_with("guide")).unwrap();
        assert_eq!((guide.stated, guide.start()), (None, 2e-4));
    }

    #[test]
    fn without_a_normal_clearance_the_stated_one_is_normal_and_else_a_usual_one() {
        let mut tree = machine("single-stage.yaml");
        let joint = tree["joints"]["big_end"].as_object_mut().unwrap();
        joint.remove("normal_clearance");
        let of = |tree: &Value| Joint::at(tree, "joints.big_end").unwrap();
        assert!((of(&tree).normal - 5e-5).abs() < 1e-18);
        tree["joints"]["big_end"]["clearance"] = "0.02 mm".into();
        assert_eq!((of(&tree).normal, of(&tree).start()), (2e-5, 2e-5));
        tree["joints"]["big_end"]["normal_clearance"] = "0.003 in diametral".into();
        assert!((of(&tree).normal - 0.0015 * 0.0254).abs() < 1e-15);
    }
}
