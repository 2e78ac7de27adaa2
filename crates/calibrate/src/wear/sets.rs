//! Where a search leads for each set of joints that are clear.
//!
//! Joints act on each other, and those that are clear make up for one that is missing. So all clearances of a set are searched
//! at once: by energies, which have few minima, from many points.

use super::cloud::{Width, descended};
use super::descent::{Led, few};
use super::draws::draws;
use super::effort::Effort;
use super::joint::Joint;
use super::model::{Contacts, Model};
use super::parts::{joined, parts};
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
/// Half the width of a cloud to begin with: of the logarithm of a clearance, and of what is known before, in standard deviations.
const CLEARANCE: f64 = 0.5;
const SPREADS: f64 = 1.0;

/// A search over sets of joints.
pub(super) struct Sets<'a> {
    /// The machine of the file.
    healthy: &'a Problem,
    /// Its joints.
    joints: &'a [Joint],
    /// Where what else is unknown begins.
    x: &'a [f64],
    /// The ends of each part of the machine with each set of its joints.
    known: BTreeMap<(usize, Vec<usize>), Vec<Led>>,
}

/// A set with where descents have led.
pub(super) struct Ends {
    /// The machine with these joints clear.
    pub model: Model,
    /// The ends, the best one first.
    pub led: Vec<Led>,
    /// What is left of the energies at the best end, and ln n for each clearance (Schwarz 1978).
    pub criterion: f64,
}

impl<'a> Sets<'a> {
    /// Of the joints of the machine `healthy`, with what else is unknown at `x`.
    pub fn new(healthy: &'a Problem, joints: &'a [Joint], x: &'a [f64]) -> Self {
        Self {
            healthy,
            joints,
            x,
            known: BTreeMap::new(),
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

    /// Joints that are ideal in the machine file.
    pub fn ideal(&self) -> Vec<usize> {
        let all = 0..self.joints.len();
        all.filter(|i| self.joints[*i].stated.is_none()).collect()
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
            let asked = (parts.len(), part.model.clear.clone());
            let led = match self.known.remove(&asked) {
                Some(led) => led,
                None => ends_of(&part.model, self.joints, &part.of_whole(&at), effort),
            };
            self.known.insert(asked, led.clone());
            ends.push(led);
        }
        let led = joined(&parts, &ends, &at);
        let count = Energies::loud(&few(&model.problem)).count() as f64;
        let left = led.first().map_or(f64::INFINITY, |led| led.left);
        Ok(Ends {
            criterion: left + model.clear.len() as f64 * count.ln(),
            model,
            led,
        })
    }
}

/// The ends of descents from the best of many points of a model, the best one first.
fn ends_of(model: &Model, joints: &[Joint], x: &[f64], effort: &mut Effort) -> Vec<Led> {
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
    effort.ends();
    drawn.sort_by(|a, b| a.left.total_cmp(&b.left));
    let starts: Vec<Vec<f64>> = drawn.into_iter().take(STARTS).map(|led| led.x).collect();
    let clearances = (0..model.clear.len()).map(|place| (place, CLEARANCE));
    let priors = model.priors.iter();
    let priors = priors.map(|prior| (prior.place, SPREADS * prior.spread));
    let widths: Vec<Width> = clearances.chain(priors).collect();
    effort.begins(Stage::Clearances);
    let led = descended(&compared, &starts, &widths, effort);
    effort.ends();
    led
}
