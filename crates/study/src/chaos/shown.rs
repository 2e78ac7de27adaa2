//! Which cases' motion is shown.

use crate::chaos::cases::CaseChaos;
use crate::classes;
use crate::examples::{nearest_median, operating_point};
use sweep::reader::Dataset;

/// At most this many rows, and cases in a row.
const MOST_ROWS: usize = 6;
const MOST_COLUMNS: usize = 5;

/// The cases, by their place among all.
pub struct Shown {
    /// Heading and cases of each row; none where the sweep lacks one.
    pub rows: Vec<(String, Vec<Option<usize>>)>,
    /// How they were chosen, in words.
    pub rule: String,
}

/// Of a grid the cases of the first operating point: a row for each set of joints, a column for
/// each clearance. Of other sweeps a typical case for each set of joints.
pub fn shown(dataset: &Dataset, known: &[CaseChaos]) -> Shown {
    let clear: Vec<usize> = (0..known.len())
        .filter(|&i| known[i].clearance_m > 0.0)
        .collect();
    let Some(&first) = clear.first() else {
        return Shown {
            rows: Vec::new(),
            rule: String::new(),
        };
    };
    let key = |i: usize| dataset.windows.all_else(dataset.cases[i].first);
    let wanted = key(first);
    let point: Vec<usize> = clear
        .iter()
        .copied()
        .filter(|&i| key(i) == wanted)
        .collect();
    let mut clearances: Vec<f64> = point.iter().map(|&i| known[i].clearance_m).collect();
    clearances.sort_by(f64::total_cmp);
    clearances.dedup();
    if clearances.len() > 1 {
        let words = operating_point(dataset, dataset.cases[first].first);
        grid(known, &point, &clearances, &words)
    } else {
        typical(known, &clear)
    }
}

fn grid(known: &[CaseChaos], point: &[usize], clearances: &[f64], operating_point: &str) -> Shown {
    let last = clearances.len() - 1;
    let columns = clearances.len().min(MOST_COLUMNS);
    // Evenly from the smallest to the largest.
    let shown: Vec<f64> = (0..columns)
        .map(|i| clearances[i * last / (columns - 1)])
        .collect();
    let sets = sets(known, point);
    let rows = sets.iter().take(MOST_ROWS).map(|set| {
        let at = |clearance: &f64| {
            let mut own = point.iter().copied();
            own.find(|&i| known[i].joints == *set && known[i].clearance_m == *clearance)
        };
        (heading(set), shown.iter().map(at).collect())
    });
    let mut rule = format!(
        "The cases of the sweep's first operating point, {operating_point}: a row for each set of joints with clearance, the \
         clearance rising from left to right."
    );
    if columns < clearances.len() {
        rule += &format!(" Of {} clearances {columns} are shown.", clearances.len());
    }
    if sets.len() > MOST_ROWS {
        rule += &format!(
            " Of {} sets of joints the first {MOST_ROWS} are shown.",
            sets.len()
        );
    }
    Shown {
        rows: rows.collect(),
        rule,
    }
}

fn typical(known: &[CaseChaos], clear: &[usize]) -> Shown {
    let sets = sets(known, clear);
    let typical = sets.iter().take(MOST_ROWS * MOST_COLUMNS).map(|set| {
        let own: Vec<usize> = clear
            .iter()
            .copied()
            .filter(|&i| known[i].joints == *set)
            .collect();
        nearest_median(&own, |&i| known[i].clearance_m).copied()
    });
    let typical: Vec<Option<usize>> = typical.collect();
    let rows = typical
        .chunks(MOST_COLUMNS)
        .map(|row| (String::new(), row.to_vec()));
    Shown {
        rows: rows.collect(),
        rule:
            "The case of each class whose largest clearance is nearest to the median of its class."
                .to_owned(),
    }
}

/// The sets of joints, in the order of the sweep.
fn sets(known: &[CaseChaos], cases: &[usize]) -> Vec<String> {
    let mut sets: Vec<String> = Vec::new();
    for &i in cases {
        if !sets.contains(&known[i].joints) {
            sets.push(known[i].joints.clone());
        }
    }
    sets
}

fn heading(set: &str) -> String {
    text::capitalised(&classes::name(set))
}
