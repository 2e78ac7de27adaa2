//! How the cases of a random sweep lie, and how features go with parameters.

use super::DatasetPage;
use crate::histogram;
use crate::plate::{About, Plate};
use figure::{Axis, Colour, Figure, Mark, Panel, Series};
use std::f64::consts::FRAC_PI_2;
use study::Level;
use study::classes;
use study::random::{Histogram, RandomSweep};
use study::scatter::Scatter;
use study::statistics::quantile;

/// At most this many of each kind of figure.
const MOST_HISTOGRAMS: usize = 24;
const MOST_SCATTERS: usize = 12;
/// Points of a class that a median of its trend is taken from, and most medians.
const LEAST_IN_GROUP: usize = 16;
const MOST_GROUPS: usize = 12;

/// The histograms in one figure, and a figure for each scatter.
pub(super) fn plates(page: &DatasetPage, sweep: &RandomSweep) -> Vec<Plate> {
    let mut plates = Vec::new();
    if !sweep.histograms.is_empty() {
        plates.push(histograms(
            &sweep.histograms[..sweep.histograms.len().min(MOST_HISTOGRAMS)],
        ));
    }
    plates.extend(
        sweep
            .scatters
            .iter()
            .take(MOST_SCATTERS)
            .map(|scatter| plate(page, scatter)),
    );
    plates
}

fn histograms(all: &[Histogram]) -> Plate {
    let cases = all.first().map_or(0, |histogram| histogram.values.len());
    let panels = all.iter().map(|drawn| {
        let (factor, unit) = readable(drawn.values.iter().copied(), &drawn.unit);
        let values: Vec<f64> = drawn.values.iter().map(|value| value * factor).collect();
        let edges = histogram::edges(values.iter().copied());
        let counts = histogram::counts(&edges, values.iter().copied());
        Panel {
            x: Axis::linear(text::with_unit(&drawn.name, unit)),
            y: Axis::linear("cases"),
            series: vec![Series::histogram("", Colour::Class(0), &edges, &counts)],
            note: if counts.is_empty() {
                "no cases".to_owned()
            } else {
                String::new()
            },
            ..Panel::default()
        }
    });
    Plate {
        heading: "Parameters".to_owned(),
        caption: format!(
            "How often values were drawn, of {}, in bins of equal width between the lowest and the highest.",
            text::counted(cases, "case")
        ),
        figure: Figure {
            rows: figure::in_rows(panels.collect(), 3),
            row_height: 150.0,
            ..Figure::default()
        },
        ..Plate::default()
    }
}

/// The factor and the unit in which the values read well.
fn readable(values: impl Iterator<Item = f64>, unit: &str) -> (f64, &str) {
    let largest = values
        .filter(|v| v.is_finite())
        .fold(0.0_f64, |largest, v| largest.max(v.abs()));
    text::readable_unit(largest, unit)
}

pub(super) fn plate(page: &DatasetPage, scatter: &Scatter) -> Plate {
    let ((x, x_unit), (y, y_unit)) = (&scatter.x, &scatter.y);
    let points = || scatter.classes.iter().flat_map(|(_, points)| points);
    let (x_factor, x_unit) = readable(points().map(|point| point[0]), x_unit);
    let series = scatter.classes.iter().flat_map(|(fault, points)| {
        let colour = page.class_colour(fault);
        let mut scaled: Vec<[f64; 2]> = points.iter().map(|p| [p[0] * x_factor, p[1]]).collect();
        let name = classes::name(fault);
        let points = Series::new(&name, colour, Mark::Points, scaled.clone());
        std::iter::once(points).chain(trend(&mut scaled, &name, colour))
    });
    let y_label = text::with_unit(y, y_unit);
    let panel = Panel {
        x: Axis::linear(text::with_unit(x, x_unit)),
        y: if scatter.log_y {
            Axis::log(y_label)
        } else {
            Axis::linear(y_label)
        },
        series: series.collect(),
        ..Panel::default()
    };
    let medians: Vec<(String, Level)> = scatter
        .classes
        .iter()
        .filter_map(|(fault, points)| {
            Some((classes::name(fault), median(points.iter().map(|p| p[1]))?))
        })
        .collect();
    let cases = scatter.classes.iter().map(|(_, points)| points.len()).sum();
    Plate {
        about: About {
            sensor: scatter.sensor.clone(),
            ..About::default()
        },
        heading: text::capitalised(&format!("{y} against {x}")),
        caption: format!(
            "{} against {x} for {}, coloured by fault; lines are medians, bands the middle half. The median is {}. Data: table features.",
            text::capitalised(y),
            text::counted(cases, "window"),
            super::captions::ends(&medians, y_unit)
        ),
        figure: Figure {
            rows: vec![vec![panel]],
            row_height: 300.0,
            ..Figure::default()
        },
        ..Plate::default()
    }
}

/// The median, and a band for the middle half, over groups of equally many points from left to right; none where the points are
/// few or stand at one place.
fn trend(points: &mut Vec<[f64; 2]>, name: &str, colour: Colour) -> Vec<Series> {
    points.retain(|point| point.iter().all(|value| value.is_finite()));
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let groups = (points.len() / LEAST_IN_GROUP).min(MOST_GROUPS);
    let spread = points
        .first()
        .zip(points.last())
        .is_some_and(|(a, b)| a[0] < b[0]);
    if groups < 2 || !spread {
        return Vec::new();
    }
    let quartiles = |group: &[[f64; 2]]| {
        let place = group.iter().map(|point| point[0]).sum::<f64>() / group.len() as f64;
        let values: Vec<f64> = group.iter().map(|point| point[1]).collect();
        let [low, middle, high] =
            [0.25, 0.5, 0.75].map(|part| quantile(&values, part).unwrap_or(f64::NAN));
        [place, low, middle, high]
    };
    let size = points.len().div_ceil(groups);
    let groups: Vec<[f64; 4]> = points.chunks(size).map(quartiles).collect();
    let line = |of: usize| groups.iter().map(move |group| [group[0], group[of]]);
    let band = line(1).chain(line(3).rev());
    vec![
        Series::new(name, colour, Mark::Band, band),
        Series::new(name, colour, Mark::BoldLine, line(2)),
    ]
}

/// The median of the finite values. Its standard error is √(π/2) σ/√n (normal values), σ being the
/// distance between the quartiles over 1.349.
fn median(values: impl Iterator<Item = f64>) -> Option<Level> {
    let values: Vec<f64> = values.filter(|v| v.is_finite()).collect();
    let quartile = |part| quantile(&values, part);
    let deviation = (quartile(0.75)? - quartile(0.25)?) / 1.349;
    Some(Level {
        value: quartile(0.5)?,
        spread: FRAC_PI_2.sqrt() * deviation / (values.len() as f64).sqrt(),
    })
}
