//! Numbers with one derivative, for products with the Jacobian.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// What the right-hand side is written over.
pub trait Number:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    fn of(value: f64) -> Self;
    fn value(self) -> f64;
    fn sqrt(self) -> Self;
    fn powf(self, exponent: f64) -> Self;
}

impl Number for f64 {
    fn of(value: f64) -> Self {
        value
    }
    fn value(self) -> f64 {
        self
    }
    fn sqrt(self) -> Self {
        self.sqrt()
    }
    fn powf(self, exponent: f64) -> Self {
        self.powf(exponent)
    }
}

/// A value and its derivative.
#[derive(Clone, Copy)]
pub struct Dual(pub f64, pub f64);

impl Add for Dual {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        Self(self.0 + b.0, self.1 + b.1)
    }
}
impl Sub for Dual {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        Self(self.0 - b.0, self.1 - b.1)
    }
}
impl Mul for Dual {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        Self(self.0 * b.0, self.1 * b.0 + self.0 * b.1)
    }
}
impl Div for Dual {
    type Output = Self;
    fn div(self, b: Self) -> Self {
        let share = self.0 / b.0;
        Self(share, (self.1 - share * b.1) / b.0)
    }
}
impl Neg for Dual {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0, -self.1)
    }
}
impl Number for Dual {
    fn of(value: f64) -> Self {
        Self(value, 0.0)
    }
    fn value(self) -> f64 {
        self.0
    }
    fn sqrt(self) -> Self {
        let root = self.0.sqrt();
        Self(root, 0.5 * self.1 / root)
    }
    fn powf(self, exponent: f64) -> Self {
        let power = self.0.powf(exponent);
        Self(power, exponent * power / self.0 * self.1)
    }
}
