//! Materials of contacts: their stiffness against Hertz's own formula.

use mechanism::joints::materials::MATERIALS;
use mechanism::joints::stiffness::{Material, composite_modulus, conformal};

fn named(name: &str) -> Material {
    MATERIALS
        .iter()
        .find(|entry| entry.name == name)
        .unwrap()
        .material
}

#[test]
fn the_composite_modulus_is_that_of_two_steels() {
    // Steel on steel of 207 GPa and 0.3: E* = 113.7 GPa.
    let modulus = composite_modulus([named("steel"); 2]);
    assert!((modulus / 113.7e9 - 1.0).abs() < 1e-3, "{modulus:e}");
}

#[test]
fn steel_in_bronze_has_the_stiffness_of_hertz() {
    // K = 4/3 E* √R with R = R₁R₂/(R₂ − R₁) (Johnson 1985, Contact Mechanics, section 4.2).
    let bodies = [named("steel"), named("bronze")];
    let (journal, clearance) = (0.05, 1e-4);
    let modulus = 1.0 / ((1.0 - 0.3 * 0.3) / 207e9 + (1.0 - 0.349 * 0.349) / 111e9);
    let hertz = 4.0 / 3.0 * modulus * f64::sqrt(0.05 * 0.0501 / 1e-4);
    let stiffness = conformal(bodies, journal, clearance);
    assert!(
        (stiffness / hertz - 1.0).abs() < 1e-12,
        "{stiffness:e} {hertz:e}"
    );
    assert!((modulus / composite_modulus(bodies) - 1.0).abs() < 1e-12);
}
