//! A valve that a recorded pressure does not open: what the machine does, and no contradiction.

use serde::{Deserialize, Serialize};

/// A valve of a chamber.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Valve {
    /// It lets gas in.
    Suction,
    /// It lets gas out.
    Discharge,
}

/// A valve that a chamber's recorded pressure does not open. The cylinder is unloaded, motored or blocked in, or it leaks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShutValve {
    /// The run.
    pub run: String,
    /// The channel's column.
    pub channel: String,
    /// The valve.
    pub valve: Valve,
    /// The pressure nearest to its line that the chamber reaches, Pa.
    pub reached_pa: f64,
    /// The pressure that is stated for the line, Pa.
    pub stated_pa: f64,
}

impl Valve {
    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Suction => "suction",
            Self::Discharge => "discharge",
        }
    }
}

/// What the valves that stay shut come to, a sentence for each valve of each channel.
pub fn sentences(shut: &[ShutValve]) -> Vec<String> {
    let mut groups: Vec<Vec<&ShutValve>> = Vec::new();
    for one in shut {
        let same = |group: &&mut Vec<&ShutValve>| {
            group[0].channel == one.channel && group[0].valve == one.valve
        };
        match groups.iter_mut().find(same) {
            Some(group) => group.push(one),
            None => groups.push(vec![one]),
        }
    }
    groups.iter().map(|group| sentence(group)).collect()
}

fn sentence(group: &[&ShutValve]) -> String {
    let first = group[0];
    let runs: Vec<&str> = group.iter().map(|one| one.run.as_str()).collect();
    let verb = match first.valve {
        Valve::Suction => "falls",
        Valve::Discharge => "rises",
    };
    format!(
        "{}, {}: the {} valve does not open. The pressure {verb} only to {}, and that of the line is stated as {}. The cylinder is \
         unloaded, motored or blocked in, or it leaks.",
        first.channel,
        runs.join(", "),
        first.valve.name(),
        range(group.iter().map(|one| one.reached_pa)),
        range(group.iter().map(|one| one.stated_pa)),
    )
}

/// Least and greatest of some pressures, MPa; one number where both look the same.
fn range(pressures: impl Iterator<Item = f64> + Clone) -> String {
    let [least, greatest] = [
        pressures.clone().fold(f64::INFINITY, f64::min),
        pressures.fold(f64::NEG_INFINITY, f64::max),
    ]
    .map(|pressure| format!("{:.4}", pressure / 1e6));
    match least == greatest {
        true => format!("{least} MPa"),
        false => format!("{least} to {greatest} MPa"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_of_one_channel_are_one_sentence() {
        let shut = |run: &str, channel: &str, reached_pa| ShutValve {
            run: run.to_owned(),
            channel: channel.to_owned(),
            valve: Valve::Discharge,
            reached_pa,
            stated_pa: 393e3,
        };
        let all = [
            shut("a", "p", 110e3),
            shut("a", "q", 120e3),
            shut("b", "p", 115e3),
        ];
        let said = sentences(&all);
        assert_eq!(said.len(), 2);
        assert!(said[0].starts_with(
            "p, a, b: the discharge valve does not open. The pressure rises only to 0.1100 to 0.1150 MPa, and that of the line is \
             stated as 0.3930 MPa."
        ));
        assert!(said[1].starts_with("q, a: ") && said[1].contains("only to 0.1200 MPa"));
    }
}
