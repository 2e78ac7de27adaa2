//! Where a search leads for each set of joints that are clear.
//!
//! Joints act on each other, and those that are clear make up for one that is missing. So all clearances of a set are searched
//! at once: by energies, which have few minima, from many points. The best of these points says already which sets are likely.

use super::descent::few;
use super::draws::draws;
use super::effort::Effort;
use super::joint::Joint;
use super::model::{Contacts, Model};
use super::parts::{Part, joined, parts};
use crate::cloud_descent::{CLOUDS, Descent, Led, Width, descend};
use crate::energies::Energies;
use crate::error::Error;
use crate::optimiser::LeastSquares;
use crate::prior::WithPriors;
use crate::problem::Problem;
use crate::search::STARTS;
use crate::stages::Stage;
use std::collections::BTreeMap;

/// Points that are drawn for each clear joint.
const DRAWN: usize = 64;
/// Points that are looked at side by side, before the search may be stopped.
const AT_ONCE: usize = 64;
/// The best points of which parts are exchanged for those of others.
const MIXED: usize = 16;
/// Half the width of a cloud to begin with: of the logarithm of a clearance, and of what is known before, in standard deviations.
const CLEARANCE: f64 = 0.5;
const SPREADS: f64 = 1.0;
/// Clouds after which the better half of the descents goes on (successive halving, Jamieson and Talwalkar 2016), and how many at least.
const HALVED: usize = 4;
const GO_ON: usize = 2;
/// Sets of the same size to which one more joint is added, and sets that are searched: the best by the points that are drawn.
const BEST: usize = 3;

/// A part of the machine: how many there are, and which of its joints are clear.
type OfPart = (usize, Vec<usize>);

/// A search over sets of joints.
pub(super) struct Sets<'a> {
    /// The machine of the file.
    healthy: &'a Problem,
    /// Its joints.
    joints: &'a [Joint],
    /// Where what else is unknown begins.
    x: &'a [f64],
    /// Points that were drawn for each part of the machine with each set of its joints, and where descents from them have led.
    drawn: BTreeMap<OfPart, Vec<Led>>,
    ended: BTreeMap<OfPart, Vec<Led>>,
}

/// A set with where descents have led.
pub(super) struct Ends {
    /// The machine with these joints clear.
    pub model: Model,
    /// The ends, the best one first.
    pub led: Vec<Led>,
}

impl<'a> Sets<'a> {
    /// Of the joints of the machine `healthy`, with what else is unknown at `x`.
    pub fn new(healthy: &'a Problem, joints: &'a [Joint], x: &'a [f64]) -> Self {
        Self {
            healthy,
            joints,
            x,
            drawn: BTreeMap::new(),
            ended: BTreeMap::new(),
        }
    }

    /// The model in which the joints that are clear in the machine file and these are clear, and where it begins.
    ///
    /// # Errors
    /// A joint that cannot be clear.
    pub fn model(&self, more: &[usize]) -> Result<(Model, Vec<f64>), Error> {
        let all = 0..self.joints.len();
        let mut clear: Vec<usize> = all.filter(|i| self.joints[*i].stated.is_some()).collect();
        clear.extend(more);
        let model = Model::new(self.healthy, self.joints, clear, Contacts::Related)?;
        // What else is unknown comes last.
        let mut at = vec![0.0; model.problem.parameters.len() - self.x.len()];
        at.extend_from_slice(self.x);
        Ok((model, at))
    }

    /// Sets of joints that are ideal in the machine file, but may be clear, the likeliest first: with each joint more the best point that
    /// is drawn is better.
    ///
    /// # Errors
    /// An invalid machine.
    pub fn likely(&mut self, effort: &mut Effort) -> Result<Vec<Vec<usize>>, Error> {
        let all = 0..self.joints.len();
        let ideal: Vec<usize> = all.filter(|i| self.joints[*i].stated.is_none()).collect();
        let mut level = vec![(Vec::new(), self.criterion(&[], effort)?)];
        let mut likely = Vec::new();
        while !level.is_empty() {
            let mut wider: Vec<(Vec<usize>, f64)> = Vec::new();
            for (joints, before) in &level {
                for more in with_one_more(joints, &ideal) {
                    let criterion = self.criterion(&more, effort)?;
                    if criterion < *before && !wider.iter().any(|(known, _)| *known == more) {
                        wider.push((more, criterion));
                    }
                }
            }
            wider.sort_by(|a, b| a.1.total_cmp(&b.1));
            wider.truncate(BEST);
            likely.extend(wider.iter().cloned());
            level = wider;
        }
        likely.sort_by(|a, b| a.1.total_cmp(&b.1));
        likely.truncate(BEST);
        Ok(likely.into_iter().map(|(joints, _)| joints).collect())
    }

    /// What is left of the energies at the best point that is drawn with these ideal joints clear, too, and ln n for each clearance (Schwarz
    /// 1978).
    fn criterion(&mut self, more: &[usize], effort: &mut Effort) -> Result<f64, Error> {
        let (model, at) = self.model(more)?;
        let mut left = 0.0;
        for part in &parts(&model)? {
            let best = self.drawn(part, &at, effort).first();
            left += best.map_or(f64::INFINITY, |best| best.left);
        }
        let count = Energies::loud(&few(&model.problem)).count() as f64;
        Ok(left + model.clear.len() as f64 * count.ln())
    }

    /// Points of a part, the best one first.
    fn drawn(&mut self, part: &Part, at: &[f64], effort: &mut Effort) -> &[Led] {
        let asked = (part.of, part.model.clear.clone());
        let joints = self.joints;
        let new = || drawn(&part.model, joints, &part.of_whole(at), effort);
        self.drawn.entry(asked).or_insert_with(new)
    }

    /// Where descents lead with these ideal joints clear, too.
    ///
    /// # Errors
    /// An invalid machine.
    pub fn ends(&mut self, more: &[usize], effort: &mut Effort) -> Result<Ends, Error> {
        let (model, at) = self.model(more)?;
        let parts = parts(&model)?;
        let mut ends = Vec::new();
        for part in &parts {
            let asked = (part.of, part.model.clear.clone());
            let led = match self.ended.remove(&asked) {
                Some(led) => led,
                None => {
                    let drawn = self.drawn(part, &at, effort);
                    let starts: Vec<Vec<f64>> =
                        drawn.iter().take(STARTS).map(|led| led.x.clone()).collect();
                    ends_of(&part.model, &starts, effort)
                }
            };
            self.ended.insert(asked, led.clone());
            ends.push(led);
        }
        Ok(Ends {
            led: joined(&parts, &ends, &at),
            model,
        })
    }
}

/// These joints and one of the others, in ascending order.
fn with_one_more(joints: &[usize], all: &[usize]) -> Vec<Vec<usize>> {
    let others = all.iter().filter(|joint| !joints.contains(joint));
    let with = |other: &usize| {
        let mut with = [joints, &[*other]].concat();
        with.sort_unstable();
        with
    };
    others.map(with).collect()
}

/// Points that are drawn for a model, and those that combine parts of them, the best one first.
fn drawn(model: &Model, joints: &[Joint], x: &[f64], effort: &mut Effort) -> Vec<Led> {
    let few = few(&model.problem);
    let energies = Energies::loud(&few);
    let compared = WithPriors {
        inner: &energies,
        priors: &model.priors,
    };
    let mut points = vec![x.to_vec()];
    points.extend(draws(model, joints, x, DRAWN * model.clear.len()));
    effort.begins(Stage::Screen);
    let mut drawn: Vec<Led> = Vec::new();
    for points in points.chunks(AT_ONCE) {
        if effort.stopped {
            break;
        }
        let residuals = compared.residuals_of_all(points).into_iter();
        let left = residuals.map(|residuals| residuals.iter().map(|r| r * r).sum());
        let led = points
            .iter()
            .zip(left)
            .map(|(x, left)| Led { x: x.clone(), left });
        drawn.extend(led);
        effort.evaluated(points.len() as u64);
    }
    drawn.sort_by(|a, b| a.left.total_cmp(&b.left));
    let points: Vec<Vec<f64>> = drawn.iter().map(|led| led.x.clone()).collect();
    let first = if effort.stopped { 0 } else { MIXED };
    let mixed = compared.mixed(&points, first).into_iter();
    drawn.extend(mixed.map(|(x, left)| Led { x, left }));
    effort.ends();
    drawn.sort_by(|a, b| a.left.total_cmp(&b.left));
    drawn
}

/// The ends of descents of a model from these points, the best one first.
fn ends_of(model: &Model, starts: &[Vec<f64>], effort: &mut Effort) -> Vec<Led> {
    let few = few(&model.problem);
    let energies = Energies::loud(&few);
    let compared = WithPriors {
        inner: &energies,
        priors: &model.priors,
    };
    let clearances = (0..model.clear.len()).map(|place| (place, CLEARANCE));
    let priors = model.priors.iter();
    let priors = priors.map(|prior| (prior.place, SPREADS * prior.spread));
    let widths: Vec<Width> = clearances.chain(priors).collect();
    effort.begins(Stage::Clearances);
    let led = descended(&compared, starts, &widths, effort);
    effort.ends();
    led
}

/// Where descents from these starts lead, the best one first.
fn descended(
    compared: &impl LeastSquares,
    starts: &[Vec<f64>],
    widths: &[Width],
    effort: &mut Effort,
) -> Vec<Led> {
    let new = |start: &Vec<f64>| Descent::new(start, widths, compared);
    let mut going: Vec<Descent> = starts.iter().map(new).collect();
    let mut ended = Vec::new();
    for number in 0..CLOUDS {
        if number > 0 && number % HALVED == 0 {
            going.sort_by(|a, b| a.best().left.total_cmp(&b.best().left));
            let half = going.len().div_ceil(2).max(GO_ON).min(going.len());
            ended.extend(going.drain(half..));
        }
        if !descend(compared, &mut going, |count| effort.evaluated(count)) {
            break;
        }
    }
    let all = going.iter().chain(&ended).map(Descent::best);
    let mut led: Vec<Led> = all.filter(|led| led.left.is_finite()).collect();
    led.sort_by(|a, b| a.left.total_cmp(&b.left));
    led
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_set_is_followed_by_those_with_one_joint_more() {
        assert_eq!(with_one_more(&[], &[2, 5]), [[2], [5]]);
        assert_eq!(with_one_more(&[5], &[2, 5, 7]), [[2, 5], [5, 7]]);
        assert!(with_one_more(&[2, 5], &[2, 5]).is_empty());
    }
}
