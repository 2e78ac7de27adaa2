//! The parameters that a sweep sets or varies.

use input::paths;
use recordings::Role;
use serde_json::Value;

use super::Plan;
use super::block::Block;
use super::parameter::Parameter;
use crate::effects::{Amplitude, VariedEffect};
use crate::sweep_file::Amount;

impl Plan {
    /// The parameters of the sweep, whose effects are known: what varies, what the blocks set, and the
    /// amplitudes of varied effects that are not among these.
    pub(super) fn find_parameters(&self) -> Vec<Parameter> {
        let varied: Vec<&str> = self.varied().map(|(_, path)| path).collect();
        let set = self.blocks.iter().flat_map(Block::paths);
        let mut paths = varied.clone();
        paths.extend(set.map(|(path, _)| path));
        let mut seen = std::collections::BTreeSet::new();
        let has_column = |path: &str| {
            path == "speed"
                || path.ends_with("cylinder.suction")
                || path.ends_with("cylinder.discharge")
                || self.joints.iter().any(|j| j.clearance_path == path)
        };
        paths.retain(|path| !has_column(path) && seen.insert(*path));
        let role = |path: &str| match varied.contains(&path) {
            _ if is_of_a_label(self, path) => Role::Label,
            true => Role::Unknown,
            false => Role::Condition,
        };
        let own = paths.iter().map(|path| parameter(self, path, role(path)));
        let amplitudes = self.effects.iter().flat_map(|effect| {
            let amplitudes = effect.amplitudes.iter();
            amplitudes.map(move |amplitude| (effect, amplitude))
        });
        let others = amplitudes.filter(|(effect, amplitude)| {
            let place = keys_of(self, effect, amplitude);
            let leads_there = |path: &&str| place.is_some() && keys(self, path) == place;
            !paths.iter().any(leads_there)
        });
        // A path that the sweep sets is a column already, and may lead to the same effect at another place.
        let others = others.filter_map(|(effect, amplitude)| {
            let is_taken = |amplitude: &Amplitude| paths.contains(&amplitude.path.as_str());
            let named = match is_taken(amplitude) {
                true => effect.at_its_place(amplitude),
                false => amplitude.clone(),
            };
            (!is_taken(&named)).then(|| Parameter::of_amplitude(effect, &named))
        });
        own.chain(others).collect()
    }
}

/// The parameter at `path`, by the machine file or else by the first case. It is a number only if
/// no case has another kind of value there, such as a stiffness by a formula.
fn parameter(plan: &Plan, path: &str, role: Role) -> Parameter {
    let value = |tree: &Value| {
        paths::get(tree, path)
            .ok()
            .flatten()
            .and_then(Amount::from_value)
    };
    let first = || value(&plan.case_before_splits(0).ok()?.tree);
    let amount = value(&plan.tree).or_else(first);
    let amount = amount.filter(|_| !plan.listed(path).any(|v| Amount::from_value(&v).is_none()));
    let unit = amount.and_then(|a| a.dimension).map(|d| d.to_string());
    Parameter::at(path, amount.is_some(), unit, role)
}

/// Whether `path` is that of a value of a varied effect, or of something that holds one. All its values describe the fault: a
/// frequency that only a fluttering valve has gives it away.
fn is_of_a_label(plan: &Plan, path: &str) -> bool {
    let of_effect = path.strip_prefix("effects.");
    let named = of_effect.and_then(|value| value.split('.').next());
    if plan
        .effects
        .iter()
        .any(|effect| named == Some(effect.name()))
    {
        return true;
    }
    let Some(keys) = keys(plan, path) else {
        return false;
    };
    if keys == ["effects"] {
        return !plan.effects.is_empty();
    }
    plan.effects.iter().any(|effect| {
        let amplitudes = effect.amplitudes.iter();
        let mut places = amplitudes.filter_map(|amplitude| keys_of(plan, effect, amplitude));
        let holds = |place: &Vec<String>| place.starts_with(&keys) || keys.starts_with(&place[..3]);
        places.any(|place| holds(&place))
    })
}

/// Keys and indices of an amplitude in the sweep's machine file, where that has the effect.
fn keys_of(plan: &Plan, effect: &VariedEffect, amplitude: &Amplitude) -> Option<Vec<String>> {
    let index = effect.index_in(&plan.tree)?.to_string();
    let keys = ["effects", &index, effect.name(), amplitude.parameter.key];
    Some(keys.map(str::to_owned).into())
}

fn keys(plan: &Plan, path: &str) -> Option<Vec<String>> {
    paths::keys(&plan.tree, path).ok()
}
