//! How well the classes can be told apart: the features that say most, and what a baseline confuses.

use super::DatasetPage;
use crate::histogram;
use crate::plate::Plate;
use classify::{Baseline, ClassScore};
use figure::{Axis, Colour, Field, Figure, Layer, Mark, Panel, Series};
use study::classes;
use study::counts::FaultCount;
use study::ranking::FeatureByClass;

/// Classes of a map of confusions.
const MOST_CLASSES: usize = 24;
/// Height of a row of the map, pixels.
const CLASS_HEIGHT: f64 = 26.0;

/// The features that say most about the class, and the confusions of the baseline.
pub(super) fn plates(page: &DatasetPage) -> Vec<Plate> {
    let histograms = (!page.by_class.is_empty()).then(|| histograms(page));
    let confusions = page
        .baseline
        .as_ref()
        .map(|baseline| confusions(page, baseline));
    histograms.into_iter().chain(confusions).collect()
}

fn histograms(page: &DatasetPage) -> Plate {
    let panel = |feature: &FeatureByClass| {
        let all = || {
            feature
                .classes
                .iter()
                .flat_map(|(_, values)| values.iter().copied())
        };
        // A few far values must not press the others into one bin.
        let logarithmic = feature.spans_decades();
        let place = |value: f64| if logarithmic { value.log10() } else { value };
        let edges = histogram::edges(all().map(place));
        let series = feature.classes.iter().map(|(class, values)| {
            let counts = histogram::counts(&edges, values.iter().copied().map(place));
            let drawn: Vec<f64> = match logarithmic {
                true => edges.iter().map(|edge| 10_f64.powf(*edge)).collect(),
                false => edges.clone(),
            };
            Series::histogram(
                classes::name(class),
                page.class_colour(class),
                &drawn,
                &counts,
            )
        });
        let label = text::with_unit(&feature.name, &feature.unit);
        Panel {
            x: if logarithmic {
                Axis::log(label)
            } else {
                Axis::linear(label)
            },
            y: Axis::linear("windows"),
            series: series
                .map(|series| Series {
                    mark: Mark::Area,
                    ..series
                })
                .collect(),
            ..Panel::default()
        }
    };
    Plate {
        heading: "The features that say most, by class".to_owned(),
        caption: "How often each value occurs in the windows of each class. The features are those at the top of the table \
                  of ranks below, one of each kind."
            .to_owned(),
        figure: Figure {
            rows: figure::in_rows(page.by_class.iter().map(panel).collect(), 2),
            row_height: 180.0,
            ..Figure::default()
        },
        ..Plate::default()
    }
}

fn confusions(page: &DatasetPage, baseline: &Baseline) -> Plate {
    let score = |count: &FaultCount| {
        baseline
            .classes
            .iter()
            .find(|score| score.class == count.fault)
    };
    let shown: Vec<&ClassScore> = page
        .faults
        .iter()
        .filter_map(score)
        .take(MOST_CLASSES)
        .collect();
    let names: Vec<&str> = shown.iter().map(|score| score.class.as_str()).collect();
    // The first class stands at the top.
    let row = |i: usize| (names.len() - 1 - i) as f64;
    let fields = shown.iter().enumerate().flat_map(|(i, score)| {
        let names = &names;
        score.answers.iter().filter_map(move |(answer, count)| {
            let column = names.iter().position(|name| name == answer)?;
            Some(Field {
                layer: Layer::Always,
                at: [column as f64, row(i)],
                fill: Colour::Tint(*count as f64 / score.rows.max(1) as f64),
                letters: text::count(*count),
            })
        })
    });
    let words =
        |names: &mut dyn Iterator<Item = &&str>| names.map(|name| classes::name(name)).collect();
    let rest = match baseline.classes.len() - shown.len() {
        0 => String::new(),
        rest => format!(" {} are not shown.", text::counted(rest, "class")),
    };
    Plate {
        heading: "What the baseline confuses".to_owned(),
        caption: format!(
            "Tested windows of each fault (rows) by the fault that the baseline names (columns). The darker a field, the \
             greater the share of its row; the diagonal is right.{rest}"
        ),
        figure: Figure {
            rows: vec![vec![Panel {
                x: Axis::named("named", words(&mut names.iter())),
                y: Axis::named("true", words(&mut names.iter().rev())),
                fields: fields.collect(),
                ..Panel::default()
            }]],
            row_height: CLASS_HEIGHT * shown.len().max(2) as f64,
            ..Figure::default()
        },
        ..Plate::default()
    }
}
