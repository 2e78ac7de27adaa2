//! How deep the surfaces of a record's joints are pressed into each other.

use mechanism::joints::guide::Guide;
use mechanism::joints::revolute::Revolute;
use mechanism::state::Layout;
use mechanism::{Dynamics, Machine};

/// Penetration over clearance beyond which a contact law says little: 1.
///
/// There the overlapping arc of pin and bearing is 120° wide: half of it is arccos(c / (c + δ)), 60° at
/// δ = c. The laws assume a contact that is narrow against the radius (Johnson 1985, Contact Mechanics,
/// section 4.2). The journal moves by its deformation as much as by its clearance, so that the clearance
/// is no measure of the wear.
pub const DEEPEST_OVER_CLEARANCE: f64 = 1.0;

/// How deep the surfaces of a joint were pressed into each other.
#[derive(Clone, Debug, PartialEq)]
pub struct Penetration {
    /// The joint: `small_end`, `throw1.big_end`.
    pub joint: String,
    /// Deepest penetration at the integration's steps within the record, m; 0 where they never touched.
    pub deepest: f64,
    /// The joint's clearance, m.
    pub clearance: f64,
}

impl Penetration {
    /// Whether it is deeper than contact laws hold.
    pub fn is_too_deep(&self) -> bool {
        self.deepest > DEEPEST_OVER_CLEARANCE * self.clearance
    }
}

impl std::fmt::Display for Penetration {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let um = |metres: f64| metres * 1e6;
        write!(
            f,
            "{}: the surfaces penetrate each other by {:.3} µm, {:.2} times the clearance of {:.3} µm; the \
             contact law does not hold there: enter a stiffer contact (materials: {{pin: steel, bush: bronze}}, or a \
             measured stiffness), or a load that the joint can bear",
            self.joint,
            um(self.deepest),
            self.deepest / self.clearance,
            um(self.clearance)
        )
    }
}

/// Joints that are watched while a machine is recorded.
#[derive(Clone)]
pub(crate) struct Watch(Vec<(Place, Penetration)>);

/// Where in the state a joint lies.
#[derive(Clone, Copy)]
enum Place {
    /// The offset of a journal.
    Journal(usize),
    /// Shift and tilt of a crosshead of this half length.
    Guide(usize, f64),
}

impl Watch {
    /// Every joint with clearance.
    pub fn new(dynamics: &Dynamics<f64>) -> Self {
        let (machine, layout): (&Machine, &Layout) = (dynamics.machine(), dynamics.layout());
        let mut joints = Vec::new();
        let mut add = |throw: &str, name: &str, clearance: Option<f64>, place: Option<Place>| {
            if let (Some(clearance), Some(place)) = (clearance, place) {
                let joint = match throw {
                    "" => name.to_owned(),
                    throw => format!("{throw}.{name}"),
                };
                let deepest = 0.0;
                let penetration = Penetration {
                    joint,
                    deepest,
                    clearance,
                };
                joints.push((place, penetration));
            }
        };
        let of = |joint: &Revolute| joint.clear().map(|clear| clear.clearance);
        let journal = |at: Option<usize>| at.map(Place::Journal);
        add("", "main", of(&machine.main), journal(layout.main));
        for (throw, at) in machine.throws.iter().zip(&layout.throws) {
            let name = throw.name.as_str();
            add(name, "big_end", of(&throw.big_end), journal(at.big_end));
            add(
                name,
                "small_end",
                of(&throw.small_end),
                journal(at.small_end),
            );
            if let Guide::Clear(guide) = &throw.guide {
                let place = at.guide.map(|i| Place::Guide(i, guide.half_length));
                add(name, "guide", Some(guide.clearance), place);
            }
        }
        Self(joints)
    }

    /// Takes in a state, of which `y` gives the components.
    pub fn update(&mut self, y: impl Fn(usize) -> f64) {
        for (place, seen) in &mut self.0 {
            let away = match *place {
                Place::Journal(i) => (y(i) * y(i) + y(i + 1) * y(i + 1)).sqrt(),
                Place::Guide(i, half_length) => y(i).abs() + y(i + 1).abs() * half_length,
            };
            seen.deepest = seen.deepest.max(away - seen.clearance);
        }
    }

    /// What was seen.
    pub fn end(self) -> Vec<Penetration> {
        self.0.into_iter().map(|(_, seen)| seen).collect()
    }
}
