//! Cylinder in a cylinder (Pereira, Ramalho and Ambrósio 2011, A critical overview of internal and
//! external cylinder contact force models): the internal form, with the clearance in the stiffness and
//! in the exponent.
//!
//! ```text
//! F = (a c + b) l E*/c δⁿ (1 + χ δ̇/v₀)           c, δ, l in mm, E* in MPa, F in N
//! a = 0.965,  b = 0.0965
//! n = Y c^(−0.005),  Y = 1.51 (ln 1000 c)^(−0.151)     0.005 ≤ c < 0.34954 mm
//!                    Y = 0.0151 c + 1.151               0.34954 ≤ c ≤ 10 mm
//! ```
//!
//! c is the radial clearance, l the length of the contact, 1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂. The
//! damping factor is that of Lankarani and Nikravesh 1990, χ = 3 (1 − e²)/4. Within its range the law
//! is near Johnson's (1985), without his iteration: 0.85 to 1.14 of his force for steel.

use super::restitution::{Family, Restitution};
use super::{Surfaces, contact_law};
use crate::declaration::Clash;
use scalar::Scalar;

/// The parameters of the law: those of a stiffness with a coefficient of restitution.
pub type Cylinder<S = f64> = Restitution<S>;

contact_law! {
    /// Cylinder in a cylinder (Pereira, Ramalho and Ambrósio 2011): stiffness and exponent follow from
    /// the length of the contact, the materials and the clearance.
    Cylinder, by hand {
        /// Length of the contact along the journal.
        length: Length(AboveZero);
        /// Composite modulus E* of the two bodies: 1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂.
        modulus: Pressure(AboveZero);
        /// Coefficient of restitution.
        restitution: Number(Rebound);
        /// Smallest approach speed that the damping is computed with; 1 mm/s where it is left out.
        slowest_approach: Velocity(AboveZero), or 1e-3;
    }
}

/// Clearances for which the law was fitted, mm, and where its second branch begins.
const FITTED: [f64; 2] = [0.005, 10.0];
const BRANCH: f64 = 0.34954;

/// The parameters with these values. In an ideal joint, where the law does not act, they are those of
/// the smallest clearance.
pub(super) fn law(surfaces: &Surfaces, values: &[f64]) -> Result<Cylinder, Clash> {
    let [length, modulus, restitution, slowest_approach] = *values else {
        unreachable!("the declaration has four parameters")
    };
    let [least, most] = FITTED;
    let clearance = match surfaces.clearance {
        0.0 => least,
        clearance => clearance * 1e3,
    };
    if !(least..=most).contains(&clearance) {
        let expected = "clearance from 5 um to 10 mm, for which the law cylinder was fitted";
        return Err(Clash {
            key: "law",
            expected: format!("another law, or a {expected}"),
        });
    }
    let (stiffness, exponent) = spring(clearance, length * 1e3, modulus * 1e-6);
    Ok(Restitution {
        // N/mmⁿ to N/mⁿ.
        stiffness: stiffness * Scalar::powf(1e3, exponent),
        exponent,
        restitution,
        slowest_approach,
    })
}

/// Stiffness, N/mmⁿ, and exponent at a clearance and length in mm and a modulus in MPa.
fn spring(clearance: f64, length: f64, modulus: f64) -> (f64, f64) {
    let y = if clearance < BRANCH {
        1.51 * Scalar::powf(Scalar::ln(1e3 * clearance), -0.151)
    } else {
        0.0151 * clearance + 1.151
    };
    let exponent = y * Scalar::powf(clearance, -0.005);
    let stiffness = (0.965 * clearance + 0.0965) * length * modulus / clearance;
    (stiffness, exponent)
}

impl Family for Law {
    /// χ = 3 (1 − e²) / 4.
    #[inline(always)]
    fn hysteresis<S: Scalar>(restitution: S) -> S {
        (S::one() - restitution * restitution) * 0.75
    }
}
