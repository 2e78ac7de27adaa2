//! Which runs are fitted to, and what an explanation may cost: one budget.

use crate::error::Error;
use crate::journal::Journal;
use calibrate::Problem;
use calibrate::likelihood::Likelihood;

/// What an explanation may cost before nothing new is begun, in steps of the integrator for each
/// throw. A step of two joints takes some 7 µs.
const BUDGET: u64 = 24_000_000;
/// By how much more it may cost for each effect that was found, so that what is left has its chance too.
const FOR_ANOTHER: u64 = BUDGET * 3 / 4;
/// By how much more where another effect is looked for beside wear.
const BESIDE_WEAR: u64 = BUDGET / 2;
/// And by how much more before the search of a force of no name goes into its second and third attempts.
const FOR_FORCE: u64 = BUDGET / 2;
/// The most for a search from the nominal machine.
pub(crate) const FIRST_SEARCH: u64 = BUDGET / 2;
/// The most for a search that continues from another.
pub(crate) const SEARCH: u64 = BUDGET / 4;

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
    /// Effects that were found in this explanation.
    pub found: usize,
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
            found: 0,
        })
    }

    /// The same where so many effects were found.
    pub(crate) fn having(&self, found: usize) -> Self {
        Self {
            found,
            ..self.clone()
        }
    }

    /// Whether there is still something left of the budget.
    pub(crate) fn goes_on(&self) -> bool {
        self.journal.spent() < self.budget()
    }

    /// The same for the search of another effect beside wear.
    pub(crate) fn goes_on_beside_wear(&self) -> bool {
        self.journal.spent() < self.budget() + BESIDE_WEAR
    }

    /// The same for the search of a force of no name.
    pub(crate) fn goes_on_for_force(&self) -> bool {
        self.journal.spent() < self.budget() + FOR_FORCE
    }

    fn budget(&self) -> u64 {
        BUDGET + self.found as u64 * FOR_ANOTHER
    }

    /// Whether a run is fitted to.
    pub(crate) fn fits(&self, run: &str) -> bool {
        !self.held_out.iter().any(|held| held == run)
    }
}
