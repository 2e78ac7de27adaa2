//! What a sweep sets or varies beside clearances, speed and pressures, as columns.

use input::paths;
use recordings::Role;
use serde_json::Value;

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
    pub fn value(&self, tree: &Value) -> recordings::Value {
        if let Some((effect, amplitude)) = &self.amplitude {
            return effect.value(amplitude, tree).into();
        }
        match paths::get(tree, &self.path).ok().flatten() {
            Some(value) if self.is_number => Amount::from_value(value).map(|a| a.si).into(),
            Some(Value::String(text)) => text.as_str().into(),
            Some(value) => value.to_string().into(),
            None => recordings::Value::Missing,
        }
    }

    /// The parameter at `path`.
    pub(super) fn at(path: &str, is_number: bool, unit: Option<String>, role: Role) -> Self {
        let suffix = unit.as_deref().map_or(String::new(), suffix);
        Self {
            path: path.to_owned(),
            column: format!("{path}{suffix}"),
            is_number,
            unit,
            role,
            amplitude: None,
        }
    }

    /// The parameter that is the amplitude of a varied effect.
    pub(super) fn of_amplitude(effect: &VariedEffect, amplitude: &Amplitude) -> Self {
        let unit = amplitude.parameter.dimension.map(|d| d.to_string());
        Self {
            amplitude: Some((effect.clone(), amplitude.clone())),
            ..Self::at(&amplitude.path, true, unit, Role::Label)
        }
    }
}

/// `_n_s_m` of `N s/m`: the ending of a column's name.
fn suffix(unit: &str) -> String {
    let parts = unit.split([' ', '/']).filter(|part| *part != "%");
    let plain = |part: &str| part.replace(['^', '.'], "").to_lowercase();
    parts.map(|part| format!("_{}", plain(part))).collect()
}
