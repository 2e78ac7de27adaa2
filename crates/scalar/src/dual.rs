//! Dual numbers: a value and its exact derivatives in `N` directions (Clifford 1873; forward
//! differentiation as in Griewank and Walther 2008, chapter 3).
//!
//! Ours rather than a crate's, because the value must follow bit for bit the plain run
//! ([`elementary`](crate::elementary)), and because sensitivities of several cases at once are
//! duals over [`Lanes`](crate::Lanes).

use crate::Scalar;
use num_traits::{One, Zero};
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// `value + tangent[0] e0 + ... + tangent[N-1] eN-1`, with `ei ej = 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<S, const N: usize> {
    /// The plain number.
    pub value: S,
    /// Its derivative in each direction.
    pub tangent: [S; N],
}

impl<S: Scalar, const N: usize> Dual<S, N> {
    /// The independent variable of direction `index`.
    pub fn variable(value: S, index: usize) -> Self {
        let mut tangent = [S::zero(); N];
        tangent[index] = S::one();
        Self { value, tangent }
    }

    /// `value` with each tangent as `f` makes it.
    #[inline]
    fn each(mut self, value: S, f: impl Fn(S) -> S) -> Self {
        for d in &mut self.tangent {
            *d = f(*d);
        }
        self.value = value;
        self
    }

    /// `f(value)`, whose derivative there is `slope`.
    #[inline]
    fn chain(self, value: S, slope: S) -> Self {
        self.each(value, |d| d * slope)
    }

    #[inline]
    fn zip(mut self, other: Self, value: S, f: impl Fn(S, S) -> S) -> Self {
        for (d, e) in self.tangent.iter_mut().zip(other.tangent) {
            *d = f(*d, e);
        }
        self.value = value;
        self
    }
}

impl<S: Scalar, const N: usize> Neg for Dual<S, N> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        self.each(-self.value, |d| -d)
    }
}

impl<S: Scalar, const N: usize> Add for Dual<S, N> {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        self.zip(other, self.value + other.value, |a, b| a + b)
    }
}

impl<S: Scalar, const N: usize> Sub for Dual<S, N> {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        self.zip(other, self.value - other.value, |a, b| a - b)
    }
}

impl<S: Scalar, const N: usize> Mul for Dual<S, N> {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        let (a, b) = (self.value, other.value);
        self.zip(other, a * b, |da, db| da.mul_add(b, a * db))
    }
}

impl<S: Scalar, const N: usize> Div for Dual<S, N> {
    type Output = Self;
    #[inline]
    fn div(self, other: Self) -> Self {
        let quotient = self.value / other.value;
        let slope = S::one() / other.value;
        self.zip(other, quotient, |da, db| {
            (-quotient).mul_add(db, da) * slope
        })
    }
}

impl<S: Scalar, const N: usize> Add<f64> for Dual<S, N> {
    type Output = Self;
    #[inline]
    fn add(self, other: f64) -> Self {
        Self {
            value: self.value + other,
            ..self
        }
    }
}

impl<S: Scalar, const N: usize> Sub<f64> for Dual<S, N> {
    type Output = Self;
    #[inline]
    fn sub(self, other: f64) -> Self {
        Self {
            value: self.value - other,
            ..self
        }
    }
}

impl<S: Scalar, const N: usize> Mul<f64> for Dual<S, N> {
    type Output = Self;
    #[inline]
    fn mul(self, other: f64) -> Self {
        self.each(self.value * other, |d| d * other)
    }
}

impl<S: Scalar, const N: usize> Div<f64> for Dual<S, N> {
    type Output = Self;
    #[inline]
    fn div(self, other: f64) -> Self {
        let slope = 1.0 / other;
        self.each(self.value / other, |d| d * slope)
    }
}

impl<S: Scalar, const N: usize> AddAssign for Dual<S, N> {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<S: Scalar, const N: usize> SubAssign for Dual<S, N> {
    #[inline]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<S: Scalar, const N: usize> MulAssign for Dual<S, N> {
    #[inline]
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl<S: Scalar, const N: usize> DivAssign for Dual<S, N> {
    #[inline]
    fn div_assign(&mut self, other: Self) {
        *self = *self / other;
    }
}

impl<S: Scalar, const N: usize> Zero for Dual<S, N> {
    #[inline]
    fn zero() -> Self {
        Self::constant(0.0)
    }
    #[inline]
    fn is_zero(&self) -> bool {
        *self == Self::zero()
    }
}

impl<S: Scalar, const N: usize> One for Dual<S, N> {
    #[inline]
    fn one() -> Self {
        Self::constant(1.0)
    }
}

impl<S: Scalar, const N: usize> Scalar for Dual<S, N> {
    type Mask = S::Mask;
    type Plain = S::Plain;

    #[inline]
    fn plain(self) -> S::Plain {
        self.value.plain()
    }

    #[inline]
    fn constant(x: f64) -> Self {
        Self {
            value: S::constant(x),
            tangent: [S::zero(); N],
        }
    }
    #[inline]
    fn lt(self, other: Self) -> S::Mask {
        self.value.lt(other.value)
    }
    #[inline]
    fn select(mask: S::Mask, yes: Self, no: Self) -> Self {
        let value = S::select(mask, yes.value, no.value);
        yes.zip(no, value, |a, b| S::select(mask, a, b))
    }
    #[inline]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        let (a, b) = (self.value, factor.value);
        let mut sum = term;
        sum.value = a.mul_add(b, term.value);
        for (d, (da, db)) in sum
            .tangent
            .iter_mut()
            .zip(self.tangent.iter().zip(factor.tangent))
        {
            *d = da.mul_add(b, a.mul_add(db, *d));
        }
        sum
    }
    #[inline]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        let positive = S::zero().lt(root);
        let slope = S::select(
            positive,
            S::constant(0.5) / S::select(positive, root, S::one()),
            S::zero(),
        );
        self.chain(root, slope)
    }
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        let (sine, cosine) = self.value.sin_cos();
        (self.chain(sine, cosine), self.chain(cosine, -sine))
    }
    #[inline]
    fn exp(self) -> Self {
        let e = self.value.exp();
        self.chain(e, e)
    }
    #[inline]
    fn ln(self) -> Self {
        self.chain(self.value.ln(), S::one() / self.value)
    }
    #[inline]
    fn atan(self) -> Self {
        let slope = S::one() / self.value.mul_add(self.value, S::one());
        self.chain(self.value.atan(), slope)
    }
    #[inline(always)]
    fn vectorised<T>(work: impl FnOnce() -> T) -> T {
        S::vectorised(work)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A function that uses every operation.
    fn f<S: Scalar>(x: S, y: S) -> S {
        let (s, c) = (x * y).sin_cos();
        let sum =
            (x.exp() * s - c / (y + 2.0)).abs().sqrt() + (x + y).ln() * x.powf(y).max(y) - 1.5;
        sum.mul_add(x, y.mul_add(s, c)) / 3.0
    }

    #[test]
    fn derivatives_agree_with_central_differences_and_values_bit_for_bit() {
        let (x, y) = (0.7, 1.3);
        let d = f(Dual::<f64, 2>::variable(x, 0), Dual::variable(y, 1));
        let h = 1e-6;
        let dx = (f(x + h, y) - f(x - h, y)) / (2.0 * h);
        let dy = (f(x, y + h) - f(x, y - h)) / (2.0 * h);
        assert_eq!(d.value, f(x, y));
        assert!((d.tangent[0] - dx).abs() < 1e-8 * dx.abs(), "{d:?} {dx}");
        assert!((d.tangent[1] - dy).abs() < 1e-8 * dy.abs(), "{d:?} {dy}");
    }
}
