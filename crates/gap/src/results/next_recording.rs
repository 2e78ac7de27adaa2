//! What to measure next: the recording in which an effect and its nearest rival differ most.
//!
//! Recordings that might be made are simulated with both models, each as it was fitted. They are the existing
//! runs, and runs that differ from one of them in speed, load or a clearance, in channels that were
//! recorded or not. The distance of the two is the misfit that the
//! rival would leave of what the effect shows (a discrimination experiment, Hunter and Reiner 1965).

use crate::error::Error;
use crate::finding::Found;
use crate::fitter::Fitter;
use crate::model::Model;
use crate::recorded::is_of_pressures;
use calibrate::Problem;
use calibrate::likelihood::{Likelihood, misfit};
use calibrate::observation::{Observation, Observed};
use calibrate::problem::columns;
use input::paths;
use input::unit::parse;
use nalgebra::Complex;
use serde_json::Value;
use signal::order_lines::OrderLines;
use std::f64::consts::PI;

/// By what speed, load and clearances of a run are multiplied for another.
const SPEEDS: [f64; 2] = [0.7, 1.3];
const LOADS: [f64; 2] = [0.7, 1.3];
const CLEARANCES: [f64; 2] = [0.5, 2.0];
/// The discharge stays this far above the suction.
const LEAST_RATIO: f64 = 1.2;
/// A recording is proposed where it separates this many times as well as what is there.
const WORTH: f64 = 1.1;
/// A sensor that is not there yet has this noise, of its signal's RMS: a good one in its range.
const NEW_SENSOR: f64 = 0.02;
/// Highest order that is looked at in a channel that was not recorded.
const ORDERS: usize = 60;

/// A recording that might be made.
struct Proposal {
    /// What would be different from what is there; empty for a run as it is.
    change: String,
    /// Its conditions, and its channels with the noise that they would have.
    run: Observation,
}

/// How far two models are apart in a channel of a recording.
struct Separation {
    change: String,
    run: String,
    column: String,
    /// Misfit that the rival would leave.
    apart: f64,
    recorded: bool,
}

/// The recording that would best distinguish the effect and the rival that are nearest to each other, in
/// a sentence. None where no effect has a rival that was fitted.
///
/// # Errors
/// A machine that cannot be simulated as it was recorded.
pub(crate) fn next_recording(fitter: &Fitter, found: &[Found]) -> Result<Option<String>, Error> {
    let pairs = found.iter().flat_map(|effect| {
        effect.rivals.iter().filter_map(move |rival| {
            let models = effect.effect.model.as_ref().zip(rival.model.as_ref())?;
            Some((effect, rival, models))
        })
    });
    let nearest = pairs.max_by(|a, b| a.1.probability.total_cmp(&b.1.probability));
    let Some((effect, rival, (ours, theirs))) = nearest else {
        return Ok(None);
    };
    (fitter.say)("choosing what to measure next", ours.fitted);
    let separations = separations(ours, theirs)?;
    let best = |wanted: &dyn Fn(&&Separation) -> bool| {
        let of = separations.iter().filter(wanted);
        of.max_by(|a, b| a.apart.total_cmp(&b.apart))
    };
    let there = best(&|s| s.recorded && s.change.is_empty());
    let Some(best) = best(&|_| true) else {
        return Ok(None);
    };
    let names = [effect.candidate(), &rival.candidate].map(|c| c.label());
    Ok(Some(sentence(&names, best, there)))
}

fn sentence([name, other]: &[String; 2], best: &Separation, there: Option<&Separation>) -> String {
    let so_far = there.map_or(0.0, |there| there.apart);
    let sensor = best
        .column
        .trim_end_matches("_m_s2")
        .trim_end_matches("_pa");
    let sensor = sensor.replace(['_', '.'], " ");
    if best.apart < WORTH * so_far || (best.recorded && best.change.is_empty()) {
        return format!(
            "{name} and {other} differ most as in {}, in its {sensor}, by {so_far:.1} times the noise: no other speed, \
             load or clearance separates them better. More revolutions there would lower the noise.",
            best.run
        );
    }
    let condition = match best.change.is_empty() {
        true => format!("Under the conditions of {}", best.run),
        false => format!("At {} of {}, all else as there", best.change, best.run),
    };
    let sensor = match best.recorded {
        true => format!("the {sensor}"),
        false => format!("a sensor of the {sensor} (not recorded so far)"),
    };
    format!(
        "{condition}, {sensor} would best distinguish {name} from {other}: they would be {:.1} times the noise from \
         each other, against {so_far:.1} in the best of the runs that there are.",
        best.apart
    )
}

/// How far the models are apart in every channel of every recording that either can be simulated in.
fn separations(ours: &Model, theirs: &Model) -> Result<Vec<Separation>, Error> {
    let runs = &theirs.problem.runs;
    let mut all = Vec::new();
    for proposal in proposals(ours, runs)? {
        let own = ours
            .problem
            .runs
            .iter()
            .find(|run| run.id == proposal.run.id);
        let recorded =
            |column: &str| own.is_some_and(|run| run.channels.iter().any(|c| c.column == column));
        // What cannot be simulated cannot be proposed.
        let Ok(shown) = shown(ours, proposal.run) else {
            continue;
        };
        let with = |run: &Observation| Problem {
            runs: vec![run.clone()],
            ..theirs.problem.clone()
        };
        let Ok(residuals) = Likelihood::new(&with(&shown)).by_run(&theirs.x) else {
            continue;
        };
        let mut rest = &residuals[0][..];
        for channel in &shown.channels {
            let (own, others) = rest.split_at(2 * channel.orders.len());
            rest = others;
            all.push(Separation {
                change: proposal.change.clone(),
                run: shown.id.clone(),
                column: channel.column.clone(),
                apart: misfit(own),
                recorded: recorded(&channel.column),
            });
        }
    }
    Ok(all)
}

/// The run as the model shows it, in place of a recording. Channels that were not recorded have the
/// noise of a new sensor.
fn shown(model: &Model, mut run: Observation) -> Result<Observation, Error> {
    let alone = Problem {
        runs: vec![run.clone()],
        ..model.problem.clone()
    };
    let predictions = Likelihood::new(&alone).predictions(&model.x)?;
    for (channel, lines) in run.channels.iter_mut().zip(&predictions[0].lines) {
        let lines = &lines.amplitude;
        if channel.lines.amplitude.is_empty() {
            let power: f64 = lines.iter().skip(1).map(Complex::norm_sqr).sum();
            let variance = NEW_SENSOR * NEW_SENSOR * power / lines.len() as f64;
            channel.lines.variance = vec![variance; lines.len()];
            channel.orders.retain(|k| *k < lines.len());
        }
        channel.lines.amplitude.clone_from(lines);
        channel
            .lines
            .amplitude
            .resize(channel.lines.variance.len(), Complex::default());
    }
    Ok(run)
}

/// The runs as they are, and with one condition changed; each with all channels that the machine can
/// have.
fn proposals(model: &Model, runs: &[Observation]) -> Result<Vec<Proposal>, Error> {
    let mut all = Vec::new();
    let of_gas = is_of_pressures(&model.problem);
    for run in runs {
        let machine = model.problem.machine(run, &model.x)?;
        let own = || run.channels.iter().map(|c| c.column.as_str());
        // Of a machine of which pressures are known alone little else can be foretold.
        let foretold = |c: &String| !of_gas || c.contains("cylinder_pressure");
        let more = columns(&machine).into_iter();
        let more = more.filter(|c| foretold(c) && own().all(|own| own != c));
        let unrecorded = |column| Observed {
            scatter: Vec::new(),
            column,
            lines: OrderLines {
                amplitude: Vec::new(),
                variance: Vec::new(),
                revolutions: own_revolutions(run),
            },
            orders: (1..=ORDERS).collect(),
        };
        let mut run = run.clone();
        run.channels.extend(more.map(unrecorded));
        let changes = changes(&model.problem, &run);
        all.push(Proposal {
            change: String::new(),
            run,
        });
        let base = all.len() - 1;
        for (change, settings, faster) in changes {
            let mut run = all[base].run.clone();
            run.crank.speed *= faster;
            run.settings.extend(settings);
            all.push(Proposal { change, run });
        }
    }
    Ok(all)
}

fn own_revolutions(run: &Observation) -> usize {
    let revolutions = run.channels.iter().map(|c| c.lines.revolutions);
    revolutions.max().unwrap_or(1)
}

/// A change in words, the settings that it takes, and by how much faster the crank turns.
type Change = (String, Vec<(String, Value)>, f64);

/// The changes of a run's conditions.
fn changes(problem: &Problem, run: &Observation) -> Vec<Change> {
    // What was fitted to the run is not known for another.
    let fitted = |path: &str| {
        let own = problem.parameters.iter().filter(|p| p.holds_in(&run.id));
        own.flat_map(|p| &p.places).any(|place| place == path)
    };
    let value = |path: &str| -> Option<Value> {
        let set = run.settings.iter().rev().find(|(set, _)| set == path);
        let of_machine = || paths::get(&problem.tree, path).ok().flatten().cloned();
        set.map(|(_, value)| value.clone()).or_else(of_machine)
    };
    let mut all: Vec<Change> = Vec::new();
    if let Some(speed) = value("speed") {
        all.extend(SPEEDS.iter().filter_map(|factor| {
            let rpm = run.crank.speed * 30.0 / PI * factor;
            let setting = ("speed".to_owned(), scaled(&speed, *factor)?);
            Some((
                format!("{factor} times the speed ({rpm:.0} rpm)"),
                vec![setting],
                *factor,
            ))
        }));
    }
    let mut paths: Vec<&str> = run.settings.iter().map(|(path, _)| path.as_str()).collect();
    paths.retain(|path| !fitted(path));
    paths.sort_unstable();
    paths.dedup();
    let discharges: Vec<&str> = paths
        .iter()
        .copied()
        .filter(|p| p.ends_with("cylinder.discharge"))
        .collect();
    for factor in LOADS {
        let settings = discharges.iter().filter_map(|path| {
            let suction = path.replace("discharge", "suction");
            let low = value(&suction).and_then(|v| si(&v))?;
            let high = value(path)?;
            let enough = factor * si(&high)? > LEAST_RATIO * low;
            enough.then(|| Some(((*path).to_owned(), scaled(&high, factor)?)))?
        });
        let settings: Vec<_> = settings.collect();
        if settings.len() == discharges.len() && !settings.is_empty() {
            all.push((
                format!("{factor} times the discharge pressure"),
                settings,
                1.0,
            ));
        }
    }
    for path in paths.iter().filter(|path| path.ends_with(".clearance")) {
        for factor in CLEARANCES {
            let Some(clearance) = value(path).and_then(|v| scaled(&v, factor)) else {
                continue;
            };
            let joint = path.trim_end_matches(".clearance").replace("joints.", "");
            let words = format!(
                "{factor} times the clearance {}",
                joint.replace(['.', '_'], " ")
            );
            all.push((words, vec![((*path).to_owned(), clearance)], 1.0));
        }
    }
    all
}

/// A quantity of a machine file, SI; none for a word.
fn si(value: &Value) -> Option<f64> {
    parse(value.as_str()?).ok().map(|measure| measure.si)
}

/// A quantity of a machine file, multiplied.
fn scaled(value: &Value, factor: f64) -> Option<Value> {
    let (number, unit) = value.as_str()?.trim().split_once(' ')?;
    let number: f64 = number.parse().ok()?;
    Some(format!("{} {unit}", number * factor).into())
}
