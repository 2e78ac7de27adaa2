//! The page itself.

use super::{Effect, GapPage, Parameter, Rival, Scaling, figures};
use crate::calibration_page::{verdict::size, waveforms, words};
use crate::plate::{Numbers, Plate, Rendered, numbered_files};
use crate::{Error, text};
use askama::Template;

#[derive(Template)]
#[template(path = "gap_page.html")]
struct View<'a> {
    page: &'a GapPage,
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
        let names = match self.effects.is_empty() {
            true => ["calibrated", ""],
            false => ["without the effects", "with them"],
        };
        let view = View {
            page: self,
            verdict: format!("{}{}", verdict(self), pressure(self)),
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

/// What the explanation comes to, in a sentence.
fn verdict(page: &GapPage) -> String {
    let named: Vec<String> = page.effects.iter().map(|e| text::words(&e.label)).collect();
    let named = match named.split_last() {
        Some((last, others)) if !others.is_empty() => format!("{} and {last}", others.join(", ")),
        _ => named.join(""),
    };
    let it = match page.effects.len() {
        1 => "it",
        _ => "them",
    };
    let mut sentences: Vec<&str> = page.effects.iter().map(|e| e.sentence.as_str()).collect();
    // An effect at two places is told once.
    sentences.dedup();
    let sentences = sentences.join(" ");
    let [before, after] = page.gap.map(size);
    match page.verdict.as_str() {
        "no-gap" => format!(
            "The calibrated model agrees with the recordings within their noise ({before} times): nothing is missing."
        ),
        "explained" => format!(
            "The calibrated model missed the recordings by {before} times their noise. What was missing is {named}; with {it} \
             {after} times the noise are left. {sentences}"
        ),
        "partly-explained" => format!(
            "The calibrated model missed the recordings by {before} times their noise. {sentences} With {named} \
             {after} times the noise are left; something smaller is still missing."
        ),
        _ => format!(
            "The calibrated model misses the recordings by {before} times their noise, and nothing in the catalogue of effects \
             explains it."
        ),
    }
}

/// By how much the pressures are off, in a sentence.
fn pressure(page: &GapPage) -> String {
    let Some([before, after]) = page.pressure_rms_pa.filter(|_| !page.effects.is_empty()) else {
        return String::new();
    };
    let [before, after] = [before, after].map(|pa| text::quantity(pa / 1e3, "kPa"));
    format!(
        " The simulated pressure was {before} from the recorded one, root mean square over the revolution, and is {after} from it \
         now."
    )
}

/// The unit in which people read a value of this SI unit, and the factor to it.
fn usual(unit: &str) -> (f64, &str) {
    match unit {
        "rad" => (1_f64.to_degrees(), "deg"),
        "m" => (1e3, "mm"),
        "m^2" => (1e6, "mm^2"),
        "%" => (100.0, "%"),
        other => (1.0, other),
    }
}

/// Significant digits that show the width of a parameter's interval to two digits, and at least four.
fn digits(parameter: &Parameter) -> usize {
    let width = parameter.interval.map_or(0.0, |[low, high]| high - low);
    let ratio = (parameter.value / width).abs();
    match ratio.is_finite() && ratio > 100.0 {
        true => (ratio.log10().ceil() as usize + 2).min(9),
        false => 4,
    }
}

/// What the template asks for, formatted.
impl View<'_> {
    fn misfit(value: &f64) -> String {
        size(*value)
    }

    fn value(parameter: &Parameter) -> String {
        let (factor, unit) = usual(&parameter.unit);
        let value = text::number(factor * parameter.value, digits(parameter));
        match unit.is_empty() {
            true => value,
            false => format!("{value}\u{a0}{}", text::unit(unit)),
        }
    }

    fn interval(parameter: &Parameter) -> String {
        match parameter.interval {
            Some([low, high]) if low == high => "not searched".to_owned(),
            Some(ends) => {
                let (factor, _) = usual(&parameter.unit);
                let digits = digits(parameter);
                let [low, high] = ends.map(|end| text::number(factor * end, digits));
                format!("{low} to {high}")
            }
            None => "not told".to_owned(),
        }
    }

    fn key(parameter: &Parameter) -> String {
        text::words(&parameter.key)
    }

    fn law(scaling: &Scaling) -> String {
        let power = |(with, exponent, error): &(String, f64, Option<f64>)| {
            let exponent = text::number(*exponent, 2);
            match error {
                Some(error) => format!(
                    "{with} to the power of {exponent} ± {}",
                    text::number(*error, 1)
                ),
                None => format!("{with} to the power of {exponent}"),
            }
        };
        let powers: Vec<String> = scaling.exponents.iter().map(power).collect();
        let (channel, _) = words::column(&scaling.channel);
        format!("{channel}: {}", powers.join(", "))
    }

    fn explains(rival: &Rival) -> String {
        format!("{} %", text::decimal(100.0 * rival.explains, 0))
    }

    fn correlation(rival: &Rival) -> String {
        let correlation = rival.correlation;
        correlation.map_or_else(|| "–".to_owned(), |rho| text::decimal(rho, 2))
    }

    fn has_rivals(effect: &Effect) -> bool {
        !effect.rivals.is_empty()
    }

    fn left_out(&self) -> String {
        match waveforms::left_out(&self.page.runs) {
            0 => String::new(),
            n => format!(
                "{} without a picture here; waveforms.parquet has them all.",
                text::counted(n, "run")
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_narrow_interval_has_digits_enough_to_be_one() {
        let parameter = |unit: &str, value, interval| Parameter {
            key: "clearance".to_owned(),
            unit: unit.to_owned(),
            value,
            interval,
        };
        let narrow = parameter("m", 1.692e-4, Some([1.691_8e-4, 1.692_2e-4]));
        assert_eq!(View::value(&narrow), "0.1692\u{a0}mm");
        assert_eq!(View::interval(&narrow), "0.16918 to 0.16922");
        let wide = parameter("", 0.18, Some([0.123_456, 0.234_567]));
        assert_eq!(View::interval(&wide), "0.1235 to 0.2346");
        let untold = parameter("m^2", 5e-6, None);
        assert_eq!(View::value(&untold), "5\u{a0}mm²");
        assert_eq!(View::interval(&untold), "not told");
    }
}
