//! The accelerations of a throw under its loads.

use super::joints::Joints;
use super::loads::{Loads, crosshead_give};
use crate::machine::Throw;
use crate::plane::{Vec2, moment, origin, turned};
use scalar::Scalar;

/// Accelerations of one throw, and its rigid joints' forces.
#[derive(Clone, Copy, Debug)]
pub struct Accelerations<S> {
    /// Crosshead along x, m/s².
    pub crosshead: S,
    /// Second rate of the big-end offset, m/s².
    pub big_end: Vec2<S>,
    /// Second rate of the small-end offset, m/s².
    pub small_end: Vec2<S>,
    /// Second rates of the crosshead's shift and tilt, m/s² and rad/s².
    pub guide: Vec2<S>,
    /// Force on the rod at the big end, of a rigid joint model (0 with compliant contact), N.
    pub big_force: Vec2<S>,
    /// The same at the small end.
    pub small_force: Vec2<S>,
    /// Rod's angular acceleration, rad/s².
    pub rod: S,
    /// Second rate of the rod's stretch, 1/s².
    pub(crate) stretch: S,
}

impl<S: Scalar> Accelerations<S> {
    /// Nothing yet.
    #[inline(always)]
    pub(crate) fn none() -> Self {
        let zero = S::zero();
        Self {
            crosshead: zero,
            big_end: origin(),
            small_end: origin(),
            guide: origin(),
            big_force: origin(),
            small_force: origin(),
            rod: zero,
            stretch: zero,
        }
    }

    /// Finds the accelerations under the loads and the rigid joints' forces, if there are any, with
    /// the crank pin's own.
    #[inline(always)]
    pub(crate) fn find(
        &mut self,
        throw: &Throw<S>,
        loads: &Loads<S>,
        joints: &Joints<S>,
        pin: Vec2<S>,
        forces: Option<[Vec2<S>; 2]>,
    ) {
        let arms = &loads.arms;
        let (mut centre, mut rod) = loads.free_rod(throw);
        let mut crosshead = loads.free_crosshead(throw);
        let mut tilting = loads.crosshead_moment;
        let [of_big, of_small] = arms.shares;
        let mut stretch = loads.stretch;
        let [big_force, small_force] = forces.unwrap_or([origin(); 2]);
        if forces.is_some() {
            centre += (big_force + small_force) / throw.rod.mass;
            rod += (moment(arms.big_force, big_force) + moment(arms.small_force, small_force))
                / loads.rod_inertia;
            crosshead -= crosshead_give(throw) * small_force;
            tilting -= moment(joints.small_end.arm, small_force);
            let pull = (big_force * of_big + small_force * of_small).dot(&arms.along);
            stretch = stretch.map(|stretch| stretch + pull / throw.rod.inertia);
        }
        let mut big_eye = turned(arms.big).mul_add(rod, centre + loads.big_bias);
        let mut small_eye = turned(arms.small).mul_add(rod, centre + loads.small_bias);
        if let Some(stretch) = stretch {
            big_eye += arms.along * (of_big * stretch);
            small_eye += arms.along * (of_small * stretch);
        }
        self.crosshead = crosshead.x;
        self.big_end = pin - big_eye;
        self.small_end = crosshead - small_eye;
        self.guide = match throw.guide.clear() {
            None => origin(),
            Some(_) => Vec2::new(crosshead.y, tilting / throw.crosshead.inertia),
        };
        self.big_force = big_force;
        self.small_force = small_force;
        self.rod = rod;
        self.stretch = stretch.unwrap_or(S::zero());
    }
}
