//! The spring that an elastic rod is.

use super::motion::Motion;
use crate::effects::RodSpring;
use crate::machine::Throw;
use scalar::Scalar;

impl<S: Scalar> RodSpring<S> {
    /// Moment of the spring and its damping on the stretch η, N m: −L² (k η + c η̇), with c so that
    /// the free rod has the damping ratio.
    #[inline(always)]
    pub(super) fn pull(&self, throw: &Throw<S>, motion: &Motion<S>) -> S {
        let length = throw.rod.length;
        -(self.stiffness * length * length * motion.stretch)
            - self.damping(throw) * motion.stretch_rate
    }

    /// Damping L² c of the stretch, N m s.
    #[inline(always)]
    pub(crate) fn damping(&self, throw: &Throw<S>) -> S {
        let critical = (self.stiffness * throw.rod.inertia).sqrt() * throw.rod.length * 2.0;
        self.damping_ratio * critical
    }
}
