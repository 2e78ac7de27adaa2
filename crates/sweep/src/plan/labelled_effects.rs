//! The effects that a sweep varies, from the values that its blocks set and those that it draws.

use input::paths;
use serde_json::Value;

use super::Plan;
use super::together::Together;
use crate::effects::{VariedEffect, varied};

impl Plan {
    /// The effects that differ among the cases, found from files that show every value of each axis.
    pub(super) fn find_effects(&self) -> Vec<VariedEffect> {
        let is_of_effects = |path: &str| path.split('.').next() == Some("effects");
        let alone = self.vary.iter().flat_map(|varied| {
            let places = varied.places.iter();
            places.map(|place| (place.as_str(), varied.sampler.representatives()))
        });
        let together = self.together.iter().flat_map(Together::representatives);
        let mut unknowns: Vec<(&str, Vec<Value>)> = alone.chain(together).collect();
        unknowns.retain(|(path, _)| is_of_effects(path));
        let mut chosen = Vec::new();
        for block in &self.blocks {
            let mut axes = block.paths();
            axes.retain(|(path, _)| is_of_effects(path));
            chosen.extend(one_at_a_time(&self.tree, &axes));
        }
        varied(&chosen, &one_at_a_time(&self.tree, &unknowns), &self.tree)
    }
}

/// `tree` with the first value of every axis, and with each other value in the place of its first.
fn one_at_a_time(tree: &Value, axes: &[(&str, Vec<Value>)]) -> Vec<Value> {
    let mut first = tree.clone();
    for (path, values) in axes {
        // A value that cannot be set is reported when the cases are tried.
        let _ = values
            .first()
            .map(|v| paths::set(&mut first, path, v.clone()));
    }
    let mut all = vec![first.clone()];
    for (path, values) in axes {
        for value in values.iter().skip(1) {
            let mut other = first.clone();
            if paths::set(&mut other, path, value.clone()).is_ok() {
                all.push(other);
            }
        }
    }
    all
}
