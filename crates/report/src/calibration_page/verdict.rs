//! What came out, in sentences.

use super::{CalibrationPage, Misfit, Parameter, words};
use crate::text;
use calibrate::results::Known;

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
    let fitted = page.fitted();
    let held_out = page.held_out().map_or_else(String::new, |misfit| {
        format!(
            "; the runs that were held back, and that it had not seen, it predicts to {}",
            shrank(misfit)
        )
    });
    let how = match fitted.after {
        after if after <= NOISE => {
            "agrees with the recordings as well as their noise allows: what is left is"
        }
        after if after < (1.0 - CLOSER) * fitted.before => {
            "is closer to the recordings than the nominal one, but something is left that is no noise:"
        }
        _ => "is no closer to the recordings than the nominal one: what is left is",
    };
    format!("The calibrated model {how} {}{held_out}.", shrank(fitted))
}

/// What the reader should be warned of.
pub(super) fn warnings(page: &CalibrationPage) -> Vec<String> {
    let mut warnings = Vec::new();
    let fitted = page.fitted().after;
    if !page.results.complete {
        warnings.push(
            "The search was stopped before its end. These are the best values it had found; the bounds are those around them."
                .to_owned(),
        );
    }
    if !page.results.model_is_adequate && !page.runs.is_empty() {
        warnings.push(
            "The model is wrong: it does not explain the recordings, so that no interval is known for any parameter. Do not \
             rely on the values below. The machine does something that the model does not have, or a value of its data sheet \
             is wrong, or a better fit was not found: explain-gap looks for a missing effect; other parameters, wider bounds \
             or more evaluations may help."
                .to_owned(),
        );
    } else if fitted > NOISE {
        warnings.push(
            "No choice of these parameters that was tried explains the recordings to within their noise. Either the machine \
             does something that the model does not have, or a better fit was not found: try other parameters, wider bounds \
             or more evaluations. The bounds were widened by what is left."
                .to_owned(),
        );
    }
    if let Some(held_out) = page.held_out()
        && fitted <= NOISE
        && held_out.after > NOISE * fitted.max(1.0)
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
pub(super) fn found(parameters: &[Parameter]) -> Vec<String> {
    let say = |parameter: &Parameter| {
        let Parameter { path, unit, found } = *parameter;
        let name = text::capitalised(&words::path(path));
        let [low, high] = match found.known() {
            Known::Within(interval) => interval,
            Known::Fitted => {
                let value = quantity(found.value, unit);
                return Some(format!(
                    "{name}: {value} in a model that is wrong; no interval is known."
                ));
            }
            Known::Nothing => return None,
        };
        if !parameter.is_ratio() {
            let [value, low, high] = [found.value, low, high].map(|value| quantity(value, unit));
            return Some(format!("{name}: {value} ({low} to {high})."));
        }
        let change = |value: f64| value / found.nominal - 1.0;
        let holds = low.min(high) <= found.nominal && found.nominal <= low.max(high);
        let percent = percent(change(found.value).abs());
        let said = match change(found.value) {
            _ if holds => "its nominal value, as far as the recordings tell".to_owned(),
            up if up > 0.0 => format!("{percent} above its nominal value"),
            _ => format!("{percent} below its nominal value"),
        };
        let half = (high - low).abs() / 2.0 / found.value.abs();
        let edge = match found.at_bound {
            true => " It lies at the edge of its search range: give it wider bounds.",
            false => "",
        };
        let half = self::percent(half);
        Some(format!("{name}: {said}, known to ±{half}.{edge}"))
    };
    parameters.iter().filter_map(say).collect()
}

fn percent(share: f64) -> String {
    text::quantity(100.0 * round(share), "%")
}

/// To two significant digits.
fn round(share: f64) -> f64 {
    format!("{share:.1e}").parse().unwrap_or(share)
}

/// What is not told, and why.
pub(super) fn untold(parameters: &[Parameter]) -> Vec<String> {
    let say = |Parameter { path, unit, found }: &Parameter| {
        format!(
            "{} keeps its nominal value {}: the recordings look the same over more than half of its range, the other \
             parameters making up for it.",
            text::capitalised(&words::path(path)),
            quantity(found.nominal, unit),
        )
    };
    let not_told = parameters.iter().filter(|p| !p.found.identifiable);
    not_told.map(say).collect()
}

/// What stands in the place of parameters that are not identifiable, where there are none.
pub(super) fn none_untold(page: &CalibrationPage) -> &'static str {
    let results = &page.results;
    match (results.parameters.is_empty(), results.model_is_adequate) {
        (true, _) => "No parameter was fitted.",
        (_, true) => "Every parameter that was fitted is identifiable.",
        (_, false) => {
            "A model that does not explain the recordings cannot tell which parameters they determine."
        }
    }
}

/// The pairs that are told only together.
pub(super) fn together(page: &CalibrationPage) -> Vec<String> {
    let results = &page.results;
    let paths: Vec<&str> = results.parameters.iter().map(|(path, _)| path).collect();
    let mut pairs: Vec<(f64, String)> = Vec::new();
    for (i, later) in paths.iter().enumerate() {
        for earlier in &paths[..i] {
            let r = results.correlation(later, earlier);
            if r.abs() > TOGETHER {
                let change = if r > 0.0 {
                    "rise together"
                } else {
                    "trade off"
                };
                let number = text::decimal(r, 2);
                pairs.push((
                    r,
                    format!(
                        "{} and {} {change} ({number})",
                        words::path(earlier),
                        words::path(later)
                    ),
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
    use calibrate::results::{Estimate, Misfits, Results};

    fn page(fitted: [f64; 2], held_out: Option<[f64; 2]>) -> CalibrationPage {
        CalibrationPage {
            results: Results {
                complete: true,
                model_is_adequate: fitted[1] <= 1.5,
                fit: Misfits {
                    nominal: Some(fitted[0]),
                    calibrated: Some(fitted[1]),
                    heldout_nominal: held_out.map(|[before, _]| before),
                    heldout_calibrated: held_out.map(|[_, after]| after),
                    ..Misfits::default()
                },
                ..Results::default()
            },
            runs: vec![Run::default()],
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
        let mut stopped = good;
        stopped.results.complete = false;
        assert!(warnings(&stopped)[0].contains("stopped"));
    }

    #[test]
    fn what_was_found_is_said_against_the_nominal_values() {
        let of = |value: f64, interval: Option<[f64; 2]>, identifiable| Estimate {
            value,
            low: interval.map(|[low, _]| low),
            high: interval.map(|[_, high]| high),
            nominal: 2e10,
            identifiable,
            at_bound: false,
            bounds: [2e9, 2e11],
            logarithmic: true,
        };
        let estimates = [
            of(1.6e10, Some([1.52e10, 1.68e10]), true),
            of(2.1e10, Some([1.9e10, 2.3e10]), true),
            of(1.6e10, None, true),
            of(2e10, None, false),
        ];
        let parameters = estimates.each_ref().map(|found| Parameter {
            path: "joints.big_end.contact.stiffness",
            unit: "N/m^1.5",
            found,
        });
        let found = found(&parameters);
        assert_eq!(
            found,
            [
                "Big end contact stiffness: 20\u{a0}% below its nominal value, known to ±5\u{a0}%.",
                "Big end contact stiffness: its nominal value, as far as the recordings tell, known to ±9.5\u{a0}%.",
                "Big end contact stiffness: 1.6 × 10¹⁰\u{a0}N/m^1.5 in a model that is wrong; no interval is known.",
            ]
        );
        let untold = untold(&parameters[3..]);
        assert!(
            untold[0].starts_with(
                "Big end contact stiffness keeps its nominal value 2 × 10¹⁰\u{a0}N/m^1.5: the"
            ),
            "{}",
            untold[0]
        );
    }
}
