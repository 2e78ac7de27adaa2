//! Which of the effects that were found are believed where more than noise is left.

use crate::criteria::{Verdict, verdict};
use crate::error::Error;
use crate::finding::{Explained, Found, Tried, first_item, with_only};
use crate::fitter::Fitter;
use crate::model::Model;
use calibrate::Problem;
use calibrate::fit::Estimate;

/// The model with the accepted effects alone; the others are refused. An effect is accepted in three cases:
///
/// 1. All effects together explain the recordings fully.
/// 2. The effect closes most of the gap that it was added for.
/// 3. The effects explain a part that no force without a name reduces further, and the size of this effect is
///    identifiable. An effect that does as well at any size stands for something else.
pub(crate) fn believed(
    fitter: &Fitter,
    problem: &Problem,
    baseline: &Model,
    explained: Explained,
    force_is_nearer: bool,
) -> Result<Explained, Error> {
    let Explained { model, found, .. } = &explained;
    let sure = |found: &Found| found.effect.evidence.is_sure();
    let by_itself: Vec<bool> = found.iter().map(sure).collect();
    let believed = match verdict(baseline, model, found.len()) {
        Verdict::NoGap | Verdict::Explained => vec![true; found.len()],
        Verdict::PartlyExplained if !force_is_nearer && by_itself.contains(&false) => {
            (fitter.say)("finding which sizes are identifiable", model.fitted);
            let estimates = fitter.bounds(model)?.estimates;
            let identifiable =
                |i| is_identifiable(&estimates, &found[i], first_item(problem, found, i));
            (0..found.len())
                .map(|i| by_itself[i] || identifiable(i))
                .collect()
        }
        Verdict::PartlyExplained | Verdict::Unexplained => by_itself,
    };
    if !believed.contains(&false) {
        return Ok(explained);
    }
    let mut believed = believed.into_iter();
    let is_believed = |_: &Found| believed.next().unwrap_or(true);
    let (mut kept, others): (Vec<Found>, Vec<Found>) =
        explained.found.into_iter().partition(is_believed);
    kept.iter_mut().for_each(|kept| kept.gap = None);
    let others = others.into_iter().map(|other| Tried {
        likeness: None,
        ..other.effect
    });
    Ok(Explained {
        model: with_only(fitter, problem, baseline, &kept)?,
        found: kept,
        refused: others.chain(explained.refused).collect(),
    })
}

/// Whether the size of an effect whose first item has this index is identifiable. It is if one of its amplitudes,
/// or of its parameters if it has no amplitudes.
fn is_identifiable(estimates: &[Estimate], found: &Found, first: usize) -> bool {
    let candidate = found.candidate();
    let entry = candidate.entry;
    let amplitudes = entry.amplitudes().next().is_some();
    let sizes = entry
        .parameters
        .iter()
        .filter(|p| !amplitudes || p.absent.is_some());
    let items = first..first + candidate.items().len();
    let mut paths = sizes.flat_map(|size| {
        let path = move |item| format!("effects.{item}.{}.{}", entry.name, size.key);
        items.clone().map(path)
    });
    paths.any(|path| {
        let estimate = estimates.iter().find(|e| e.parameter.path == path);
        estimate.is_some_and(|estimate| estimate.interval.is_some())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::candidate::Candidate;
    use crate::criteria::evidence;
    use crate::fixture::{effort, problem};

    /// Whether an effect counts as identifiable of which only the parameter of this key is.
    fn is_identifiable_by(effect: &str, key: &str) -> bool {
        let problem = problem();
        let candidate = Candidate::first(&problem, effect);
        let values = candidate.usual();
        let added = candidate.added(&problem, &values).unwrap();
        let before = Model::at(problem.clone(), &[0.0], &effort()).unwrap();
        let found = Found {
            effect: Tried {
                evidence: evidence(&before, &before, 0.0),
                candidate,
                values,
                likeness: None,
                model: None,
            },
            gap: None,
            rivals: Vec::new(),
        };
        let estimate = |parameter: &calibrate::Parameter| Estimate {
            parameter: parameter.clone(),
            value: 1.0,
            interval: parameter.path.ends_with(key).then_some([0.0, 2.0]),
        };
        let estimates: Vec<Estimate> = added.parameters.iter().map(estimate).collect();
        is_identifiable(&estimates, &found, first_item(&problem, &[], 0))
    }

    #[test]
    fn an_effect_is_identifiable_by_its_size() {
        assert!(is_identifiable_by("guide_clearance", ".clearance"));
        assert!(!is_identifiable_by("guide_clearance", ".damping"));
        assert!(!is_identifiable_by("guide_clearance", "contact.stiffness"));
        // One without amplitudes by any of its parameters.
        assert!(is_identifiable_by("sensor_resonance", ".frequency"));
    }
}
