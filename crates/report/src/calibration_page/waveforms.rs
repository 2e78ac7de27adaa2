//! One picture per run: measured against simulated.

use super::misfits::{AFTER, BEFORE};
use super::verdict::size;
use super::{Channel, OrderResidual, Point, Run, words};
use crate::plate::Plate;
use figure::{Axis, Colour, Figure, Layer, Mark, Panel, Series};
use study::statistics::HALF;

/// At most so many runs have a picture, the first.
const MOST_RUNS: usize = 40;
/// Points, beyond which dots stand for orders.
const MANY: usize = 60;
/// Residuals below this share of the noise are not shown: they are as small by chance.
const LOWEST: f64 = 0.1;
/// The recording.
const MEASURED: Colour = Colour::Ink;

/// A remark on the runs without a figure; empty if all have one.
pub(crate) fn left_out(runs: &[Run]) -> String {
    match runs.len().saturating_sub(MOST_RUNS) {
        0 => String::new(),
        n => format!(
            "{} without a figure here; waveforms.parquet has all runs.",
            text::counted(n, "run")
        ),
    }
}

/// A picture per run; `names` are what the simulation before and after is called.
pub(crate) fn plates(runs: &[Run], names: [&str; 2]) -> Vec<Plate> {
    let runs = runs.iter().take(MOST_RUNS);
    let with_channels = runs.filter(|run| !run.channels.is_empty());
    with_channels.map(|run| plate(run, names)).collect()
}

fn plate(run: &Run, names: [&str; 2]) -> Plate {
    let kind = if run.held_out {
        "held out and predicted"
    } else {
        "fitted"
    };
    Plate {
        heading: format!("{}, {kind}", run.id),
        caption: format!(
            "The misfit is {} times the noise before and {} after. Left: the mean over the revolutions, with the \
             band that holds 95 % of them. Middle: simulation less recording, with the band of the noise. Right: the same by \
             order, divided by its noise; noise alone is about 1.",
            size(run.misfit.before),
            size(run.misfit.after)
        ),
        figure: Figure {
            rows: run.channels.iter().map(|c| panels(c, names)).collect(),
            row_headings: run.channels.iter().map(heading).collect(),
            row_height: 210.0,
            ..Figure::default()
        },
        ..Plate::default()
    }
}

fn heading(channel: &Channel) -> String {
    text::capitalised(&words::column(&channel.column).0)
}

fn panels(channel: &Channel, [before, after]: [&str; 2]) -> Vec<Panel> {
    let (_, unit) = words::column(&channel.column);
    let points = &channel.waveform;
    let largest = points.iter().map(|p| p.measured.abs()).fold(0.0, f64::max);
    let (scale, unit) = text::readable_unit(largest, unit);
    let line = |label: &str, colour, mark, of: &dyn Fn(&Point) -> f64| {
        let at = points.iter().map(|p| [p.crank_angle_deg, scale * of(p)]);
        // The end of the revolution is its beginning.
        let first = points.first().map(|p| [360.0, scale * of(p)]);
        Series::new(label, colour, mark, at.chain(first))
    };
    let band = |label: &str, middle: &dyn Fn(&Point) -> f64, half: &dyn Fn(&Point) -> f64| {
        let edge = |sign: f64| {
            let value = move |p: &Point| scale * (middle(p) + sign * HALF * half(p));
            let at = points.iter().map(move |p| [p.crank_angle_deg, value(p)]);
            at.chain(points.first().map(|p| [360.0, value(p)]))
        };
        let back: Vec<[f64; 2]> = edge(-1.0).collect();
        let outline = edge(1.0).chain(back.into_iter().rev());
        Series::new(label, MEASURED, Mark::Band, outline)
    };
    let measured: Vec<f64> = points.iter().map(|p| p.measured).collect();
    let at_steps = |over: &dyn Fn(f64, f64) -> f64| -> Vec<Series> {
        let step = |(i, (label, means)): (usize, &(String, Vec<f64>))| {
            let values = means.iter().zip(&measured).zip(points);
            let at = values.map(|((s, m), p)| [p.crank_angle_deg, scale * over(*s, *m)]);
            let line = Series::new(text::words(label), AFTER, Mark::Line, at);
            line.in_layer(Layer::Step(i))
        };
        channel.steps.iter().enumerate().map(step).collect()
    };
    let of_ends = match channel.steps.is_empty() {
        true => Layer::Always,
        false => Layer::Ends,
    };
    let mut waveform = Panel {
        title: "Over the crank angle".to_owned(),
        x: Axis::crank_angle(),
        y: Axis::linear(text::with_unit("mean", unit)),
        series: vec![
            band("measured revolutions", &|p| p.measured, &|p| p.scatter),
            line(before, BEFORE, Mark::Line, &|p| p.before).in_layer(of_ends),
            line("measured mean", MEASURED, Mark::Line, &|p| p.measured),
            line(after, AFTER, Mark::Line, &|p| p.after).in_layer(of_ends),
        ],
        ..Panel::default()
    };
    waveform.series.extend(at_steps(&|simulated, _| simulated));
    let mut difference = Panel {
        title: "Simulated less measured".to_owned(),
        x: Axis::crank_angle(),
        y: Axis::linear(text::with_unit("difference", unit)),
        series: vec![
            line("", BEFORE, Mark::HairLine, &|p| p.before - p.measured).in_layer(of_ends),
            band("", &|_| 0.0, &|p| p.noise),
            line("", AFTER, Mark::HairLine, &|p| p.after - p.measured).in_layer(of_ends),
        ],
        ..Panel::default()
    };
    difference
        .series
        .extend(at_steps(&|simulated, measured| simulated - measured));
    vec![waveform, difference, residuals(&channel.orders)]
}

fn residuals(orders: &[OrderResidual]) -> Panel {
    let highest = orders.iter().map(|o| o.order).fold(1.0, f64::max);
    let both = orders.iter().flat_map(|o| [o.before, o.after]);
    let greatest = both.filter(|r| r.is_finite()).fold(2.0, f64::max);
    let mark = match orders.len() {
        0..MANY => Mark::Points,
        _ => Mark::Dots,
    };
    let points = |of: fn(&OrderResidual) -> f64| -> Vec<[f64; 2]> {
        orders.iter().map(|o| [o.order, of(o)]).collect()
    };
    Panel {
        title: "By order of the crank's speed".to_owned(),
        x: Axis {
            range: Some((-0.02 * highest, 1.02 * highest)),
            ..Axis::linear("order")
        },
        y: Axis {
            range: Some((LOWEST, 1.5 * greatest)),
            ..Axis::log("difference over noise")
        },
        series: vec![
            Series::new(
                "",
                Colour::Ink,
                Mark::Line,
                [[-highest, 1.0], [2.0 * highest, 1.0]],
            ),
            Series::new("", BEFORE, mark, points(|o| o.before)),
            Series::new("", AFTER, mark, points(|o| o.after)),
        ],
        note: if orders.is_empty() {
            "no orders".to_owned()
        } else {
            String::new()
        },
        ..Panel::default()
    }
}
