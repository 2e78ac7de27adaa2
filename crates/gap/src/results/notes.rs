//! What must be known to judge an explanation, in sentences.

use crate::amendment::candidate::Candidate;
use crate::criteria::{EXPLAINED, NAMED, Verdict, explains};
use crate::explain::{Explanation, by_energies};
use crate::fitter::effort::Effort;
use crate::recorded::Recorded;
use calibrate::fit::Estimate;
use calibrate::indicator::Alternative;
use calibrate::pressure_gap::PressureGap;
use calibrate::shut_valve;
use input::effects::Proposal;
use std::f64::consts::PI;

/// Correlation from which two estimates are one.
const TOGETHER: f64 = 0.95;
/// Two readings of a curve are as good as each other where the worse one's scatter is within this
/// factor of the better one's.
const AS_GOOD: f64 = 1.5;

/// What must be known to judge the results.
pub(crate) fn notes(
    explanation: &Explanation,
    effort: &Effort,
    recorded: &Recorded,
) -> Vec<String> {
    let mut notes = shut_valve::sentences(recorded.shut_valves);
    notes.extend(unexplained(explanation));
    notes.extend(heard(explanation));
    notes.extend(predicted_worse(explanation, effort));
    if effort.held_out.is_empty() && !explanation.found.is_empty() {
        notes.push(
            "No run was held out: there are too few. What was found has to hold in all of them at once; \
             predict a run that was left out to test it."
                .to_owned(),
        );
    }
    let mut estimated = explanation.estimates.iter();
    if explanation.verdict != Verdict::NoGap
        && !estimated.any(|e| e.parameter.is_crank_angle_offset())
    {
        notes.push(
            "The zero of the crank angle is taken as it was recorded: pressures by themselves do not determine it, \
             as clearance volumes and exponents imitate it."
                .to_owned(),
        );
    }
    let of_gas = |e: &Estimate| e.parameter.path.contains("cylinder.");
    if explanation.estimates.iter().any(of_gas) {
        notes.extend(full_cycles(recorded).filter_map(together));
    }
    notes.extend(correlated(explanation));
    let unidentifiable = explanation.estimates.iter();
    let unidentifiable = unidentifiable.filter(|e| e.interval.is_none());
    let unidentifiable: Vec<&str> = unidentifiable.map(|e| e.parameter.path.as_str()).collect();
    if !unidentifiable.is_empty() && !by_energies(&explanation.found) {
        notes.push(format!(
            "Not identifiable from the recordings: {}.",
            unidentifiable.join(", ")
        ));
    }
    notes
}

/// By what was decided where no fit follows the ringing.
fn heard(explanation: &Explanation) -> Option<String> {
    let last = explanation.found.last()?;
    let [before, after] = last.effect.evidence.energies?;
    let held_out = before.held_out.zip(after.held_out);
    let held_out = held_out.map_or(String::new(), |(before, after)| {
        format!(" ({before:.2} to {after:.2} in held-out runs)")
    });
    Some(format!(
        "No fit follows the ringing of the recordings, so that the gap, which compares its phases, hardly shrinks. What is named was \
         found by how strongly the machine rings in each band of orders and sector of the revolution: what is left of that falls \
         from {:.2} to {:.2}{held_out}, where 1 is what a law somewhat off leaves. Its values have no intervals for this reason.",
        before.fitted, after.fitted,
    ))
}

/// That runs which were predicted only show more than the fitted ones, in which there is no gap.
fn predicted_worse(explanation: &Explanation, effort: &Effort) -> Option<String> {
    let left = explanation.baseline.held_out?;
    if explanation.verdict != Verdict::NoGap || left <= EXPLAINED {
        return None;
    }
    Some(format!(
        "Runs that are fitted are left with noise alone, but those that are predicted only ({}) with {left:.2} times the noise. Either \
         they depend on something that the fitted runs do not determine, or something acts in them alone. `--hold-out` chooses which \
         runs are predicted only, so that the others are fitted.",
        effort.held_out.join(", ")
    ))
}

/// Why nothing is named although there is a gap.
fn unexplained(explanation: &Explanation) -> Option<String> {
    if explanation.verdict != Verdict::Unexplained {
        return None;
    }
    let before = explanation.baseline.fitted;
    let refused = explanation.refused.iter();
    // A fit that ends above the machine without the effect did not get anywhere.
    let nearer = refused.filter(|one| one.evidence.misfit[1] < before);
    let Some(nearest) = nearer.max_by(|a, b| a.probability.total_cmp(&b.probability)) else {
        return Some(format!(
            "The gap is {before:.2} times the noise, and none of the effects that were tried makes the recordings likelier."
        ));
    };
    let [_, after] = nearest.evidence.misfit;
    let held_out = nearest.evidence.heldout_misfit;
    let held_out = held_out.map_or(String::new(), |[before, after]| {
        format!(", and {after:.2} of {before:.2} in held-out runs")
    });
    Some(format!(
        "Nothing is named. The most probable of the effects that were tried is {}. It leaves {after:.2} of {before:.2} times the \
         noise{held_out}: its probability is {:.2}, and {NAMED} is needed.",
        nearest.candidate.label(),
        nearest.probability,
    ))
}

/// The pressures whose valves both open: elsewhere there are no two lines that the polytropes lead to.
fn full_cycles<'a>(recorded: &'a Recorded) -> impl Iterator<Item = &'a PressureGap> {
    recorded.gas.iter().filter(|gap| {
        let mut shut = recorded.shut_valves.iter();
        !shut.any(|shut| shut.run == gap.run && shut.channel == gap.column)
    })
}

/// Takes the intervals of clearance volumes and exponents where no curve determines both: there the law decides, and that of a model
/// which leaves more than noise is not the machine's.
pub(crate) fn leave_open(explanation: &mut Explanation, recorded: &Recorded) {
    let mut cycles = full_cycles(recorded).peekable();
    let open = cycles.peek().is_some() && cycles.all(|gap| together(gap).is_some());
    if !open || explains(&explanation.explained) {
        return;
    }
    for estimate in &mut explanation.estimates {
        let path = &estimate.parameter.path;
        if path.contains("cylinder.") && (path.ends_with("clearance") || path.contains("exponent"))
        {
            estimate.interval = None;
        }
    }
}

/// What a pressure by itself leaves open about clearance and exponents.
fn together(gap: &PressureGap) -> Option<String> {
    let indicator = gap.indicator.as_ref()?;
    let [a, b] = indicator.alternatives;
    let [better, worse] = [a.scatter.min(b.scatter), a.scatter.max(b.scatter)];
    let stroke = indicator.chamber.stroke();
    let reading = |other: &Alternative| {
        let [compression, expansion] = other.exponents;
        let clearance = 100.0 * other.clearance / stroke;
        format!("{clearance:.1} % of the stroke with {compression:.2} and {expansion:.2}")
    };
    (worse < AS_GOOD * better).then(|| {
        format!(
            "{}, {}: this curve does not determine both clearance volume and polytropic exponents: a clearance \
             of {} (compression, expansion) fits it as well as {}. Take one of them from elsewhere.",
            gap.run,
            gap.column,
            reading(&a),
            reading(&b)
        )
    })
}

/// Pairs of parameters that are strongly correlated.
fn correlated(explanation: &Explanation) -> Vec<String> {
    let estimates = &explanation.estimates;
    let pairs = (0..estimates.len()).flat_map(|i| (0..i).map(move |j| (j, i)));
    let close = pairs.filter(|at| explanation.correlations[*at].abs() > TOGETHER);
    let words = close.map(|at| {
        format!(
            "{} and {} are strongly correlated (correlation {:.2}).",
            estimates[at.0].parameter.path,
            estimates[at.1].parameter.path,
            explanation.correlations[at]
        )
    });
    words.collect()
}

/// At which crank angle a held suction valve closes, as a sentence. None unless `key` is the angle for which it
/// is held.
pub(crate) fn closing(item: &Candidate, key: &str, held: f64) -> Option<String> {
    let is_held = item.entry.parameter(key)?.on_the_stroke;
    if item.entry.proposal != Proposal::PerEnd || !is_held {
        return None;
    }
    let after = held.to_degrees();
    let (end, dead) = match item.end() {
        Some("head") => ("head end", PI),
        Some("crank") => ("crank end", 0.0),
        _ => return Some(format!(" It closes {after:.0}° after the dead centre.")),
    };
    let angle = (dead + held).to_degrees();
    Some(format!(
        " At the {end} it closes {after:.0}° after the dead centre, at a crank angle of {angle:.0}°."
    ))
}
