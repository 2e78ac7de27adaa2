//! The pictures of an explanation.

use super::GapPage;
use crate::calibration_page::{misfits, words};
use crate::plate::Plate;
use figure::{Axis, Colour, Field, Figure, Layer, Mark, Panel, Series};
use gap::results::Maps;
use gap::{MissingForce, ResidualMap, Step};

/// About so many runs' channels have a map: of each channel those with the greatest gap.
const MOST_MAPS: usize = 6;
/// Height of a row of a map, pixels.
const ROW: f64 = 18.0;
/// An excess of so many times the noise is black.
const BLACK: f64 = 30.0;
/// Excess up to which a cell is empty.
const EMPTY: f64 = 1.3;

/// What is left when nothing is missing.
const FLOOR: &str = "noise floor";

/// The gap as it shrank: each step takes it from where the one before has left it, and the floor is
/// what none goes below.
pub(super) fn waterfall(page: &GapPage) -> Option<Plate> {
    let steps = &page.results.steps;
    let last = steps.last()?;
    let top = steps.len() as f64;
    let name = |(i, step): (usize, &Step)| match i {
        0 | 1 => step.label.clone(),
        _ => format!("+ {}", text::words(&step.label)),
    };
    let mut names: Vec<String> = steps.iter().enumerate().map(name).collect();
    names.push(FLOOR.to_owned());
    names.reverse();
    let row = |i: usize| top - i as f64;
    let fall = |i: usize| {
        let from = steps[i - 1].gap.fitted;
        [[from, row(i)], [steps[i].gap.fitted, row(i)], [f64::NAN; 2]]
    };
    let falls = (1..steps.len()).flat_map(fall);
    // Down from the step above, then along the row.
    let drops = (1..steps.len()).flat_map(|i| {
        let from = steps[i - 1].gap.fitted;
        [[from, row(i - 1)], [from, row(i)], [f64::NAN; 2]]
    });
    let left = [
        [last.gap.fitted, row(steps.len() - 1)],
        [last.gap.fitted, 0.0],
        [1.0, 0.0],
    ];
    let at = |of: fn(&Step) -> Option<f64>| {
        let points = steps.iter().enumerate();
        points.filter_map(move |(i, step)| Some([of(step)?, row(i)]))
    };
    let panel = Panel {
        x: Axis::log("gap (times the noise)"),
        y: Axis::named("", names),
        series: vec![
            Series::new(
                FLOOR,
                Colour::Ink,
                Mark::Line,
                [[1.0, -1.0], [1.0, top + 1.0]],
            ),
            Series::new("", misfits::AFTER, Mark::FaintLine, drops),
            Series::new("", misfits::AFTER, Mark::BoldLine, falls),
            Series::new("", Colour::Ink, Mark::FaintLine, left),
            Series::new(
                "runs fitted to",
                misfits::AFTER,
                Mark::Discs,
                at(|step| Some(step.gap.fitted)),
            ),
            Series::new(
                "runs held out",
                misfits::BEFORE,
                Mark::Rings,
                at(|step| step.gap.held_out),
            ),
        ],
        ..Panel::default()
    };
    Some(Plate {
        heading: "The gap, step by step".to_owned(),
        caption: "Root mean square difference between simulation and recording, by order, divided by its noise. Each bar is the \
                  reduction by one step: calibration first, then one effect after another. At 1 only noise is left. Held-out \
                  runs are never fitted."
            .to_owned(),
        figure: Figure {
            rows: vec![vec![panel]],
            row_height: misfits::ROW * (top + 1.5),
            ..Figure::default()
        },
        ..Plate::default()
    })
}

/// The force that is missing over the crank angle.
pub(super) fn forces(page: &GapPage) -> Option<Plate> {
    let forces = &page.results.missing_force;
    let last = forces.len().checked_sub(1)?;
    let line = |(i, force): (usize, &MissingForce)| {
        let step = 360.0 / force.force.len().max(1) as f64;
        let points = force.force.iter().enumerate();
        let points: Vec<[f64; 2]> = points.map(|(i, f)| [i as f64 * step, *f]).collect();
        let colour = Colour::Ordered(i as f64 / last.max(1) as f64);
        let label = format!("{} {}", force.run, force.throw);
        Series::new(label.trim(), colour, Mark::Line, points)
    };
    let panel = Panel {
        x: Axis::crank_angle(),
        y: Axis::linear("force toward the head (N)"),
        series: forces.iter().enumerate().map(line).collect(),
        ..Panel::default()
    };
    Some(Plate {
        heading: "The missing force".to_owned(),
        caption: "Force on the crosshead with which the model fits the recordings best, estimated without a law. A named effect or \
                  a formula would have to reproduce it."
            .to_owned(),
        figure: Figure {
            rows: vec![vec![panel]],
            ..Figure::default()
        },
        ..Plate::default()
    })
}

/// The maps of a channel: without and with the effects, and at each step.
struct OfChannel<'a> {
    before: &'a ResidualMap,
    after: &'a ResidualMap,
    steps: Vec<&'a ResidualMap>,
}

/// Where the gap was and is, for the channels in which it was greatest.
pub(super) fn maps(page: &GapPage) -> Vec<Plate> {
    let Maps {
        bands,
        before,
        after,
        steps,
    } = &page.results.maps;
    let greatest = |map: &ResidualMap| map.excess.iter().flatten().copied().fold(0.0, f64::max);
    let of_channel = |(i, (before, after))| OfChannel {
        before,
        after,
        steps: steps.iter().filter_map(|maps| maps.get(i)).collect(),
    };
    let mut maps: Vec<OfChannel<'_>> = before
        .iter()
        .zip(after)
        .enumerate()
        .map(of_channel)
        .collect();
    maps.sort_by(|a, b| greatest(b.before).total_cmp(&greatest(a.before)));
    let mut columns: Vec<&str> = maps.iter().map(|map| map.before.channel.as_str()).collect();
    columns.sort_unstable();
    columns.dedup();
    let each = (MOST_MAPS / columns.len().max(1)).max(1);
    let chosen = columns.iter().flat_map(|column| {
        let own = maps.iter().filter(move |map| map.before.channel == *column);
        own.take(each)
    });
    chosen.map(|map| plate(map, bands)).collect()
}

/// The map of a channel without and with the effects; a single map without any effect.
fn plate(maps: &OfChannel<'_>, bands: &[String]) -> Plate {
    let OfChannel {
        before,
        after,
        steps,
    } = maps;
    let (channel, _) = words::column(&before.channel);
    let bands = &bands[..bands.len().min(before.excess.len())];
    let ends = match steps.is_empty() {
        true => Layer::Always,
        false => Layer::Ends,
    };
    // The last panel is the one that steps.
    let stepping = |title: &str| {
        let mut panel = panel(title, bands, &after.excess, ends);
        let of_step = |(i, map): (usize, &&ResidualMap)| fields(&map.excess, Layer::Step(i));
        panel
            .fields
            .extend(steps.iter().enumerate().flat_map(of_step));
        panel
    };
    let panels = match before.excess == after.excess {
        true => vec![stepping("calibrated")],
        false => vec![
            panel("without the effects", bands, &before.excess, Layer::Always),
            stepping("with them"),
        ],
    };
    Plate {
        heading: format!("{}, {channel}", before.run),
        caption: "Residual divided by the noise, by crank angle and order; darker is larger. White is noise alone."
            .to_owned(),
        figure: Figure {
            rows: vec![panels],
            row_height: ROW * (bands.len() as f64 + 0.5),
            ..Figure::default()
        },
        ..Plate::default()
    }
}

fn fields(excess: &[Vec<f64>], layer: Layer) -> Vec<Field> {
    let mut fields = Vec::new();
    for (band, row) in excess.iter().enumerate() {
        for (sector, value) in row.iter().enumerate().filter(|(_, v)| **v > EMPTY) {
            let letters = match *value {
                v if v < 9.5 => text::decimal(v, 0),
                _ => String::new(),
            };
            fields.push(Field {
                layer,
                at: [sector as f64, band as f64],
                fill: Colour::Tint((value.ln() / BLACK.ln()).clamp(0.0, 1.0)),
                letters,
            });
        }
    }
    fields
}

fn panel(title: &str, bands: &[String], excess: &[Vec<f64>], layer: Layer) -> Panel {
    let sectors = excess.first().map_or(1, Vec::len);
    let sector = 360.0 / sectors as f64;
    let name = |i: usize| match i % 6 {
        0 => format!("{}°", text::decimal(i as f64 * sector, 0)),
        _ => String::new(),
    };
    Panel {
        title: title.to_owned(),
        x: Axis::named("crank angle", (0..sectors).map(name).collect()),
        y: Axis::named("orders", bands.to_vec()),
        fields: fields(excess, layer),
        ..Panel::default()
    }
}
