//! Vectors and matrices of the plane.
//!
//! Ours rather than nalgebra's, whose operators are loops over matrices of any size: all that the
//! right-hand side does must be inlined for lanes to be fast ([`Scalar::vectorised`]).

use scalar::Scalar;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// A vector of the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vec2<S> {
    /// Along x.
    pub x: S,
    /// Along y.
    pub y: S,
}

impl<S: Scalar> Vec2<S> {
    /// The vector with these components.
    #[inline(always)]
    pub fn new(x: S, y: S) -> Self {
        Self { x, y }
    }

    /// The scalar product.
    #[inline(always)]
    pub fn dot(&self, other: &Self) -> S {
        self.x.mul_add(other.x, self.y * other.y)
    }

    /// `self * by + plus`, each component rounded once.
    #[inline(always)]
    pub fn mul_add(self, by: S, plus: Self) -> Self {
        Self::new(self.x.mul_add(by, plus.x), self.y.mul_add(by, plus.y))
    }

    /// The length.
    #[inline(always)]
    pub fn norm(&self) -> S {
        self.dot(self).sqrt()
    }
}

impl<S: Scalar> Add for Vec2<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y)
    }
}

impl<S: Scalar> Sub for Vec2<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y)
    }
}

impl<S: Scalar> Neg for Vec2<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y)
    }
}

impl<S: Scalar> Mul<S> for Vec2<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, by: S) -> Self {
        Self::new(self.x * by, self.y * by)
    }
}

impl<S: Scalar> Div<S> for Vec2<S> {
    type Output = Self;
    /// One division: they take long.
    #[inline(always)]
    fn div(self, by: S) -> Self {
        self * (S::one() / by)
    }
}

impl<S: Scalar> AddAssign for Vec2<S> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<S: Scalar> SubAssign for Vec2<S> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

/// A 2 × 2 matrix, as its rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mat2<S>(pub [Vec2<S>; 2]);

impl<S: Scalar> Mat2<S> {
    #[inline(always)]
    pub fn transpose(&self) -> Self {
        let Self([a, b]) = *self;
        Self([Vec2::new(a.x, b.x), Vec2::new(a.y, b.y)])
    }

    /// The inverse of a matrix that is known to have one.
    #[inline(always)]
    pub fn inverse(&self) -> Self {
        let Self([a, b]) = *self;
        let scale = S::one() / moment(a, b);
        Self([
            Vec2::new(b.y * scale, -a.y * scale),
            Vec2::new(-b.x * scale, a.x * scale),
        ])
    }
}

impl<S: Scalar> Mul<Vec2<S>> for Mat2<S> {
    type Output = Vec2<S>;
    #[inline(always)]
    fn mul(self, v: Vec2<S>) -> Vec2<S> {
        Vec2::new(self.0[0].dot(&v), self.0[1].dot(&v))
    }
}

impl<S: Scalar> Mul for Mat2<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let Self([first, second]) = other.transpose();
        let Self([a, b]) = self;
        Self([
            Vec2::new(a.dot(&first), a.dot(&second)),
            Vec2::new(b.dot(&first), b.dot(&second)),
        ])
    }
}

impl<S: Scalar> Mul<S> for Mat2<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, by: S) -> Self {
        Self([self.0[0] * by, self.0[1] * by])
    }
}

impl<S: Scalar> Add for Mat2<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self([self.0[0] + other.0[0], self.0[1] + other.0[1]])
    }
}

impl<S: Scalar> Sub for Mat2<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self([self.0[0] - other.0[0], self.0[1] - other.0[1]])
    }
}

/// The vector turned by +90°: the velocity of a point `r` from the pivot is `ω turned(r)`.
#[inline(always)]
pub fn turned<S: Scalar>(r: Vec2<S>) -> Vec2<S> {
    Vec2::new(-r.y, r.x)
}

/// Moment of a force about the origin of its arm, r × F.
#[inline(always)]
pub fn moment<S: Scalar>(arm: Vec2<S>, force: Vec2<S>) -> S {
    arm.x.mul_add(force.y, -(arm.y * force.x))
}

/// The zero vector.
#[inline(always)]
pub fn origin<S: Scalar>() -> Vec2<S> {
    Vec2::new(S::zero(), S::zero())
}

/// `a bᵀ`.
#[inline(always)]
pub(crate) fn outer<S: Scalar>(a: Vec2<S>, b: Vec2<S>) -> Mat2<S> {
    Mat2([b * a.x, b * a.y])
}

/// A diagonal matrix.
#[inline(always)]
pub(crate) fn diagonal<S: Scalar>(x: S, y: S) -> Mat2<S> {
    Mat2([Vec2::new(x, S::zero()), Vec2::new(S::zero(), y)])
}
