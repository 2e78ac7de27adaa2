//! The page itself.

use super::{
    CalibrationPage, Correction, Estimate, Hypothesis, Known, Phase, Sensor, Transfer, corrections,
    gas, misfits, parameters, sensors, transfers, verdict, waveforms, words,
};
use crate::plate::{Numbers, Plate, Rendered, numbered_files};
use crate::{Error, text};
use askama::Template;

#[derive(Template)]
#[template(path = "calibration_page.html")]
struct View<'a> {
    page: &'a CalibrationPage,
    verdict: String,
    warnings: Vec<String>,
    found: Vec<String>,
    untold: Vec<String>,
    together: Vec<String>,
    corrections: Vec<String>,
    misfits: Vec<(usize, Plate)>,
    intervals: Vec<(usize, Plate)>,
    correlations: Vec<(usize, Plate)>,
    transfers: Vec<(usize, Plate)>,
    gas: Vec<(usize, Plate)>,
    runs: Vec<(usize, Plate)>,
}

impl CalibrationPage {
    /// The page as one HTML file that loads nothing from anywhere, and its figures.
    ///
    /// # Errors
    /// [`Error::Template`] if the template cannot be filled in.
    pub fn render(&self) -> Result<Rendered, Error> {
        let mut numbers = Numbers::default();
        let mut numbered = |plates| numbers.give(plates);
        let view = View {
            page: self,
            verdict: verdict::verdict(self),
            warnings: verdict::warnings(self),
            found: verdict::found(&self.parameters),
            untold: verdict::untold(&self.parameters),
            together: verdict::together(self),
            corrections: corrections::sentences(&self.corrections),
            misfits: numbered(misfits::plate(self).into_iter().collect()),
            intervals: numbered(parameters::intervals(self).into_iter().collect()),
            correlations: numbered(parameters::correlations(self).into_iter().collect()),
            transfers: numbered(transfers::plates(self)),
            gas: numbered(gas::plates(&self.gas)),
            runs: numbered(waveforms::plates(
                &self.runs,
                ["before", "after calibration"],
            )),
        };
        let html = view.render()?;
        let plates = [
            view.misfits,
            view.intervals,
            view.correlations,
            view.transfers,
            view.gas,
            view.runs,
        ];
        Ok(Rendered {
            html,
            figures: numbered_files("calibration", plates.into_iter().flatten()),
        })
    }
}

/// What the template asks for, formatted.
impl View<'_> {
    fn counts(&self) -> [String; 2] {
        let held_out = self.page.runs.iter().filter(|run| run.held_out).count();
        let fitted = self.page.runs.len() - held_out;
        [fitted, held_out].map(text::count)
    }

    fn told(&self) -> String {
        let all = &self.page.parameters;
        let told = all.iter().filter(|e| e.is_identifiable()).count();
        format!("{told} of {}", all.len())
    }

    fn effort(&self) -> String {
        let evaluations = usize::try_from(self.page.evaluations).unwrap_or(usize::MAX);
        format!("{} evaluations", text::count(evaluations))
    }

    fn name(estimate: &Estimate) -> String {
        text::capitalised(&words::path(&estimate.path))
    }

    fn value(value: &f64, estimate: &Estimate) -> String {
        let (scale, _) = text::readable_unit(estimate.nominal, &estimate.unit);
        text::number(value * scale, 4)
    }

    fn unit(estimate: &Estimate) -> String {
        text::unit(text::readable_unit(estimate.nominal, &estimate.unit).1)
    }

    fn interval(estimate: &Estimate) -> String {
        match estimate.known {
            Known::Within([low, high]) => format!(
                "{} to {}",
                Self::value(&low, estimate),
                Self::value(&high, estimate)
            ),
            Known::Fitted => "none: the model is wrong".to_owned(),
            Known::Nothing => "not identifiable".to_owned(),
        }
    }

    fn change(estimate: &Estimate) -> String {
        if !estimate.is_identifiable() || !estimate.is_ratio() {
            return String::new();
        }
        let change = 100.0 * (estimate.value / estimate.nominal - 1.0);
        let sign = if change > 0.0 { "+" } else { "" };
        format!("{sign}{}\u{a0}%", text::decimal(change, 1))
    }

    fn correction(correction: &Correction) -> [String; 5] {
        corrections::row(correction)
    }

    fn column(sensor: &Sensor) -> String {
        text::capitalised(&words::column(&sensor.column).0)
    }

    fn sensor(sensor: &Sensor) -> [String; 5] {
        sensors::row(sensor)
    }

    fn spreads(transfer: &Transfer) -> Vec<transfers::Spread> {
        transfers::spreads(transfer)
    }

    fn none_untold(&self) -> &'static str {
        verdict::none_untold(self.page)
    }

    fn decision(transfer: &Transfer) -> String {
        transfers::decision(transfer)
    }

    fn relation(name: &str) -> &str {
        transfers::words(name)
    }

    fn exponents(hypothesis: &Hypothesis) -> String {
        transfers::exponents(hypothesis)
    }

    fn range(phase: &Phase) -> String {
        let [from, to] = phase.crank_angle_deg.map(|a| text::decimal(a, 0));
        format!("{from}° to {to}°")
    }

    fn kilopascal(phase: &Phase) -> String {
        text::number(phase.rms_pa / 1e3, 3)
    }

    fn share(phase: &Phase) -> String {
        text::decimal(100.0 * phase.share, 0)
    }

    fn misfit(value: &f64) -> String {
        verdict::size(*value)
    }

    fn optional(value: &Option<f64>) -> String {
        value.map_or_else(String::new, verdict::size)
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
