//! The page itself.

use super::{
    CalibrationPage, Parameter, corrections, gas, misfits, parameters, sensors, transfers, verdict,
    waveforms, words,
};
use crate::Error;
use crate::plate::{Numbers, Plate, Rendered, numbered_files};
use askama::Template;
use calibrate::Relation;
use calibrate::recorded_sensor::RecordedSensor;
use calibrate::results::{Correction, Known, Phase, Relations, Results};
use calibrate::transfer::Hypothesis;

#[derive(Template)]
#[template(path = "calibration_page.html")]
struct View<'a> {
    page: &'a CalibrationPage,
    results: &'a Results,
    parameters: Vec<Parameter<'a>>,
    chambers: Vec<gas::Chamber<'a>>,
    verdict: String,
    warnings: Vec<String>,
    found: Vec<String>,
    unidentifiable: Vec<String>,
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
        let parameters = self.parameters();
        let chambers = gas::chambers(self);
        let view = View {
            page: self,
            results: &self.results,
            verdict: verdict::verdict(self),
            warnings: verdict::warnings(self),
            found: verdict::estimates(&parameters),
            unidentifiable: verdict::unidentifiable(&parameters),
            together: verdict::together(self),
            corrections: corrections::sentences(&self.results.corrections),
            misfits: numbered(misfits::plate(self).into_iter().collect()),
            intervals: numbered(parameters::intervals(self).into_iter().collect()),
            correlations: numbered(parameters::correlations(self).into_iter().collect()),
            transfers: numbered(transfers::plates(self)),
            gas: numbered(gas::plates(&chambers)),
            runs: numbered(waveforms::plates(
                &self.runs,
                ["before", "after calibration"],
            )),
            parameters,
            chambers,
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

    fn identifiable(&self) -> String {
        let all = &self.parameters;
        let identifiable = all.iter().filter(|p| p.found.identifiable).count();
        format!("{identifiable} of {}", all.len())
    }

    fn effort(&self) -> String {
        let evaluations = usize::try_from(self.results.evaluations).unwrap_or(usize::MAX);
        format!("{} evaluations", text::count(evaluations))
    }

    fn name(parameter: &Parameter) -> String {
        text::capitalised(&words::path(parameter.path))
    }

    fn value(value: &f64, parameter: &Parameter) -> String {
        let (scale, _) = text::readable_unit(parameter.found.nominal, parameter.unit);
        text::number(value * scale, 4)
    }

    fn unit(parameter: &Parameter) -> String {
        text::unit(text::readable_unit(parameter.found.nominal, parameter.unit).1)
    }

    fn interval(parameter: &Parameter) -> String {
        match parameter.found.known() {
            Known::Within([low, high]) => format!(
                "{} to {}",
                Self::value(&low, parameter),
                Self::value(&high, parameter)
            ),
            Known::Fitted => "none: the model is wrong".to_owned(),
            Known::Nothing => "not identifiable".to_owned(),
        }
    }

    fn change(parameter: &Parameter) -> String {
        let found = parameter.found;
        if !found.identifiable || !parameter.is_ratio() {
            return String::new();
        }
        let change = 100.0 * (found.value / found.nominal - 1.0);
        let sign = if change > 0.0 { "+" } else { "" };
        format!("{sign}{}\u{a0}%", text::decimal(change, 1))
    }

    fn correction(correction: &Correction) -> [String; 5] {
        corrections::row(correction)
    }

    fn column(column: &str) -> String {
        text::capitalised(&words::column(column).0)
    }

    fn sensor(column: &str, sensor: &RecordedSensor) -> [String; 5] {
        sensors::row(column, sensor)
    }

    fn spreads(&self) -> Vec<transfers::Spread> {
        transfers::spreads(self.page)
    }

    fn all_identifiable(&self) -> &'static str {
        verdict::all_identifiable(self.page)
    }

    fn decision(relations: &Relations) -> String {
        transfers::decision(relations)
    }

    fn relation(relation: &Relation) -> &'static str {
        transfers::words(*relation)
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
        waveforms::left_out(&self.page.runs)
    }
}
