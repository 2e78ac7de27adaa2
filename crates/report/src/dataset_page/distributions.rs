//! How the cases of a random sweep lie, and how features go with parameters.

use super::{DatasetPage, Histogram, RandomSweep, Scatter};
use crate::classes;
use crate::figure::{self, Axis, Colour, Figure, Mark, Panel, Series};
use crate::plate::Plate;
use crate::statistics::quantile;
use crate::{Level, text};
use std::f64::consts::FRAC_PI_2;

const MOST_BINS: usize = 30;
/// At most this many of each kind of figure.
const MOST_HISTOGRAMS: usize = 24;
const MOST_SCATTERS: usize = 12;

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
    let panels = all.iter().map(|histogram| {
        let (factor, unit) = readable(histogram.values.iter().copied(), &histogram.unit);
        let values: Vec<f64> = histogram
            .values
            .iter()
            .map(|value| value * factor)
            .collect();
        let (edges, counts) = binned(&values);
        Panel {
            x: Axis::linear(text::with_unit(&histogram.name, unit)),
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
        svg: Figure {
            rows: figure::in_rows(panels.collect(), 3),
            row_height: 150.0,
            ..Figure::default()
        }
        .svg(),
    }
}

/// The factor and the unit in which the values read well.
fn readable(values: impl Iterator<Item = f64>, unit: &str) -> (f64, &str) {
    let largest = values
        .filter(|v| v.is_finite())
        .fold(0.0_f64, |largest, v| largest.max(v.abs()));
    text::readable_unit(largest, unit)
}

/// Edges and counts of equal bins over the finite values; none where there are no values. There
/// are 2∛n bins for n values (D. Lane's rule of Rice University), and not too many.
fn binned(values: &[f64]) -> (Vec<f64>, Vec<usize>) {
    let finite = || values.iter().copied().filter(|v| v.is_finite());
    let (low, high) = finite().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
        (l.min(v), h.max(v))
    });
    if low > high {
        return (Vec::new(), Vec::new());
    }
    let bins = (2.0 * (finite().count() as f64).cbrt()).ceil() as usize;
    let bins = bins.min(MOST_BINS);
    let (low, width) = if high > low {
        (low, (high - low) / bins as f64)
    } else {
        (low - 0.5, 1.0 / bins as f64)
    };
    let mut counts = vec![0; bins];
    for value in finite() {
        counts[(((value - low) / width) as usize).min(bins - 1)] += 1;
    }
    ((0..=bins).map(|i| low + width * i as f64).collect(), counts)
}

pub(super) fn plate(page: &DatasetPage, scatter: &Scatter) -> Plate {
    let ((x, x_unit), (y, y_unit)) = (&scatter.x, &scatter.y);
    let points = || scatter.classes.iter().flat_map(|(_, points)| points);
    let (x_factor, x_unit) = readable(points().map(|point| point[0]), x_unit);
    let series = scatter.classes.iter().map(|(fault, points)| {
        Series::new(
            classes::name(fault),
            page.class_colour(fault),
            Mark::Points,
            points.iter().map(|p| [p[0] * x_factor, p[1]]),
        )
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
        heading: text::capitalised(&format!("{y} against {x}")),
        caption: format!(
            "{} against {x} for {}, coloured by fault. The median is {}. Data: table features.",
            text::capitalised(y),
            text::counted(cases, "window"),
            super::captions::ends(&medians, y_unit)
        ),
        svg: Figure {
            rows: vec![vec![panel]],
            row_height: 300.0,
            ..Figure::default()
        }
        .svg(),
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_finite_value_falls_into_one_bin() {
        let values: Vec<f64> = (0..=300)
            .map(|i| f64::from(i) * 0.1)
            .chain([f64::NAN])
            .collect();
        let (edges, counts) = binned(&values);
        assert_eq!((edges[0], edges[edges.len() - 1].round()), (0.0, 30.0));
        assert_eq!(counts.iter().sum::<usize>(), 301);
        assert_eq!(binned(&[2.0, 2.0]).1.iter().sum::<usize>(), 2);
        assert!(binned(&[f64::INFINITY]).1.is_empty());
    }
}
