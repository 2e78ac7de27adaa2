//! Errors of the measuring chain, not of the machine: reported as effects like any other.

use crate::candidate::Candidate;
use crate::criteria::{Evidence, evidence};
use crate::finding::{Found, Tried};
use crate::mains_hum::Hum;
use crate::model::Model;
use calibrate::fit::Estimate;
use input::effects::{Entry, Proposal, proposed};

/// An encoder is set to a dead centre within this, rad (a tenth of a degree): less is no finding.
const SET: f64 = 1.7e-3;
/// An offset that counts is so many times the half width of its 95 % interval.
const CLEAR: f64 = 2.0;

/// The zero of the crank angle, where it is not at top dead centre; its item of a machine file.
pub(crate) fn crank_angle_offset(
    estimates: &[Estimate],
    before: impl FnOnce() -> Result<Model, crate::Error>,
    after: &Model,
) -> Result<Option<(Found, Model)>, crate::Error> {
    let mut offsets = estimates
        .iter()
        .filter(|e| e.parameter.is_crank_angle_offset() && e.parameter.run.is_none());
    let (Some(estimate), Some(entry)) = (offsets.next(), proposed(Proposal::CrankAngleZero)) else {
        return Ok(None);
    };
    let clear = estimate
        .interval
        .is_some_and(|[low, high]| estimate.value.abs() > CLEAR * 0.5 * (high - low));
    if estimate.value.abs() < SET || !clear {
        return Ok(None);
    }
    let before = before()?;
    let evidence = evidence(&before, after);
    Ok(Some((
        finding(entry, Vec::new(), vec![estimate.value], evidence),
        before,
    )))
}

/// A hum as an effect.
pub(crate) fn mains_hum(hum: &Hum, model: &Model) -> Option<Found> {
    let entry = proposed(Proposal::Hum)?;
    let of = |key: &str, start: f64| match key {
        "amplitude" => hum.amplitude,
        "frequency" => hum.frequency,
        _ => start,
    };
    let values = entry.parameters.iter().map(|p| of(p.key, p.start));
    let throw = hum.channel.split_once('.').map(|(throw, _)| throw);
    let place = throw.map(|throw| ("throw", throw.to_owned())).into_iter();
    let evidence = Evidence {
        log_odds: hum.over_noise.ln(),
        misfit: [model.fitted; 2],
        heldout_misfit: model.held_out.map(|held_out| [held_out; 2]),
        timing: model.timing,
    };
    Some(finding(entry, place.collect(), values.collect(), evidence))
}

fn finding(
    entry: &'static Entry,
    place: Vec<(&'static str, String)>,
    values: Vec<f64>,
    evidence: Evidence,
) -> Found {
    let candidate = Candidate {
        entry,
        place,
        fixed: Vec::new(),
        each: Vec::new(),
        shared: false,
        formed: false,
    };
    Found {
        effect: Tried {
            candidate,
            values,
            evidence,
            probability: 1.0,
            model: None,
        },
        gap: None,
        rivals: Vec::new(),
    }
}
