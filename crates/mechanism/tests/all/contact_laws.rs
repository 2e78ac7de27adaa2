//! Every contact law of the list, and reference values of those that have some of their own.

use mechanism::declaration::{Quantity, Range};
use mechanism::joints::contact::{CONTACT_LAWS, ContactLaw, Entry, Surfaces};
use mechanism::mode::ContactMode;

/// The law with a stiffness of 20 GN/m^1.5 and usual values of its parameters.
fn usual(entry: &Entry, clearance: f64) -> ContactLaw {
    let value = |declared: (Quantity, Range)| match declared {
        (_, Range::Rebound) => 0.8,
        (_, Range::FromOne) => 1.5,
        (Quantity::Damping, _) => 2e4,
        (Quantity::Length, _) => 1e-5,
        (Quantity::Velocity, _) => 1e-3,
        (Quantity::Pressure, _) => 1e11,
        other => panic!("{other:?}: say here what is usual"),
    };
    let parameters = entry.declaration.parameters.iter();
    let values: Vec<f64> = parameters.map(|p| value(p.declared())).collect();
    let stiffness = 2e10;
    let surfaces = Surfaces {
        stiffness,
        clearance,
    };
    (entry.law)(&surfaces, &values).unwrap()
}

#[test]
fn at_rest_every_law_is_a_spring_whose_energy_is_the_integral_of_its_force() {
    for entry in CONTACT_LAWS {
        let law = usual(entry, 1e-4);
        let (stiffness, exponent) = law.spring();
        let mode = ContactMode::apart();
        for depth in [1e-7, 1e-6, 2e-5] {
            let force = law.force(depth, 0.0, &mode);
            let expected = stiffness * depth.powf(exponent);
            let name = entry.name;
            assert!((force.raw / expected - 1.0).abs() < 1e-12, "{name}");
            assert_eq!(force.raw, force.elastic, "{name}");
            let energy = expected * depth / (exponent + 1.0);
            let found = law.stored_energy(depth);
            assert!((found / energy - 1.0).abs() < 1e-12, "{name}");
        }
        assert_eq!(law.force(-1e-6, 0.0, &mode).elastic, 0.0);
    }
}
