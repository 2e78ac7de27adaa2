//! One example of each class.

use super::portrait::{PORTRAIT_REVOLUTIONS, portrait};
use super::{DatasetPage, captions};
use crate::plate::{About, Plate};
use crate::revolutions::Revolutions;
use figure::{Axis, Colour, Figure, Mark, Panel, Series};
use study::classes;
use study::examples::{ClassExample, MOST_EXAMPLES};
use study::recording::Spectrum;

/// The figures of the first classes, all with the same axes.
pub(super) fn plates(page: &DatasetPage) -> Vec<Plate> {
    let shown = || page.examples.iter().take(MOST_EXAMPLES);
    let mut rows: Vec<[Panel; 4]> = shown()
        .map(|example| panels(example, page.class_colour(&example.fault)))
        .collect();
    for column in 0..4 {
        figure::share_ranges(rows.iter_mut().map(|row| &mut row[column]));
    }
    shown()
        .zip(rows)
        .map(|(example, [waveform, portrait, spectrum, orders])| {
            plate(
                example,
                vec![vec![waveform, portrait], vec![spectrum, orders]],
            )
        })
        .collect()
}

fn plate(example: &ClassExample, rows: Vec<Vec<Panel>>) -> Plate {
    let level = captions::levels(&example.response).map_or_else(String::new, |[peak, rms]| {
        format!(
            " Peak {}, rms {}, crest factor {}.",
            text::quantity(peak.value, "m/s²"),
            text::quantity(rms.value, "m/s²"),
            text::number(peak.value / rms.value, 3)
        )
    });
    Plate {
        about: About {
            class: classes::name(&example.fault),
            sensor: example.sensor.clone(),
            ..About::default()
        },
        heading: match example.sensor.as_str() {
            "" => text::capitalised(&classes::name(&example.fault)),
            sensor => format!(
                "{}, {sensor}",
                text::capitalised(&classes::name(&example.fault))
            ),
        },
        caption: format!(
            "{}: one revolution, the velocity-acceleration portrait of the last {PORTRAIT_REVOLUTIONS} revolutions or fewer, the \
             amplitude spectrum (rms over stretches of two revolutions) and the order spectrum (rms over the \
             revolutions).{level} Axes are the same for all classes. Data: {}.",
            text::capitalised(&example.operating_point),
            captions::places([&example.response])
        ),
        figure: Figure {
            rows,
            row_height: 170.0,
            ..Figure::default()
        },
        ..Plate::default()
    }
}

fn panels(example: &ClassExample, colour: Colour) -> [Panel; 4] {
    let response = &example.response;
    let revolution =
        Revolutions::new(&response.crank_angle_rad, &response.acceleration_m_s2).longest();
    let waveform = Panel {
        title: "One revolution".to_owned(),
        x: Axis::crank_angle(),
        y: Axis::linear("acceleration (m/s²)"),
        series: vec![Series::new("", colour, Mark::Line, revolution)],
        ..Panel::default()
    };
    let spectrum = |title: &str, x: &str, spectrum: &Spectrum| Panel {
        title: title.to_owned(),
        x: Axis {
            fundamental: Some(spectrum.fundamental),
            ..Axis::linear(x)
        },
        y: Axis::log("amplitude (m/s²)"),
        series: vec![Series::new(
            "",
            colour,
            Mark::Line,
            spectrum
                .at
                .iter()
                .zip(&spectrum.amplitude_m_s2)
                .map(|(&x, &y)| [x, y]),
        )],
        ..Panel::default()
    };
    [
        waveform,
        portrait("Portrait", response, colour),
        spectrum("Spectrum", "frequency (Hz)", &example.spectrum),
        spectrum(
            "Order spectrum",
            "order of crank speed",
            &example.order_spectrum,
        ),
    ]
}
