//! Bifurcation diagrams, both ways.

use super::ChaosPage;
use crate::case_table::rounded;
use crate::plate::Plate;
use figure::{Axis, Colour, Figure, Mark, Panel, Series, Share};
use std::collections::BTreeMap;
use study::chaos::bifurcations::{Bifurcation, Recorded, Section};

/// Ranges that are further apart than this share of the whole are of two motions.
const APART: f64 = 0.01;

/// A figure per diagram.
pub(super) fn plates(page: &ChaosPage) -> Vec<Plate> {
    page.bifurcations.iter().map(plate).collect()
}

fn plate(diagram: &Bifurcation) -> Plate {
    let places = || {
        let all = diagram
            .quantities
            .iter()
            .flat_map(|q| q.up.iter().chain(&q.down));
        all.map(|point| point[0])
    };
    let largest = places().fold(0.0_f64, |largest, v| largest.max(v.abs()));
    let (factor, unit) = text::readable_unit(largest, &diagram.unit);
    let x = text::with_unit(&diagram.parameter, unit);
    let panels = diagram.quantities.iter().map(|quantity| {
        let scaled = |points: &[[f64; 2]]| -> Vec<[f64; 2]> {
            points.iter().map(|[x, y]| [x * factor, *y]).collect()
        };
        let series = |label: &str, class, mark, points: &[[f64; 2]]| {
            Series::new(label, Colour::Class(class), mark, scaled(points))
        };
        vec![Panel {
            x: Axis::linear(&x),
            y: Axis::linear(text::with_unit(&quantity.name, &quantity.unit)),
            series: vec![
                series("rising (wide, below)", 0, Mark::WideDots, &quantity.up),
                series("falling (on top)", 1, Mark::Dots, &quantity.down),
            ],
            ..Panel::default()
        }]
    });
    Plate {
        sections: crate::plate::json(&scaled(&diagram.sections, factor)),
        heading: format!("Bifurcation diagram: {}", diagram.name),
        caption: caption(diagram, factor, unit),
        figure: Figure {
            rows: panels.collect(),
            row_height: 230.0,
            share_x: Share::All,
            ..Figure::default()
        },
        ..Plate::default()
    }
}

/// The sections with their values in the unit of the axis, short as text.
fn scaled(sections: &[Section], factor: f64) -> Vec<Section> {
    let motion = |branch: &[[f64; 2]]| branch.iter().map(|point| point.map(rounded)).collect();
    let scaled = |section: &Section| Section {
        value: section.value * factor,
        up: motion(&section.up),
        down: motion(&section.down),
    };
    sections.iter().map(scaled).collect()
}

fn caption(diagram: &Bifurcation, factor: f64, unit: &str) -> String {
    let mut said = format!(
        "One dot per revolution at each value of {}. The state is carried over from value to value: rising (blue, wide) and \
         falling (orange, on top). One dot at a value is a motion with a period of one revolution, n dots a period of n \
         revolutions, a column of dots a motion that does not repeat. Where only one colour has dots, the motion depends on \
         the direction: hysteresis.",
        diagram.parameter
    );
    if let Some(first) = diagram.quantities.first() {
        let both = both_ways(first);
        let apart: Vec<f64> = apart(first, &both);
        said += &format!(
            " At {} of {} the two directions have no common range of the {}",
            apart.len(),
            text::counted(both.len(), "value"),
            first.name,
        );
        if let (Some(low), Some(high)) = (apart.first(), apart.last()) {
            let [low, high] = [low, high].map(|v| text::number(v * factor, 3));
            said += &format!(" (between {low} and {high}\u{a0}{unit})");
        }
        said += ".";
    }
    if !diagram.reasons.is_empty() {
        said += &format!(" Values without dots: {}.", diagram.reasons.join("; "));
    }
    said + &format!(" Data: bifurcations/{}.parquet.", diagram.name)
}

/// A value of the parameter with the ranges (low, high) of the quantity, rising and falling.
type Both = (f64, [[f64; 2]; 2]);

/// The values that both ways have points at.
fn both_ways(quantity: &Recorded) -> Vec<Both> {
    let [up, down] = [&quantity.up, &quantity.down].map(|points| ranges(points));
    let both = up
        .iter()
        .filter_map(|(key, &(value, up))| Some((value, [up, down.get(key)?.1])));
    let mut both: Vec<Both> = both.collect();
    both.sort_by(|a, b| a.0.total_cmp(&b.0));
    both
}

/// The range of the quantity at each value of the parameter.
fn ranges(points: &[[f64; 2]]) -> BTreeMap<u64, (f64, [f64; 2])> {
    let mut ranges = BTreeMap::new();
    for &[x, y] in points
        .iter()
        .filter(|[x, y]| x.is_finite() && y.is_finite())
    {
        let (_, range) = ranges.entry(x.to_bits()).or_insert((x, [y, y]));
        *range = [range[0].min(y), range[1].max(y)];
    }
    ranges
}

/// The values at which the two ways have nothing in common.
fn apart(quantity: &Recorded, both: &[Both]) -> Vec<f64> {
    let all = || {
        quantity
            .up
            .iter()
            .chain(&quantity.down)
            .map(|p| p[1])
            .filter(|y| y.is_finite())
    };
    let whole = all().fold(f64::NEG_INFINITY, f64::max) - all().fold(f64::INFINITY, f64::min);
    let gap = |[a, b]: &[[f64; 2]; 2]| (a[0] - b[1]).max(b[0] - a[1]);
    both.iter()
        .filter(|(_, ranges)| gap(ranges) > APART * whole)
        .map(|(value, _)| *value)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hysteresis_is_where_the_ways_have_nothing_in_common() {
        let quantity = Recorded {
            up: vec![
                [1.0, 5.0],
                [2.0, 5.0],
                [2.0, 6.0],
                [3.0, 9.0],
                [4.0, f64::NAN],
            ],
            down: vec![[3.0, 9.05], [2.0, 8.0], [2.0, 7.0], [1.0, 5.0], [4.0, 1.0]],
            ..Recorded::default()
        };
        let both = both_ways(&quantity);
        assert_eq!(both.len(), 3);
        assert_eq!(apart(&quantity, &both), [2.0]);
    }
}
