//! Elastic constants of the materials that pins, bushes and bearing shells are made of.
//!
//! Sources: Budynas and Nisbett, Shigley's Mechanical Engineering Design, Table A–5; for white metal makeitfrom.com,
//! ASTM B23 grade 2; steel as in both papers (Table A–5: 207 GPa, 0.292). Grades of one material differ by some
//! per cent, those of cast iron by up to 30 %.

use super::stiffness::Material;

/// A material of the list.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// Its name in the machine file.
    pub name: &'static str,
    /// Which material it is.
    pub words: &'static str,
    /// Its elastic constants.
    pub material: Material,
}

const fn entry(
    name: &'static str,
    words: &'static str,
    youngs_modulus: f64,
    poisson_ratio: f64,
) -> Entry {
    Entry {
        name,
        words,
        material: Material {
            youngs_modulus,
            poisson_ratio,
        },
    }
}

/// The materials that have names.
pub const MATERIALS: [Entry; 7] = [
    entry("steel", "carbon and low-alloy steel", 207e9, 0.3),
    entry("stainless_steel", "stainless steel, 18-8", 190e9, 0.305),
    entry("cast_iron", "grey cast iron", 100e9, 0.211),
    entry("bronze", "phosphor bronze", 111e9, 0.349),
    entry("brass", "brass", 106e9, 0.324),
    entry("aluminium", "aluminium alloys", 71.7e9, 0.333),
    entry(
        "white_metal",
        "tin-based white metal (Babbitt), as thick as the contact is wide; a thin lining is as stiff as its shell",
        53e9,
        0.35,
    ),
];
