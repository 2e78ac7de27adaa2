//! On which of its motions a machine is.
//!
//! A machine with clearances may have several motions that repeat themselves. From rest it settles on one of them, and the
//! least change of a parameter decides on which, so that a sum of squares jumps where it ought to change little. The
//! recorded machine is on one of them. So each run is looked at from where the motion stands that explains it best, and stays
//! there while the parameters change.

use crate::likelihood::{SAMPLES, beside, residuals};
use crate::observation::Observation;
use crate::prediction::{Accuracy, Wanted, predictions, settled, to_a_thread};
use crate::problem::Problem;
use rayon::prelude::*;
use simulate::WarmStart;

/// What a search for branches counts for: each of the motions that are tried settles, and is predicted.
pub(crate) const EVALUATIONS: u64 = 2 * SAMPLES as u64;

/// The problem with its runs on the motions, near the coordinates `x`, that explain them best: those on which they are, and those that
/// machines beside settle on from rest. A run whose motion does not repeat itself, recorded or simulated, is left as it is.
pub(crate) fn on_best_branches(problem: &Problem, x: &[f64]) -> Problem {
    let runs = problem.runs.par_iter();
    Problem {
        runs: runs.map(|run| on_best_branch(problem, run, x)).collect(),
        ..problem.clone()
    }
}

fn on_best_branch(problem: &Problem, run: &Observation, x: &[f64]) -> Observation {
    if !run.repeats() {
        return run.clone();
    }
    let on = |warm_start| Observation {
        warm_start,
        ..run.clone()
    };
    let at_rest = on(None);
    let settled_at = |at: &Observation, x: &[f64]| settled(problem, at, x).ok().flatten();
    let present = run.warm_start.as_ref().and_then(|_| settled_at(run, x));
    let beside: Vec<Vec<f64>> = beside(x).collect();
    let beside = beside.par_iter().map(|x| settled_at(&at_rest, x));
    let beside: Vec<Option<WarmStart>> = beside.collect();
    let starts = present.into_iter().chain(beside.into_iter().flatten());
    let candidates: Vec<Observation> = starts.map(|start| on(Some(start))).collect();
    let wanted: Vec<Wanted> = candidates.iter().map(|on| (on, x)).collect();
    let shown = wanted.par_chunks(to_a_thread(wanted.len()));
    let shown = shown.flat_map_iter(|wanted| predictions(problem, wanted, Accuracy::Fine));
    let left = |shown: Result<_, _>| {
        let residuals = residuals(run, &shown.ok()?, 0.0);
        Some(residuals.iter().map(|r| r * r).sum::<f64>())
    };
    let left: Vec<Option<f64>> = shown.map(left).collect();
    let best = candidates.into_iter().zip(left);
    let best = best.filter_map(|(on, left)| Some((left?, on)));
    let best = best.min_by(|a, b| a.0.total_cmp(&b.0));
    best.map_or_else(|| run.clone(), |(_, on)| on)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crank_motion::CrankMotion;
    use crate::likelihood::misfit;
    use crate::meter::Meter;
    use crate::observation::Observed;
    use crate::parameter::Parameter;
    use crate::prediction::Prediction;
    use input::paths;
    use mechanism::drive::GivenSpeed;
    use serde_json::json;
    use signal::order_lines::OrderLines;
    use std::path::Path;

    const CLEARANCES: [(&str, &str); 2] = [
        ("joints.big_end.clearance", "0.25 mm"),
        ("joints.small_end.clearance", "0.3 mm"),
    ];

    /// A machine that has a motion that repeats itself, which it does not find from rest.
    fn problem() -> Problem {
        let file = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../data/machines/single-stage.yaml"
        );
        let file = input::machine_file::read(Path::new(file)).unwrap();
        let mut tree = file.to_tree().clone();
        for (path, clearance) in CLEARANCES {
            paths::set(&mut tree, path, json!(clearance)).unwrap();
        }
        paths::set(&mut tree, "speed", json!("400 rpm")).unwrap();
        let parameter = |(path, _)| Parameter::at(&tree, path).unwrap();
        let run = Observation {
            id: "run".into(),
            settings: Vec::new(),
            crank: GivenSpeed {
                speed: 400.0 * std::f64::consts::PI / 30.0,
                fluctuation: Vec::new(),
            },
            channels: vec![Observed {
                column: "crosshead_acceleration_m_s2".into(),
                orders: (1..100).collect(),
                lines: OrderLines {
                    amplitude: Vec::new(),
                    variance: vec![1e-2; 100],
                    revolutions: 20,
                },
                scatter: Vec::new(),
            }],
            warm_start: None,
        };
        Problem {
            parameters: CLEARANCES.map(parameter).into(),
            tree,
            runs: vec![run],
            crank: CrankMotion::Driven,
            meter: Meter::default(),
        }
    }

    fn shown(problem: &Problem, x: &[f64]) -> Prediction {
        let mut all = predictions(problem, &[(&problem.runs[0], x)], Accuracy::Fine);
        all.remove(0).unwrap()
    }

    #[test]
    fn a_run_goes_on_with_the_motion_that_explains_it() {
        let (mut problem, x) = (problem(), [0.0, 0.0]);
        assert!(!shown(&problem, &x).periodic);
        // The same from rest on: no motion is known that would explain it.
        let at_rest = on_best_branches(&problem, &x);
        assert!(at_rest.runs[0].warm_start.is_none());
        problem.runs[0].warm_start = settled(&problem, &problem.runs[0], &[0.0, -0.1]).unwrap();
        let recorded = shown(&problem, &x);
        assert!(recorded.periodic);
        let [recorded] = &recorded.lines[..] else {
            panic!("one channel");
        };
        problem.runs[0].channels[0].lines.amplitude = recorded.amplitude.clone();
        let found = on_best_branches(&problem, &x);
        let run = &found.runs[0];
        assert_ne!(run.warm_start, problem.runs[0].warm_start);
        let left = misfit(&residuals(run, &shown(&found, &x), 0.0));
        assert!(left < 1e-1, "{left}");
        // It stays on it while the parameters change a little.
        assert!(shown(&found, &[1e-2, -1e-2]).periodic);
    }

    #[test]
    fn a_run_that_does_not_repeat_itself_is_left_as_it_is() {
        let mut problem = problem();
        let channel = &mut problem.runs[0].channels[0];
        channel.lines.amplitude = vec![1.0.into(); 100];
        channel.lines.variance = vec![1.0; 100];
        assert!(!problem.runs[0].repeats());
        let x = [0.0, -0.1];
        problem.runs[0].warm_start = settled(&problem, &problem.runs[0], &x).unwrap();
        let found = on_best_branches(&problem, &x);
        assert_eq!(found.runs[0].warm_start, problem.runs[0].warm_start);
    }
}
