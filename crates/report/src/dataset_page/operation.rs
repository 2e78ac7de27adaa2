//! How levels and spectra go with speed and load.

use super::{DatasetPage, distributions};
use crate::plate::{About, Plate};
use figure::{Axis, Colour, Figure, Mark, Panel, Series};
use std::f64::consts::TAU;
use study::classes;
use study::operation::{Operation, Waterfall};

/// At most this many trends and waterfalls.
const MOST_TRENDS: usize = 8;
const MOST_WATERFALLS: usize = 4;
/// A waterfall shows this much below its greatest amplitude, in decades, over this many distances between its lines.
const DECADES: f64 = 4.0;
const HEIGHT: f64 = 2.5;
/// The orders whose frequencies are drawn over the speed.
const ORDERS: [f64; 6] = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0];

/// Trends, then waterfalls.
pub(super) fn plates(page: &DatasetPage, operation: &Operation) -> Vec<Plate> {
    let trends = operation.trends.iter().take(MOST_TRENDS);
    let trends = trends.map(|scatter| distributions::plate(page, scatter));
    let waterfalls = operation.waterfalls.iter().take(MOST_WATERFALLS);
    trends
        .chain(waterfalls.map(|waterfall| plate(page, waterfall)))
        .collect()
}

fn plate(page: &DatasetPage, waterfall: &Waterfall) -> Plate {
    let spectra = &waterfall.spectra;
    let amplitudes = spectra
        .iter()
        .flat_map(|(_, spectrum)| &spectrum.amplitude_m_s2);
    let greatest = amplitudes.copied().fold(0.0, f64::max);
    let rpm = |speed: f64| speed * 60.0 / TAU;
    let [low, high] =
        [spectra.first(), spectra.last()].map(|end| end.map_or(0.0, |(speed, _)| rpm(*speed)));
    let spacing = (high - low) / (spectra.len() - 1).max(1) as f64;
    let height = |amplitude: f64| {
        let below = (amplitude / greatest).log10().max(-DECADES);
        HEIGHT * spacing * (1.0 + below / DECADES)
    };
    let colour = page.class_colour(&waterfall.fault);
    let mut series: Vec<Series> = spectra
        .iter()
        .map(|(speed, spectrum)| {
            let points = spectrum.at.iter().zip(&spectrum.amplitude_m_s2);
            let at = |(order, a): (&f64, &f64)| [order * speed / TAU, rpm(*speed) + height(*a)];
            Series::new("", colour, Mark::HairLine, points.map(at))
        })
        .collect();
    let furthest = spectra
        .iter()
        .filter_map(|(speed, s)| Some(s.at.last()? * speed / TAU));
    let furthest = furthest.fold(0.0, f64::max);
    series.extend(ORDERS.map(|order| {
        let ends = [low, high].map(|rpm| [order * rpm / 60.0, rpm]);
        Series::new("", Colour::Class(1), Mark::FaintLine, ends)
    }));
    let panel = Panel {
        x: Axis {
            range: Some((0.0, furthest)),
            ..Axis::linear("frequency (Hz)")
        },
        y: Axis::linear("speed (rpm), spectra rising from it"),
        series,
        ..Panel::default()
    };
    let class = classes::name(&waterfall.fault);
    let place = match waterfall.sensor.as_str() {
        "" => String::new(),
        sensor => format!(", {sensor}"),
    };
    let orders = ORDERS.map(|order| format!("{order:.0}"));
    Plate {
        about: About {
            sensor: waterfall.sensor.clone(),
            ..About::default()
        },
        heading: format!("Waterfall over the speed, {class}{place}"),
        caption: format!(
            "Order spectra of {} of one class ({class}), of each speed the one with the median rms, over frequency. Each line starts at its \
             speed and rises by {} for amplitudes from {} to {}, the greatest. Slanted lines are the orders {} of the crank; a peak that \
             stays at one frequency is a resonance.",
            text::counted(spectra.len(), "recording"),
            text::quantity(HEIGHT * spacing, "rpm"),
            text::quantity(greatest * 10f64.powf(-DECADES), "m/s²"),
            text::quantity(greatest, "m/s²"),
            orders.join(", ")
        ),
        figure: Figure {
            rows: vec![vec![panel]],
            row_height: 420.0,
            ..Figure::default()
        },
        ..Plate::default()
    }
}
