//! Contact stiffness from materials and radii, against published numbers.

use mechanism::joints::stiffness::{Material, conformal, equation_5};

const STEEL: Material = Material {
    youngs_modulus: 207e9,
    poisson_ratio: 0.3,
};

#[test]
fn equation_5_gives_the_stiffness_of_the_single_stage_machine() {
    // MODEL.md section 5: 2.40e10 and 2.00e10 "with these radii, rounded".
    let big = equation_5([STEEL; 2], [0.050, 0.0501]);
    let small = equation_5([STEEL; 2], [0.035, 0.0351]);
    assert!((big / 2.40e10 - 1.0).abs() < 5e-3, "{big:e}");
    assert!((small / 2.00e10 - 1.0).abs() < 5e-3, "{small:e}");
}

#[test]
fn conformal_gives_the_stiffness_of_the_ravn_slider_crank() {
    // Flores' papers quote 6.61e10 for 9.5 mm in 10 mm, steel.
    let k = conformal([STEEL; 2], 0.0095, 0.0005);
    assert!((k / 6.6102e10 - 1.0).abs() < 1e-4, "{k:e}");
}
