//! The gas of one throw.

use super::chamber::GasState;
use crate::mode::ThrowMode;
use scalar::Scalar;

/// The gas of one throw at an instant.
#[derive(Clone, Copy, Debug)]
pub struct Gas<S> {
    /// Head end.
    pub head_end: GasState<S>,
    /// Crank end; pressure 0 in a single-acting cylinder.
    pub crank_end: GasState<S>,
    /// Force of the gas on the crosshead body along x, N.
    pub force: S,
    /// Force of the effects on the crosshead body along x, N.
    pub effects: S,
    /// Rates of the drifts of head end and crank end off their polytropes, 1/s.
    pub(crate) drift: [S; 2],
    /// Suction and discharge pressure of head end and crank end at the dead centres, where effects may have moved them.
    /// They stay what they are while the speed is constant.
    pub(crate) centres: Option<[[S; 2]; 2]>,
}

impl<S: Scalar> Gas<S> {
    /// Nothing yet.
    #[inline(always)]
    pub(crate) fn none() -> Self {
        Self {
            head_end: GasState::none(),
            crank_end: GasState::none(),
            force: S::zero(),
            effects: S::zero(),
            drift: [S::zero(); 2],
            centres: None,
        }
    }

    /// Sets the valves of head end and crank end as the pressures call for.
    #[inline(always)]
    pub(crate) fn set_valves(&self, mode: &mut ThrowMode<S>) {
        let ([head, crank], outward) = (self.drift, mode.outward);
        let trapped = [mode.head_end.trapped, mode.crank_end.trapped];
        mode.head_end = self.head_end.mode(outward, head, trapped[0]);
        mode.crank_end = (self.crank_end).mode(S::one() - outward, crank, trapped[1]);
    }
}
