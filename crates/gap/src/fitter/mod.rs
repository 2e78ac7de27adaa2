//! Fits a machine to its recordings, from what is slow in them to what is fast.
//!
//! The ringing of the contacts has many local minima, its low orders and its energies have few. A descent therefore
//! compares those first, then lines that may stand elsewhere in the revolution, with less and less of that. No law of
//! the catalogue is quite a machine's: where a descent allows less than the law is off by, the likelihood falls again.
//! The allowance with which it is greatest is the size of the model's discrepancy (Kennedy and O'Hagan 2001).

pub(crate) mod conditions;
pub mod effort;
pub mod journal;

use crate::criteria::NOISE;
use crate::error::{Error, possible};
use crate::fitter::conditions::{conditions_of, most_different, of_one_clearance};
use crate::fitter::effort::{Effort, FIRST_SEARCH, MOST_OF_A_DESCENT};
use crate::fitter::journal::Finished;
use crate::model::Model;
use crate::recorded::is_of_pressures;
use calibrate::Problem;
use calibrate::energies::Energies;
use calibrate::fit::{Estimate, Fit, FitSettings, Optimiser};
use calibrate::likelihood::Likelihood;
use calibrate::observation::Observation;
use calibrate::optimiser::{LeastSquares, Progress, levenberg_marquardt};
use calibrate::secant::secant;
use calibrate::sizes::Sizes;
use rayon::prelude::*;
use std::ops::ControlFlow;

/// The stages of a descent: for every start, and for those that have led near.
const ROUGH: [Stage; 3] = [
    Stage::Energies(12),
    Stage::Lines(0.01, 8),
    Stage::Lines(0.003, 10),
];
const FINE: [Stage; 4] = [
    Stage::Lines(0.01, 25),
    Stage::Lines(0.003, 25),
    Stage::Lines(0.001, 25),
    Stage::Lines(0.0, 40),
];
/// The same for pressures alone, which do not ring: nothing in them is in the way of a descent, and where their valves work
/// counts from the start.
const ROUGH_OF_GAS: [Stage; 1] = [Stage::Lines(0.0, 12)];
const FINE_OF_GAS: [Stage; 1] = [Stage::Lines(0.0, 30)];
/// Allowance that a descent with lines begins with at least, rad.
const LEAST: f64 = 0.001;
/// Sizes of the discrepancy that a model may have, rad: of timing, and of pressures alone none.
const TIMINGS: [f64; 6] = [0.03, 0.01, 0.003, 0.001, 0.0003, 0.0];
/// Relative change of the sum of squares at which a descent ends.
const CHANGE: f64 = 1e-2;
/// The same of the last fit of what is believed.
const LAST: f64 = 1e-4;
/// Evaluations that it may take.
const MOST_OF_LAST: u64 = 300;
/// Runs that candidates are compared with.
const FEW: usize = 3;

/// What a stage of a descent compares, and the evaluations that it may take.
#[derive(Clone, Copy, Debug)]
enum Stage {
    /// Energies by band and sector.
    Energies(u64),
    /// Lines that may stand elsewhere by so much, rad.
    Lines(f64, u64),
}

/// Asked between evaluations whether to go on.
pub type Watch<'a> = &'a (dyn Fn() -> ControlFlow<()> + Sync);

/// A point from which a descent may start: a problem and coordinates of its parameters.
pub(crate) type Start = (Problem, Vec<f64>);

/// A problem in a few of its runs.
pub(crate) struct Few {
    /// Of one clearance, and of speeds as different as there are. Another clearance is another kind of motion, with minima of its
    /// own: descents begin without it.
    pub alike: Problem,
    /// As different as there are: effects differ by how they grow with speed, load and clearance, so that sets are compared with these.
    pub different: Problem,
}

/// Fits models.
#[derive(Clone, Copy)]
pub(crate) struct Fitter<'a> {
    pub effort: &'a Effort,
    pub watch: Watch<'a>,
    /// Told what is being done, and the misfit so far.
    pub say: &'a (dyn Fn(&str, f64) + Sync),
}

impl Fitter<'_> {
    /// The best model that descents from these points lead to, and the index of its start; none where no machine
    /// there can be simulated.
    ///
    /// # Errors
    /// [`Error::Stopped`].
    pub fn explored(&self, starts: &[Start]) -> Result<Option<(Model, usize)>, Error> {
        let Some(rough) = self.roughly(starts)? else {
            return Ok(None);
        };
        let model = self.settled(&(starts[rough.start].0.clone(), rough.x))?;
        Ok(model.map(|model| (model, rough.start)))
    }

    /// Where short descents from these points lead, the best of them. After each stage half of them go on.
    ///
    /// # Errors
    /// [`Error::Stopped`].
    pub fn roughly(&self, starts: &[Start]) -> Result<Option<Rough>, Error> {
        let mut led: Vec<Rough> = starts
            .iter()
            .enumerate()
            .map(|(start, (_, x))| Rough::at(start, x))
            .collect();
        let of_gas = starts
            .first()
            .is_some_and(|(problem, _)| is_of_pressures(problem));
        let stages: &[Stage] = if of_gas { &ROUGH_OF_GAS } else { &ROUGH };
        for stage in stages {
            let next = led.into_par_iter().map(|mut rough| {
                let problem = &starts[rough.start].0;
                let descent = self.descended(problem, &rough.end, &[*stage])?;
                Ok(descent.map(|descent| {
                    rough.take(descent);
                    rough
                }))
            });
            let next = next.collect::<Result<Vec<_>, Error>>()?;
            led = next.into_iter().flatten().collect();
            led.sort_by(|a, b| a.last.total_cmp(&b.last));
            led.truncate(led.len().div_ceil(2));
        }
        Ok(led.into_iter().next())
    }

    /// The model with all its fitted runs, continued from where a few of them have led.
    pub fn settled(&self, start: &Start) -> Result<Option<Model>, Error> {
        self.settled_from(start, f64::INFINITY)
    }

    /// The same from where no more than this allowance was needed, rad: more would lead away again.
    pub fn settled_from(&self, start: &Start, timing: f64) -> Result<Option<Model>, Error> {
        let (problem, x) = start;
        let stages: Vec<Stage> = match is_of_pressures(problem) {
            true => FINE_OF_GAS.to_vec(),
            false => {
                let allowed = |stage: &&Stage| match stage {
                    Stage::Lines(allowed, _) => *allowed <= timing.max(LEAST),
                    Stage::Energies(_) => true,
                };
                FINE.iter().filter(allowed).copied().collect()
            }
        };
        let fine = self.descended(problem, x, &stages)?;
        match fine {
            None => Ok(None),
            Some(fine) => possible(Model::at(
                problem.clone(),
                &fine.x,
                fine.timing,
                self.effort,
            )),
        }
    }

    /// A descent with one allowance after another; none where it ends at a machine that cannot be simulated.
    fn descended(
        &self,
        problem: &Problem,
        x: &[f64],
        stages: &[Stage],
    ) -> Result<Option<Descent>, Error> {
        let fitted = problem.with_runs(|run| self.effort.fits(&run.id)).metered();
        if fitted.parameters.is_empty() {
            return Ok(Some(Descent::nowhere()));
        }
        let input = ("descent", &fitted, x, stages);
        let numbers = self.effort.journal.once(&input, || {
            let mut descent = Descent::nowhere();
            descent.end = x.to_vec();
            for stage in stages {
                let within = || ((self.watch)(), fitted.meter.steps() < MOST_OF_A_DESCENT);
                let led = match stage {
                    Stage::Energies(evaluations) => {
                        let energies = Energies::new(&fitted);
                        let led = descend(&energies, &fitted, &descent.end, *evaluations, &within);
                        led.map(|led| (energies.squares(&led.x).map(|left| (None, left)), led.x))
                    }
                    Stage::Lines(timing, evaluations) => {
                        let likelihood = Likelihood::coarse(&fitted, *timing);
                        let led =
                            descend(&likelihood, &fitted, &descent.end, *evaluations, &within);
                        led.map(|led| {
                            let likeliest = likelihood.likeliest(&led.x, timings(&fitted));
                            (likeliest.map(|(timing, d)| (Some(timing), d)), led.x)
                        })
                    }
                };
                let (timing, left) = match led {
                    Ok((Ok(measure), x)) => {
                        descent.end = x;
                        measure
                    }
                    Ok((Err(_), _)) | Err(Error::Fit(_)) => break,
                    Err(error) => return Err(error),
                };
                descent.last = left;
                if let Some(timing) = timing {
                    descent.note(timing, left);
                }
            }
            Ok(Finished {
                numbers: descent.numbers(),
                cost: fitted.meter.steps(),
            })
        })?;
        Ok(Descent::read(&numbers))
    }

    /// The problem's machine, calibrated as well as it can be with so many evaluations.
    pub fn searched(
        &self,
        problem: &Problem,
        start: &[f64],
        evaluations: u64,
    ) -> Result<Vec<f64>, Error> {
        let settings = FitSettings {
            optimiser: Optimiser::Default,
            seed: 0,
            evaluations,
            held_out: self.effort.held_out.clone(),
            start: Some(start.to_vec()),
        };
        let metered = problem.metered();
        let watch = |_: &_| match metered.meter.steps() < FIRST_SEARCH {
            true => (self.watch)(),
            false => ControlFlow::Break(()),
        };
        let search = || {
            let fit = calibrate::calibrate(&metered, &settings, watch)?;
            if !fit.complete && (self.watch)().is_break() {
                return Err(Error::Stopped);
            }
            let coordinate = |e: &Estimate| e.parameter.coordinate(e.value);
            Ok(Finished {
                numbers: fit.estimates.iter().map(coordinate).collect(),
                cost: metered.meter.steps(),
            })
        };
        self.effort
            .journal
            .once(&("search", problem, &settings), search)
    }

    /// The model where a longer fit to its lines ends, with the allowance that it needs there; none where it leaves no more than noise
    /// already, or no machine there can be simulated.
    ///
    /// # Errors
    /// [`Error::Stopped`].
    pub fn finished(&self, model: &Model) -> Result<Option<Model>, Error> {
        if model.problem.parameters.is_empty() || Self::is_at_noise(model) {
            return Ok(None);
        }
        let fitted = model.problem.with_runs(|run| self.effort.fits(&run.id));
        let fitted = fitted.metered();
        let lines = Likelihood::new(&fitted);
        let x = self
            .effort
            .journal
            .once(&("finished", &fitted, &model.x), || {
                let found = levenberg_marquardt(&lines, &model.x, LAST, MOST_OF_LAST, &mut |_| {
                    (self.watch)()
                })?;
                if (self.watch)().is_break() {
                    return Err(Error::Stopped);
                }
                Ok(Finished {
                    numbers: found.x,
                    cost: fitted.meter.steps(),
                })
            });
        let Some(x) = possible(x)? else {
            return Ok(None);
        };
        let likeliest = lines.likeliest(&x, timings(&fitted)).map_err(Error::from);
        let Some((timing, _)) = possible(likeliest)? else {
            return Ok(None);
        };
        possible(Model::at(model.problem.clone(), &x, timing, self.effort))
    }

    /// The parameters of a model with their bounds.
    pub fn bounds(&self, model: &Model) -> Result<Fit, Error> {
        let settings = FitSettings {
            optimiser: Optimiser::LevenbergMarquardt,
            seed: 0,
            evaluations: self.effort.evaluations,
            held_out: self.effort.held_out.clone(),
            start: Some(model.x.clone()),
        };
        let fit = calibrate::calibrate(&model.problem, &settings, |_| (self.watch)())?;
        Ok(fit)
    }

    /// The problem with a few of the runs that are fitted to.
    ///
    /// # Errors
    /// An invalid machine.
    pub fn few(&self, problem: &Problem) -> Result<Few, Error> {
        let runs = problem.runs.iter();
        let mut runs: Vec<_> = runs.filter(|run| self.effort.fits(&run.id)).collect();
        runs.sort_by(|a, b| a.crank.speed.total_cmp(&b.crank.speed));
        let nominal = vec![0.0; problem.parameters.len()];
        let conditions = runs.iter().map(|run| conditions_of(problem, run, &nominal));
        let conditions = conditions.collect::<Result<Vec<_>, _>>()?;
        let with = |chosen: Vec<usize>| {
            let chosen: Vec<&str> = chosen.into_iter().map(|i| runs[i].id.as_str()).collect();
            problem.with_runs(|run: &Observation| chosen.contains(&run.id.as_str()))
        };
        let alike = of_one_clearance(&conditions);
        let spread = |i| alike.get(i * alike.len().saturating_sub(1) / (FEW - 1));
        Ok(Few {
            alike: with((0..FEW).filter_map(spread).copied().collect()),
            different: with(most_different(&conditions, FEW)),
        })
    }

    /// Whether a model fits the recordings within their noise.
    pub fn is_at_noise(model: &Model) -> bool {
        model.fitted <= NOISE
    }
}

/// The sizes that the discrepancy of a problem's model may have, rad.
fn timings(problem: &Problem) -> &'static [f64] {
    match is_of_pressures(problem) {
        true => &[0.0],
        false => &TIMINGS,
    }
}

/// Where a short descent has led.
pub(crate) struct Rough {
    /// The index of its start.
    pub start: usize,
    /// Coordinates.
    pub x: Vec<f64>,
    /// Twice the negative logarithm of the likelihood there.
    pub deviance: f64,
    /// Where the last descent ended, and what was left there.
    end: Vec<f64>,
    last: f64,
}

impl Rough {
    fn at(start: usize, x: &[f64]) -> Self {
        Self {
            start,
            x: x.to_vec(),
            deviance: f64::INFINITY,
            end: x.to_vec(),
            last: f64::INFINITY,
        }
    }

    /// Goes on to where a stage has ended.
    fn take(&mut self, descent: Descent) {
        if descent.least < self.deviance {
            (self.x, self.deviance) = (descent.x, descent.least);
        }
        (self.end, self.last) = (descent.end, descent.last);
    }
}

/// Where a descent has led.
struct Descent {
    /// Where it ended, and the deviance there with the last allowance.
    end: Vec<f64>,
    last: f64,
    /// Where the likelihood was greatest, the allowance there, and the deviance.
    x: Vec<f64>,
    timing: f64,
    least: f64,
}

impl Descent {
    fn nowhere() -> Self {
        Self {
            end: Vec::new(),
            last: f64::INFINITY,
            x: Vec::new(),
            timing: 0.0,
            least: f64::INFINITY,
        }
    }

    /// Takes note of where a descent with this allowance ended, if the recordings are likelier so.
    fn note(&mut self, timing: f64, deviance: f64) {
        if deviance < self.least {
            self.x.clone_from(&self.end);
            (self.timing, self.least) = (timing, deviance);
        }
    }

    fn numbers(&self) -> Vec<f64> {
        match self.last.is_finite() {
            true => [
                &[self.last, self.timing, self.least][..],
                &self.end,
                if self.x.is_empty() {
                    &self.end
                } else {
                    &self.x
                },
            ]
            .concat(),
            false => Vec::new(),
        }
    }

    fn read(numbers: &[f64]) -> Option<Self> {
        let [last, timing, least, points @ ..] = numbers else {
            return None;
        };
        let (end, x) = points.split_at(points.len() / 2);
        Some(Self {
            end: end.to_vec(),
            last: *last,
            x: x.to_vec(),
            timing: *timing,
            least: *least,
        })
    }
}

/// A descent of what is `compared` of a problem. `watch` decides whether to go on, and whether there are steps left for that.
fn descend(
    compared: &impl LeastSquares,
    problem: &Problem,
    start: &[f64],
    evaluations: u64,
    watch: &dyn Fn() -> (ControlFlow<()>, bool),
) -> Result<Progress, Error> {
    let mut stopped = false;
    let sizes = Sizes::new(compared, &problem.parameters);
    let start = sizes.from_own(start).into_iter().zip(sizes.bounds());
    let start: Vec<f64> = start.map(|(z, [low, high])| z.clamp(low, high)).collect();
    let mut found = secant(&sizes, &start, CHANGE, evaluations, &mut |_| {
        let (answer, affordable) = watch();
        stopped |= answer.is_break();
        match affordable {
            true => answer,
            false => ControlFlow::Break(()),
        }
    });
    found.x = sizes.to_own(&found.x);
    if stopped {
        Err(Error::Stopped)
    } else {
        Ok(found)
    }
}
