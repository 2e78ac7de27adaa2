//! Intervals of clearances that include what is not known of the contact parameters.
//!
//! A machine file has its contact parameters from a calibration or a data sheet, and their relation to the clearance is a
//! model. What they may be off by moves the clearances that were found with them.

use super::joint::Joint;
use super::model::Model;
use super::selection::Found;
use crate::error::Error;
use crate::identifiability::widening;
use crate::likelihood::Likelihood;
use crate::problem::Problem;

/// A contact parameter of the machine file lies within this share of its true value.
const TOLERANCE: f64 = 0.05;

/// Widens the intervals of a fit whose contact parameters are those of the machine file.
///
/// # Errors
/// A joint that cannot be clear.
pub(super) fn widen(healthy: &Problem, joints: &[Joint], found: &mut Found) -> Result<(), Error> {
    if found.model.contacts {
        return Ok(());
    }
    let clear = found.model.clear.clone();
    let first = clear.len();
    let mut model = Model::new(healthy, joints, clear, true)?;
    let x = model.coordinates_of(&found.model, &found.fit.coordinates());
    let contacts = first..x.len() - healthy.parameters.len();
    for parameter in &mut model.problem.parameters[contacts.clone()] {
        let nominal = parameter.nominal;
        parameter.bounds = [1.0 - TOLERANCE, 1.0 + TOLERANCE].map(|share| share * nominal);
    }
    // A place in the fit is one in the model, but for the contact parameters between.
    let place_of = |estimate: usize| match estimate < first {
        true => estimate,
        false => estimate + contacts.len(),
    };
    let estimates = &mut found.fit.estimates;
    let known: Vec<usize> = (0..estimates.len())
        .filter(|i| estimates[*i].interval.is_some())
        .collect();
    let places: Vec<usize> = known.iter().map(|i| place_of(*i)).collect();
    let factors = widening(&Likelihood::new(&model.problem), &x, &places);
    for (i, factor) in known.into_iter().zip(factors) {
        let estimate = &mut estimates[i];
        let parameter = &estimate.parameter;
        let at = parameter.coordinate(estimate.value);
        let [least, greatest] = parameter.bounds;
        let wider = |end: f64| {
            let end = parameter.value(at + factor * (parameter.coordinate(end) - at));
            end.clamp(least, greatest)
        };
        estimate.interval = estimate.interval.map(|ends| ends.map(wider));
    }
    Ok(())
}
