//! Which runs are fitted to, and what an explanation may cost: one budget.

use crate::error::Error;
use crate::fitter::journal::Journal;
use calibrate::Problem;
use calibrate::likelihood::Likelihood;

/// What an explanation may cost before nothing new is begun, in steps of the integrator for each
/// throw: at most ten minutes on two cores, as a step of two joints takes 2 to 4 µs.
const BUDGET: u64 = 300_000_000;
/// The most for a calibration.
pub(crate) const FIRST_SEARCH: u64 = BUDGET / 48;
/// What a round of searches far away costs together.
pub(crate) const FAR_ROUND: u64 = BUDGET / 15;
/// The most for a descent.
pub(crate) const MOST_OF_A_DESCENT: u64 = BUDGET / 48;

/// Which runs a model is fitted to, and how long it may take.
#[derive(Clone, Debug)]
pub struct Effort {
    /// Runs that are predicted only.
    pub held_out: Vec<String>,
    /// Most evaluations of a descent.
    pub evaluations: u64,
    /// Whether no run that is fitted to repeats itself: then many revolutions of each are compared.
    pub chaotic: bool,
    /// What was found before.
    pub journal: Journal,
}

impl Effort {
    /// The effort for a problem of which these runs are held out. So are those in which the recording or
    /// the nominal machine does not repeat itself, if others are left: there are no derivatives.
    ///
    /// # Errors
    /// A machine that cannot be simulated.
    pub fn new(
        problem: &Problem,
        mut held_out: Vec<String>,
        evaluations: u64,
        journal: Journal,
    ) -> Result<Self, Error> {
        let nominal = vec![0.0; problem.parameters.len()];
        let predictions = Likelihood::new(problem).predictions(&nominal)?;
        let runs = problem.runs.iter().zip(&predictions);
        let (periodic, others): (Vec<_>, Vec<_>) =
            runs.partition(|(run, shown)| shown.periodic && run.repeats_like(&problem.runs));
        let chaotic = !periodic.iter().any(|(run, _)| !held_out.contains(&run.id));
        if !chaotic {
            for (run, _) in others {
                if !held_out.contains(&run.id) {
                    held_out.push(run.id.clone());
                }
            }
        }
        Ok(Self {
            held_out,
            evaluations,
            chaotic,
            journal,
        })
    }

    /// Whether there is still something left of the budget.
    pub(crate) fn goes_on(&self) -> bool {
        self.journal.spent() < BUDGET
    }

    /// Whether a run is fitted to.
    pub(crate) fn fits(&self, run: &str) -> bool {
        !self.held_out.iter().any(|held| held == run)
    }
}
