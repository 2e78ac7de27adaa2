//! How the residual grows with speed, load and clearance: a power law over the runs. Its exponents
//! are the fingerprint of what is missing: inertia grows with the square of the speed, gas with the
//! load, impacts with the clearance.
//!
//! ```text
//! ln residual = constant + a ln speed + b ln load + c ln clearance
//! ```

use crate::fitter::conditions::{Conditions, conditions_of, varied};
use crate::model::Model;
use crate::results::residual_map::ResidualMap;
use calibrate::Error;
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

/// A residual counts where its mean square is this many times that of the noise.
const ABOVE: f64 = 2.0;

/// The exponents of a channel's residual.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scaling {
    /// The channel's column.
    pub channel: String,
    /// One per condition that varies enough between the runs.
    pub exponents: Vec<Exponent>,
}

/// The residual grows with this power of a condition.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Exponent {
    /// `speed`, `load` (discharge less suction pressure) or `clearance` (of all joints together).
    pub with: String,
    /// The power.
    pub exponent: f64,
    /// Its standard error, from the scatter about the law; none where there are no runs to spare.
    pub standard_error: Option<f64>,
}

/// The scaling of each channel whose residual stands out of the noise in enough runs; `maps` are
/// those of `model`.
///
/// # Errors
/// An invalid machine.
pub fn scaling(model: &Model, maps: &[ResidualMap]) -> Result<Vec<Scaling>, Error> {
    let mut conditions = Vec::new();
    for run in &model.problem.runs {
        let of_run = conditions_of(&model.problem, run, &model.x)?;
        conditions.push((run.id.as_str(), of_run));
    }
    let mut channels: Vec<&str> = maps.iter().map(|map| map.channel.as_str()).collect();
    channels.sort_unstable();
    channels.dedup();
    let of_channel = |channel: &str| {
        let above = |map: &&ResidualMap| {
            map.channel == channel && map.rms.powi(2) > ABOVE * map.noise.powi(2)
        };
        let points = maps.iter().filter(above).filter_map(|map| {
            let (_, conditions) = conditions.iter().find(|(run, _)| *run == map.run)?;
            let residual = (map.rms.powi(2) - map.noise.powi(2)).sqrt();
            Some((*conditions, residual))
        });
        let exponents = exponents(&points.collect::<Vec<_>>());
        (!exponents.is_empty()).then(|| Scaling {
            channel: channel.to_owned(),
            exponents,
        })
    };
    Ok(channels.into_iter().filter_map(of_channel).collect())
}

/// The exponents of the power law through these residuals.
fn exponents(points: &[(Conditions, f64)]) -> Vec<Exponent> {
    let conditions: Vec<Conditions> = points.iter().map(|(conditions, _)| *conditions).collect();
    let varied = varied(&conditions);
    let unknowns = varied.len() + 1;
    if varied.is_empty() || points.len() < unknowns {
        return Vec::new();
    }
    let design = DMatrix::from_fn(points.len(), unknowns, |row, column| match column {
        0 => 1.0,
        _ => points[row].0[varied[column - 1]].1.ln(),
    });
    let residual = DVector::from_iterator(points.len(), points.iter().map(|(_, r)| r.ln()));
    let Some(inverse) = design.tr_mul(&design).try_inverse() else {
        return Vec::new();
    };
    let found = &inverse * design.tr_mul(&residual);
    let spare = points.len() - unknowns;
    let scatter = (&residual - &design * &found).norm_squared() / spare.max(1) as f64;
    let exponent = |(i, condition): (usize, &usize)| Exponent {
        with: points[0].0[*condition].0.to_owned(),
        exponent: found[i + 1],
        standard_error: (spare > 0).then(|| (scatter * inverse[(i + 1, i + 1)]).sqrt()),
    };
    varied.iter().enumerate().map(exponent).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponents_of_a_power_law_come_back() {
        let point = |speed: f64, load: f64| {
            let conditions = [("speed", speed), ("load", load), ("clearance", 1e-4)];
            (conditions, 3.0 * speed.powi(2) / load.sqrt())
        };
        let speeds = [30.0, 40.0, 50.0, 60.0];
        let points: Vec<_> = speeds
            .iter()
            .flat_map(|speed| [2e5, 3e5].map(|load| point(*speed, load)))
            .collect();
        let found = exponents(&points);
        assert_eq!(found.len(), 2, "{found:?}");
        assert_eq!([&found[0].with, &found[1].with], ["speed", "load"]);
        assert!((found[0].exponent - 2.0).abs() < 1e-9);
        assert!((found[1].exponent + 0.5).abs() < 1e-9);
        assert!(found.iter().all(|e| e.standard_error.unwrap() < 1e-9));
    }

    #[test]
    fn one_condition_tells_nothing() {
        let conditions = [("speed", 50.0), ("load", 2e5), ("clearance", 0.0)];
        assert!(exponents(&[(conditions, 1.0), (conditions, 1.1)]).is_empty());
    }
}
