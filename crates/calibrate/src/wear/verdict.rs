//! The verdict on each joint.

use super::discrepancy::Discrepancy;
use super::joint::Joint;
use super::model::Model;
use super::results::{JointWear, Together, Verdict};
use super::selection::Found;
use crate::branch::on_best_branches;
use crate::error::Error;
use crate::identifiability::information;
use crate::likelihood::Likelihood;
use crate::problem::Problem;

/// Correlation from which two clearances are hardly told apart.
const CORRELATED: f64 = 0.95;
/// Difference of the deviance from which recordings show a clearance: odds of twenty to one.
const SHOWN: f64 = 6.0;

/// Standard deviations by which it may differ by chance, of motions that scatter.
const CHANCE: f64 = 3.0;

/// What the verdicts rest on.
pub(super) struct Grounds<'a> {
    /// The machine as its file has it.
    pub healthy: &'a Problem,
    /// Its joints.
    pub joints: &'a [Joint],
    /// The model that the evidence favours.
    pub found: &'a Found,
    /// What is known where that model is wrong.
    pub discrepancy: Option<&'a Discrepancy>,
    /// Whether the search came to its end.
    pub complete: bool,
    /// A joint counts as worn from this many times its normal clearance.
    pub worn_from: f64,
}

impl Grounds<'_> {
    /// The verdict on the joint of this index.
    ///
    /// # Errors
    /// A machine that cannot be simulated.
    pub fn verdict(&self, index: usize, together: &[Together]) -> Result<JointWear, Error> {
        let place = self.found.model.clear.iter().position(|i| *i == index);
        if let Some(doubt) = self.doubt() {
            let value = place.map(|place| self.found.fit.estimates[place].value);
            return Ok(self.wear(index, Verdict::Unclear, doubt.to_owned(), value, None));
        }
        match place {
            Some(place) => Ok(self.of_clear(index, place, together)),
            None => self.of_ideal(index),
        }
    }

    /// Why the model says nothing of any joint, one that is ideal in it included; none where it explains the recordings.
    fn doubt(&self) -> Option<&'static str> {
        let fit = &self.found.fit;
        match self.discrepancy {
            Some(_) => None,
            None if !self.complete => Some("the search was stopped: this is the best so far"),
            None if !fit.model_is_adequate() => Some(
                "the best fit is far from the recordings, and may be another minimum than that of the machine",
            ),
            None => None,
        }
    }

    fn of_clear(&self, index: usize, place: usize, together: &[Together]) -> JointWear {
        let estimate = &self.found.fit.estimates[place];
        let limit = self.limit(index);
        let (value, interval) = match self.discrepancy {
            Some(discrepancy) => {
                let value = estimate.parameter.value(discrepancy.x[place]);
                let ends = discrepancy.ranges[place];
                let [least, greatest] = estimate.parameter.bounds;
                let of = |x| estimate.parameter.value(x).clamp(least, greatest);
                (value, ends.map(|ends| ends.map(of)))
            }
            None => {
                // What is left counts as noise.
                let by = self.found.misfit().max(1.0);
                let [least, greatest] = estimate.parameter.bounds;
                let wider = |end: f64| {
                    let end = estimate.value + by * (end - estimate.value);
                    end.clamp(least, greatest)
                };
                let interval = estimate.interval.map(|ends| ends.map(wider));
                (estimate.value, interval)
            }
        };
        let (verdict, reason) = match interval {
            Some([low, _]) if low > limit => (
                Verdict::Worn,
                "the interval lies above the clearance of a worn joint",
            ),
            Some([_, high]) if high <= limit => (
                Verdict::Healthy,
                "the interval lies below the clearance of a worn joint",
            ),
            Some(_) => (
                Verdict::Unclear,
                "the interval includes the clearance from which the joint counts as worn",
            ),
            None => {
                let reason = self.not_identifiable(index, together);
                return self.wear(index, Verdict::NotIdentifiable, reason, None, None);
            }
        };
        self.wear(index, verdict, reason.to_owned(), Some(value), interval)
    }

    /// A joint that is ideal in the machine file and in the model: healthy if the recordings would show it worn.
    fn of_ideal(&self, index: usize) -> Result<JointWear, Error> {
        let timing = self.discrepancy.map_or(0.0, |d| d.timing);
        let deviance =
            |model: &Model, x: &[f64]| Likelihood::coarse(&model.problem, timing).mean_deviance(x);
        let best = &self.found.model;
        let x = match self.discrepancy {
            Some(discrepancy) => discrepancy.x.clone(),
            None => self.found.fit.coordinates(),
        };
        let clear = best.clear.iter().copied().chain([index]).collect();
        let mut worn = Model::new(self.healthy, self.joints, clear, best.contacts)?;
        let mut at = worn.coordinates_of(best, &x);
        let place = worn.clear.len() - 1;
        at[place] = worn.problem.parameters[place].coordinate(self.limit(index));
        worn.problem = on_best_branches(&worn.problem, &at);
        let shown = match deviance(&worn, &at) {
            Ok((with, chance)) => {
                let (without, other) = deviance(best, &x)?;
                with - without > SHOWN + CHANCE * (chance + other).sqrt()
            }
            // Where the worn machine cannot be simulated, nothing is known.
            Err(_) => false,
        };
        let (verdict, reason) = match shown {
            true => (
                Verdict::Healthy,
                "the recordings need no clearance of this joint, and would show a worn one",
            ),
            false => (
                Verdict::NotIdentifiable,
                "the channels of these recordings do not show a clearance of this joint",
            ),
        };
        Ok(self.wear(index, verdict, reason.to_owned(), None, None))
    }

    fn not_identifiable(&self, index: usize, together: &[Together]) -> String {
        let path = &self.joints[index].path;
        let other = together.iter().find_map(|pair| match &pair.joints {
            [a, b] if a == path => Some(b),
            [a, b] if b == path => Some(a),
            _ => None,
        });
        match other {
            Some(other) => {
                format!("the recordings do not distinguish its clearance from that of {other}")
            }
            None => "its interval would fill half of the range that was searched".to_owned(),
        }
    }

    /// The clearance from which a joint counts as worn, m.
    fn limit(&self, index: usize) -> f64 {
        self.worn_from * self.joints[index].normal
    }

    fn wear(
        &self,
        index: usize,
        verdict: Verdict,
        reason: String,
        clearance: Option<f64>,
        interval: Option<[f64; 2]>,
    ) -> JointWear {
        JointWear {
            verdict,
            reason,
            clearance_m: clearance,
            low_m: interval.map(|[low, _]| low),
            high_m: interval.map(|[_, high]| high),
            diametral_clearance_m: clearance.map(|clearance| 2.0 * clearance),
            healthy_m: self.joints[index].stated,
            worn_from_m: self.limit(index),
        }
    }
}

/// Pairs of joints whose clearances are strongly correlated at the best fit, those that are not identifiable included where its
/// motion `repeats` itself.
pub(super) fn together(joints: &[Joint], found: &Found, repeats: bool) -> Vec<Together> {
    let model = &found.model;
    let likelihood = Likelihood::new(&model.problem);
    let correlations = match repeats {
        true => information(&likelihood, &found.fit.coordinates()).correlations,
        false => found.fit.correlations.clone(),
    };
    let mut pairs = Vec::new();
    for a in 0..model.clear.len() {
        for b in a + 1..model.clear.len() {
            let correlation = correlations[(a, b)];
            if correlation.abs() >= CORRELATED {
                pairs.push(Together {
                    joints: [a, b].map(|place| joints[model.clear[place]].path.clone()),
                    correlation,
                });
            }
        }
    }
    pairs
}
