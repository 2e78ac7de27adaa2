//! Intervals of clearances that include what is not known of the contact parameters.
//!
//! A machine file has its contact parameters from a calibration or a data sheet, and their relation to the clearance is a
//! model. What they may be off by moves the clearances that were found with them.

use super::joint::Joint;
use super::selection::Found;
use crate::fit::Estimate;
use crate::identifiability::widening;
use crate::likelihood::Likelihood;
use crate::normal::QUANTILE;
use crate::prior::WithPriors;
use crate::statistical_linearization;
use crate::statistics::Statistics;

/// A contact parameter of the machine file lies within this share of its true value.
const TOLERANCE: f64 = 0.05;

/// Widens the intervals of a fit whose contact parameters are those of the machine file, and whose motion `repeats` itself or does not.
pub(super) fn widen(joints: &[Joint], found: &mut Found, repeats: bool) {
    let problem = found.model.with_tolerance(joints, TOLERANCE);
    let mut x = found.fit.coordinates();
    // Contact parameters come last.
    x.resize(problem.parameters.len(), 0.0);
    let estimates = &mut found.fit.estimates;
    if x.len() == estimates.len() {
        return;
    }
    let known: Vec<usize> = (0..estimates.len())
        .filter(|i| estimates[*i].interval.is_some())
        .collect();
    let factors = match repeats {
        true => widening(&Likelihood::new(&problem), &x, &known),
        false => {
            let statistics = WithPriors {
                inner: &Statistics::new(&problem),
                priors: &found.model.priors,
            };
            let spreads: Vec<f64> = known.iter().map(|i| deviation(&estimates[*i])).collect();
            statistical_linearization::widening(&statistics, &x, &known, &spreads)
        }
    };
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
}

/// The standard deviation of an estimate's coordinate; 0 without an interval.
fn deviation(estimate: &Estimate) -> f64 {
    let parameter = &estimate.parameter;
    let ends = estimate
        .interval
        .map(|ends| ends.map(|end| parameter.coordinate(end)));
    ends.map_or(0.0, |[low, high]| (high - low) / (2.0 * QUANTILE))
}
