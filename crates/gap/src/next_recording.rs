//! What to measure next: where an effect and its rivals differ most.

use crate::explain::Found;

/// The run in which the nearest rival of an effect does worst beside it, and by how much, as misfits
/// of the effect and of the rival; none without a rival.
pub fn next_recording(found: &[Found]) -> Option<String> {
    let (effect, rival) = found
        .iter()
        .filter_map(|effect| Some((effect, effect.rivals.first()?)))
        .min_by(|a, b| a.1.evidence.misfit[1].total_cmp(&b.1.evidence.misfit[1]))?;
    let of_effect = |id: &str| effect.by_run.iter().find(|(run, _)| run == id);
    let apart = rival.by_run.iter().filter_map(|(run, rival)| {
        let (_, effect) = of_effect(run)?;
        Some((run, *effect, *rival))
    });
    let (run, with, without) = apart.max_by(|a, b| (a.2 - a.1).total_cmp(&(b.2 - b.1)))?;
    let [name, other] = [&effect.candidate, &rival.candidate].map(|c| c.label());
    Some(format!(
        "{name} and {other} differ most at the speed, load and clearances of {run}, where they leave \
         {with:.2} and {without:.2} times the noise: more recordings there, or further that way, would \
         tell them apart."
    ))
}
