//! What came out, in sentences.

use super::{CalibrationPage, Estimate, Known, Misfit, words};
use crate::text;

/// A misfit up to here is said to be noise: a calibration takes it for that, too.
const NOISE: f64 = 1.15;
/// A misfit that shrinks by less than this share has come no closer: nobody sees a twentieth in a figure.
const CLOSER: f64 = 0.05;
/// Estimates that are correlated more than this are told only together.
const TOGETHER: f64 = 0.9;

/// The one sentence at the top.
pub(super) fn verdict(page: &CalibrationPage) -> String {
    let shrank = |misfit: Misfit| {
        format!(
            "{} times the noise (before: {})",
            size(misfit.after),
            size(misfit.before)
        )
    };
    let held_out = page.held_out.map_or_else(String::new, |misfit| {
        format!(
            "; the runs that were held back, and that it had not seen, it predicts to {}",
            shrank(misfit)
        )
    });
    let how = match page.fitted.after {
        after if after <= NOISE => {
            "agrees with the recordings as well as their noise allows: what is left is"
        }
        after if after < (1.0 - CLOSER) * page.fitted.before => {
            "is closer to the recordings than the nominal one, but something is left that is no noise:"
        }
        _ => "is no closer to the recordings than the nominal one: what is left is",
    };
    format!(
        "The calibrated model {how} {}{held_out}.",
        shrank(page.fitted)
    )
}

/// What the reader should be warned of.
pub(super) fn warnings(page: &CalibrationPage) -> Vec<String> {
    let mut warnings = Vec::new();
    if !page.complete {
        warnings.push(
            "The search was stopped before its end. These are the best values it had found; the bounds are those around them."
                .to_owned(),
        );
    }
    if !page.adequate && !page.runs.is_empty() {
        warnings.push(
            "The model is wrong: it does not explain the recordings, so that no interval is known for any parameter. Do not \
             rely on the values below. The machine does something that the model does not have, or a value of its data sheet \
             is wrong, or a better fit was not found: explain-gap looks for a missing effect; other parameters, wider bounds \
             or more evaluations may help."
                .to_owned(),
        );
    } else if page.fitted.after > NOISE {
        warnings.push(
            "No choice of these parameters that was tried explains the recordings to within their noise. Either the machine \
             does something that the model does not have, or a better fit was not found: try other parameters, wider bounds \
             or more evaluations. The bounds were widened by what is left."
                .to_owned(),
        );
    }
    if let Some(held_out) = page.held_out
        && page.fitted.after <= NOISE
        && held_out.after > NOISE * page.fitted.after.max(1.0)
    {
        warnings.push(
            "The runs that were held back are predicted less well than the fitted ones: do not rely on the model far from the \
             conditions of the fitted runs."
                .to_owned(),
        );
    }
    warnings
}

/// A misfit as a number of a few digits.
pub(crate) fn size(misfit: f64) -> String {
    text::decimal(misfit, if misfit < 10.0 { 2 } else { 0 })
}

/// What was found of each parameter that is told, as a mechanic would say it.
pub(super) fn found(estimates: &[Estimate]) -> Vec<String> {
    let say = |estimate: &Estimate| {
        let name = text::capitalised(&words::path(&estimate.path));
        if estimate.known == Known::Fitted {
            let value = quantity(estimate.value, &estimate.unit);
            return Some(format!(
                "{name}: {value} in a model that is wrong; no interval is known."
            ));
        }
        let [low, high] = estimate.interval()?;
        if !estimate.is_ratio() {
            let [value, low, high] =
                [estimate.value, low, high].map(|value| quantity(value, &estimate.unit));
            return Some(format!("{name}: {value} ({low} to {high})."));
        }
        let change = |value: f64| value / estimate.nominal - 1.0;
        let holds = low.min(high) <= estimate.nominal && estimate.nominal <= low.max(high);
        let percent = percent(change(estimate.value).abs());
        let said = match change(estimate.value) {
            _ if holds => "its nominal value, as far as the recordings tell".to_owned(),
            up if up > 0.0 => format!("{percent} above its nominal value"),
            _ => format!("{percent} below its nominal value"),
        };
        let half = (high - low).abs() / 2.0 / estimate.value.abs();
        let edge = match estimate.at_bound {
            true => " It lies at the edge of its search range: give it wider bounds.",
            false => "",
        };
        let half = self::percent(half);
        Some(format!("{name}: {said}, known to ±{half}.{edge}"))
    };
    estimates.iter().filter_map(say).collect()
}

fn percent(share: f64) -> String {
    text::quantity(100.0 * round(share), "%")
}

/// To two significant digits.
fn round(share: f64) -> f64 {
    format!("{share:.1e}").parse().unwrap_or(share)
}

/// What is not told, and why.
pub(super) fn untold(estimates: &[Estimate]) -> Vec<String> {
    let say = |estimate: &Estimate| {
        let why = if estimate.reason.is_empty() {
            "the recordings look the same over more than half of its range, the other parameters making up for it"
        } else {
            &estimate.reason
        };
        format!(
            "{} keeps its nominal value {}: {why}.",
            text::capitalised(&words::path(&estimate.path)),
            quantity(estimate.nominal, &estimate.unit),
        )
    };
    let not_told = estimates.iter().filter(|e| !e.is_identifiable());
    not_told.map(say).collect()
}

/// What stands in the place of parameters that are not identifiable, where there are none.
pub(super) fn none_untold(page: &CalibrationPage) -> &'static str {
    match (page.parameters.is_empty(), page.adequate) {
        (true, _) => "No parameter was fitted.",
        (_, true) => "Every parameter that was fitted is identifiable.",
        (_, false) => {
            "A model that does not explain the recordings cannot tell which parameters they determine."
        }
    }
}

/// The pairs that are told only together.
pub(super) fn together(page: &CalibrationPage) -> Vec<String> {
    let name = |i: usize| words::path(&page.parameters[i].path);
    let count = page.parameters.len().min(page.correlations.len());
    let mut pairs: Vec<(f64, String)> = Vec::new();
    for i in 0..count {
        for j in 0..i.min(page.correlations[i].len()) {
            let r = page.correlations[i][j];
            if r.abs() > TOGETHER {
                let change = if r > 0.0 {
                    "rise together"
                } else {
                    "trade off"
                };
                let number = text::decimal(r, 2);
                pairs.push((
                    r,
                    format!("{} and {} {change} ({number})", name(j), name(i)),
                ));
            }
        }
    }
    pairs.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
    pairs.into_iter().map(|(_, said)| said).collect()
}

/// A value with its unit, to four digits.
pub(super) fn quantity(value: f64, unit: &str) -> String {
    let (scale, unit) = text::readable_unit(value, unit);
    let number = text::number(value * scale, 4);
    if unit.is_empty() {
        return number;
    }
    format!("{number}\u{a0}{}", text::unit(unit))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibration_page::Run;

    fn page(fitted: [f64; 2], held_out: Option<[f64; 2]>) -> CalibrationPage {
        let misfit = |[before, after]: [f64; 2]| Misfit { before, after };
        CalibrationPage {
            complete: true,
            adequate: fitted[1] <= 1.5,
            runs: vec![Run::default()],
            fitted: misfit(fitted),
            held_out: held_out.map(misfit),
            ..CalibrationPage::default()
        }
    }

    #[test]
    fn the_sentence_at_the_top_follows_the_misfits() {
        let good = page([14.3, 1.04], Some([15.2, 1.12]));
        assert_eq!(
            verdict(&good),
            "The calibrated model agrees with the recordings as well as their noise allows: what is left is 1.04 times the \
             noise (before: 14); the runs that were held back, and that it had not seen, it predicts to 1.12 times the noise \
             (before: 15)."
        );
        assert!(warnings(&good).is_empty());
        let poor = page([14.0, 4.0], None);
        assert!(verdict(&poor).contains("something is left that is no noise"));
        assert_eq!(warnings(&poor).len(), 1);
        assert!(warnings(&poor)[0].contains("The model is wrong"));
        assert!(none_untold(&good).contains("No parameter"));
        assert!(verdict(&page([2.0, 2.0], None)).contains("no closer"));
        // Less than anybody sees: 204 before and after.
        assert!(verdict(&page([204.3, 203.9], None)).contains("no closer"));
        let narrow = page([14.0, 1.0], Some([14.0, 9.0]));
        assert!(warnings(&narrow)[0].contains("held back"));
        let stopped = CalibrationPage {
            complete: false,
            ..good
        };
        assert!(warnings(&stopped)[0].contains("stopped"));
    }

    #[test]
    fn what_was_found_is_said_against_the_nominal_values() {
        let of = |value: f64, known| Estimate {
            path: "joints.big_end.contact.stiffness".into(),
            unit: "N/m^1.5".into(),
            nominal: 2e10,
            value,
            known,
            ..Estimate::default()
        };
        let found = found(&[
            of(1.6e10, Known::Within([1.52e10, 1.68e10])),
            of(2.1e10, Known::Within([1.9e10, 2.3e10])),
            of(1.6e10, Known::Fitted),
            of(2e10, Known::Nothing),
        ]);
        assert_eq!(
            found,
            [
                "Big end contact stiffness: 20\u{a0}% below its nominal value, known to ±5\u{a0}%.",
                "Big end contact stiffness: its nominal value, as far as the recordings tell, known to ±9.5\u{a0}%.",
                "Big end contact stiffness: 1.6 × 10¹⁰\u{a0}N/m^1.5 in a model that is wrong; no interval is known.",
            ]
        );
        let untold = untold(&[of(2e10, Known::Nothing)]);
        assert!(
            untold[0].starts_with(
                "Big end contact stiffness keeps its nominal value 2 × 10¹⁰\u{a0}N/m^1.5: the"
            ),
            "{}",
            untold[0]
        );
    }
}
