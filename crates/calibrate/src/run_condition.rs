//! Parameters beyond the machine file: what holds in one run alone, and the crank angle's offset.

use crate::error::Error;
use crate::observation::Run;
use crate::parameter::{EACH_RUN, Parameter, Scale};
use input::paths;
use input::unit::{self, Dimension};
use serde_json::Value;

/// By how much the recorded crank angle is ahead of the crank, rad: a dead centre that was set wrong
/// at the encoder. It is a parameter of every run, or of one: `runs.RUN.crank_angle_offset`.
pub const CRANK_ANGLE_OFFSET: &str = "crank_angle_offset";
/// Without bounds of its own it is searched over 5° to either side, of 0 and of where it is seen.
const OFFSETS: [f64; 2] = [-5.0_f64.to_radians(), 5.0_f64.to_radians()];
pub(crate) const ANGLE: Dimension = Dimension::new(0.0, 0.0, 0.0, 1.0);

impl Parameter {
    /// Opens the bounds of an offset of the crank angle that has no bounds of its own, so that they hold `seen`, rad.
    /// Returns whether they had to be opened.
    pub fn open_for_offset(&mut self, seen: f64) -> bool {
        let [low, high] = self.bounds;
        if self.bounds != OFFSETS || !self.is_crank_angle_offset() || (low..=high).contains(&seen) {
            return false;
        }
        self.bounds = [low.min(seen + OFFSETS[0]), high.max(seen + OFFSETS[1])];
        true
    }

    /// The parameter that `path` names, with bounds of its own where they are given, SI: a value of
    /// the machine file `tree`; `runs.RUN.PATH`, the same value in one run alone (the suction
    /// pressure, say, which differs from run to run); `runs.*.PATH`, one factor to what every run has there, as a value of
    /// the first run; or [`CRANK_ANGLE_OFFSET`], of all runs or one.
    ///
    /// # Errors
    /// As [`Parameter::at`] and [`Parameter::within`]; a run that is not there.
    pub fn named(
        tree: &Value,
        runs: &[Run],
        path: &str,
        bounds: Option<[f64; 2]>,
    ) -> Result<Self, Error> {
        let Some(of_runs) = path.strip_prefix("runs.") else {
            return shared(tree, path, bounds);
        };
        let behind = |name: &str| of_runs.strip_prefix(name)?.strip_prefix('.');
        let of_each = runs.first().zip(behind(EACH_RUN));
        let mut rests = runs
            .iter()
            .filter_map(|run| Some((run, behind(run.id.as_str())?)));
        let named = rests.next().map(|(run, rest)| (run, rest, run.id.as_str()));
        let Some((run, rest, name)) = named.or(of_each.map(|(run, rest)| (run, rest, EACH_RUN)))
        else {
            let ids: Vec<&str> = runs.iter().map(|run| run.id.as_str()).collect();
            return Err(Error::Parameter {
                path: path.to_owned(),
                reason: format!("there is no such run; the runs are {}", ids.join(", ")),
            });
        };
        let mut tree = tree.clone();
        for (path, value) in &run.settings {
            paths::set(&mut tree, path, value.clone())?;
        }
        Ok(Self {
            path: path.to_owned(),
            run: Some(name.to_owned()),
            ..shared(&tree, rest, bounds)?
        })
    }
}

fn shared(tree: &Value, path: &str, bounds: Option<[f64; 2]>) -> Result<Parameter, Error> {
    if path == CRANK_ANGLE_OFFSET {
        return Ok(Parameter {
            path: path.to_owned(),
            places: Vec::new(),
            run: None,
            nominal: 0.0,
            dimension: Some(ANGLE),
            scale: Scale::Linear,
            bounds: bounds.unwrap_or(OFFSETS),
        });
    }
    match bounds {
        Some(bounds) => Parameter::within(tree, path, bounds),
        None => Parameter::at(tree, path),
    }
}

/// The unit of the value at `path` of the machine file `tree`, as a run's condition or for the machine; empty
/// for a pure number.
pub fn unit(tree: &Value, path: &str) -> String {
    let offset = format!(".{path}");
    if offset.ends_with(&format!(".{CRANK_ANGLE_OFFSET}")) {
        return "rad".to_owned();
    }
    // A value of one run alone stands behind the run's name.
    let names = offset.match_indices('.').map(|(i, _)| &offset[i + 1..]);
    let value = names
        .filter_map(|name| paths::get(tree, name).ok().flatten())
        .next();
    let measure = value
        .and_then(Value::as_str)
        .and_then(|text| unit::parse_clearance(text).ok());
    match measure {
        Some(measure) if measure.dimension != Dimension::NONE => measure.dimension.to_string(),
        _ => String::new(),
    }
}
