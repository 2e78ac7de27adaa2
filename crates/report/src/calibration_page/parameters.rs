//! The parameters: against their nominal values, and against each other.

use super::misfits::{AFTER, ROW};
use super::{CalibrationPage, Parameter, words};
use crate::plate::Plate;
use calibrate::results::Known;
use figure::{Axis, Colour, Field, Figure, Layer, Mark, Panel, Series};

/// At most so many parameters are drawn, the first.
const MOST: usize = 60;
/// With more parameters than this their correlations are not written into the map.
const WRITTEN: usize = 16;

/// The names of the parameters, from the last to the first, as an upright axis has them.
fn names(parameters: &[Parameter], numbered: bool) -> Vec<String> {
    let name = |(i, parameter): (usize, &Parameter)| {
        let name = text::capitalised(&words::path(parameter.path));
        if numbered {
            format!("{name}\u{a0}\u{a0}{}", i + 1)
        } else {
            name
        }
    };
    let names = parameters.iter().enumerate().map(name);
    names.rev().collect()
}

/// Value and interval of each over the nominal value; none where nothing was fitted.
pub(super) fn intervals(page: &CalibrationPage) -> Option<Plate> {
    let mut ratios = page.parameters();
    ratios.retain(Parameter::is_ratio);
    ratios.truncate(MOST);
    if ratios.is_empty() {
        return None;
    }
    let top = ratios.len() as f64 - 1.0;
    let mut bars = Vec::new();
    let (mut identified, mut fitted, mut kept) = (Vec::new(), Vec::new(), Vec::new());
    for (i, parameter) in ratios.iter().enumerate() {
        let estimate = parameter.found;
        let y = top - i as f64;
        let place = |value: f64| [value / estimate.nominal, y];
        match estimate.known() {
            Known::Within([low, high]) => {
                identified.push(place(estimate.value));
                bars.extend([place(low), place(high), [f64::NAN; 2]]);
            }
            Known::Fitted => fitted.push(place(estimate.value)),
            Known::Nothing => kept.push(place(estimate.nominal)),
        }
    }
    let positive = bars
        .iter()
        .chain(&identified)
        .chain(&fitted)
        .all(|[x, _]| x.is_nan() || *x > 0.0);
    let label = "value over its nominal value";
    let named = |points: &[[f64; 2]], name: &str| match points.is_empty() {
        true => String::new(),
        false => name.to_owned(),
    };
    let panel = Panel {
        x: if positive {
            Axis::log(label)
        } else {
            Axis::linear(label)
        },
        y: Axis::named("", names(&ratios, false)),
        series: vec![
            Series::new(
                "nominal",
                Colour::Ink,
                Mark::Line,
                [[1.0, -1.0], [1.0, top + 1.0]],
            ),
            Series::new("", AFTER, Mark::BoldLine, bars),
            Series::new(
                named(&identified, "estimate with its 95 % interval"),
                AFTER,
                Mark::Discs,
                identified,
            ),
            Series::new(
                named(
                    &fitted,
                    "estimate of a model that is wrong: no interval is known",
                ),
                AFTER,
                Mark::Rings,
                fitted,
            ),
            Series::new(
                named(&kept, "not identifiable: nominal value kept"),
                Colour::Ink,
                Mark::Rings,
                kept,
            ),
        ],
        ..Panel::default()
    };
    Some(Plate {
        heading: "Parameters against their nominal values".to_owned(),
        caption: "Estimate of each parameter with its 95 % interval, divided by the nominal value. An interval that crosses the \
                  line at 1 agrees with the nominal value."
            .to_owned(),
        figure: Figure {
            rows: vec![vec![panel]],
            row_height: ROW * (ratios.len() as f64 + 0.5),
            ..Figure::default()
        },
        ..Plate::default()
    })
}

/// The correlations as a map; none where there is no pair.
pub(super) fn correlations(page: &CalibrationPage) -> Option<Plate> {
    let mut parameters = page.parameters();
    parameters.truncate(MOST);
    let count = parameters.len();
    if count < 2 {
        return None;
    }
    let is_identifiable = |i: usize| parameters[i].found.identifiable;
    let field = |i: usize, j: usize| {
        let r = page
            .results
            .correlation(parameters[i].path, parameters[j].path);
        let both = is_identifiable(i) && is_identifiable(j);
        let letters = match both {
            _ if i == j || count > WRITTEN => String::new(),
            true => text::decimal(r, 2),
            false => "–".to_owned(),
        };
        Field {
            layer: Layer::Always,
            at: [j as f64, (count - 1 - i) as f64],
            fill: Colour::Tint(if both && i != j { r.abs() } else { 0.0 }),
            letters,
        }
    };
    let panel = Panel {
        x: Axis::named("parameter", (1..=count).map(|i| i.to_string()).collect()),
        y: Axis::named("", names(&parameters, true)),
        fields: (0..count)
            .flat_map(|i| (0..count).map(move |j| (i, j)))
            .map(|(i, j)| field(i, j))
            .collect(),
        ..Panel::default()
    };
    Some(Plate {
        heading: "Correlations".to_owned(),
        caption: "Correlation between the errors of each pair of estimates, darker for stronger. Near 1 or −1 only a \
                  combination of the two is identifiable: if one is wrong, so is the other. A dash stands for a parameter that \
                  is not identifiable."
            .to_owned(),
        figure: Figure {
            rows: vec![vec![panel]],
            row_height: (1.3 * ROW * count as f64).clamp(90.0, 640.0),
            ..Figure::default()
        },
        ..Plate::default()
    })
}
