//! Hides effects of the catalogue in recordings made here, and looks whether they are found again:
//! which was hidden, which was named, and how far the gap shrank.
//!
//! ```text
//! hidden_effects BUNDLE SEED COPIES [EFFECT ...]    no effect: all of them; `none` hides nothing
//! ```
//!
//! The machine and its runs are those of a bundle, with other contact parameters and noise. Amplitudes
//! are drawn between once and four times the usual ones, phases anywhere.

#![allow(clippy::print_stdout)]

#[path = "../../calibrate/examples/bench/mod.rs"]
mod bench;

use bench::Bench;
use gap::{Candidate, Effort, Explanation};
use input::effects::Parameter;
use rand::RngExt;
use scalar::random::{Purpose, Stream, stream};
use serde_json::Value;
use std::error::Error;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

/// Most evaluations of a descent, as the program allows.
const EVALUATIONS: u64 = 120;
/// Amplitudes over the usual ones.
const AMPLITUDES: [f64; 2] = [1.0, 4.0];

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [bundle, seed, copies, effects @ ..] = &arguments[..] else {
        return Err("usage: hidden_effects BUNDLE SEED COPIES [EFFECT ...]".into());
    };
    let bench = Bench::open(Path::new(bundle))?;
    let (seed, copies): (u64, u64) = (seed.parse()?, copies.parse()?);
    let truth = bench.truth(seed, 0);
    let clean = bench.simulated(&truth, &[])?;
    let without = bench.problem(&clean, seed, 0)?;
    let candidates = Candidate::all(&without);
    let names: Vec<String> = match effects {
        [] => {
            let mut names: Vec<String> =
                candidates.iter().map(|c| c.entry.name.to_owned()).collect();
            names.dedup();
            names.push("none".into());
            names
        }
        some => some.to_vec(),
    };
    for (row, name) in names.iter().enumerate() {
        for copy in 0..copies {
            let number = row as u64 * 100 + copy + 1;
            let mut random = stream(seed, number, Purpose::Design);
            let of_name: Vec<&Candidate> = candidates
                .iter()
                .filter(|c| c.entry.name == *name)
                .collect();
            let mut hidden = Vec::new();
            let mut label = name.clone();
            if !of_name.is_empty() {
                let candidate = of_name[random.random_range(0..of_name.len())];
                label = candidate.label();
                hidden.push(item(candidate, &mut random));
            }
            let truth = bench.truth(seed, number);
            let problem = match bench.simulated(&truth, &hidden) {
                Ok(clean) => bench.problem(&clean, seed, number)?,
                Err(error) => {
                    println!("{label}: {error}");
                    continue;
                }
            };
            let start = Instant::now();
            let held_out = problem.runs.iter().skip(3).step_by(4).map(|r| r.id.clone());
            let effort = Effort {
                held_out: held_out.collect(),
                evaluations: EVALUATIONS,
                journal: gap::Journal::default(),
            };
            let tell = |stage: &gap::Stage| {
                let seconds = start.elapsed().as_secs_f64();
                eprintln!(
                    "{seconds:.0} s: {}, misfit {:.2}",
                    stage.words, stage.misfit
                );
            };
            let watch = || ControlFlow::Continue(());
            let found = gap::explain(&problem, &[], &effort, &tell, &watch)?;
            println!(
                "{label}: {}, {:.0} s",
                told(&found),
                start.elapsed().as_secs_f64()
            );
        }
    }
    Ok(())
}

/// The effect at random values.
fn item(candidate: &Candidate, random: &mut Stream) -> Value {
    let place: Vec<(&str, &str)> = candidate
        .place
        .iter()
        .map(|(k, w)| (*k, w.as_str()))
        .collect();
    let value = |(i, p): (usize, &Parameter)| {
        if let Some((_, value)) = candidate.fixed.iter().find(|(index, _)| *index == i) {
            return *value;
        }
        let [low, high] = p.bounds;
        match (p.absent, p.cyclic) {
            (_, true) => random.random_range(low..high),
            (Some(absent), _) => {
                let share = random.random_range(AMPLITUDES[0]..AMPLITUDES[1]);
                (absent + share * (p.start - absent)).clamp(low, high)
            }
            _ => p.start,
        }
    };
    let values: Vec<f64> = candidate
        .entry
        .parameters
        .iter()
        .enumerate()
        .map(value)
        .collect();
    candidate.entry.item(&place, &values)
}

fn told(found: &Explanation) -> String {
    let named: Vec<String> = found
        .found
        .iter()
        .chain(&found.chain)
        .map(|f| {
            let rivals: Vec<String> = f.rivals.iter().map(|r| r.candidate.label()).collect();
            match rivals.is_empty() {
                true => f.candidate.label(),
                false => format!("{} (rivals {})", f.candidate.label(), rivals.join(", ")),
            }
        })
        .collect();
    let refused: Vec<String> = found
        .refused
        .iter()
        .take(3)
        .map(|r| format!("{} {:.2}", r.candidate.label(), r.evidence.misfit[1]))
        .collect();
    format!(
        "{:?} [{}], {:.2} before, {:.2} after, held out {:.2} to {:.2}; refused {}",
        found.verdict,
        named.join("; "),
        found.baseline.fitted,
        found.explained.fitted,
        found.baseline.held_out.unwrap_or(f64::NAN),
        found.explained.held_out.unwrap_or(f64::NAN),
        refused.join(", "),
    )
}
