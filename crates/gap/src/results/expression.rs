//! A force law as a formula.

/// What the terms are in a formula, by their keys.
const SYMBOLS: [(&str, &str); 21] = [
    ("constant", ""),
    ("cos_1", "cos α"),
    ("sin_1", "sin α"),
    ("cos_2", "cos 2α"),
    ("sin_2", "sin 2α"),
    ("cos_3", "cos 3α"),
    ("sin_3", "sin 3α"),
    ("cos_4", "cos 4α"),
    ("sin_4", "sin 4α"),
    ("displacement", "x/r"),
    ("displacement_cubed", "(x/r)³"),
    ("velocity", "v/(1 m/s)"),
    ("velocity_squared", "v|v|/(1 m/s)²"),
    ("velocity_cubed", "(v/(1 m/s))³"),
    ("velocity_sign", "sign v"),
    ("pressure_sign", "p/(1 bar) sign v"),
    ("side_force_sign", "|G tan φ| sign v"),
    ("acceleration", "a/g"),
    ("gas_force", "G"),
    ("big_end_offset", "e_b/c_b"),
    ("small_end_offset", "e_s/c_s"),
];

/// A law in words of the model: its terms by their keys, with their coefficients in N.
///
/// - α is the crank angle since top dead centre.
/// - x, v and a are displacement from mid-stroke, velocity and acceleration of the crosshead toward the head.
/// - p is the head-end pressure, G the gas force over that of 1 bar on the piston, φ the rod's angle.
/// - e/c are the offsets of big and small end over their clearances.
pub fn expression<'a>(terms: impl IntoIterator<Item = (&'a str, f64)>) -> String {
    let mut text = String::new();
    for (key, coefficient) in terms {
        let Some((_, symbol)) = SYMBOLS.iter().find(|(known, _)| *known == key) else {
            continue;
        };
        let sign = match (text.is_empty(), coefficient < 0.0) {
            (true, true) => "-",
            (true, false) => "",
            (false, true) => " - ",
            (false, false) => " + ",
        };
        let size = coefficient.abs();
        // Four digits; more is never known.
        let digits = (3.0 - size.max(1e-9).log10().floor()).clamp(0.0, 12.0) as usize;
        text.push_str(&format!("{sign}{size:.digits$} N"));
        if !symbol.is_empty() {
            text.push_str(&format!(" {symbol}"));
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use input::effects::{Proposal, proposed};

    #[test]
    fn a_law_is_written_in_words_of_the_model() {
        let terms = [
            ("constant", 12.5),
            ("velocity_sign", -120.04),
            ("cos_2", 35.0),
        ];
        assert_eq!(
            expression(terms),
            "12.50 N - 120.0 N sign v + 35.00 N cos 2α"
        );
        assert_eq!(
            expression([("velocity_cubed", -0.25)]),
            "-0.2500 N (v/(1 m/s))³"
        );
        assert_eq!(expression([]), "");
    }

    #[test]
    fn every_term_of_the_effect_has_a_symbol() {
        let keys = proposed(Proposal::ForceLaw)
            .unwrap()
            .amplitudes()
            .map(|p| p.key);
        assert!(keys.eq(SYMBOLS.iter().map(|(key, _)| *key)));
    }
}
