//! Whether an effect has earned its place, and what an explanation comes to.

pub use calibrate::likelihood::NOISE;

use crate::model::Model;
use crate::recorded::is_of_pressures;
use serde::{Deserialize, Serialize};

/// Pressures this near to the noise show no effect by themselves.
pub(crate) const GAS_NOISE: f64 = 2.0;
/// A model this near to the noise explains what was missing.
pub const EXPLAINED: f64 = 1.5;
/// Candidates whose misfit is within this factor of the best one's are its rivals.
pub(crate) const RIVAL: f64 = 3.0;
/// The same where the best one leaves more than noise: what is left is then other physics, which
/// every candidate leaves.
const RIVAL_ABOVE_NOISE: f64 = 1.5;
/// An effect earns its place where it takes this share of the misfit, squared above the noise, of
/// fitted and of held-out runs.
pub(crate) const EARNED: f64 = 0.3;
/// The same where only pressures were recorded. The gas alone can explain them. After one
/// effect the contribution of others is still in the way of the next.
pub(crate) const EARNED_OF_GAS: f64 = 0.2;
/// Share of the distance to the noise that must be gone, of fitted and of held-out runs: for effects
/// to explain a part, and for a single one to be sure by itself.
pub(crate) const PARTLY: f64 = 0.5;
const SURE: f64 = 0.8;

/// What an explanation comes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The calibrated model fits within the noise.
    NoGap,
    /// With the effects it is.
    Explained,
    /// With the effects it is much nearer, and something is left.
    PartlyExplained,
    /// Nothing in the catalogue brings it near.
    Unexplained,
}

impl Verdict {
    /// It as results name it.
    pub fn name(self) -> &'static str {
        match self {
            Self::NoGap => "no-gap",
            Self::Explained => "explained",
            Self::PartlyExplained => "partly-explained",
            Self::Unexplained => "unexplained",
        }
    }
}

/// What speaks for an effect.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Evidence {
    /// Share of the residual that the score test lets it explain.
    pub score: f64,
    /// Misfit of the fitted runs without and with it, in standard deviations of the noise.
    pub misfit: [f64; 2],
    /// The same of the held-out runs.
    pub heldout_misfit: Option<[f64; 2]>,
    /// Bayesian information criterion with it less that without it, revolutions' lines counted as
    /// one observation each: below −10 is strong evidence.
    pub delta_bic: f64,
}

/// Whether this share of the distance to the noise is gone.
fn closes(share: f64, [before, after]: [f64; 2]) -> bool {
    after - 1.0 <= (1.0 - share) * (before - 1.0)
}

/// Whether most of the distance to the noise is gone, from the misfit before to that after.
pub(crate) fn closes_most(misfit: [f64; 2]) -> bool {
    closes(SURE, misfit)
}

impl Evidence {
    /// Whether the effect by itself closes most of the gap that it was added for.
    pub(crate) fn is_sure(&self) -> bool {
        closes_most(self.misfit) && self.heldout_misfit.is_none_or(closes_most)
    }
}

/// What speaks for `after`, which has an effect that `before` has not.
pub(crate) fn evidence(before: &Model, after: &Model, score: f64) -> Evidence {
    let held_out = before.held_out.zip(after.held_out);
    Evidence {
        score,
        misfit: [before.fitted, after.fitted],
        heldout_misfit: held_out.map(|(before, after)| [before, after]),
        delta_bic: before.bic_to(after),
    }
}

/// The misfit up to which a candidate is a rival of the best one, which has `least`.
pub(crate) fn rival(least: f64) -> f64 {
    match least > EXPLAINED {
        true => RIVAL_ABOVE_NOISE * least,
        false => RIVAL * least,
    }
}

/// Whether the effect that `after` has and `before` has not earns its place. It does not where, without it, the
/// fitted runs fit within the noise and the held-out ones are explained.
pub(crate) fn earns(before: &Model, after: &Model) -> bool {
    let excess = |misfit: f64| (misfit * misfit - 1.0).max(0.0);
    let share = match is_of_pressures(&after.problem) {
        true => EARNED_OF_GAS,
        false => EARNED,
    };
    let takes = |before: f64, after: f64| excess(after) <= (1.0 - share) * excess(before);
    let held_out = before.held_out.zip(after.held_out);
    let is_left = before.fitted > NOISE || before.held_out.is_some_and(|held| held > EXPLAINED);
    is_left
        && takes(before.fitted, after.fitted)
        && held_out.is_none_or(|(before, after)| after < NOISE || takes(before, after))
}

/// What a model with so many effects comes to.
pub(crate) fn verdict(baseline: &Model, model: &Model, effects: usize) -> Verdict {
    if effects == 0 && baseline.fitted <= NOISE {
        return Verdict::NoGap;
    }
    let worst = model
        .held_out
        .map_or(model.fitted, |held| held.max(model.fitted));
    let held_out = baseline.held_out.zip(model.held_out);
    let closes = |before, after| closes(PARTLY, [before, after]);
    let held_out = held_out.is_none_or(|(before, after)| closes(before, after));
    if effects == 0 {
        Verdict::Unexplained
    } else if worst <= EXPLAINED {
        Verdict::Explained
    } else if held_out && closes(baseline.fitted, model.fitted) {
        Verdict::PartlyExplained
    } else {
        Verdict::Unexplained
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use calibrate::{CrankMotion, Problem};

    fn model(fitted: f64, held_out: f64) -> Model {
        let problem = Problem {
            tree: serde_json::Value::Null,
            parameters: Vec::new(),
            runs: Vec::new(),
            crank: CrankMotion::Driven,
            meter: calibrate::meter::Meter::default(),
        };
        Model {
            problem,
            x: Vec::new(),
            fitted,
            held_out: Some(held_out),
            by_run: Vec::new(),
        }
    }

    #[test]
    fn an_effect_earns_its_place_where_something_is_left_without_it() {
        let good = model(0.9, 0.9);
        assert!(earns(&model(5.0, 6.0), &good));
        assert!(earns(&model(1.0, 6.0), &good));
        assert!(!earns(&model(0.95, 0.9), &good));
        assert!(!earns(&model(1.0, 1.4), &good));
        assert!(!earns(&model(5.0, 6.0), &model(4.8, 6.0)));
        assert!(!earns(&model(5.0, 6.0), &model(2.0, 7.0)));
    }
}
