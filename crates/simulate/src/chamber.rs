//! The chambers of a machine's cylinders, as an indicator sees them.

use crate::sensors::{ChamberEnd, Measured};
use crate::slider_crank::SliderCrank;
use mechanism::{Machine, Throw};
use std::f64::consts::PI;

/// A chamber: what turns its pressure over the crank angle into a p-V card.
///
/// The piston is where crank and rod have it without clearances and without load. In a joint with 0.3 mm
/// of clearance and 240 mm of stroke that errs by 0.1 % of the stroke at most.
#[derive(Clone, Debug, PartialEq)]
pub struct Chamber {
    /// Column of its pressure, as [`Measured::column`] names it.
    pub column: String,
    /// Index of the throw.
    pub throw: usize,
    /// Which end of the cylinder.
    pub end: ChamberEnd,
    /// Area of the piston on this side, m².
    pub area: f64,
    /// Stroke, m.
    pub stroke: f64,
    /// Volume at its dead centre, m³.
    pub clearance_volume: f64,
    mechanism: SliderCrank,
    /// Angle since the throw's top dead centre where the machine's crank angle is 0, rad.
    angle: f64,
}

impl Chamber {
    /// All chambers of a machine: throw by throw, the head end first.
    pub fn of_machine(machine: &Machine) -> Vec<Self> {
        let names = machine.throw_names();
        let throws = machine.throws.iter().enumerate();
        let ends = throws.flat_map(|(i, throw)| {
            let crank = throw.cylinder.crank_end.as_ref().map(|_| ChamberEnd::Crank);
            let ends = [Some(ChamberEnd::Head), crank].into_iter().flatten();
            ends.map(move |end| (i, throw, end))
        });
        ends.map(|(i, throw, end)| Self::new(i, throw, end, &names))
            .collect()
    }

    fn new(index: usize, throw: &Throw<f64>, end: ChamberEnd, names: &[&str]) -> Self {
        let cylinder = &throw.cylinder;
        let face = PI * cylinder.piston_radius.powi(2);
        let (area, dead) = match (end, &cylinder.crank_end) {
            (ChamberEnd::Crank, Some(end)) => (face - PI * end.rod_radius.powi(2), end.clearance),
            _ => (face, cylinder.head_clearance),
        };
        let measured = Measured::CylinderPressure { throw: index, end };
        Self {
            column: measured.column(names),
            throw: index,
            end,
            area,
            stroke: 2.0 * throw.crank_radius,
            clearance_volume: area * dead,
            mechanism: SliderCrank::from_throw(throw),
            angle: throw.local_angle(0.0),
        }
    }

    /// The same chamber, whose pressure has another name.
    pub fn named(&self, column: impl Into<String>) -> Self {
        Self {
            column: column.into(),
            ..self.clone()
        }
    }

    /// Its volume where the machine's crank stands at `crank_angle`, rad, in m³.
    pub fn volume(&self, crank_angle: f64) -> f64 {
        let SliderCrank { radius, rod } = self.mechanism;
        let position = self.mechanism.position(crank_angle + self.angle);
        let distance = match self.end {
            ChamberEnd::Head => radius + rod - position,
            ChamberEnd::Crank => position - (rod - radius),
        };
        self.clearance_volume + self.area * distance
    }

    /// Volume that the piston sweeps, m³.
    pub fn swept_volume(&self) -> f64 {
        self.area * self.stroke
    }
}
