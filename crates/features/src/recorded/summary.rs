//! What is said at the end: how many windows, what looks wrong, and which columns stay empty and why.

use super::counted::counted;
use super::table::Row;
use crate::{Reason, Remedy};
use recordings::{Schema, Value};
use std::collections::BTreeMap;

/// Files whose warnings are shown.
const SHOWN: usize = 5;

/// Counts over the rows of a table.
pub struct Summary {
    /// Of each column, whether any row has a value, and why the first one has none.
    filled: Vec<bool>,
    reasons: Vec<Option<Reason>>,
    rows: u64,
    bridged: usize,
    /// Files with warnings, in order: windows with one, and the first.
    warnings: Vec<Warned>,
}

struct Warned {
    file: String,
    windows: u64,
    first: String,
}

impl Summary {
    /// Of a table with so many columns, before its first row.
    pub fn new(columns: usize) -> Self {
        Self {
            filled: vec![false; columns],
            reasons: vec![None; columns],
            rows: 0,
            bridged: 0,
            warnings: Vec::new(),
        }
    }

    /// Counts a row; its reasons are taken.
    pub fn add(&mut self, row: &mut Row) {
        self.rows += 1;
        self.bridged += row.bridged;
        for (filled, value) in self.filled.iter_mut().zip(&row.values) {
            *filled |= !matches!(value, Value::Missing);
        }
        for (column, reason) in row.reasons.drain(..) {
            self.reasons[column].get_or_insert(reason);
        }
        let Some(warning) = &row.warning else { return };
        match self.warnings.last_mut().filter(|w| w.file == row.file) {
            Some(warned) => warned.windows += 1,
            None => self.warnings.push(Warned {
                file: row.file.clone(),
                windows: 1,
                first: format!("at {:.3} s: {warning}", row.start_s),
            }),
        }
    }

    /// Rows of the table.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// Samples that are bridged.
    pub fn bridged(&self) -> usize {
        self.bridged
    }

    /// A line per file with warnings.
    pub fn warnings(&self) -> Vec<String> {
        let shown = self.warnings.iter().take(SHOWN);
        let mut lines: Vec<String> = shown
            .map(|warned| {
                let more = match warned.windows {
                    1 => String::new(),
                    n => format!(" (and {} more)", counted(n - 1, "window")),
                };
                format!("warning: {}: {}{more}", warned.file, warned.first)
            })
            .collect();
        if self.warnings.len() > SHOWN {
            let more = counted((self.warnings.len() - SHOWN) as u64, "more file");
            lines.push(format!("warning: {more}: see the column `warnings`"));
        }
        lines
    }

    /// How many of the features are empty in every window, and what fills them.
    pub fn empty(&self, schema: &Schema) -> Vec<String> {
        let columns = schema.columns().iter().zip(&self.filled);
        let mut empty: BTreeMap<String, u64> = BTreeMap::new();
        for ((_, filled), reason) in columns.zip(&self.reasons) {
            if let (false, Some(reason)) = (filled, reason) {
                *empty.entry(advice(reason)).or_default() += 1;
            }
        }
        let all: u64 = empty.values().sum();
        if all == 0 {
            return Vec::new();
        }
        let mut lines = vec![format!("  {} without any value:", counted(all, "column"))];
        let mut groups: Vec<(String, u64)> = empty.into_iter().collect();
        groups.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        lines.extend(groups.iter().map(|(why, n)| format!("  {n:>5}  {why}")));
        lines
    }
}

/// Why, and the option that helps.
fn advice(reason: &Reason) -> String {
    match reason.remedy() {
        Some(Remedy::Speed) => {
            "the speed is not known: --speed, --tacho or --crank-angle gives it".into()
        }
        Some(Remedy::TopDeadCentre) => {
            "top dead centre is not known: --top-dead-centre gives it, with a crank angle or a tacho"
                .into()
        }
        Some(Remedy::Machine) => {
            "the chamber is not known: --machine gives bore, stroke and rod of cylinder pressures".into()
        }
        Some(Remedy::LongerWindow) => "the window is too short: a longer --window".into(),
        Some(Remedy::HigherSampleRate) => "the sample rate is too low".into(),
        None => reason.to_string(),
    }
}
