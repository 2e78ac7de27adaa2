//! The energy that gas and back pressure hold for the piston.

use super::cylinder::area;
use super::throw_gas::Gas;
use crate::machine::Throw;
use crate::throw::Motion;

impl Gas<f64> {
    /// What the gas of the throw and the back pressure hold for the piston, J, to a constant; none with two
    /// exponents. The work that a chamber does until it is at the suction pressure, all valves closed, and
    /// what a constant pressure holds:
    ///
    /// ```text
    /// A (∫ (p − ps) dx − ps x),   p xᵐ constant
    /// ```
    ///
    /// It falls when gas passes a valve and when the crank turns back. Elsewhere only the work changes it.
    pub(crate) fn held(&self, throw: &Throw<f64>, motion: &Motion<f64>) -> Option<f64> {
        let cylinder = &throw.cylinder;
        let (exponent, suction) = (cylinder.exponent, cylinder.suction);
        if exponent != cylinder.expansion_exponent {
            return None;
        }
        let of = |pressure: f64, x: f64| {
            let ratio = (pressure / suction).max(1.0);
            let full = x * ratio.powf(1.0 / exponent);
            // ∫ p dx from x to where it is at the suction pressure; (yᵃ − 1)/a tends to ln y.
            let power = 1.0 - 1.0 / exponent;
            let grown = match exponent == 1.0 {
                true => ratio.ln(),
                false => (1.0 - ratio.powf(-power)) / (exponent - 1.0),
            };
            pressure * x * grown - suction * full
        };
        let face = area(cylinder.piston_radius);
        let reach = throw.crank_radius + throw.rod.length;
        let to_head = cylinder.head_clearance + reach - motion.crosshead;
        let head = face * of(self.head_end.pressure, to_head);
        Some(match &cylinder.crank_end {
            None => head - face * cylinder.back * motion.crosshead,
            Some(end) => {
                let rod = area(end.rod_radius);
                let to_cover =
                    end.clearance + motion.crosshead - (throw.rod.length - throw.crank_radius);
                let crank = (face - rod) * of(self.crank_end.pressure, to_cover);
                head + crank - rod * cylinder.back * motion.crosshead
            }
        })
    }
}
