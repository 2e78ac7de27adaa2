//! Vectors of the plane.

use nalgebra::{Matrix2, Vector2};
use scalar::Scalar;

/// A vector of the plane.
pub type Vec2<S> = Vector2<S>;

/// The vector turned by +90°: the velocity of a point `r` from the pivot is `ω turned(r)`.
#[inline]
pub fn turned<S: Scalar>(r: Vec2<S>) -> Vec2<S> {
    Vec2::new(-r.y, r.x)
}

/// Moment of a force about the origin of its arm, r × F.
#[inline]
pub fn moment<S: Scalar>(arm: Vec2<S>, force: Vec2<S>) -> S {
    arm.x * force.y - arm.y * force.x
}

/// The zero vector.
#[inline]
pub fn origin<S: Scalar>() -> Vec2<S> {
    Vec2::new(S::zero(), S::zero())
}

/// Inverse of a 2 × 2 matrix that is known to have one.
#[inline]
pub fn inverse<S: Scalar>(m: &Matrix2<S>) -> Matrix2<S> {
    let determinant = m[(0, 0)] * m[(1, 1)] - m[(0, 1)] * m[(1, 0)];
    let scale = S::one() / determinant;
    Matrix2::new(
        m[(1, 1)] * scale,
        -m[(0, 1)] * scale,
        -m[(1, 0)] * scale,
        m[(0, 0)] * scale,
    )
}

/// `m v`, inlined wherever it stands.
pub fn apply<S: Scalar>(m: &Matrix2<S>, v: Vec2<S>) -> Vec2<S> {
    Vec2::new(
        m[(0, 0)] * v.x + m[(0, 1)] * v.y,
        m[(1, 0)] * v.x + m[(1, 1)] * v.y,
    )
}

/// `a bᵀ`.
#[inline]
pub fn outer<S: Scalar>(a: Vec2<S>, b: Vec2<S>) -> Matrix2<S> {
    Matrix2::new(a.x * b.x, a.x * b.y, a.y * b.x, a.y * b.y)
}

/// A diagonal matrix.
#[inline]
pub fn diagonal<S: Scalar>(x: S, y: S) -> Matrix2<S> {
    Matrix2::new(x, S::zero(), S::zero(), y)
}
