//! What is integrated.

use scalar::{Dual, Scalar};

/// A scalar with one plain value: what step control and event location look at.
pub trait Real: Scalar<Mask = bool, Plain = f64> {
    /// The plain value.
    fn value(self) -> f64 {
        self.plain()
    }
    /// Whether numbers of this kind can carry derivatives.
    const DERIVATIVES: bool;
    /// True where the number carries a derivative other than 0.
    fn varies(self) -> bool;
}

impl Real for f64 {
    const DERIVATIVES: bool = false;
    fn varies(self) -> bool {
        false
    }
}

impl<const N: usize> Real for Dual<f64, N> {
    const DERIVATIVES: bool = true;
    fn varies(self) -> bool {
        self.tangent.iter().any(|t| *t != 0.0)
    }
}

/// A differential equation `y' = f(t, y)` with modes.
pub trait System<S> {
    /// Length of `y`.
    fn dimension(&self) -> usize;

    /// Writes `f(t, y)` in the present mode into `dy`. The integrator calls it within
    /// [`Scalar::vectorised`], so that what is inlined into it gains by the processor's instructions.
    fn derivative(&mut self, t: S, y: &[S], dy: &mut [S]);

    /// Size of each component that counts as 1 for the tolerance; infinite for components whose
    /// error does not steer the step.
    fn scales(&self) -> &[S];

    /// How many guards there are, in every mode.
    fn guard_count(&self) -> usize {
        0
    }

    /// Writes the guards at `(t, y)`: positive while the present mode holds. A guard that the
    /// present mode does not have is 1.
    fn guards(&mut self, _t: S, _y: &[S], _guards: &mut [S]) {}

    /// Writes the guards where the derivative was evaluated last, if the system knows them there.
    fn guards_here(&mut self, _guards: &mut [S]) -> bool {
        self.guard_count() == 0
    }

    /// Changes the mode (and, for rigid impacts, the state) as guard number `guard` demands.
    fn switch(&mut self, _guard: usize, _t: S, _y: &mut [S]) {}
}
