//! Several numbers side by side: every operation acts on each lane alone.
//!
//! There is one type for each instruction set, whose numbers fill one register, or two of AVX2. Which of them a
//! processor has is known when the program runs: [`in_lanes`] chooses. No other way leads to the
//! types, so that nobody can use them on a processor that lacks them.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod portable;

use crate::Scalar;
use std::sync::OnceLock;

/// `W` independent numbers.
pub trait Lanes<const W: usize>: Scalar<Plain = Self> {
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

/// Work that is written for lanes of any width.
pub trait InLanes {
    /// What it yields.
    type Output;
    /// Does it in `W` lanes.
    fn run<L: Lanes<W>, const W: usize>(self) -> Self::Output;
}

/// The environment variable that holds the width of registers down.
pub const WIDTH_VARIABLE: &str = "CROSSHEAD_LANES";

/// Does `work` in lanes: 8 in a register of AVX-512 or in two of AVX2, 2 elsewhere. The results do not depend on
/// it.
pub fn in_lanes<T: InLanes>(work: T) -> T::Output {
    match width() {
        #[cfg(target_arch = "x86_64")]
        8 => work.run::<avx512::F64x8, 8>(),
        #[cfg(target_arch = "x86_64")]
        4 => work.run::<avx2::F64x8, 8>(),
        _ => work.run::<portable::F64x2, 2>(),
    }
}

/// How many numbers the registers hold that [`in_lanes`] takes: 8 with AVX-512, 4 with AVX2, 2 elsewhere.
/// `CROSSHEAD_LANES` in the environment holds them down, for those who want to measure what they are worth; it
/// never asks for more than the processor has.
pub fn width() -> usize {
    static WIDTH: OnceLock<usize> = OnceLock::new();
    *WIDTH.get_or_init(|| {
        let asked = std::env::var(WIDTH_VARIABLE).ok();
        let most = asked.and_then(|text| text.parse().ok());
        let most = most.unwrap_or(usize::MAX);
        widths().into_iter().find(|w| *w <= most).unwrap_or(2)
    })
}

/// The widths that this processor has, the greatest first.
fn widths() -> Vec<usize> {
    #[cfg(target_arch = "x86_64")]
    {
        let has = [avx512::is_present(), avx2::is_present(), true];
        let widths = [8, 4, 2].into_iter().zip(has);
        widths.filter_map(|(w, has)| has.then_some(w)).collect()
    }
    #[cfg(not(target_arch = "x86_64"))]
    vec![2]
}

/// Does `work` in lanes of every width that this processor has: for tests.
pub fn in_all_lanes<T: InLanes + Copy>(work: T) -> Vec<T::Output> {
    let run = |width| match width {
        #[cfg(target_arch = "x86_64")]
        8 => work.run::<avx512::F64x8, 8>(),
        #[cfg(target_arch = "x86_64")]
        4 => work.run::<avx2::F64x8, 8>(),
        _ => work.run::<portable::F64x2, 2>(),
    };
    widths().into_iter().map(run).collect()
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
    ($name:ident, $width:literal) => {
        $crate::lanes::operators! { $name:
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

        impl $crate::lanes::Lanes<$width> for $name {
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

use {lanes, operators};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Mask;

    fn f<S: Scalar>(x: S, y: S) -> S {
        let (s, c) = (x * y).sin_cos();
        let far = (x * 40.0 - y).sin_cos();
        let apart = x.lt(y).and(y.lt(S::constant(2.0)).not()).or(c.lt(s));
        let chosen = S::select(apart, far.0, -far.1);
        let sums = (x.exp() * s - c / (y + 2.0)).abs().sqrt();
        sums.mul_add(y, sums) + (x + y).ln() * x.powf(y).max(y) - 1.5
            + chosen * (x.ln().min(-x) - 3.0).exp()
    }

    const X: [f64; 8] = [0.1, 0.7, 2.5, 40.0, 1e-3, 3.3, 0.9, 11.0];
    const Y: [f64; 8] = [1.3, 0.2, 0.9, 0.01, 7.0, 1.1, 2.2, 0.5];

    #[derive(Clone, Copy)]
    struct Bits;

    impl InLanes for Bits {
        type Output = usize;
        fn run<L: Lanes<W>, const W: usize>(self) -> usize {
            let take = |of: [f64; 8]| L::from_array(std::array::from_fn(|i| of[i]));
            let lanes = L::vectorised(|| f(take(X), take(Y)));
            for i in 0..W {
                assert_eq!(lanes.get(i).to_bits(), f(X[i], Y[i]).to_bits(), "lane {i}");
            }
            let truths = std::array::from_fn(|i| i % 3 == 1);
            assert_eq!(L::truths(L::mask(truths)), truths);
            assert!(L::mask(truths).any());
            W
        }
    }

    #[test]
    fn each_lane_has_the_bits_of_the_plain_number_at_every_width() {
        let widths = in_all_lanes(Bits);
        assert_eq!(widths.len(), super::widths().len());
        assert_eq!(widths.last(), Some(&2));
    }
}
