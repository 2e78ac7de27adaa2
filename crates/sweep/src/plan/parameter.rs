//! What a sweep sets or varies beside clearances, speed and pressures, as columns.

use input::paths;
use recordings::Role;
use serde_json::Value;

use super::{Block, Plan};
use crate::effects::{Amplitude, VariedEffect};
use crate::sweep_file::Amount;

/// Something that a sweep sets or varies.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Path in the machine file.
    pub path: String,
    /// Name of its column: the path and the unit, `joints.big_end.contact.damping_n_s_m`.
    pub column: String,
    /// Unit, where it is a quantity.
    pub unit: Option<String>,
    /// Whether it is a number; text otherwise.
    pub is_number: bool,
    /// A label where it says how large a varied effect is, an unknown where it is drawn, else a
    /// condition.
    pub role: Role,
    /// The effect whose amplitude it is, where the path alone does not lead to it in every case.
    amplitude: Option<(VariedEffect, Amplitude)>,
}

impl Parameter {
    /// Its value in the case with the machine file `tree`; none where that does not have it.
    pub(crate) fn value(&self, tree: &Value) -> recordings::Value {
        if let Some((effect, amplitude)) = &self.amplitude {
            return effect.value(amplitude, tree).into();
        }
        match paths::get(tree, &self.path).ok().flatten() {
            Some(value) if self.is_number => Amount::of(value).map(|a| a.si).into(),
            Some(Value::String(text)) => text.as_str().into(),
            Some(value) => value.to_string().into(),
            None => recordings::Value::Missing,
        }
    }
}

/// The parameters of `plan`, whose effects are known: what varies, what the blocks set, and the
/// amplitudes of varied effects that are not among these.
pub(super) fn find(plan: &Plan) -> Vec<Parameter> {
    let varied: Vec<&str> = plan.varied().map(|(_, path)| path).collect();
    let set = plan.blocks.iter().flat_map(Block::paths);
    let mut paths = varied.clone();
    paths.extend(set.map(|(path, _)| path));
    let mut seen = std::collections::BTreeSet::new();
    let has_column = |path: &str| {
        path == "speed"
            || path.ends_with("cylinder.suction")
            || path.ends_with("cylinder.discharge")
            || plan.joints.iter().any(|j| j.clearance_path == path)
    };
    paths.retain(|path| !has_column(path) && seen.insert(*path));
    let role = |path: &str| match varied.contains(&path) {
        _ if is_of_a_label(plan, path) => Role::Label,
        true => Role::Unknown,
        false => Role::Condition,
    };
    let own = paths.iter().map(|path| parameter(plan, path, role(path)));
    let amplitudes = plan.effects.iter().flat_map(|effect| {
        let amplitudes = effect.amplitudes.iter();
        amplitudes.map(move |amplitude| (effect, amplitude))
    });
    let others = amplitudes.filter(|(effect, amplitude)| {
        let place = keys_of(plan, effect, amplitude);
        let leads_there = |path: &&str| place.is_some() && keys(plan, path) == place;
        !paths.iter().any(leads_there)
    });
    let others = others.map(|(effect, amplitude)| size(effect, amplitude));
    own.chain(others).collect()
}

/// How `path` stands in the file and in the first case that says what it is: a number only if no case has
/// anything else there, such as a stiffness by a formula.
fn parameter(plan: &Plan, path: &str, role: Role) -> Parameter {
    let value = |tree: &Value| paths::get(tree, path).ok().flatten().and_then(Amount::of);
    let first = || value(&plan.case_before_splits(0).ok()?.tree);
    let amount = value(&plan.tree).or_else(first);
    let amount = amount.filter(|_| !plan.listed(path).any(|v| Amount::of(&v).is_none()));
    let unit = amount.and_then(|a| a.dimension).map(|d| d.to_string());
    let suffix = unit.as_deref().map_or(String::new(), suffix);
    Parameter {
        path: path.to_owned(),
        column: format!("{path}{suffix}"),
        is_number: amount.is_some(),
        unit,
        role,
        amplitude: None,
    }
}

/// The column of an amplitude.
fn size(effect: &VariedEffect, amplitude: &Amplitude) -> Parameter {
    let unit = amplitude.parameter.dimension.map(|d| d.to_string());
    let suffix = unit.as_deref().map_or(String::new(), suffix);
    Parameter {
        path: amplitude.path.clone(),
        column: format!("{}{suffix}", amplitude.path),
        is_number: true,
        unit,
        role: Role::Label,
        amplitude: Some((effect.clone(), amplitude.clone())),
    }
}

/// Whether `path` is that of an amplitude of a varied effect, or of something that holds one.
fn is_of_a_label(plan: &Plan, path: &str) -> bool {
    let Some(keys) = keys(plan, path) else {
        return false;
    };
    if keys == ["effects"] {
        return !plan.effects.is_empty();
    }
    plan.effects.iter().any(|effect| {
        let amplitudes = effect.amplitudes.iter();
        let mut places = amplitudes.filter_map(|amplitude| keys_of(plan, effect, amplitude));
        places.any(|place| place.starts_with(&keys))
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

/// `_n_s_m` of `N s/m`: the ending of a column's name.
fn suffix(unit: &str) -> String {
    let parts = unit.split([' ', '/']).filter(|part| *part != "%");
    let plain = |part: &str| part.replace(['^', '.'], "").to_lowercase();
    parts.map(|part| format!("_{}", plain(part))).collect()
}
