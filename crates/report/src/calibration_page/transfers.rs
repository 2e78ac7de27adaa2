//! What the machine shows at other clearances, under each relation.

use super::misfits::ROW;
use super::{Bounded, CalibrationPage, Forecast, Hypothesis, Transfer};
use crate::figure::{Axis, Colour, Figure, Mark, Panel, Series, in_rows};
use crate::plate::Plate;
use crate::text;

/// At most so many sets of clearances have a picture, and so many runs stand in it.
const MOST_STATES: usize = 12;
const MOST_RUNS: usize = 20;
/// Distance between the relations of a run, in rows.
const APART: f64 = 0.2;

/// A relation in words.
pub(super) fn words(name: &str) -> &str {
    match name {
        "eq5" => "Eq. (5) of the two-stage study",
        "conformal" => "conformal contact",
        "constant" => "parameters carried over unchanged",
        "fitted" => "powers of the clearance, fitted",
        other => other,
    }
}

/// What the recordings say about the relations.
pub(super) fn decision(transfer: &Transfer) -> String {
    let names: Vec<&str> = transfer.left.iter().map(|name| words(name)).collect();
    let which = if transfer.by_held_out {
        "The fitted runs have one clearance and those held back have others, so that these decide how the contact parameters \
         follow the clearance."
    } else {
        "The recordings were made at several clearances, so that they can decide how the contact parameters follow the clearance."
    };
    match names.as_slice() {
        [] => "All recordings were made at the same clearances. Nothing in them tells how the contact parameters follow the \
               clearance as the bearings wear; every relation fits them equally well. What each predicts stands below, side by \
               side. One recording at another clearance would decide."
            .to_owned(),
        [one] => format!("{which} They are for: {one}."),
        [best, rest @ ..] => format!(
            "{which} The best is: {best}; but they do not rule out: {}.",
            rest.join("; ")
        ),
    }
}

/// The fitted exponents of a relation.
pub(super) fn exponents(hypothesis: &Hypothesis) -> String {
    let said = |(path, bounded): &(String, Bounded)| {
        let name = path.rsplit('.').next().unwrap_or(path);
        let value = text::decimal(bounded.value, 2);
        match bounded.interval {
            Some([low, high]) => format!(
                "{name} {value} ({} to {})",
                text::decimal(low, 2),
                text::decimal(high, 2)
            ),
            None => format!("{name} {value} (not told)"),
        }
    };
    let said: Vec<String> = hypothesis.exponents.iter().map(said).collect();
    said.join("; ")
}

/// What a run shows at other clearances, over the relations that the recordings do not exclude.
pub(super) struct Spread {
    /// The clearances.
    pub state: String,
    /// The run.
    pub run: String,
    /// The channel.
    pub channel: String,
    /// Least and greatest peak, the 95 % intervals of each relation included.
    pub peak: [String; 2],
}

/// The spread of each run, set of clearances and channel. Where the recordings have no say, all relations
/// that have a name are possible.
pub(super) fn spreads(transfer: &Transfer) -> Vec<Spread> {
    let possible = |f: &&Forecast| match transfer.left.is_empty() {
        true => f.relation != "fitted",
        false => transfer.left.contains(&f.relation),
    };
    let mut ranges: Vec<(&Forecast, &str, [f64; 2])> = Vec::new();
    for forecast in transfer.forecasts.iter().filter(possible) {
        for (column, peak, _) in &forecast.peaks {
            let [low, high] = peak.interval.unwrap_or([peak.value; 2]);
            let same = |(other, c, _): &&mut (&Forecast, &str, [f64; 2])| {
                let state = (&other.run, &other.clearances);
                c == column && state == (&forecast.run, &forecast.clearances)
            };
            match ranges.iter_mut().find(same) {
                Some((.., range)) => *range = [range[0].min(low), range[1].max(high)],
                None => ranges.push((forecast, column, [low, high])),
            }
        }
    }
    let spread = |(forecast, column, range): (&Forecast, &str, [f64; 2])| {
        let (channel, unit) = super::words::column(column);
        Spread {
            state: state(&forecast.clearances),
            run: forecast.run.clone(),
            channel,
            peak: range.map(|peak| super::verdict::quantity(peak, unit)),
        }
    };
    ranges.into_iter().map(spread).collect()
}

/// Clearances in words.
fn state(clearances: &[(String, f64)]) -> String {
    let joints = clearances.iter();
    let joints = joints
        .map(|(path, metres)| format!("{} {}", super::words::path(path), text::clearance(*metres)));
    text::capitalised(&joints.collect::<Vec<_>>().join(", "))
}

/// A picture for each set of clearances.
pub(super) fn plates(page: &CalibrationPage) -> Vec<Plate> {
    let Some(transfer) = &page.transfer else {
        return Vec::new();
    };
    let mut states: Vec<&[(String, f64)]> = Vec::new();
    for forecast in &transfer.forecasts {
        if !forecast.peaks.is_empty() && !states.contains(&forecast.clearances.as_slice()) {
            states.push(&forecast.clearances);
        }
    }
    states.truncate(MOST_STATES);
    states.iter().map(|state| plate(transfer, state)).collect()
}

fn plate(transfer: &Transfer, state: &[(String, f64)]) -> Plate {
    let forecasts: Vec<&Forecast> = transfer
        .forecasts
        .iter()
        .filter(|f| f.clearances == state && !f.peaks.is_empty())
        .collect();
    let mut runs: Vec<&str> = Vec::new();
    let mut columns: Vec<&str> = Vec::new();
    for forecast in &forecasts {
        if !runs.contains(&forecast.run.as_str()) {
            runs.push(&forecast.run);
        }
        for (column, ..) in &forecast.peaks {
            if !columns.contains(&column.as_str()) {
                columns.push(column);
            }
        }
    }
    runs.truncate(MOST_RUNS);
    // Wear is heard, and hardly felt by the gas.
    if columns.iter().any(|c| c.contains("acceleration")) {
        columns.retain(|c| c.contains("acceleration"));
    }
    let panels = columns
        .iter()
        .map(|column| panel(transfer, &forecasts, &runs, column));
    Plate {
        heading: self::state(state),
        caption: "Greatest acceleration within a revolution at this clearance, under each relation, with the 95 % interval that the \
                  calibrated parameters leave. A grey ring is a recording. Where the relations' bars lie apart, a recording at \
                  this clearance would tell which of them holds."
            .to_owned(),
        svg: Figure {
            rows: in_rows(panels.collect(), 2),
            row_height: 1.6 * ROW * (runs.len() as f64 + 0.5),
            ..Figure::default()
        }
        .svg(),
    }
}

fn panel(transfer: &Transfer, forecasts: &[&Forecast], runs: &[&str], column: &str) -> Panel {
    let (name, unit) = super::words::column(column);
    let top = runs.len() as f64 - 1.0;
    let row = |run: &str| Some(top - runs.iter().position(|r| *r == run)? as f64);
    let middle = (transfer.relations.len() as f64 - 1.0) / 2.0;
    let mut series = Vec::new();
    let mut recorded = Vec::new();
    for (i, hypothesis) in transfer.relations.iter().enumerate() {
        let (mut points, mut bars) = (Vec::new(), Vec::new());
        for forecast in forecasts {
            let of_column = forecast.peaks.iter().find(|(c, ..)| c == column);
            let (Some((_, peak, measured)), Some(y)) = (of_column, row(&forecast.run)) else {
                continue;
            };
            if forecast.relation != hypothesis.relation {
                continue;
            }
            let y = y + (middle - i as f64) * APART;
            points.push([peak.value, y]);
            if let Some([low, high]) = peak.interval {
                bars.extend([[low, y], [high, y], [f64::NAN; 2]]);
            }
            recorded.extend(measured.map(|measured| [measured, y]));
        }
        let colour = Colour::Class(i);
        series.push(Series::new("", colour, Mark::Line, bars));
        series.push(Series::new(
            words(&hypothesis.relation),
            colour,
            Mark::Discs,
            points,
        ));
    }
    let label = if recorded.is_empty() { "" } else { "recorded" };
    series.push(Series::new(label, Colour::Ink, Mark::Rings, recorded));
    Panel {
        title: text::capitalised(&name),
        x: Axis::linear(text::with_unit("greatest magnitude", unit)),
        y: Axis::named("", runs.iter().rev().map(|run| (*run).to_owned()).collect()),
        series,
        ..Panel::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spread_is_over_the_relations_that_are_left() {
        let of = |relation: &str, value: f64| Forecast {
            run: "run01".into(),
            relation: relation.into(),
            clearances: vec![("joints.big_end".into(), 2e-4)],
            peaks: vec![(
                "crosshead_acceleration_m_s2".into(),
                Bounded {
                    value,
                    interval: Some([value - 10.0, value + 10.0]),
                },
                None,
            )],
        };
        let mut transfer = Transfer {
            forecasts: vec![of("eq5", 500.0), of("constant", 700.0), of("fitted", 900.0)],
            ..Transfer::default()
        };
        let peaks = |transfer: &Transfer| {
            let spreads = spreads(transfer);
            assert_eq!(spreads.len(), 1);
            spreads[0].peak.clone()
        };
        assert_eq!(peaks(&transfer), ["490\u{a0}m/s²", "710\u{a0}m/s²"]);
        transfer.left = vec!["fitted".into()];
        assert_eq!(peaks(&transfer), ["890\u{a0}m/s²", "910\u{a0}m/s²"]);
    }

    #[test]
    fn the_decision_names_what_the_recordings_leave() {
        let of = |left: &[&str]| Transfer {
            left: left.iter().map(|name| (*name).to_owned()).collect(),
            ..Transfer::default()
        };
        assert!(decision(&of(&[])).contains("One recording at another clearance would decide"));
        assert!(decision(&of(&["constant"])).ends_with("for: parameters carried over unchanged."));
        assert!(decision(&of(&["fitted", "eq5"])).contains("do not rule out: Eq. (5)"));
    }
}
