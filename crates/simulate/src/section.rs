//! What a Poincaré section holds.

use mechanism::Machine;

/// A joint with clearance. Throws are counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Joint {
    /// The main bearing.
    Main,
    /// The big end of a throw.
    BigEnd(usize),
    /// The small end of a throw.
    SmallEnd(usize),
    /// The guide of a throw.
    Guide(usize),
}

/// Where a joint stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointPoint {
    /// Offset of the journal along x and y of its throw's frame, m; of a guide the shift, m, and
    /// the tilt, rad.
    pub offset: [f64; 2],
    /// Its rate, per second.
    pub rate: [f64; 2],
}

/// How a throw moves at the end of a revolution, and its peak within.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThrowPoint {
    /// Speed of the crosshead, m/s.
    pub velocity: f64,
    /// Its acceleration, m/s².
    pub acceleration: f64,
    /// Largest magnitude of the acceleration over the revolution, m/s².
    pub peak_acceleration: f64,
}

/// A contact that is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    /// Where.
    pub joint: Joint,
    /// Which corner of a guide: upper rear, upper front, lower rear, lower front; 0 elsewhere.
    pub corner: usize,
    /// When, s since the start.
    pub time: f64,
    /// Crank angle in [0, 2π), rad.
    pub angle: f64,
    /// Offset as in [`JointPoint::offset`].
    pub offset: [f64; 2],
    /// Speed of approach along the normal, m/s.
    pub approach: f64,
}

/// One revolution, from a passage of the section to the next, at which the points are.
#[derive(Clone, Debug, PartialEq)]
pub struct Revolution {
    /// Time of the passage, s since the start.
    pub time: f64,
    /// Crank angle there, unwrapped, rad.
    pub angle: f64,
    /// The joints with clearance, as [`clear_joints`] has them.
    pub joints: Vec<JointPoint>,
    /// The throws.
    pub throws: Vec<ThrowPoint>,
    /// The contacts made on the way, in the order of time.
    pub impacts: Vec<Impact>,
}

/// The sections of a machine.
#[derive(Clone, Debug, PartialEq)]
pub struct Sections {
    /// The joints with clearance.
    pub joints: Vec<Joint>,
    /// The revolutions.
    pub revolutions: Vec<Revolution>,
}

impl Sections {
    /// All impacts at one joint.
    pub fn impacts(&self, joint: Joint) -> impl Iterator<Item = &Impact> {
        let all = self.revolutions.iter().flat_map(|r| &r.impacts);
        all.filter(move |impact| impact.joint == joint)
    }
}

/// The joints of `machine` that have clearance: the main bearing, then big end, small end and guide
/// of each throw.
pub fn clear_joints(machine: &Machine) -> Vec<Joint> {
    let main = machine.main.clear().map(|_| Joint::Main);
    let throws = machine.throws.iter().enumerate().flat_map(|(i, throw)| {
        [
            throw.big_end.clear().map(|_| Joint::BigEnd(i)),
            throw.small_end.clear().map(|_| Joint::SmallEnd(i)),
            throw.guide.clear().map(|_| Joint::Guide(i)),
        ]
    });
    main.into_iter().chain(throws.flatten()).collect()
}
