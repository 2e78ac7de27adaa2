//! What every number of the equations of motion can do.

use num_traits::{One, Zero};
use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// The result of comparing two scalars: one truth value, or one per lane.
pub trait Mask: Copy + Debug {
    /// True in every lane where both are.
    fn and(self, other: Self) -> Self;
    /// True in every lane where either is.
    fn or(self, other: Self) -> Self;
    /// True in every lane where this is not.
    fn not(self) -> Self;
    /// True in at least one lane.
    fn any(self) -> bool;
}

/// The closure itself. Only where a closure is handed over it may be marked `#[inline(always)]`, and the
/// compiler keeps one that is used twice out of line, without the instructions of lanes.
#[inline(always)]
pub fn inlined<F>(closure: F) -> F {
    closure
}

/// A real number of the equations of motion.
///
/// Branches on values are written with [`Scalar::select`], so that lanes may disagree.
pub trait Scalar:
    Copy
    + Debug
    + PartialEq
    + Send
    + Sync
    + 'static
    + Zero
    + One
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + DivAssign
{
    /// What a comparison yields.
    type Mask: Mask;
    /// The number without its derivatives.
    type Plain: Scalar<Mask = Self::Mask, Plain = Self::Plain>;

    /// The number without its derivatives.
    fn plain(self) -> Self::Plain;

    /// The constant `x` (in every lane, with no derivative).
    fn constant(x: f64) -> Self;
    /// `self < other`, by value.
    fn lt(self, other: Self) -> Self::Mask;
    /// `yes` where the mask is true, `no` elsewhere.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// `self * factor + term`, rounded once.
    fn mul_add(self, factor: Self, term: Self) -> Self;
    /// Square root; the derivative at 0 is taken as 0.
    fn sqrt(self) -> Self;
    /// Sine and cosine of an angle in radians.
    fn sin_cos(self) -> (Self, Self);
    /// Exponential function.
    fn exp(self) -> Self;
    /// Natural logarithm of a positive number.
    fn ln(self) -> Self;

    /// Does `work` with the instructions that the processor has for this scalar. Only what is inlined
    /// into `work` gains by it.
    #[inline(always)]
    fn vectorised<T>(work: impl FnOnce() -> T) -> T {
        work()
    }

    /// `self` raised to `exponent`; `self` must be positive.
    #[inline(always)]
    fn powf(self, exponent: Self) -> Self {
        (self.ln() * exponent).exp()
    }
    /// Arc tangent: the polynomial of Abramowitz and Stegun 1964, 4.4.49, and one step of Newton's method.
    #[inline(always)]
    fn atan(self) -> Self {
        const COEFFICIENTS: [f64; 9] = [
            1.0,
            -0.333_331_452_8,
            0.199_935_508_5,
            -0.142_088_994_4,
            0.106_562_639_3,
            -0.075_289_640_0,
            0.042_909_613_8,
            -0.016_165_736_7,
            0.002_866_225_7,
        ];
        let steep = Self::one().lt(self.abs());
        let slope = Self::select(steep, -(Self::one() / self), self);
        let square = slope * slope;
        let mut sum = Self::zero();
        for coefficient in COEFFICIENTS.into_iter().rev() {
            sum = sum * square + coefficient;
        }
        let angle = slope * sum;
        let (sine, cosine) = angle.sin_cos();
        let angle = angle + (slope * cosine - sine) / (cosine + slope * sine);
        let quarter = Self::constant(std::f64::consts::FRAC_PI_2);
        let quarter = Self::select(self.lt(Self::zero()), -quarter, quarter);
        Self::select(steep, angle + quarter, angle)
    }
    /// The larger of two, by value.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select(self.lt(other), other, self)
    }
    /// The smaller of two, by value.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::select(other.lt(self), other, self)
    }
    /// Absolute value.
    #[inline(always)]
    fn abs(self) -> Self {
        Self::select(self.lt(Self::zero()), -self, self)
    }
    /// `self` kept between `low` and `high`.
    #[inline(always)]
    fn clamp(self, low: Self, high: Self) -> Self {
        self.max(low).min(high)
    }
}
