//! Corrected values of the data sheet.

use super::verdict::{quantity, size};
use super::words;
use calibrate::results::Correction;

/// The corrections in sentences.
pub(super) fn sentences(corrections: &[Correction]) -> Vec<String> {
    let name = |correction: &Correction| words::path(&correction.path);
    let applied = corrections.iter().filter(|correction| correction.applied);
    let mut said: Vec<String> = applied
        .map(|correction| {
            format!(
                "The model explains the recordings if the {} is {} in place of {}. The calibrated machine and the other values on \
                 this page have this correction.",
                name(correction),
                quantity(correction.value, &correction.unit),
                stated(correction),
            )
        })
        .collect();
    if said.is_empty() && !corrections.is_empty() {
        let names: Vec<String> = corrections.iter().map(name).collect();
        said.push(format!(
            "A correction of any one of these values would explain the recordings: {}. The calibrated machine corrects \
             none of them; measure them.",
            names.join(", ")
        ));
    }
    said
}

fn stated(correction: &Correction) -> String {
    let quantity = |nominal| quantity(nominal, &correction.unit);
    match correction.nominal {
        Some(nominal) => format!("the stated {}", quantity(nominal)),
        None => "no stated value".to_owned(),
    }
}

/// The cells of a row: stated, found, interval, misfit, probability.
pub(super) fn row(correction: &Correction) -> [String; 5] {
    let said = |value: f64| quantity(value, &correction.unit);
    let interval = correction.interval().map_or_else(
        || "not identifiable".to_owned(),
        |[low, high]| format!("{} to {}", said(low), said(high)),
    );
    [
        correction.nominal.map_or_else(|| "–".to_owned(), said),
        said(correction.value),
        interval,
        size(correction.misfit),
        text::decimal(correction.probability, 2),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_value_is_corrected_and_rivals_are_not() {
        let of = |path: &str, applied| Correction {
            path: path.into(),
            unit: "kg".into(),
            nominal: Some(18.54),
            value: 18.0,
            low: Some(17.99),
            high: Some(18.01),
            probability: 0.5,
            misfit: 0.98,
            applied,
        };
        let one = sentences(&[of("crosshead.mass", true)]);
        assert_eq!(one.len(), 1);
        assert!(
            one[0].contains("18\u{a0}kg in place of the stated 18.54\u{a0}kg"),
            "{one:?}"
        );
        let rivals = sentences(&[of("crosshead.mass", false), of("rod.mass", false)]);
        assert!(rivals[0].contains("crosshead mass, rod mass"), "{rivals:?}");
        assert!(sentences(&[]).is_empty());
        assert_eq!(row(&of("rod.mass", false))[3..], ["0.98", "0.50"]);
    }
}
