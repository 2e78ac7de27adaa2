//! How it is fitted, and which runs are held out.

use super::settings::Settings;
use crate::error::Error;
use crate::fit::{FitSettings, Optimiser};
use crate::observation::Run;
use crate::optimiser::Genetic;
use crate::relation::{ClearJoint, clearances};
use input::calibration;
use serde_json::Value;

/// Of so many runs one is held out.
const HELD_OUT: usize = 4;
/// Most evaluations of the model.
const EVALUATIONS: u32 = 5000;

/// How the settings have it fitted; defaults where they say nothing.
///
/// # Errors
/// Runs to hold out that are not there, or all of them.
pub(super) fn with_defaults(
    settings: &Settings,
    tree: &Value,
    runs: &[Run],
) -> Result<FitSettings, Error> {
    let asked = settings.calibration;
    let ids: Vec<&str> = runs.iter().map(|run| run.id.as_str()).collect();
    let held_out = match &asked.hold_out {
        None => held_out(tree, runs)?,
        Some(named) => {
            if let Some(unknown) = named.iter().find(|id| !ids.contains(&id.as_str())) {
                let error = input::Error::unknown_name("hold_out", unknown, &ids);
                return Err((settings.locate)(error).into());
            }
            if ids.iter().all(|id| named.iter().any(|held| held == id)) {
                let expected = "at least one run to fit to";
                let error = input::Error::unexpected("hold_out", "every run", expected);
                return Err((settings.locate)(error).into());
            }
            named.clone()
        }
    };
    Ok(FitSettings {
        optimiser: optimiser(asked.optimiser),
        seed: asked.seed.map_or(0, |seed| u64::from(seed.get())),
        evaluations: u64::from(asked.evaluations.map_or(EVALUATIONS, |n| n.get())),
        held_out,
        start: None,
    })
}

/// Of every four runs the last whose clearances a run has that is fitted: what the parameters are at
/// other clearances is another question.
fn held_out(tree: &Value, runs: &[Run]) -> Result<Vec<String>, Error> {
    let joints = ClearJoint::in_runs(tree, runs.iter().map(|run| &run.settings[..]));
    let joints = joints?;
    let states = runs.iter().map(|r| clearances(tree, &joints, &r.settings));
    let states: Vec<_> = states.collect::<Result<_, _>>()?;
    let mut held_out: Vec<usize> = Vec::new();
    for last in (HELD_OUT - 1..runs.len()).step_by(HELD_OUT) {
        let shared = |i: &usize| {
            let mut others = (0..runs.len()).filter(|j| j != i && !held_out.contains(j));
            others.any(|j| states[j] == states[*i])
        };
        let group = last + 1 - HELD_OUT..=last;
        held_out.extend(group.rev().find(shared));
    }
    Ok(held_out.into_iter().map(|i| runs[i].id.clone()).collect())
}

fn optimiser(asked: calibration::Optimiser) -> Optimiser {
    match asked {
        calibration::Optimiser::Default => Optimiser::Default,
        calibration::Optimiser::CmaEs => Optimiser::CmaEs,
        calibration::Optimiser::LevenbergMarquardt => Optimiser::LevenbergMarquardt,
        calibration::Optimiser::Genetic(asked) => {
            let asked = asked.unwrap_or_default();
            let usual = Genetic::default();
            Optimiser::Genetic(Genetic {
                population: asked
                    .population
                    .map_or(usual.population, |n| n.get() as usize),
                crossover: asked.crossover.map_or(usual.crossover, |x| x.get()),
                mutation: asked.mutation.map_or(usual.mutation, |x| x.get()),
            })
        }
    }
}
