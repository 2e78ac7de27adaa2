//! The spring that an elastic rod is.

use super::motion::Motion;
use crate::effects::{HARDENED, RodSpring};
use crate::machine::Throw;
use scalar::Scalar;

impl<S: Scalar> RodSpring<S> {
    /// Moment of the spring and its damping on the stretch η, N m: −L² (k η (1 + q (η/η₀)²) + c η̇), with c so that
    /// the free rod has the damping ratio.
    #[inline(always)]
    pub(super) fn pull(&self, throw: &Throw<S>, motion: &Motion<S>) -> S {
        let length = throw.rod.length;
        let stretch = motion.stretch * (S::one() + self.hardening * hardened(motion.stretch));
        -(self.stiffness * length * length * stretch) - self.damping(throw) * motion.stretch_rate
    }

    /// Energy of the spring, J: L² k (η²/2 + q η⁴/(4 η₀²)).
    #[inline(always)]
    pub(crate) fn energy(&self, longer: S, stretch: S) -> S {
        let whole = self.stiffness * longer * longer * 0.5;
        whole * (S::one() + self.hardening * hardened(stretch) * 0.5)
    }

    /// Damping L² c of the stretch, N m s.
    #[inline(always)]
    pub(crate) fn damping(&self, throw: &Throw<S>) -> S {
        let critical = (self.stiffness * throw.rod.inertia).sqrt() * throw.rod.length * 2.0;
        self.damping_ratio * critical
    }
}

/// (η/η₀)².
#[inline(always)]
fn hardened<S: Scalar>(stretch: S) -> S {
    let share = stretch * (1.0 / HARDENED);
    share * share
}
