//! The outcome of a calibration, in sentences.

use super::{CalibrationPage, Misfit, Parameter, words};
use calibrate::likelihood::NOISE;
use calibrate::results::Known;
use calibrate::shut_valve::sentences;

/// A misfit counts as smaller if it shrinks by more than this share.
const CLOSER: f64 = 0.05;
/// Magnitude of a correlation above which two estimates are strongly correlated.
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
        format!(". It predicts the held-out runs to {}", shrank(misfit))
    });
    let how = match fitted.after {
        after if after <= NOISE => "fits the recordings within their noise: the misfit is",
        after if after < (1.0 - CLOSER) * fitted.before => {
            "fits the recordings better than the nominal one, but not within their noise: the misfit is"
        }
        _ => "does not fit the recordings better than the nominal one: the misfit is",
    };
    format!("The calibrated model {how} {}{held_out}.", shrank(fitted))
}

/// Warnings about the calibration.
pub(super) fn warnings(page: &CalibrationPage) -> Vec<String> {
    let mut warnings = sentences(&page.results.shut_valves);
    let fitted = page.fitted().after;
    if !page.results.complete {
        warnings.push(
            "The search was stopped before its end. The values are the best so far, and the intervals are those around them. \
             The same command with --resume continues from there."
                .to_owned(),
        );
    } else if !page.results.model_is_adequate && !page.runs.is_empty() {
        warnings.push(
            "The model is wrong: it does not explain the recordings, so no interval is known for any parameter. Do not rely \
             on the values below. There are three possible reasons: the model lacks an effect, a value of the data sheet is \
             wrong, or the search missed a better fit. Run explain-gap to find a missing effect, or try other parameters, \
             wider bounds or more evaluations."
                .to_owned(),
        );
    } else if fitted > NOISE {
        warnings.push(
            "No tried values of these parameters explain the recordings to within their noise. Either the model lacks an \
             effect, or the search missed a better fit: try other parameters, wider bounds or more evaluations. The \
             intervals were widened by the misfit."
                .to_owned(),
        );
    }
    if let Some(held_out) = page.held_out()
        && fitted <= NOISE
        && held_out.after > NOISE * fitted.max(1.0)
    {
        warnings.push(
            "The held-out runs are predicted less well than the fitted ones: do not rely on the model far from the \
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

/// A sentence about each identifiable parameter.
pub(super) fn estimates(parameters: &[Parameter]) -> Vec<String> {
    let say = |parameter: &Parameter| {
        let Parameter { path, unit, found } = *parameter;
        let name = text::capitalised(&words::path(path));
        let [low, high] = match found.known() {
            Known::Within(interval) => interval,
            Known::Fitted => {
                let value = quantity(found.value, unit);
                return Some(format!(
                    "{name}: {value}, in a model that is wrong; no interval is known."
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
            _ if holds => "agrees with its nominal value".to_owned(),
            up if up > 0.0 => format!("{percent} above its nominal value"),
            _ => format!("{percent} below its nominal value"),
        };
        let half = (high - low).abs() / 2.0 / found.value.abs();
        let edge = match found.at_bound {
            true => " It is at the edge of its search range: give it wider bounds.",
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

/// A sentence about each parameter that is not identifiable.
pub(super) fn unidentifiable(parameters: &[Parameter]) -> Vec<String> {
    let say = |Parameter { path, unit, found }: &Parameter| {
        format!(
            "{} keeps its nominal value {}: over more than half of its range, the other parameters can make up for it.",
            text::capitalised(&words::path(path)),
            quantity(found.nominal, unit),
        )
    };
    let others = parameters.iter().filter(|p| !p.found.identifiable);
    others.map(say).collect()
}

/// The sentence that replaces an empty list of [`unidentifiable`] parameters.
pub(super) fn all_identifiable(page: &CalibrationPage) -> &'static str {
    let results = &page.results;
    match (results.parameters.is_empty(), results.model_is_adequate) {
        (true, _) => "No parameter was fitted.",
        (_, true) => "Every parameter that was fitted is identifiable.",
        (_, false) => {
            "The model does not explain the recordings, so it is not known which parameters are identifiable."
        }
    }
}

/// The pairs of strongly correlated estimates.
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
            "The calibrated model fits the recordings within their noise: the misfit is 1.04 times the \
             noise (before: 14). It predicts the held-out runs to 1.12 times the noise \
             (before: 15)."
        );
        assert!(warnings(&good).is_empty());
        let poor = page([14.0, 4.0], None);
        assert!(verdict(&poor).contains("but not within their noise"));
        assert_eq!(warnings(&poor).len(), 1);
        assert!(warnings(&poor)[0].contains("The model is wrong"));
        assert!(all_identifiable(&good).contains("No parameter"));
        assert!(verdict(&page([2.0, 2.0], None)).contains("not fit the recordings better"));
        // Less than anybody sees: 204 before and after.
        assert!(verdict(&page([204.3, 203.9], None)).contains("not fit the recordings better"));
        let narrow = page([14.0, 1.0], Some([14.0, 9.0]));
        assert!(warnings(&narrow)[0].contains("held-out runs are predicted"));
        // A search that was stopped says nothing about the model.
        for mut stopped in [good, poor] {
            stopped.results.complete = false;
            let warnings = warnings(&stopped);
            assert!(warnings[0].contains("stopped") && warnings.len() == 1);
        }
    }

    #[test]
    fn estimates_are_compared_with_the_nominal_values() {
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
        let found = super::estimates(&parameters);
        assert_eq!(
            found,
            [
                "Big end contact stiffness: 20\u{a0}% below its nominal value, known to ±5\u{a0}%.",
                "Big end contact stiffness: agrees with its nominal value, known to ±9.5\u{a0}%.",
                "Big end contact stiffness: 1.6 × 10¹⁰\u{a0}N/m^1.5, in a model that is wrong; no interval is known.",
            ]
        );
        let others = unidentifiable(&parameters[3..]);
        assert!(
            others[0].starts_with(
                "Big end contact stiffness keeps its nominal value 2 × 10¹⁰\u{a0}N/m^1.5: over"
            ),
            "{}",
            others[0]
        );
    }
}
