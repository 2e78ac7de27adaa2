//! What is fitted: paths of the machine file, and the coordinates in which they are searched.

use crate::error::Error;
use input::paths;
use input::unit::{self, Dimension, Measure};
use serde_json::Value;

/// A fitted value of the machine file.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Its path in the machine file. With `*` for a part, one value that several places share:
    /// `joints.*.friction.coefficient`.
    pub path: String,
    /// The places that hold it; the offset of the crank angle has no place.
    pub places: Vec<String>,
    /// The run that it is a condition of, `*` for what every run states, times one factor; none where it holds for the machine.
    pub run: Option<String>,
    /// Its value there, SI.
    pub nominal: f64,
    /// Its unit; none for a bare number.
    pub dimension: Option<Dimension>,
    /// On what scale it is searched.
    pub scale: Scale,
    /// Least and greatest value, SI.
    pub bounds: [f64; 2],
}

/// Stands in place of a run's name where every run has what it states times the same factor: a gauge that is off.
pub(crate) const EACH_RUN: &str = "*";

/// The scale on which a parameter is searched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Its logarithm: for positive values that are known to a factor.
    Logarithmic,
    /// The value over half the width of its bounds.
    Linear,
}

/// Without bounds of its own a value is searched from a tenth to ten times the nominal one.
const FACTOR: f64 = 10.0;
/// Lengths, masses and other values that are measured with a rule or a balance are searched from
/// two thirds to 1.5 times the nominal one.
const MEASURED_FACTOR: f64 = 1.5;
/// Last keys of paths that are known to a factor only.
const UNCERTAIN: [&str; 7] = [
    "stiffness",
    "damping",
    "depth",
    "coefficient",
    "slip_speed",
    "damping_ratio",
    "clearance",
];

/// Exponents of a relation between clearances are searched from twice that of a conformal bearing's
/// stiffness, −1/2, to as much the other way.
const EXPONENTS: [f64; 2] = [-1.0, 0.5];

impl Parameter {
    /// The value at `path` of the machine file `tree`, with bounds around its nominal value.
    ///
    /// # Errors
    /// A path that is not there, whose value is no quantity, or 0; places that should share a value
    /// and differ.
    pub fn at(tree: &Value, path: &str) -> Result<Self, Error> {
        let found = Found::at(tree, path)?;
        let last = path.rsplit('.').next().unwrap_or(path);
        let nominal = found.nominal;
        let effect = input::effects::at_path(path);
        let bounds = if let Some(effect) = effect.filter(|e| e.absent.is_none() || nominal != 0.0) {
            let [low, high] = effect.bounds;
            [low.min(nominal), high.max(nominal)]
        } else if path.contains(".relation.") {
            [
                EXPONENTS[0].min(nominal - 0.5),
                EXPONENTS[1].max(nominal + 0.5),
            ]
        } else if nominal == 0.0 {
            let reason = "its nominal value is 0, which gives no scale; state its bounds";
            return Err(refusal(path, reason));
        } else {
            let factor = if UNCERTAIN.contains(&last) {
                FACTOR
            } else {
                MEASURED_FACTOR
            };
            let mut bounds = [nominal / factor, nominal * factor];
            // An exponent of 1 is a limit that no law goes below.
            if last.ends_with("exponent") {
                bounds[0] = bounds[0].max(1.01);
            }
            bounds.sort_by(f64::total_cmp);
            bounds
        };
        Ok(found.within(path, bounds))
    }

    /// The same with bounds of its own, SI. It is searched on a logarithmic scale where both are
    /// above 0.
    ///
    /// # Errors
    /// As [`Parameter::at`]; bounds that do not enclose the nominal value.
    pub fn within(tree: &Value, path: &str, bounds: [f64; 2]) -> Result<Self, Error> {
        let found = Found::at(tree, path)?;
        let [mut low, high] = bounds;
        // An effect without amplitude is absent, and has no derivative.
        if let Some(effect) = input::effects::at_path(path)
            && low == 0.0
            && effect.absent == Some(0.0)
        {
            if found.nominal == 0.0 {
                let reason = "its value is 0, where the effect is absent; start above it";
                return Err(refusal(path, reason));
            }
            low = effect.bounds[0].min(found.nominal);
        }
        let bounds = [low, high];
        if !(low < high && (low..=high).contains(&found.nominal)) {
            let reason = format!(
                "its bounds are {low} and {high}, and do not enclose its value {} (in SI)",
                found.nominal
            );
            return Err(refusal(path, reason));
        }
        Ok(found.within(path, bounds))
    }

    /// The coordinate of a value: 0 at the nominal one.
    pub fn coordinate(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Logarithmic => (value / self.nominal).ln(),
            Scale::Linear => (value - self.nominal) / self.half_width(),
        }
    }

    /// The value at a coordinate, SI.
    pub fn value(&self, coordinate: f64) -> f64 {
        match self.scale {
            Scale::Logarithmic => self.nominal * coordinate.exp(),
            Scale::Linear => self.nominal + coordinate * self.half_width(),
        }
    }

    /// The derivative of the coordinate by the value.
    pub(crate) fn slope(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Logarithmic => 1.0 / value,
            Scale::Linear => 1.0 / self.half_width(),
        }
    }

    /// The standard error of a value whose coordinate has this one, SI.
    pub fn error(&self, value: f64, of_coordinate: f64) -> f64 {
        of_coordinate / self.slope(value).abs()
    }

    fn half_width(&self) -> f64 {
        0.5 * (self.bounds[1] - self.bounds[0])
    }

    /// The coordinates of the bounds.
    pub fn box_bounds(&self) -> [f64; 2] {
        self.bounds.map(|bound| self.coordinate(bound))
    }

    /// Writes a value into a machine file, at every place. A condition of a run does not belong to the
    /// machine, and is not written.
    ///
    /// # Errors
    /// Where the file does not have a place.
    pub fn write(&self, tree: &mut Value, value: f64) -> Result<(), Error> {
        match self.run {
            Some(_) => Ok(()),
            None => self.write_everywhere(tree, value),
        }
    }

    /// Writes a value into the machine file of a run, if it holds there.
    ///
    /// # Errors
    /// Where the file does not have a place.
    pub fn write_for(&self, run: &str, tree: &mut Value, value: f64) -> Result<(), Error> {
        match self.holds_in(run) {
            true if self.is_of_each_run() => {
                for place in &self.places {
                    let (stated, _) = quantity(tree, place)?;
                    paths::set(tree, place, self.written(stated * value / self.nominal))?;
                }
                Ok(())
            }
            true => self.write_everywhere(tree, value),
            false => Ok(()),
        }
    }

    /// Whether it holds in a run.
    pub fn holds_in(&self, run: &str) -> bool {
        self.run.as_ref().is_none_or(|of| of == run) || self.is_of_each_run()
    }

    /// The same as a factor to what every run states.
    pub(crate) fn of_each_run(self) -> Self {
        Self {
            path: format!("runs.{EACH_RUN}.{}", self.path),
            run: Some(EACH_RUN.to_owned()),
            ..self
        }
    }

    /// Whether it is a factor to what every run states.
    pub fn is_of_each_run(&self) -> bool {
        self.run.as_deref() == Some(EACH_RUN)
    }

    /// Whether it changes the motion in a run of this name. A condition of another run does not, nor does an offset
    /// of the recorded crank angle.
    pub(crate) fn moves(&self, run: &str) -> bool {
        self.holds_in(run) && !self.is_crank_angle_offset()
    }

    /// Whether it is the clearance of a joint, searched on a logarithmic scale.
    pub(crate) fn is_clearance(&self) -> bool {
        let of_joint = |place: &String| place.contains("joints.") && place.ends_with(".clearance");
        self.scale == Scale::Logarithmic && self.places.iter().any(of_joint)
    }

    /// Whether it is by how much the recorded crank angle is ahead of the crank.
    pub fn is_crank_angle_offset(&self) -> bool {
        self.places.is_empty()
    }

    fn write_everywhere(&self, tree: &mut Value, value: f64) -> Result<(), Error> {
        for place in &self.places {
            paths::set(tree, place, self.written(value))?;
        }
        Ok(())
    }

    /// A value as a machine file has it.
    pub(crate) fn written(&self, si: f64) -> Value {
        match self.dimension {
            Some(dimension) => Measure { si, dimension }.to_string().into(),
            None => Value::from(si),
        }
    }
}

/// What a machine file has at the places of a path.
struct Found {
    places: Vec<String>,
    nominal: f64,
    dimension: Option<Dimension>,
}

impl Found {
    fn at(tree: &Value, path: &str) -> Result<Self, Error> {
        let places = paths::matching(tree, path)?;
        let Some(first) = places.first() else {
            return Err(refusal(path, "the machine file has no value there"));
        };
        let (nominal, dimension) = quantity(tree, first)?;
        for other in &places[1..] {
            let (value, unit) = quantity(tree, other)?;
            if value != nominal || unit != dimension {
                let reason = format!(
                    "one value would stand at all its places, but {first} and {other} differ; name them one by one"
                );
                return Err(refusal(path, reason));
            }
        }
        Ok(Self {
            places,
            nominal,
            dimension,
        })
    }

    fn within(self, path: &str, bounds: [f64; 2]) -> Parameter {
        Parameter {
            path: path.to_owned(),
            places: self.places,
            run: None,
            nominal: self.nominal,
            dimension: self.dimension,
            scale: if bounds[0] > 0.0 {
                Scale::Logarithmic
            } else {
                Scale::Linear
            },
            bounds,
        }
    }
}

/// The value at a path, SI, and its unit.
fn quantity(tree: &Value, path: &str) -> Result<(f64, Option<Dimension>), Error> {
    let none = || refusal(path, "its value is no quantity");
    match paths::get(tree, path)? {
        Some(Value::Number(number)) => Ok((number.as_f64().ok_or_else(none)?, None)),
        Some(Value::String(text)) => match unit::parse_clearance(text) {
            Ok(measure) => Ok((measure.si, Some(measure.dimension))),
            Err(error) => Err(refusal(path, format!("'{text}': {error}"))),
        },
        _ => Err(none()),
    }
}

fn refusal(path: &str, reason: impl Into<String>) -> Error {
    Error::Parameter {
        path: path.to_owned(),
        reason: reason.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn machine(name: &str) -> Value {
        let file = format!("{}/../../data/machines/{name}", env!("CARGO_MANIFEST_DIR"));
        let file = input::machine_file::read(std::path::Path::new(&file)).unwrap();
        file.to_tree().clone()
    }

    fn at(tree: &Value, path: &str) -> Value {
        paths::get(tree, path).unwrap().unwrap().clone()
    }

    #[test]
    fn a_star_is_one_value_at_several_places() {
        let mut tree = machine("single-stage.yaml");
        let friction = Parameter::at(&tree, "joints.*.friction.coefficient").unwrap();
        let ends = ["joints.big_end", "joints.small_end"].map(|j| j.to_owned() + ".friction");
        for end in &ends {
            let place = format!("{end}.coefficient");
            assert!(friction.places.contains(&place), "{friction:?}");
        }
        friction.write(&mut tree, 0.07).unwrap();
        for place in &friction.places {
            assert_eq!(at(&tree, place), json!(0.07));
        }
        let apart = Parameter::at(&tree, "joints.*.contact.stiffness").unwrap_err();
        assert!(apart.to_string().contains("differ"), "{apart}");
    }

    #[test]
    fn what_every_run_states_is_multiplied_by_one_factor() {
        let tree = machine("single-stage.yaml");
        let path = "cylinder.suction";
        let suction = Parameter::at(&tree, path).unwrap().of_each_run();
        assert_eq!(suction.path, "runs.*.cylinder.suction");
        let third = suction.nominal / 3.0;
        let (mut of_run, mut own) = (tree.clone(), tree.clone());
        paths::set(&mut of_run, path, json!("0.3 MPa")).unwrap();
        suction.write_for("run07", &mut of_run, third).unwrap();
        let (written, _) = quantity(&of_run, path).unwrap();
        assert!((written - 1e5).abs() < 1e-6, "{written}");
        // It is no value of the machine.
        suction.write(&mut own, third).unwrap();
        assert_eq!(at(&own, path), at(&tree, path));
    }

    #[test]
    fn effects_are_searched_within_the_bounds_of_the_catalogue() {
        let mut tree = machine("single-stage.yaml");
        let section = json!({"discharge": "3 %", "discharge_phase": "0 deg"});
        tree["effects"] = json!([{"gas_pulsation": section}]);
        let path = "effects.gas_pulsation.discharge";
        let amplitude = Parameter::at(&tree, path).unwrap();
        assert_eq!(amplitude.bounds, [0.001, 0.2]);
        let phase = Parameter::at(&tree, "effects.0.gas_pulsation.discharge_phase").unwrap();
        assert_eq!(phase.bounds, [0.0, std::f64::consts::TAU]);
        // Where nothing is left of it, it has no derivative.
        let within = Parameter::within(&tree, path, [0.0, 0.1]).unwrap();
        assert_eq!(within.bounds, [0.001, 0.1]);
        amplitude.write(&mut tree, 0.0).unwrap();
        assert_eq!(at(&tree, path), json!("0 %"));
        assert!(Parameter::at(&tree, path).is_err());
        assert!(Parameter::within(&tree, path, [0.0, 0.1]).is_err());
    }

    #[test]
    fn throws_that_share_a_section_get_values_of_their_own() {
        let mut tree = machine("two-stage.yaml");
        let damping = Parameter::at(&tree, "throws.*.joints.small_end.contact.damping").unwrap();
        let places = ["throw1", "throw2"]
            .map(|throw| format!("throws.{throw}.joints.small_end.contact.damping"));
        assert_eq!(damping.places, places);
        damping.write(&mut tree, 3e4).unwrap();
        input::MachineFile::from_tree(&tree)
            .unwrap()
            .resolve()
            .unwrap();
    }

    #[test]
    fn coordinates_lead_back_to_values() {
        let mut tree = machine("single-stage.yaml");
        let relation = json!({"stiffness": 0, "damping": -0.2});
        paths::set(&mut tree, "joints.big_end.contact.relation", relation).unwrap();
        let stiffness = Parameter::at(&tree, "joints.big_end.contact.stiffness").unwrap();
        assert_eq!(stiffness.scale, Scale::Logarithmic);
        assert_eq!(stiffness.bounds, [2.4e9, 2.4e11]);
        let exponent = "joints.big_end.contact.relation.stiffness";
        let exponent = Parameter::at(&tree, exponent).unwrap();
        assert_eq!((exponent.nominal, exponent.bounds), (0.0, [-1.0, 0.5]));
        assert_eq!(exponent.scale, Scale::Linear);
        let mass = Parameter::within(&tree, "rod.mass", [5.0, 20.0]).unwrap();
        assert_eq!(mass.bounds, [5.0, 20.0]);
        for parameter in [stiffness, exponent, mass] {
            assert_eq!(parameter.coordinate(parameter.nominal), 0.0);
            let [low, high] = parameter.box_bounds();
            for (x, bound) in [(low, parameter.bounds[0]), (high, parameter.bounds[1])] {
                assert!((parameter.value(x) - bound).abs() < 1e-12 * bound.abs());
            }
        }
    }

    #[test]
    fn what_cannot_be_fitted_says_why() {
        let mut tree = machine("single-stage.yaml");
        let refused = |tree: &Value, path: &str| Parameter::at(tree, path).unwrap_err().to_string();
        assert!(refused(&tree, "name").contains("'"));
        assert!(refused(&tree, "joints.*.contact.stifness").contains("stiffness"));
        assert!(refused(&tree, "rod").contains("no quantity"));
        paths::set(&mut tree, "cylinder.back", json!("0 Pa")).unwrap();
        assert!(refused(&tree, "cylinder.back").contains("bounds"));
        let within = |bounds| Parameter::within(&tree, "cylinder.back", bounds);
        assert_eq!(within([-1e5, 1e5]).unwrap().value(0.5), 5e4);
        let refused = within([1e5, 2e5]).unwrap_err().to_string();
        assert!(refused.contains("100000 and 200000"), "{refused}");
    }
}
