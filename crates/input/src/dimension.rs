//! Dimensions, and values that have one.

/// Exponents of the base units. The angle counts as one, so that a speed in rpm cannot pass for a
/// frequency in Hz.
#[derive(Clone, Copy, Debug)]
pub struct Dimension {
    /// Exponent of the metre.
    pub length: f64,
    /// Exponent of the kilogram.
    pub mass: f64,
    /// Exponent of the second.
    pub time: f64,
    /// Exponent of the radian.
    pub angle: f64,
}

/// A value with its dimension.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measure {
    /// The value in SI units.
    pub si: f64,
    /// What it is a value of.
    pub dimension: Dimension,
}

impl Dimension {
    /// A pure number.
    pub const NONE: Self = Self::new(0.0, 0.0, 0.0, 0.0);

    /// m^length kg^mass s^time rad^angle.
    pub const fn new(length: f64, mass: f64, time: f64, angle: f64) -> Self {
        Self {
            length,
            mass,
            time,
            angle,
        }
    }

    /// N/m^n: the stiffness of a contact law with exponent n.
    pub const fn stiffness(exponent: f64) -> Self {
        Self::new(1.0 - exponent, 1.0, -2.0, 0.0)
    }

    /// The exponent n, if this is N/m^n.
    pub fn stiffness_exponent(&self) -> Option<f64> {
        let exponent = (1e9 * (1.0 - self.length)).round() / 1e9;
        (*self == Self::stiffness(exponent)).then_some(exponent)
    }

    pub(crate) fn exponents(&self) -> [f64; 4] {
        [self.length, self.mass, self.time, self.angle]
    }

    pub(crate) fn times(&self, unit: &Self, power: f64) -> Self {
        Self {
            length: self.length + power * unit.length,
            mass: self.mass + power * unit.mass,
            time: self.time + power * unit.time,
            angle: self.angle + power * unit.angle,
        }
    }
}

/// Equal up to the rounding of fractional exponents.
impl PartialEq for Dimension {
    fn eq(&self, other: &Self) -> bool {
        let pairs = self.exponents().into_iter().zip(other.exponents());
        pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-9)
    }
}
