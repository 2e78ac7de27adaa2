//! What an explanation found, as it is printed.

use crate::calibrate::summary::sensors;
use gap::Results;
use gap::results::Other;

/// Prints the results of an explanation.
pub(super) fn print(results: &Results) {
    println!("{}", results.verdict.name());
    for effect in &results.effects {
        println!(
            "{} ({:.2}): {}",
            effect.label, effect.probability, effect.sentence
        );
        if let Some(expression) = &effect.expression {
            println!("  F = {expression}");
        }
        for (key, parameter) in effect.parameters.iter() {
            println!("  {key}: {:.4e}", parameter.value);
        }
        for other in &effect.rivals {
            println!("  rival: {}, {}", other.label, rival(other));
        }
    }
    for wrong in &results.corrections {
        println!(
            "{} ({:.2}): {:.4e} in place of {:.4e}",
            wrong.path, wrong.probability, wrong.value, wrong.nominal
        );
    }
    let gap = &results.gap;
    let held_out = gap.heldout_after.map_or(String::new(), |after| {
        let before = gap.heldout_before.unwrap_or(f64::NAN);
        format!("; of runs held out {before:.2} before, {after:.2} after")
    });
    println!(
        "gap: {:.2} before, {:.2} after{held_out}; noise is 1",
        gap.before, gap.after
    );
    for (run, content) in results.runs.iter() {
        if let Some(rms) = content.pressure_rms_pa.both() {
            let [before, after] = rms.map(|pa| pa / 1e3);
            println!(
                "{run}: {before:.1} kPa RMS from the recorded pressure before, {after:.1} after"
            );
        }
    }
    for note in &results.notes {
        println!("{note}");
    }
    for refused in &results.refused {
        let [before, after] = refused.evidence.misfit;
        println!("refused: {} [{before:?},{after:?}]", refused.label);
    }
    sensors(&results.noise);
}

/// How probable a rival is, and what it leaves.
fn rival(other: &Other) -> String {
    format!("{:.2}, leaves {:.2}", other.probability, other.leaves)
}
