//! Measures what a calibration reaches on recordings whose truth is known: made here, from the
//! machine and the runs of a bundle, with other contact parameters and noise.
//!
//! ```text
//! proof coverage BUNDLE MACHINES COPIES SEED   truths drawn, copies noised, bounds counted
//! proof compare BUNDLE SEED MOST               evaluations and time of each optimiser, MOST at most
//! ```

#![allow(clippy::print_stdout)]

mod bench;
#[path = "bench/recording.rs"]
mod recording;

use bench::Bench;
use calibrate::fit::{FitSettings, Optimiser};
use calibrate::optimiser::Genetic;
use calibrate::run_condition::CRANK_ANGLE_OFFSET;
use calibrate::{Fit, Problem, calibrate};
use std::error::Error;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        ["coverage", bundle, machines, copies, seed] => coverage(
            &Bench::open(Path::new(bundle))?,
            machines.parse()?,
            copies.parse()?,
            seed.parse()?,
        ),
        ["truth", bundle, seed] => truth(&Bench::open(Path::new(bundle))?, seed.parse()?),
        ["compare", bundle, seed, most] => compare(
            &Bench::open(Path::new(bundle))?,
            seed.parse()?,
            most.parse()?,
        ),
        _ => Err(
            "usage: proof coverage BUNDLE MACHINES COPIES SEED | proof compare BUNDLE SEED MOST"
                .into(),
        ),
    }
}

fn settings(optimiser: Optimiser, seed: u64, problem: &Problem) -> FitSettings {
    FitSettings {
        optimiser,
        seed,
        evaluations: 20_000,
        held_out: problem
            .runs
            .iter()
            .skip(3)
            .step_by(4)
            .map(|r| r.id.clone())
            .collect(),
        start: None,
    }
}

fn coverage(bench: &Bench, machines: u64, copies: u64, seed: u64) -> Result<(), Box<dyn Error>> {
    let (mut inside, mut told, mut all) = (0, 0, 0);
    for machine in 0..machines {
        let truth = bench.truth(seed, machine);
        let clean = bench.simulated(&truth)?;
        for copy in 0..copies {
            let problem = bench.problem(&clean, seed, machine * copies + copy)?;
            let start = Instant::now();
            let fit = calibrate(
                &problem,
                &settings(Optimiser::Default, seed, &problem),
                |_| ControlFlow::Continue(()),
            )?;
            let (mut wrong, mut untold) = (Vec::new(), Vec::new());
            for (estimate, truth) in fit.estimates.iter().zip(&truth) {
                if estimate.parameter.path == CRANK_ANGLE_OFFSET {
                    continue;
                }
                all += 1;
                match estimate.interval {
                    Some([low, high]) => {
                        told += 1;
                        if (low..=high).contains(truth) {
                            inside += 1;
                        } else {
                            let deviation = (estimate.value - truth) / (0.5 * (high - low) / 1.96);
                            wrong.push(format!("{} {deviation:+.1} s", estimate.parameter.path));
                        }
                    }
                    None => untold.push(estimate.parameter.path.clone()),
                }
            }
            println!(
                "machine {machine} copy {copy}: {} of {} inside, misfit {:.3} fitted, {:.3} held out, {} evaluations, {:.1} s; outside: {}; not told: {}",
                told_inside(&fit, &truth),
                fit.estimates.len() - untold.len(),
                fit.misfit(false, |r| r.calibrated).unwrap_or(f64::NAN),
                fit.misfit(true, |r| r.calibrated).unwrap_or(f64::NAN),
                fit.evaluations,
                start.elapsed().as_secs_f64(),
                wrong.join(", "),
                untold.join(", "),
            );
        }
    }
    println!(
        "{inside} of {told} bounds hold the truth; {} of {all} not told",
        all - told
    );
    Ok(())
}

fn told_inside(fit: &Fit, truth: &[f64]) -> usize {
    let pairs = fit.estimates.iter().zip(truth);
    pairs
        .filter(|(e, truth)| {
            e.interval
                .is_some_and(|[low, high]| (low..=high).contains(truth))
        })
        .count()
}

/// The misfit of each run and channel at the truth.
fn truth(bench: &Bench, seed: u64) -> Result<(), Box<dyn Error>> {
    let truth = bench.truth(seed, 0);
    let problem = bench.problem(&bench.simulated(&truth)?, seed, 0)?;
    let parameters = problem.parameters.iter().zip(&truth);
    let x: Vec<f64> = parameters.map(|(p, value)| p.coordinate(*value)).collect();
    for run in &problem.runs {
        for channel in &run.channels {
            let mut alone = problem.with_runs(|other| other.id == run.id);
            alone.runs[0]
                .channels
                .retain(|c| c.column == channel.column);
            let residuals = calibrate::likelihood::Likelihood::new(&alone)
                .by_run(&x)?
                .concat();
            let parts: Vec<String> = residuals
                .chunks(residuals.len().div_ceil(4))
                .map(|part| format!("{:.2}", calibrate::likelihood::misfit(part)))
                .collect();
            println!(
                "{} {}: {} orders, {}",
                run.id,
                channel.column,
                channel.orders.len(),
                parts.join(" ")
            );
            for k in [1, 2, 3, 5, 8, 13] {
                println!(
                    "  {k}: {:.2} {:.2} sd {:.3e}",
                    residuals[2 * k],
                    residuals[2 * k + 1],
                    channel.lines.variance[k].sqrt()
                );
            }
        }
    }
    Ok(())
}

/// Bounds of every optimiser's search, over the nominal values: a user of a genetic algorithm would
/// not search further.
const SEARCHED: [f64; 2] = [0.5, 2.0];

/// Every optimiser on the same recordings and within the same bounds, until its misfit is within a
/// tenth of the best.
fn compare(bench: &Bench, seed: u64, most: u64) -> Result<(), Box<dyn Error>> {
    let truth = bench.truth(seed, 0);
    let mut problem = bench.problem(&bench.simulated(&truth)?, seed, 0)?;
    for parameter in &mut problem.parameters {
        if parameter.path != CRANK_ANGLE_OFFSET {
            parameter.bounds = SEARCHED.map(|share| share * parameter.nominal);
        }
    }
    let mut goal = 0.0;
    for (optimiser, limit) in [
        (Optimiser::Default, 0.0),
        (Optimiser::LevenbergMarquardt, 1.0),
        (Optimiser::CmaEs, 1.0),
        (Optimiser::Genetic(Genetic::default()), 1.0),
    ] {
        let start = Instant::now();
        let (mut evaluations, mut best, mut told) = (0, f64::INFINITY, f64::INFINITY);
        calibrate(&problem, &settings(optimiser, seed, &problem), |progress| {
            (evaluations, best) = (progress.evaluations, progress.misfit());
            if best < told / 1.3 {
                told = best;
                let seconds = start.elapsed().as_secs_f64();
                println!("  misfit {best:.3} after {evaluations} evaluations, {seconds:.1} s");
            }
            if best <= 1.1 * goal * limit || evaluations >= most {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        })?;
        if goal == 0.0 {
            goal = best;
        }
        println!(
            "{}: misfit {best:.3} after {evaluations} evaluations, {:.1} s",
            optimiser.name(),
            start.elapsed().as_secs_f64(),
        );
    }
    Ok(())
}
