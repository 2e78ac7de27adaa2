//! What the machine shows at other clearances, under each relation.

use super::CalibrationPage;
use super::misfits::ROW;
use crate::plate::Plate;
use calibrate::Bounded;
use calibrate::Relation;
use calibrate::forecast::Forecast;
use calibrate::results::Relations;
use calibrate::transfer::{Basis, Hypothesis};
use figure::{Axis, Colour, Figure, Mark, Panel, Series, in_rows};
use simulate::sensor::Quantity;
use std::collections::BTreeMap;

/// At most so many sets of clearances have a picture, and so many runs stand in it.
const MOST_STATES: usize = 12;
const MOST_RUNS: usize = 20;
/// Distance between the relations of a run, in rows.
const APART: f64 = 0.2;

/// A relation in words.
pub(super) fn words(relation: Relation) -> &'static str {
    match relation {
        Relation::Equation5 => "Eq. (5) of the two-stage study",
        Relation::Conformal => "conformal contact",
        Relation::Constant => "parameters carried over unchanged",
        Relation::Fitted => "powers of the clearance, fitted",
    }
}

/// Which relation the recordings favour.
pub(super) fn decision(relations: &Relations) -> String {
    let decision = &relations.decision;
    let names: Vec<&str> = decision.relations.iter().map(|r| words(*r)).collect();
    let which = if decision.runs == Basis::HeldOut {
        "The held-out runs have other clearances than the fitted ones. They decide how the contact parameters follow the \
         clearance."
    } else {
        "The recordings were made at several clearances. They decide how the contact parameters follow the clearance."
    };
    match names.as_slice() {
        [] => "All recordings were made at the same clearances, so every relation between contact parameters and clearance fits \
               them equally well. The figures compare what the relations predict. One recording at another clearance would \
               decide."
            .to_owned(),
        [one] => format!("{which} The data favour: {one}."),
        [best, rest @ ..] => format!(
            "{which} The data favour: {best}. They do not rule out: {}.",
            rest.join("; ")
        ),
    }
}

/// The fitted exponents of a relation.
pub(super) fn exponents(hypothesis: &Hypothesis) -> String {
    let said = |(path, bounded): (&String, &Bounded)| {
        let name = path.rsplit('.').next().unwrap_or(path);
        let [value, low, high] =
            [bounded.value, bounded.low, bounded.high].map(|x| text::decimal(x, 2));
        format!("{name} {value} ({low} to {high})")
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
pub(super) fn spreads(page: &CalibrationPage) -> Vec<Spread> {
    let results = &page.results;
    let left = results.relations.as_ref().map(|r| &r.decision.relations);
    let possible = |f: &&Forecast| match left {
        Some(left) if !left.is_empty() => left.contains(&f.relation),
        _ => f.relation != Relation::Fitted,
    };
    let mut ranges: Vec<(&Forecast, &str, [f64; 2])> = Vec::new();
    let forecasts = results.predictions.iter().flatten();
    for forecast in forecasts.filter(possible) {
        for (column, shown) in &forecast.channels {
            let Bounded { low, high, .. } = shown.peak;
            let same = |(other, c, _): &&mut (&Forecast, &str, [f64; 2])| {
                let state = (&other.run, &other.clearance_m);
                c == column && state == (&forecast.run, &forecast.clearance_m)
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
            state: state(&forecast.clearance_m),
            run: forecast.run.clone(),
            channel,
            peak: range.map(|peak| super::verdict::quantity(peak, unit)),
        }
    };
    ranges.into_iter().map(spread).collect()
}

/// Clearances in words.
fn state(clearances: &BTreeMap<String, f64>) -> String {
    let joints = clearances.iter();
    let joints = joints
        .map(|(path, metres)| format!("{} {}", super::words::path(path), text::clearance(*metres)));
    text::capitalised(&joints.collect::<Vec<_>>().join(", "))
}

/// A picture for each set of clearances.
pub(super) fn plates(page: &CalibrationPage) -> Vec<Plate> {
    let results = &page.results;
    let (Some(relations), Some(forecasts)) = (&results.relations, &results.predictions) else {
        return Vec::new();
    };
    let shown: Vec<&Forecast> = forecasts
        .iter()
        .filter(|forecast| !forecast.channels.is_empty())
        .collect();
    let mut states: Vec<&BTreeMap<String, f64>> = Vec::new();
    for forecast in &shown {
        if !states.contains(&&forecast.clearance_m) {
            states.push(&forecast.clearance_m);
        }
    }
    states.truncate(MOST_STATES);
    states
        .iter()
        .map(|state| plate(relations, &shown, state))
        .collect()
}

fn plate(relations: &Relations, all: &[&Forecast], state: &BTreeMap<String, f64>) -> Plate {
    let forecasts: Vec<&Forecast> = all
        .iter()
        .filter(|f| f.clearance_m == *state)
        .copied()
        .collect();
    let mut runs: Vec<&str> = Vec::new();
    let mut columns: Vec<&str> = Vec::new();
    for forecast in &forecasts {
        if !runs.contains(&forecast.run.as_str()) {
            runs.push(&forecast.run);
        }
        for column in forecast.channels.keys() {
            if !columns.contains(&column.as_str()) {
                columns.push(column);
            }
        }
    }
    runs.truncate(MOST_RUNS);
    // Wear is heard, and hardly felt by the gas.
    let is_heard = |column: &str| Quantity::of_column(column).is_acceleration();
    if columns.iter().any(|column| is_heard(column)) {
        columns.retain(|column| is_heard(column));
    }
    let panels = columns
        .iter()
        .map(|column| panel(&relations.compared, &forecasts, &runs, column));
    Plate {
        heading: self::state(state),
        caption: "Greatest acceleration within a revolution at this clearance for each relation, with the 95 % interval that \
                  follows from the calibrated parameters. A grey ring is a recording. Where the bars of two relations do not \
                  overlap, a recording at this clearance decides between them."
            .to_owned(),
        figure: Figure {
            rows: in_rows(panels.collect(), 2),
            row_height: 1.6 * ROW * (runs.len() as f64 + 0.5),
            ..Figure::default()
        },
        ..Plate::default()
    }
}

fn panel(compared: &[Hypothesis], forecasts: &[&Forecast], runs: &[&str], column: &str) -> Panel {
    let (name, unit) = super::words::column(column);
    let top = runs.len() as f64 - 1.0;
    let row = |run: &str| Some(top - runs.iter().position(|r| *r == run)? as f64);
    let middle = (compared.len() as f64 - 1.0) / 2.0;
    let mut series = Vec::new();
    let mut recorded = Vec::new();
    for (i, hypothesis) in compared.iter().enumerate() {
        let (mut points, mut bars) = (Vec::new(), Vec::new());
        for forecast in forecasts {
            let of_column = forecast.channels.get(column);
            let (Some(shown), Some(y)) = (of_column, row(&forecast.run)) else {
                continue;
            };
            if forecast.relation != hypothesis.relation {
                continue;
            }
            let y = y + (middle - i as f64) * APART;
            let Bounded { value, low, high } = shown.peak;
            points.push([value, y]);
            bars.extend([[low, y], [high, y], [f64::NAN; 2]]);
            recorded.extend(shown.recorded.map(|[_, peak]| [peak, y]));
        }
        let colour = Colour::Class(i);
        series.push(Series::new("", colour, Mark::Line, bars));
        series.push(Series::new(
            words(hypothesis.relation),
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
    use calibrate::forecast::ChannelForecast;
    use calibrate::results::Results;
    use calibrate::transfer::Decision;

    fn left(relations: &[Relation]) -> Relations {
        Relations {
            decision: Decision {
                relations: relations.to_vec(),
                runs: Basis::Fitted,
            },
            compared: Vec::new(),
        }
    }

    #[test]
    fn the_spread_is_over_the_relations_that_are_left() {
        let of = |relation, value: f64| {
            let shown = Bounded {
                value,
                low: value - 10.0,
                high: value + 10.0,
            };
            let channel = ChannelForecast {
                rms: shown,
                peak: shown,
                recorded: None,
                difference: None,
            };
            Forecast {
                run: "run01".into(),
                clearance_m: [("joints.big_end".into(), 2e-4)].into(),
                relation,
                recorded: false,
                misfit: None,
                failure: None,
                channels: [("crosshead_acceleration_m_s2".into(), channel)].into(),
            }
        };
        let peaks = |relations: &[Relation]| {
            let page = CalibrationPage {
                results: Results {
                    relations: Some(left(relations)),
                    predictions: Some(vec![
                        of(Relation::Equation5, 500.0),
                        of(Relation::Constant, 700.0),
                        of(Relation::Fitted, 900.0),
                    ]),
                    ..Results::default()
                },
                ..CalibrationPage::default()
            };
            let spreads = spreads(&page);
            assert_eq!(spreads.len(), 1);
            spreads[0].peak.clone()
        };
        assert_eq!(peaks(&[]), ["490\u{a0}m/s²", "710\u{a0}m/s²"]);
        let fitted = peaks(&[Relation::Fitted]);
        assert_eq!(fitted, ["890\u{a0}m/s²", "910\u{a0}m/s²"]);
    }

    #[test]
    fn the_decision_names_what_the_recordings_leave() {
        let of = |relations: &[Relation]| decision(&left(relations));
        assert!(of(&[]).contains("One recording at another clearance would decide"));
        assert!(of(&[Relation::Constant]).ends_with("favour: parameters carried over unchanged."));
        let two = of(&[Relation::Fitted, Relation::Equation5]);
        assert!(two.contains("do not rule out: Eq. (5)"));
    }
}
