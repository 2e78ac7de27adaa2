//! The machine in motion, written once for every scalar.

mod equations;
mod start;

use crate::energy::{self, Energy, Powers};
use crate::evaluation::Evaluation;
use crate::joints::revolute::{JointState, Revolute};
use crate::machine::Machine;
use crate::mode::Mode;
use crate::state::Layout;
use crate::throw::Response;
use crate::watch::{Place, Watch};
use scalar::Scalar;

/// A machine in motion: parameters, mode, and what the last evaluation found.
#[derive(Clone, Debug)]
pub struct Dynamics<S> {
    pub(crate) machine: Machine<S>,
    layout: Layout,
    pub(crate) mode: Mode<S>,
    scales: Vec<S>,
    watches: Vec<Watch>,
    evaluation: Evaluation<S>,
    /// The throws' eliminated joints.
    responses: Vec<Response<S>>,
    /// Whether the machine is plain.
    plain: bool,
    /// Whether a force at an end of a rod follows from accelerations.
    rigid: bool,
    /// Whether the crank pins' accelerations are more than their bias: not at constant speed in an ideal
    /// main bearing.
    pins_give: bool,
}

impl<S: Scalar> Dynamics<S> {
    /// The machine.
    pub fn machine(&self) -> &Machine<S> {
        &self.machine
    }

    /// What the state vector holds.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// The present mode.
    pub fn mode(&self) -> &Mode<S> {
        &self.mode
    }

    /// The present mode, to be changed: a caller that steps lanes puts each lane into its own.
    pub fn mode_mut(&mut self) -> &mut Mode<S> {
        &mut self.mode
    }

    /// Puts the machine into a mode of a plain one of its build.
    pub fn set_mode(&mut self, mode: &Mode) {
        self.mode.each(mode, |number, of| *number = S::constant(of));
    }

    pub(crate) fn watches(&self) -> &[Watch] {
        &self.watches
    }

    pub(crate) fn tolerance_scales(&self) -> &[S] {
        &self.scales
    }

    /// A revolute joint and its state at the last evaluation.
    pub(crate) fn joint(&self, place: Place) -> (&Revolute<S>, &JointState<S>) {
        let (machine, at) = (&self.machine, &self.evaluation);
        match place {
            Place::Main => (&machine.main, &at.main),
            Place::BigEnd(i) => (&machine.throws[i].big_end, &at.throws[i].joints.big_end),
            Place::SmallEnd(i) => (&machine.throws[i].small_end, &at.throws[i].joints.small_end),
        }
    }

    pub(crate) fn evaluation_mut(&mut self) -> &mut Evaluation<S> {
        &mut self.evaluation
    }

    /// What the last evaluation found.
    pub fn evaluation(&self) -> &Evaluation<S> {
        &self.evaluation
    }

    /// Kinetic, potential and elastic energy at the last evaluation, J.
    #[inline(never)]
    pub fn energy(&self) -> Energy<S> {
        S::vectorised(
            #[inline(always)]
            || energy::energy(&self.machine, &self.evaluation),
        )
    }

    /// The powers of the ledger at the last evaluation.
    pub fn powers(&self) -> Powers<S> {
        S::vectorised(
            #[inline(always)]
            || energy::powers(&self.machine, &self.evaluation),
        )
    }
}

impl Dynamics<f64> {
    /// What gas and back pressure hold for the pistons at the last evaluation, J, to an unknown constant.
    /// With ideal valves they never do more work than this falls by. None where effects act on the
    /// machine, or where compression and expansion have different exponents (heat does work there).
    pub fn gas_energy(&self) -> Option<f64> {
        if !self.machine.effects.is_empty() {
            return None;
        }
        let throws = self.machine.throws.iter().zip(&self.evaluation.throws);
        throws
            .map(|(throw, at)| at.gas.held(throw, &at.motion))
            .sum()
    }
}
