//! The joints of a throw.

use crate::joints::guide::GuideState;
use crate::joints::revolute::JointState;

/// The joints of one throw at an instant.
#[derive(Clone, Copy, Debug)]
pub struct Joints<S> {
    /// Big end: crank pin in the rod.
    pub big_end: JointState<S>,
    /// Small end: crosshead pin in the rod.
    pub small_end: JointState<S>,
    /// Crosshead in its guide.
    pub guide: GuideState<S>,
}
