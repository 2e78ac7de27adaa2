//! How contacts follow their clearance, against the equations by hand.

use mechanism::joints::clearance_relation::Relation;
use mechanism::joints::contact::{ContactLaw, Impact, KelvinVoigt};

const CLEARANCES: [f64; 2] = [1e-4, 3e-4];

fn impact() -> ContactLaw {
    ContactLaw::Impact(Impact {
        stiffness: 2e10,
        exponent: 1.5,
        damping: 2e4,
        depth: 1e-5,
    })
}

/// Stiffness, damping and depth of IMPACT with a journal of 35 mm, from 0.1 to 0.3 mm, as
/// factors.
fn factors(relation: Relation) -> [f64; 3] {
    let ContactLaw::Impact(law) = impact().at_clearance(&relation, 0.035, CLEARANCES) else {
        panic!("another law")
    };
    [law.stiffness / 2e10, law.damping / 2e4, law.depth / 1e-5]
}

fn assert_near(found: [f64; 3], expected: [f64; 3]) {
    for (found, expected) in found.into_iter().zip(expected) {
        assert!((found / expected - 1.0).abs() < 1e-8, "{found} {expected}");
    }
}

#[test]
fn the_stiffness_of_equation_5_hardly_depends_on_the_clearance_and_its_damping_does() {
    // R₁ = 35 mm, R₂ = 35.1 and 35.3 mm: R₁R₂/(R₁ + R₂) = 1228.5/70.1 and 1235.5/70.3 mm.
    let stiffness = ((1235.5 / 70.3) / (1228.5 / 70.1_f64)).sqrt();
    assert!((stiffness - 1.001_417_4).abs() < 1e-7, "{stiffness}");
    let damping = (12_355.0 / 3.0 / 12_285.0_f64).powf(0.2);
    assert!((damping - 3_f64.powf(-0.2)).abs() < 1e-3, "{damping}");
    assert_near(factors(Relation::Equation5), [stiffness, damping, 1.0]);
}

#[test]
fn conformal_follows_the_root_of_the_clearance() {
    // R₁R₂/(R₂ − R₁) = 12 285 and 12 355/3 mm: √(1/3) but for 0.3 %.
    let stiffness = (12_355.0 / 3.0 / 12_285.0_f64).sqrt();
    let damping = stiffness.powf(0.4);
    assert!((damping - 3_f64.powf(-0.2)).abs() < 1e-3, "{damping}");
    assert_near(
        factors(Relation::Conformal),
        [stiffness, damping, 1.0 / damping],
    );
}

#[test]
fn powers_are_taken_as_they_are() {
    let relation = Relation::Powers {
        stiffness: -0.5,
        damping: -0.25,
        depth: 0.0,
    };
    let expected = [1.0 / 3_f64.sqrt(), 1.0 / 3_f64.sqrt().sqrt(), 1.0];
    assert_near(factors(relation), expected);
}

#[test]
fn nothing_changes_at_the_same_clearance_or_by_a_constant_relation() {
    let constant = impact().at_clearance(&Relation::Constant, 0.035, CLEARANCES);
    assert_eq!(constant, impact());
    for relation in [Relation::Equation5, Relation::Conformal] {
        assert_eq!(impact().at_clearance(&relation, 0.035, [2e-4; 2]), impact());
    }
}

#[test]
fn a_linear_spring_keeps_its_damping_ratio() {
    let law = KelvinVoigt {
        stiffness: 2e8,
        damping: 1e3,
    };
    let ratio = |law: &KelvinVoigt| law.damping / law.stiffness.sqrt();
    let before = ratio(&law);
    let law = ContactLaw::KelvinVoigt(law);
    let ContactLaw::KelvinVoigt(law) = law.at_clearance(&Relation::Conformal, 0.035, CLEARANCES)
    else {
        panic!("another law")
    };
    assert!((law.stiffness / 2e8 - 1.0).abs() > 0.4);
    assert!((ratio(&law) / before - 1.0).abs() < 1e-12);
}
