//! A chamber of a cylinder: how far its piston is from its cover over the crank angle.

use mechanism::{Machine, Throw};
use simulate::{ChamberEnd, Measured};
use std::f64::consts::{PI, TAU};

/// A chamber: how far its piston is from its cover. Volumes are lengths here, the area of the piston
/// being the same throughout.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chamber {
    /// Which end of the cylinder.
    pub end: ChamberEnd,
    /// Gap between piston and cover at the chamber's own dead centre, m.
    pub clearance: f64,
    pub(crate) crank_radius: f64,
    pub(crate) rod_length: f64,
    /// The throw's own crank angle, 0 at the head's dead centre, less that of the shaft.
    pub(crate) phase: f64,
}

impl Chamber {
    /// The chamber of the machine that a pressure's column names; none where it names none.
    pub fn of_column(machine: &Machine, column: &str) -> Option<Self> {
        let (throw, end) = place(machine, column)?;
        Self::of_throw(&machine.throws[throw], end)
    }

    fn of_throw(throw: &Throw, end: ChamberEnd) -> Option<Self> {
        let cylinder = &throw.cylinder;
        Some(Self {
            end,
            clearance: match end {
                ChamberEnd::Head => cylinder.head_clearance,
                ChamberEnd::Crank => cylinder.crank_end.as_ref()?.clearance,
            },
            crank_radius: throw.crank_radius,
            rod_length: throw.rod.length,
            phase: throw.local_angle(0.0),
        })
    }

    /// Twice the crank radius, m.
    pub fn stroke(&self) -> f64 {
        2.0 * self.crank_radius
    }

    /// How far the piston is from where it stands at the chamber's dead centre, m.
    pub fn travel(&self, crank_angle: f64) -> f64 {
        let (sine, cosine) = (crank_angle + self.phase).sin_cos();
        let [r, l] = [self.crank_radius, self.rod_length];
        let position = r * cosine + (l * l - (r * sine).powi(2)).sqrt();
        match self.end {
            ChamberEnd::Head => r + l - position,
            ChamberEnd::Crank => position - (l - r),
        }
    }

    /// Distance from piston to cover, m: the volume over the area.
    pub fn distance(&self, crank_angle: f64) -> f64 {
        self.clearance + self.travel(crank_angle)
    }

    /// Crank angle of the chamber's own dead centre, where it is smallest, in [0, 2π).
    pub(crate) fn dead_centre(&self) -> f64 {
        let own = match self.end {
            ChamberEnd::Head => 0.0,
            ChamberEnd::Crank => PI,
        };
        (own - self.phase).rem_euclid(TAU)
    }

    /// Whether it grows where the crank turns on from there.
    pub(crate) fn is_growing(&self, crank_angle: f64) -> bool {
        (crank_angle - self.dead_centre()).rem_euclid(TAU) < PI
    }

    /// The angle after the dead centre at which the piston has the distance, from 0 to π: bisection.
    pub(crate) fn turned(&self, distance: f64) -> f64 {
        if distance <= self.clearance {
            return 0.0;
        }
        if distance >= self.clearance + self.stroke() {
            return PI;
        }
        let [mut low, mut high] = [0.0, PI];
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            // The mechanism is symmetric about its dead centres.
            if self.distance(self.dead_centre() + middle) < distance {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }
}

/// The throw, by its index, and the end of its cylinder that a pressure's column names; none where it names none.
pub(crate) fn place(machine: &Machine, column: &str) -> Option<(usize, ChamberEnd)> {
    let names: Vec<&str> = machine.throws.iter().map(|t| t.name.as_str()).collect();
    let ends = [ChamberEnd::Head, ChamberEnd::Crank];
    let mut all = (0..names.len()).flat_map(|throw| ends.map(|end| (throw, end)));
    all.find(|&(throw, end)| Measured::CylinderPressure { throw, end }.column(&names) == column)
}
