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
    let most = page.effects.first().map_or("", |e| e.sentence.as_str());
    let [before, after] = page.gap.map(size);
    match page.verdict.as_str() {
        "no-gap" => format!(
            "The calibrated model agrees with the recordings within their noise ({before} times): nothing is missing."
        ),
        "explained" => format!(
            "The calibrated model missed the recordings by {before} times their noise. What was missing is {named}; with it {after} \
             times the noise are left. {most}"
        ),
        "partly-explained" => format!(
            "The calibrated model missed the recordings by {before} times their noise. {most} Together, {named} take this down to \
             {after}; something smaller is still missing."
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
        "%" => (100.0, "%"),
        other => (1.0, other),
    }
}

/// What the template asks for, formatted.
impl View<'_> {
    fn misfit(value: &f64) -> String {
        size(*value)
    }

    fn value(parameter: &Parameter) -> String {
        let (factor, unit) = usual(&parameter.unit);
        let value = text::number(factor * parameter.value, 4);
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
                let [low, high] = ends.map(|end| text::number(factor * end, 4));
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
