//! The table of what each run and channel says of the effects by itself.

use super::units::usual;
use crate::calibration_page::words;
use gap::ByPart;
use gap::results::parts::{Agreement, Own, Part, Values};
use input::effects::at_path;

/// Digits of a standard error.
const DIGITS: usize = 2;

/// What the table shows, in sentences.
pub(super) fn sentences(parts: &ByPart) -> String {
    let effects: Vec<String> = parts
        .effects
        .iter()
        .map(|label| text::words(label))
        .collect();
    let effects = effects.join(" and ");
    let first = match parts.named {
        true => format!("Whether all recordings ask for the same {effects}."),
        false => format!(
            "Nothing is named. This is the most probable of the effects that were tried: {effects}."
        ),
    };
    format!(
        "{first} Each row is one channel of one run. The gaps are without and with the effect, in times the noise. The other columns give \
         the value that this row alone asks for, ± its standard error: one step from the accepted fit, with all other values of the \
         machine shared by all rows. Rows that agree support the effect. A row that stands apart shows where its law is off, or where \
         something else acts. A dash: the row does not show the value."
    )
}

/// The heading of a column of values.
pub(super) fn heading(values: &Values) -> String {
    let name = name(values);
    match usual(unit(values)).1 {
        "" => name,
        unit => format!("{name} ({})", text::unit(unit)),
    }
}

/// The name of a channel.
pub(super) fn channel(part: &Part) -> String {
    words::column(&part.channel).0
}

/// The value that a part alone asks for.
pub(super) fn own(values: &Values, part: usize) -> String {
    let (factor, _) = usual(unit(values));
    match values.by_part.get(part) {
        Some(Some(Own {
            value,
            standard_error,
        })) => with_error(factor * value, factor * standard_error),
        _ => "–".to_owned(),
    }
}

/// What was fitted to all together.
pub(super) fn together(values: &Values) -> String {
    let (factor, _) = usual(unit(values));
    text::number(factor * values.value, 4)
}

/// Whether the rows agree, in sentences: one for values that can stand for each other, about which they say the same.
pub(super) fn agreements(all: &[Values]) -> Vec<String> {
    let mut found: Vec<(String, Vec<String>)> = Vec::new();
    for values in all {
        let Some(agreement) = &values.agreement else {
            continue;
        };
        let sentence = agreement_of_rows(agreement);
        match found.iter_mut().find(|(known, _)| *known == sentence) {
            Some((_, names)) => names.push(name(values)),
            None => found.push((sentence, vec![name(values)])),
        }
    }
    let sentences = found.into_iter();
    sentences
        .map(|(sentence, names)| format!("{}: {sentence}", names.join(", ")))
        .collect()
}

fn agreement_of_rows(agreement: &Agreement) -> String {
    let chi_squared = text::number(agreement.chi_squared, 3);
    let degrees = text::counted(agreement.degrees, "degree");
    let found = format!("χ² {chi_squared}, {degrees} of freedom");
    match agreement.agree {
        true => format!("the rows agree ({found})."),
        false => format!(
            "the rows differ by more than chance ({found}). The law of the effect is not quite right, it is not the same in all runs and \
             ends, or something else acts as well."
        ),
    }
}

/// The last two parts of a path, and the number of its effect where there are several.
fn name(values: &Values) -> String {
    let key = values.path.rsplit('.').next().unwrap_or_default();
    let index = values
        .path
        .split('.')
        .nth(1)
        .and_then(|index| index.parse::<usize>().ok());
    match index {
        Some(index) if index > 0 => format!("{} of effect {}", text::words(key), index + 1),
        _ => text::words(key),
    }
}

/// The SI unit of a value; empty for a plain number.
fn unit(values: &Values) -> &'static str {
    at_path(&values.path).map_or("", |parameter| parameter.unit)
}

/// A value with its standard error, to as many digits as that has.
fn with_error(value: f64, error: f64) -> String {
    let ratio = (value / error).abs();
    let digits = match ratio.is_finite() && ratio > 1.0 {
        true => (ratio.log10().floor() as usize + DIGITS).min(7),
        false => DIGITS,
    };
    format!(
        "{} ± {}",
        text::number(value, digits),
        text::number(error, DIGITS)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(path: &str, own: Option<Own>) -> Values {
        Values {
            path: path.to_owned(),
            value: 1.0,
            by_part: vec![own],
            agreement: None,
        }
    }

    #[test]
    fn values_that_can_stand_for_each_other_have_one_sentence() {
        let with = |path: &str, chi_squared: f64, degrees: usize| Values {
            agreement: Some(Agreement {
                chi_squared,
                degrees,
                agree: chi_squared < 5.0,
            }),
            ..values(path, None)
        };
        let all = [
            with("effects.0.thermal_clearance.change", 72.1, 11),
            with("effects.0.thermal_clearance.exponent", 72.1, 11),
            values("effects.0.thermal_clearance.at_speed", None),
            with("effects.1.sensor_gain.error", 0.5, 1),
        ];
        let [first, second] = &agreements(&all)[..] else {
            panic!("two sentences");
        };
        assert!(first.starts_with("change, exponent: the rows differ by more than chance (χ² 72.1, 11\u{a0}degrees of freedom)."));
        assert_eq!(
            second,
            "error of effect 2: the rows agree (χ² 0.5, 1\u{a0}degree of freedom)."
        );
    }

    #[test]
    fn a_value_has_the_digits_of_its_error() {
        let own = |value, standard_error| Own {
            value,
            standard_error,
        };
        let loss = values(
            "effects.0.valve_loss.suction",
            Some(own(0.181_23, 0.004_12)),
        );
        assert_eq!(super::own(&loss, 0), "0.181 ± 0.0041");
        assert_eq!(heading(&loss), "suction");
        let held = values("effects.1.suction_unloading.held", Some(own(1.0, 0.1)));
        assert_eq!(super::own(&held, 0), "57 ± 5.7");
        assert_eq!(heading(&held), "held of effect 2 (deg)");
        assert_eq!(super::own(&held, 1), "–");
    }
}
