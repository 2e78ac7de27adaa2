//! Which candidates are worth a fit: a score test at finite amplitudes.
//!
//! An amendment changes the predicted features by Δ. What the calibrated parameters could imitate of
//! it, and of the residual r, is projected out (P, with a prior of one unit of their coordinates).
//! The score is the share of the residual that the rest explains at its best amplitude:
//!
//! ```text
//! 1 − min_a |P (r + a Δ)|² / |P r|²
//! ```
//!
//! (Rao 1948; finite amplitudes because the linear test misses effects that saturate.) A wave has a phase as well: it is the
//! best sum of its two quadratures.

use crate::amendment::Amendment;
use crate::error::Error;
use crate::fitter::journal::Finished;
use crate::fitter::{Fitter, Start};
use crate::model::Model;
use crate::recorded::is_of_pressures;
use crate::search::hypothesis::start;
use crate::search::projector::Projector;
use calibrate::Problem;
use calibrate::energies::Energies;
use calibrate::likelihood::Likelihood;
use calibrate::optimiser::LeastSquares;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// A probe is not scaled by more than this: further away the change is another one.
const SCALED: f64 = 2.0;
/// Forms of a law that are fitted, the most promising ones: which of two is right is known once they are.
pub(crate) const FORMS: usize = 2;
/// What is added to the squares of changes that may be alike, over the greatest.
const RIDGE: f64 = 1e-6;

/// An amendment that may explain a part of the residual.
#[derive(Clone, Debug)]
pub(crate) struct Screened {
    /// The amendment.
    pub amendment: Amendment,
    /// Where a fit may start.
    pub starts: Vec<Point>,
}

/// A point to start from: the machine as it was fitted with an amendment, or the nominal one.
#[derive(Clone, Debug)]
pub(crate) struct Point {
    /// Coordinates of the machine without the amendment.
    pub x: Vec<f64>,
    /// Where the amendment is tried.
    pub values: Vec<f64>,
}

/// A point at which candidates are looked at, and what is left there.
struct Base<'a> {
    x: Vec<f64>,
    /// What is compared, but for pressures alone.
    energies: Option<Energies<'a>>,
    residual: DVector<f64>,
    projector: Projector,
    left: DVector<f64>,
}

impl<'a> Base<'a> {
    fn at(problem: &'a Problem, x: &[f64]) -> Self {
        let energies = (!is_of_pressures(problem)).then(|| Energies::new(problem));
        let (residual, jacobian) = match &energies {
            Some(energies) => (energies.residuals(x), energies.jacobian(x)),
            None => {
                let lines = Likelihood::new(problem);
                (lines.residuals(x), lines.jacobian(x))
            }
        };
        let (residual, projector) = (DVector::from_vec(residual), Projector::new(&jacobian));
        Self {
            x: x.to_vec(),
            energies,
            left: projector.apply(&residual),
            residual,
            projector,
        }
    }

    /// The residuals of other machines: of the lines of pressures alone, of energies elsewhere.
    fn residuals_of(&self, machines: &[Start]) -> Vec<Vec<f64>> {
        let lines = |(problem, x): &Start| Likelihood::new(problem).residuals(x);
        match &self.energies {
            Some(energies) => energies.residuals_of_machines(machines),
            None => machines.iter().map(lines).collect(),
        }
    }

    /// What a probe that has these residuals changes that the calibrated parameters cannot.
    fn change(&self, there: Vec<f64>) -> DVector<f64> {
        self.projector
            .apply(&(DVector::from_vec(there) - &self.residual))
    }

    /// The score of a change; none where nothing changes.
    fn score(&self, change: &DVector<f64>) -> Option<f64> {
        let size = change.norm_squared();
        (size > 0.0).then(|| {
            let share = (-self.left.dot(change) / size).clamp(0.0, SCALED);
            let left = (&self.left + share * change).norm_squared();
            1.0 - left / self.left.norm_squared()
        })
    }

    /// The shares of these changes that leave the least together.
    fn shares(&self, changes: &[DVector<f64>]) -> Option<Vec<f64>> {
        let all = DMatrix::from_columns(changes);
        let mut normal = all.tr_mul(&all);
        let little = RIDGE * normal.diagonal().max();
        for i in 0..changes.len() {
            normal[(i, i)] += little;
        }
        let shares = normal.cholesky()?.solve(&-all.tr_mul(&self.left));
        Some(shares.as_slice().to_vec())
    }
}

/// The amendments, the most promising first. Those that cannot be simulated are left out. They are
/// looked at where the machine is fitted; a machine to which nothing was added (`alone`) also where it is nominal: without
/// what is missing a fit may have gone far astray.
///
/// # Errors
/// [`Error::Stopped`].
pub(crate) fn screen(
    fitter: &Fitter,
    model: &Model,
    alone: bool,
    amendments: Vec<Amendment>,
) -> Result<Vec<Screened>, Error> {
    let nominal = vec![0.0; model.x.len()];
    let mut bases = vec![Base::at(&model.problem, &model.x)];
    if alone && nominal != model.x {
        bases.push(Base::at(&model.problem, &nominal));
    }
    // The best score and probe of each form, one after another; nothing for what cannot be simulated.
    let best = |amendment: &Amendment, base: &Base| -> Result<Finished, Error> {
        let mut best: Vec<(f64, Vec<f64>)> = Vec::new();
        let metered = model.problem.metered();
        let mut tried = |probes: Vec<Vec<f64>>| -> Result<Vec<DVector<f64>>, Error> {
            if (fitter.watch)().is_break() {
                return Err(Error::Stopped);
            }
            let machines = probes.into_iter().filter_map(|probe| {
                let machine = start(&metered, &base.x, amendment, &probe)?;
                Some((machine, probe))
            });
            let (machines, probes): (Vec<Start>, Vec<Vec<f64>>) = machines.unzip();
            let residuals = base.residuals_of(&machines).into_iter();
            let changes: Vec<_> = residuals.map(|there| base.change(there)).collect();
            for (probe, change) in probes.into_iter().zip(&changes) {
                if let Some(score) = base.score(change) {
                    best.push((score, probe));
                }
            }
            Ok(changes)
        };
        tried(amendment.probes(&model.problem)?)?;
        let quadratures = amendment.quadratures();
        let count = quadratures.len();
        let changes = tried(quadratures)?;
        if count > 0
            && changes.len() == count
            && let Some(shares) = base.shares(&changes)
        {
            tried(amendment.combinations(&shares))?;
        }
        let mut best = best_of_each_form(best, amendment);
        // Descents of pressures by themselves cost little, and say more than scores.
        if !is_of_pressures(&model.problem) {
            best.truncate(FORMS);
        }
        let best = best.into_iter();
        let numbers = best.flat_map(|(score, probe)| [vec![score], probe].concat());
        Ok(Finished {
            numbers: numbers.collect(),
            cost: metered.meter.steps(),
        })
    };
    let screened = amendments.into_par_iter().map(|amendment| {
        let (mut scores, mut starts) = (Vec::new(), Vec::new());
        for base in &bases {
            let input = ("screen", &model.problem, &base.x, amendment.label());
            let found = fitter
                .effort
                .journal
                .once(&input, || best(&amendment, base))?;
            scores.push(found.first().copied().unwrap_or(f64::NEG_INFINITY));
            let probes = found.chunks_exact(1 + amendment.count());
            starts.extend(probes.map(|probe| Point {
                x: base.x.clone(),
                values: probe[1..].to_vec(),
            }));
        }
        let screened = Screened { amendment, starts };
        Ok((!screened.starts.is_empty()).then_some((screened, scores)))
    });
    let screened = screened.collect::<Result<Vec<_>, Error>>()?;
    let all: Vec<(Screened, Vec<f64>)> = screened.into_iter().flatten().collect();
    Ok(ordered(all))
}

/// The best probe of each form of a law, the best first.
fn best_of_each_form(
    mut probes: Vec<(f64, Vec<f64>)>,
    amendment: &Amendment,
) -> Vec<(f64, Vec<f64>)> {
    probes.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut forms: Vec<Vec<f64>> = Vec::new();
    probes.retain(|(_, probe)| {
        let form = amendment.form_at(probe);
        let is_new = !forms.contains(&form);
        forms.push(form);
        is_new
    });
    probes
}

/// The most promising first: by the place that each has at the point where it has the best one. Shares at different
/// points cannot be compared.
fn ordered<T>(scored: Vec<(T, Vec<f64>)>) -> Vec<T> {
    let place = |scores: &[f64]| {
        let at = |(point, score): (usize, &f64)| {
            scored
                .iter()
                .filter(|(_, other)| other[point] > *score)
                .count()
        };
        scores
            .iter()
            .enumerate()
            .map(at)
            .min()
            .unwrap_or(usize::MAX)
    };
    let places: Vec<usize> = scored.iter().map(|(_, scores)| place(scores)).collect();
    let mut order: Vec<(usize, T)> = places
        .into_iter()
        .zip(scored.into_iter().map(|(it, _)| it))
        .collect();
    order.sort_by_key(|(place, _)| *place);
    order.into_iter().map(|(_, it)| it).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::problem;

    #[test]
    fn the_best_probe_of_each_form_is_left() {
        let all = Amendment::all(&problem()).unwrap();
        let with_forms = |one: &&Amendment| {
            let effect = one.effect();
            effect.is_some_and(|it| it.other_forms_of(&it.usual()).len() > 1)
        };
        let amendment = all.iter().find(with_forms).unwrap();
        let effect = amendment.effect().unwrap();
        let usual = effect.usual();
        let other = effect.other_forms_of(&usual);
        let scored = vec![
            (0.2, other[0].clone()),
            (0.3, usual.clone()),
            (0.1, other[1].clone()),
            (0.4, other[0].clone()),
        ];
        let best = best_of_each_form(scored, amendment);
        let expected = [
            (0.4, other[0].clone()),
            (0.3, usual),
            (0.1, other[1].clone()),
        ];
        assert_eq!(best, expected);
    }

    /// Twelve machines, more than fill a register, whose effects differ: some are of the gas, some of the joints.
    #[test]
    fn probes_side_by_side_leave_what_each_leaves_by_itself() {
        let problem = problem();
        let all = Amendment::all(&problem).unwrap();
        let kinds = [
            "ring_leakage",
            "ring_friction",
            "misalignment",
            "squeeze_film",
        ];
        let effects = kinds.map(|kind| {
            let one = all.iter().find(|one| one.kind() == kind).unwrap();
            one.clone()
        });
        let machines: Vec<Start> = [0.0, 0.1, -0.2]
            .iter()
            .flat_map(|x| effects.iter().map(move |effect| (x, effect)))
            .map(|(x, effect)| {
                let usual = effect.effect().unwrap().usual();
                start(&problem, &[*x], effect, &usual).unwrap()
            })
            .collect();
        let together = Energies::new(&problem).residuals_of_machines(&machines);
        let alone = machines
            .iter()
            .map(|(machine, x)| Energies::new(machine).residuals(x));
        assert_eq!(together, alone.collect::<Vec<_>>());
    }

    #[test]
    fn the_best_of_each_point_come_first() {
        let scored = vec![
            ("only where it is calibrated", vec![0.09, 0.1]),
            ("worth nothing there", vec![0.0, 0.5]),
            ("a little", vec![0.01, 0.3]),
            ("nowhere", vec![f64::NEG_INFINITY, 0.2]),
        ];
        let expected = [
            "only where it is calibrated",
            "worth nothing there",
            "a little",
            "nowhere",
        ];
        assert_eq!(ordered(scored), expected);
    }
}
