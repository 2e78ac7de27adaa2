//! What a model leaves, as a linear function of the coefficients of an empirical force.

use crate::amendment::candidate::Candidate;
use crate::error::Error;
use crate::force::stability_selection::Regression;
use calibrate::LOOSE;
use calibrate::Problem;
use calibrate::likelihood::Likelihood;
use calibrate::optimiser::LeastSquares;
use input::effects::Entry;
use nalgebra::DVector;
use std::f64::consts::PI;

/// Standard deviation of the missing force, as a share of the loads of gas and inertia.
const SHARE: f64 = 0.1;
/// A coefficient that is as good as 0, over its greatest value: without any the effect would be none.
const NOTHING: f64 = 1e-9;

/// The terms by their indices among the parameters of the effect, those together that one needs with
/// the other.
pub(crate) fn groups(entry: &Entry) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    let terms = entry.parameters.iter().enumerate();
    for (i, parameter) in terms.filter(|(_, p)| p.absent.is_some()) {
        match (parameter.key.starts_with("sin_"), groups.last_mut()) {
            (true, Some(cosine)) => cosine.push(i),
            _ => groups.push(vec![i]),
        }
    }
    groups
}

/// The residuals of a model and their derivatives by the terms of a force at one throw.
pub(crate) struct Linearised {
    /// As a regression on the terms, over their priors, without the force that the model has.
    pub regression: Regression,
    /// Standard deviation of each coefficient, N.
    pub prior: Vec<f64>,
    /// The coefficients there, N, among the values of the effect's parameters.
    pub values: Vec<f64>,
}

impl Linearised {
    /// At the coordinates `x` of `problem`, with a force of coefficients `values` (SI) added.
    ///
    /// # Errors
    /// A machine that cannot be simulated.
    pub fn at(
        problem: &Problem,
        x: &[f64],
        library: &Candidate,
        values: &[f64],
    ) -> Result<Self, Error> {
        let parameters = library.entry.parameters;
        let is_term = |i: usize| parameters[i].absent.is_some();
        let present = |i: usize| match values[i] == 0.0 && is_term(i) {
            true => NOTHING * parameters[i].bounds[1],
            false if is_term(i) => values[i],
            false => parameters[i].start,
        };
        let values: Vec<f64> = (0..values.len()).map(present).collect();
        let added = library.added(problem, &values)?;
        let mut there = x.to_vec();
        there.resize(added.parameters.len(), 0.0);
        let likelihood = Likelihood::coarse(&added, LOOSE);
        let mut target = DVector::from_vec(likelihood.residuals(&there));
        let jacobian = likelihood.jacobian(&there);
        let nuisance = jacobian.columns(0, x.len()).into_owned();
        let mut terms = jacobian
            .columns(x.len(), there.len() - x.len())
            .into_owned();
        let load = load(problem, x, library)?;
        let largest = parameters[0].bounds[1];
        let mut prior = Vec::new();
        let free = added.parameters[x.len()..].iter();
        for ((mut column, free), i) in terms
            .column_iter_mut()
            .zip(free)
            .zip((0..values.len()).filter(|i| is_term(*i)))
        {
            let deviation = SHARE * load * parameters[i].bounds[1] / largest;
            column *= deviation / (free.value(1.0) - free.value(0.0));
            target.axpy(-values[i] / deviation, &column, 1.0);
            prior.push(deviation);
        }
        Ok(Self {
            regression: Regression {
                nuisance,
                terms,
                target,
            },
            prior,
            values,
        })
    }

    /// The terms that change more than the noise within their priors.
    pub fn seen(&self) -> Vec<usize> {
        let columns = self.regression.terms.column_iter().enumerate();
        let seen = columns.filter(|(_, column)| column.norm_squared() > 1.0);
        seen.map(|(i, _)| i).collect()
    }

    /// The values of the effect's parameters with which a candidate that has few of its terms explains
    /// most, SI.
    pub fn fitted(&self, candidate: &Candidate) -> Vec<f64> {
        let terms: Vec<usize> = candidate.free().collect();
        let scaled = self.regression.fitted(&terms);
        let parameters = candidate.entry.parameters;
        let none = parameters.iter().map(|p| p.absent.unwrap_or(p.start));
        let mut values: Vec<f64> = none.collect();
        for (term, coefficient) in terms.iter().zip(scaled) {
            let [low, high] = parameters[*term].bounds;
            values[*term] = (coefficient * self.prior[*term]).clamp(low, high);
        }
        values
    }
}

/// The greatest load of gas and inertia on the crosshead, N.
fn load(problem: &Problem, x: &[f64], library: &Candidate) -> Result<f64, Error> {
    let mut greatest = 0.0_f64;
    for run in &problem.runs {
        let machine = problem.machine(run, x)?;
        for throw in &machine.machine.throws {
            if library.throw().is_some_and(|name| name != throw.name) {
                continue;
            }
            let gas = PI * throw.cylinder.piston_radius.powi(2) * throw.cylinder.discharge;
            let inertia = throw.crosshead.mass * throw.crank_radius * machine.speed.powi(2);
            greatest = greatest.max(gas + inertia);
        }
    }
    Ok(greatest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::problem;
    use input::effects::entry;

    #[test]
    fn near_a_law_its_term_is_chosen_and_no_other() {
        let entry = entry("empirical_force").unwrap();
        let groups = groups(entry);
        let library = Candidate {
            entry,
            place: Vec::new(),
            fixed: Vec::new(),
            each: Vec::new(),
            shared: false,
            formed: false,
        }
        .restricted(&groups.concat());
        let key = |i: usize| entry.parameters[i].key;
        let term = (0..entry.parameters.len()).find(|i| key(*i) == "velocity_sign");
        let term = term.unwrap();
        let mut values = vec![0.0; entry.parameters.len()];
        // Not quite the truth, and something beside it.
        values[term] = -146.0;
        values[1] = 3.0;
        let linear = Linearised::at(&problem(), &[0.02], &library, &values).unwrap();
        let stable = linear.regression.stable(&groups);
        let keys: Vec<&str> = stable.iter().map(|g| key(groups[*g][0])).collect();
        assert_eq!(keys, ["velocity_sign"]);
        let law = library.restricted(&[term]);
        let found = linear.fitted(&law)[term];
        assert!((found + 150.0).abs() < 5.0, "{found}");
        // With ideal joints the big end has no offset.
        let seen: Vec<&str> = linear.seen().into_iter().map(key).collect();
        assert!(seen.contains(&"cos_1") && !seen.contains(&"big_end_offset"));
    }
}
