//! Maps of the regimes.

use super::ChaosPage;
use super::exponents::MOST_SPEEDS;
use super::levels::Levels;
use crate::plate::Plate;
use figure::{Axis, Colour, Field, Figure, Layer, Panel};
use study::chaos::agreement::most_frequent;
use study::chaos::cases::CaseChaos;
use study::chaos::regime::Regime;

/// At most this many sets of joints have a map over speed.
const MOST_SETS: usize = 4;
const KEY: &str = "P periodic (P2: every second revolution), Q quasi-periodic, C chaotic, S as noise, ? undecided";

/// Where the regimes of a case are taken from.
type Source = fn(&CaseChaos) -> Vec<Regime>;

/// From the equations and from the signal, as far as there are any.
fn sources(cases: &[CaseChaos]) -> Vec<(&'static str, Source)> {
    let all: [(&str, Source); 2] = [
        ("From the equations", |case| {
            case.regime.into_iter().collect()
        }),
        ("From the signal", |case| {
            case.windows
                .iter()
                .filter_map(|window| window.regime)
                .collect()
        }),
    ];
    let there = |source: &(&str, Source)| cases.iter().any(|case| !source.1(case).is_empty());
    all.into_iter().filter(there).collect()
}

/// Clearance against joints, and clearance against speed.
pub(super) fn plates(page: &ChaosPage) -> Vec<Plate> {
    let clear: Vec<CaseChaos> = page
        .cases
        .iter()
        .filter(|case| case.clearance_m > 0.0)
        .cloned()
        .collect();
    let sources = sources(&clear);
    if sources.is_empty() {
        return Vec::new();
    }
    let mut sets: Vec<String> = Vec::new();
    for case in &clear {
        if !sets.contains(&case.joints) {
            sets.push(case.joints.clone());
        }
    }
    let clearances = Levels::from_values(clear.iter().map(|case| case.clearance_m));
    let speeds = Levels::from_values(clear.iter().map(|case| case.speed_rpm));
    let x = Axis::named("clearance (mm)", clearances.names(1e3));
    let mut plates = vec![by_joints(&clear, &sources, &sets, &clearances, &speeds, &x)];
    if speeds.count() > 1 {
        plates.push(by_speed(&clear, &sources, &sets, &clearances, &speeds, &x));
    }
    plates
}

fn by_joints(
    cases: &[CaseChaos],
    sources: &[(&str, Source)],
    sets: &[String],
    clearances: &Levels,
    speeds: &Levels,
    x: &Axis,
) -> Plate {
    let names = speeds.names(1.0);
    let apart = speeds.width == 0.0 && speeds.count() <= MOST_SPEEDS;
    let groups: Vec<(String, Option<usize>)> = if apart {
        let named = names.iter().enumerate();
        named
            .map(|(i, name)| (format!("{name}\u{a0}rpm"), Some(i)))
            .collect()
    } else {
        vec![("All speeds".to_owned(), None)]
    };
    // The first set stands at the top.
    let from_top = |i: usize| sets.len() - 1 - i;
    let labels: Vec<String> = sets.iter().rev().map(|set| text::words(set)).collect();
    let panel = |source: Source, (title, speed): &(String, Option<usize>)| {
        let own = cases
            .iter()
            .filter(|case| speed.is_none() || speeds.index(case.speed_rpm) == *speed);
        let at = |case: &CaseChaos| {
            let set = sets.iter().position(|set| *set == case.joints)?;
            Some((clearances.index(case.clearance_m)?, from_top(set)))
        };
        Panel {
            title: title.clone(),
            x: x.clone(),
            y: Axis::named("", labels.clone()),
            fields: fields(own, source, at),
            ..Panel::default()
        }
    };
    let rows = sources
        .iter()
        .map(|(_, source)| groups.iter().map(|group| panel(*source, group)).collect());
    Plate {
        heading: "Regimes by clearance and joint".to_owned(),
        caption: caption("in different joints", clearances.width),
        figure: figure(sources, rows.collect(), 26.0 * sets.len().max(2) as f64),
        ..Plate::default()
    }
}

fn by_speed(
    cases: &[CaseChaos],
    sources: &[(&str, Source)],
    sets: &[String],
    clearances: &Levels,
    speeds: &Levels,
    x: &Axis,
) -> Plate {
    let panel = |source: Source, set: &String| {
        let own = cases.iter().filter(|case| case.joints == *set);
        let at = |case: &CaseChaos| {
            Some((
                clearances.index(case.clearance_m)?,
                speeds.index(case.speed_rpm)?,
            ))
        };
        Panel {
            title: text::capitalised(&text::words(set)),
            x: x.clone(),
            y: Axis::named("speed (rpm)", speeds.names(1.0)),
            fields: fields(own, source, at),
            ..Panel::default()
        }
    };
    let shown = &sets[..sets.len().min(MOST_SETS)];
    let rows = sources
        .iter()
        .map(|(_, source)| shown.iter().map(|set| panel(*source, set)).collect());
    Plate {
        heading: "Regimes by clearance and speed".to_owned(),
        caption: caption("at different speeds", clearances.width.max(speeds.width)),
        figure: figure(sources, rows.collect(), 26.0 * speeds.count().max(3) as f64),
        ..Plate::default()
    }
}

/// A field for every place that has cases.
fn fields<'a>(
    cases: impl Iterator<Item = &'a CaseChaos>,
    source: Source,
    at: impl Fn(&CaseChaos) -> Option<(usize, usize)>,
) -> Vec<Field> {
    let mut places: std::collections::BTreeMap<(usize, usize), Vec<Regime>> = Default::default();
    for case in cases {
        if let Some(place) = at(case) {
            places.entry(place).or_default().extend(source(case));
        }
    }
    let fields = places.into_iter().filter_map(|((x, y), regimes)| {
        let (regime, others) = most_frequent(regimes.into_iter())?;
        Some(Field {
            layer: Layer::Always,
            at: [x as f64, y as f64],
            fill: Colour::Tint(regime.tint()),
            letters: regime.letters() + if others { "*" } else { "" },
        })
    });
    fields.collect()
}

fn figure(sources: &[(&str, Source)], rows: Vec<Vec<Panel>>, row_height: f64) -> Figure {
    let heading = |(i, (name, _)): (usize, &(&str, Source))| match i {
        0 => format!("{name}: {KEY}"),
        _ => (*name).to_owned(),
    };
    Figure {
        rows,
        row_headings: sources.iter().enumerate().map(heading).collect(),
        row_height,
        share_y: figure::Share::All,
        ..Figure::default()
    }
}

fn caption(over: &str, bins: f64) -> String {
    let binned = if bins > 0.0 {
        " The values are in bins of equal width; the axis shows their centres."
    } else {
        ""
    };
    format!(
        "The regime with clearances of different size {over}; darker is less regular. {KEY}. A star marks a field whose cases or \
         windows disagree; it shows their most frequent regime. White fields have no case.{binned}"
    )
}
