//! The words `radial` and `diametral` in files that set values by path: they belong at clearances alone.

use crate::error::{Error, join};
use crate::unit::{UnitError, parse};
use serde_json::Value;

/// Last parts of the paths that lead to a clearance.
const CLEARANCES: [&str; 4] = ["clearance", "normal_clearance", "at_clearance", "change"];

/// Checks that no value of `tree` but a clearance says how it is measured: `vary: {crank.radius: 150 mm diametral}`
/// would be a slip. A value belongs to the path among its keys, or to the one that its section names as `path`.
///
/// # Errors
/// The first such value.
pub fn check(tree: &Value) -> Result<(), Error> {
    walk(tree, "", false)
}

fn walk(node: &Value, key: &str, is_clearance: bool) -> Result<(), Error> {
    match node {
        Value::String(text) if !is_clearance && parse(text) == Err(UnitError::Sided) => {
            Err(Error::clash(
                key,
                "a value without it: only a clearance is radial or diametral",
            ))
        }
        Value::Array(items) => items
            .iter()
            .enumerate()
            .try_for_each(|(i, item)| walk(item, &join(key, &i.to_string()), is_clearance)),
        Value::Object(section) => {
            let path = section
                .get("path")
                .and_then(Value::as_str)
                .unwrap_or_default();
            section.iter().try_for_each(|(name, value)| {
                let is_clearance = is_clearance || leads_there(name) || leads_there(path);
                walk(value, &join(key, name), is_clearance)
            })
        }
        _ => Ok(()),
    }
}

fn leads_there(path: &str) -> bool {
    path.rsplit('.')
        .next()
        .is_some_and(|last| CLEARANCES.contains(&last))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn only_clearances_are_sided() {
        for right in [
            json!({"vary": {"joints.*.clearance": {"uniform": ["0.1 mm diametral", "0.2 mm diametral"]}}}),
            json!({"cases": [{"grid": {"clearance": ["0.1 mm radial"]}}]}),
            json!({"bifurcations": [{"path": "joints.main.clearance", "from": "0.1 mm diametral"}]}),
            json!({"name": "diametral"}),
        ] {
            assert_eq!(check(&right), Ok(()));
        }
        let wrong = json!({"vary": {"crank.radius": {"uniform": ["150 mm diametral", "0.2 m"]}}});
        assert_eq!(
            check(&wrong).unwrap_err().key(),
            "vary.crank.radius.uniform.0"
        );
        let wrong = json!({"bifurcations": [{"path": "crank.radius", "from": "0.1 mm diametral"}]});
        assert_eq!(check(&wrong).unwrap_err().key(), "bifurcations.0.from");
    }
}
