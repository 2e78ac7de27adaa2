//! The page itself.

use super::units::usual;
use super::{GapPage, figures, parts};
use crate::Error;
use crate::calibration_page::verdict::size;
use crate::calibration_page::{waveforms, words};
use crate::plate::{Numbers, Plate, Rendered, numbered_files};
use askama::Template;
use gap::results::parts::{Part, Values};
use gap::results::scaling::Exponent;
use gap::results::{Bounded, Effect};
use gap::{ByPart, Correction, Results, Scaling, Step, Verdict};

#[derive(Template)]
#[template(path = "gap_page.html")]
struct View<'a> {
    page: &'a GapPage,
    results: &'a Results,
    verdict: String,
    waterfall: Vec<(usize, Plate)>,
    forces: Vec<(usize, Plate)>,
    maps: Vec<(usize, Plate)>,
    runs: Vec<(usize, Plate)>,
}

impl GapPage {
    /// The page as one HTML file that loads nothing from anywhere, and its figures.
    ///
    /// # Errors
    /// [`Error::Template`] if the template cannot be filled in.
    pub fn render(&self) -> Result<Rendered, Error> {
        let mut numbers = Numbers::default();
        let mut numbered = |plates| numbers.give(plates);
        let names = match self.results.effects.is_empty() {
            true => ["calibrated", ""],
            false => ["without the effects", "with them"],
        };
        let view = View {
            page: self,
            results: &self.results,
            verdict: format!("{}{}", verdict(&self.results), pressure(&self.results)),
            waterfall: numbered(figures::waterfall(self).into_iter().collect()),
            forces: numbered(figures::forces(self).into_iter().collect()),
            maps: numbered(figures::maps(self)),
            runs: numbered(waveforms::plates(&self.runs, names)),
        };
        let html = view.render()?;
        let plates = [view.waterfall, view.forces, view.maps, view.runs];
        Ok(Rendered {
            html,
            figures: numbered_files("gap", plates.into_iter().flatten()),
        })
    }
}

/// The outcome in a few sentences.
fn verdict(results: &Results) -> String {
    let named: Vec<String> = results
        .effects
        .iter()
        .map(|e| text::words(&e.label))
        .collect();
    let named = match named.split_last() {
        Some((last, others)) if !others.is_empty() => format!("{} and {last}", others.join(", ")),
        _ => named.join(""),
    };
    let it = match results.effects.len() {
        1 => "it",
        _ => "them",
    };
    let mut sentences: Vec<&str> = results
        .effects
        .iter()
        .map(|e| e.sentence.as_str())
        .collect();
    // An effect at two places is described once.
    sentences.dedup();
    let sentences = sentences.join(" ");
    let sentences = format!("{sentences}{}", forms(&results.effects));
    let [before, after] = [results.gap.before, results.gap.after].map(size);
    match results.verdict {
        Verdict::NoGap => format!(
            "The calibrated model fits the recordings within their noise ({before} times): no effect is missing."
        ),
        Verdict::Explained => format!(
            "The misfit of the calibrated model is {before} times the noise. The missing part is {named}: with {it} the misfit is \
             {after} times the noise. {sentences}"
        ),
        Verdict::PartlyExplained => format!(
            "The misfit of the calibrated model is {before} times the noise. {sentences} With {named} the misfit is {after} times \
             the noise. What is left may be the form of the law, or something smaller."
        ),
        Verdict::Unexplained => format!(
            "The misfit of the calibrated model is {before} times the noise. No effect of the catalogue explains it."
        ),
    }
}

/// What is known of the forms of the effects' laws, a sentence for each form.
fn forms(effects: &[Effect]) -> String {
    let known = effects
        .iter()
        .filter_map(|effect| Some((text::words(&effect.label), effect.form.as_deref()?)));
    sentences_of_forms(known.collect())
}

/// The same of labels and forms. One that effects share, as those at two places do, is stated once.
fn sentences_of_forms(known: Vec<(String, &str)>) -> String {
    let mut shared: Vec<(Vec<String>, &str)> = Vec::new();
    for (label, form) in known {
        match shared.iter_mut().find(|(_, other)| *other == form) {
            Some((labels, _)) => labels.push(label),
            None => shared.push((vec![label], form)),
        }
    }
    let sentence = |(labels, form): &(Vec<String>, &str)| {
        format!(" Of the law of {}: {form}.", labels.join(" and "))
    };
    shared.iter().map(sentence).collect()
}

/// The error of the simulated pressures, in a sentence.
fn pressure(results: &Results) -> String {
    let rms = results.gap.pressure_rms_pa.both();
    let Some([before, after]) = rms.filter(|_| !results.effects.is_empty()) else {
        return String::new();
    };
    let [before, after] = [before, after].map(|pa| text::quantity(pa / 1e3, "kPa"));
    format!(
        " The error of the simulated pressure (root mean square over the revolution) is {before} before and {after} after."
    )
}

/// Significant digits that show the width of a parameter's interval to two digits, and at least four.
fn digits(parameter: &Bounded) -> usize {
    let width = parameter.interval().map_or(0.0, |[low, high]| high - low);
    let ratio = (parameter.value / width).abs();
    match ratio.is_finite() && ratio > 100.0 {
        true => (ratio.log10().ceil() as usize + 2).min(9),
        false => 4,
    }
}

/// What the template asks for, formatted.
impl View<'_> {
    /// Labels of the steps that figures can be shown at, each with the gap that is left; empty where there are none.
    fn steps(&self) -> String {
        let steps = self.results.steps.iter();
        let words = |step: &Step| {
            format!(
                "{}, gap {}",
                text::words(&step.label),
                size(step.gap.fitted)
            )
        };
        match self.results.maps.steps.is_empty() {
            true => String::new(),
            false => steps.map(words).collect::<Vec<_>>().join("|"),
        }
    }

    fn misfit(value: &f64) -> String {
        size(*value)
    }

    fn value(unit: &str, parameter: &Bounded) -> String {
        let (factor, unit) = usual(unit);
        let value = text::number(factor * parameter.value, digits(parameter));
        match unit.is_empty() {
            true => value,
            false => format!("{value}\u{a0}{}", text::unit(unit)),
        }
    }

    fn interval(unit: &str, parameter: &Bounded) -> String {
        match parameter.interval() {
            Some([low, high]) if low == high => "not searched".to_owned(),
            Some(ends) => {
                let (factor, _) = usual(unit);
                let digits = digits(parameter);
                let [low, high] = ends.map(|end| text::number(factor * end, digits));
                format!("{low} to {high}")
            }
            None => "not identifiable".to_owned(),
        }
    }

    fn key(key: &str) -> String {
        text::words(key)
    }

    fn law(scaling: &Scaling) -> String {
        let power = |exponent: &Exponent| {
            let (with, error) = (&exponent.with, exponent.standard_error);
            let exponent = text::number(exponent.exponent, 2);
            match error {
                Some(error) => format!(
                    "{with} to the power of {exponent} ± {}",
                    text::number(error, 1)
                ),
                None => format!("{with} to the power of {exponent}"),
            }
        };
        let powers: Vec<String> = scaling.exponents.iter().map(power).collect();
        let (channel, _) = words::column(&scaling.channel);
        format!("{channel}: {}", powers.join(", "))
    }

    fn probability(probability: &f64) -> String {
        text::decimal(*probability, 2)
    }

    fn number(value: &f64) -> String {
        text::number(*value, 4)
    }

    fn bounds(wrong: &Correction) -> String {
        match wrong.low.zip(wrong.high) {
            Some((low, high)) => format!("{} to {}", Self::number(&low), Self::number(&high)),
            None => "not identifiable".to_owned(),
        }
    }

    fn parts_of(by_part: &ByPart) -> String {
        parts::sentences(by_part)
    }

    fn rows(by_part: &ByPart) -> Vec<(usize, &Part)> {
        by_part.parts.iter().enumerate().collect()
    }

    fn before(part: &Part) -> String {
        part.before.map_or_else(|| "–".to_owned(), size)
    }

    fn channel(part: &Part) -> String {
        parts::channel(part)
    }

    fn heading(values: &Values) -> String {
        parts::heading(values)
    }

    fn own(values: &Values, part: &usize) -> String {
        parts::own(values, *part)
    }

    fn together(values: &Values) -> String {
        parts::together(values)
    }

    fn agreements(all: &[Values]) -> Vec<String> {
        parts::agreements(all)
    }

    fn has_rivals(effect: &Effect) -> bool {
        !effect.rivals.is_empty()
    }

    fn left_out(&self) -> String {
        waveforms::left_out(&self.page.runs)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_narrow_interval_has_digits_enough_to_be_one() {
        let parameter = |value, interval: Option<[f64; 2]>| Bounded {
            value,
            low: interval.map(|[low, _]| low),
            high: interval.map(|[_, high]| high),
        };
        let narrow = parameter(1.692e-4, Some([1.691_8e-4, 1.692_2e-4]));
        assert_eq!(View::value("m", &narrow), "0.1692\u{a0}mm");
        assert_eq!(View::interval("m", &narrow), "0.16918 to 0.16922");
        let wide = parameter(0.18, Some([0.123_456, 0.234_567]));
        assert_eq!(View::interval("", &wide), "0.1235 to 0.2346");
        let unidentifiable = parameter(5e-6, None);
        assert_eq!(View::value("m^2", &unidentifiable), "5\u{a0}mm²");
        assert_eq!(View::interval("m^2", &unidentifiable), "not identifiable");
    }

    #[test]
    fn a_form_that_effects_share_is_stated_once() {
        let known = |label: &str, form| (label.to_owned(), form);
        let stated = sentences_of_forms(vec![
            known("film big end", "long 1"),
            known("valve loss", "linear 0.2"),
            known("film small end", "long 1"),
        ]);
        let expected = " Of the law of film big end and film small end: long 1. Of the law of valve loss: linear 0.2.";
        assert_eq!(stated, expected);
    }
}
