//! What the guards of a machine watch.

use crate::joints::contact_guards::CONTACT_GUARDS;
use crate::joints::revolute::Revolute;
use crate::machine::Machine;
use scalar::Scalar;

/// A revolute joint of the machine.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Place {
    /// The main bearing.
    Main,
    /// The big end of a throw.
    BigEnd(usize),
    /// The small end of a throw.
    SmallEnd(usize),
}

/// What a guard watches, and which of that place's guards it is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Watch {
    pub place: Watched,
    pub part: usize,
}

/// Where a guard watches.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Watched {
    /// A revolute joint with clearance.
    Joint(Place),
    /// A corner of the crosshead of a throw.
    Corner(usize, usize),
    /// The gas of a throw: dead centres, and two valves a chamber.
    Gas(usize),
    /// The crank's speed, where it is not constant: the crank turns back.
    Crank,
}

/// The guards that a machine of this build has, in the order in which they are written.
pub(crate) fn watches<S: Scalar>(machine: &Machine<S>) -> Vec<Watch> {
    let mut watches = Vec::new();
    let mut add = |place, parts| {
        watches.extend((0..parts).map(|part| Watch { place, part }));
    };
    let mut joint = |joint: &Revolute<S>, place| {
        if joint.clear().is_some() {
            add(Watched::Joint(place), CONTACT_GUARDS);
        }
    };
    joint(&machine.main, Place::Main);
    for (i, throw) in machine.throws.iter().enumerate() {
        joint(&throw.big_end, Place::BigEnd(i));
        joint(&throw.small_end, Place::SmallEnd(i));
    }
    for (i, throw) in machine.throws.iter().enumerate() {
        if throw.guide.clear().is_some() {
            for corner in 0..4 {
                add(Watched::Corner(i, corner), CONTACT_GUARDS);
            }
        }
        let chambers = 1 + usize::from(throw.cylinder.crank_end.is_some());
        add(Watched::Gas(i), 1 + 2 * chambers);
    }
    if !machine.drive.is_constant() {
        add(Watched::Crank, 1);
    }
    watches
}
