//! What lanes of any width can do, and how a type of them is made from the instructions of a processor.

use crate::Scalar;

/// `W` independent numbers.
pub trait Lanes<const W: usize>: Scalar<Plain = Self> {
    /// So many machines, or fewer, take less time one by one than side by side: a step in lanes takes the time of 2.8 plain
    /// ones with AVX-512, and of 4.0 with AVX2 (eight machines at 1e-6, tests/peers/README.md).
    const FEW: usize;

    /// The number in each lane.
    fn to_array(self) -> [f64; W];
    /// These numbers.
    fn from_array(numbers: [f64; W]) -> Self;
    /// The number in one lane.
    fn get(&self, lane: usize) -> f64;
    /// Puts a number into one lane.
    fn set(&mut self, lane: usize, number: f64);
    /// The truth value of each lane.
    fn truths(mask: Self::Mask) -> [bool; W];
    /// These truth values.
    fn mask(truths: [bool; W]) -> Self::Mask;
}

/// Lane-wise binary operators, with another of the kind and with a plain number.
macro_rules! operators {
    ($name:ident: $( $trait:ident $method:ident $assign:ident $assign_method:ident $function:path; )*) => { $(
        impl std::ops::$trait for $name {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                $function(self, other)
            }
        }
        impl std::ops::$trait<f64> for $name {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: f64) -> Self {
                $function(self, splat(other))
            }
        }
        impl std::ops::$assign for $name {
            #[inline(always)]
            fn $assign_method(&mut self, other: Self) {
                *self = $function(*self, other);
            }
        }
    )* };
}

/// Makes a type of lanes from the functions of the module that it stands in: `splat`, `add`,
/// `subtract`, `multiply`, `divide`, `multiply_add`, `negate`, `square_root`, `less`, `choose`, `bit`, `two_to_the`,
/// `split`, `equal` and `vectorised`, on values of the type; `Truths` is its mask.
macro_rules! lanes {
    ($name:ident, $width:literal, few: $few:literal) => {
        $crate::lanes::operations::operators! { $name:
            Add add AddAssign add_assign add;
            Sub sub SubAssign sub_assign subtract;
            Mul mul MulAssign mul_assign multiply;
            Div div DivAssign div_assign divide;
        }

        impl std::ops::Neg for $name {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                negate(self)
            }
        }

        impl PartialEq for $name {
            #[inline(always)]
            fn eq(&self, other: &Self) -> bool {
                equal(*self, *other)
            }
        }

        impl std::fmt::Debug for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                self.to_array().fmt(f)
            }
        }

        impl num_traits::Zero for $name {
            #[inline(always)]
            fn zero() -> Self {
                splat(0.0)
            }
            #[inline(always)]
            fn is_zero(&self) -> bool {
                *self == splat(0.0)
            }
        }

        impl num_traits::One for $name {
            #[inline(always)]
            fn one() -> Self {
                splat(1.0)
            }
        }

        impl $crate::Scalar for $name {
            type Mask = Truths;
            type Plain = Self;

            #[inline(always)]
            fn plain(self) -> Self {
                self
            }
            #[inline(always)]
            fn constant(x: f64) -> Self {
                splat(x)
            }
            #[inline(always)]
            fn lt(self, other: Self) -> Truths {
                less(self, other)
            }
            #[inline(always)]
            fn select(mask: Truths, yes: Self, no: Self) -> Self {
                choose(mask, yes, no)
            }
            #[inline(always)]
            fn mul_add(self, factor: Self, term: Self) -> Self {
                multiply_add(self, factor, term)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                square_root(self)
            }
            #[inline(always)]
            fn sin_cos(self) -> (Self, Self) {
                $crate::elementary::sin_cos(self)
            }
            #[inline(always)]
            fn exp(self) -> Self {
                $crate::elementary::exp(self)
            }
            #[inline(always)]
            fn ln(self) -> Self {
                $crate::elementary::ln(self)
            }
            #[inline(always)]
            fn vectorised<T>(work: impl FnOnce() -> T) -> T {
                vectorised(work)
            }
        }

        impl $crate::elementary::Bits for $name {
            #[inline(always)]
            fn bit(self, number: u32) -> Truths {
                bit(self, number)
            }
            #[inline(always)]
            fn two_to_the(self) -> Self {
                two_to_the(self)
            }
            #[inline(always)]
            fn split(self) -> (Self, Self) {
                split(self)
            }
        }

        impl $crate::Lanes<$width> for $name {
            const FEW: usize = $few;

            fn to_array(self) -> [f64; $width] {
                std::array::from_fn(|lane| self.get(lane))
            }
            fn from_array(numbers: [f64; $width]) -> Self {
                let mut lanes = splat(0.0);
                for (lane, number) in numbers.into_iter().enumerate() {
                    lanes.set(lane, number);
                }
                lanes
            }
            #[inline]
            fn get(&self, lane: usize) -> f64 {
                self.numbers()[lane]
            }
            #[inline]
            fn set(&mut self, lane: usize, number: f64) {
                self.numbers_mut()[lane] = number;
            }
            fn truths(mask: Truths) -> [bool; $width] {
                mask.to_array()
            }
            fn mask(truths: [bool; $width]) -> Truths {
                Truths::from_array(truths)
            }
        }
    };
}

pub(super) use {lanes, operators};
