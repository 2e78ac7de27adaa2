//! Every contact law of the list, and reference values of those that have some of their own.

use mechanism::declaration::{Clash, Quantity, Range};
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

/// Composite modulus of steel on steel, E = 207 GPa and ν = 0.3, Pa.
const STEEL: f64 = 207e9 / (2.0 * (1.0 - 0.09));

/// The law `cylinder` of two steel cylinders, 50 mm long.
fn cylinder(clearance: f64) -> Result<ContactLaw, Clash> {
    let entry = CONTACT_LAWS.iter().find(|entry| entry.name == "cylinder");
    let surfaces = Surfaces {
        stiffness: 1.0,
        clearance,
    };
    (entry.unwrap().law)(&surfaces, &[0.05, STEEL, 0.8, 1e-3])
}

#[test]
fn cylinder_has_the_stiffness_and_exponent_of_its_formula() {
    // Pereira, Ramalho and Ambrósio 2011, internal contact, worked out in other software.
    let (stiffness, exponent) = cylinder(1e-4).unwrap().spring();
    assert!(
        (exponent - 1.212_905_174_802_935).abs() < 1e-12,
        "{exponent}"
    );
    assert!(
        (stiffness / 47_768_521_030.503_82 - 1.0).abs() < 1e-12,
        "{stiffness}"
    );
    for (force, depth) in [
        (1e3, 0.466_447_577_966_333_8e-6),
        (8e3, 2.590_421_990_136_693e-6),
        (4e4, 9.764_456_009_020_41e-6),
    ] {
        let found = (force / stiffness).powf(1.0 / exponent);
        assert!((found / depth - 1.0).abs() < 1e-12, "{found:e}");
    }
    // The branches of the exponent meet to seven digits.
    let [below, above] = [0.349_539e-3, 0.349_541e-3].map(|c| cylinder(c).unwrap().spring().1);
    assert!((below - above).abs() < 1e-6, "{below} {above}");
    let (_, wide) = cylinder(1e-3).unwrap().spring();
    assert!((wide - 1.1661).abs() < 1e-12, "{wide}");
}

#[test]
fn cylinder_is_near_johnson() {
    // Johnson 1985: δ = F/(π E* l) (ln(4 π E* l c/F) − 1).
    for clearance in [5e-5, 1e-4, 3e-4] {
        let law = cylinder(clearance).unwrap();
        for force in [1e3, 8e3, 4e4] {
            let rigid = std::f64::consts::PI * STEEL * 0.05;
            let depth = force / rigid * ((4.0 * rigid * clearance / force).ln() - 1.0);
            let found = law.force(depth, 0.0, &ContactMode::apart()).raw / force;
            assert!(
                (0.85..1.14).contains(&found),
                "{clearance} {force}: {found}"
            );
        }
    }
}

#[test]
fn cylinder_is_refused_where_it_was_not_fitted() {
    for clearance in [4.9e-6, 0.0101] {
        assert_eq!(cylinder(clearance).unwrap_err().key, "law");
    }
    // An ideal joint has no contact, whatever its section says.
    assert!(cylinder(0.0).is_ok());
}
