//! Contact stiffness from materials and radii.
//!
//! Both forms are Hertz's point contact, `K = 4 √R / (3 π (h₁ + h₂))` with
//! `h = (1 − ν²)/(π E)`; they differ in the effective radius R.

use scalar::Scalar;

/// Elastic constants of one body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material<S = f64> {
    /// Young's modulus E, Pa.
    pub youngs_modulus: S,
    /// Poisson's ratio ν.
    pub poisson_ratio: S,
}

impl<S: Scalar> Material<S> {
    /// h = (1 − ν²)/(π E), 1/Pa.
    fn compliance(&self) -> S {
        (S::one() - self.poisson_ratio * self.poisson_ratio)
            / (self.youngs_modulus * std::f64::consts::PI)
    }
}

/// Eq. (5) of both papers: R = R₁R₂/(R₁ + R₂), N/m^1.5.
///
/// This is the radius of two convex bodies. The papers use it for a pin in an eye. There it gives a
/// stiffness some 30 times too small and almost independent of the clearance. It is here to reproduce
/// the papers.
pub fn equation_5<S: Scalar>(bodies: [Material<S>; 2], radii: [S; 2]) -> S {
    point_contact(bodies, effective_radius_eq5(radii))
}

pub(super) fn effective_radius_eq5<S: Scalar>(radii: [S; 2]) -> S {
    radii[0] * radii[1] / (radii[0] + radii[1])
}

/// The conformal form: a journal in a bearing has R = R_j R_b/(R_b − R_j), so that K falls with
/// the clearance like c^(−1/2). N/m^1.5.
pub fn conformal<S: Scalar>(bodies: [Material<S>; 2], journal: S, clearance: S) -> S {
    point_contact(bodies, effective_radius_conformal(journal, clearance))
}

pub(super) fn effective_radius_conformal<S: Scalar>(journal: S, clearance: S) -> S {
    journal * (journal + clearance) / clearance
}

/// Composite modulus E* of two bodies, 1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂ (Johnson 1985, section 4.2). Pa.
pub fn composite_modulus<S: Scalar>(bodies: [Material<S>; 2]) -> S {
    let compliance = bodies[0].compliance() + bodies[1].compliance();
    S::one() / (compliance * std::f64::consts::PI)
}

fn point_contact<S: Scalar>(bodies: [Material<S>; 2], radius: S) -> S {
    let compliance = bodies[0].compliance() + bodies[1].compliance();
    radius.sqrt() * 4.0 / (compliance * (3.0 * std::f64::consts::PI))
}
