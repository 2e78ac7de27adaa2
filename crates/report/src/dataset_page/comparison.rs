//! Responses by set of joints and clearance, as in Figs. 3 to 8 of the reciprocating-compressor
//! study that the shipped sweep repeats (dynamic analysis of the moving mechanism of the
//! reciprocating compressor with clearance joints, section 3 and 4).

use super::DatasetPage;
use super::captions;
use super::portrait::{PORTRAIT_REVOLUTIONS, portrait};
use crate::plate::{About, Plate};
use crate::revolutions::Revolutions;
use figure::{Axis, Colour, Figure, Mark, Panel, Series, Share};
use study::Level;
use study::classes::{self, HEALTHY};
use study::grid::{ClearanceGrid, JointSet};
use study::recording::Response;

/// At most this many sets of joints are shown, and clearances of each.
const MOST_COMPARED: usize = 8;
const MOST_CLEARANCES: usize = 5;

/// A response with the words and the colour it has in a figure.
struct Drawn<'a> {
    name: String,
    colour: Colour,
    response: &'a Response,
}

/// All figures of the grid: by clearance for each set, across sets, and both again as portraits.
pub(super) fn plates(page: &DatasetPage, grid: &ClearanceGrid) -> Vec<Plate> {
    let sets: Vec<&JointSet> = grid
        .joint_sets
        .iter()
        .filter(|set| !set.responses.is_empty())
        .take(MOST_COMPARED)
        .collect();
    let mut plates: Vec<Plate> = sets.iter().map(|set| by_clearance(grid, set)).collect();
    let common = common_clearance(&sets);
    plates.extend(
        common.map(|clearance| {
            across_sets(grid, &by_colour_of_set(page, &sets, clearance), clearance)
        }),
    );
    if !sets.is_empty() {
        plates.push(portraits_by_clearance(grid, &sets));
    }
    plates.extend(common.map(|clearance| {
        portraits_across_sets(grid, &by_colour_of_set(page, &sets, clearance), clearance)
    }));
    plates
}

/// The responses of the set in the order of clearance, evenly thinned to what a figure holds.
fn in_order(set: &JointSet) -> Vec<(f64, &Response)> {
    let mut all: Vec<(f64, &Response)> = set
        .responses
        .iter()
        .map(|(clearance, response)| (*clearance, response))
        .collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let last = all.len().saturating_sub(1);
    let shown = all.len().min(MOST_CLEARANCES);
    (0..shown)
        .map(|i| all[i * last / shown.saturating_sub(1).max(1)])
        .collect()
}

fn by_colour_of_clearance(set: &JointSet) -> Vec<Drawn<'_>> {
    let ordered = in_order(set);
    let last = ordered.len().saturating_sub(1).max(1) as f64;
    let drawn = ordered
        .into_iter()
        .enumerate()
        .map(|(i, (clearance, response))| Drawn {
            name: text::clearance(clearance),
            colour: Colour::Ordered(i as f64 / last),
            response,
        });
    drawn.collect()
}

/// The largest clearance that every set has.
fn common_clearance(sets: &[&JointSet]) -> Option<f64> {
    let mut clearances: Vec<f64> = sets
        .first()?
        .responses
        .iter()
        .map(|(clearance, _)| *clearance)
        .collect();
    clearances.sort_by(|a, b| b.total_cmp(a));
    clearances.into_iter().find(|&clearance| {
        sets.iter()
            .all(|set| at_clearance(set, clearance).is_some())
    })
}

fn at_clearance(set: &JointSet, clearance: f64) -> Option<&Response> {
    let same = |other: f64| (other - clearance).abs() <= 1e-6 * clearance.abs();
    set.responses
        .iter()
        .find(|(other, _)| same(*other))
        .map(|(_, response)| response)
}

fn about(grid: &ClearanceGrid) -> About {
    About {
        sensor: grid.sensor.clone(),
        operating_point: grid.operating_point.clone(),
        ..About::default()
    }
}

fn by_clearance(grid: &ClearanceGrid, set: &JointSet) -> Plate {
    let drawn = by_colour_of_clearance(set);
    let joints = text::words(&set.joints);
    let levels = || drawn.iter().filter_map(|d| captions::levels(d.response));
    let peaks: Vec<Level> = levels().map(|[peak, _]| peak).collect();
    let rms: Vec<Level> = levels().map(|[_, rms]| rms).collect();
    Plate {
        about: about(grid),
        heading: format!("Clearance in {joints}"),
        caption: format!(
            "Acceleration over one revolution with clearance in {joints}, {}; above all on one pair of axes, below each by \
             itself{}. With the clearance the peak {}, the rms {}. Data: {}.",
            grid.title(),
            ideal_words(grid),
            captions::trend(&peaks, "m/s²"),
            captions::trend(&rms, "m/s²"),
            captions::places(drawn.iter().map(|d| d.response)),
        ),
        figure: overlaid_and_apart(grid, &drawn),
        ..Plate::default()
    }
}

fn across_sets(grid: &ClearanceGrid, drawn: &[Drawn<'_>], clearance: f64) -> Plate {
    let named = |which: usize| -> Vec<(String, Level)> {
        let levels = drawn.iter();
        let levels = levels.filter_map(|d| Some((d, captions::levels(d.response)?[which])));
        levels.map(|(d, level)| (d.name.clone(), level)).collect()
    };
    let (peaks, rms) = (named(0), named(1));
    Plate {
        about: about(grid),
        heading: format!("Sets of joints at {}", text::clearance(clearance)),
        caption: format!(
            "Acceleration over one revolution with a clearance of {} in different joints, {}; above all on one pair of axes, \
             below each by itself{}. The peak is {}; the rms is {}. Data: {}.",
            text::clearance(clearance),
            grid.title(),
            ideal_words(grid),
            captions::ends(&peaks, "m/s²"),
            captions::ends(&rms, "m/s²"),
            captions::places(drawn.iter().map(|d| d.response)),
        ),
        figure: overlaid_and_apart(grid, drawn),
        ..Plate::default()
    }
}

fn by_colour_of_set<'a>(
    page: &DatasetPage,
    sets: &[&'a JointSet],
    clearance: f64,
) -> Vec<Drawn<'a>> {
    let drawn = sets.iter().filter_map(|set| {
        let response = at_clearance(set, clearance)?;
        Some(Drawn {
            name: text::words(&set.joints),
            colour: page.class_colour(&set.joints),
            response,
        })
    });
    drawn.collect()
}

fn ideal_words(grid: &ClearanceGrid) -> &'static str {
    if grid.ideal.is_some() {
        " over the machine without clearance (grey)"
    } else {
        ""
    }
}

/// One wide panel with all responses, the most violent at the back, and a panel for each.
fn overlaid_and_apart(grid: &ClearanceGrid, drawn: &[Drawn<'_>]) -> Figure {
    let mut order: Vec<&Drawn<'_>> = drawn.iter().collect();
    let peak = |d: &Drawn<'_>| captions::levels(d.response).map_or(0.0, |[peak, _]| peak.value);
    order.sort_by(|a, b| peak(b).total_cmp(&peak(a)));
    let ideal = grid
        .ideal
        .as_ref()
        .map(|response| one_revolution(&classes::name(HEALTHY), Colour::Ink, response));
    let overlaid = order
        .iter()
        .map(|d| one_revolution("", d.colour, d.response))
        .chain(ideal.clone());
    let panel = |title: &str, series: Vec<Series>| Panel {
        title: title.to_owned(),
        x: Axis::crank_angle(),
        y: Axis::linear("acceleration (m/s²)"),
        series,
        ..Panel::default()
    };
    let apart = drawn.iter().map(|d| {
        let series = [one_revolution(&d.name, d.colour, d.response)]
            .into_iter()
            .chain(ideal.clone());
        panel(&d.name, series.collect())
    });
    Figure {
        rows: vec![vec![panel("", overlaid.collect())], apart.collect()],
        row_height: 200.0,
        share_y: Share::All,
        ..Figure::default()
    }
}

fn one_revolution(name: &str, colour: Colour, response: &Response) -> Series {
    let curve = Revolutions::new(&response.crank_angle_rad, &response.acceleration_m_s2).longest();
    Series::new(name, colour, Mark::Line, curve)
}

fn portraits_by_clearance(grid: &ClearanceGrid, sets: &[&JointSet]) -> Plate {
    let rows: Vec<Vec<Drawn<'_>>> = sets.iter().map(|set| by_colour_of_clearance(set)).collect();
    let panels = sets.iter().zip(&rows).map(|(set, row)| {
        row.iter()
            .map(|d| {
                portrait(
                    &format!(
                        "{}, {}",
                        text::capitalised(&text::words(&set.joints)),
                        d.name
                    ),
                    d.response,
                    d.colour,
                )
            })
            .collect()
    });
    Plate {
        about: about(grid),
        heading: "Portraits by clearance".to_owned(),
        caption: format!(
            "Acceleration against velocity over the last {PORTRAIT_REVOLUTIONS} revolutions or fewer, {}: a row for each set of joints, the clearance rising from \
             left to right. A closed curve is a motion that repeats with the crank; a band or a cloud is one that does not. \
             Axes are the same in all panels. Data: {}.",
            grid.title(),
            captions::places(rows.iter().flatten().map(|d| d.response)),
        ),
        figure: portraits(panels.collect()),
        ..Plate::default()
    }
}

fn portraits_across_sets(grid: &ClearanceGrid, drawn: &[Drawn<'_>], clearance: f64) -> Plate {
    let panels: Vec<Panel> = drawn
        .iter()
        .map(|d| portrait(&text::capitalised(&d.name), d.response, d.colour))
        .collect();
    Plate {
        about: about(grid),
        heading: format!("Portraits at {}", text::clearance(clearance)),
        caption: format!(
            "Acceleration against velocity over the last {PORTRAIT_REVOLUTIONS} revolutions or fewer with a clearance of {} in different joints, {}. Axes are the \
             same in all panels. Data: {}.",
            text::clearance(clearance),
            grid.title(),
            captions::places(drawn.iter().map(|d| d.response)),
        ),
        figure: portraits(figure::in_rows(panels, 4)),
        ..Plate::default()
    }
}

fn portraits(rows: Vec<Vec<Panel>>) -> Figure {
    Figure {
        rows,
        row_height: 190.0,
        share_x: Share::All,
        share_y: Share::All,
        ..Figure::default()
    }
}
