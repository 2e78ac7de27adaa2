//! The page of a comparison.

use crate::Error;
use crate::plate::{Numbers, Plate, Rendered, numbered_files};
use askama::Template;
use figure::{Axis, Colour, Figure, Mark, Panel, Series};
use sweep::comparison::{ComparedChannel, ComparedFeature, Comparison};

#[derive(Template)]
#[template(path = "comparison_page.html")]
struct View<'a> {
    comparison: &'a Comparison,
    version: &'static str,
    plates: Vec<(usize, Plate)>,
    features: Vec<&'a ComparedFeature>,
}

/// The page as one HTML file that loads nothing from anywhere, and its figures: the features that differ
/// most first, and each channel of both over the crank angle and over frequency.
///
/// # Errors
/// [`Error::Template`] if the template cannot be filled in.
pub fn render(comparison: &Comparison) -> Result<Rendered, Error> {
    let names: Vec<&str> = comparison.sides.iter().map(|s| s.name.as_str()).collect();
    let plates = comparison.channels.iter().map(|c| plate(c, &names));
    let view = View {
        comparison,
        version: env!("CARGO_PKG_VERSION"),
        plates: Numbers::default().give(plates.collect()),
        features: comparison.most_different(),
    };
    let html = view.render()?;
    Ok(Rendered {
        html,
        figures: numbered_files("comparison", view.plates.into_iter()),
    })
}

fn plate(channel: &ComparedChannel, names: &[&str]) -> Plate {
    let unit = text::unit(&channel.unit);
    let label = |i: usize| names.get(i).copied().unwrap_or_default();
    let over_angle = |i: usize, values: &Vec<f64>| {
        let step = 360.0 / values.len().max(1) as f64;
        let points = values.iter().chain(values.first()).enumerate();
        let points = points.map(|(j, value)| [j as f64 * step, *value]);
        Series::new(label(i), Colour::Class(i), Mark::Line, points)
    };
    let waveforms = channel.waveforms.iter().flatten().enumerate();
    let note = match channel.waveforms {
        Some(_) => "",
        None => "the crank angle from top dead centre is not known",
    };
    let waveform = Panel {
        title: "Mean over the revolutions".to_owned(),
        x: Axis::crank_angle(),
        y: Axis::linear(text::with_unit(&text::words(&channel.name), &unit)),
        series: waveforms.map(|(i, values)| over_angle(i, values)).collect(),
        note: note.to_owned(),
        ..Panel::default()
    };
    let difference = channel.waveforms.as_ref().map(|[a, b]| Panel {
        title: "Difference".to_owned(),
        x: Axis::crank_angle(),
        y: Axis::linear(text::with_unit("B − A", &unit)),
        series: vec![over_angle(1, &differences(a, b))],
        ..Panel::default()
    });
    let spectra = channel.spectra.iter().enumerate().map(|(i, spectrum)| {
        // The mean has its place in the table.
        let points = spectrum.frequencies().zip(&spectrum.amplitude).skip(1);
        let points = points.map(|(frequency, amplitude)| [frequency, *amplitude]);
        Series::new(label(i), Colour::Class(i), Mark::Line, points)
    });
    let spectrum = Panel {
        title: "Amplitude over frequency".to_owned(),
        x: Axis::linear("frequency (Hz)"),
        y: Axis::log(text::with_unit("amplitude", &unit)),
        series: spectra.collect(),
        ..Panel::default()
    };
    let figure = Figure {
        rows: [Some(waveform), difference, Some(spectrum)]
            .into_iter()
            .flatten()
            .map(|panel| vec![panel])
            .collect(),
        ..Figure::default()
    };
    Plate {
        heading: text::capitalised(&text::words(&channel.name)),
        caption: "The first window of each: the mean over its whole revolutions, the difference of the two, and the \
                  amplitude spectrum with a Hann window."
            .to_owned(),
        figure,
        ..Plate::default()
    }
}

/// What B exceeds A by at each crank angle; both have the same angles.
fn differences(a: &[f64], b: &[f64]) -> Vec<f64> {
    b.iter().zip(a).map(|(b, a)| b - a).collect()
}

impl View<'_> {
    fn value(value: &Option<f64>) -> String {
        value.map_or("–".to_owned(), |value| text::number(value, 4))
    }

    fn unit(feature: &ComparedFeature) -> String {
        text::unit(&feature.unit)
    }
}
